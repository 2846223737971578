// The real-time tier: lobes as soft boxes and harmonics, `Fitted` of src/cpu/fitted.rs; src/realtime/tables
// documents the parameters. The including file declares, in any group, octagloss_octaves: OctaglossOctaves,
// octagloss_lights: array<OctaglossLight, N> (uniform), octagloss_entries: array<Sum>, octagloss_parameters:
// array<vec4<u32>> (storage, read), octagloss_oems: texture_2d_array<f32>. N environments share them, each a
// `probe`: its light, as many entries as each other's, its layer.
#include "common/harmonics.wgsl"
#include "common/light.wgsl"
#include "common/octahedral.wgsl"
#include "common/octaves.wgsl"
#include "common/plane.wgsl"

// e = 1 - u + v at the outer side of the grid around the cone point.
const CONE_REACH = 0.475f;
// Squared sines of the angle from a cone point between which the parameters around it fade out.
const CONE_FROM = 0.039f;
const CONE_UNTIL = 0.087f;
// Alphas between which they fade in.
const CONE_SHARP = 0.01f;
const CONE_ROUGH = 0.0125f;
// Knots of an octave, the first of them and their distance, in octaves of alpha over the blur.
const KNOTS = 4u;
const FIRST_KNOT = 0.25f;
const KNOT_STEP = 0.41666667f;
// How far the parameters of an octave reach beyond it; an octave begins at its first knot.
const OVERLAP = 0.25f;
// The coarsest octave of parameters.
const FIRST_OCTAVE = 2u;
// Roughness above which harmonics blend in, and above which they replace the boxes.
const HARMONICS_FROM = 0.65f;
const HARMONICS_ALONE = 0.75f;
// Least roughness of the polynomial for peaks.
const PEAK_FROM = 0.09f;
// 2^-60: scales entries to the harmonics' units.
const UNIT = 8.6736174e-19f;

// Contribution of each order of the harmonics in one direction.
struct Orders {
    first: vec4<f32>,
    others: mat4x4<f32>,
}

fn orders_around(probe: u32, direction: vec3<f32>) -> Orders {
    var b = harmonic_basis(direction);
    var orders: Orders;
    orders.first = b[0] * octagloss_lights[probe].harmonics[0];
    orders.others[0] = b[1] * octagloss_lights[probe].harmonics[1]
        + b[2] * octagloss_lights[probe].harmonics[2]
        + b[3] * octagloss_lights[probe].harmonics[3];
    orders.others[1] = b[4] * octagloss_lights[probe].harmonics[4]
        + b[5] * octagloss_lights[probe].harmonics[5]
        + b[6] * octagloss_lights[probe].harmonics[6]
        + b[7] * octagloss_lights[probe].harmonics[7]
        + b[8] * octagloss_lights[probe].harmonics[8];
    orders.others[2] = b[9] * octagloss_lights[probe].harmonics[9]
        + b[10] * octagloss_lights[probe].harmonics[10]
        + b[11] * octagloss_lights[probe].harmonics[11]
        + b[12] * octagloss_lights[probe].harmonics[12]
        + b[13] * octagloss_lights[probe].harmonics[13]
        + b[14] * octagloss_lights[probe].harmonics[14]
        + b[15] * octagloss_lights[probe].harmonics[15];
    orders.others[3] = b[16] * octagloss_lights[probe].harmonics[16]
        + b[17] * octagloss_lights[probe].harmonics[17]
        + b[18] * octagloss_lights[probe].harmonics[18]
        + b[19] * octagloss_lights[probe].harmonics[19]
        + b[20] * octagloss_lights[probe].harmonics[20]
        + b[21] * octagloss_lights[probe].harmonics[21]
        + b[22] * octagloss_lights[probe].harmonics[22]
        + b[23] * octagloss_lights[probe].harmonics[23]
        + b[24] * octagloss_lights[probe].harmonics[24];
    return orders;
}

