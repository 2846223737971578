// The levels of a pyramid: crates/core/src/pyramid/levels.rs and sharp.rs.
#include "common/octahedral.wgsl"
#include "common/table.wgsl"
#include "common/bordered.wgsl"
#include "common/light.wgsl"

const EDGE = 8u;
// The sharp level's Gaussian ends at so many standard deviations, where it has this share of its covariance.
const CUT = 3.0f;
const CUT_COVARIANCE = 0.949448f;

@group(0) @binding(1) var<storage, read> red: array<f32>;
@group(0) @binding(2) var<storage, read> green: array<f32>;
@group(0) @binding(3) var<storage, read> blue: array<f32>;
@group(0) @binding(4) var<storage, read> solid_angle: array<f32>;
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
    let own = vec3<f32>(red[at], green[at], blue[at]) / solid_angle[at] * light.scale;
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

// Sums of the texels of the mirror without suns under a Gaussian.
@compute @workgroup_size(EDGE, EDGE)
fn sharp(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(level.inner)) {
        return;
    }
    let n = i32(level.inner);
    let centre = vec2<i32>(id.xy);
    let place = place_of(id.xy);
    // Narrowed by a read, and by half as much: texels have the light of an area at one point.
    let round = vec3<f32>(level.variance, 0.0, level.variance);
    let c = (1.5 * place.covariance - 0.5 * round) / CUT_COVARIANCE;
    // Half of the inverse.
    let inverse = 0.5 * vec3<f32>(c.z, -c.y, c.x) / (c.x * c.z - c.y * c.y);
    let reach = vec2<i32>(ceil(place.reach * (1.1 * CUT * sqrt(level.variance))));
    var sum = vec3<f32>();
    var total = 0.0;
    for (var j = -reach.y; j <= reach.y; j++) {
        for (var i = -reach.x; i <= reach.x; i++) {
            var own = centre + vec2<i32>(i, j);
            if any((own < vec2<i32>()) | (own >= vec2<i32>(n))) {
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
                var texel = textureLoad(finer, own + i32(level.finer_border), 0).xyz;
                let brightness = max(max(texel.x, texel.y), texel.z);
                if brightness > light.clamp {
                    texel *= light.clamp / brightness;
                }
                sum += weight * texel;
                total += weight;
            }
        }
    }
    store(centre, sum / total);
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
    let shear = c.y / long;
    let wide = sqrt(c.z - c.y * c.y / c.x);
    let side = f32(level.finer_inner + 2u * level.finer_border);
    let scale = 0.5 * f32(level.finer_inner) / side;
    var sum = vec3<f32>();
    for (var k = 0u; k < 25u; k++) {
        let tap = level.taps[k];
        let p = long * tap.x;
        let q = shear * tap.x + wide * tap.y;
        // A distance on the sphere whose 1 - cos is half its square.
        let half = 0.5 * (p * p + q * q);
        let to = place.direction * (1.0 - half)
            + (place.along * p + place.across * q) * sqrt(1.0 - 0.5 * half);
        let at = 0.5 + oct_from_direction(to) * mirrors * scale;
        sum += tap.z * textureSampleLevel(finer, linear, at, 0.0).xyz;
    }
    store(vec2<i32>(id.xy), sum);
}
