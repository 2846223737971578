// The production scan of two channels into exact tables: input read twice, output written once, four
// dispatches, no waiting between workgroups. Blocks after Nehab et al. 2011, section 6 (overlapped
// summed-area tables).
//
// The table is cut into tiles of 64 x 64. With rows_left(y, I) the sum of row y left of tile column I, and
// above(x, J) the sum of all texels above tile row J in columns up to x, an entry of tile (I, J) is S(x, y) =
// above(x, J) + sum over the tile's rows y' <= y of (rows_left(y', I) + texels of row y' in the tile up to
// x).
#include "common/fixed_point.wgsl"
#include "common/scan.wgsl"

const TILE = 64u;
// Texels along an edge of one invocation's block of a tile.
const PART = 4u;
// Invocations along an edge of a tile.
const EDGE = 16u;
const GROUP_SIZE = 256u;

struct Scan {
    // Side of the bordered table; rows are `pitch` apart, a multiple of 4.
    side: u32,
    pitch: u32,
    // Tiles along an edge.
    tiles: u32,
    // The first of the two channels.
    channel: u32,
}

@group(0) @binding(0) var<uniform> scan: Scan;
@group(0) @binding(1) var<storage, read> exponents: array<i32, 4>;
@group(0) @binding(2) var<storage, read> texels_0: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> texels_1: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read_write> rows_left: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read_write> above: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read_write> table_0: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read_write> table_1: array<vec4<u32>>;

// Index into `rows_left` or `above`: `tile` along the direction of summation, `place` along the tile's edge.
fn carry(channel: u32, tile: u32, place: u32) -> u32 {
    return (channel * scan.tiles + tile) * scan.tiles * TILE + place;
}

// Four quantised texels of row `y` from column `x` on, a multiple of 4; zero outside the table.
fn load(channel: u32, x: u32, y: u32) -> array<vec2<u32>, 4> {
    if x >= scan.pitch || y >= scan.side {
        return array<vec2<u32>, 4>();
    }
    let at = (y * scan.pitch + x) / 4u;
    let exponent = exponents[scan.channel + channel];
    var bits: vec4<u32>;
    if channel == 0u {
        bits = texels_0[at];
    } else {
        bits = texels_1[at];
    }
    return array<vec2<u32>, 4>(
        quantise(bits.x, exponent), quantise(bits.y, exponent),
        quantise(bits.z, exponent), quantise(bits.w, exponent));
}

// Odd, so that consecutive rows start in different memory banks.
const SKEW = EDGE + 1u;

var<workgroup> by_row: array<vec2<u32>, TILE * EDGE>;
var<workgroup> by_column: array<vec2<u32>, TILE * EDGE>;

// Sums the rows and columns of each tile.
@compute @workgroup_size(EDGE, EDGE)
fn tile_sums(
    @builtin(workgroup_id) tile: vec3<u32>,
    @builtin(local_invocation_id) part: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    var columns = array<vec2<u32>, PART>();
    for (var j = 0u; j < PART; j++) {
        let row = load(tile.z, tile.x * TILE + part.x * PART, tile.y * TILE + part.y * PART + j);
        var sum = vec2<u32>();
        for (var i = 0u; i < PART; i++) {
            sum = add64(sum, row[i]);
            columns[i] = add64(columns[i], row[i]);
        }
        by_row[part.x * TILE + part.y * PART + j] = sum;
    }
    for (var i = 0u; i < PART; i++) {
        by_column[part.y * TILE + part.x * PART + i] = columns[i];
    }
    workgroupBarrier();
    if lane < TILE {
        var sum = vec2<u32>();
        for (var k = 0u; k < EDGE; k++) {
            sum = add64(sum, by_row[k * TILE + lane]);
        }
        rows_left[carry(tile.z, tile.x, tile.y * TILE + lane)] = sum;
    } else if lane < 2u * TILE {
        var sum = vec2<u32>();
        for (var k = 0u; k < EDGE; k++) {
            sum = add64(sum, by_column[k * TILE + lane - TILE]);
        }
        above[carry(tile.z, tile.y, tile.x * TILE + lane - TILE)] = sum;
    }
}