// The equivalent point of the fundamental triangle, and the symmetry that maps to it: `triangle_from_oct` of
// src/realtime/tables/triangle.rs.
struct Folded {
    point: vec2<f32>,
    signs: vec2<f32>,
    swapped: bool,
    reflected: bool,
}

fn triangle_from_oct(uv: vec2<f32>) -> Folded {
    let signs = select(vec2<f32>(-1.0), vec2<f32>(1.0), uv >= vec2<f32>(0.0));
    var point = abs(uv);
    let swapped = point.y > point.x;
    point = select(point, point.yx, swapped);
    let reflected = point.x + point.y > 1.0;
    point = select(point, 1.0 - point.yx, reflected);
    return Folded(point, signs, swapped, reflected);
}

fn oct_from_triangle(folded: Folded, offset: vec2<f32>) -> vec2<f32> {
    let unreflected = select(offset, -offset.yx, folded.reflected);
    return select(unreflected, unreflected.yx, folded.swapped) * folded.signs;
}

// The six sets of parameters to interpolate for a lobe: three nodes at two knots.
struct Place {
    // First row of each set.
    lower: vec3<u32>,
    upper: vec3<u32>,
    shares: vec3<f32>,
    // Share of the upper knot.
    along: f32,
}

fn triangle_node(i: u32, j: u32) -> u32 {
    return i * (i + 1u) / 2u + j;
}

// Column and row of a point of the triangle on the grid of `model`: `Grid::coordinates` of
// src/realtime/tables/triangle.rs.
fn grid_from_triangle(model: u32, point: vec2<f32>) -> vec2<f32> {
    let most = f32(octagloss_octaves.models[model].intervals);
    var at = vec2<f32>(point.x + point.y, point.x - point.y) * most;
    if model == 1u {
        let square = vec2<f32>(1.0 - point.x + point.y, 1.0 - point.x - point.y) * (most * most / CONE_REACH);
        at = square / sqrt(max(square.x, 1.0));
    }
    return clamp(at, vec2<f32>(0.0), vec2<f32>(most));
}

fn parameters_around(model: u32, octave: u32, log_alpha: f32, point: vec2<f32>) -> Place {
    let own = octagloss_octaves.models[model];
    let at = grid_from_triangle(model, point);
    let i = min(u32(at.x), own.intervals - 1u);
    let j = min(min(u32(at.y), own.intervals - 1u), i);
    let dp = at.x - f32(i);
    var dq = at.y - f32(j);
    var nodes = vec3<u32>(triangle_node(i, j), triangle_node(i, j + 1u), triangle_node(i + 1u, j + 1u));
    var shares = vec3<f32>(1.0 - dq, dq - dp, dp);
    if dq <= dp || i == j {
        dq = min(dq, dp);
        nodes.y = triangle_node(i + 1u, j);
        shares = vec3<f32>(1.0 - dp, dp - dq, dq);
    }
    let knots = clamp((log_alpha + f32(octave) - FIRST_KNOT) / KNOT_STEP, 0.0, f32(KNOTS - 1u));
    let knot = min(u32(knots), KNOTS - 2u);
    let rows = own.boxes + 1u;
    let layer = triangle_node(own.intervals + 1u, 0u);
    let lower = ((octave - FIRST_OCTAVE) * KNOTS + knot) * layer;
    return Place(
        (nodes + lower) * rows + own.first_parameters,
        (nodes + lower + layer) * rows + own.first_parameters,
        shares, knots - f32(knot));
}

// Five parameters, half floats in the buffer.
struct Parameters {
    first: vec4<f32>,
    last: f32,
}

fn add_parameters(sum: Parameters, share: f32, row: u32) -> Parameters {
    let halves = octagloss_parameters[row];
    let own = vec4<f32>(unpack2x16float(halves.x), unpack2x16float(halves.y));
    return Parameters(sum.first + share * own, sum.last + share * unpack2x16float(halves.z).x);
}

