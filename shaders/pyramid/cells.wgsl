// Moments of the light without suns in square cells, irradiance and harmonics:
// crates/core/src/pyramid/cells.rs.
#include "common/direction.wgsl"
#include "common/harmonics.wgsl"
#include "common/octahedral.wgsl"
#include "common/reduce.wgsl"
#include "common/table.wgsl"
#include "common/bordered.wgsl"
#include "common/light.wgsl"

const GROUP_SIZE = 64u;
// Cells along an edge of the finest grid.
const FINEST = 64u;

// For each channel, the sum of energy times direction, and of energy.
alias Reduced = vec3<f32>;

fn combine(a: Reduced, b: Reduced) -> Reduced {
    return a + b;
}

@group(0) @binding(1) var<storage, read> red: array<f32>;
@group(0) @binding(2) var<storage, read> green: array<f32>;
@group(0) @binding(3) var<storage, read> blue: array<f32>;
@group(0) @binding(4) var<storage, read> solid_angle: array<f32>;
@group(0) @binding(5) var<storage, read_write> light: OctaglossLight;
@group(0) @binding(6) var<storage, read_write> cells: array<array<vec4<f32>, 3>>;

fn side() -> u32 {
    return min(table.inner, FINEST);
}

@compute @workgroup_size(GROUP_SIZE)
fn cells_of_texels(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= side() * side() {
        return;
    }
    let block = table.inner / side();
    let corner = vec2<u32>(id.x % side(), id.x / side()) * block;
    var cell: array<vec4<f32>, 3>;
    for (var k = 0u; k < block * block; k++) {
        let texel = corner + vec2<u32>(k % block, k / block);
        let at = place_in_plane(texel);
        let direction = direction_from_oct((vec2<f32>(texel) + 0.5) * (2.0 / f32(table.inner)) - 1.0);
        let energy = vec3<f32>(red[at], green[at], blue[at]) * light.scale;
        let brightness = max(max(energy.x, energy.y), energy.z) / solid_angle[at];
        let kept = energy * select(1.0, light.clamp / brightness, brightness > light.clamp);
        let moment = vec4<f32>(direction, 1.0);
        cell[0] += kept.x * moment;
        cell[1] += kept.y * moment;
        cell[2] += kept.z * moment;
    }
    cells[id.x] = cell;
}

// Irradiance over pi, one texel a workgroup.
@compute @workgroup_size(GROUP_SIZE)
fn cosine(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let normal = direction_from_oct((vec2<f32>(group.xy) + 0.5) * (2.0 / f32(level.inner)) - 1.0);
    var sum = vec3<f32>();
    for (var k = lane; k < side() * side(); k += GROUP_SIZE) {
        let cell = cells[k];
        let facing = vec3<f32>(dot(cell[0].xyz, normal), dot(cell[1].xyz, normal), dot(cell[2].xyz, normal));
        sum += max(facing, vec3<f32>());
    }
    sum = reduce(sum, lane);
    if lane == 0u {
        store(vec2<i32>(group.xy), sum * 0.31830987);
    }
}

// One function a workgroup.
@compute @workgroup_size(GROUP_SIZE)
fn harmonics(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    var sum = vec3<f32>();
    for (var k = lane; k < side() * side(); k += GROUP_SIZE) {
        let cell = cells[k];
        var basis = harmonic_basis(direction_of_sum(cell[0].xyz + cell[1].xyz + cell[2].xyz));
        sum += vec3<f32>(cell[0].w, cell[1].w, cell[2].w) * basis[group.x];
    }
    sum = reduce(sum, lane);
    if lane == 0u {
        light.harmonics[group.x] = vec4<f32>(sum, light.harmonics[group.x].w);
    }
}
