// Isotropic reflections of the true BRDF out of a pyramid: `Pyramid::isotropic` of
// crates/core/src/pyramid/reflect.rs. Ten trilinear reads, or nine and a bilinear one.
#include "common/pyramid.wgsl"

const READS = 10u;
// Texels of a node.
const LAYERS = 18u;
// Roughness from which on the cosine level is read in place of the last read.
const COSINE_FROM = 0.435f;
const NODES = vec2<f32>(46.0, 26.0);
const LEAST_COSINE = 0.01f;

// The table of crates/core/src/pyramid/albedo.rs, and the dip that it leaves out.
const ALBEDO_NODES = vec2<f32>(91.0, 75.0);
const DIP = vec4<f32>(0.222, 0.634, 0.098, 0.3126);
const LEAST_ALPHA = 1e-6f;

// A layer of the table of crates/core/src/pyramid/reads.rs at `roughness` and n.v of `cosine`.
fn reflection_node(layer: u32, roughness: f32, cosine: f32) -> vec4<f32> {
    // 1 / log2(11). The fourth root of 1 less the sine, without cancellation.
    let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    let place = vec2<f32>(log2(1.0 + 10.0 * roughness) * 0.289064826, sqrt(cosine * inverseSqrt(1.0 + sine)));
    let at = (place * (NODES - 1.0) + 0.5) / NODES;
    return read_reflections(layer, at);
}

// What an isotropic surface reflects of a white world, scale and bias of f0; `cosine` is n.v: `albedo_at` of
// crates/core/src/pyramid/albedo.rs.
fn round_albedo(cosine: f32, roughness: f32) -> vec2<f32> {
    let seen = clamp(cosine, 1e-4, 1.0);
    // 1 / log2(31).
    let places = vec2<f32>(log2(1.0 + 30.0 * roughness) * 0.201848706, (sqrt(sqrt(seen)) - 0.1) / 0.9);
    let place = clamp(places, vec2<f32>(), vec2<f32>(1.0)) * (ALBEDO_NODES - 1.0);
    let node = min(floor(place), ALBEDO_NODES - 2.0);
    let share = place - node;
    let first = u32(node.x + ALBEDO_NODES.x * node.y);
    // Texels have a node and its neighbour over roughness.
    let pair = mix(read_albedo(first), read_albedo(first + u32(ALBEDO_NODES.x)), share.y);
    let t = seen / max(roughness * roughness, LEAST_ALPHA);
    let left = 1.0 - DIP.x * t / (1.0 + t * (DIP.y + t * (DIP.z + t * DIP.w)));
    return left * mix(pair.xy, pair.zw, share.x);
}

// A surface that is looked at, in the map's space.
struct SurfaceFrame {
    normal: vec3<f32>,
    // Unit vector in the surface under the view.
    towards: vec3<f32>,
    // n.v, and its sine.
    cosine: f32,
    sine: f32,
}

// Light around the unit vector `direction` between two levels: 0 the mirror, 1 the sharp one.
fn between_levels(probe: u32, direction: vec3<f32>, level: f32) -> vec3<f32> {
    let at = place_of(direction);
    let finer = u32(level);
    let share = fract(level);
    // The last level has none above.
    let coarser = select(finer, finer + 1u, share > 0.0);
    return mix(read_map(probe, at, finer), read_map(probe, at, coarser), share);
}

// Smith's S.
fn masking_of(w: vec3<f32>, alpha: vec2<f32>) -> f32 {
    return length(vec3<f32>(alpha * w.xy, w.z));
}

