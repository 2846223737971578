// The levels of a pyramid: crates/core/src/pyramid/levels.rs and sharp.rs.
#include "common/octahedral.wgsl"
#include "common/planes.wgsl"
#include "common/bordered.wgsl"
#include "common/light.wgsl"

const EDGE = 8u;
// The sharp level's Gaussian ends at so many standard deviations, where it has this share of its covariance.
const CUT = 3.0f;
const CUT_COVARIANCE = 0.949448f;

@group(0) @binding(5) var<storage, read> light: OctaglossLight;
@group(0) @binding(6) var finer: texture_2d<f32>;
@group(0) @binding(9) var linear: sampler;

// Radiance of the OEM, scaled.
@compute @workgroup_size(EDGE, EDGE)
fn mirror(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(level.inner)) {
        return;
    }
    let at = place_in_plane(id.xy);
    let own = energy_at(at) / solid_angle[at] * light.scale;
    let brightness = max(max(own.x, own.y), own.z);
    // The greatest half float.
    store(vec2<i32>(id.xy), own * select(1.0, 65504.0 / brightness, brightness > 65504.0));
}

// A texel's direction, and the covariance of a Gaussian there along two axes that touch the sphere.
struct Place {
    direction: vec3<f32>,
    along: vec3<f32>,
    across: vec3<f32>,
    // Of the first axis, of both, of the second.
    covariance: vec3<f32>,
    // Texels that a Gaussian of standard deviation 1 reaches along u and v.
    reach: vec2<f32>,
}

// Texel `at`, for a Gaussian of the level's variance less what a bilinear read adds.
fn place_of(at: vec2<u32>) -> Place {
    let texel = 2.0 / f32(level.inner);
    let uv = (vec2<f32>(at) + 0.5) * texel - 1.0;
    let direction = direction_from_oct(uv);
    let steps = steps_from_oct(uv);
    let by_u = steps[0];
    let by_v = steps[1];
    let along = normalize(by_u);
    let across = cross(direction, along);
    let long = length(by_u);
    let shear = dot(by_v, along);
    let wide = dot(by_v, across);
    let read = texel * texel / 6.0;
    let variance = level.variance;
    return Place(
        direction, along, across,
        vec3<f32>(
            variance - read * (long * long + shear * shear), -read * shear * wide,
            variance - read * wide * wide),
        vec2<f32>(length(by_v), long) / (abs(long * wide) * texel));
}

// The texel of the square that `at`, up to a square away, stands for.
fn folded(n: i32, at: vec2<i32>) -> vec2<i32> {
    var own = at;
    if own.x < 0 || own.x >= n {
        own = vec2<i32>(select(2 * n - 1 - own.x, -1 - own.x, own.x < 0), n - 1 - own.y);
    }
    if own.y < 0 || own.y >= n {
        own = vec2<i32>(n - 1 - own.x, select(2 * n - 1 - own.y, -1 - own.y, own.y < 0));
    }
    return own;
}

// Texel `at` of the mirror without suns, and 1.
fn rest_at(at: vec2<i32>) -> vec4<f32> {
    let texel = textureLoad(finer, at + i32(level.finer_border), 0).xyz;
    let brightness = max(max(texel.x, texel.y), texel.z);
    return vec4<f32>(texel * select(1.0, light.clamp / brightness, brightness > light.clamp), 1.0);
}

var<workgroup> parts: array<vec4<f32>, EDGE * EDGE * 16u>;

