// Cuts triangles at the planes x = 0, y = 0 and z = 0 into pieces that each lie in one octant: "strict split"
// of Engelhardt and Dachsbacher 2008, section 4.1, in two compute passes around direct/offsets.wgsl.
#include "common/direct.wgsl"

const GROUP_SIZE = 256u;
// Triangles of a triangle's pieces: three lines cut it into seven polygons at most, with twelve corners of
// which nine are on its border, which is 2 * 12 - 9 - 2 triangles.
const PIECES = 13u;

struct Split {
    triangles: u32,
    // Chunks of GROUP_SIZE triangles.
    chunks: u32,
}

@group(0) @binding(0) var<uniform> split: Split;
@group(0) @binding(1) var<storage, read> corners: array<Corner>;
@group(0) @binding(2) var<storage, read> indices: array<u32>;
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;
// Three corners per triangle of a piece.
@group(0) @binding(4) var<storage, read_write> pieces: array<Corner>;

struct Scanned {
    count: u32,
}

const SCAN_SIZE = GROUP_SIZE;

fn add_scanned(a: Scanned, b: Scanned) -> Scanned {
    return Scanned(a.count + b.count);
}

#include "common/scan.wgsl"
#include "common/rows.wgsl"

// A part of a triangle: every plane adds at most one corner.
struct Polygon {
    count: u32,
    corners: array<Corner, 6>,
}

// Where an edge meets the plane. From the positive side to the negative one, so that both triangles at an
// edge, and both pieces at a cut, have the same point.
fn crossing(a: Corner, b: Corner, axis: u32) -> Corner {
    var above = a;
    var below = b;
    if a.position[axis] < 0.0 {
        above = b;
        below = a;
    }
    let t = above.position[axis] / (above.position[axis] - below.position[axis]);
    var at = Corner(mix(above.position, below.position, t), 0u, mix(above.value, below.value, t));
    at.position[axis] = 0.0;
    return at;
}

// The part of a polygon on one side of a plane (Sutherland and Hodgman 1974).
fn cut(polygon: Polygon, axis: u32, side: f32) -> Polygon {
    var uncut = polygon;
    var part = Polygon();
    for (var k = 0u; k < uncut.count; k++) {
        let here = uncut.corners[k];
        let next = uncut.corners[select(k + 1u, 0u, k + 1u == uncut.count)];
        let height = side * here.position[axis];
        let ahead = side * next.position[axis];
        if height >= 0.0 && part.count < 6u {
            part.corners[part.count] = here;
            part.count++;
        }
        if min(height, ahead) < 0.0 && max(height, ahead) > 0.0 && part.count < 6u {
            part.corners[part.count] = crossing(here, next, axis);
            part.count++;
        }
    }
    return part;
}

// Counts the triangles of the pieces, and writes them from place `at` on if `is_written`.
fn split_triangle(triangle: u32, at: u32, is_written: bool) -> u32 {
    var whole = Polygon();
    whole.count = 3u;
    for (var k = 0u; k < 3u; k++) {
        whole.corners[k] = corners[indices[3u * triangle + k]];
    }
    let a = whole.corners[0].position;
    let b = whole.corners[1].position;
    let c = whole.corners[2].position;
    let low = min(min(a, b), c);
    let high = max(max(a, b), c);
    var count = 0u;
    for (var octant = 0u; octant < 8u; octant++) {
        let signs = signs_of_octant(octant);
        // No corner is inside of one of the planes; 0 counts as positive if nothing is negative.
        let reach = select(-low, high, signs > vec3<f32>());
        if any(reach < vec3<f32>()) || any((reach == vec3<f32>()) & (signs < vec3<f32>())) {
            continue;
        }
        var piece = whole;
        for (var axis = 0u; axis < 3u; axis++) {
            piece = cut(piece, axis, signs[axis]);
        }
        for (var k = 2u; k < piece.count && count < PIECES; k++) {
            if is_written {
                let place = 3u * (at + count);
                pieces[place] = Corner(piece.corners[0].position, octant, piece.corners[0].value);
                let before = piece.corners[k - 1u];
                pieces[place + 1u] = Corner(before.position, octant, before.value);
                pieces[place + 2u] = Corner(piece.corners[k].position, octant, piece.corners[k].value);
            }
            count++;
        }
    }
    return count;
}

var<workgroup> total: atomic<u32>;

@compute @workgroup_size(GROUP_SIZE)
fn count_pieces(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let chunk = index_in_rows(group);
    let triangle = chunk * GROUP_SIZE + lane;
    if triangle < split.triangles {
        atomicAdd(&total, split_triangle(triangle, 0u, false));
    }
    workgroupBarrier();
    if lane == 0u && chunk < split.chunks {
        counts[chunk] = atomicLoad(&total);
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn write_pieces(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let chunk = index_in_rows(group);
    let triangle = chunk * GROUP_SIZE + lane;
    var own = Scanned();
    if triangle < split.triangles {
        own.count = split_triangle(triangle, 0u, false);
    }
    let before = sum_before(own, lane);
    if triangle < split.triangles {
        split_triangle(triangle, counts[chunk] + before.count, true);
    }
}
