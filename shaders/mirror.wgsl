// Copies the square of an OEM to one texture, as read by `radiance` of src/cpu/mirror.rs. Planes hold
// energies (radiance times solid angle, float32) and solid angles in steradians.
#include "common/table.wgsl"

const EDGE = 16u;

@group(0) @binding(1) var<storage, read> red: array<f32>;
@group(0) @binding(2) var<storage, read> green: array<f32>;
@group(0) @binding(3) var<storage, read> blue: array<f32>;
@group(0) @binding(4) var<storage, read> solid_angle: array<f32>;
@group(0) @binding(5) var energy: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(EDGE, EDGE)
fn mirror(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < table.inner && id.y < table.inner {
        let at = place_in_plane(id.xy);
        textureStore(energy, id.xy, vec4<f32>(red[at], green[at], blue[at], solid_angle[at]));
    }
}
