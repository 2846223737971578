// Lists the triangles that each view may show, in their order: counts them by chunks, then, once
// direct/offsets.wgsl has summed the counts, writes their indices.
// Counts are of triangles, indices of corners.
#include "common/direct.wgsl"

const GROUP_SIZE = 256u;
const VIEWS = 8u;
const PLANES = 5u;

struct Cull {
    // Planes of each view; the view is where dot(plane.xyz, p) + plane.w >= 0 for all of its planes.
    planes: array<vec4<f32>, VIEWS * PLANES>,
    triangles: u32,
    // Chunks of GROUP_SIZE triangles.
    chunks: u32,
    // Share of a position's coordinates that rounding may have changed a distance by.
    slack: f32,
}

@group(0) @binding(0) var<uniform> cull: Cull;
@group(0) @binding(1) var<storage, read> corners: array<Corner>;
@group(0) @binding(2) var<storage, read> indices: array<u32>;
// Triangles of each chunk, by view; after the scan, those of the chunks before.
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;
// Three indices per triangle, in as much room for every view as the whole mesh takes.
@group(0) @binding(4) var<storage, read_write> kept: array<u32>;

// Triangles kept, by view.
alias Scanned = array<vec4<u32>, 2>;

fn add_scanned(a: Scanned, b: Scanned) -> Scanned {
    return Scanned(a[0] + b[0], a[1] + b[1]);
}

#include "common/scan.wgsl"
#include "common/rows.wgsl"

// Whether a view may show the triangle: not if all corners lie beyond one of its planes.
fn is_kept(view: u32, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> bool {
    let one = vec3<f32>(1.0);
    let slack = cull.slack * vec3<f32>(dot(abs(a), one), dot(abs(b), one), dot(abs(c), one));
    for (var k = 0u; k < PLANES; k++) {
        let plane = cull.planes[view * PLANES + k];
        let heights = vec3<f32>(dot(plane.xyz, a), dot(plane.xyz, b), dot(plane.xyz, c)) + plane.w + slack;
        if all(heights < vec3<f32>()) {
            return false;
        }
    }
    return true;
}

fn views_of(triangle: u32) -> Scanned {
    if triangle >= cull.triangles {
        return Scanned();
    }
    let a = corners[indices[3u * triangle]].position;
    let b = corners[indices[3u * triangle + 1u]].position;
    let c = corners[indices[3u * triangle + 2u]].position;
    var found = Scanned();
    for (var view = 0u; view < VIEWS; view++) {
        found[view / 4u][view % 4u] = select(0u, 1u, is_kept(view, a, b, c));
    }
    return found;
}

var<workgroup> totals: array<atomic<u32>, VIEWS>;

@compute @workgroup_size(GROUP_SIZE)
fn count_kept(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let chunk = index_in_rows(group);
    var own = views_of(chunk * GROUP_SIZE + lane);
    for (var view = 0u; view < VIEWS; view++) {
        if own[view / 4u][view % 4u] == 1u {
            atomicAdd(&totals[view], 1u);
        }
    }
    workgroupBarrier();
    if lane < VIEWS && chunk < cull.chunks {
        counts[lane * cull.chunks + chunk] = atomicLoad(&totals[lane]);
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn list_kept(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let chunk = index_in_rows(group);
    let triangle = chunk * GROUP_SIZE + lane;
    var own = views_of(triangle);
    var before = sum_before(own, lane);
    if triangle >= cull.triangles {
        return;
    }
    for (var view = 0u; view < VIEWS; view++) {
        if own[view / 4u][view % 4u] == 1u {
            let place = counts[view * cull.chunks + chunk] + before[view / 4u][view % 4u];
            let at = 3u * (view * cull.triangles + place);
            for (var k = 0u; k < 3u; k++) {
                kept[at + k] = indices[3u * triangle + k];
            }
        }
    }
}
