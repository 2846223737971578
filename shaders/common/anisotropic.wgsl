// Reflections of the true BRDF along a tangent: `Pyramid::reflect` of crates/core/src/pyramid/reflect.rs, and
// the row of reads of crates/core/src/pyramid/anisotropic.rs. Fifteen trilinear reads, one bilinear.
#include "common/reflect.wgsl"

const ROW_NODES = vec4<f32>(16.0, 10.0, 8.0, 7.0);
const ROW_MIDDLE = 7u;
// Texels of a node with the weights of reads, and all.
const ROW_PAIRS = 8u;
const ROW_LAYERS = 21u;
// Below them, nodes of sixteen lobes' albedos, of their shares, of means over azimuths and of their shares;
// rows of a block of the first, less 1, and the first columns of shares.
const BLEND_ALBEDO_NODES = vec2<f32>(84.0, 61.0);
const BLEND_SHARE_NODES = vec2<f32>(49.0, 11.0);
const BLEND_MEAN_NODES = vec2<f32>(84.0, 21.0);
const BLEND_RATIO_NODES = 33.0f;
const BLEND_STRIP = 20.0f;
const BLEND_SHARES_AT = 252.0f;
const BLEND_RATIOS_AT = 302.0f;
// Texels of the table.
const ROW_SIZE = vec3<f32>(336.0, 91.0, 8.0);
const ROW_SHARP = 0.001f;
const NARROWEST = 0.05f;
const BLEND = 0.1f;
const TILTED = 0.5f;
const SKEWED = 0.2f;

// Alpha along the tangent and across it.
fn row_alphas(roughness: f32, anisotropy: f32) -> vec2<f32> {
    let alpha = roughness * roughness;
    return vec2<f32>(alpha + (1.0 - alpha) * anisotropy * anisotropy, alpha);
}

// The share of the row in a reflection; the rest is isotropic.
fn row_share(alpha: vec2<f32>) -> f32 {
    return smoothstep(0.0, 1.0, (alpha.x - alpha.y) / (BLEND * max(alpha.y, 1e-6)));
}

// The place of `alpha`, n.v of `cosine` and a unit `tangent` along the plane of incidence and across it,
// between the first node and the last of each axis.
fn row_places(alpha: vec2<f32>, cosine: f32, tangent: vec2<f32>) -> vec4<f32> {
    let sharp = max(alpha.y, ROW_SHARP);
    let azimuth = atan2(abs(tangent.y), abs(tangent.x)) * 0.636619772;
    let places = vec4<f32>(
        // 1 / log2(6).
        log2(1.0 + 5.0 * sqrt(alpha.y)) * 0.386852807,
        sqrt(cosine),
        1.0 - pow(max(1.0 - azimuth, 0.0), 0.666666667),
        log2(max(alpha.x, sharp) / sharp) / -log2(min(sharp, 0.999999)));
    return clamp(places, vec4<f32>(), vec4<f32>(1.0));
}

// Where the table is read: coordinates of the first texel of nodes at the lower of two anisotropies, how far
// the upper is, and its share.
struct RowPlace {
    at: vec3<f32>,
    share: f32,
}

// The place of the arguments of row_places.
fn row_place(alpha: vec2<f32>, cosine: f32, tangent: vec2<f32>) -> RowPlace {
    let place = row_places(alpha, cosine, tangent) * (ROW_NODES - 1.0);
    let lower = min(floor(place.w), ROW_NODES.w - 2.0);
    // Coordinates have eight bits between texels, and what lies beside a node may be of another kind.
    let inset = 1.0 / 256.0;
    let inside = clamp(place.xy, vec2<f32>(inset), ROW_NODES.xy - 1.0 - inset);
    let texel = vec3<f32>(inside.x, inside.y + ROW_NODES.y * lower, place.z) + 0.5;
    return RowPlace(texel / ROW_SIZE, place.w - lower);
}

// A texel of the node at `place`.
fn row_node(layer: u32, place: RowPlace) -> vec4<f32> {
    let at = vec3<f32>(place.at.x + f32(layer) / f32(ROW_LAYERS), place.at.yz);
    return mix(read_rows(at), read_rows(vec3<f32>(at.x, at.y + ROW_NODES.y / ROW_SIZE.y, at.z)), place.share);
}

// Coordinates of a place between some nodes of the albedo, the first of them in `column`, in the first layer.
fn blend_at(place: vec2<f32>, nodes: vec2<f32>, column: f32) -> vec3<f32> {
    // Coordinates have eight bits between texels, and what lies beside nodes may be of another kind.
    let inset = 1.0 / 256.0;
    let inside = clamp(place, vec2<f32>(inset), nodes - 1.0 - inset);
    return (vec3<f32>(column + inside.x, inside.y + ROW_NODES.y * ROW_NODES.w, 0.0) + 0.5) / ROW_SIZE;
}

