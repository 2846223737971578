// The levels of a pyramid: crates/core/src/pyramid/levels.rs and sharp.rs.
#include "common/octahedral.wgsl"
#include "common/planes.wgsl"
#include "common/bordered.wgsl"
#include "common/seeds.wgsl"

const EDGE = 8u;
// The sharp level's Gaussian ends at so many standard deviations, where it has this share of its covariance.
const CUT = 3.0f;
const CUT_COVARIANCE = 0.949448f;
// More than it reaches by flat texels.
const MARGIN = 1.1f;
// Texels along an edge from which on the sphere is as flat under the Gaussian.
const LARGE = 256u;

@group(0) @binding(5) var<storage, read> found: Seeds;
@group(0) @binding(6) var finer: texture_2d<f32>;
@group(0) @binding(9) var linear: sampler;
// The mirror without suns, row by row: halves of red and green, of blue.
@group(0) @binding(10) var<storage, read_write> rest: array<vec2<u32>>;
// What dispatches read that stand beside `sharp`, and beside the first cascade: the barrier before these is
// theirs, too.
@group(0) @binding(11) var<storage, read> cells: array<f32>;
@group(0) @binding(12) var<storage, read> excess: array<f32>;
@group(0) @binding(13) var<storage, read> sums_of_harmonics: array<f32>;

// Radiance of the OEM, scaled.
@compute @workgroup_size(EDGE, EDGE)
fn mirror(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2<u32>(level.inner)) {
        return;
    }
    let at = place_in_plane(id.xy);
    let own = energy_at(at) / solid_angle[at] * found.scale;
    let brightness = max(max(own.x, own.y), own.z);
    // The greatest half float.
    store(vec2<i32>(id.xy), own * select(1.0, 65504.0 / brightness, brightness > 65504.0));
    let kept = own * select(1.0, found.clamp / brightness, brightness > found.clamp);
    let halves = vec2<u32>(pack2x16float(kept.xy), pack2x16float(vec2<f32>(kept.z, 0.0)));
    rest[id.y * level.inner + id.x] = halves;
}

// A texel's direction, and the covariance of a Gaussian there along two axes that touch the sphere.
struct Place {
    direction: vec3<f32>,
    along: vec3<f32>,
    across: vec3<f32>,
    // Of the first axis, of both, of the second.
    covariance: vec3<f32>,
    // A step along u, which the first axis has; along v, on both.
    steps: vec3<f32>,
}

