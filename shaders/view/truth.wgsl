// Viewer pipeline for precomputed radiance, one answer per pixel.
#include "common/view_draw.wgsl"
#include "common/view_split.wgsl"

fn radiance(direction: vec3<f32>, roughness: f32, pixel: vec2<f32>) -> vec3<f32> {
    return textureLoad(truth, vec2<i32>(pixel), 0).rgb;
}
