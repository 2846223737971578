// The least radiance of each channel of an OEM: of each workgroup, then of all.
#include "common/reduction.wgsl"

@group(0) @binding(1) var<storage, read> red: array<f32>;
@group(0) @binding(2) var<storage, read> green: array<f32>;
@group(0) @binding(3) var<storage, read> blue: array<f32>;
@group(0) @binding(4) var<storage, read> solid_angle: array<f32>;
@group(0) @binding(5) var<storage, read_write> partials: array<vec4<f32>, GROUPS>;
@group(0) @binding(6) var<storage, read_write> least: array<vec4<f32>, 1>;

var<workgroup> shared_least: array<vec4<f32>, GROUP_SIZE>;

fn reduce_least(lane: u32) {
    for (var step = GROUP_SIZE / 2u; step > 0u; step /= 2u) {
        workgroupBarrier();
        if lane < step {
            shared_least[lane] = min(shared_least[lane], shared_least[lane + step]);
        }
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn least_of_groups(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    var smallest = vec4<f32>(3.4e38);
    for (var k = group.x * GROUP_SIZE + lane; k < count(); k += groups() * GROUP_SIZE) {
        let at = place(k);
        smallest = min(smallest, vec4<f32>(red[at], green[at], blue[at], 3.4e38) / solid_angle[at]);
    }
    shared_least[lane] = smallest;
    reduce_least(lane);
    if lane == 0u {
        partials[group.x] = shared_least[0];
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn least_of_all(@builtin(local_invocation_index) lane: u32) {
    shared_least[lane] = partials[min(lane, groups() - 1u)];
    reduce_least(lane);
    if lane == 0u {
        least[0] = shared_least[0];
    }
}