// Texel `at`, for a Gaussian of the level's variance less what a bilinear read adds.
fn place_of(at: vec2<u32>) -> Place {
    let texel = 2.0 / f32(level.inner);
    let uv = (vec2<f32>(at) + 0.5) * texel - 1.0;
    let direction = direction_from_oct(uv);
    let steps = steps_from_oct(uv);
    let along = normalize(steps[0]);
    let across = cross(direction, along);
    let long = length(steps[0]) * texel;
    let shear = dot(steps[1], along) * texel;
    let wide = dot(steps[1], across) * texel;
    let variance = level.variance;
    return Place(
        direction, along, across,
        vec3<f32>(
            variance - (long * long + shear * shear) / 6.0, -shear * wide / 6.0,
            variance - wide * wide / 6.0),
        vec3<f32>(long, shear, wide));
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

fn rest_at(at: vec2<i32>) -> vec3<f32> {
    let texel = rest[at.y * i32(level.inner) + at.x];
    return vec3<f32>(unpack2x16float(texel.x), unpack2x16float(texel.y).x);
}

// Sums of weights, and of light: of texels as they are, mirrored along u, along v, and along both. No array:
// what is indexed by a loop stands in memory.
struct Sums {
    weight: f32,
    own: vec3<f32>,
    along_u: vec3<f32>,
    along_v: vec3<f32>,
    along_both: vec3<f32>,
}

fn add(sums: ptr<function, Sums>, weight: f32, own: vec2<i32>) {
    let far = i32(level.inner) - 1 - own;
    (*sums).weight += weight;
    (*sums).own += weight * rest_at(own);
    (*sums).along_u += weight * rest_at(vec2<i32>(far.x, own.y));
    (*sums).along_v += weight * rest_at(vec2<i32>(own.x, far.y));
    (*sums).along_both += weight * rest_at(far);
}

// A Gaussian. The weight of a point p of the octahedron is |p|^-3 exp(-exponent(p, p) / |p|^2).
struct Bell {
    along: vec3<f32>,
    across: vec3<f32>,
    // Half of the inverse of its covariance.
    inverse: vec3<f32>,
}

fn exponent(bell: Bell, a: vec2<f32>, b: vec2<f32>) -> f32 {
    return bell.inverse.x * a.x * b.x + bell.inverse.y * (a.x * b.y + a.y * b.x) + bell.inverse.z * a.y * b.y;
}

// A point on the axes, which are at right angles to the Gaussian's direction.
fn on_axes(bell: Bell, point: vec3<f32>) -> vec2<f32> {
    return vec2<f32>(dot(point, bell.along), dot(point, bell.across));
}

fn point_of(at: vec2<i32>) -> vec3<f32> {
    return octahedron_from_oct((vec2<f32>(at) + 0.5) * (2.0 / f32(level.inner)) - 1.0);
}

// Adds texels of row `j` from `centre`, within one face of the octahedron: squares of points and exponents
// are polynomials of the place in the row there.
fn add_row(sums: ptr<function, Sums>, bell: Bell, centre: vec2<i32>, j: i32, from_i: i32, to_i: i32) {
    let middle = centre + vec2<i32>(0, j);
    let point = point_of(middle);
    let step = point_of(middle + vec2<i32>(1, 0)) - point;
    let at = on_axes(bell, point);
    let by = on_axes(bell, step);
    let exponents = vec3<f32>(exponent(bell, at, at), 2.0 * exponent(bell, at, by), exponent(bell, by, by));
    let squares = vec3<f32>(dot(point, point), 2.0 * dot(point, step), dot(step, step));
    for (var i = from_i; i <= to_i; i++) {
        let k = f32(i);
        let nearness = inverseSqrt(squares.x + k * (squares.y + k * squares.z));
        let nearer = nearness * nearness;
        let own = nearer * (exponents.x + k * (exponents.y + k * exponents.z));
        if own < 0.5 * CUT * CUT {
            add(sums, nearer * nearness * exp(-own), middle + vec2<i32>(i, 0));
        }
    }
}

// The same where the row crosses edges of faces or of the square.
fn add_folded(
    sums: ptr<function, Sums>, bell: Bell, centre: vec2<i32>, j: i32, reach: vec2<i32>,
) {
    for (var i = -reach.x; i <= reach.x; i++) {
        var own = centre + vec2<i32>(i, j);
        if any(own < vec2<i32>()) {
            own = folded(i32(level.inner), own);
            // Around +-X and +-Z the unfolded plane shows every texel twice.
            if all(abs(own - centre) <= reach) {
                continue;
            }
        }
        let point = point_of(own);
        let nearness = inverseSqrt(dot(point, point));
        let at = nearness * on_axes(bell, point);
        let apart = exponent(bell, at, at);
        if apart < 0.5 * CUT * CUT {
            add(sums, nearness * nearness * nearness * exp(-apart), own);
        }
    }
}

const PART = EDGE * EDGE * 4u;
var<workgroup> parts: array<vec4<f32>, 4u * PART>;

// Sums of its texels under a Gaussian: for a texel of the first quarter, and for its places mirrored along u,
// along v and along both, whose weights are the same. Four invocations share the rows around a texel, and
// each of them stores one of its places.
@compute @workgroup_size(EDGE, EDGE, 4)
fn sharp(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    _ = &cells;
    let centre = vec2<i32>(id.xy);
    let place = place_of(id.xy);
    // Narrowed by a read, and by half as much: texels have the light of an area at one point.
    let round = vec3<f32>(level.variance, 0.0, level.variance);
    let c = (1.5 * place.covariance - 0.5 * round) / CUT_COVARIANCE;
    let inverse = 0.5 * vec3<f32>(c.z, -c.y, c.x) / (c.x * c.z - c.y * c.y);
    let bell = Bell(place.along, place.across, inverse);
    // The ellipse of texels that it reaches: along u and v, and along their sum.
    let width = MARGIN * CUT * sqrt(level.variance);
    let long = place.steps.x;
    let shear = place.steps.y;
    let wide = place.steps.z;
    let scale = width / abs(long * wide);
    let reach = scale * vec2<f32>(length(vec2<f32>(shear, wide)), long);
    let reach_of_sum = scale * length(vec2<f32>(long - shear, wide));
    let texels = vec2<i32>(ceil(reach));
    let half = i32(level.inner / 2u);
    let lies_in_face = level.inner >= LARGE && all(centre >= texels) && all(centre + texels < vec2<i32>(half))
        && abs(f32(centre.x + centre.y + 1 - half)) >= reach_of_sum;
    var sums = Sums();
    for (var j = i32(id.z) - texels.y; j <= texels.y; j += 4) {
        if lies_in_face {
            let middle = -shear / long * f32(j);
            let row = f32(j) * wide / width;
            let beside = width / long * sqrt(max(1.0 - row * row, 0.0));
            add_row(&sums, bell, centre, j, i32(ceil(middle - beside)), i32(floor(middle + beside)));
        } else {
            add_folded(&sums, bell, centre, j, texels);
        }
    }
    parts[lane] = vec4<f32>(sums.own, sums.weight);
    parts[PART + lane] = vec4<f32>(sums.along_u, sums.weight);
    parts[2u * PART + lane] = vec4<f32>(sums.along_v, sums.weight);
    parts[3u * PART + lane] = vec4<f32>(sums.along_both, sums.weight);
    workgroupBarrier();
    let first = id.z * PART + lane % (EDGE * EDGE);
    let sum = parts[first] + parts[first + EDGE * EDGE] + parts[first + 2u * EDGE * EDGE]
        + parts[first + 3u * EDGE * EDGE];
    let far = (vec2<u32>(id.z) & vec2<u32>(1u, 2u)) != vec2<u32>();
    store(select(centre, i32(level.inner) - 1 - centre, far), sum.xyz / sum.w);
}

// A level from the next finer one.
@compute @workgroup_size(EDGE, EDGE)
fn cascade(@builtin(global_invocation_id) id: vec3<u32>) {
    _ = &excess;
    _ = &sums_of_harmonics;
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
    // 1 - cos is bent, as Gaussians on the sphere do not make Gaussians: `Between` of
    // crates/core/src/pyramid/levels.rs.
    let half = 0.5 * (p * p + q * q);
    let bent = 1.0 + level.bend * half;
    let versine = half * bent;
    let to = place.direction * (1.0 - versine)
        + (place.along * p + place.across * q) * sqrt(bent * (1.0 - 0.5 * versine));
    return tap.z * textureSampleLevel(finer, linear, 0.5 + oct_from_direction(to) * scale, 0.0).xyz;
}
