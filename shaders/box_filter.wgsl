// Box queries for lists of directions, unit vectors in the OEM's space; answers are radiance.
@group(0) @binding(0) var<uniform> octagloss_table: OctaglossTable;
@group(0) @binding(1) var octagloss_low: texture_2d<u32>;
@group(0) @binding(2) var octagloss_high: texture_2d<u32>;
#include "common/rows.wgsl"
#include "common/sat.wgsl"

const GROUP_SIZE = 64u;

@group(1) @binding(0) var<storage, read> queries: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> answers: array<vec4<f32>>;
// The stack for every direction: solid angle and weight of each box.
@group(1) @binding(2) var<storage, read> stack: array<vec2<f32>>;

@compute @workgroup_size(GROUP_SIZE)
fn radiance(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = index_in_rows(group) * GROUP_SIZE + lane;
    if k < arrayLength(&queries) {
        var energy = vec4<f32>();
        for (var b = 0u; b < arrayLength(&stack); b++) {
            energy += stack[b].y * octagloss_box_energy(queries[k].xyz, stack[b].x);
        }
        answers[k] = vec4<f32>(energy.rgb / energy.a, 1.0);
    }
}
