// Uniforms and textures of every viewer pipeline: crates/view/src/picture/frame.rs. Radiance is linear;
// roughness is perceptual. No branch depends on the uniform alone: Mesa's lavapipe specialises code for the
// values in such branches and would recompile it whenever the camera moves.

#include "common/harmonics.wgsl"

const BALLS = 9u;
const MAX_LEVELS = 16u;

struct Ball {
    centre: vec3<f32>,
    radius: f32,
    roughness: f32,
}

struct ViewFrame {
    eye: vec3<f32>,
    // Factor of radiance.
    exposure: f32,
    // To the right and upper edges of the picture, at distance 1.
    right: vec3<f32>,
    roughness: f32,
    up: vec3<f32>,
    // Roughness of the lobe for the backdrop.
    backdrop: f32,
    forward: vec3<f32>,
    // Levels of the prefiltered cube.
    levels: f32,
    // Reflectance of plain metals at normal incidence.
    metal: vec3<f32>,
    // Factor of the prefiltered cube's texels.
    levels_scale: f32,
    // Factors of the base colour and roughness of a mesh's own materials.
    tint: vec3<f32>,
    roughness_factor: f32,
    // Pixels of the picture.
    size: vec2<f32>,
    // Height of the ground below the spheres.
    floor: f32,
    // Finish of plain surfaces: anisotropy, cosine and sine of its direction, clear coat.
    anisotropy: f32,
    brush: vec2<f32>,
    clearcoat: f32,
    coat_roughness: f32,
    source_from_world: mat3x3<f32>,
    levels_from_source: mat3x3<f32>,
    clip_from_world: mat4x4<f32>,
    // Roughness of the levels, four to a vector, ascending.
    ladder: array<vec4<f32>, MAX_LEVELS / 4u>,
    // Unused spheres have radius 0.
    ball: array<Ball, BALLS>,
}

// `Diffuse` of crates/view/src/picture/frame.rs, in the source's space.
struct Diffuse {
    // Harmonics of irradiance over pi.
    harmonics: array<vec4<f32>, 25>,
    // Direction of the lamp, and its energy over pi.
    lamp: vec4<f32>,
}

// `MaterialUniform` of crates/view/src/picture/model.rs.
struct Material {
    // Colour and opacity.
    base: vec4<f32>,
    metallic: f32,
    roughness: f32,
    // Opacity below which the surface is discarded.
    cutoff: f32,
    // 1 for a material of the mesh's file, 0 for a plain metal.
    own: f32,
    brush: vec2<f32>,
    anisotropy: f32,
    clearcoat: f32,
    coat_roughness: f32,
}

@group(0) @binding(0) var<uniform> frame: ViewFrame;
// Scale and bias of the reflectance at normal incidence: columns by the view's cosine, rows by roughness.
@group(0) @binding(1) var split_sum: texture_2d<f32>;
// White for an even roughness.
@group(0) @binding(2) var roughness_map: texture_2d<f32>;
// Radiance of the certified tier, one texel per pixel.
@group(0) @binding(3) var truth: texture_2d<f32>;
@group(0) @binding(4) var<uniform> diffuse: Diffuse;
@group(0) @binding(5) var<uniform> material: Material;
@group(0) @binding(6) var base_texture: texture_2d<f32>;
@group(0) @binding(7) var base_sampler: sampler;
// Factors of roughness (green) and metalness (blue).
@group(0) @binding(8) var surface_texture: texture_2d<f32>;
@group(0) @binding(9) var surface_sampler: sampler;

// What a surface is besides rough.
struct Finish {
    // Along the brushing, in world space, of any length; zero for none.
    tangent: vec3<f32>,
    anisotropy: f32,
    // Share of a clear coat, and its roughness.
    clearcoat: f32,
    coat_roughness: f32,
}

// The query of a pixel to the environment, and the factors of the answer.
struct Sample {
    // Unit vector in world space.
    direction: vec3<f32>,
    roughness: f32,
    factor: vec3<f32>,
    // Unit normal in world space, and the diffuse albedo: reflected radiance over (irradiance / pi).
    normal: vec3<f32>,
    albedo: vec3<f32>,
    // Towards the viewer; reflectance at normal incidence; 1 for a surface, 0 for the backdrop.
    view: vec3<f32>,
    f0: vec3<f32>,
    surface: f32,
    finish: Finish,
}

// Bilinear between columns and rows `low` and `high`, by hand, so that texels are at the same positions with
// every driver.
fn bilinear(map: texture_2d<f32>, low: vec2<i32>, high: vec2<i32>, share: vec2<f32>) -> vec2<f32> {
    let upper = mix(textureLoad(map, low, 0), textureLoad(map, vec2<i32>(high.x, low.y), 0), share.x);
    let lower = mix(textureLoad(map, vec2<i32>(low.x, high.y), 0), textureLoad(map, high, 0), share.x);
    return mix(upper, lower, share.y).rg;
}

fn split_sum_at(cosine: f32, roughness: f32) -> vec2<f32> {
    let last = vec2<f32>(textureDimensions(split_sum)) - 1.0;
    let at = clamp(vec2<f32>(cosine, roughness) * (last + 1.0) - 0.5, vec2<f32>(0.0), last);
    let low = vec2<i32>(floor(at));
    return bilinear(split_sum, low, min(low + 1, vec2<i32>(last)), at - floor(at));
}

