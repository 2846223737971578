// A plain copy in words of 16 bytes, the reference for the bandwidth of the scans.
#include "common/rows.wgsl"

const GROUP_SIZE = 256u;

@group(0) @binding(0) var<storage, read> source: array<vec4<u32>>;
@group(0) @binding(1) var<storage, read_write> destination: array<vec4<u32>>;

@compute @workgroup_size(GROUP_SIZE)
fn copy(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = index_in_rows(group) * GROUP_SIZE + lane;
    if k < arrayLength(&source) {
        destination[k] = source[k];
    }
}
