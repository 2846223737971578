// Packs the planes of a table into two textures, low words and high words: two loads per entry, close
// together in 2D. Entries are 64-bit fixed point, low word first, as in crates/core/src/light/sat.rs.
#include "common/table.wgsl"

const EDGE = 16u;

@group(0) @binding(1) var<storage, read> red: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> green: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> blue: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> solid_angle: array<vec2<u32>>;
@group(0) @binding(5) var low: texture_storage_2d<rgba32uint, write>;
@group(0) @binding(6) var high: texture_storage_2d<rgba32uint, write>;
@group(0) @binding(7) var<storage, read> exponents: vec4<i32>;
// `OctaglossTable` of common/sat.wgsl.
@group(0) @binding(8) var<storage, read_write> header: array<vec4<i32>, 2>;

@compute @workgroup_size(EDGE, EDGE)
fn pack(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy == vec2<u32>(0u)) {
        header[0] = exponents;
        header[1] = vec4<i32>(i32(table.inner), i32(table.border), 0, 0);
    }
    if id.x >= table.side || id.y >= table.side {
        return;
    }
    let at = id.y * table.pitch + id.x;
    let r = red[at];
    let g = green[at];
    let b = blue[at];
    let w = solid_angle[at];
    textureStore(low, id.xy, vec4<u32>(r.x, g.x, b.x, w.x));
    textureStore(high, id.xy, vec4<u32>(r.y, g.y, b.y, w.y));
}
