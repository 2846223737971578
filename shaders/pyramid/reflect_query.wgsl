// Looks reflections up for lists of frames in the map's space. A query is the normal with perceptual
// roughness in w, the view with f90 in w, and f0; answers are radiance, and the albedo for f0 in w.
@group(0) @binding(6) var octagloss_reflections: texture_2d_array<f32>;
#include "common/pyramid_group.wgsl"
#include "common/rows.wgsl"
#include "common/reflect_maps.wgsl"

const GROUP_SIZE = 64u;

@group(1) @binding(0) var<storage, read> queries: array<array<vec4<f32>, 3>>;
@group(1) @binding(1) var<storage, read_write> answers: array<vec4<f32>>;

@compute @workgroup_size(GROUP_SIZE)
fn query(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = index_in_rows(group) * GROUP_SIZE + lane;
    if k < arrayLength(&queries) {
        let asked = queries[k];
        let light = octagloss_reflect(asked[0].xyz, asked[1].xyz, asked[0].w, asked[2].xyz, asked[1].w);
        let cosine = dot(normalize(asked[0].xyz), normalize(asked[1].xyz));
        answers[k] = vec4<f32>(light, octagloss_albedo(cosine, asked[0].w).x);
    }
}
