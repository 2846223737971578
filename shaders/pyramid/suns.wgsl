// Finds the seeds of an OEM's suns, what the rest is clamped to, the scale of the maps, and the suns: `Suns`
// of crates/core/src/pyramid/suns.rs.
#include "common/direction.wgsl"
#include "common/octahedral.wgsl"
#include "common/reduce.wgsl"
#include "common/planes.wgsl"
#include "common/light.wgsl"

const GROUP_SIZE = 256u;
// Blocks along an edge of the finest grid.
const FINEST = 128u;
// Texels closer to a seed than this, on the unit sphere, are no seeds; at twice the distance they count
// fully.
const NEAR = 0.02f;
// The same in texels of the map, over its edge.
const NEAR_TEXELS = 7.0f;
// Bits of a brightness that do not count.
const BELOW = 255u;
// Areas along an edge, each of which an invocation keeps while seeds are sought.
const AREAS = 16u;
const_assert AREAS * AREAS == GROUP_SIZE;
// No texel.
const NONE = 0xffffffffu;

// For each block the bits of its greatest brightness, which sort like it, and the texel that has that,
// counted by blocks; then the seeds. Brightness without BELOW.
@group(0) @binding(5) var<storage, read_write> blocks: array<vec4<u32>>;
@group(0) @binding(6) var<storage, read_write> light: OctaglossLight;

// Moments of a channel's energy: of offsets from the seed, and all; of products xx, yy, zz; of xy, yz, zx.
alias Reduced = array<vec4<f32>, 3>;

fn combine(a: Reduced, b: Reduced) -> Reduced {
    return Reduced(a[0] + b[0], a[1] + b[1], a[2] + b[2]);
}

var<workgroup> most: array<atomic<u32>, GROUP_SIZE>;
var<workgroup> first: array<atomic<u32>, GROUP_SIZE>;

// The greatest value among the invocations with the same `part`, and the least texel that has it.
fn first_of_part(own: vec2<u32>, part: u32, lane: u32) -> vec2<u32> {
    workgroupBarrier();
    atomicStore(&most[lane], 0u);
    atomicStore(&first[lane], NONE);
    workgroupBarrier();
    atomicMax(&most[part], own.x);
    workgroupBarrier();
    let greatest = atomicLoad(&most[part]);
    if own.x == greatest {
        atomicMin(&first[part], own.y);
    }
    workgroupBarrier();
    return vec2<u32>(greatest, atomicLoad(&first[part]));
}

var<workgroup> seeds: array<vec3<f32>, SUNS>;

fn side() -> u32 {
    return min(table.inner, FINEST);
}

fn block() -> u32 {
    return table.inner / side();
}

// Texel `k`, counted by blocks.
fn texel_of(k: u32) -> vec2<u32> {
    let size = block() * block();
    let own = k / size;
    let within = k % size;
    return vec2<u32>(own % side(), own / side()) * block()
        + vec2<u32>(within % block(), within / block());
}

fn brightness(at: u32) -> f32 {
    return max(max(red[at], green[at]), blue[at]) / solid_angle[at];
}

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

fn block_count() -> u32 {
    return side() * side();
}

// The brightest texel of each block, one texel an invocation.
@compute @workgroup_size(GROUP_SIZE)
fn brightest(
    @builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32,
) {
    let size = block() * block();
    let value = counted(brightness(place_in_plane(texel_of(id.x))));
    let found = first_of_part(vec2<u32>(value, id.x), lane / size, lane);
    if lane % size == 0u {
        blocks[id.x / size] = vec4<u32>(found, 0u, 0u);
    }
}

fn counted(brightness: f32) -> u32 {
    return bitcast<u32>(brightness) & ~BELOW;
}

// Block `k` of an area.
fn block_of(area: u32, k: u32) -> u32 {
    let edge = side() / AREAS;
    let at = vec2<u32>(area % AREAS, area / AREAS) * edge + vec2<u32>(k % edge, k / edge);
    return at.y * side() + at.x;
}

fn blocks_of_area() -> u32 {
    return block_count() / GROUP_SIZE;
}

// The brighter of two texels; of equals the first.
fn brighter(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return select(a, b, b.x > a.x || (b.x == a.x && b.y < a.y));
}

// The brightest texel of `area` beside the first `count` seeds, of those that an invocation visits.
fn brightest_of(area: u32, count: u32, lane: u32) -> vec2<u32> {
    let size = block() * block();
    var found = vec2<u32>(0u, NONE);
    for (var k = lane; k < blocks_of_area() * size; k += GROUP_SIZE) {
        let own = block_of(area, k / size) * size + k % size;
        let texel = texel_of(own);
        let value = brightness(place_in_plane(texel)) * apart(texel, 0u, count);
        found = brighter(found, vec2<u32>(counted(value), own));
    }
    return found;
}

