// Viewer pipeline for the real-time tier.
@group(1) @binding(0) var octagloss_weights: texture_2d<f32>;
@group(1) @binding(1) var<uniform> octagloss_lights: array<OctaglossLight, 1>;
@group(1) @binding(2) var octagloss_levels: texture_2d_array<f32>;
@group(1) @binding(3) var octagloss_sharp: texture_2d_array<f32>;
@group(1) @binding(4) var octagloss_middles: texture_2d_array<f32>;
@group(1) @binding(5) var octagloss_linear: sampler;
#include "common/pyramid_maps.wgsl"
#include "common/view_draw.wgsl"
#include "common/view_split.wgsl"

fn radiance(direction: vec3<f32>, roughness: f32, pixel: vec2<f32>) -> vec3<f32> {
    return octagloss_radiance(direction, roughness);
}