// The texel some layers below a place.
fn blend_texel(at: vec3<f32>, layer: u32) -> vec4<f32> {
    return read_rows(at + vec3<f32>(0.0, 0.0, f32(layer) / ROW_SIZE.z));
}

// The place between nodes over alpha, in the plane of incidence or along the tangent, and n.v.
fn blend_place(alpha: f32, cosine: f32, nodes: vec2<f32>) -> vec2<f32> {
    // 1 / log2(16), and the fourth root of the least n.v.
    let x = log2(1.0 + 15.0 * sqrt(alpha)) * 0.25;
    let y = (sqrt(sqrt(cosine)) - 0.316227766) / 0.683772234;
    return clamp(vec2<f32>(x, y), vec2<f32>(), vec2<f32>(1.0)) * (nodes - 1.0);
}

// `first` and the blend, by `texels` of `shares`, of what is in twice as many from `blended`, `layer`
// layers below.
fn blend_of(first: vec2<f32>, shares: vec3<f32>, texels: u32, blended: vec3<f32>, layer: u32) -> vec2<f32> {
    var sum = first;
    for (var k = 0u; k < texels; k++) {
        let share = blend_texel(shares, k);
        let two = blend_texel(blended, layer + 2u * k);
        let next = blend_texel(blended, layer + 2u * k + 1u);
        sum += share.x * two.xy + share.y * two.zw + share.z * next.xy + share.w * next.zw;
    }
    return max(sum, vec2<f32>());
}

// Scale and bias of f0 of the lobe with `alpha` along a unit `tangent`, along the plane of incidence and
// across it, and across that: `albedo_along` of crates/core/src/pyramid/anisotropic/blend.rs.
fn blended_albedo(alpha: vec2<f32>, cosine: f32, tangent: vec2<f32>) -> vec2<f32> {
    let squares = alpha * alpha;
    let seen = sqrt(squares.y + (squares.x - squares.y) * tangent * tangent);
    let round = min(alpha.x * alpha.y / max(seen.x * seen.y, 1e-12), 1.0);
    let place = blend_place(seen.x, cosine, BLEND_ALBEDO_NODES);
    let block = min(floor(place.y / BLEND_STRIP), 2.0);
    let size = vec2<f32>(BLEND_ALBEDO_NODES.x, BLEND_STRIP + 1.0);
    let lobes = blend_at(place - vec2<f32>(0.0, BLEND_STRIP * block), size, BLEND_ALBEDO_NODES.x * block);
    let between = vec2<f32>(sqrt(seen.y), round) * (BLEND_SHARE_NODES - 1.0);
    let shares = blend_at(between, BLEND_SHARE_NODES, BLEND_SHARES_AT);
    return blend_of(vec2<f32>(1.0, 0.0), shares, 4u, lobes, 0u);
}

// The same in the mean over the tangent's directions: `mean_albedo` there.
fn blended_mean(alpha: vec2<f32>, cosine: f32) -> vec2<f32> {
    let means = blend_at(blend_place(alpha.x, cosine, BLEND_MEAN_NODES), BLEND_MEAN_NODES, BLEND_SHARES_AT);
    let ratio = sqrt(alpha.y / max(alpha.x, 1e-12)) * (BLEND_RATIO_NODES - 1.0);
    let size = vec2<f32>(BLEND_RATIO_NODES, BLEND_STRIP + 1.0);
    let shares = blend_at(vec2<f32>(ratio, 0.0), size, BLEND_RATIOS_AT);
    return blend_of(round_albedo(cosine, sqrt(alpha.x)), shares, 2u, means, 4u);
}

// A row of reads.
struct Row {
    // Slopes of the half vector along the plane of incidence and across it, of a read of slope 1.
    axis: vec2<f32>,
    // Length of the lobe.
    extent: f32,
    shift: f32,
    // Step, bend, width and growth.
    steps: vec4<f32>,
    alternation: f32,
    // How much of the difference between weights either side of the middle counts.
    skew: f32,
}

// A number of the law.
fn row_number(terms: array<vec4<f32>, 3>, a: vec4<f32>, b: vec4<f32>, c: vec4<f32>) -> f32 {
    return dot(terms[0], a) + dot(terms[1], b) + dot(terms[2], c);
}