// Replaces tile sums by sums of all tiles before: along rows, and down columns.
@compute @workgroup_size(GROUP_SIZE)
fn carries(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let place = group.x * GROUP_SIZE + lane;
    if place >= scan.tiles * TILE {
        return;
    }
    var left = vec2<u32>();
    var up = vec2<u32>();
    for (var tile = 0u; tile < scan.tiles; tile++) {
        let at = carry(group.z, tile, place);
        let row = rows_left[at];
        let column = above[at];
        rows_left[at] = left;
        above[at] = up;
        left = add64(left, row);
        up = add64(up, column);
    }
}

alias Scanned = vec2<u32>;

fn add_scanned(a: Scanned, b: Scanned) -> Scanned {
    return add64(a, b);
}

// Sums `above` along each tile row, one workgroup per tile row.
@compute @workgroup_size(GROUP_SIZE)
fn carry_rows(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let width = scan.tiles * TILE;
    // Each invocation sums a run of columns.
    let run = (width + GROUP_SIZE - 1u) / GROUP_SIZE;
    let first = min(lane * run, width);
    let last = min(first + run, width);
    var sum = vec2<u32>();
    for (var x = first; x < last; x++) {
        sum = add64(sum, above[carry(group.z, group.x, x)]);
    }
    var total = sum_before(sum, lane);
    for (var x = first; x < last; x++) {
        let at = carry(group.z, group.x, x);
        total = add64(total, above[at]);
        above[at] = total;
    }
}

var<workgroup> carried: array<vec2<u32>, TILE * SKEW>;

// Replaces the block sums along a line of the tile by prefix sums that start at `before`.
fn carry_on(line: u32, before: vec2<u32>) {
    var sum = before;
    for (var k = 0u; k < EDGE; k++) {
        let own = carried[line * SKEW + k];
        carried[line * SKEW + k] = sum;
        sum = add64(sum, own);
    }
}

// Computes the entries of each tile.
@compute @workgroup_size(EDGE, EDGE)
fn tables(
    @builtin(workgroup_id) tile: vec3<u32>,
    @builtin(local_invocation_id) part: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // Prefix sums along the rows of this block.
    var entries = array<array<vec2<u32>, PART>, PART>();
    for (var j = 0u; j < PART; j++) {
        var row = load(tile.z, tile.x * TILE + part.x * PART, tile.y * TILE + part.y * PART + j);
        for (var i = 1u; i < PART; i++) {
            row[i] = add64(row[i], row[i - 1u]);
        }
        entries[j] = row;
        carried[(part.y * PART + j) * SKEW + part.x] = row[PART - 1u];
    }
    workgroupBarrier();
    // One invocation per row carries the sums to the right, starting with the tiles to the left.
    if lane < TILE {
        carry_on(lane, rows_left[carry(tile.z, tile.x, tile.y * TILE + lane)]);
    }
    workgroupBarrier();
    // Add down the columns of this block.
    for (var j = 0u; j < PART; j++) {
        let left = carried[(part.y * PART + j) * SKEW + part.x];
        for (var i = 0u; i < PART; i++) {
            entries[j][i] = add64(entries[j][i], left);
            if j > 0u {
                entries[j][i] = add64(entries[j][i], entries[j - 1u][i]);
            }
        }
    }
    workgroupBarrier();
    for (var i = 0u; i < PART; i++) {
        carried[(part.x * PART + i) * SKEW + part.y] = entries[PART - 1u][i];
    }
    workgroupBarrier();
    // One invocation per column carries the sums down, starting with the tiles above.
    if lane < TILE {
        carry_on(lane, above[carry(tile.z, tile.y, tile.x * TILE + lane)]);
    }
    workgroupBarrier();
    let x = tile.x * TILE + part.x * PART;
    if x >= scan.pitch {
        return;
    }
    for (var j = 0u; j < PART; j++) {
        let y = tile.y * TILE + part.y * PART + j;
        if y >= scan.side {
            return;
        }
        var row = entries[j];
        for (var i = 0u; i < PART; i++) {
            row[i] = add64(row[i], carried[(part.x * PART + i) * SKEW + part.y]);
        }
        // Two entries per word of four.
        let at = (y * scan.pitch + x) / 2u;
        if tile.z == 0u {
            table_0[at] = vec4<u32>(row[0], row[1]);
            table_0[at + 1u] = vec4<u32>(row[2], row[3]);
        } else {
            table_1[at] = vec4<u32>(row[0], row[1]);
            table_1[at + 1u] = vec4<u32>(row[2], row[3]);
        }
    }
}
