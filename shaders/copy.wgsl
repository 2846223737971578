// A plain copy, to hold the scans' bandwidth against.

const GROUP_SIZE = 256u;
const ROW = 32768u;

@group(0) @binding(0) var<storage, read> source: array<vec4<u32>>;
@group(0) @binding(1) var<storage, read_write> destination: array<vec4<u32>>;

@compute @workgroup_size(GROUP_SIZE)
fn copy(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = (group.y * ROW + group.x) * GROUP_SIZE + lane;
    if k < arrayLength(&source) {
        destination[k] = source[k];
    }
}
