// Pictures of moving scenes: matte parts, and glossy parts that reflect the maps of probes:
// crates/view/src/scene/picture.rs. As in common/view_scene.wgsl, no branch depends on the uniform alone.
// Lengths are in units of the scene; radiance is linear.
#include "common/view_parts.wgsl"

const MAX_PROBES = 8u;

// The greatest half float.
const MAX_RADIANCE = 65504.0f;

struct SceneFrame {
    clip_from_world: mat4x4<f32>,
    eye: vec3<f32>,
    // Factor of radiance.
    exposure: f32,
    // Corners of the proxy box.
    low: vec3<f32>,
    // 0 for no proxy, 1 for a box, 2 for a sphere.
    proxy: u32,
    high: vec3<f32>,
    probes: u32,
    // Centre and radius of the proxy sphere.
    sphere: vec4<f32>,
    centres: array<vec4<f32>, MAX_PROBES>,
}

@group(0) @binding(0) var<uniform> frame: SceneFrame;
@group(0) @binding(1) var<uniform> light: SceneLight;
@group(0) @binding(2) var<storage, read> parts: array<ScenePart>;
@group(0) @binding(3) var<storage, read> scene_texels: array<u32>;

struct Matte {
    @builtin(position) clip: vec4<f32>,
    // Radiance, to be multiplied by the textures.
    @location(0) reflected: vec3<f32>,
    @location(1) emission: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) @interpolate(flat) part: u32,
}

@vertex
fn matte_corner(
    @location(0) position: vec3<f32>,
    @location(1) index: u32,
    @location(2) normal: vec3<f32>,
    @location(3) albedo: vec3<f32>,
    @location(4) emission: vec3<f32>,
    @location(5) u: f32,
    @location(6) v: f32,
) -> Matte {
    let part = parts[index];
    let clip = frame.clip_from_world * vec4<f32>(world_position(part, position), 1.0);
    let reflected = albedo * matte_light(light, world_normal(part, normal));
    return Matte(clip, reflected, emission, vec2<f32>(u, v), index);
}

fn exposed(radiance: vec3<f32>) -> vec4<f32> {
    return vec4<f32>(min(frame.exposure * radiance, vec3<f32>(MAX_RADIANCE)), 1.0);
}

@fragment
fn matte(fragment: Matte) -> @location(0) vec4<f32> {
    let across = dpdx(fragment.uv);
    let down = dpdy(fragment.uv);
    let base = texture_of_pixel(parts[fragment.part].base, fragment.uv, across, down);
    let glow = texture_of_pixel(parts[fragment.part].glow, fragment.uv, across, down);
    return exposed(fragment.reflected * base + fragment.emission * glow);
}

struct Glossy {
    // Both passes over a part meet the same depth.
    @builtin(position) @invariant clip: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) @interpolate(flat) part: u32,
    @location(3) emission: vec3<f32>,
    @location(4) uv: vec2<f32>,
}

@vertex
fn glossy_corner(
    @location(0) position: vec3<f32>,
    @location(1) index: u32,
    @location(2) normal: vec3<f32>,
    @location(4) emission: vec3<f32>,
    @location(5) u: f32,
    @location(6) v: f32,
) -> Glossy {
    let part = parts[index];
    let place = world_position(part, position);
    let clip = frame.clip_from_world * vec4<f32>(place, 1.0);
    return Glossy(clip, place, world_normal(part, normal), index, emission, vec2<f32>(u, v));
}

// The depth of a glossy part and what it emits, to which its probes add radiance.
@fragment
fn cover_glossy(fragment: Glossy) -> @location(0) vec4<f32> {
    let across = dpdx(fragment.uv);
    let down = dpdy(fragment.uv);
    let glow = texture_of_pixel(parts[fragment.part].glow, fragment.uv, across, down);
    return exposed(fragment.emission * glow);
}

// Distance along the unit `direction` from `position` to the inside of the box; negative from outside.
fn box_distance(position: vec3<f32>, direction: vec3<f32>) -> f32 {
    let away = select(direction, vec3<f32>(1e-6), abs(direction) < vec3<f32>(1e-6));
    let distance = max((frame.low - position) / away, (frame.high - position) / away);
    let inside = all(position >= frame.low) && all(position <= frame.high);
    return select(-1.0, min(distance.x, min(distance.y, distance.z)), inside);
}

// The same for the sphere.
fn sphere_distance(position: vec3<f32>, direction: vec3<f32>) -> f32 {
    let from_centre = position - frame.sphere.xyz;
    let beyond = dot(from_centre, from_centre) - frame.sphere.w * frame.sphere.w;
    let along = dot(from_centre, direction);
    return select(-1.0, sqrt(max(along * along - beyond, 0.0)) - along, beyond <= 0.0);
}

// The direction in which a probe at `centre` sees what the proxy has in unit `direction` from `position`;
// from outside of the proxy, `direction`.
fn direction_from(centre: vec3<f32>, position: vec3<f32>, direction: vec3<f32>) -> vec3<f32> {
    let of_sphere = sphere_distance(position, direction);
    let distance = select(of_sphere, box_distance(position, direction), frame.proxy == 1u);
    let corrected = position + distance * direction - centre;
    return select(direction, corrected, frame.proxy != 0u && distance > 0.0);
}

// Weight of a probe at `position`: inverse squared distances, 0 beyond the last probe.
fn weight_of_probe(position: vec3<f32>, probe: u32) -> f32 {
    let away = position - frame.centres[probe].xyz;
    return select(0.0, 1.0 / (dot(away, away) + 1e-4), probe < frame.probes);
}

// What the probes of a part reflect: its own, or all by their weights.
@fragment
fn glossy(fragment: Glossy) -> @location(0) vec4<f32> {
    let part = parts[fragment.part];
    let position = fragment.position;
    let direction = reflect(normalize(position - frame.eye), normalize(fragment.normal));
    var sum = 0.0;
    for (var k = 0u; k < MAX_PROBES; k++) {
        sum += weight_of_probe(position, k);
    }
    var radiance = vec3<f32>();
    for (var k = 0u; k < MAX_PROBES; k++) {
        let blended = weight_of_probe(position, k) / sum;
        let share = select(blended, select(0.0, 1.0, k == part.probe), part.own == 1u);
        if share > 0.0 {
            let towards = direction_from(frame.centres[k].xyz, position, direction);
            radiance += share * octagloss_radiance_of(k, towards, part.roughness);
        }
    }
    return vec4<f32>(exposed(part.reflectance * radiance).rgb, 0.0);
}
