// Cuts triangles into pieces, by a method of Engelhardt and Dachsbacher 2008, in two compute passes around
// direct/offsets.wgsl: "strict split" (section 4.1) at the planes x = 0, y = 0 and z = 0, so that each piece
// lies in one octant; "XZ-split" (section 5.2) at y = 0; "edge strip" at y = 0 with the edges of both parts
// cut at x = 0 and z = 0. Counts are of triangles.
#include "common/direct.wgsl"

const GROUP_SIZE = 256u;
// Triangles of a triangle's pieces: three lines cut it into seven polygons at most, with twelve corners of
// which nine are on its border, which is 2 * 12 - 9 - 2 triangles.
const PIECES = 13u;
// Corners of a polygon: three, one more by each plane that cuts it, and four more on the edges of a strip.
const CORNERS = 8u;

// Values of `Split.cut`.
const CUT_OCTANTS = 0u;
const CUT_EDGES = 2u;

struct Split {
    triangles: u32,
    // Chunks of GROUP_SIZE triangles.
    chunks: u32,
    // `Cut` of crates/gpu/src/direct/list.rs.
    cut: u32,
}

@group(0) @binding(0) var<uniform> split: Split;
@group(0) @binding(1) var<storage, read> corners: array<Corner>;
@group(0) @binding(2) var<storage, read> indices: array<u32>;
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;
// Three corners per triangle of a piece.
@group(0) @binding(4) var<storage, read_write> pieces: array<Corner>;

alias Scanned = u32;

fn add_scanned(a: Scanned, b: Scanned) -> Scanned {
    return a + b;
}

#include "common/scan.wgsl"
#include "common/rows.wgsl"

