// Moments of the light without suns in square cells, irradiance and harmonics:
// crates/core/src/pyramid/cells.rs.
#include "common/direction.wgsl"
#include "common/harmonics.wgsl"
#include "common/octahedral.wgsl"
#include "common/reduce.wgsl"
#include "common/planes.wgsl"
#include "common/bordered.wgsl"
#include "common/light.wgsl"

const GROUP_SIZE = 256u;
// Cells along an edge of the finest grid.
const FINEST = 64u;

// Light in each channel, of four texels or functions.
alias Reduced = mat4x3<f32>;

fn combine(a: Reduced, b: Reduced) -> Reduced {
    return a + b;
}

@group(0) @binding(5) var<storage, read_write> light: OctaglossLight;
@group(0) @binding(6) var<storage, read_write> cells: array<array<vec4<f32>, 3>>;

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
        let energy = energy_at(at) * light.scale;
        let brightness = max(max(energy.x, energy.y), energy.z) / solid_angle[at];
        let kept = energy * select(1.0, light.clamp / brightness, brightness > light.clamp);
        let moment = vec4<f32>(direction, 1.0);
        cell[0] += kept.x * moment;
        cell[1] += kept.y * moment;
        cell[2] += kept.z * moment;
    }
    rows[lane] = cell;
    workgroupBarrier();
    if lane % block == 0u {
        for (var k = 1u; k < block; k++) {
            for (var c = 0u; c < 3u; c++) {
                cell[c] += rows[lane + k][c];
            }
        }
        cells[own] = cell;
    }
}

// Irradiance over pi, four texels a workgroup.
@compute @workgroup_size(GROUP_SIZE)
fn cosine(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    var normals: array<vec3<f32>, 4>;
    for (var k = 0u; k < 4u; k++) {
        let texel = vec2<f32>(texel_of(group.xy, k)) + 0.5;
        normals[k] = direction_from_oct(texel * (2.0 / f32(level.inner)) - 1.0);
    }
    var sum = Reduced();
    for (var k = lane; k < side() * side(); k += GROUP_SIZE) {
        let cell = cells[k];
        sum += Reduced(
            facing(cell, normals[0]), facing(cell, normals[1]), facing(cell, normals[2]),
            facing(cell, normals[3]));
    }
    sum = reduce(sum, lane);
    if lane < 4u {
        store(vec2<i32>(texel_of(group.xy, lane)), sum[lane] * 0.31830987);
    }
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

// Four functions a workgroup; the last has one.
@compute @workgroup_size(GROUP_SIZE)
fn harmonics(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let first = 4u * group.x;
    var sum = Reduced();
    for (var k = lane; k < side() * side(); k += GROUP_SIZE) {
        let cell = cells[k];
        var basis = harmonic_basis(direction_of_sum(cell[0].xyz + cell[1].xyz + cell[2].xyz));
        let energy = vec3<f32>(cell[0].w, cell[1].w, cell[2].w);
        for (var f = 0u; f < 4u; f++) {
            sum[f] += energy * basis[min(first + f, 24u)];
        }
    }
    sum = reduce(sum, lane);
    if lane < 4u && first + lane < 25u {
        light.harmonics[first + lane] = vec4<f32>(sum[lane], light.harmonics[first + lane].w);
    }
}
