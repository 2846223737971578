// Finds the seeds of an OEM's suns, what the rest is clamped to, and the scale of the maps: `Suns` of
// crates/core/src/pyramid/suns.rs.
#include "common/areas.wgsl"

// Texels closer to a seed than this, on the unit sphere, are no seeds; at twice the distance they count
// fully.
const NEAR = 0.02f;
// The same in texels of the map, over its edge.
const NEAR_TEXELS = 7.0f;
// No texel.
const NONE = 0xffffffffu;

// Of each texel, counted by blocks.
@group(0) @binding(5) var<storage, read_write> brightness: array<f32>;
// Of each area the bits of its greatest brightness without BELOW, which sort like it, and the texel that has
// that.
@group(0) @binding(6) var<storage, read_write> areas: array<vec2<u32>>;
// The same, to read.
@group(0) @binding(8) var<storage, read> known: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> found: Seeds;

var<workgroup> most: atomic<u32>;
var<workgroup> first: atomic<u32>;

// The greatest value among all invocations, and the least texel that has it.
fn brightest_of_all(own: vec2<u32>, lane: u32) -> vec2<u32> {
    workgroupBarrier();
    if lane == 0u {
        atomicStore(&most, 0u);
        atomicStore(&first, NONE);
    }
    workgroupBarrier();
    atomicMax(&most, own.x);
    workgroupBarrier();
    let greatest = atomicLoad(&most);
    if own.x == greatest {
        atomicMin(&first, own.y);
    }
    workgroupBarrier();
    return vec2<u32>(greatest, atomicLoad(&first));
}

fn counted(brightness: f32) -> u32 {
    // No greater than the greatest float.
    return (min(bitcast<u32>(brightness), 0x7f7fffffu - HALF) + HALF) & ~BELOW;
}

// The brighter of two texels; of equals the first.
fn brighter(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return select(a, b, b.x > a.x || (b.x == a.x && b.y < a.y));
}

// The brightest texel of an area, one area a workgroup.
@compute @workgroup_size(GROUP_SIZE)
fn brightest(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    var own = vec2<u32>(0u, NONE);
    for (var k = lane; k < texels_of_area(); k += GROUP_SIZE) {
        let texel = counted_in(group.x, k);
        let value = brightness_at(place_in_plane(texel_of(texel)));
        brightness[texel] = value;
        own = brighter(own, vec2<u32>(counted(value), texel));
    }
    own = brightest_of_all(own, lane);
    if lane == 0u {
        areas[group.x] = own;
    }
}

var<workgroup> seeds: array<vec3<f32>, SUNS>;

// How much a texel counts beside the seeds from `start` to `end`.
fn apart(texel: vec2<u32>, start: u32, end: u32) -> f32 {
    let direction = direction_of(texel);
    var nearest = 4.0;
    for (var k = start; k < end; k++) {
        nearest = min(nearest, squared(direction - seeds[k]));
    }
    let near = max(NEAR, NEAR_TEXELS / f32(table.inner));
    return clamp((nearest / (near * near) - 1.0) / 3.0, 0.0, 1.0);
}

// Texel `k` of an area beside the first `count` seeds. The last for `k` beyond it.
fn beside(area: u32, k: u32, count: u32) -> vec2<u32> {
    let texel = counted_in(area, min(k, texels_of_area() - 1u));
    return vec2<u32>(counted(brightness[texel] * apart(texel_of(texel), 0u, count)), texel);
}

// The brightest texel of `area` beside the first `count` seeds, of those that an invocation visits.
fn brightest_of(area: u32, count: u32, lane: u32) -> vec2<u32> {
    var own = vec2<u32>(0u, NONE);
    // Four reads under way at once.
    for (var k = lane; k < texels_of_area(); k += 4u * GROUP_SIZE) {
        let a = brighter(beside(area, k, count), beside(area, k + GROUP_SIZE, count));
        let b = brighter(beside(area, k + 2u * GROUP_SIZE, count), beside(area, k + 3u * GROUP_SIZE, count));
        own = brighter(own, brighter(a, b));
    }
    return own;
}

var<workgroup> touched: array<u32, GROUP_SIZE>;
var<workgroup> touched_count: atomic<u32>;
var<workgroup> touched_all: u32;

// The seeds; then the scale, and what the rest is clamped to, by what is the brightest beside all of them.
// One workgroup: areas whose brightest texel is near a new seed are read again, by all invocations.
@compute @workgroup_size(GROUP_SIZE)
fn seek(@builtin(local_invocation_index) lane: u32) {
    var own = known[lane];
    var greatest = 0u;
    for (var count = 0u; count < SUNS; count++) {
        let next = brightest_of_all(own, lane);
        // The first seed is the brightest texel of all.
        greatest = max(greatest, next.x);
        let seed = direction_of(texel_of(next.y));
        if lane == 0u {
            seeds[count] = seed;
            found.directions[count] = vec4<f32>(seed, 0.0);
            atomicStore(&touched_count, 0u);
        }
        workgroupBarrier();
        if apart(texel_of(own.y), count, count + 1u) < 1.0 {
            touched[atomicAdd(&touched_count, 1u)] = lane;
        }
        workgroupBarrier();
        if lane == 0u {
            touched_all = atomicLoad(&touched_count);
        }
        let all = workgroupUniformLoad(&touched_all);
        for (var k = 0u; k < all; k++) {
            let area = touched[k];
            let again = brightest_of_all(brightest_of(area, count + 1u, lane), lane);
            own = select(own, again, lane == area);
        }
    }
    let last = brightest_of_all(own, lane).x;
    if lane == 0u {
        let clamped = select(0u, last + HALF, last > 0u);
        // `exponent` of crates/core/src/pyramid/levels.rs.
        var exponent = select(0, exponent_of(greatest), greatest > 0u);
        if clamped > 0u {
            exponent = clamp(exponent_of(clamped) + 19, exponent - 40, exponent);
        }
        found.scale = bitcast<f32>(u32(127 - exponent) << 23u);
        found.unscale = bitcast<f32>(u32(127 + exponent) << 23u);
        found.clamp = bitcast<f32>(clamped) * found.scale;
    }
}

fn exponent_of(brightness: u32) -> i32 {
    return max(i32(brightness >> 23u) - 126, -100) - 15;
}
