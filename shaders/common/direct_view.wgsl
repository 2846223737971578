// Draws into one octant of an octahedral map in either layout, or into one face of a cube: `View` of
// crates/gpu/src/direct/view.rs.
// The including shader declares octagloss_view: OctaglossView (uniform).
//
// Within an octant |x| + |y| + |z| is linear, so that clip coordinates are a matrix times the position, and
// interpolation with perspective is exact. The map of an octant holds beyond its borders wherever w > 0: a
// triangle that leaves the octant needs no cut, its fragments outside are dropped.
#include "common/octants.wgsl"

struct OctaglossView {
    clip_from_scene: mat4x4<f32>,
    // Position of the map's centre in the world; the scene is around it.
    centre: vec3<f32>,
    // Pixels along an edge of a square or face.
    size: u32,
    // The octant that is drawn.
    octant: u32,
    // Squares side by side: 1 in the quadratic layout, 2 in the rectangular one.
    squares: u32,
}

// Clip coordinates of `position` (world space).
fn octagloss_direct_position(position: vec3<f32>) -> vec4<f32> {
    return octagloss_view.clip_from_scene * vec4<f32>(position - octagloss_view.centre, 1.0);
}

// Whether the fragment at `position`, the built-in of the fragment stage, belongs to the octant that is
// drawn. Discard all others.
fn octagloss_direct_owns(position: vec4<f32>) -> bool {
    let octant = octant_of_pixel(octagloss_view.squares, octagloss_view.size, vec2<u32>(position.xy));
    return octant == octagloss_view.octant;
}
