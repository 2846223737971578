// The planes of an OEM that stages read, at bindings 1 to 4: energies (radiance times solid angle, float32)
// and solid angles in steradians.
#include "common/table.wgsl"

@group(0) @binding(1) var<storage, read> red: array<f32>;
@group(0) @binding(2) var<storage, read> green: array<f32>;
@group(0) @binding(3) var<storage, read> blue: array<f32>;
@group(0) @binding(4) var<storage, read> solid_angle: array<f32>;

// Energy of the texel at place `at` in the planes.
fn energy_at(at: u32) -> vec3<f32> {
    return vec3<f32>(red[at], green[at], blue[at]);
}
