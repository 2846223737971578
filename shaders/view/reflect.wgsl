// Viewer pipeline for the true reflection.
@group(1) @binding(4) var octagloss_reflections: texture_2d_array<f32>;
@group(1) @binding(5) var octagloss_rows: texture_3d<f32>;
#include "common/pyramid_group.wgsl"
#include "common/reflect_maps.wgsl"
#include "common/view_draw.wgsl"

fn radiance(direction: vec3<f32>, roughness: f32, pixel: vec2<f32>) -> vec3<f32> {
    return octagloss_radiance(direction, roughness);
}

// Errors are those of what a surface reflects, without its coat and light that is scattered again.
fn judged(found: Sample, pixel: vec2<f32>) -> vec3<f32> {
    if found.surface == 0.0 {
        return radiance(frame.source_from_world * found.direction, found.roughness, pixel);
    }
    return octagloss_reflect(
        frame.source_from_world * found.normal,
        frame.source_from_world * found.view,
        frame.source_from_world * found.finish.tangent,
        found.roughness,
        found.finish.anisotropy,
        found.f0,
        1.0);
}

fn shaded(found: Sample, diffuse: vec3<f32>, pixel: vec2<f32>) -> vec3<f32> {
    if found.surface == 0.0 {
        return radiance(frame.source_from_world * found.direction, found.roughness, pixel) * found.factor;
    }
    let normal = frame.source_from_world * found.normal;
    let view = frame.source_from_world * found.view;
    let tangent = frame.source_from_world * found.finish.tangent;
    let anisotropy = found.finish.anisotropy;
    // Reflections are those of views turned up to this.
    let cosine = max(dot(normal, view), LEAST_COSINE);
    let albedo = octagloss_albedo(cosine, found.roughness, anisotropy);
    // Multiple scattering as in surface_sample.
    let again = 1.0 + found.f0 * (1.0 / (albedo.x + albedo.y) - 1.0);
    let reflected = octagloss_reflect(normal, view, tangent, found.roughness, anisotropy, found.f0, 1.0);
    // A clear coat of refractive index 1.5 takes what it reflects from what is below.
    let coat = octagloss_albedo(cosine, found.finish.coat_roughness, 0.0);
    let taken = found.finish.clearcoat * (0.04 * coat.x + coat.y);
    let coated =
        octagloss_reflect_isotropic(normal, view, found.finish.coat_roughness, vec3<f32>(0.04), 1.0);
    return (reflected * again + diffuse) * (1.0 - taken) + coated * found.finish.clearcoat;
}