// Interpolates row `row` of the parameters at `place`.
fn parameters_of(place: Place, row: u32) -> Parameters {
    let lower = place.shares * (1.0 - place.along);
    let upper = place.shares * place.along;
    var sum = add_parameters(Parameters(), lower.x, place.lower.x + row);
    sum = add_parameters(sum, lower.y, place.lower.y + row);
    sum = add_parameters(sum, lower.z, place.lower.z + row);
    sum = add_parameters(sum, upper.x, place.upper.x + row);
    sum = add_parameters(sum, upper.y, place.upper.y + row);
    return add_parameters(sum, upper.z, place.upper.z + row);
}

// Differences of four consecutive entries of a row.
struct Strip {
    first: Sum,
    middle: Sum,
    last: Sum,
}

// Reads `octave`'s entries of one row at the columns of `edges`, from the corner of the bordered square.
fn strip(row: u32, edges: vec4<i32>) -> Strip {
    let at = vec4<u32>(edges) + row;
    let a = octagloss_entries[at.x];
    let b = octagloss_entries[at.y];
    let c = octagloss_entries[at.z];
    let d = octagloss_entries[at.w];
    return Strip(subtract_sums(b, a), subtract_sums(c, b), subtract_sums(d, c));
}

// Sum between two strips, with columns weighted by `shares`.
fn between(upper: Strip, lower: Strip, shares: vec3<f32>) -> vec4<f32> {
    return shares.x * floats_from_sum(subtract_sums(lower.first, upper.first))
        + shares.y * floats_from_sum(subtract_sums(lower.middle, upper.middle))
        + shares.z * floats_from_sum(subtract_sums(lower.last, upper.last));
}

// Sum of the texels of the blurred square below (x, y).
fn blurred_prefix(octave: OctaglossOctave, x: i32, y: i32) -> Sum {
    let corner = octave.first_entry + OCTAVE_BORDER * (octave.side + 1u);
    let right = corner + u32(x);
    let down = u32(y) * octave.side;
    return corners(
        octagloss_entries[corner], octagloss_entries[right], octagloss_entries[corner + down],
        octagloss_entries[right + down]);
}

// Strip of the unfolded plane below `y`, for boxes that leave the border.
fn unfolded_strip(octave: OctaglossOctave, y: i32, edges: vec4<i32>) -> Strip {
    let n = octave.coarse;
    var columns = edges;
    var entries: array<Sum, 4>;
    for (var i = 0u; i < 4u; i++) {
        let at = vec2<i32>(columns[i], y);
        var ends = prefix_ends(n, at);
        var prefixes: array<Sum, 6>;
        for (var k = 0u; k < 6u; k++) {
            prefixes[k] = blurred_prefix(octave, ends[k].x, ends[k].y);
        }
        entries[i] = unfolded_prefix(n, at, prefixes);
    }
    return Strip(
        subtract_sums(entries[1], entries[0]), subtract_sums(entries[2], entries[1]),
        subtract_sums(entries[3], entries[2]));
}

// Energies and solid angle of a box over the blurred square of `octave`, in its texels. Sixteen entries
// around the corners make nine boxes, each non-negative and exact, weighted by the share of their texels
// inside.
fn soft_box(octave: OctaglossOctave, low: vec2<f32>, high: vec2<f32>) -> vec4<f32> {
    let columns = fractional_spans(low.x, high.x);
    var rows = fractional_spans(low.y, high.y);
    let border = i32(OCTAVE_BORDER);
    let most = i32(octave.coarse) + border;
    let inside = min(columns.edges.x, rows.edges.x) >= -border && max(columns.edges.w, rows.edges.w) <= most;
    if inside {
        let edges = columns.edges + border;
        let lines = vec4<u32>(rows.edges + border) * octave.side + octave.first_entry;
        let first = strip(lines.x, edges);
        let second = strip(lines.y, edges);
        let third = strip(lines.z, edges);
        let fourth = strip(lines.w, edges);
        return rows.shares.x * between(first, second, columns.shares)
            + rows.shares.y * between(second, third, columns.shares)
            + rows.shares.z * between(third, fourth, columns.shares);
    }
    var upper = unfolded_strip(octave, rows.edges.x, columns.edges);
    var sum = vec4<f32>();
    for (var j = 0u; j < 3u; j++) {
        let lower = unfolded_strip(octave, rows.edges[j + 1u], columns.edges);
        sum += rows.shares[j] * between(upper, lower, columns.shares);
        upper = lower;
    }
    return sum;
}

