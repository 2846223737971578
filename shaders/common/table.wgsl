// Memory layout of the planes of an OEM: `Table` of crates/gpu/src/stages/oem.rs. Stages over planes bind it
// at binding 0.

struct Table {
    inner: u32,
    border: u32,
    side: u32,
    pitch: u32,
}

@group(0) @binding(0) var<uniform> table: Table;

// Index of a texel of the square in a plane.
fn place_in_plane(texel: vec2<u32>) -> u32 {
    return (texel.y + table.border) * table.pitch + texel.x + table.border;
}
