// An environment that a renderer updates while it runs: `LiveEnvironment` of src/gpu/live.rs. The including
// shader declares the resources of common/fitted.wgsl and octagloss_source_from_world: mat3x3<f32> (uniform),
// the rotation of the environment.
#include "common/fitted.wgsl"

// Radiance of a GGX reflection around `direction` (world space, any length but zero) at `roughness` in
// [0, 1].
fn octagloss_radiance(direction: vec3<f32>, roughness: f32) -> vec3<f32> {
    return octagloss_fitted(octagloss_source_from_world * direction, roughness);
}

// Irradiance on a surface with `normal` (world space, any length but zero) over pi: the radiance that a white
// diffuse surface reflects. Harmonics up to order 4, off by at most 3.4 % of what all light would give from
// one direction, and point emitters by their cosines.
fn octagloss_irradiance(normal: vec3<f32>) -> vec3<f32> {
    let direction = normalize(octagloss_source_from_world * normal);
    let orders = orders_around(direction);
    // Factors of orders 1 to 4 under convolution with the cosine lobe (Ramamoorthi and Hanrahan 2001,
    // equation 8, over pi).
    let weights = vec4<f32>(2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0);
    var radiance = radiance_of(orders.first + orders.others * weights);
    for (var k = 0u; k < EMITTERS; k++) {
        let emitter = octagloss_light.emitters[k];
        // Over pi.
        radiance += emitter.energy * (0.31830987 * max(dot(direction, emitter.direction), 0.0));
    }
    return radiance;
}
