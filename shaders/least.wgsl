// Finds the least radiance of each channel of an OEM: per workgroup, then overall.
#include "common/planes.wgsl"
#include "common/reduce.wgsl"
#include "common/reduction.wgsl"

@group(0) @binding(5) var<storage, read_write> partials: array<vec4<f32>, GROUPS>;
@group(0) @binding(6) var<storage, read_write> least: array<vec4<f32>, 1>;

alias Reduced = vec4<f32>;

fn combine(a: Reduced, b: Reduced) -> Reduced {
    return min(a, b);
}

@compute @workgroup_size(GROUP_SIZE)
fn least_of_groups(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    var smallest = vec4<f32>(3.4e38);
    for (var k = group.x * GROUP_SIZE + lane; k < count(); k += groups() * GROUP_SIZE) {
        let at = place(k);
        smallest = min(smallest, vec4<f32>(energy_at(at), 3.4e38) / solid_angle[at]);
    }
    smallest = reduce(smallest, lane);
    if lane == 0u {
        partials[group.x] = smallest;
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn least_of_all(@builtin(local_invocation_index) lane: u32) {
    let smallest = reduce(partials[min(lane, groups() - 1u)], lane);
    if lane == 0u {
        least[0] = smallest;
    }
}
