// Draws triangles into a panel of the tennis-ball map by unwrapping their corners:
// crates/gpu/src/direct/unwrap.rs. Angles are in radians.
#include "common/direct.wgsl"

// Values of `Panel.remedy`.
const DROP = 1u;
const ONE_SIDE = 2u;
const BY_ALPHA = 3u;

const PI = 3.1415927f;

struct Panel {
    // 0 for C_1, 1 for C_2.
    panel: u32,
    // For triangles across the seam.
    remedy: u32,
    near: f32,
}

@group(0) @binding(0) var<uniform> panel: Panel;
@group(0) @binding(1) var<storage, read> corners: array<Corner>;
@group(0) @binding(2) var<storage, read> indices: array<u32>;

struct Fragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) value: vec4<f32>,
    // 1 at corners in the panel's rectangle.
    @location(1) alpha: f32,
}

// phi, theta and the distance: equation 4 of Herron, "The Tennis-ball Map", with atan2(a, c) for C_1, which
// is around +Z, and the sines of unit vectors.
fn unwrapped(position: vec3<f32>) -> vec3<f32> {
    let ahead = select(position.z, -position.z, panel.panel == 1u);
    let along = select(position.x, position.y, panel.panel == 1u);
    let up = select(position.y, position.x, panel.panel == 1u);
    let phi = atan2(along, ahead);
    let theta = atan2(up, length(vec2<f32>(along, ahead)));
    return vec3<f32>(phi, theta, length(position));
}

@vertex
fn unwrap_corner(@builtin(vertex_index) index: u32) -> Fragment {
    let first = index - index % 3u;
    var angles = vec3<f32>();
    for (var k = 0u; k < 3u; k++) {
        angles[k] = unwrapped(corners[indices[first + k]].position).x;
    }
    let low = min(angles.x, min(angles.y, angles.z));
    let high = max(angles.x, max(angles.y, angles.z));
    // The whole triangle spans less than half a round, so that its corners lie on both sides of phi = pi.
    let is_across = high - low > PI;
    let corner = corners[indices[index]];
    var at = unwrapped(corner.position);
    if is_across && panel.remedy == ONE_SIDE {
        at.x += select(0.0, 2.0 * PI, at.x < 0.0);
    }
    let place = at.xy / vec2<f32>(0.75 * PI, 0.25 * PI);
    let is_inside = all(abs(place) <= vec2<f32>(1.0));
    var clip = vec4<f32>(place, panel.near / at.z, 1.0);
    if is_across && panel.remedy == DROP {
        // Outside of the panel, as the other two corners.
        clip = vec4<f32>(2.0, 2.0, 0.0, 1.0);
    }
    return Fragment(clip, corner.value, select(0.0, 1.0, is_inside));
}

@fragment
fn unwrapped_pixel(fragment: Fragment) -> @location(0) vec4<f32> {
    if panel.remedy == BY_ALPHA && fragment.alpha <= 0.0 {
        discard;
    }
    return fragment.value;
}
