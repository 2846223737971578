// Viewer pipeline for the real-time tier. Entries are 64-bit fixed point, as in src/sat.rs; the texture holds
// energies (radiance times solid angle).
@group(1) @binding(0) var<uniform> octagloss_octaves: OctaglossOctaves;
@group(1) @binding(1) var<uniform> octagloss_lights: array<OctaglossLight, 1>;
@group(1) @binding(2) var<storage, read> octagloss_entries: array<Sum>;
@group(1) @binding(3) var<storage, read> octagloss_parameters: array<vec4<u32>>;
@group(1) @binding(4) var octagloss_oems: texture_2d_array<f32>;
#include "common/fitted.wgsl"
#include "common/view_draw.wgsl"

fn radiance(direction: vec3<f32>, roughness: f32, pixel: vec2<f32>) -> vec3<f32> {
    return octagloss_fitted(direction, roughness);
}