var<workgroup> touched: array<u32, GROUP_SIZE>;
var<workgroup> touched_count: atomic<u32>;
var<workgroup> touched_all: u32;

// The seeds; then the scale, and what the rest is clamped to, by what is the brightest beside all of them.
// One workgroup: areas whose brightest texel is near a new seed are read again, by all invocations.
@compute @workgroup_size(GROUP_SIZE)
fn seek(@builtin(local_invocation_index) lane: u32) {
    var own = vec2<u32>(0u, NONE);
    for (var k = 0u; k < blocks_of_area(); k++) {
        own = brighter(own, blocks[block_of(lane, k)].xy);
    }
    var greatest = 0u;
    for (var count = 0u; count < SUNS; count++) {
        let found = first_of_part(own, 0u, lane);
        // The first seed is the brightest texel of all.
        greatest = max(greatest, found.x);
        let seed = direction_of(texel_of(found.y));
        if lane == 0u {
            seeds[count] = seed;
            blocks[block_count() + count] = vec4<u32>(bitcast<vec3<u32>>(seed), 0u);
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
            let again = first_of_part(brightest_of(area, count + 1u, lane), 0u, lane);
            own = select(own, again, lane == area);
        }
    }
    let last = first_of_part(own, 0u, lane).x;
    if lane == 0u {
        let clamped = select(0u, last | BELOW, last > 0u);
        // `exponent` of crates/core/src/pyramid/levels.rs.
        var exponent = select(0, exponent_of(greatest), greatest > 0u);
        if clamped > 0u {
            exponent = clamp(exponent_of(clamped) + 19, exponent - 40, exponent);
        }
        light.scale = bitcast<f32>(u32(127 - exponent) << 23u);
        light.unscale = bitcast<f32>(u32(127 + exponent) << 23u);
        light.clamp = bitcast<f32>(clamped) * light.scale;
    }
}

fn exponent_of(brightness: u32) -> i32 {
    return max(i32(brightness >> 23u) - 126, -100) - 15;
}

// One sun a workgroup.
@compute @workgroup_size(GROUP_SIZE)
fn suns(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    if lane < SUNS {
        seeds[lane] = bitcast<vec3<f32>>(blocks[block_count() + lane].xyz);
    }
    workgroupBarrier();
    let own = moments(group.x, lane);
    let channels = array<Channel, 3>(
        channel_of(seeds[group.x], reduce(own[0], lane)), channel_of(seeds[group.x], reduce(own[1], lane)),
        channel_of(seeds[group.x], reduce(own[2], lane)));
    if lane != 0u {
        return;
    }
    let energy = vec3<f32>(channels[0].energy, channels[1].energy, channels[2].energy);
    let all = energy.x + energy.y + energy.z;
    if all == 0.0 {
        set_sun(group.x, OctaglossSun(), vec3<f32>());
        return;
    }
    let share = energy / all;
    var middle = share.x * channels[0].direction + share.y * channels[1].direction
        + share.z * channels[2].direction;
    // Channels that are opposite leave no direction.
    if squared(middle) < 1e-12 {
        middle = vec3<f32>(0.0, 0.0, 1.0);
    }
    // Two axes that touch the sphere.
    let up = select(vec3<f32>(0.0, 1.0, 0.0), vec3<f32>(1.0, 0.0, 0.0), abs(middle.y) > abs(middle.x));
    let t = normalize(cross(up, middle));
    let b = normalize(cross(middle, t));
    // Covariances along t, along both, along b.
    let red = seen_along(channels[0], t, b);
    let green = seen_along(channels[1], t, b);
    let blue = seen_along(channels[2], t, b);
    let mean = share.x * red + share.y * green + share.z * blue;
    // Half the sum of its eigenvalues, and half their difference.
    let half = 0.5 * (mean.x + mean.z);
    let differ = 0.5 * (mean.x - mean.z);
    let apart = length(vec2<f32>(differ, mean.y));
    let square = max(half + apart, 0.0) - max(half - apart, 0.0);
    let angle = 0.5 * atan2(mean.y, select(1.0, differ, apart > 0.0));
    let half_axis = sqrt(square) * (cos(angle) * t + sin(angle) * b);
    let spread = max(vec3<f32>(red.x + red.z, green.x + green.z, blue.x + blue.z) - square, vec3<f32>());
    let sun = OctaglossSun(
        vec4<f32>(channels[0].direction, spread.x), vec4<f32>(channels[1].direction, spread.y),
        vec4<f32>(channels[2].direction, spread.z), energy * light.unscale, 0.0);
    set_sun(group.x, sun, half_axis);
}

