// Viewer pipeline for the true reflection.
@group(1) @binding(0) var<uniform> octagloss_pyramid: OctaglossPyramid;
@group(1) @binding(1) var<uniform> octagloss_lights: array<OctaglossLight, 1>;
@group(1) @binding(2) var octagloss_levels: texture_2d_array<f32>;
@group(1) @binding(3) var octagloss_sharp: texture_2d_array<f32>;
@group(1) @binding(4) var octagloss_cosine: texture_2d_array<f32>;
@group(1) @binding(5) var octagloss_linear: sampler;
@group(1) @binding(6) var octagloss_reflections: texture_2d_array<f32>;
@group(1) @binding(7) var octagloss_rows: texture_3d<f32>;
#include "common/reflect_maps.wgsl"
#include "common/view_draw.wgsl"

fn radiance(direction: vec3<f32>, roughness: f32, pixel: vec2<f32>) -> vec3<f32> {
    return octagloss_radiance(direction, roughness);
}

fn glossy(found: Sample, pixel: vec2<f32>) -> vec3<f32> {
    if found.surface == 0.0 {
        return radiance(frame.source_from_world * found.direction, found.roughness, pixel) * found.factor;
    }
    let normal = frame.source_from_world * found.normal;
    let view = frame.source_from_world * found.view;
    let albedo = octagloss_albedo(dot(normal, view), found.roughness, 0.0);
    // Multiple scattering as in surface_sample.
    let again = 1.0 + found.f0 * (1.0 / (albedo.x + albedo.y) - 1.0);
    return octagloss_reflect_isotropic(normal, view, found.roughness, found.f0, 1.0) * again;
}