// Wraps in both axes.
fn roughness_at(uv: vec2<f32>) -> f32 {
    let size = vec2<f32>(textureDimensions(roughness_map));
    let at = (uv - floor(uv)) * size - 0.5;
    let low = floor(at);
    let left = vec2<i32>((low + size) - size * floor((low + size) / size));
    let right = vec2<i32>((low + 1.0) - size * floor((low + 1.0) / size));
    return bilinear(roughness_map, left, right, at - low).r;
}

// The direction through a point of the picture, in pixels from its upper left corner.
fn view_direction(pixel: vec2<f32>) -> vec3<f32> {
    let at = (pixel / frame.size * 2.0 - 1.0) * vec2<f32>(1.0, -1.0);
    return normalize(frame.forward + frame.right * at.x + frame.up * at.y);
}

// Evaluates glTF's metallic-roughness model by the split sum, for a surface with unit `normal` seen along
// `view`.
fn surface_sample(
    view: vec3<f32>, normal: vec3<f32>, base: vec3<f32>, metallic: f32, roughness: f32) -> Sample {
    let cosine = clamp(-dot(view, normal), 0.0, 1.0);
    let terms = split_sum_at(cosine, roughness);
    let once = terms.x + terms.y;
    // Dielectrics reflect 4 % at normal incidence.
    let f0 = mix(vec3<f32>(0.04), base, metallic);
    // Energy compensation for multiple scattering, complete for a white metal in a white environment
    // (Fdez-Aguera 2019, in the form of Filament's 4.7.2).
    let again = 1.0 + f0 * (1.0 / once - 1.0);
    let reflected = (f0 * terms.x + terms.y) * again;
    // Light that is not reflected enters and leaves diffusely.
    let albedo = base * (1.0 - metallic) * max(1.0 - reflected, vec3<f32>(0.0));
    return Sample(reflect(view, normal), roughness, reflected, normal, albedo, -view, f0, 1.0, Finish());
}

// Irradiance over pi for a unit normal `direction` in the source's space.
fn irradiance(direction: vec3<f32>) -> vec3<f32> {
    var basis = harmonic_basis(direction);
    var sum = vec3<f32>(diffuse.lamp.w * max(dot(direction, diffuse.lamp.xyz), 0.0));
    for (var k = 0u; k < 25u; k++) {
        sum += basis[k] * diffuse.harmonics[k].rgb;
    }
    return max(sum, vec3<f32>(0.0));
}

// The share of an even light that the spheres leave on the ground seen along `view`: a sphere above the
// horizon hides (radius / distance)^2 times the cosine of its direction.
fn ground_light(view: vec3<f32>) -> f32 {
    let reach = (frame.floor - frame.eye.y) / min(view.y, -1e-4);
    let at = frame.eye + reach * view;
    var light = 1.0;
    for (var k = 0u; k < BALLS; k++) {
        let ball = frame.ball[k];
        let way = ball.centre - at;
        let square = max(dot(way, way), 1e-6);
        let hidden = ball.radius * ball.radius / square * way.y * inverseSqrt(square);
        light *= 1.0 - clamp(hidden, 0.0, 1.0);
    }
    return select(1.0, light, view.y < 0.0 && reach > 0.0);
}

// `tangent` turned towards `bitangent`.
fn turned(tangent: vec3<f32>, bitangent: vec3<f32>, brush: vec2<f32>) -> vec3<f32> {
    return tangent * brush.x + bitangent * brush.y;
}

// The nearest sphere along the view, or the backdrop.
fn ball_sample(pixel: vec2<f32>) -> Sample {
    let view = view_direction(pixel);
    var nearest = 1e30;
    let none = vec3<f32>(0.0);
    let light = vec3<f32>(ground_light(view));
    var found = Sample(view, frame.backdrop, light, view, none, -view, none, 0.0, Finish());
    for (var k = 0u; k < BALLS; k++) {
        let ball = frame.ball[k];
        let from_centre = frame.eye - ball.centre;
        let along = dot(from_centre, view);
        // Avoids the cancellation of the textbook discriminant.
        let across = from_centre - along * view;
        let square = ball.radius * ball.radius - dot(across, across);
        let distance = -along - sqrt(max(square, 0.0));
        if square > 0.0 && distance > 0.0 && distance < nearest {
            nearest = distance;
            let normal = normalize(from_centre + distance * view);
            let uv = vec2<f32>(
                0.5 + atan2(normal.z, normal.x) / 6.2831853, acos(clamp(normal.y, -1.0, 1.0)) / 3.1415927);
            found = surface_sample(view, normal, frame.metal, 1.0, ball.roughness * roughness_at(uv));
            // Brushed around the vertical axis; at the poles there is no direction.
            let around = vec3<f32>(normal.z, 0.0, -normal.x);
            found.finish = Finish(
                turned(around, cross(normal, around), frame.brush),
                frame.anisotropy,
                frame.clearcoat,
                frame.coat_roughness);
        }
    }
    return found;
}
