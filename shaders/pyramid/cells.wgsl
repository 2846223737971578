// Moments of the light without suns in square cells, irradiance and harmonics:
// crates/core/src/pyramid/cells.rs.
#include "common/direction.wgsl"
#include "common/harmonics.wgsl"
#include "common/octahedral.wgsl"
#include "common/reduce.wgsl"
#include "common/planes.wgsl"
#include "common/bordered.wgsl"
#include "common/seeds.wgsl"

const GROUP_SIZE = 256u;
// Cells along an edge of the finest grid.
const FINEST = 64u;

// Light in each channel, of four texels or functions.
alias Reduced = mat4x3<f32>;

fn combine(a: Reduced, b: Reduced) -> Reduced {
    return a + b;
}

@group(0) @binding(5) var<storage, read> found: Seeds;
@group(0) @binding(6) var<storage, read_write> cells: array<array<vec4<f32>, 3>>;
@group(0) @binding(9) var<storage, read_write> sums_of_harmonics: array<array<f32, 3u * BASIS>>;

fn side() -> u32 {
    return min(table.inner, FINEST);
}

var<workgroup> rows: array<array<vec4<f32>, 3>, GROUP_SIZE>;

// One row of a cell's texels an invocation.
@compute @workgroup_size(GROUP_SIZE)
fn cells_of_texels(
    @builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32,
) {
    let block = table.inner / side();
    let own = id.x / block;
    let corner = vec2<u32>(own % side(), own / side()) * block + vec2<u32>(0u, id.x % block);
    var cell: array<vec4<f32>, 3>;
    for (var k = 0u; k < block; k++) {
        let texel = corner + vec2<u32>(k, 0u);
        let at = place_in_plane(texel);
        let direction = direction_from_oct((vec2<f32>(texel) + 0.5) * (2.0 / f32(table.inner)) - 1.0);
        let energy = energy_at(at) * found.scale;
        let brightness = max(max(energy.x, energy.y), energy.z) / solid_angle[at];
        let kept = energy * select(1.0, found.clamp / brightness, brightness > found.clamp);
        let moment = vec4<f32>(direction, 1.0);
        cell[0] += kept.x * moment;
        cell[1] += kept.y * moment;
        cell[2] += kept.z * moment;
    }
    rows[lane] = cell;
    workgroupBarrier();
    if lane % block == 0u {
        for (var k = 1u; k < block; k++) {
            cell[0] += rows[lane + k][0];
            cell[1] += rows[lane + k][1];
            cell[2] += rows[lane + k][2];
        }
        cells[own] = cell;
    }
}

// Squares of four texels along an edge that a workgroup takes, and invocations for each: all read the same
// cells.
const SQUARES_A_GROUP = 2u;
const LANES_A_SQUARE = 64u;
const_assert SQUARES_A_GROUP * SQUARES_A_GROUP * LANES_A_SQUARE == GROUP_SIZE;

// What a white world's irradiance loses at the horizon: crates/core/src/pyramid/cells.rs.
const HORIZON_LOSS = 1.345f;

// Irradiance over pi.
@compute @workgroup_size(GROUP_SIZE)
fn cosine(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let square = square_of(group.xy, lane / LANES_A_SQUARE);
    let a = normal_at(texel_of(square, 0u));
    let b = normal_at(texel_of(square, 1u));
    let c = normal_at(texel_of(square, 2u));
    let d = normal_at(texel_of(square, 3u));
    let own = lane % LANES_A_SQUARE;
    var sum = Reduced();
    for (var k = own; k < side() * side(); k += LANES_A_SQUARE) {
        let cell = cells[k];
        sum += Reduced(facing(cell, a), facing(cell, b), facing(cell, c), facing(cell, d));
    }
    sum = reduce_part(sum, lane, LANES_A_SQUARE);
    if own < 4u {
        let edges = 1.0 / vec2<f32>(f32(side()), f32(table.inner));
        let share = 0.31830987 * (1.0 + HORIZON_LOSS * (edges.x * edges.x - edges.y * edges.y));
        store(vec2<i32>(texel_of(square, own)), sum[own] * share);
    }
}

