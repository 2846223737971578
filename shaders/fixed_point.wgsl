// Computes the fixed-point exponent of each channel: `FixedPoint::of_square` in crates/core/src/light/sat.rs.
// The result does not depend on the order: the greatest bit pattern, then a 64-bit integer sum at the scale
// that it sets. Planes hold float32 energies and solid angles, as bit patterns.
#include "common/fixed_point.wgsl"
#include "common/reduce.wgsl"
#include "common/reduction.wgsl"
#include "common/sum.wgsl"

struct Partial {
    greatest: vec4<u32>,
    // Words of the sums.
    low: vec4<u32>,
    high: vec4<u32>,
}

@group(0) @binding(1) var<storage, read> red: array<u32>;
@group(0) @binding(2) var<storage, read> green: array<u32>;
@group(0) @binding(3) var<storage, read> blue: array<u32>;
@group(0) @binding(4) var<storage, read> solid_angle: array<u32>;
@group(0) @binding(5) var<storage, read_write> partials: array<Partial, GROUPS>;
@group(0) @binding(6) var<storage, read_write> exponents: array<i32, 4>;

fn texel(k: u32) -> vec4<u32> {
    let at = place(k);
    return vec4<u32>(red[at], green[at], blue[at], solid_angle[at]);
}

alias Reduced = Partial;

fn combine(a: Reduced, b: Reduced) -> Reduced {
    let sums = add_sums(Sum(a.low, a.high), Sum(b.low, b.high));
    return Reduced(max(a.greatest, b.greatest), sums.low, sums.high);
}

@compute @workgroup_size(GROUP_SIZE)
fn greatest(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    var most = vec4<u32>(0u);
    for (var k = group.x * GROUP_SIZE + lane; k < count(); k += groups() * GROUP_SIZE) {
        most = max(most, texel(k));
    }
    let all = reduce(Partial(most, vec4<u32>(), vec4<u32>()), lane);
    if lane == 0u {
        partials[group.x].greatest = all.greatest;
    }
}

// The scale at which the greatest value times the count stays below 2^62.
fn provisional(most: u32) -> i32 {
    let count_log2 = 32 - i32(countLeadingZeros(count() - 1u));
    return 62 - count_log2 - (max(i32(most >> 23u), 1) - 126);
}

fn greatest_of_all(lane: u32) -> vec4<u32> {
    var own = Partial();
    if lane < groups() {
        own.greatest = partials[lane].greatest;
    }
    return reduce(own, lane).greatest;
}

@compute @workgroup_size(GROUP_SIZE)
fn totals(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let most = greatest_of_all(lane);
    var sums = Sum();
    for (var k = group.x * GROUP_SIZE + lane; k < count(); k += groups() * GROUP_SIZE) {
        let value = texel(k);
        var own = Sum();
        for (var c = 0u; c < 4u; c++) {
            let words = quantise(value[c], provisional(most[c]));
            own.low[c] = words.x;
            own.high[c] = words.y;
        }
        sums = add_sums(sums, own);
    }
    let all = reduce(Partial(vec4<u32>(), sums.low, sums.high), lane);
    if lane == 0u {
        partials[group.x].low = all.low;
        partials[group.x].high = all.high;
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn finish(@builtin(local_invocation_index) lane: u32) {
    var own = Partial();
    if lane < groups() {
        own = partials[lane];
    }
    let all = reduce(own, lane);
    if lane >= 4u {
        return;
    }
    let most = all.greatest[lane];
    if most == 0u {
        exponents[lane] = 0;
        return;
    }
    // Truncation loses less than one unit per texel; each doubling doubles that loss.
    let texels = vec2<u32>(count(), 0u);
    let total = add64(vec2<u32>(all.low[lane], all.high[lane]), texels);
    let limit = sub64(vec2<u32>(0u, 0x40000000u), texels);
    var up = 0;
    for (var next = shift_left64(total, 1u); less64(next, limit); next = shift_left64(next, 1u)) {
        up += 1;
    }
    exponents[lane] = provisional(most) + up;
}