// GGX with Smith's height-correlated masking, and (1 - v.h)^5, of a sun of `spread`: `Brdf::around` of
// crates/core/src/pyramid/brdf.rs. In axes of the surface with its normal z.
fn brdf_around(view: vec3<f32>, light: vec3<f32>, alpha: vec2<f32>, spread: f32) -> vec2<f32> {
    let radius = sqrt(2.0 * spread);
    if light.z <= -radius {
        return vec2<f32>();
    }
    let left = min(0.5 * (light.z + radius) / max(radius, 1e-9), 1.0);
    let l = normalize(vec3<f32>(light.xy, max(light.z, left * radius)));
    let above = spread * left * left;
    let middle = view + (1.0 - above) * l;
    let length2 = dot(middle, middle);
    let h = middle * inverseSqrt(length2);
    let shape = vec3<f32>(alpha.y / alpha.x, alpha.x / alpha.y, alpha.x * alpha.y);
    let bent = shape * h;
    let bend = dot(h, bent);
    let along = dot(h, l);
    // The cone of half vectors, and the root of its cubic.
    let size = above * (2.0 - above) / (length2 * bend);
    let trace = size * dot(shape, 1.0 - l * l);
    let aside = trace - size * squared(cross(l, bent)) / bend;
    let masking = masking_of(l, alpha);
    let determinant = size * size * masking * masking;
    let near = shape.z * along * along / (bend * masking * masking);
    let last = determinant * near;
    let linear = 1.0 - trace;
    var x = max(0.5 * (linear + sqrt(linear * linear + 4.0 * trace * near)), near);
    var side = 0.0;
    var slope = 1.0;
    for (var step = 0u; step < 3u; step++) {
        x += side * (side - ((x + trace) * x + determinant) * x) / slope;
        side = (x + aside) * x + last;
        slope = (((x + 2.0 * aside) * x + 3.0 * last + trace * aside - determinant) * x
            + 2.0 * trace * last) * x + determinant * last;
    }
    let inverse = 1.0 / (size * shape + x);
    let towards = size * dot(l, inverse * bent) / (x * dot(l, inverse * l));
    let axis = normalize(inverse * (h + towards * l));
    let cosine = dot(view, axis);
    let lit = 2.0 * cosine * axis - view;
    let facing = max(lit.z, 0.0);
    let lobe = sqrt(side / (x * slope * bend * dot(axis, shape * axis))) * shape.z / (3.14159265 * bend);
    let share = pow(left, 1.25) * (1.0 - 0.5 * above);
    let visible = facing / (facing * masking_of(view, alpha) + view.z * masking_of(lit, alpha));
    return vec2<f32>(share * 2.0 * along * cosine / length2 * lobe * visible, fresnel_of(cosine));
}

// (1 - v.h)^5.
fn fresnel_of(cosine: f32) -> f32 {
    let rest = max(1.0 - cosine, 0.0);
    return rest * rest * rest * rest * rest;
}

// The cosine level around the unit vector `n`.
fn cosine_light(probe: u32, n: vec3<f32>) -> vec3<f32> {
    return read_cosine(probe, place_of(n));
}

// What f0 and f90 multiply, of `light` with these weights.
fn weighed(light: vec3<f32>, weights: vec2<f32>) -> mat2x3<f32> {
    return mat2x3<f32>(light * weights.x, light * weights.y);
}

// Harmonics around five directions in the plane of incidence, of orders from their place up: `pairs` are
// weights for f0 and f90, two in a texel.
fn harmonics_reflected(probe: u32, surface: SurfaceFrame, pairs: array<vec4<f32>, 8>) -> mat2x3<f32> {
    let n = surface.normal;
    let t = surface.towards;
    let a = orders_of(probe, harmonic_basis(n));
    let b = orders_of(probe, harmonic_basis(n * 0.309016994 + t * 0.951056516));
    let c = orders_of(probe, harmonic_basis(n * -0.809016994 + t * 0.587785252));
    let d = orders_of(probe, harmonic_basis(n * 0.809016994 + t * 0.587785252));
    let e = orders_of(probe, harmonic_basis(n * -0.309016994 + t * 0.951056516));
    return weighed(a[0], pairs[0].xy) + weighed(a[1], pairs[0].zw) + weighed(a[2], pairs[1].xy)
        + weighed(a[3], pairs[1].zw) + weighed(a[4], pairs[2].xy) + weighed(b[1], pairs[2].zw)
        + weighed(b[2], pairs[3].xy) + weighed(b[3], pairs[3].zw) + weighed(b[4], pairs[4].xy)
        + weighed(c[2], pairs[4].zw) + weighed(c[3], pairs[5].xy) + weighed(c[4], pairs[5].zw)
        + weighed(d[3], pairs[6].xy) + weighed(d[4], pairs[6].zw) + weighed(e[4], pairs[7].xy);
}

// The suns, with `alpha` along `tangent` and across it: the tangent along the plane of incidence and across
// it.
fn suns_reflected(
    probe: u32,
    surface: SurfaceFrame,
    tangent: vec2<f32>,
    alpha: vec2<f32>,
    f0: vec3<f32>,
    f90: f32,
) -> vec3<f32> {
    let across = cross(surface.normal, surface.towards);
    let x = surface.towards * tangent.x + across * tangent.y;
    let y = across * tangent.x - surface.towards * tangent.y;
    let view = vec3<f32>(surface.sine * tangent.x, -surface.sine * tangent.y, surface.cosine);
    let wide = max(alpha, vec2<f32>(0.9 / map_inner()));
    var sum = vec3<f32>();
    for (var disc = 0u; disc < 2u * SUNS; disc++) {
        let sun = octagloss_lights[probe].suns[disc / 2u];
        let half_axis = half_axis_of(probe, disc);
        let nearer = 1.0 - 0.5 * squared(half_axis);
        for (var c = 0u; c < 3u; c++) {
            let own = vec3<u32>(c) == vec3<u32>(0u, 1u, 2u);
            let channel = select(select(sun.blue, sun.green, own.y), sun.red, own.x);
            let to = nearer * channel.xyz + half_axis;
            let light = vec3<f32>(dot(to, x), dot(to, y), dot(to, surface.normal));
            let value = brdf_around(view, light, wide, channel.w);
            // A disc has half of the light.
            let reflected = 0.5 * sun.energy * value.x * (f0 + (f90 - f0) * value.y);
            sum += select(vec3<f32>(), reflected, own);
        }
    }
    return sum;
}

