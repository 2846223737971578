// Builds summed-area tables of the OEM blurred by a tent, one per octave: `blurred` of src/cpu/blur.rs, bit
// for bit. The tent is a box applied twice, in integers. The tables have a border, so that soft boxes near
// the square's edge also need four reads per corner. Texels and entries are 64-bit fixed point, as in
// src/sat.rs.
#include "common/octahedral.wgsl"
#include "common/octaves.wgsl"
#include "common/planes.wgsl"
#include "common/scan.wgsl"
#include "common/sum.wgsl"

// Texels along an edge of a tile of the grid.
const EDGE = 16u;
const GROUP_SIZE = 256u;
// Invocations that sum one row or column of a table.
const LINE_SIZE = 64u;
// Corners along an edge that a tile's texels read: boxes are up to 16 wide.
const REACH = 31u;

@group(0) @binding(5) var<uniform> octaves: OctaglossOctaves;
// Blurred texels: written word by word, read whole.
@group(0) @binding(6) var<storage, read_write> words: array<u32>;
@group(0) @binding(7) var<storage, read> texels: array<Sum>;
@group(0) @binding(8) var<storage, read_write> entries: array<Sum>;

// Sum of the texels in the box of `side` texels from `low` on in the unfolded plane, in texels of a grid of
// `n`. Corners must lie in the square or in its direct neighbours.
fn grid_box(channel: u32, n: u32, low: vec2<i32>, side: i32) -> vec2<u32> {
    let factor = table.inner / n;
    let width = i32(n);
    let first = select(vec2<i32>(0), vec2<i32>(-1), low < vec2<i32>(0));
    var sum = vec2<u32>();
    // Add the parts in up to four squares.
    for (var k = 0; k < 4; k++) {
        let square = first + vec2<i32>(k & 1, k >> 1u);
        let from_corner = clamp(low - square * width, vec2<i32>(0), vec2<i32>(width));
        let to_corner = clamp(low + side - square * width, vec2<i32>(0), vec2<i32>(width));
        if any(from_corner >= to_corner) {
            continue;
        }
        let turned = ((square.x ^ square.y) & 1) != 0;
        let a = select(from_corner, width - to_corner, turned);
        let d = select(to_corner, width - from_corner, turned);
        sum = add64(sum, square_box(channel, vec2<u32>(a) * factor, vec2<u32>(d) * factor));
    }
    return sum;
}

var<workgroup> once: array<vec2<u32>, REACH * REACH>;
var<workgroup> along: array<vec2<u32>, REACH * EDGE>;

// One tile of one channel of one octave per workgroup.
@compute @workgroup_size(EDGE, EDGE)
fn blur(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    var k = 0u;
    while k + 1u < octaves.finest && group.x >= octaves.octaves[k + 1u].first_tile {
        k++;
    }
    let octave = octaves.octaves[k];
    let channel = group.y;
    let side = octave.box_side;
    let shift = 2u * firstLeadingBit(side);
    let tiles = octave.fine / EDGE;
    let tile = group.x - octave.first_tile;
    let origin = vec2<u32>(tile % tiles, tile / tiles) * EDGE;
    // Box sums around corners. A texel's second box runs from the corner before its middle to the one after.
    let reach = EDGE + side - 1u;
    for (var c = lane; c < reach * reach; c += GROUP_SIZE) {
        let low = vec2<i32>(origin + vec2<u32>(c % reach, c / reach)) + 1 - i32(side);
        once[c] = shift_right64(grid_box(channel, octave.fine, low, i32(side)), shift);
    }
    workgroupBarrier();
    for (var c = lane; c < reach * EDGE; c += GROUP_SIZE) {
        var sum = vec2<u32>();
        for (var i = 0u; i < side; i++) {
            sum = add64(sum, once[c / EDGE * reach + c % EDGE + i]);
        }
        along[c] = sum;
    }
    workgroupBarrier();
    var sum = vec2<u32>();
    for (var j = 0u; j < side; j++) {
        sum = add64(sum, along[lane + j * EDGE]);
    }
    once[lane] = shift_right64(sum, shift);
    workgroupBarrier();
    // Merge several texels of the grid into one.
    let factor = octave.fine / octave.coarse;
    let edge = EDGE / factor;
    if lane >= edge * edge {
        return;
    }
    let at = vec2<u32>(lane % edge, lane / edge);
    var texel = vec2<u32>();
    for (var part = 0u; part < factor * factor; part++) {
        let place = at * factor + vec2<u32>(part % factor, part / factor);
        texel = add64(texel, once[place.y * EDGE + place.x]);
    }
    let place = origin / factor + at;
    let first = 8u * (octave.first_texel + place.y * octave.coarse + place.x);
    words[first + channel] = texel.x;
    words[first + 4u + channel] = texel.y;
}

// One row or column of one octave.
struct Line {
    octave: OctaglossOctave,
    place: u32,
}

fn line(group: u32) -> Line {
    var k = 0u;
    while k + 1u < octaves.finest && group >= octaves.octaves[k + 1u].first_row {
        k++;
    }
    let octave = octaves.octaves[k];
    return Line(octave, group - octave.first_row);
}

// The texel before entry (x, y); zero in the first row and column.
fn texel_before(octave: OctaglossOctave, x: u32, y: u32) -> Sum {
    if x == 0u || y == 0u {
        return Sum();
    }
    let at = wrap_texel(octave.coarse, vec2<i32>(vec2<u32>(x, y)) - 1 - i32(OCTAVE_BORDER));
    return texels[octave.first_texel + at.y * octave.coarse + at.x];
}

const SCAN_SIZE = LINE_SIZE;
alias Scanned = Sum;

fn add_scanned(a: Scanned, b: Scanned) -> Scanned {
    return add_sums(a, b);
}

// Sums along the rows of the bordered squares, one workgroup per row.
@compute @workgroup_size(LINE_SIZE)
fn rows(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let row = line(group.x);
    let side = row.octave.side;
    let run = (side + LINE_SIZE - 1u) / LINE_SIZE;
    let first = min(lane * run, side);
    let last = min(first + run, side);
    var sum = Sum();
    for (var x = first; x < last; x++) {
        sum = add_sums(sum, texel_before(row.octave, x, row.place));
    }
    var total = sum_before(sum, lane);
    for (var x = first; x < last; x++) {
        total = add_sums(total, texel_before(row.octave, x, row.place));
        entries[row.octave.first_entry + row.place * side + x] = total;
    }
}

// Sums down their columns, one workgroup per column.
@compute @workgroup_size(LINE_SIZE)
fn columns(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let column = line(group.x);
    let side = column.octave.side;
    let run = (side + LINE_SIZE - 1u) / LINE_SIZE;
    let first = min(lane * run, side);
    let last = min(first + run, side);
    let top = column.octave.first_entry + column.place;
    var sum = Sum();
    for (var y = first; y < last; y++) {
        sum = add_sums(sum, entries[top + y * side]);
    }
    var total = sum_before(sum, lane);
    for (var y = first; y < last; y++) {
        total = add_sums(total, entries[top + y * side]);
        entries[top + y * side] = total;
    }
}
