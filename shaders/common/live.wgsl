// An environment that a renderer updates while it runs: `LiveEnvironment` of src/gpu/live.rs. The including
// shader declares the resources of common/fitted.wgsl.
#include "common/fitted.wgsl"

// `direction` in the environment `probe`. As dot products, which begin with `direction`: where a condition
// depends on an expression that begins with a constant place in a stage's fourth uniform buffer, Mesa 22.3's
// llvmpipe crashes, and the second environment of a shader has its light there.
fn source_from_world(probe: u32, direction: vec3<f32>) -> vec3<f32> {
    let axes = octagloss_lights[probe].world_from_source;
    return vec3<f32>(dot(direction, axes[0]), dot(direction, axes[1]), dot(direction, axes[2]));
}

// Radiance of a GGX reflection around `direction` (world space, any length but zero) at `roughness` in
// [0, 1].
fn octagloss_radiance(direction: vec3<f32>, roughness: f32) -> vec3<f32> {
    return octagloss_radiance_of(0u, direction, roughness);
}

// The same in the environment `probe`.
fn octagloss_radiance_of(probe: u32, direction: vec3<f32>, roughness: f32) -> vec3<f32> {
    return fitted_of(probe, source_from_world(probe, direction), roughness);
}

// Irradiance on a surface with `normal` (world space, any length but zero) over pi: the radiance that a white
// diffuse surface reflects. Harmonics up to order 4, off by at most 3.4 % of what all light would give from
// one direction, and point emitters by their cosines.
fn octagloss_irradiance(normal: vec3<f32>) -> vec3<f32> {
    return octagloss_irradiance_of(0u, normal);
}

// The same in the environment `probe`.
fn octagloss_irradiance_of(probe: u32, normal: vec3<f32>) -> vec3<f32> {
    let direction = normalize(source_from_world(probe, normal));
    let orders = orders_around(probe, direction);
    // Factors of orders 1 to 4 under convolution with the cosine lobe (Ramamoorthi and Hanrahan 2001,
    // equation 8, over pi).
    let weights = vec4<f32>(2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0);
    var radiance = radiance_from_energy(probe, orders.first + orders.others * weights);
    for (var k = 0u; k < EMITTERS; k++) {
        let emitter = octagloss_lights[probe].emitters[k];
        // Over pi.
        radiance += emitter.energy * (0.31830987 * max(dot(direction, emitter.direction), 0.0));
    }
    return radiance;
}
