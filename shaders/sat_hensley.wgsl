// Recursive doubling of two channels (Hensley et al. 2005, section 3): passes of
//   back[i] = sum over k < RADIX of front[i - k * stride],
// along rows until they are summed, then along columns, ping-pong.
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

// Texels to fixed point, before the first pass.
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
