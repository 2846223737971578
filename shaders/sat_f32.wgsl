// The float32 table of the 2005 paper with its mean bias, radix 2: crates/core/src/analysis/sat_f32.rs. Used
// for comparison; crates/core/src/light/sat.rs describes its errors. Texels are energies (radiance times
// solid angle) and solid angles.
#include "common/reduce.wgsl"
#include "common/planes.wgsl"

const GROUPS = 64u;
const GROUP_SIZE = 256u;
const EDGE = 16u;

struct Doubling {
    side: u32,
    // 0 along rows, 1 along columns.
    axis: u32,
    stride: u32,
}

// Sums of each workgroup, then the mean.
@group(0) @binding(5) var<storage, read_write> partials: array<vec4<f32>, GROUPS>;
@group(0) @binding(6) var<storage, read_write> mean: array<vec4<f32>, 1>;
@group(0) @binding(7) var<storage, read_write> back: array<vec4<f32>>;
@group(0) @binding(8) var<uniform> doubling: Doubling;
@group(0) @binding(9) var<storage, read> front: array<vec4<f32>>;

fn texel(x: u32, y: u32) -> vec4<f32> {
    let at = y * table.pitch + x;
    return vec4<f32>(energy_at(at), solid_angle[at]);
}

alias Reduced = vec4<f32>;

fn combine(a: Reduced, b: Reduced) -> Reduced {
    return a + b;
}

@compute @workgroup_size(GROUP_SIZE)
fn sums_of_groups(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    var sum = vec4<f32>();
    // Sum each row first, so that no sum has many terms.
    for (var y = group.x; y < table.side; y += GROUPS) {
        var row = vec4<f32>();
        for (var x = lane; x < table.side; x += GROUP_SIZE) {
            row += texel(x, y);
        }
        sum += row;
    }
    sum = reduce(sum, lane);
    if lane == 0u {
        partials[group.x] = sum;
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn mean_of_all(@builtin(local_invocation_index) lane: u32) {
    var own = vec4<f32>();
    if lane < GROUPS {
        own = partials[lane];
    }
    let sum = reduce(own, lane);
    if lane == 0u {
        mean[0] = sum / (f32(table.side) * f32(table.side));
    }
}

@compute @workgroup_size(EDGE, EDGE)
fn bias(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < table.side && id.y < table.side {
        back[id.y * table.side + id.x] = texel(id.x, id.y) - mean[0];
    }
}

@compute @workgroup_size(EDGE, EDGE)
fn double_sums(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= doubling.side || id.y >= doubling.side {
        return;
    }
    let at = id.y * doubling.side + id.x;
    var sum = front[at];
    if select(id.x, id.y, doubling.axis == 1u) >= doubling.stride {
        sum += front[at - select(1u, doubling.side, doubling.axis == 1u) * doubling.stride];
    }
    back[at] = sum;
}
