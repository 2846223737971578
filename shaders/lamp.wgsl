// Adds a disc light with a soft edge to an OEM: `Lamp` of crates/gpu/src/stages/lamp.rs. Planes hold energies
// (radiance times solid angle, float32) and solid angles in steradians.
#include "common/octahedral.wgsl"
#include "common/table.wgsl"

const EDGE = 16u;
// Samples of the lamp along an edge of a texel.
const PLACES = 4u;

struct Lamp {
    towards: vec3<f32>,
    radiance: f32,
    // Squared distances on the unit sphere.
    disc: f32,
    edge: f32,
    pad: vec2<f32>,
}

@group(0) @binding(1) var<storage, read_write> red: array<f32>;
@group(0) @binding(2) var<storage, read_write> green: array<f32>;
@group(0) @binding(3) var<storage, read_write> blue: array<f32>;
@group(0) @binding(4) var<storage, read> solid_angle: array<f32>;
@group(0) @binding(5) var<uniform> light: Lamp;

fn distance_squared(uv: vec2<f32>) -> f32 {
    let apart = direction_from_oct(uv) - light.towards;
    return dot(apart, apart);
}

@compute @workgroup_size(EDGE, EDGE)
fn lamp(@builtin(global_invocation_id) id: vec3<u32>) {
    if light.radiance == 0.0 || id.x >= table.side || id.y >= table.side {
        return;
    }
    let texel = vec2<f32>(wrap_texel(table.inner, vec2<i32>(id.xy) - i32(table.border)));
    let width = 2.0 / f32(table.inner);
    // Farthest distance of a texel's points from its centre: sqrt(6)/inner on the octahedron, whose squared
    // distance from the sphere's centre is at least 1/3.
    let reach = sqrt(light.edge) + 4.25 / f32(table.inner);
    if distance_squared((texel + 0.5) * width - 1.0) > reach * reach {
        return;
    }
    var share = 0.0;
    for (var k = 0u; k < PLACES * PLACES; k++) {
        let place = (vec2<f32>(vec2<u32>(k % PLACES, k / PLACES)) + 0.5) / f32(PLACES);
        let squared = distance_squared((texel + place) * width - 1.0);
        share += clamp((light.edge - squared) / (light.edge - light.disc), 0.0, 1.0);
    }
    let at = id.y * table.pitch + id.x;
    let energy = light.radiance * share / f32(PLACES * PLACES) * solid_angle[at];
    red[at] += energy;
    green[at] += energy;
    blue[at] += energy;
}
