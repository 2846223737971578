// The fixed-point exponent of each channel: `FixedPoint::of_square` in src/sat.rs. Order-free: the greatest
// bit pattern, then a 64-bit integer sum at the scale that it sets.
#include "common/fixed_point.wgsl"
#include "common/reduction.wgsl"

struct Partial {
    greatest: array<u32, 4>,
    sums: array<vec2<u32>, 4>,
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

var<workgroup> shared_greatest: array<vec4<u32>, GROUP_SIZE>;

// The greatest of every invocation's `own`, for all of them.
fn reduce_greatest(own: vec4<u32>, lane: u32) -> vec4<u32> {
    shared_greatest[lane] = own;
    for (var step = GROUP_SIZE / 2u; step > 0u; step /= 2u) {
        workgroupBarrier();
        if lane < step {
            shared_greatest[lane] = max(shared_greatest[lane], shared_greatest[lane + step]);
        }
    }
    workgroupBarrier();
    return shared_greatest[0];
}

@compute @workgroup_size(GROUP_SIZE)
fn greatest(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    var own = vec4<u32>(0u);
    for (var k = group.x * GROUP_SIZE + lane; k < count(); k += groups() * GROUP_SIZE) {
        own = max(own, texel(k));
    }
    let most = reduce_greatest(own, lane);
    if lane < 4u {
        partials[group.x].greatest[lane] = most[lane];
    }
}

// The scale at which the greatest value times the count stays below 2^62.
fn provisional(most: u32) -> i32 {
    let count_log2 = 32 - i32(countLeadingZeros(count() - 1u));
    return 62 - count_log2 - (max(i32(most >> 23u), 1) - 126);
}

fn greatest_of_all(lane: u32) -> vec4<u32> {
    var own = vec4<u32>(0u);
    if lane < groups() {
        for (var c = 0u; c < 4u; c++) {
            own[c] = partials[lane].greatest[c];
        }
    }
    return reduce_greatest(own, lane);
}

var<workgroup> shared_sums: array<array<vec2<u32>, 4>, GROUP_SIZE>;

fn reduce_sums(own: array<vec2<u32>, 4>, lane: u32) {
    shared_sums[lane] = own;
    for (var step = GROUP_SIZE / 2u; step > 0u; step /= 2u) {
        workgroupBarrier();
        if lane < step {
            for (var c = 0u; c < 4u; c++) {
                shared_sums[lane][c] = add64(shared_sums[lane][c], shared_sums[lane + step][c]);
            }
        }
    }
    workgroupBarrier();
}

@compute @workgroup_size(GROUP_SIZE)
fn totals(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let most = greatest_of_all(lane);
    var sums = array<vec2<u32>, 4>();
    for (var k = group.x * GROUP_SIZE + lane; k < count(); k += groups() * GROUP_SIZE) {
        let value = texel(k);
        for (var c = 0u; c < 4u; c++) {
            sums[c] = add64(sums[c], quantise(value[c], provisional(most[c])));
        }
    }
    reduce_sums(sums, lane);
    if lane < 4u {
        partials[group.x].sums[lane] = shared_sums[0][lane];
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn finish(@builtin(local_invocation_index) lane: u32) {
    let all = greatest_of_all(lane);
    var sums = array<vec2<u32>, 4>();
    if lane < groups() {
        sums = partials[lane].sums;
    }
    reduce_sums(sums, lane);
    if lane >= 4u {
        return;
    }
    let most = all[lane];
    if most == 0u {
        exponents[lane] = 0;
        return;
    }
    // Truncation lost less than one unit a texel; each doubling doubles what it may have lost.
    let texels = vec2<u32>(count(), 0u);
    let total = add64(shared_sums[0][lane], texels);
    let limit = sub64(vec2<u32>(0u, 0x40000000u), texels);
    var up = 0;
    for (var next = shift_left64(total, 1u); less64(next, limit); next = shift_left64(next, 1u)) {
        up += 1;
    }
    exponents[lane] = provisional(most) + up;
}
