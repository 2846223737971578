// Areas of an OEM's square, a workgroup or an invocation for each. Texels are counted by blocks, as the CPU
// counts them: `Suns` of crates/core/src/pyramid/suns.rs.
#include "common/direction.wgsl"
#include "common/octahedral.wgsl"
#include "common/planes.wgsl"
#include "common/seeds.wgsl"

const GROUP_SIZE = 256u;
const_assert AREAS * AREAS == GROUP_SIZE;
// Blocks along an edge of the finest grid.
const FINEST = 128u;

fn texels_of_area() -> u32 {
    return table.inner * table.inner / GROUP_SIZE;
}

// Bits of places of blocks in the square, and of texels in a block, along an edge. Sizes are powers of two:
// places come by shifts.
fn bits_of_blocks() -> vec2<u32> {
    let blocks = firstTrailingBit(min(table.inner, FINEST));
    return vec2<u32>(blocks, firstTrailingBit(table.inner) - blocks);
}

// x and y of place `k` in rows of a power of two.
fn in_rows(k: u32, bits: u32) -> vec2<u32> {
    return vec2<u32>(k & ((1u << bits) - 1u), k >> bits);
}

// Texel `k` of an area, counted by blocks of the square.
fn counted_in(area: u32, k: u32) -> u32 {
    let blocks = bits_of_blocks();
    let bits = firstTrailingBit(AREAS);
    let edge = blocks.x - bits;
    let at = (in_rows(area, bits) << vec2<u32>(edge)) + in_rows(k >> (2u * blocks.y), edge);
    let within = k & ((1u << (2u * blocks.y)) - 1u);
    return (((at.y << blocks.x) + at.x) << (2u * blocks.y)) + within;
}

// Texel `k`, counted by blocks.
fn texel_of(k: u32) -> vec2<u32> {
    let blocks = bits_of_blocks();
    let within = k & ((1u << (2u * blocks.y)) - 1u);
    return (in_rows(k >> (2u * blocks.y), blocks.x) << vec2<u32>(blocks.y)) + in_rows(within, blocks.y);
}

fn brightness_at(at: u32) -> f32 {
    return max(max(red[at], green[at]), blue[at]) / solid_angle[at];
}

fn uv_of(texel: vec2<u32>) -> vec2<f32> {
    return (vec2<f32>(texel) + 0.5) * (2.0 / f32(table.inner)) - 1.0;
}

fn direction_of(texel: vec2<u32>) -> vec3<f32> {
    return direction_from_oct(uv_of(texel));
}
