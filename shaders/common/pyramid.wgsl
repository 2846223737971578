// Glossy reflections of any roughness and irradiance out of a pyramid: `Pyramid` of
// crates/core/src/pyramid/mod.rs. At most five bilinear reads. Maps and table are read by functions at places
// of type MapPlace: those of pyramid_maps.wgsl, pyramid_file.wgsl or pyramid_file_cube.wgsl.
#include "common/harmonics.wgsl"
#include "common/light.wgsl"

const INTERVALS = 860u;

// `direction` in the environment `probe`, as a unit vector. As dot products, which begin with `direction`:
// where a condition depends on an expression that begins with a constant place in a stage's fourth uniform
// buffer, Mesa 22.3's llvmpipe crashes, and the fourth environment of a shader has its light there.
fn source_from_world(probe: u32, direction: vec3<f32>) -> vec3<f32> {
    let axes = octagloss_lights[probe].world_from_source;
    return normalize(vec3<f32>(dot(direction, axes[0]), dot(direction, axes[1]), dot(direction, axes[2])));
}

fn harmonic(probe: u32, k: u32) -> vec3<f32> {
    return octagloss_lights[probe].harmonics[k].xyz;
}

// The sum of the harmonics times `b`, by order. Written out: drivers keep loops, and their arrays in memory.
fn orders_of(probe: u32, b: array<f32, 25>) -> array<vec3<f32>, 5> {
    return array<vec3<f32>, 5>(
        b[0] * harmonic(probe, 0u),
        b[1] * harmonic(probe, 1u) + b[2] * harmonic(probe, 2u) + b[3] * harmonic(probe, 3u),
        b[4] * harmonic(probe, 4u) + b[5] * harmonic(probe, 5u) + b[6] * harmonic(probe, 6u)
            + b[7] * harmonic(probe, 7u) + b[8] * harmonic(probe, 8u),
        b[9] * harmonic(probe, 9u) + b[10] * harmonic(probe, 10u) + b[11] * harmonic(probe, 11u)
            + b[12] * harmonic(probe, 12u) + b[13] * harmonic(probe, 13u) + b[14] * harmonic(probe, 14u)
            + b[15] * harmonic(probe, 15u),
        b[16] * harmonic(probe, 16u) + b[17] * harmonic(probe, 17u) + b[18] * harmonic(probe, 18u)
            + b[19] * harmonic(probe, 19u) + b[20] * harmonic(probe, 20u) + b[21] * harmonic(probe, 21u)
            + b[22] * harmonic(probe, 22u) + b[23] * harmonic(probe, 23u) + b[24] * harmonic(probe, 24u));
}

// Harmonics of radiance around the unit vector `d`, the sum of each order times its weight.
fn harmonics_around(probe: u32, d: vec3<f32>, weights: array<f32, 5>) -> vec3<f32> {
    let orders = orders_of(probe, harmonic_basis(d));
    return weights[0] * orders[0] + weights[1] * orders[1] + weights[2] * orders[2] + weights[3] * orders[3]
        + weights[4] * orders[4];
}

// Radiance of a GGX reflection around `direction` (world space, any length but zero) at `roughness` in
// [0, 1].
fn octagloss_radiance(direction: vec3<f32>, roughness: f32) -> vec3<f32> {
    return octagloss_radiance_of(0u, direction, roughness);
}

