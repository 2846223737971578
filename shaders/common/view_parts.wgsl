// Parts of moving scenes: crates/view/src/scene/uniforms.rs. Group 1 has the tables of all probes.
@group(1) @binding(0) var octagloss_weights: texture_2d<f32>;
@group(1) @binding(1) var<uniform> octagloss_lights: array<OctaglossLight, 64>;
@group(1) @binding(2) var octagloss_maps: texture_2d_array<f32>;
@group(1) @binding(3) var octagloss_linear: sampler;
#include "common/pyramid_maps.wgsl"
#include "common/view_texture.wgsl"

struct SceneCorner {
    // In the space of the part.
    position: vec3<f32>,
    part: u32,
    normal: vec3<f32>,
    // Coordinates of textures: u here, v below.
    u: f32,
    // Albedo of matte parts.
    albedo: vec3<f32>,
    v: f32,
    // Radiance that the surface emits.
    emission: vec3<f32>,
    // Distance to the farthest neighbouring corner along u or v.
    spread: f32,
}

struct ScenePart {
    // Turns and moves, without scale.
    world_from_part: mat4x4<f32>,
    // Reflectance of glossy parts.
    reflectance: vec3<f32>,
    roughness: f32,
    // Factors of albedo and emission.
    base: SceneTexture,
    glow: SceneTexture,
    // The probe of a glossy part or, where it has none, the nearest.
    probe: u32,
    // 1 if that probe is at the part's centre and serves it alone.
    own: u32,
}

// A distant lamp and the light from above and from below.
struct SceneLight {
    // Unit vector to the lamp.
    towards: vec3<f32>,
    // Radiance of a white surface that faces the lamp.
    lamp: vec3<f32>,
    above: vec3<f32>,
    below: vec3<f32>,
}

fn world_position(part: ScenePart, position: vec3<f32>) -> vec3<f32> {
    return (part.world_from_part * vec4<f32>(position, 1.0)).xyz;
}

fn world_normal(part: ScenePart, normal: vec3<f32>) -> vec3<f32> {
    return normalize((part.world_from_part * vec4<f32>(normal, 0.0)).xyz);
}

// Radiance of a white matte surface.
fn matte_light(light: SceneLight, normal: vec3<f32>) -> vec3<f32> {
    let ambient = mix(light.below, light.above, 0.5 + 0.5 * normal.y);
    return ambient + light.lamp * max(dot(normal, light.towards), 0.0);
}
