// Computes spherical harmonics of an OEM to order 4 from its exact table: `table_harmonics` of
// src/sh/coefficients.rs. Coefficients are of radiance. Sums run in a fixed order: within workgroups, then
// over all workgroups.
#include "common/harmonics.wgsl"
#include "common/light.wgsl"
#include "common/octahedral.wgsl"
#include "common/planes.wgsl"

// Texels that a workgroup sums per batch, and its batches.
const GROUP_SIZE = 128u;
const BATCHES = 4u;
const COUNT = 25u;
// Odd, so that consecutive functions start in different memory banks.
const SKEW = GROUP_SIZE + 1u;
// 2^-28 and 2^-60.
const HIGH_WORD = 3.7252903e-9f;
const LOW_WORD = 8.6736174e-19f;
// Texels along an edge of the finest grid.
const FINEST = 256u;

@group(0) @binding(5) var<storage, read> exponents: vec4<i32>;
@group(0) @binding(6) var<storage, read_write> partials: array<f32>;
@group(0) @binding(7) var<storage, read_write> light: OctaglossLight;

// Texels along an edge of the grid.
fn grid() -> u32 {
    return min(table.inner, FINEST);
}

// Workgroups of the first dispatch.
fn groups() -> u32 {
    let texels = grid() * grid();
    return (texels + GROUP_SIZE * BATCHES - 1u) / (GROUP_SIZE * BATCHES);
}

var<workgroup> basis: array<f32, COUNT * SKEW>;
var<workgroup> energy: array<vec4<f32>, GROUP_SIZE>;

@compute @workgroup_size(GROUP_SIZE)
fn sums_of_groups(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let n = grid();
    let factor = table.inner / n;
    var total = 0.0;
    for (var batch = 0u; batch < BATCHES; batch++) {
        let texel = (group.x * BATCHES + batch) * GROUP_SIZE + lane;
        let at = vec2<u32>(texel % n, texel / n);
        var own = vec4<f32>();
        if texel < n * n {
            for (var c = 0u; c < 4u; c++) {
                let sum = square_box(c, at * factor, (at + 1u) * factor);
                own[c] = f32(sum.y) * HIGH_WORD + f32(sum.x) * LOW_WORD;
            }
        }
        energy[lane] = own;
        let values = harmonic_basis(direction_from_oct((2.0 * vec2<f32>(at) + 1.0) / f32(n) - 1.0));
        store(lane, values);
        workgroupBarrier();
        if lane < 4u * COUNT {
            var sum = 0.0;
            for (var k = 0u; k < GROUP_SIZE; k++) {
                sum += basis[lane / 4u * SKEW + k] * energy[k][lane % 4u];
            }
            total += sum;
        }
        workgroupBarrier();
    }
    if lane < 4u * COUNT {
        partials[group.x * 4u * COUNT + lane] = total;
    }
}

fn store(lane: u32, values: array<f32, COUNT>) {
    var own = values;
    for (var k = 0u; k < COUNT; k++) {
        basis[k * SKEW + lane] = own[k];
    }
}

// 2^e for the quotient of two channels' units, as two factors: their product may be out of range.
fn powers(e: i32) -> vec2<f32> {
    let half = clamp(e / 2, -126, 127);
    let rest = clamp(e - half, -126, 127);
    return vec2<f32>(bitcast<f32>(u32(half + 127) << 23u), bitcast<f32>(u32(rest + 127) << 23u));
}

@compute @workgroup_size(GROUP_SIZE)
fn sum_of_all(@builtin(local_invocation_index) lane: u32) {
    if lane < 4u * COUNT {
        var sum = 0.0;
        for (var group = 0u; group < groups(); group++) {
            sum += partials[group * 4u * COUNT + lane];
        }
        light.harmonics[lane / 4u][lane % 4u] = sum;
    } else if lane < 4u * COUNT + 4u {
        let c = lane - 4u * COUNT;
        let factors = powers(exponents.a - exponents[c]);
        light.scale[0][c] = factors.x;
        light.scale[1][c] = factors.y;
    }
}
