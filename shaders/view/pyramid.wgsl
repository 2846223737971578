// Viewer pipeline for the real-time tier.
#include "common/pyramid_group.wgsl"
#include "common/view_draw.wgsl"
#include "common/view_split.wgsl"

fn radiance(direction: vec3<f32>, roughness: f32, pixel: vec2<f32>) -> vec3<f32> {
    return octagloss_radiance(direction, roughness);
}