// What weights that sum to `sums` are multiplied by, to sum to `albedo`.
fn albedo_share(albedo: vec2<f32>, sums: vec2<f32>) -> vec2<f32> {
    // Where nothing is reflected, shares mean nothing.
    return (albedo + 1e-4) / (max(sums, vec2<f32>()) + 1e-4);
}

// Radiance of what f0 and f90 multiply.
fn lit_of(probe: u32, sum: mat2x3<f32>, f0: vec3<f32>, f90: f32) -> vec3<f32> {
    return max(f0 * sum[0] + f90 * sum[1], vec3<f32>()) * octagloss_lights[probe].unscale;
}

// Radiance reflected without a tangent, where a white world gives `albedo`.
fn reflected_isotropic(
    probe: u32,
    surface: SurfaceFrame,
    roughness: f32,
    albedo: vec2<f32>,
    f0: vec3<f32>,
    f90: f32,
) -> vec3<f32> {
    let n = surface.normal;
    let cosine = surface.cosine;
    // Offsets of reads have the length of its sine, so that nothing turns there.
    let along = surface.towards * surface.sine;
    let v = along + n * cosine;
    let pairs = array<vec4<f32>, 8>(
        reflection_node(READS, roughness, cosine), reflection_node(READS + 1u, roughness, cosine),
        reflection_node(READS + 2u, roughness, cosine), reflection_node(READS + 3u, roughness, cosine),
        reflection_node(READS + 4u, roughness, cosine), reflection_node(READS + 5u, roughness, cosine),
        reflection_node(READS + 6u, roughness, cosine), reflection_node(READS + 7u, roughness, cosine));
    var sum = harmonics_reflected(probe, surface, pairs);
    // What the weights give of a white world: of the harmonics, the first.
    var white = pairs[0].xy + pairs[7].zw;
    var reads = READS;
    if roughness > COSINE_FROM {
        sum += weighed(cosine_light(probe, n), pairs[7].zw);
        reads -= 1u;
    }
    var in_mirror = 0.0;
    for (var k = 0u; k < reads; k++) {
        // Slope, level, weights of f0 and f90.
        let read = reflection_node(k, roughness, cosine);
        let half_vector = normalize(n + read.x * along);
        let direction = half_vector * (2.0 * dot(v, half_vector)) - v;
        sum += weighed(between_levels(probe, direction, read.y), read.zw);
        white += read.zw;
        in_mirror += (read.z + read.w) * max(1.0 - read.y, 0.0);
    }
    let shares = albedo_share(albedo, white);
    let lit = lit_of(probe, sum, f0 * shares.x, f90 * shares.y);
    let share = max(1.0 - in_mirror / (white.x + white.y), 0.0);
    let alpha = vec2<f32>(roughness * roughness);
    return lit + share * suns_reflected(probe, surface, vec2<f32>(1.0, 0.0), alpha, f0, f90);
}

// The surface with `normal` under a viewer in the direction `view`, both in world space.
fn surface_of(probe: u32, normal: vec3<f32>, view: vec3<f32>) -> SurfaceFrame {
    let n = source_from_world(probe, normal);
    let seen = source_from_world(probe, view);
    let cosine = clamp(dot(n, seen), LEAST_COSINE, 1.0);
    // The view without its part along the normal, or any direction in the surface where that vanishes.
    var level_view = seen - n * dot(n, seen);
    if dot(level_view, level_view) < 1e-10 {
        level_view = select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), abs(n.x) > 0.5);
    }
    let towards = normalize(level_view - n * dot(n, level_view));
    return SurfaceFrame(n, towards, cosine, sqrt(1.0 - cosine * cosine));
}

// Radiance that a surface reflects to a viewer: GGX with Smith's height-correlated masking and Schlick's
// Fresnel term f0 + (f90 - f0) (1 - v.h)^5. `normal` and `view`, towards the viewer, are in world space, of
// any length but zero; `roughness` is in [0, 1]. A view with n.v below 0.01, or from below the surface, is
// turned up to that.
fn octagloss_reflect_isotropic(
    normal: vec3<f32>,
    view: vec3<f32>,
    roughness: f32,
    f0: vec3<f32>,
    f90: f32,
) -> vec3<f32> {
    let surface = surface_of(0u, normal, view);
    return reflected_isotropic(0u, surface, roughness, round_albedo(surface.cosine, roughness), f0, f90);
}