// The row of a lobe with `alpha` along `tangent` and across it.
fn row_of(alpha: vec2<f32>, tangent: vec2<f32>, cosine: f32) -> Row {
    let squares = alpha * alpha;
    let difference = squares.x - squares.y;
    let along = squares.y + difference * tangent.x * tangent.x;
    let across = (squares.y + difference * tangent.y * tangent.y) * cosine * cosine;
    let mixed = difference * tangent.x * tangent.y * cosine;
    let apart = 0.5 * (along - across);
    let root = length(vec2<f32>(apart, mixed));
    let greatest = max(0.5 * (along + across) + root, 1e-30);
    var axis = vec2<f32>(1.0, 0.0);
    if root > 0.0 {
        let steep = vec2<f32>(abs(mixed), (root - apart) * select(-1.0, 1.0, mixed >= 0.0));
        axis = normalize(select(steep, vec2<f32>(apart + root, mixed), apart >= 0.0) / root);
    }
    let x = log(max(alpha.x * alpha.y * cosine / greatest, NARROWEST));
    let extent = sqrt(greatest);
    let y = log(1.0 + 6.0 * extent);
    let tilt = axis.x * smoothstep(0.0, TILTED, sqrt(1.0 - cosine * cosine));
    let e = axis.x * tilt;
    let terms = array<vec4<f32>, 3>(
        vec4<f32>(1.0, x, x * x, y),
        vec4<f32>(x * y, y * y, e, e * x),
        vec4<f32>(x * x * x, y * y * y, x * x * y, x * y * y));
    let shift = row_number(
        terms,
        vec4<f32>(-0.550, -0.357, -0.024, -0.112),
        vec4<f32>(-0.155, -0.099, 0.179, -0.206),
        vec4<f32>(-0.040, 0.145, -0.024, -0.063));
    let step = row_number(
        terms,
        vec4<f32>(-0.554, -0.031, 0.533, -0.071),
        vec4<f32>(0.392, 0.140, -0.295, 0.008),
        vec4<f32>(0.133, 0.121, 0.231, 0.259));
    let bend = row_number(
        terms,
        vec4<f32>(-0.215, 0.021, 0.069, -0.271),
        vec4<f32>(0.356, 0.057, -0.463, -0.223),
        vec4<f32>(0.047, 0.086, 0.153, 0.094));
    let width = row_number(
        terms,
        vec4<f32>(0.550, 1.256, -0.003, -0.371),
        vec4<f32>(-0.377, -0.126, -0.001, 0.019),
        vec4<f32>(-0.020, 0.034, -0.066, -0.010));
    let growth = row_number(
        terms,
        vec4<f32>(-0.516, 0.484, 0.150, 0.012),
        vec4<f32>(-0.583, 0.111, -0.020, -0.968),
        vec4<f32>(0.055, -0.352, -0.216, -0.214));
    let uneven = row_number(
        terms,
        vec4<f32>(0.500, 0.259, -0.071, -0.267),
        vec4<f32>(-0.373, -0.066, -0.039, -0.122),
        vec4<f32>(-0.014, -0.027, -0.072, -0.048));
    return Row(
        vec2<f32>(axis.x, axis.y / cosine) * sqrt(2.0 * root),
        extent,
        shift * tilt,
        exp(vec4<f32>(step, bend, width, growth)),
        exp(uneven),
        smoothstep(0.0, SKEWED, axis.x));
}

// Slope along the axis, and level, of a read.
fn row_read(row: Row, read: u32) -> vec2<f32> {
    // Reads are 8 / 14 apart.
    let place = (f32(read) - f32(ROW_MIDDLE)) * 0.571428571 + row.shift;
    let slope = row.steps.z * row.steps.x * sinh(row.steps.y * place) / row.steps.y;
    let wider = select(1.0 / row.alternation, row.alternation, read % 2u == ROW_MIDDLE % 2u);
    let growth = row.steps.w * slope;
    let width = wider * row.steps.z * sqrt(1.0 + growth * growth) * row.extent;
    // The widest level's Gaussian is 0.35 wide, the mirror's 1.8 over its texels.
    let last = last_map();
    let widest = log2(map_inner() * (0.35 / 1.8));
    let octaves = widest + log2(max(width, 1e-9) / 0.35);
    let gaussian = last + (octaves - widest) / LEVEL_OCTAVES;
    let below = max(octaves / (widest - (last - 1.0) * LEVEL_OCTAVES), 0.0);
    return vec2<f32>(slope, select(below, min(gaussian, last), gaussian >= 1.0));
}

