// Extracts the brightest cells of an OEM as point emitters; src/realtime/emitters.rs explains why. Planes
// hold energies (radiance times solid angle, float32) and solid angles; brightness is a quarter of the
// channels' summed radiance.
//
// Order: brightest cells of each batch, brightest of all, then the residual map (`rest`) and the emitters.
#include "common/light.wgsl"
#include "common/octahedral.wgsl"
#include "common/table.wgsl"

const GROUP_SIZE = 256u;
const EDGE = 16u;
// Most cells along an edge of the grid.
const GRID = 256u;
// Cells that a workgroup sorts, and how many it keeps: one per emitter, and the next brightest.
const BATCH = 1024u;
const KEPT = EMITTERS + 1u;

// Bit patterns of the channels, which are mostly copied: drivers flush subnormals.
@group(0) @binding(1) var<storage, read> red: array<u32>;
@group(0) @binding(2) var<storage, read> green: array<u32>;
@group(0) @binding(3) var<storage, read> blue: array<u32>;
@group(0) @binding(4) var<storage, read> solid_angle: array<f32>;
@group(0) @binding(5) var<storage, read_write> brightness: array<f32>;
// Brightness as bits, and cell index, brightest first.
@group(0) @binding(6) var<storage, read> listed: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> brightest: array<vec2<u32>>;
@group(0) @binding(8) var<storage, read_write> rest_red: array<u32>;
@group(0) @binding(9) var<storage, read_write> rest_green: array<u32>;
@group(0) @binding(10) var<storage, read_write> rest_blue: array<u32>;
@group(0) @binding(11) var<storage, read_write> light: OctaglossLight;

// Texels along an edge of a cell.
fn block() -> u32 {
    return max(table.inner / GRID, 1u);
}

// Cells along an edge of the grid.
fn side() -> u32 {
    return table.inner / block();
}

// Texel `k` of a cell.
fn texel_of(cell: u32, k: u32) -> vec2<u32> {
    let n = block();
    return vec2<u32>(cell % side(), cell / side()) * n + vec2<u32>(k % n, k / n);
}

fn energy(at: u32) -> vec3<f32> {
    return vec3<f32>(bitcast<f32>(red[at]), bitcast<f32>(green[at]), bitcast<f32>(blue[at]));
}

var<workgroup> batch: array<vec2<u32>, BATCH>;

// Bit patterns of non-negative floats sort like their values.
fn precedes(a: vec2<u32>, b: vec2<u32>) -> bool {
    return a.x > b.x || (a.x == b.x && a.y < b.y);
}

// Sorts the batch by Batcher's bitonic sort and stores its first entries.
fn keep_brightest(group: u32, lane: u32) {
    for (var size = 2u; size <= BATCH; size *= 2u) {
        for (var stride = size / 2u; stride > 0u; stride /= 2u) {
            workgroupBarrier();
            for (var pair = lane; pair < BATCH / 2u; pair += GROUP_SIZE) {
                let i = 2u * pair - (pair & (stride - 1u));
                let a = batch[i];
                let b = batch[i + stride];
                if precedes(b, a) == ((i & size) == 0u) {
                    batch[i] = b;
                    batch[i + stride] = a;
                }
            }
        }
    }
    workgroupBarrier();
    if lane < KEPT {
        brightest[group * KEPT + lane] = batch[lane];
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn brightest_cells(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    for (var k = lane; k < BATCH; k += GROUP_SIZE) {
        let cell = group.x * BATCH + k;
        batch[k] = vec2<u32>(0u, cell);
        if cell < side() * side() {
            var sum = vec2<f32>();
            for (var texel = 0u; texel < block() * block(); texel++) {
                let at = place_in_plane(texel_of(cell, texel));
                let own = energy(at);
                sum += vec2<f32>(own.x + own.y + own.z, solid_angle[at]);
            }
            // A quarter, so that the sum of three radiances does not overflow.
            let own = 0.25 * sum.x / sum.y;
            brightness[cell] = own;
            batch[k].x = bitcast<u32>(own);
        }
    }
    keep_brightest(group.x, lane);
}

@compute @workgroup_size(GROUP_SIZE)
fn brightest_of_lists(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    for (var k = lane; k < BATCH; k += GROUP_SIZE) {
        let at = group.x * BATCH + k;
        batch[k] = vec2<u32>(0u, 0xffffffffu);
        if at < arrayLength(&listed) {
            batch[k] = listed[at];
        }
    }
    keep_brightest(group.x, lane);
}

// Share of a cell's energy left in the residual map: the cell is clamped to the brightest cell without an
// emitter.
fn share_kept(own: f32) -> f32 {
    let most = bitcast<f32>(listed[KEPT - 1u].x);
    return select(1.0, most / own, own > most);
}

@compute @workgroup_size(EDGE, EDGE)
fn rest(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= table.side || id.y >= table.side {
        return;
    }
    let texel = wrap_texel(table.inner, vec2<i32>(id.xy) - i32(table.border));
    let cell = texel / block();
    let kept = share_kept(brightness[cell.y * side() + cell.x]);
    let at = id.y * table.pitch + id.x;
    var bits = vec3<u32>(red[at], green[at], blue[at]);
    if kept < 1.0 {
        bits = bitcast<vec3<u32>>(kept * bitcast<vec3<f32>>(bits));
    }
    rest_red[at] = bits.x;
    rest_green[at] = bits.y;
    rest_blue[at] = bits.z;
}

// Mean squared distance on the sphere from the centre of a texel of width 1 at `uv`.
fn texel_spread(uv: vec2<f32>) -> f32 {
    let p = abs(octahedron_from_oct(uv));
    let squared = dot(p, p);
    let apart = p.xz - p.y;
    return (4.0 * squared - dot(apart, apart)) / (12.0 * squared * squared);
}

@compute @workgroup_size(KEPT)
fn emitters(@builtin(local_invocation_index) lane: u32) {
    if lane == KEPT - 1u {
        return;
    }
    let given = 1.0 - share_kept(bitcast<f32>(listed[lane].x));
    var emitter = OctaglossEmitter(vec3<f32>(0.0, 1.0, 0.0), 0.0, vec3<f32>(), 0.0);
    if given > 0.0 {
        let width = 2.0 / f32(table.inner);
        for (var k = 0u; k < block() * block(); k++) {
            emitter.energy += energy(place_in_plane(texel_of(listed[lane].y, k)));
        }
        let whole = emitter.energy.x + emitter.energy.y + emitter.energy.z;
        var mean = vec3<f32>();
        for (var k = 0u; k < block() * block(); k++) {
            let texel = texel_of(listed[lane].y, k);
            let own = energy(place_in_plane(texel));
            let share = (own.x + own.y + own.z) / whole;
            mean += share * direction_from_oct((vec2<f32>(texel) + 0.5) * width - 1.0);
        }
        emitter.direction = normalize(mean);
        for (var k = 0u; k < block() * block(); k++) {
            let texel = texel_of(listed[lane].y, k);
            let own = energy(place_in_plane(texel));
            let share = (own.x + own.y + own.z) / whole;
            let uv = (vec2<f32>(texel) + 0.5) * width - 1.0;
            let apart = direction_from_oct(uv) - emitter.direction;
            emitter.spread += share * (dot(apart, apart) + width * width * texel_spread(uv));
        }
        emitter.energy *= given;
    }
    light.emitters[lane] = emitter;
}
