// The planes of an exact table, one per channel. Entries are 64-bit fixed point, low word first, as in
// src/sat.rs.
#include "common/table.wgsl"
#include "common/u64.wgsl"

@group(0) @binding(1) var<storage, read> red: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> green: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> blue: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> solid_angle: array<vec2<u32>>;

// Sum of the texels of `channel` with coordinates below (x, y), from the corner of the bordered table.
fn plane_prefix(channel: u32, x: u32, y: u32) -> vec2<u32> {
    if x == 0u || y == 0u {
        return vec2<u32>(0u);
    }
    let at = (y - 1u) * table.pitch + x - 1u;
    switch channel {
        case 0u: {
            return red[at];
        }
        case 1u: {
            return green[at];
        }
        case 2u: {
            return blue[at];
        }
        default: {
            return solid_angle[at];
        }
    }
}

// Sum of the square's texels low <= p < high.
fn square_box(channel: u32, low: vec2<u32>, high: vec2<u32>) -> vec2<u32> {
    let a = low + table.border;
    let d = high + table.border;
    let upper = sub64(plane_prefix(channel, d.x, a.y), plane_prefix(channel, a.x, a.y));
    let lower = sub64(plane_prefix(channel, d.x, d.y), plane_prefix(channel, a.x, d.y));
    return sub64(lower, upper);
}