// The harmonics around a direction less those around its mirror image behind the plane of incidence, by
// order.
fn orders_aside(probe: u32, surface: SurfaceFrame, across: vec3<f32>, d: vec3<f32>) -> array<vec3<f32>, 5> {
    let level = surface.towards * d.x + surface.normal * d.z;
    let own = harmonic_basis(level + across * d.y);
    let other = harmonic_basis(level - across * d.y);
    let difference = array<f32, 25>(
        own[0] - other[0], own[1] - other[1], own[2] - other[2], own[3] - other[3], own[4] - other[4],
        own[5] - other[5], own[6] - other[6], own[7] - other[7], own[8] - other[8], own[9] - other[9],
        own[10] - other[10], own[11] - other[11], own[12] - other[12], own[13] - other[13],
        own[14] - other[14], own[15] - other[15], own[16] - other[16], own[17] - other[17],
        own[18] - other[18], own[19] - other[19], own[20] - other[20], own[21] - other[21],
        own[22] - other[22], own[23] - other[23], own[24] - other[24]);
    return orders_of(probe, difference);
}

// Harmonics that change sign in the plane of incidence, around four directions, of orders from 1 more than
// their place up. `first` is their first pair of weights.
fn harmonics_aside(
    probe: u32,
    surface: SurfaceFrame,
    across: vec3<f32>,
    place: RowPlace,
    first: vec2<f32>,
) -> mat2x3<f32> {
    let a = orders_aside(probe, surface, across, vec3<f32>(0.462034181, 0.546550727, -0.698431613));
    let b = orders_aside(probe, surface, across, vec3<f32>(0.896618294, 0.386504464, 0.216078536));
    let c = orders_aside(probe, surface, across, vec3<f32>(0.118148049, 0.383575285, 0.915920870));
    let d = orders_aside(probe, surface, across, vec3<f32>(0.140111780, 0.817230125, -0.559020226));
    let p = row_node(ROW_PAIRS + 8u, place);
    let q = row_node(ROW_PAIRS + 9u, place);
    let r = row_node(ROW_PAIRS + 10u, place);
    let s = row_node(ROW_PAIRS + 11u, place);
    return weighed(a[1], first) + weighed(a[2], p.xy) + weighed(a[3], p.zw) + weighed(a[4], q.xy)
        + weighed(b[2], q.zw) + weighed(b[3], r.xy) + weighed(b[4], r.zw) + weighed(c[3], s.xy)
        + weighed(c[4], s.zw) + weighed(d[4], row_node(ROW_PAIRS + 12u, place).xy);
}

// Radiance reflected with `alpha` along `tangent` and across it, where a white world gives `albedo`: the
// tangent along the plane of incidence and across it.
fn reflect_in_row(
    probe: u32,
    surface: SurfaceFrame,
    tangent: vec2<f32>,
    alpha: vec2<f32>,
    albedo: vec2<f32>,
    f0: vec3<f32>,
    f90: f32,
) -> vec3<f32> {
    let n = surface.normal;
    let across = cross(n, surface.towards);
    let v = surface.towards * surface.sine + n * surface.cosine;
    let place = row_place(alpha, surface.cosine, tangent);
    let row = row_of(alpha, tangent, surface.cosine);
    let axis = surface.towards * row.axis.x + across * row.axis.y;
    var sum = mat2x3<f32>();
    var in_mirror = vec2<f32>();
    // What the weights give of a white world: of the harmonics, the first.
    var white = vec2<f32>();
    for (var distance = 0u; distance <= ROW_MIDDLE; distance++) {
        let texel = row_node(distance, place);
        var mean = texel.xy;
        var skew = vec2<f32>();
        if distance == 0u {
            sum += weighed(cosine_light(probe, n), texel.zw);
            white += texel.zw;
        } else {
            mean = 0.5 * (texel.xy + texel.zw);
            skew = 0.5 * row.skew * (texel.xy - texel.zw);
        }
        for (var side = 0u; side < min(distance + 1u, 2u); side++) {
            let weights = select(mean - skew, mean + skew, side == 0u);
            let read = row_read(row, select(ROW_MIDDLE - distance, ROW_MIDDLE + distance, side == 0u));
            let half_vector = normalize(n + read.x * axis);
            let direction = half_vector * (2.0 * dot(v, half_vector)) - v;
            sum += weighed(between_levels(probe, direction, read.y), weights);
            white += weights;
            in_mirror += weights * max(1.0 - read.y, 0.0);
        }
    }
    let pairs = array<vec4<f32>, 8>(
        row_node(ROW_PAIRS, place), row_node(ROW_PAIRS + 1u, place), row_node(ROW_PAIRS + 2u, place),
        row_node(ROW_PAIRS + 3u, place), row_node(ROW_PAIRS + 4u, place), row_node(ROW_PAIRS + 5u, place),
        row_node(ROW_PAIRS + 6u, place), row_node(ROW_PAIRS + 7u, place));
    sum += harmonics_reflected(probe, surface, pairs);
    white += pairs[0].xy;
    // The table is for tangents on one side of the plane of incidence.
    let mirrored = across * select(1.0, -1.0, tangent.x * tangent.y < 0.0);
    sum += harmonics_aside(probe, surface, mirrored, place, pairs[7].zw);
    let shares = albedo / white;
    let lit = lit_of(probe, sum, f0 * shares.x, f90 * shares.y);
    let share = max(1.0 - dot(shares, in_mirror) / (albedo.x + albedo.y), 0.0);
    return lit + share * suns_reflected(probe, surface, tangent, alpha, f0, f90);
}

