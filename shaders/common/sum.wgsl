// Sums of four channels as unsigned 64-bit integers, and their conversion to floats.

// Four channels modulo 2^64.
struct Sum {
    low: vec4<u32>,
    high: vec4<u32>,
}

fn add_sums(a: Sum, b: Sum) -> Sum {
    let low = a.low + b.low;
    return Sum(low, a.high + b.high + select(vec4<u32>(0u), vec4<u32>(1u), low < a.low));
}

fn subtract_sums(a: Sum, b: Sum) -> Sum {
    return Sum(a.low - b.low, a.high - b.high - select(vec4<u32>(0u), vec4<u32>(1u), a.low < b.low));
}

// `count` times a sum. `count` may be negative; its square must fit in 32 bits.
fn multiply_sum(count: i32, a: Sum) -> Sum {
    let k = u32(abs(count));
    let k0 = k & 0xffffu;
    let k1 = k >> 16u;
    let a0 = a.low & vec4<u32>(0xffffu);
    let a1 = a.low >> vec4<u32>(16u);
    let middle = a1 * k0 + ((a0 * k0) >> vec4<u32>(16u));
    let carried = a0 * k1 + (middle & vec4<u32>(0xffffu));
    let high = a1 * k1 + (middle >> vec4<u32>(16u)) + (carried >> vec4<u32>(16u));
    let product = Sum(a.low * k, high + a.high * k);
    if count < 0 {
        return subtract_sums(Sum(), product);
    }
    return product;
}

fn corners(a: Sum, b: Sum, c: Sum, d: Sum) -> Sum {
    return add_sums(subtract_sums(subtract_sums(d, b), c), a);
}

fn floats_from_sum(sum: Sum) -> vec4<f32> {
    return vec4<f32>(sum.high) * 4294967296.0 + vec4<f32>(sum.low);
}

// x * 2^e, exact unless the result is out of range.
fn scale_by_power(x: f32, e: i32) -> f32 {
    let half = clamp(e / 2, -126, 127);
    let rest = clamp(e - half, -126, 127);
    return x * bitcast<f32>(u32(half + 127) << 23u) * bitcast<f32>(u32(rest + 127) << 23u);
}
