// Evaluates fitted lobes for lists of directions. Queries are unit vectors in the OEM's space with perceptual
// roughness in w; answers are radiance.
@group(0) @binding(0) var<uniform> octagloss_octaves: OctaglossOctaves;
@group(0) @binding(1) var<uniform> octagloss_lights: array<OctaglossLight, 1>;
@group(0) @binding(2) var<storage, read> octagloss_entries: array<Sum>;
@group(0) @binding(3) var<storage, read> octagloss_parameters: array<vec4<u32>>;
@group(0) @binding(4) var octagloss_oems: texture_2d_array<f32>;
#include "common/rows.wgsl"
#include "common/fitted.wgsl"

const GROUP_SIZE = 64u;

@group(1) @binding(0) var<storage, read> queries: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> answers: array<vec4<f32>>;

@compute @workgroup_size(GROUP_SIZE)
fn fitted(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = index_in_rows(group) * GROUP_SIZE + lane;
    if k < arrayLength(&queries) {
        answers[k] = vec4<f32>(octagloss_fitted(queries[k].xyz, queries[k].w), 1.0);
    }
}
