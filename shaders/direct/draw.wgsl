// Draws triangles into an octahedral map, one octant at a time, or into a face of a cube:
// src/gpu/direct/view.rs.
//
// Within an octant |x| + |y| + |z| is linear, so that clip coordinates are a matrix times the position, and
// interpolation with perspective is exact. The map of an octant holds beyond its borders wherever w > 0: a
// triangle that leaves the octant needs no cut, its fragments outside are dropped.
#include "common/direct.wgsl"

struct View {
    clip_from_scene: mat4x4<f32>,
    // Pixels along an edge of the map or face.
    size: u32,
    // The octant that is drawn.
    octant: u32,
}

@group(0) @binding(0) var<uniform> view: View;

struct Fragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) value: vec4<f32>,
}

@vertex
fn project(@location(0) position: vec3<f32>, @location(2) value: vec4<f32>) -> Fragment {
    return Fragment(view.clip_from_scene * vec4<f32>(position, 1.0), value);
}

// The planar projection of a position in `octant`. On a fold, where y = 0, both sides compute the same
// coordinates.
fn planar(position: vec3<f32>, octant: u32) -> vec4<f32> {
    let signs = signs_of_octant(octant);
    let folded = select(0.0, abs(position.y), signs.y < 0.0);
    let at = position.xz + signs.xz * folded;
    let w = abs(position.x) + abs(position.y) + abs(position.z);
    return vec4<f32>(at.x, -at.y, view.clip_from_scene[3].z, w);
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
    if octant_of_pixel(view.size, vec2<u32>(fragment.clip.xy)) != view.octant {
        discard;
    }
    return fragment.value;
}
