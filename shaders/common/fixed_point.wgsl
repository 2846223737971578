// Converts non-negative float32 values to 64-bit fixed point through their bit patterns:
// `FixedPoint::quantise` in crates/core/src/light/sat.rs. Without float arithmetic, neither a driver's
// flushing of subnormals nor rounding can make CPU and GPU differ.
#include "common/u64.wgsl"

// floor(value * 2^exponent), where `bits` is the value's bit pattern.
fn quantise(bits: u32, exponent: i32) -> vec2<u32> {
    let biased = i32(bits >> 23u);
    let mantissa = (bits & 0x007fffffu) | select(0u, 0x00800000u, biased != 0);
    // value = mantissa * 2^(max(biased, 1) - 150)
    let shift = max(biased, 1) - 150 + exponent;
    if shift >= 0 {
        return shift_left64(vec2<u32>(mantissa, 0u), u32(min(shift, 63)));
    }
    // Shifts of 24 and more clear the mantissa.
    return vec2<u32>(mantissa >> u32(min(-shift, 31)), 0u);
}
