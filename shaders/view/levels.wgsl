// The viewer by a prefiltered cube chain, as engines have it: trilinear between levels of roughness 0 to 1.
@group(1) @binding(0) var levels: texture_cube<f32>;
@group(1) @binding(1) var trilinear: sampler;
#include "common/view_draw.wgsl"

fn radiance(direction: vec3<f32>, roughness: f32, pixel: vec2<f32>) -> vec3<f32> {
    return textureSampleLevel(levels, trilinear, direction, roughness * (frame.levels - 1.0)).rgb;
}
