// Triangles that are drawn straight into octahedral maps: crates/gpu/src/triangles/mod.rs. Positions
// are in units of the scene; values are what triangles interpolate, such as radiance.
#include "common/octants.wgsl"

struct Corner {
    position: vec3<f32>,
    // Octant of a piece of a triangle.
    octant: u32,
    value: vec4<f32>,
}
