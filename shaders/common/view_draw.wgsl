// Draws the viewer's pictures: linear and exposed, or the samples themselves. The including file declares
// radiance(direction: vec3<f32>, roughness: f32, pixel: vec2<f32>) -> vec3<f32>, with `direction` in the
// source's space, shaded(found: Sample, diffuse: vec3<f32>, pixel: vec2<f32>) -> vec3<f32>, a surface with
// this diffuse light, and judged(found: Sample, pixel: vec2<f32>) -> vec3<f32>, light of which errors are
// shown.
#include "common/luminance.wgsl"
#include "common/view_scene.wgsl"

// Greatest half float.
const GREATEST = 65504.0f;

struct Corner {
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) colour: vec4<f32>,
    @location(3) uv: vec2<f32>,
    @location(4) surface_uv: vec2<f32>,
}

struct Surface {
    @builtin(position) clip: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) colour: vec4<f32>,
    @location(3) uv: vec2<f32>,
    @location(4) surface_uv: vec2<f32>,
}

// One triangle that covers the picture.
@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4<f32>(corner * 2.0 - 1.0, 1.0, 1.0);
}

@vertex
fn transform(corner: Corner) -> Surface {
    let clip = frame.clip_from_world * vec4<f32>(corner.position, 1.0);
    return Surface(clip, corner.position, corner.normal, corner.colour, corner.uv, corner.surface_uv);
}

fn mesh_sample(surface: Surface) -> Sample {
    let painted = material.base * surface.colour * textureSample(base_texture, base_sampler, surface.uv);
    let texel = textureSample(surface_texture, surface_sampler, surface.surface_uv);
    // Orient the normal to the visible side, whatever the winding.
    let across = cross(dpdx(surface.position), dpdy(surface.position));
    let seen = across * -sign(dot(across, surface.position - frame.eye));
    let normal = normalize(surface.normal) * select(1.0, -1.0, dot(seen, surface.normal) < 0.0);
    if painted.a < material.cutoff {
        discard;
    }
    let view = normalize(surface.position - frame.eye);
    let base = painted.rgb * mix(frame.metal, frame.tint, material.own);
    let plain = frame.roughness * roughness_at(surface.uv);
    let roughness = material.roughness * texel.g * mix(plain, frame.roughness_factor, material.own);
    var found = surface_sample(view, normal, base, material.metallic * texel.b, roughness);
    let brush = mix(frame.brush, material.brush, material.own);
    found.finish = Finish(
        brushed(surface, normal, brush),
        mix(frame.anisotropy, material.anisotropy, material.own),
        mix(frame.clearcoat, material.clearcoat, material.own),
        mix(frame.coat_roughness, material.coat_roughness, material.own));
    return found;
}

// The direction in which u grows, turned counterclockwise in the texture by the angle of `brush`; zero
// without coordinates.
fn brushed(surface: Surface, normal: vec3<f32>, brush: vec2<f32>) -> vec3<f32> {
    let right = dpdx(surface.position);
    let down = dpdy(surface.position);
    let u = vec2<f32>(dpdx(surface.uv.x), dpdy(surface.uv.x));
    let v = vec2<f32>(dpdx(surface.uv.y), dpdy(surface.uv.y));
    let side = sign(u.x * v.y - u.y * v.x);
    let along_u = side * (right * v.y - down * v.x);
    // Textures grow downwards.
    let up = side * (right * u.y - down * u.x);
    let tangent = along_u - normal * dot(along_u, normal);
    let across = cross(normal, tangent);
    return turned(tangent, across * select(1.0, -1.0, dot(across, up) < 0.0), brush);
}

fn lit(found: Sample, pixel: vec2<f32>) -> vec4<f32> {
    let diffuse = found.albedo * irradiance(frame.source_from_world * found.normal);
    return vec4<f32>(min(shaded(found, diffuse, pixel) * frame.exposure, vec3<f32>(GREATEST)), 1.0);
}

@fragment
fn cover_picture(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return lit(ball_sample(at.xy), at.xy);
}

@fragment
fn mesh_picture(surface: Surface) -> @location(0) vec4<f32> {
    return lit(mesh_sample(surface), surface.clip.xy);
}

// Colour of a relative luminance error: black through blue and red to pale yellow, with lightness linear in
// the logarithm from 1e-4 to 1. `RELATIVE_ERROR` of crates/drawing/src/scale.rs, linear.
fn error_colour(error: f32) -> vec3<f32> {
    if error <= 0.0 {
        return vec3<f32>();
    }
    let t = clamp(log2(error * 1e4) / log2(1e4), 0.0, 1.0);
    let lightness = 0.22 + 0.74 * t;
    let hue = radians(265.0 + 205.0 * t);
    let chroma = 0.04 + 0.13 * sin(t * 3.1415927);
    let a = chroma * cos(hue);
    let b = chroma * sin(hue);
    let l = lightness + 0.39633778 * a + 0.21580376 * b;
    let m = lightness - 0.10556135 * a - 0.06385417 * b;
    let s = lightness - 0.08948418 * a - 1.2914855 * b;
    let cubes = vec3<f32>(l * l * l, m * m * m, s * s * s);
    return max(vec3<f32>(
        dot(vec3<f32>(4.0767417, -3.3077116, 0.23096994), cubes),
        dot(vec3<f32>(-1.268438, 2.6097574, -0.34131938), cubes),
        dot(vec3<f32>(-0.0041960863, -0.7034186, 1.7076147), cubes)), vec3<f32>(0.0));
}

// The colour of the error, and the error.
fn off(found: Sample, pixel: vec2<f32>) -> vec4<f32> {
    let given = dot(LUMINANCE, judged(found, pixel));
    let expected = dot(LUMINANCE, textureLoad(truth, vec2<i32>(pixel), 0).rgb);
    let error = abs(given - expected) / max(expected, 1e-30);
    return vec4<f32>(error_colour(error), min(error, GREATEST));
}

@fragment
fn cover_error(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return off(ball_sample(at.xy), at.xy);
}

@fragment
fn mesh_error(surface: Surface) -> @location(0) vec4<f32> {
    return off(mesh_sample(surface), surface.clip.xy);
}

// Writes world direction and roughness.
@fragment
fn cover_samples(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let found = ball_sample(at.xy);
    return vec4<f32>(found.direction, found.roughness);
}

@fragment
fn mesh_samples(surface: Surface) -> @location(0) vec4<f32> {
    let found = mesh_sample(surface);
    return vec4<f32>(found.direction, found.roughness);
}

// Normal and anisotropy of a surface; zero for the backdrop.
fn normal_texel(found: Sample) -> vec4<f32> {
    return vec4<f32>(found.normal, found.finish.anisotropy) * found.surface;
}

@fragment
fn cover_normals(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return normal_texel(ball_sample(at.xy));
}

@fragment
fn mesh_normals(surface: Surface) -> @location(0) vec4<f32> {
    return normal_texel(mesh_sample(surface));
}

@fragment
fn cover_tangents(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4<f32>(ball_sample(at.xy).finish.tangent, 0.0);
}

@fragment
fn mesh_tangents(surface: Surface) -> @location(0) vec4<f32> {
    return vec4<f32>(mesh_sample(surface).finish.tangent, 0.0);
}

@fragment
fn cover_reflectances(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4<f32>(ball_sample(at.xy).f0, 0.0);
}

@fragment
fn mesh_reflectances(surface: Surface) -> @location(0) vec4<f32> {
    return vec4<f32>(mesh_sample(surface).f0, 0.0);
}
