// The summed-area table of two channels by recursive doubling (Hensley et al. 2005, section 3). Each pass is
//   back[i] = sum over k < RADIX of front[i - k * stride],
// with stride 1, RADIX, RADIX^2, ... below the side: ceil(log_RADIX(side)) passes along rows, as many along
// columns, after one that quantises the texels. Buffers are exchanged between passes (ping-pong).
//
// A dispatch is one pass: one invocation per entry, workgroups of 16 x 16 over the side x side entries of the
// bordered table, with rows `pitch` apart. Two channels share a pass: their four tables and two planes take
// six of the eight storage buffers per stage that WebGPU guarantees; four channels would need twelve.
//
// Texels are float32 energies (radiance times solid angle), as bit patterns. Entries are 64-bit integers, low
// word first, in units of 2^-exponent of their channel. Sums are exact modulo 2^64. Exponents keep the whole
// sum below 2^62 (crates/core/src/light/sat.rs), so every box is exact.
#include "common/fixed_point.wgsl"

override RADIX: u32 = 2u;

struct Doubling {
    side: u32,
    pitch: u32,
    // The first of the two channels.
    channel: u32,
    // 0 along rows, 1 along columns.
    axis: u32,
    stride: u32,
}

@group(0) @binding(0) var<uniform> doubling: Doubling;
@group(0) @binding(1) var<storage, read> exponents: array<i32, 4>;
@group(0) @binding(2) var<storage, read> texels_0: array<u32>;
@group(0) @binding(3) var<storage, read> texels_1: array<u32>;
@group(0) @binding(4) var<storage, read> front_0: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> front_1: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read_write> back_0: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> back_1: array<vec2<u32>>;

// Quantises the texels, before the first pass.
@compute @workgroup_size(16, 16)
fn quantise_texels(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= doubling.side || id.y >= doubling.side {
        return;
    }
    let at = id.y * doubling.pitch + id.x;
    back_0[at] = quantise(texels_0[at], exponents[doubling.channel]);
    back_1[at] = quantise(texels_1[at], exponents[doubling.channel + 1u]);
}

@compute @workgroup_size(16, 16)
fn double_sums(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= doubling.side || id.y >= doubling.side {
        return;
    }
    let at = id.y * doubling.pitch + id.x;
    let step = select(1u, doubling.pitch, doubling.axis == 1u) * doubling.stride;
    let reach = select(id.x, id.y, doubling.axis == 1u) / doubling.stride;
    let samples = min(RADIX, reach + 1u);
    var sum_0 = vec2<u32>();
    var sum_1 = vec2<u32>();
    for (var k = 0u; k < samples; k++) {
        sum_0 = add64(sum_0, front_0[at - k * step]);
        sum_1 = add64(sum_1, front_1[at - k * step]);
    }
    back_0[at] = sum_0;
    back_1[at] = sum_1;
}