// The share of the model around cone points in a lobe of `alpha` around the unit vector `direction`.
fn cone_share(direction: vec3<f32>, alpha: f32) -> f32 {
    if octagloss_octaves.models[1].boxes == 0u {
        return 0.0;
    }
    let square = direction * direction;
    let far = smoothstep(CONE_FROM, CONE_UNTIL, square.y + min(square.x, square.z));
    return (1.0 - far) * smoothstep(CONE_SHARP, CONE_ROUGH, alpha);
}

// Energies and solid angle of the lobe around `uv`, with the parameters of `model` and `octave`.
fn soft_boxes(
    probe: u32, model: u32, octave: u32, alpha: f32, uv: vec2<f32>, orders: Orders) -> vec4<f32> {
    let folded = triangle_from_oct(uv);
    let density = solid_angle_density(uv);
    let place = parameters_around(model, octave, log2(alpha), folded.point);
    let boxes = octagloss_octaves.models[model].boxes;
    var sum = vec4<f32>();
    for (var b = 0u; b < boxes; b++) {
        let own = parameters_of(place, b);
        let wider = select(0u, 1u, b >= octagloss_octaves.models[model].first_wider);
        var table = octagloss_octaves.octaves[octave - wider - 1u];
        table.first_entry += probe * octagloss_octaves.entries;
        let scale = 0.5 * f32(table.coarse);
        // Square root of the mass; centre in half-widths; log2 of half-widths in units of alpha.
        let half = exp2(vec2<f32>(own.first.w, own.last)) * alpha;
        let centre = uv + oct_from_triangle(folded, own.first.yz * half);
        let extent = abs(oct_from_triangle(folded, half));
        let energy = soft_box(table, (centre - extent + 1.0) * scale, (centre + extent + 1.0) * scale);
        let height = own.first.x * own.first.x / (4.0 * extent.x * extent.y * density);
        sum += height * UNIT * energy;
    }
    let weights = parameters_of(place, boxes);
    let others = vec4<f32>(weights.first.yzw, weights.last);
    return sum + weights.first.x * orders.first + orders.others * others;
}

// Convolution weights of harmonics of order 1 to 4, for a roughness of at least HARMONICS_FROM.
fn zonal_weights(roughness: f32) -> vec4<f32> {
    let t = (2.0 * roughness - (1.0 + HARMONICS_FROM)) / (1.0 - HARMONICS_FROM);
    var sum = octagloss_octaves.zonal[7];
    for (var k = 6; k >= 0; k--) {
        sum = sum * t + octagloss_octaves.zonal[k];
    }
    return sum;
}

// Radiance of the emitters through a lobe around the unit vector `direction`: `radiance` of
// src/realtime/emitters.rs.
fn emitters_radiance(probe: u32, direction: vec3<f32>, alpha: f32, roughness: f32) -> vec3<f32> {
    var sum = vec3<f32>();
    for (var k = 0u; k < EMITTERS; k++) {
        let emitter = octagloss_lights[probe].emitters[k];
        let apart = direction - emitter.direction;
        let s = 0.25 * dot(apart, apart);
        let widened = min(alpha * alpha + 0.5 * emitter.spread, 1.0);
        let denominator = s + widened * (1.0 - s);
        sum += emitter.energy * (widened * max(1.0 - 2.0 * s, 0.0) / (denominator * denominator));
    }
    let t = (2.0 * roughness - (1.0 + PEAK_FROM)) / (1.0 - PEAK_FROM);
    var peak = 0.0;
    for (var k = 2; k >= 0; k--) {
        let four = octagloss_octaves.peak[k];
        peak = (((peak * t + four.w) * t + four.z) * t + four.y) * t + four.x;
    }
    return sum * peak;
}

