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
        store(vec2<i32>(texel_of(square, own)), sum[own] * 0.31830987);
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

// One cell an invocation, then one function of one channel.
@compute @workgroup_size(HARMONIC_CELLS)
fn harmonics(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let cell = cells[group.x * HARMONIC_CELLS + lane];
    basis[lane] = harmonic_basis(direction_of_sum(cell[0].xyz + cell[1].xyz + cell[2].xyz));
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
