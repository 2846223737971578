// Draws triangles into an octahedral map, one octant at a time, or into a face of a cube:
// crates/gpu/src/direct/mod.rs. Positions are in units of the scene.
#include "common/direct_view.wgsl"

@group(0) @binding(0) var<uniform> octagloss_view: OctaglossView;

struct Fragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) value: vec4<f32>,
}

@vertex
fn project(@location(0) position: vec3<f32>, @location(2) value: vec4<f32>) -> Fragment {
    return Fragment(octagloss_direct_position(position), value);
}

// The planar projection of a position in `octant`. Where octants meet both sides compute the same
// coordinates.
fn planar(position: vec3<f32>, octant: u32) -> vec4<f32> {
    let signs = signs_of_octant(octant);
    let is_lower = signs.y < 0.0;
    let w = abs(position.x) + abs(position.y) + abs(position.z);
    let folded = select(0.0, abs(position.y), is_lower);
    let in_square = position.xz + signs.xz * folded;
    let side = select(-0.5, 0.5, is_lower);
    let in_rectangle = vec2<f32>(side * (position.z - position.x + w), position.x + position.z);
    let at = select(in_square, in_rectangle, octagloss_view.squares == 2u);
    return vec4<f32>(at.x, -at.y, octagloss_view.clip_from_scene[3].z, w);
}

// A corner of a piece that lies in one octant.
@vertex
fn project_piece(
    @location(0) position: vec3<f32>,
    @location(1) octant: u32,
    @location(2) value: vec4<f32>,
) -> Fragment {
    return Fragment(planar(position, octant), value);
}

// A corner by its own octant, whatever those of the triangle's other corners.
@vertex
fn project_corner(@location(0) position: vec3<f32>, @location(2) value: vec4<f32>) -> Fragment {
    let bits = select(vec3<u32>(), vec3<u32>(1u, 2u, 4u), position < vec3<f32>());
    return Fragment(planar(position, bits.x | bits.y | bits.z), value);
}

@fragment
fn whole(fragment: Fragment) -> @location(0) vec4<f32> {
    return fragment.value;
}

@fragment
fn own_octant(fragment: Fragment) -> @location(0) vec4<f32> {
    if !octagloss_direct_owns(fragment.clip) {
        discard;
    }
    return fragment.value;
}
