// The light of a pyramid: its suns by the moments of the light above the clamp, `Sun` of
// crates/core/src/pyramid/suns.rs; harmonics by sums over cells.
#include "common/direction.wgsl"
#include "common/excess.wgsl"

const GROUP_SIZE = 256u;
const BASIS = 25u;
const_assert MOMENTS_OF_AREA == GROUP_SIZE;

@group(0) @binding(0) var<storage, read> found: Seeds;
@group(0) @binding(1) var<storage, read> excess: Excess;
@group(0) @binding(2) var<storage, read> harmonics: array<array<f32, 3u * BASIS>>;
@group(0) @binding(3) var<storage, read_write> light: OctaglossLight;

var<workgroup> is_bright: array<u32, GROUP_SIZE>;
// Moments of all areas.
var<workgroup> sums: array<f32, GROUP_SIZE>;

// One workgroup.
@compute @workgroup_size(GROUP_SIZE)
fn write_light(@builtin(local_invocation_index) lane: u32) {
    is_bright[lane] = excess.is_bright[lane];
    workgroupBarrier();
    var sum = 0.0;
    for (var area = 0u; area < GROUP_SIZE; area++) {
        if is_bright[area] != 0u {
            sum += excess.moments[area][lane];
        }
    }
    sums[lane] = sum;
    workgroupBarrier();
    if lane == 0u {
        light.scale = found.scale;
        light.unscale = found.unscale;
        light.clamp = found.clamp;
    }
    if lane < SUNS {
        set_sun_of(lane);
    }
    if lane < 3u * BASIS {
        var harmonic = 0.0;
        // Four reads under way at once: there are 8 or 32 sums.
        for (var k = 0u; k < arrayLength(&harmonics); k += 4u) {
            harmonic += harmonics[k][lane] + harmonics[k + 1u][lane] + harmonics[k + 2u][lane]
                + harmonics[k + 3u][lane];
        }
        light.harmonics[lane / 3u][lane % 3u] = harmonic;
    }
}

// Sun `k`, of the sums of its moments.
fn set_sun_of(k: u32) {
    let channels = array<Channel, 3>(channel_of(k, 0u), channel_of(k, 1u), channel_of(k, 2u));
    let energy = vec3<f32>(channels[0].energy, channels[1].energy, channels[2].energy);
    let all = energy.x + energy.y + energy.z;
    if all == 0.0 {
        set_sun(k, OctaglossSun(), vec3<f32>());
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
        vec4<f32>(channels[2].direction, spread.z), energy * found.unscale, 0.0);
    set_sun(k, sun, half_axis);
}

fn set_sun(k: u32, sun: OctaglossSun, half_axis: vec3<f32>) {
    light.suns[k] = sun;
    light.harmonics[3u * k].w = half_axis.x;
    light.harmonics[3u * k + 1u].w = half_axis.y;
    light.harmonics[3u * k + 2u].w = half_axis.z;
}

// The light of one channel.
struct Channel {
    direction: vec3<f32>,
    energy: f32,
    // Its covariance: xx, yy, zz, and xy, yz, zx.
    squares: vec3<f32>,
    beside: vec3<f32>,
}

// Channel `c` of sun `k`.
fn channel_of(k: u32, c: u32) -> Channel {
    let first = k * MOMENTS_OF_SUN + c * MOMENTS;
    let energy = sums[first + 3u];
    if energy == 0.0 {
        return Channel();
    }
    let mean = three(first) / energy;
    return Channel(
        normalize(found.directions[k].xyz + mean), energy, three(first + 4u) / energy - mean * mean,
        three(first + 7u) / energy - mean * mean.yzx);
}

fn three(first: u32) -> vec3<f32> {
    return vec3<f32>(sums[first], sums[first + 1u], sums[first + 2u]);
}

// The covariance of a channel along t, along t and b, and along b.
fn seen_along(own: Channel, t: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(
        dot(own.squares, t * t) + 2.0 * dot(own.beside, t * t.yzx),
        dot(own.squares, t * b) + dot(own.beside, t * b.yzx + t.yzx * b),
        dot(own.squares, b * b) + 2.0 * dot(own.beside, b * b.yzx));
}