// Radiance of the OEM, bilinear between texel centres.
fn mirror_radiance(probe: u32, uv: vec2<f32>) -> vec3<f32> {
    let n = octagloss_octaves.inner;
    let scale = 0.5 * f32(n);
    let at = (uv + 1.0) * scale - 0.5;
    let low = floor(at);
    let share = at - low;
    let texel = vec2<i32>(low);
    let least = octagloss_lights[probe].least.rgb;
    var above = vec3<f32>();
    for (var k = 0; k < 4; k++) {
        let corner = vec2<i32>(k & 1, k >> 1u);
        let energy = textureLoad(octagloss_oems, wrap_texel(n, texel + corner), probe, 0);
        let shares = select(1.0 - share, share, corner == vec2<i32>(1));
        above += shares.x * shares.y * (energy.rgb - least * energy.a);
    }
    return least + above * (scale * scale / solid_angle_density(uv));
}

// Clamps to the least radiance: no lobe is darker than the darkest texel, but harmonics ring and turn
// negative opposite a sun.
fn radiance_from_energy(probe: u32, energy: vec4<f32>) -> vec3<f32> {
    let quotient = energy.rgb / energy.a;
    let radiance = quotient * octagloss_lights[probe].scale[0].rgb * octagloss_lights[probe].scale[1].rgb;
    return max(radiance, octagloss_lights[probe].least.rgb);
}

// Radiance of a GGX reflection around `direction` (any length but zero) at `roughness` in [0, 1].
fn octagloss_fitted(direction: vec3<f32>, roughness: f32) -> vec3<f32> {
    return fitted_of(0u, direction, roughness);
}

// The same in the environment `probe`.
fn fitted_of(probe: u32, direction: vec3<f32>, roughness: f32) -> vec3<f32> {
    let uv = oct_from_direction(direction);
    let finest = octagloss_octaves.finest;
    let sharpest = octagloss_octaves.sharpest;
    // Approximate a sharper lobe by the sharpest one blended with a mirror.
    let sharpness = min(roughness * roughness / sharpest, 1.0);
    let share = sharpness * sharpness * (2.0 - sharpness * sharpness);
    let alpha = max(roughness * roughness, sharpest);
    let rough = sqrt(alpha);
    let alone = smoothstep(HARMONICS_FROM, HARMONICS_ALONE, rough);
    var radiance = vec3<f32>();
    if share > 0.0 {
        let towards = normalize(direction);
        let orders = orders_around(probe, towards);
        if alone < 1.0 {
            let log_alpha = log2(alpha);
            let own = u32(clamp(i32(ceil(FIRST_KNOT - log_alpha)), i32(FIRST_OCTAVE), i32(finest)));
            // In the first quarter of an octave, blend out the next finer one.
            let position = log_alpha + f32(own) - FIRST_KNOT;
            let finer = select(0.0, 1.0 - smoothstep(0.0, OVERLAP, position), own < finest);
            let cone = cone_share(towards, alpha);
            for (var part = 0u; part < 4u; part++) {
                let model = part >> 1u;
                let step = part & 1u;
                let weight = select(1.0 - finer, finer, step == 1u) * select(1.0 - cone, cone, model == 1u);
                if weight > 0.0 {
                    let energy = soft_boxes(probe, model, own + step, alpha, uv, orders);
                    radiance += weight * radiance_from_energy(probe, energy);
                }
            }
            radiance *= 1.0 - alone;
        }
        if alone > 0.0 {
            let energy = orders.first + orders.others * zonal_weights(rough);
            radiance += alone * radiance_from_energy(probe, energy);
        }
        radiance += emitters_radiance(probe, towards, alpha, rough);
        radiance *= share;
    }
    if share < 1.0 {
        radiance += (1.0 - share) * mirror_radiance(probe, uv);
    }
    return radiance;
}
