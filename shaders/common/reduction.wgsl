// Reductions over the n x n texels of an OEM: workgroups to partial results, then one workgroup over those.
#include "common/table.wgsl"

// At most GROUP_SIZE, so that each invocation of the last workgroup takes one partial result.
const GROUPS = 256u;
const GROUP_SIZE = 256u;
// Texels per invocation before more workgroups are used.
const TEXELS = 4u;

// Texels of the square.
fn count() -> u32 {
    return table.inner * table.inner;
}

// Workgroups of the dispatch.
fn groups() -> u32 {
    return clamp((count() + TEXELS * GROUP_SIZE - 1u) / (TEXELS * GROUP_SIZE), 1u, GROUPS);
}

// Index of texel `k` of the square in a plane.
fn place(k: u32) -> u32 {
    return place_in_plane(vec2<u32>(k % table.inner, k / table.inner));
}