fn set_sun(k: u32, sun: OctaglossSun, half_axis: vec3<f32>) {
    light.suns[k] = sun;
    light.harmonics[3u * k].w = half_axis.x;
    light.harmonics[3u * k + 1u].w = half_axis.y;
    light.harmonics[3u * k + 2u].w = half_axis.z;
}

// Moments of each channel over the light of sun `own` that an invocation visits.
fn moments(own: u32, lane: u32) -> array<Reduced, 3> {
    var sums: array<Reduced, 3>;
    // Four reads under way at once: there are at least 1024 blocks.
    for (var b = lane; b < block_count(); b += 4u * GROUP_SIZE) {
        let found = vec4<u32>(
            blocks[b].x, blocks[b + GROUP_SIZE].x, blocks[b + 2u * GROUP_SIZE].x,
            blocks[b + 3u * GROUP_SIZE].x);
        for (var k = 0u; k < 4u; k++) {
            if bitcast<f32>(found[k] | BELOW) * light.scale > light.clamp {
                add_block(&sums, b + k * GROUP_SIZE, own);
            }
        }
    }
    return sums;
}

// Adds the light of block `b` that is sun `own`'s.
fn add_block(sums: ptr<function, array<Reduced, 3>>, b: u32, own: u32) {
    let size = block() * block();
    for (var k = b * size; k < (b + 1u) * size; k++) {
        let texel = texel_of(k);
        let at = place_in_plane(texel);
        let bright = brightness(at) * light.scale;
        let direction = direction_of(texel);
        if bright > light.clamp && nearest_seed(direction) == own {
            // Scaled: squares of energies overflow.
            let given = energy_at(at) * light.scale * (1.0 - light.clamp / bright);
            let offset = direction - seeds[own];
            // The light of the texel's area is at its centre.
            let width = 2.0 / f32(table.inner);
            let steps = steps_from_oct(uv_of(texel));
            let u = steps[0] * width;
            let v = steps[1] * width;
            let of_one = Reduced(
                vec4<f32>(offset, 1.0),
                vec4<f32>(offset * offset - (u * u + v * v) / 12.0, 0.0),
                vec4<f32>(offset * offset.yzx - (u * u.yzx + v * v.yzx) / 12.0, 0.0));
            (*sums)[0] = combine((*sums)[0], times(given.x, of_one));
            (*sums)[1] = combine((*sums)[1], times(given.y, of_one));
            (*sums)[2] = combine((*sums)[2], times(given.z, of_one));
        }
    }
}

fn times(energy: f32, moments: Reduced) -> Reduced {
    return Reduced(energy * moments[0], energy * moments[1], energy * moments[2]);
}

// The light of one channel.
struct Channel {
    direction: vec3<f32>,
    energy: f32,
    // Its covariance: xx, yy, zz, and xy, yz, zx.
    squares: vec3<f32>,
    beside: vec3<f32>,
}

fn channel_of(seed: vec3<f32>, sum: Reduced) -> Channel {
    let energy = sum[0].w;
    if energy == 0.0 {
        return Channel();
    }
    let mean = sum[0].xyz / energy;
    return Channel(
        normalize(seed + mean), energy, sum[1].xyz / energy - mean * mean,
        sum[2].xyz / energy - mean * mean.yzx);
}

// The covariance of a channel along t, along t and b, and along b.
fn seen_along(own: Channel, t: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(
        dot(own.squares, t * t) + 2.0 * dot(own.beside, t * t.yzx),
        dot(own.squares, t * b) + dot(own.beside, t * b.yzx + t.yzx * b),
        dot(own.squares, b * b) + 2.0 * dot(own.beside, b * b.yzx));
}

fn nearest_seed(direction: vec3<f32>) -> u32 {
    var nearest = 0u;
    var least = squared(direction - seeds[0]);
    for (var k = 1u; k < SUNS; k++) {
        let own = squared(direction - seeds[k]);
        if own < least {
            nearest = k;
            least = own;
        }
    }
    return nearest;
}

fn squared(v: vec3<f32>) -> f32 {
    return dot(v, v);
}

fn uv_of(texel: vec2<u32>) -> vec2<f32> {
    return (vec2<f32>(texel) + 0.5) * (2.0 / f32(table.inner)) - 1.0;
}

fn direction_of(texel: vec2<u32>) -> vec3<f32> {
    return direction_from_oct(uv_of(texel));
}
