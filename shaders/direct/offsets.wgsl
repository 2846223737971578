// Turns the counts of each list's chunks into the counts before each chunk, and writes the arguments of the
// indirect draw of the list. A workgroup serves a list. Counts are of triangles.

const GROUP_SIZE = 256u;

struct Offsets {
    // Counts of a list.
    chunks: u32,
    // Triangles that a list has room for.
    room: u32,
}

@group(0) @binding(0) var<uniform> offsets: Offsets;
@group(0) @binding(1) var<storage, read_write> counts: array<u32>;
// Five words per draw: corners, instances, first corner or index, then two zeros. Indirect draws without
// indices read the first three and a zero.
@group(0) @binding(2) var<storage, read_write> draws: array<u32>;

alias Scanned = u32;

fn add_scanned(a: Scanned, b: Scanned) -> Scanned {
    return a + b;
}

#include "common/scan.wgsl"

@compute @workgroup_size(GROUP_SIZE)
fn sum_chunks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let list = group.x;
    var before = 0u;
    for (var first = 0u; first < offsets.chunks; first += GROUP_SIZE) {
        let at = list * offsets.chunks + first + lane;
        let is_chunk = first + lane < offsets.chunks;
        var own = 0u;
        if is_chunk {
            own = counts[at];
        }
        let earlier = sum_before(own, lane);
        if is_chunk {
            counts[at] = before + earlier;
        }
        before += scanned[GROUP_SIZE - 1u];
        // The next turn overwrites the sums.
        workgroupBarrier();
    }
    if lane == 0u {
        draws[5u * list] = 3u * before;
        draws[5u * list + 1u] = 1u;
        draws[5u * list + 2u] = 3u * list * offsets.room;
        draws[5u * list + 3u] = 0u;
        draws[5u * list + 4u] = 0u;
    }
}