// Radiance that a surface reflects to a viewer: GGX with Smith's height-correlated masking and Schlick's
// Fresnel term f0 + (f90 - f0) (1 - v.h)^5. `normal` and `view`, towards the viewer, are in world space, of
// any length but zero; `roughness` is in [0, 1]. A view with n.v below 0.01, or from below the surface, is
// turned up to that. `anisotropy`, of KHR_materials_anisotropy, is taken to [0, 1]; of the `tangent`, of any
// length and either sign, counts what is at right angles to the normal. If nothing is, the reflection is
// isotropic.
fn octagloss_reflect(
    normal: vec3<f32>,
    view: vec3<f32>,
    tangent: vec3<f32>,
    roughness: f32,
    anisotropy: f32,
    f0: vec3<f32>,
    f90: f32,
) -> vec3<f32> {
    return octagloss_reflect_of(0u, normal, view, tangent, roughness, anisotropy, f0, f90);
}

// The same in the environment `probe`.
fn octagloss_reflect_of(
    probe: u32,
    normal: vec3<f32>,
    view: vec3<f32>,
    tangent: vec3<f32>,
    roughness: f32,
    anisotropy: f32,
    f0: vec3<f32>,
    f90: f32,
) -> vec3<f32> {
    let surface = surface_of(probe, normal, view);
    // Along the plane of incidence, and across it.
    var level = vec2<f32>();
    if anisotropy > 0.0 && dot(tangent, tangent) > 0.0 {
        let unit = source_from_world(probe, tangent);
        let across = cross(surface.normal, surface.towards);
        level = vec2<f32>(dot(unit, surface.towards), dot(unit, across));
    }
    if dot(level, level) < 1e-10 {
        let albedo = round_albedo(surface.cosine, roughness);
        return reflected_isotropic(probe, surface, roughness, albedo, f0, f90);
    }
    let alpha = row_alphas(roughness, min(anisotropy, 1.0));
    let share = row_share(alpha);
    let unit_level = normalize(level);
    let albedo = blended_albedo(alpha, surface.cosine, unit_level);
    let sum = share * reflect_in_row(probe, surface, unit_level, alpha, albedo, f0, f90);
    if share == 1.0 {
        return sum;
    }
    let round = sqrt(sqrt(alpha.x * alpha.y));
    return sum + (1.0 - share) * reflected_isotropic(probe, surface, round, albedo, f0, f90);
}

// What a surface reflects of a white world, f0 times the first plus f90 times the second: for multiple
// scattering, and for what lies under a clear coat. `cosine` is n.v. With anisotropy it is the mean over the
// tangent's directions.
fn octagloss_albedo(cosine: f32, roughness: f32, anisotropy: f32) -> vec2<f32> {
    if anisotropy <= 0.0 {
        return round_albedo(cosine, roughness);
    }
    return blended_mean(row_alphas(roughness, min(anisotropy, 1.0)), clamp(cosine, LEAST_COSINE, 1.0));
}

// The same along a tangent: `along` is t.v, the tangent of length 1 and at right angles to the normal.
fn octagloss_albedo_along(cosine: f32, along: f32, roughness: f32, anisotropy: f32) -> vec2<f32> {
    if anisotropy <= 0.0 {
        return round_albedo(cosine, roughness);
    }
    let seen = clamp(cosine, LEAST_COSINE, 1.0);
    let x = min(abs(along) / max(sqrt(1.0 - seen * seen), 1e-4), 1.0);
    let alpha = row_alphas(roughness, min(anisotropy, 1.0));
    return blended_albedo(alpha, seen, vec2<f32>(x, sqrt(1.0 - x * x)));
}