// Sums of its texels under a Gaussian: for a texel of the first quarter, and for its places mirrored along u,
// along v and along both, whose weights are the same. Four invocations share the rows around a texel, and
// each of them stores one of its places.
@compute @workgroup_size(EDGE, EDGE, 4)
fn sharp(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let n = i32(level.inner);
    let centre = vec2<i32>(id.xy);
    let place = place_of(id.xy);
    // Narrowed by a read, and by half as much: texels have the light of an area at one point.
    let round = vec3<f32>(level.variance, 0.0, level.variance);
    let c = (1.5 * place.covariance - 0.5 * round) / CUT_COVARIANCE;
    // Half of the inverse.
    let inverse = 0.5 * vec3<f32>(c.z, -c.y, c.x) / (c.x * c.z - c.y * c.y);
    let reach = vec2<i32>(ceil(place.reach * (1.1 * CUT * sqrt(level.variance))));
    var sums: array<vec4<f32>, 4>;
    for (var j = i32(id.z) - reach.y; j <= reach.y; j += 4) {
        for (var i = -reach.x; i <= reach.x; i++) {
            var own = centre + vec2<i32>(i, j);
            if any(own < vec2<i32>()) {
                own = folded(n, own);
                // Around +-X and +-Z the unfolded plane shows every texel twice.
                if all(abs(own - centre) <= reach) {
                    continue;
                }
            }
            let point = octahedron_from_oct((vec2<f32>(own) + 0.5) * (2.0 / f32(n)) - 1.0);
            let nearness = inverseSqrt(dot(point, point));
            // The axes are at right angles to the Gaussian's direction.
            let p = nearness * dot(point, place.along);
            let q = nearness * dot(point, place.across);
            let exponent = inverse.x * p * p + 2.0 * inverse.y * p * q + inverse.z * q * q;
            if exponent < 0.5 * CUT * CUT {
                let weight = nearness * nearness * nearness * exp(-exponent);
                let far = n - 1 - own;
                sums[0] += weight * rest_at(own);
                sums[1] += weight * rest_at(vec2<i32>(far.x, own.y));
                sums[2] += weight * rest_at(vec2<i32>(own.x, far.y));
                sums[3] += weight * rest_at(far);
            }
        }
    }
    for (var mirrored = 0u; mirrored < 4u; mirrored++) {
        parts[mirrored * EDGE * EDGE * 4u + lane] = sums[mirrored];
    }
    workgroupBarrier();
    let first = id.z * EDGE * EDGE * 4u + lane % (EDGE * EDGE);
    var sum = vec4<f32>();
    for (var part = 0u; part < 4u; part++) {
        sum += parts[first + part * EDGE * EDGE];
    }
    let far = (vec2<u32>(id.z) & vec2<u32>(1u, 2u)) != vec2<u32>();
    store(select(centre, n - 1 - centre, far), sum.xyz / sum.w);
}

// A level from the next finer one.
@compute @workgroup_size(EDGE, EDGE)
fn cascade(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(level.inner)) {
        return;
    }
    // The octahedron's mirrors take the texel to the first quarter.
    let far = id.xy >= vec2<u32>(level.inner / 2u);
    let place = place_of(select(id.xy, level.inner - 1u - id.xy, far));
    let mirrors = select(vec2<f32>(1.0), vec2<f32>(-1.0), far);
    let c = place.covariance;
    // The covariance's root, a triangle.
    let long = sqrt(c.x);
    let root = vec3<f32>(long, c.y / long, sqrt(c.z - c.y * c.y / c.x));
    let side = f32(level.finer_inner + 2u * level.finer_border);
    let scale = mirrors * (0.5 * f32(level.finer_inner) / side);
    var sum = vec3<f32>();
    // Five reads under way at once.
    for (var k = 0u; k < 25u; k += 5u) {
        sum += tap(k, place, root, scale) + tap(k + 1u, place, root, scale)
            + tap(k + 2u, place, root, scale) + tap(k + 3u, place, root, scale)
            + tap(k + 4u, place, root, scale);
    }
    store(vec2<i32>(id.xy), sum);
}

// A read of the cascade, weighted.
fn tap(k: u32, place: Place, root: vec3<f32>, scale: vec2<f32>) -> vec3<f32> {
    let tap = level.taps[k];
    let p = root.x * tap.x;
    let q = root.y * tap.x + root.z * tap.y;
    // A distance on the sphere whose 1 - cos is half its square.
    let half = 0.5 * (p * p + q * q);
    let to = place.direction * (1.0 - half)
        + (place.along * p + place.across * q) * sqrt(1.0 - 0.5 * half);
    return tap.z * textureSampleLevel(finer, linear, 0.5 + oct_from_direction(to) * scale, 0.0).xyz;
}
