// Places the corners of a moving scene around a probe, with their radiance, for direct draws into the probe's
// map: crates/view/src/scene/probe.rs. Positions are in units of the scene; radiance is linear.
#include "common/direct.wgsl"
#include "common/rows.wgsl"
#include "common/view_parts.wgsl"

const POSE_GROUP = 64u;

struct ScenePose {
    // Position of the probe.
    centre: vec3<f32>,
    // Part that the probe is inside of, which it does not show.
    hidden: u32,
    // Range of corners.
    first: u32,
    count: u32,
}

@group(0) @binding(0) var<uniform> pose: ScenePose;
@group(0) @binding(1) var<uniform> light: SceneLight;
@group(0) @binding(2) var<storage, read> parts: array<ScenePart>;
@group(0) @binding(3) var<storage, read> scene_corners: array<SceneCorner>;
@group(0) @binding(4) var<storage, read> scene_texels: array<u32>;
@group(0) @binding(5) var<storage, read_write> posed: array<Corner>;

// Hidden triangles shrink to the centre, which lies within the near surface.
fn place(index: u32, corner: SceneCorner, position: vec3<f32>, radiance: vec3<f32>) {
    let relative = position - pose.centre;
    posed[index].position = select(relative, vec3<f32>(), corner.part == pose.hidden);
    posed[index].octant = 0u;
    posed[index].value = vec4<f32>(radiance, 1.0);
}

fn colour(shown: SceneTexture, corner: SceneCorner) -> vec3<f32> {
    return texture_of_corner(shown, vec2<f32>(corner.u, corner.v), corner.spread);
}

@compute @workgroup_size(POSE_GROUP)
fn pose_matte(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let index = index_in_rows(group) * POSE_GROUP + lane;
    if index >= pose.count {
        return;
    }
    let corner = scene_corners[pose.first + index];
    let part = parts[corner.part];
    let reflected = corner.albedo * matte_light(light, world_normal(part, corner.normal));
    let radiance = reflected * colour(part.base, corner) + corner.emission * colour(part.glow, corner);
    place(pose.first + index, corner, world_position(part, corner.position), radiance);
}

// Glossy parts reflect the surroundings of their probes.
@compute @workgroup_size(POSE_GROUP)
fn pose_glossy(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let index = index_in_rows(group) * POSE_GROUP + lane;
    if index >= pose.count {
        return;
    }
    let corner = scene_corners[pose.first + index];
    let part = parts[corner.part];
    let position = world_position(part, corner.position);
    let mirrored = reflect(position - pose.centre, world_normal(part, corner.normal));
    // A corner at the centre, of a hidden part, has no direction.
    let direction = select(vec3<f32>(0.0, 1.0, 0.0), mirrored, dot(mirrored, mirrored) > 1e-12);
    let reflected = part.reflectance * octagloss_radiance_of(part.probe, direction, part.roughness);
    let radiance = reflected + corner.emission * colour(part.glow, corner);
    place(pose.first + index, corner, position, radiance);
}
