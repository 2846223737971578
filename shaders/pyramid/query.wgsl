// Looks a pyramid up for lists of directions. Queries are directions in the map's space with perceptual
// roughness in w; answers are radiance.
#include "common/rows.wgsl"
#include "common/pyramid_group.wgsl"

const GROUP_SIZE = 64u;

@group(0) @binding(0) var<storage, read> queries: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> answers: array<vec4<f32>>;

@compute @workgroup_size(GROUP_SIZE)
fn query(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = index_in_rows(group) * GROUP_SIZE + lane;
    if k < arrayLength(&queries) {
        answers[k] = vec4<f32>(octagloss_radiance(queries[k].xyz, queries[k].w), 1.0);
    }
}
