// Finds the brightest blocks of an OEM, what the rest is clamped to, and the scale of the maps: `Suns` of
// crates/core/src/pyramid/suns.rs. Planes hold energies (radiance times solid angle, float32) and solid angles in
// steradians.
#include "common/direction.wgsl"
#include "common/octahedral.wgsl"
#include "common/reduce.wgsl"
#include "common/table.wgsl"
#include "common/light.wgsl"

const GROUP_SIZE = 256u;
// Blocks along an edge of the finest grid.
const FINEST = 128u;

@group(0) @binding(1) var<storage, read> red: array<f32>;
@group(0) @binding(2) var<storage, read> green: array<f32>;
@group(0) @binding(3) var<storage, read> blue: array<f32>;
@group(0) @binding(4) var<storage, read> solid_angle: array<f32>;
@group(0) @binding(5) var<storage, read_write> blocks: array<u32>;
@group(0) @binding(6) var<storage, read_write> light: OctaglossLight;

// The bits of a brightness, which sort like it, and the block that has it.
alias Reduced = vec2<u32>;

// Whether `b` comes before `a`.
fn precedes(b: Reduced, a: Reduced) -> bool {
    return b.x > a.x || (b.x == a.x && b.y < a.y);
}

fn combine(a: Reduced, b: Reduced) -> Reduced {
    return select(a, b, precedes(b, a));
}

fn side() -> u32 {
    return min(table.inner, FINEST);
}

// Texel `k` of block `own`.
fn texel_of(own: u32, k: u32) -> vec2<u32> {
    let block = table.inner / side();
    return vec2<u32>(own % side(), own / side()) * block + vec2<u32>(k % block, k / block);
}

fn energy_at(at: u32) -> vec3<f32> {
    return vec3<f32>(red[at], green[at], blue[at]);
}

fn brightness(at: u32) -> f32 {
    return max(max(red[at], green[at]), blue[at]) / solid_angle[at];
}

@compute @workgroup_size(64)
fn brightest_of_blocks(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= side() * side() {
        return;
    }
    let block = table.inner / side();
    var most = 0.0;
    for (var k = 0u; k < block * block; k++) {
        most = max(most, brightness(place_in_plane(texel_of(id.x, k))));
    }
    blocks[id.x] = bitcast<u32>(most);
}

@compute @workgroup_size(GROUP_SIZE)
fn suns(@builtin(local_invocation_index) lane: u32) {
    var chosen: array<u32, SUNS>;
    var last = Reduced(0xffffffffu, 0u);
    var greatest = 0u;
    for (var k = 0u; k <= SUNS; k++) {
        var own = Reduced(0u, 0xffffffffu);
        for (var block = lane; block < side() * side(); block += GROUP_SIZE) {
            let candidate = Reduced(blocks[block], block);
            if precedes(last, candidate) {
                own = combine(own, candidate);
            }
        }
        last = reduce(own, lane);
        if k == 0u {
            greatest = last.x;
        }
        if k < SUNS {
            chosen[k] = last.y;
        }
    }
    let clamp = bitcast<f32>(last.x);
    // `exponent` of crates/core/src/pyramid/levels.rs.
    let exponent = select(0, max(i32(greatest >> 23u) - 126, -100) - 15, greatest > 0u);
    let scale = bitcast<f32>(u32(127 - exponent) << 23u);
    let unscale = bitcast<f32>(u32(127 + exponent) << 23u);
    if lane < SUNS {
        light.suns[lane] = sun_of(chosen[lane], clamp, scale);
        light.suns[lane].energy *= unscale;
    }
    if lane == 0u {
        light.scale = scale;
        light.unscale = unscale;
        light.clamp = clamp * scale;
    }
}

// The energy of a texel above what it is clamped to, scaled: squares of energies overflow.
fn excess(at: u32, clamp: f32, scale: f32) -> vec3<f32> {
    let own = brightness(at);
    return energy_at(at) * scale * select(0.0, 1.0 - clamp / own, own > clamp);
}

// Its energy is scaled.
fn sun_of(own: u32, clamp: f32, scale: f32) -> OctaglossSun {
    let block = table.inner / side();
    var energy = vec3<f32>();
    // Energy times direction, a column for each channel.
    var means: mat3x3<f32>;
    for (var k = 0u; k < block * block; k++) {
        let texel = texel_of(own, k);
        let given = excess(place_in_plane(texel), clamp, scale);
        let direction = direction_of(texel);
        energy += given;
        means += mat3x3<f32>(given.x * direction, given.y * direction, given.z * direction);
    }
    for (var c = 0; c < 3; c++) {
        means[c] = direction_of_sum(means[c]);
    }
    var apart = vec3<f32>();
    for (var k = 0u; k < block * block; k++) {
        let texel = texel_of(own, k);
        let direction = direction_of(texel);
        let squares = vec3<f32>(
            squared(direction - means[0]), squared(direction - means[1]), squared(direction - means[2]));
        apart += excess(place_in_plane(texel), clamp, scale) * (squares + texel_spread(texel));
    }
    let spreads = select(vec3<f32>(), apart / energy, energy > vec3<f32>());
    return OctaglossSun(
        vec4<f32>(means[0], spreads.x), vec4<f32>(means[1], spreads.y), vec4<f32>(means[2], spreads.z),
        energy, 0.0);
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

// Mean squared distance on the sphere of a texel's points from its centre.
fn texel_spread(texel: vec2<u32>) -> f32 {
    let p = abs(octahedron_from_oct(uv_of(texel)));
    let squared = dot(p, p);
    let a = p.x - p.y;
    let b = p.z - p.y;
    let width = 2.0 / f32(table.inner);
    return width * width * (4.0 * squared - a * a - b * b) / (12.0 * squared * squared);
}
