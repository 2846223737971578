// Triangles that are drawn straight into octahedral maps: src/direct/mod.rs.
#include "common/octants.wgsl"

struct Corner {
    position: vec3<f32>,
    // Octant of a piece of a triangle.
    octant: u32,
    value: vec4<f32>,
}