// A part of a triangle.
struct Polygon {
    count: u32,
    corners: array<Corner, CORNERS>,
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

fn next_corner(polygon: ptr<function, Polygon>, k: u32) -> Corner {
    return (*polygon).corners[select(k + 1u, 0u, k + 1u == (*polygon).count)];
}

fn append_corner(polygon: ptr<function, Polygon>, corner: Corner) {
    if (*polygon).count < CORNERS {
        (*polygon).corners[(*polygon).count] = corner;
        (*polygon).count++;
    }
}

// The part of a polygon on one side of a plane (Sutherland and Hodgman 1974), or, where `side` is 0, the
// polygon with further corners where its edges cross the plane.
fn cut(polygon: Polygon, axis: u32, side: f32) -> Polygon {
    var uncut = polygon;
    var part = Polygon();
    for (var k = 0u; k < uncut.count; k++) {
        let here = uncut.corners[k];
        let next = next_corner(&uncut, k);
        let height = here.position[axis];
        let ahead = next.position[axis];
        if side * height >= 0.0 {
            append_corner(&part, here);
        }
        if min(height, ahead) < 0.0 && max(height, ahead) > 0.0 {
            append_corner(&part, crossing(here, next, axis));
        }
    }
    return part;
}

// Whether a triangle between `low` and `high` crosses each plane.
fn is_across(low: vec3<f32>, high: vec3<f32>) -> vec3<bool> {
    return (low < vec3<f32>()) & (high > vec3<f32>());
}

// Whether a part of a triangle between `low` and `high` lies on a side of planes; a triangle within a plane
// is on the positive side.
fn reaches(low: vec3<f32>, high: vec3<f32>, signs: vec3<f32>) -> vec3<bool> {
    let is_above = (high > vec3<f32>()) | ((high == vec3<f32>()) & (low == vec3<f32>()));
    return select(vec3<f32>() > low, is_above, signs > vec3<f32>());
}

// Writes triangle `index` of all pieces.
fn write_piece(index: u32, a: Corner, b: Corner, c: Corner) {
    pieces[3u * index] = a;
    pieces[3u * index + 1u] = b;
    pieces[3u * index + 2u] = c;
}

// The corner as part of a piece in `octant`.
fn in_octant(corner: Corner, octant: u32) -> Corner {
    return Corner(corner.position, octant, corner.value);
}

// The octant of a corner in the lower hemisphere or in the upper one.
fn in_half(corner: Corner, half: u32) -> Corner {
    let position = corner.position;
    return in_octant(corner, half | select(0u, 1u, position.x < 0.0) | select(0u, 4u, position.z < 0.0));
}

// Counts the triangles of the pieces that each lie in an octant, and writes them from place `at` on if
// `is_written`.
fn split_by_octants(whole: Polygon, low: vec3<f32>, high: vec3<f32>, at: u32, is_written: bool) -> u32 {
    let is_crossed = is_across(low, high);
    var count = 0u;
    for (var octant = 0u; octant < 8u; octant++) {
        let signs = signs_of_octant(octant);
        if !all(reaches(low, high, signs)) {
            continue;
        }
        var piece = whole;
        for (var axis = 0u; axis < 3u; axis++) {
            if is_crossed[axis] {
                piece = cut(piece, axis, signs[axis]);
            }
        }
        for (var k = 2u; k < piece.count && count < PIECES; k++) {
            if is_written {
                let before = in_octant(piece.corners[k - 1u], octant);
                let last = in_octant(piece.corners[k], octant);
                write_piece(at + count, in_octant(piece.corners[0], octant), before, last);
            }
            count++;
        }
    }
    return count;
}

// The same for the parts in either hemisphere, as strips from side to side of their polygons.
fn split_by_halves(whole: Polygon, low: vec3<f32>, high: vec3<f32>, at: u32, is_written: bool) -> u32 {
    let is_crossed = is_across(low, high);
    var count = 0u;
    for (var half = 0u; half <= 2u; half += 2u) {
        let signs = signs_of_octant(half);
        if !reaches(low, high, signs).y {
            continue;
        }
        var part = whole;
        if is_crossed.y {
            part = cut(part, 1u, signs.y);
        }
        for (var axis = 0u; axis < 3u; axis += 2u) {
            if is_crossed[axis] && split.cut == CUT_EDGES {
                part = cut(part, axis, 0.0);
            }
        }
        for (var k = 2u; k < part.count && count < PIECES; k++) {
            if is_written {
                var strip = array<Corner, 3>();
                for (var i = 0u; i < 3u; i++) {
                    let place = k - 2u + i;
                    let corner = select(place / 2u, part.count - (place + 1u) / 2u, place % 2u == 1u);
                    strip[i] = in_half(part.corners[corner], half);
                }
                write_piece(at + count, strip[0], strip[1], strip[2]);
            }
            count++;
        }
    }
    return count;
}

// Writes a triangle that crosses no plane, of which `low` is the least corner.
fn write_whole(a: Corner, b: Corner, c: Corner, low: vec3<f32>, at: u32) {
    let is_below = low < vec3<f32>();
    let half = select(0u, 2u, is_below.y);
    if split.cut == CUT_OCTANTS {
        let octant = half | select(0u, 1u, is_below.x) | select(0u, 4u, is_below.z);
        write_piece(at, in_octant(a, octant), in_octant(b, octant), in_octant(c, octant));
    } else {
        write_piece(at, in_half(a, half), in_half(b, half), in_half(c, half));
    }
}

fn split_triangle(triangle: u32, at: u32, is_written: bool) -> u32 {
    let a = corners[indices[3u * triangle]];
    let b = corners[indices[3u * triangle + 1u]];
    let c = corners[indices[3u * triangle + 2u]];
    let low = min(min(a.position, b.position), c.position);
    let high = max(max(a.position, b.position), c.position);
    // Nearly all triangles of a fine mesh; polygons are slow.
    if !any(is_across(low, high)) {
        if is_written {
            write_whole(a, b, c, low, at);
        }
        return 1u;
    }
    var whole = Polygon();
    whole.count = 3u;
    whole.corners[0] = a;
    whole.corners[1] = b;
    whole.corners[2] = c;
    if split.cut == CUT_OCTANTS {
        return split_by_octants(whole, low, high, at, is_written);
    }
    return split_by_halves(whole, low, high, at, is_written);
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
    var own = 0u;
    if triangle < split.triangles {
        own = split_triangle(triangle, 0u, false);
    }
    let before = sum_before(own, lane);
    if triangle < split.triangles {
        split_triangle(triangle, counts[chunk] + before, true);
    }
}