fn normal_at(texel: vec2<u32>) -> vec3<f32> {
    return direction_from_oct((vec2<f32>(texel) + 0.5) * (2.0 / f32(level.inner)) - 1.0);
}

// Square `k` of a workgroup's.
fn square_of(group: vec2<u32>, k: u32) -> vec2<u32> {
    return SQUARES_A_GROUP * group + vec2<u32>(k % SQUARES_A_GROUP, k / SQUARES_A_GROUP);
}

// Texel `k` of a square of four.
fn texel_of(square: vec2<u32>, k: u32) -> vec2<u32> {
    return 2u * square + vec2<u32>(k % 2u, k / 2u);
}

// The light that a surface gets from a cell.
fn facing(cell: array<vec4<f32>, 3>, normal: vec3<f32>) -> vec3<f32> {
    let light = vec3<f32>(dot(cell[0].xyz, normal), dot(cell[1].xyz, normal), dot(cell[2].xyz, normal));
    return max(light, vec3<f32>());
}

const BASIS = 25u;
// Cells of a workgroup that sums harmonics.
const HARMONIC_CELLS = 128u;

var<workgroup> basis: array<array<f32, BASIS>, HARMONIC_CELLS>;
var<workgroup> energies: array<array<f32, 3>, HARMONIC_CELLS>;

// A direction on a cell, and the solid angle there over that of the square's middle.
fn on_cell(uv: vec2<f32>) -> vec4<f32> {
    let direction = direction_from_oct(uv);
    let flat = dot(abs(direction), vec3<f32>(1.0));
    return vec4<f32>(direction, flat * flat * flat);
}

// Corners of a square around `centre`.
fn corners(centre: vec2<f32>, offset: f32) -> array<vec4<f32>, 4> {
    return array<vec4<f32>, 4>(
        on_cell(centre - offset), on_cell(centre + vec2<f32>(offset, -offset)),
        on_cell(centre + vec2<f32>(-offset, offset)), on_cell(centre + offset));
}

// The mean of the basis over cell `k` less what it is in the mean direction of its texels' centres.
fn spread(k: u32) -> array<f32, BASIS> {
    let size = 1.0 / f32(side());
    let centre = (vec2<f32>(vec2<u32>(k % side(), k / side())) + 0.5) * (2.0 * size) - 1.0;
    let block = f32(table.inner) * size;
    // Gauss's points, and points that have the second moments of texels' centres.
    let gauss = size * 0.577350269;
    let inner = corners(centre, gauss * sqrt(1.0 - 1.0 / (block * block)));
    let outer = corners(centre, gauss);
    var mean = vec3<f32>();
    var all = 0.0;
    for (var corner = 0u; corner < 4u; corner++) {
        mean += inner[corner].xyz * inner[corner].w;
        all += outer[corner].w;
    }
    let own = harmonic_basis(normalize(mean));
    let a = harmonic_basis(outer[0].xyz);
    let b = harmonic_basis(outer[1].xyz);
    let c = harmonic_basis(outer[2].xyz);
    let d = harmonic_basis(outer[3].xyz);
    let shares = vec4<f32>(outer[0].w, outer[1].w, outer[2].w, outer[3].w) / all;
    var sums: array<f32, BASIS>;
    for (var f = 0u; f < BASIS; f++) {
        sums[f] = dot(shares, vec4<f32>(a[f], b[f], c[f], d[f])) - own[f];
    }
    return sums;
}

// One cell an invocation, then one function of one channel.
@compute @workgroup_size(HARMONIC_CELLS)
fn harmonics(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = group.x * HARMONIC_CELLS + lane;
    let cell = cells[k];
    let own = harmonic_basis(direction_of_sum(cell[0].xyz + cell[1].xyz + cell[2].xyz));
    let beside = spread(k);
    for (var f = 0u; f < BASIS; f++) {
        basis[lane][f] = own[f] + beside[f];
    }
    energies[lane] = array<f32, 3>(cell[0].w, cell[1].w, cell[2].w);
    workgroupBarrier();
    if lane < 3u * BASIS {
        var sum = 0.0;
        for (var k = 0u; k < HARMONIC_CELLS; k++) {
            sum += basis[k][lane / 3u] * energies[k][lane % 3u];
        }
        sums_of_harmonics[group.x][lane] = sum;
    }
}