// The same in the environment `probe`.
fn octagloss_radiance_of(probe: u32, direction: vec3<f32>, roughness: f32) -> vec3<f32> {
    let d = source_from_world(probe, direction);
    let at = place_of(d);
    // 860 / log2(31).
    let node = log2(1.0 + 30.0 * roughness) * 173.590214;
    let k = min(u32(node), INTERVALS - 1u);
    let share = node - f32(k);
    let low = node_weights(k);
    let high = node_weights(k + 1u);
    let a = mix(low[0], high[0], share);
    let b = mix(low[1], high[1], share);
    let c = mix(low[2], high[2], share);
    let e = mix(low[3], high[3], share);
    let f = mix(low[4], high[4], share);
    var sum = vec3<f32>();
    var maps = array<f32, 10>(a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w, c.x, c.y);
    // Levels that a smaller map does not have weigh nothing.
    for (var map = 0u; map < 10u; map++) {
        if maps[map] != 0.0 {
            sum += maps[map] * read_map(probe, at, map);
        }
    }
    if c.z != 0.0 {
        sum += c.z * read_cosine(probe, at);
    }
    sum += harmonics_around(probe, d, array<f32, 5>(c.w, e.x, e.y, e.z, e.w));
    sum = max(sum, vec3<f32>()) * octagloss_lights[probe].unscale;
    // GGX around the suns: `glossy` of crates/core/src/pyramid/suns.rs.
    // Sharper lobes read the mirror; a sun of one texel is a point there.
    let a2 = max(roughness * roughness * roughness * roughness, 1e-12);
    for (var disc = 0u; disc < 2u * SUNS; disc++) {
        let sun = octagloss_lights[probe].suns[disc / 2u];
        let half_axis = half_axis_of(probe, disc);
        let nearer = 1.0 - 0.5 * squared(half_axis);
        // A quarter of the squared distance, which the cosine does not resolve in single precision.
        let to = d - half_axis;
        let apart = vec3<f32>(
            squared(to - nearer * sun.red.xyz), squared(to - nearer * sun.green.xyz),
            squared(to - nearer * sun.blue.xyz));
        let s = min(0.25 * apart, vec3<f32>(0.5));
        let radius2 = 0.5 * vec3<f32>(sun.red.w, sun.green.w, sun.blue.w);
        let nearness = s + a2 * (1.0 - s) - radius2;
        var lobe = vec3<f32>();
        if all(radius2 < 0.03 * nearness) {
            // Far away the root's series is within .1 %, and most pixels are far from most suns.
            lobe = a2 / (nearness * nearness + 3.0 * a2 * radius2);
        } else {
            let root = max(sqrt(nearness * nearness + 4.0 * a2 * radius2), vec3<f32>(1e-30));
            let outside = 2.0 * a2 / (root * max(root + nearness, vec3<f32>(1e-30)));
            let inside = (root - nearness) / (2.0 * max(radius2, vec3<f32>(1e-30)) * root);
            lobe = select(inside, outside, nearness > vec3<f32>());
        }
        // 1 / (2 pi): a disc has half of the light.
        sum += sun.energy * (lobe * (1.0 - 2.0 * s) * (0.15915494 * f.x * (1.0 - a.x)));
    }
    return sum;
}

fn squared(v: vec3<f32>) -> f32 {
    return dot(v, v);
}

// From a sun's directions to the centre of its disc `disc`: suns have two.
fn half_axis_of(probe: u32, disc: u32) -> vec3<f32> {
    let k = 3u * (disc / 2u);
    let half_axis = vec3<f32>(
        octagloss_lights[probe].harmonics[k].w, octagloss_lights[probe].harmonics[k + 1u].w,
        octagloss_lights[probe].harmonics[k + 2u].w);
    return select(-half_axis, half_axis, disc % 2u == 0u);
}

// Irradiance on a surface with `normal` (world space, any length but zero) over pi: the radiance that a white
// diffuse surface reflects.
fn octagloss_irradiance(normal: vec3<f32>) -> vec3<f32> {
    return octagloss_irradiance_of(0u, normal);
}

// The same in the environment `probe`.
fn octagloss_irradiance_of(probe: u32, normal: vec3<f32>) -> vec3<f32> {
    let d = source_from_world(probe, normal);
    var sum = read_cosine(probe, place_of(d)) * octagloss_lights[probe].unscale;
    for (var k = 0u; k < SUNS; k++) {
        let sun = octagloss_lights[probe].suns[k];
        let facing = vec3<f32>(dot(d, sun.red.xyz), dot(d, sun.green.xyz), dot(d, sun.blue.xyz));
        sum += sun.energy * (0.31830987 * max(facing, vec3<f32>()));
    }
    return sum;
}
