// Reads files of `octagloss bake --target pyramid`: reflections of any roughness and view, and irradiance.
// octagloss_lights holds the 256 floats `uniform` of NAME_pyramid.json, octagloss_maps NAME_pyramid.ktx2,
// octagloss_tables pyramid_tables.ktx2, octagloss_rows pyramid_rows.ktx2, of which isotropic reflections read
// nothing; octagloss_linear is a sampler, linear in texels and in mip levels and clamped to the edge.
// Directions are in the world, right-handed, y up. To use: octagloss_radiance, octagloss_irradiance,
// octagloss_reflect, octagloss_reflect_isotropic, octagloss_albedo and octagloss_albedo_along; `probe` is 0.
@group(0) @binding(0) var<uniform> octagloss_lights: array<OctaglossLight, 1>;
@group(0) @binding(1) var octagloss_maps: texture_2d_array<f32>;
@group(0) @binding(2) var octagloss_tables: texture_2d<f32>;
@group(0) @binding(3) var octagloss_linear: sampler;
@group(0) @binding(4) var octagloss_rows: texture_3d<f32>;
// Reads of a pyramid in its files: src/io/pyramid_write.rs has their layout.
// Reflections of the true BRDF along a tangent: `Pyramid::reflect` of src/pyramid/reflect.rs, and the row of
// reads of src/pyramid/anisotropic.rs. Fifteen trilinear reads, one bilinear.
// Isotropic reflections of the true BRDF out of a pyramid: `Pyramid::isotropic` of src/pyramid/reflect.rs.
// Nine trilinear reads, one bilinear.
// Glossy reflections of any roughness and irradiance out of a pyramid: `Pyramid` of src/pyramid/mod.rs. At
// most five bilinear reads. Maps and table are read by functions: those of pyramid_maps.wgsl or
// pyramid_file.wgsl.
// Real spherical harmonics to order 4: `basis` of src/sh/coefficients.rs.

// Evaluates the basis at the unit vector `d`.
fn octagloss_harmonic_basis(d: vec3<f32>) -> array<f32, 25> {
    let x = d.x;
    let y = d.y;
    let z = d.z;
    let xx = x * x;
    let yy = y * y;
    let zz = z * z;
    return array<f32, 25>(
        0.28209479,
        0.48860251 * y,
        0.48860251 * z,
        0.48860251 * x,
        1.09254843 * x * y,
        1.09254843 * y * z,
        0.31539157 * (3.0 * zz - 1.0),
        1.09254843 * x * z,
        0.54627422 * (xx - yy),
        0.59004359 * y * (3.0 * xx - yy),
        2.89061144 * x * y * z,
        0.45704580 * y * (5.0 * zz - 1.0),
        0.37317633 * z * (5.0 * zz - 3.0),
        0.45704580 * x * (5.0 * zz - 1.0),
        1.44530572 * z * (xx - yy),
        0.59004359 * x * (xx - 3.0 * yy),
        2.50334294 * x * y * (xx - yy),
        1.77013077 * y * z * (3.0 * xx - yy),
        0.94617470 * x * y * (7.0 * zz - 1.0),
        0.66904654 * y * z * (7.0 * zz - 3.0),
        0.10578555 * (35.0 * zz * zz - 30.0 * zz + 3.0),
        0.66904654 * x * z * (7.0 * zz - 3.0),
        0.47308735 * (xx - yy) * (7.0 * zz - 1.0),
        1.77013077 * x * z * (xx - 3.0 * yy),
        0.62583574 * (xx * xx - 6.0 * xx * yy + yy * yy));
}
// Per-environment data of a pyramid: `OctaglossLight` of src/gpu/pyramid.rs.

const octagloss_SUNS = 8u;

// A sun: `Sun` of src/pyramid/suns.rs. Unused ones have no energy.
struct OctaglossSun {
    // Mean direction of each channel, and the mean octagloss_squared distance of its light from there.
    red: vec4<f32>,
    green: vec4<f32>,
    blue: vec4<f32>,
    // Radiance times solid angle.
    energy: vec3<f32>,
    pad: f32,
}

struct OctaglossLight {
    // The rotation that takes a direction of the environment to one of the world.
    world_from_source: mat3x3<f32>,
    // The power of two that scales the maps, its inverse, and what the rest is clamped to, scaled.
    scale: f32,
    unscale: f32,
    clamp: f32,
    pad: f32,
    // Harmonics of the rest to order 4, scaled.
    harmonics: array<vec4<f32>, 25>,
    // Fills a multiple of 256 bytes, at which bindings may begin.
    @size(560) suns: array<OctaglossSun, octagloss_SUNS>,
}

const octagloss_INTERVALS = 640u;

// `direction` in the environment `probe`, as a unit vector. As dot products, which begin with `direction`:
// where a condition depends on an expression that begins with a constant place in a stage's fourth uniform
// buffer, Mesa 22.3's llvmpipe crashes, and the second environment of a shader has its light there.
fn octagloss_source_from_world(probe: u32, direction: vec3<f32>) -> vec3<f32> {
    let axes = octagloss_lights[probe].world_from_source;
    return normalize(vec3<f32>(dot(direction, axes[0]), dot(direction, axes[1]), dot(direction, axes[2])));
}

// Texture coordinates of `direction`, the same in all maps with borders that halve with the texels.
fn octagloss_place_of(direction: vec3<f32>) -> vec2<f32> {
    let p = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    let folded = 1.0 - abs(p.zx);
    let turned = vec2<f32>(select(-folded.x, folded.x, p.x >= 0.0), select(-folded.y, folded.y, p.z >= 0.0));
    let uv = select(turned, p.xz, p.y >= 0.0);
    let inner = octagloss_map_inner();
    return 0.5 + uv * (0.5 * inner / (inner + 2.0 * octagloss_map_border()));
}

// Harmonics of radiance around the unit vector `d`, the sum of each order times its weight.
fn octagloss_harmonics_around(probe: u32, d: vec3<f32>, weights: array<f32, 5>) -> vec3<f32> {
    var basis = octagloss_harmonic_basis(d);
    var sum = vec3<f32>();
    for (var order = 0u; order < 5u; order++) {
        var own = vec3<f32>();
        for (var k = order * order; k < (order + 1u) * (order + 1u); k++) {
            own += basis[k] * octagloss_lights[probe].harmonics[k].xyz;
        }
        sum += weights[order] * own;
    }
    return sum;
}

// Radiance of a GGX reflection around `direction` (world space, any length but zero) at `roughness` in
// [0, 1].
fn octagloss_radiance(direction: vec3<f32>, roughness: f32) -> vec3<f32> {
    return octagloss_radiance_of(0u, direction, roughness);
}

// The same in the environment `probe`.
fn octagloss_radiance_of(probe: u32, direction: vec3<f32>, roughness: f32) -> vec3<f32> {
    let d = octagloss_source_from_world(probe, direction);
    let at = octagloss_place_of(d);
    // 640 / log2(51).
    let node = log2(1.0 + 50.0 * roughness) * 112.826518;
    let k = min(u32(node), octagloss_INTERVALS - 1u);
    let share = node - f32(k);
    var low = octagloss_node_weights(k);
    var high = octagloss_node_weights(k + 1u);
    let a = mix(low[0], high[0], share);
    let b = mix(low[1], high[1], share);
    let c = mix(low[2], high[2], share);
    let e = mix(low[3], high[3], share);
    var sum = vec3<f32>();
    if a.x != 0.0 {
        sum += a.x * octagloss_read_mirror(probe, at);
    }
    if a.y != 0.0 {
        sum += a.y * octagloss_read_sharp(probe, at);
    }
    var levels = array<f32, 7>(a.z, a.w, b.x, b.y, b.z, b.w, c.x);
    // Levels that a smaller map does not have weigh nothing.
    for (var level = 0u; level < 7u; level++) {
        if levels[level] != 0.0 {
            sum += levels[level] * octagloss_read_levels(probe, at, f32(level));
        }
    }
    if c.y != 0.0 {
        sum += c.y * octagloss_read_cosine(probe, octagloss_place_in_cosine(at));
    }
    sum += octagloss_harmonics_around(probe, d, array<f32, 5>(c.z, c.w, e.x, e.y, e.z));
    sum = max(sum, vec3<f32>()) * octagloss_lights[probe].unscale;
    // GGX around the suns: `glossy` of src/pyramid/suns.rs.
    let alpha = roughness * roughness;
    for (var k = 0u; k < octagloss_SUNS; k++) {
        let sun = octagloss_lights[probe].suns[k];
        // A quarter of the octagloss_squared distance, which the cosine does not resolve in single precision.
        let apart = vec3<f32>(
            octagloss_squared(d - sun.red.xyz), octagloss_squared(d - sun.green.xyz), octagloss_squared(d - sun.blue.xyz));
        let s = min(0.25 * apart, vec3<f32>(0.5));
        let spread = vec3<f32>(sun.red.w, sun.green.w, sun.blue.w);
        let a2 = min(alpha * alpha + 0.5 * spread, vec3<f32>(1.0));
        let bend = s + a2 * (1.0 - s);
        let lobe = 0.31830987 * a2 / (bend * bend) * (1.0 - 2.0 * s);
        sum += sun.energy * lobe * (e.w * (1.0 - a.x));
    }
    return sum;
}

fn octagloss_squared(v: vec3<f32>) -> f32 {
    return dot(v, v);
}

// The same place in the cosine map, which has a border of one texel around 32.
fn octagloss_place_in_cosine(at: vec2<f32>) -> vec2<f32> {
    let size = octagloss_map_inner() + 2.0 * octagloss_map_border();
    return 0.5 + (at - 0.5) * (size / octagloss_map_inner() * (32.0 / 34.0));
}

// Irradiance on a surface with `normal` (world space, any length but zero) over pi: the radiance that a white
// diffuse surface reflects.
fn octagloss_irradiance(normal: vec3<f32>) -> vec3<f32> {
    return octagloss_irradiance_of(0u, normal);
}

// The same in the environment `probe`.
fn octagloss_irradiance_of(probe: u32, normal: vec3<f32>) -> vec3<f32> {
    let d = octagloss_source_from_world(probe, normal);
    var sum = octagloss_read_cosine(probe, octagloss_place_in_cosine(octagloss_place_of(d))) * octagloss_lights[probe].unscale;
    for (var k = 0u; k < octagloss_SUNS; k++) {
        let sun = octagloss_lights[probe].suns[k];
        let facing = vec3<f32>(dot(d, sun.red.xyz), dot(d, sun.green.xyz), dot(d, sun.blue.xyz));
        sum += sun.energy * (0.31830987 * max(facing, vec3<f32>()));
    }
    return sum;
}

const octagloss_READS = 9u;
// Texels of a node.
const octagloss_LAYERS = 18u;
const octagloss_NODES = vec2<f32>(46.0, 26.0);
const octagloss_LEAST_COSINE = 0.01f;

// The table of src/pyramid/albedo.rs, and the dip that it leaves out.
const octagloss_ALBEDO_NODES = vec2<f32>(91.0, 75.0);
const octagloss_DIP = vec4<f32>(0.222, 0.634, 0.098, 0.3126);
const octagloss_LEAST_ALPHA = 1e-6f;

// A layer of the table of src/pyramid/reads.rs at `roughness` and n.v of `cosine`.
fn octagloss_reflection_node(layer: u32, roughness: f32, cosine: f32) -> vec4<f32> {
    // 1 / log2(11). The fourth root of 1 less the sine, without cancellation.
    let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    let place = vec2<f32>(log2(1.0 + 10.0 * roughness) * 0.289064826, sqrt(cosine * inverseSqrt(1.0 + sine)));
    let at = (place * (octagloss_NODES - 1.0) + 0.5) / octagloss_NODES;
    return octagloss_read_reflections(layer, at);
}

// What an isotropic surface reflects of a white world, scale and bias of f0; `cosine` is n.v: `albedo_at` of
// src/pyramid/albedo.rs.
fn octagloss_round_albedo(cosine: f32, roughness: f32) -> vec2<f32> {
    let seen = clamp(cosine, 1e-4, 1.0);
    // 1 / log2(31).
    let places = vec2<f32>(log2(1.0 + 30.0 * roughness) * 0.201848706, (sqrt(sqrt(seen)) - 0.1) / 0.9);
    let place = clamp(places, vec2<f32>(), vec2<f32>(1.0)) * (octagloss_ALBEDO_NODES - 1.0);
    let node = min(floor(place), octagloss_ALBEDO_NODES - 2.0);
    let share = place - node;
    let first = u32(node.x + octagloss_ALBEDO_NODES.x * node.y);
    // Texels have a node and its neighbour over roughness.
    let pair = mix(octagloss_read_albedo(first), octagloss_read_albedo(first + u32(octagloss_ALBEDO_NODES.x)), share.y);
    let t = seen / max(roughness * roughness, octagloss_LEAST_ALPHA);
    let left = 1.0 - octagloss_DIP.x * t / (1.0 + t * (octagloss_DIP.y + t * (octagloss_DIP.z + t * octagloss_DIP.w)));
    return left * mix(pair.xy, pair.zw, share.x);
}

// A surface that is looked at, in the map's space.
struct octagloss_SurfaceFrame {
    normal: vec3<f32>,
    // Unit vector in the surface under the view.
    towards: vec3<f32>,
    // n.v, and its sine.
    cosine: f32,
    sine: f32,
}

// Light around the unit vector `direction` between two levels: 0 the mirror, 1 the sharp one.
fn octagloss_between_levels(probe: u32, direction: vec3<f32>, level: f32) -> vec3<f32> {
    let at = octagloss_place_of(direction);
    if level >= 2.0 {
        return octagloss_read_levels(probe, at, level - 2.0);
    }
    if level >= 1.0 {
        return mix(octagloss_read_sharp(probe, at), octagloss_read_levels(probe, at, 0.0), level - 1.0);
    }
    return mix(octagloss_read_mirror(probe, at), octagloss_read_sharp(probe, at), level);
}

// GGX with Smith's height-correlated masking, and (1 - v.h)^5, of a light of `spread`: `Brdf::around` of
// src/pyramid/brdf.rs. In axes of the surface with its normal z.
fn octagloss_brdf_around(view: vec3<f32>, light: vec3<f32>, alpha: vec2<f32>, spread: f32) -> vec2<f32> {
    if light.z <= 0.0 {
        return vec2<f32>();
    }
    let half_vector = normalize(view + light);
    let cosine = dot(view, half_vector);
    let across = vec2<f32>(-view.y, view.x) / cosine;
    let squares = alpha * alpha + 0.5 * spread * (1.0 + across * across);
    let mixed = 0.5 * spread * across.x * across.y;
    let determinant = squares.x * squares.y - mixed * mixed;
    let h = half_vector.xy;
    let slopes = squares.y * h.x * h.x - 2.0 * mixed * h.x * h.y + squares.x * h.y * h.y;
    let bend = slopes / determinant + half_vector.z * half_vector.z;
    let masking = light.z * length(vec3<f32>(alpha * view.xy, view.z))
        + view.z * length(vec3<f32>(alpha * light.xy, light.z));
    let value = 0.5 * light.z / (masking * 3.14159265 * sqrt(determinant) * bend * bend);
    return vec2<f32>(value, pow(max(1.0 - cosine, 0.0), 5.0));
}

// Harmonics of radiance around the unit vector `d`, by order.
fn octagloss_harmonic_orders(probe: u32, d: vec3<f32>) -> array<vec3<f32>, 5> {
    var basis = octagloss_harmonic_basis(d);
    var sums = array<vec3<f32>, 5>();
    for (var order = 0u; order < 5u; order++) {
        for (var k = order * order; k < (order + 1u) * (order + 1u); k++) {
            sums[order] += basis[k] * octagloss_lights[probe].harmonics[k].xyz;
        }
    }
    return sums;
}

// The cosine level around the unit vector `n`.
fn octagloss_cosine_light(probe: u32, n: vec3<f32>) -> vec3<f32> {
    return octagloss_read_cosine(probe, octagloss_place_in_cosine(octagloss_place_of(n)));
}

// Harmonics around five directions in the plane of incidence, of orders from their place up: `pairs` are
// weights for f0 and f90, two in a texel.
fn octagloss_harmonics_reflected(
    probe: u32,
    surface: octagloss_SurfaceFrame,
    pairs: array<vec4<f32>, 8>,
    f0: vec3<f32>,
    f90: f32,
) -> vec3<f32> {
    var angles = array<vec2<f32>, 5>(
        vec2<f32>(1.0, 0.0),
        vec2<f32>(0.309016994, 0.951056516),
        vec2<f32>(-0.809016994, 0.587785252),
        vec2<f32>(0.809016994, 0.587785252),
        vec2<f32>(-0.309016994, 0.951056516));
    var texels = pairs;
    var sum = vec3<f32>();
    var pair = 0u;
    for (var k = 0u; k < 5u; k++) {
        var orders = octagloss_harmonic_orders(probe, surface.normal * angles[k].x + surface.towards * angles[k].y);
        for (var order = k; order < 5u; order++) {
            let texel = texels[pair / 2u];
            let weights = select(texel.zw, texel.xy, pair % 2u == 0u);
            sum += (f0 * weights.x + f90 * weights.y) * orders[order];
            pair++;
        }
    }
    return sum;
}

// The suns, with `alpha` along `tangent` and across it: the tangent along the plane of incidence and across
// it.
fn octagloss_suns_reflected(
    probe: u32,
    surface: octagloss_SurfaceFrame,
    tangent: vec2<f32>,
    alpha: vec2<f32>,
    f0: vec3<f32>,
    f90: f32,
) -> vec3<f32> {
    let across = cross(surface.normal, surface.towards);
    let x = surface.towards * tangent.x + across * tangent.y;
    let y = across * tangent.x - surface.towards * tangent.y;
    let view = vec3<f32>(surface.sine * tangent.x, -surface.sine * tangent.y, surface.cosine);
    let wide = max(alpha, vec2<f32>(0.9 / octagloss_map_inner()));
    var sum = vec3<f32>();
    for (var k = 0u; k < octagloss_SUNS; k++) {
        let sun = octagloss_lights[probe].suns[k];
        var channels = array<vec4<f32>, 3>(sun.red, sun.green, sun.blue);
        var values = array<vec2<f32>, 3>();
        for (var c = 0u; c < 3u; c++) {
            let to = channels[c].xyz;
            let light = vec3<f32>(dot(to, x), dot(to, y), dot(to, surface.normal));
            values[c] = octagloss_brdf_around(view, light, wide, channels[c].w);
        }
        let value = vec3<f32>(values[0].x, values[1].x, values[2].x);
        let fresnel = vec3<f32>(values[0].y, values[1].y, values[2].y);
        sum += sun.energy * value * (f0 + (f90 - f0) * fresnel);
    }
    return sum;
}

// What weights that sum to `sums` are multiplied by, to sum to `albedo`.
fn octagloss_albedo_share(albedo: vec2<f32>, sums: vec2<f32>) -> vec2<f32> {
    // Where nothing is reflected, shares mean nothing.
    return (albedo + 1e-4) / (max(sums, vec2<f32>()) + 1e-4);
}

// Radiance reflected without a tangent.
fn octagloss_reflected_isotropic(
    probe: u32,
    surface: octagloss_SurfaceFrame,
    roughness: f32,
    f0: vec3<f32>,
    f90: f32,
) -> vec3<f32> {
    let n = surface.normal;
    let cosine = surface.cosine;
    // Offsets of reads have the length of its sine, so that nothing turns there.
    let along = surface.towards * surface.sine;
    let v = along + n * cosine;
    let rest = octagloss_reflection_node(octagloss_READS, roughness, cosine);
    let shares = octagloss_albedo_share(octagloss_round_albedo(cosine, roughness), rest.zw);
    let scaled = f0 * shares.x;
    let grazing = f90 * shares.y;
    var sum = vec3<f32>();
    var in_mirror = 0.0;
    for (var k = 0u; k < octagloss_READS; k++) {
        // Slope, level, weights of f0 and f90.
        let read = octagloss_reflection_node(k, roughness, cosine);
        let half_vector = normalize(n + read.x * along);
        let direction = half_vector * (2.0 * dot(v, half_vector)) - v;
        sum += (scaled * read.z + grazing * read.w) * octagloss_between_levels(probe, direction, read.y);
        in_mirror += (read.z + read.w) * max(1.0 - read.y, 0.0);
    }
    sum += (scaled * rest.x + grazing * rest.y) * octagloss_cosine_light(probe, n);
    var pairs = array<vec4<f32>, 8>();
    for (var k = 0u; k < 8u; k++) {
        pairs[k] = octagloss_reflection_node(octagloss_READS + 1u + k, roughness, cosine);
    }
    sum += octagloss_harmonics_reflected(probe, surface, pairs, scaled, grazing);
    sum = max(sum, vec3<f32>()) * octagloss_lights[probe].unscale;
    let share = max(1.0 - in_mirror / (rest.z + rest.w), 0.0);
    let alpha = vec2<f32>(roughness * roughness);
    return sum + share * octagloss_suns_reflected(probe, surface, vec2<f32>(1.0, 0.0), alpha, f0, f90);
}

// The surface with `normal` under a viewer in the direction `view`, both in world space.
fn octagloss_surface_of(probe: u32, normal: vec3<f32>, view: vec3<f32>) -> octagloss_SurfaceFrame {
    let n = octagloss_source_from_world(probe, normal);
    let seen = octagloss_source_from_world(probe, view);
    let cosine = clamp(dot(n, seen), octagloss_LEAST_COSINE, 1.0);
    // The view without its part along the normal, or any direction in the surface where that vanishes.
    var level_view = seen - n * dot(n, seen);
    if dot(level_view, level_view) < 1e-10 {
        level_view = select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), abs(n.x) > 0.5);
    }
    let towards = normalize(level_view - n * dot(n, level_view));
    return octagloss_SurfaceFrame(n, towards, cosine, sqrt(1.0 - cosine * cosine));
}

// Radiance that a surface reflects to a viewer: GGX with Smith's height-correlated masking and Schlick's
// Fresnel term f0 + (f90 - f0) (1 - v.h)^5. `normal` and `view`, towards the viewer, are in world space, of
// any length but zero; `roughness` is in [0, 1]. A view with n.v below 0.01, or from below the surface, is
// turned up to that.
fn octagloss_reflect_isotropic(
    normal: vec3<f32>,
    view: vec3<f32>,
    roughness: f32,
    f0: vec3<f32>,
    f90: f32,
) -> vec3<f32> {
    return octagloss_reflected_isotropic(0u, octagloss_surface_of(0u, normal, view), roughness, f0, f90);
}

const octagloss_ROW_NODES = vec4<f32>(16.0, 10.0, 8.0, 7.0);
const octagloss_ROW_MIDDLE = 7u;
// Texels of a node with the weights of reads, and all.
const octagloss_ROW_PAIRS = 8u;
const octagloss_ROW_LAYERS = 21u;
// Nodes of the albedo, below; anisotropies side by side there.
const octagloss_ROW_ALBEDO_NODES = vec4<f32>(16.0, 10.0, 8.0, 13.0);
const octagloss_ROW_BLOCKS = 21.0f;
// Texels of the table.
const octagloss_ROW_SIZE = vec3<f32>(336.0, 80.0, 8.0);
const octagloss_ROW_SHARP = 0.001f;
const octagloss_NARROWEST = 0.05f;
const octagloss_BLEND = 0.1f;
const octagloss_TILTED = 0.5f;
const octagloss_SKEWED = 0.2f;

// Alpha along the tangent and across it.
fn octagloss_row_alphas(roughness: f32, anisotropy: f32) -> vec2<f32> {
    let alpha = roughness * roughness;
    return vec2<f32>(alpha + (1.0 - alpha) * anisotropy * anisotropy, alpha);
}

// The share of the row in a reflection; the rest is isotropic.
fn octagloss_row_share(alpha: vec2<f32>) -> f32 {
    return smoothstep(0.0, 1.0, (alpha.x - alpha.y) / (octagloss_BLEND * max(alpha.y, 1e-6)));
}

// The place of `alpha`, n.v of `cosine` and a unit `tangent` along the plane of incidence and across it, between
// the first node and the last of each axis.
fn octagloss_row_places(alpha: vec2<f32>, cosine: f32, tangent: vec2<f32>) -> vec4<f32> {
    let sharp = max(alpha.y, octagloss_ROW_SHARP);
    let azimuth = atan2(abs(tangent.y), abs(tangent.x)) * 0.636619772;
    let places = vec4<f32>(
        // 1 / log2(6).
        log2(1.0 + 5.0 * sqrt(alpha.y)) * 0.386852807,
        sqrt(cosine),
        1.0 - pow(max(1.0 - azimuth, 0.0), 0.666666667),
        log2(max(alpha.x, sharp) / sharp) / -log2(min(sharp, 0.999999)));
    return clamp(places, vec4<f32>(), vec4<f32>(1.0));
}

// Where the table is read: coordinates of the first texel of nodes at the lower of two anisotropies, how far
// the upper is, and its share.
struct octagloss_RowPlace {
    at: vec3<f32>,
    share: f32,
}

// The place of the arguments of octagloss_row_places.
fn octagloss_row_place(alpha: vec2<f32>, cosine: f32, tangent: vec2<f32>) -> octagloss_RowPlace {
    let place = octagloss_row_places(alpha, cosine, tangent) * (octagloss_ROW_NODES - 1.0);
    let lower = min(floor(place.w), octagloss_ROW_NODES.w - 2.0);
    // Coordinates have eight bits between texels, and what lies beside a node may be of another kind.
    let inset = 1.0 / 256.0;
    let inside = clamp(place.xy, vec2<f32>(inset), octagloss_ROW_NODES.xy - 1.0 - inset);
    let texel = vec3<f32>(inside.x, inside.y + octagloss_ROW_NODES.y * lower, place.z) + 0.5;
    return octagloss_RowPlace(texel / octagloss_ROW_SIZE, place.w - lower);
}

// A texel of the node at `place`.
fn octagloss_row_node(layer: u32, place: octagloss_RowPlace) -> vec4<f32> {
    let at = vec3<f32>(place.at.x + f32(layer) / f32(octagloss_ROW_LAYERS), place.at.yz);
    return mix(octagloss_read_rows(at), octagloss_read_rows(vec3<f32>(at.x, at.y + octagloss_ROW_NODES.y / octagloss_ROW_SIZE.y, at.z)), place.share);
}

// What scale and bias of f0 exceed those of a round lobe by, at the azimuth of `tangent` and in the mean:
// `more_at` of src/pyramid/anisotropic.rs.
fn octagloss_row_more(alpha: vec2<f32>, cosine: f32, tangent: vec2<f32>) -> vec4<f32> {
    let place = octagloss_row_places(alpha, cosine, tangent) * (octagloss_ROW_ALBEDO_NODES - 1.0);
    let lower = min(floor(place.w), octagloss_ROW_ALBEDO_NODES.w - 2.0);
    let inset = 1.0 / 256.0;
    let inside = vec3<f32>(clamp(place.xy, vec2<f32>(inset), octagloss_ROW_ALBEDO_NODES.xy - 1.0 - inset), place.z);
    return mix(octagloss_row_block(lower, inside), octagloss_row_block(lower + 1.0, inside), place.w - lower);
}

// The nodes of anisotropy `block` at a place among them.
fn octagloss_row_block(block: f32, place: vec3<f32>) -> vec4<f32> {
    let row = floor((block + 0.5) / octagloss_ROW_BLOCKS);
    let corner = octagloss_ROW_ALBEDO_NODES.xy * vec2<f32>(block - octagloss_ROW_BLOCKS * row, row);
    let first = vec3<f32>(corner.x, corner.y + octagloss_ROW_NODES.y * octagloss_ROW_NODES.w, 0.0);
    return octagloss_read_rows((first + place + 0.5) / octagloss_ROW_SIZE);
}

// Scale and bias of f0, which exceed those of a round lobe by `more`. `along` is the square of the tangent's
// part in the plane of incidence, a half for the mean over azimuths: `round_roughness` of
// src/pyramid/anisotropic.rs.
fn octagloss_row_albedo(alpha: vec2<f32>, cosine: f32, along: f32, more: vec2<f32>) -> vec2<f32> {
    let squares = alpha * alpha;
    let mean = sqrt(0.5 * (squares.x + squares.y));
    let seen = sqrt(mix(squares.y, squares.x, along));
    let round = octagloss_round_albedo(cosine, sqrt(mix(seen, mean, cosine)));
    return max(round + more, vec2<f32>());
}

// A row of reads.
struct octagloss_Row {
    // Slopes of the half vector along the plane of incidence and across it, of a read of slope 1.
    axis: vec2<f32>,
    // Length of the lobe.
    extent: f32,
    shift: f32,
    // Step, bend, width and growth.
    steps: vec4<f32>,
    alternation: f32,
    // How much of the difference between weights either side of the middle counts.
    skew: f32,
}

// A number of the law.
fn octagloss_row_number(terms: array<vec4<f32>, 3>, a: vec4<f32>, b: vec4<f32>, c: vec4<f32>) -> f32 {
    return dot(terms[0], a) + dot(terms[1], b) + dot(terms[2], c);
}

// The row of a lobe with `alpha` along `tangent` and across it.
fn octagloss_row_of(alpha: vec2<f32>, tangent: vec2<f32>, cosine: f32) -> octagloss_Row {
    let squares = alpha * alpha;
    let difference = squares.x - squares.y;
    let along = squares.y + difference * tangent.x * tangent.x;
    let across = (squares.y + difference * tangent.y * tangent.y) * cosine * cosine;
    let mixed = difference * tangent.x * tangent.y * cosine;
    let apart = 0.5 * (along - across);
    let root = length(vec2<f32>(apart, mixed));
    let greatest = max(0.5 * (along + across) + root, 1e-30);
    var axis = vec2<f32>(1.0, 0.0);
    if root > 0.0 {
        let steep = vec2<f32>(abs(mixed), (root - apart) * select(-1.0, 1.0, mixed >= 0.0));
        axis = normalize(select(steep, vec2<f32>(apart + root, mixed), apart >= 0.0) / root);
    }
    let x = log(max(alpha.x * alpha.y * cosine / greatest, octagloss_NARROWEST));
    let extent = sqrt(greatest);
    let y = log(1.0 + 6.0 * extent);
    let tilt = axis.x * smoothstep(0.0, octagloss_TILTED, sqrt(1.0 - cosine * cosine));
    let e = axis.x * tilt;
    let terms = array<vec4<f32>, 3>(
        vec4<f32>(1.0, x, x * x, y),
        vec4<f32>(x * y, y * y, e, e * x),
        vec4<f32>(x * x * x, y * y * y, x * x * y, x * y * y));
    let shift = octagloss_row_number(
        terms,
        vec4<f32>(-0.822, -0.434, 0.191, 0.225),
        vec4<f32>(-0.113, -0.022, -0.153, -0.163),
        vec4<f32>(-0.008, 0.111, -0.063, -0.064));
    let step = octagloss_row_number(
        terms,
        vec4<f32>(-0.509, -0.287, 0.427, -0.088),
        vec4<f32>(0.234, -0.052, -0.085, 0.361),
        vec4<f32>(0.054, 0.157, 0.012, 0.191));
    let bend = octagloss_row_number(
        terms,
        vec4<f32>(-0.565, -0.221, -0.153, -0.803),
        vec4<f32>(-0.329, 0.168, -0.066, -0.018),
        vec4<f32>(-0.016, 0.148, -0.022, 0.161));
    let width = octagloss_row_number(
        terms,
        vec4<f32>(0.284, 1.090, -0.036, -0.148),
        vec4<f32>(-0.071, -0.010, -0.058, -0.113),
        vec4<f32>(-0.009, -0.116, -0.045, -0.229));
    let growth = octagloss_row_number(
        terms,
        vec4<f32>(-0.150, 0.374, 0.152, 0.064),
        vec4<f32>(-0.469, -0.105, 0.057, -0.678),
        vec4<f32>(0.099, -0.303, 0.036, -0.038));
    let uneven = octagloss_row_number(
        terms,
        vec4<f32>(0.399, 0.142, -0.070, -0.052),
        vec4<f32>(-0.032, -0.014, -0.090, -0.173),
        vec4<f32>(0.032, -0.020, 0.144, 0.075));
    return octagloss_Row(
        vec2<f32>(axis.x, axis.y / cosine) * sqrt(2.0 * root),
        extent,
        shift * tilt,
        exp(vec4<f32>(step, bend, width, growth)),
        exp(uneven),
        smoothstep(0.0, octagloss_SKEWED, axis.x));
}

// Slope along the axis, and level, of a read.
fn octagloss_row_read(row: octagloss_Row, read: u32) -> vec2<f32> {
    // Reads are 8 / 14 apart.
    let place = (f32(read) - f32(octagloss_ROW_MIDDLE)) * 0.571428571 + row.shift;
    let slope = row.steps.z * row.steps.x * sinh(row.steps.y * place) / row.steps.y;
    let wider = select(1.0 / row.alternation, row.alternation, read % 2u == octagloss_ROW_MIDDLE % 2u);
    let growth = row.steps.w * slope;
    let width = wider * row.steps.z * sqrt(1.0 + growth * growth) * row.extent;
    // The widest level's Gaussian is 0.35 wide, at 32 texels; the mirror's 1.8 over its texels, the sharp
    // level's 5.6.
    let inner = octagloss_map_inner();
    let last = log2(inner) - 3.0;
    let sharp = last + log2(max(width, 1e-9) / 0.35);
    // 1 / log2(5.6 / 1.8).
    let below = max(log2(max(width, 1e-9) * inner / 1.8) * 0.610706, 0.0);
    return vec2<f32>(slope, select(below, min(sharp, last), sharp >= 1.0));
}

// Radiance reflected with `alpha` along `tangent` and across it: the tangent along the plane of incidence and
// across it.
fn octagloss_reflect_in_row(
    probe: u32,
    surface: octagloss_SurfaceFrame,
    tangent: vec2<f32>,
    alpha: vec2<f32>,
    f0: vec3<f32>,
    f90: f32,
) -> vec3<f32> {
    let n = surface.normal;
    let across = cross(n, surface.towards);
    let v = surface.towards * surface.sine + n * surface.cosine;
    let place = octagloss_row_place(alpha, surface.cosine, tangent);
    let row = octagloss_row_of(alpha, tangent, surface.cosine);
    let axis = surface.towards * row.axis.x + across * row.axis.y;
    let more = octagloss_row_more(alpha, surface.cosine, tangent).xy;
    let albedo = octagloss_row_albedo(alpha, surface.cosine, tangent.x * tangent.x, more);
    let scaled = f0 * albedo.x;
    let grazing = f90 * albedo.y;
    var sum = vec3<f32>();
    var in_mirror = 0.0;
    for (var distance = 0u; distance <= octagloss_ROW_MIDDLE; distance++) {
        let texel = octagloss_row_node(distance, place);
        var mean = texel.xy;
        var skew = vec2<f32>();
        if distance == 0u {
            sum += (scaled * texel.z + grazing * texel.w) * octagloss_cosine_light(probe, n);
        } else {
            mean = 0.5 * (texel.xy + texel.zw);
            skew = 0.5 * row.skew * (texel.xy - texel.zw);
        }
        for (var side = 0u; side < min(distance + 1u, 2u); side++) {
            let weights = select(mean - skew, mean + skew, side == 0u);
            let read = octagloss_row_read(row, select(octagloss_ROW_MIDDLE - distance, octagloss_ROW_MIDDLE + distance, side == 0u));
            let half_vector = normalize(n + read.x * axis);
            let direction = half_vector * (2.0 * dot(v, half_vector)) - v;
            sum += (scaled * weights.x + grazing * weights.y) * octagloss_between_levels(probe, direction, read.y);
            in_mirror += dot(albedo, weights) * max(1.0 - read.y, 0.0);
        }
    }
    var pairs = array<vec4<f32>, 8>();
    for (var k = 0u; k < 8u; k++) {
        pairs[k] = octagloss_row_node(octagloss_ROW_PAIRS + k, place);
    }
    sum += octagloss_harmonics_reflected(probe, surface, pairs, scaled, grazing);
    // Harmonics that change sign in the plane of incidence. The table is for tangents on one side of it.
    var aside = array<vec3<f32>, 4>(
        vec3<f32>(0.462034181, 0.546550727, -0.698431613),
        vec3<f32>(0.896618294, 0.386504464, 0.216078536),
        vec3<f32>(0.118148049, 0.383575285, 0.915920870),
        vec3<f32>(0.140111780, 0.817230125, -0.559020226));
    let mirrored = across * select(1.0, -1.0, tangent.x * tangent.y < 0.0);
    var texel = pairs[7];
    var pair = 15u;
    for (var k = 0u; k < 4u; k++) {
        let level = surface.towards * aside[k].x + n * aside[k].z;
        var own = octagloss_harmonic_orders(probe, level + mirrored * aside[k].y);
        var other = octagloss_harmonic_orders(probe, level - mirrored * aside[k].y);
        for (var order = k + 1u; order < 5u; order++) {
            if pair % 2u == 0u {
                texel = octagloss_row_node(octagloss_ROW_PAIRS + pair / 2u, place);
            }
            let weights = select(texel.zw, texel.xy, pair % 2u == 0u);
            sum += (scaled * weights.x + grazing * weights.y) * (own[order] - other[order]);
            pair++;
        }
    }
    sum = max(sum, vec3<f32>()) * octagloss_lights[probe].unscale;
    let share = max(1.0 - in_mirror / (albedo.x + albedo.y), 0.0);
    return sum + share * octagloss_suns_reflected(probe, surface, tangent, alpha, f0, f90);
}

// Radiance that a surface reflects to a viewer: GGX with Smith's height-correlated masking and Schlick's
// Fresnel term f0 + (f90 - f0) (1 - v.h)^5. `normal` and `view`, towards the viewer, are in world space, of
// any length but zero; `roughness` is in [0, 1]. A view with n.v below 0.01, or from below the surface, is
// turned up to that. `anisotropy`, of KHR_materials_anisotropy, is taken to [0, 1]; of the `tangent`, of any
// length and either sign, counts what is at right angles to the normal. If nothing is, the reflection is
// isotropic.
fn octagloss_reflect(
    normal: vec3<f32>,
    view: vec3<f32>,
    tangent: vec3<f32>,
    roughness: f32,
    anisotropy: f32,
    f0: vec3<f32>,
    f90: f32,
) -> vec3<f32> {
    return octagloss_reflect_of(0u, normal, view, tangent, roughness, anisotropy, f0, f90);
}

// The same in the environment `probe`.
fn octagloss_reflect_of(
    probe: u32,
    normal: vec3<f32>,
    view: vec3<f32>,
    tangent: vec3<f32>,
    roughness: f32,
    anisotropy: f32,
    f0: vec3<f32>,
    f90: f32,
) -> vec3<f32> {
    let surface = octagloss_surface_of(probe, normal, view);
    // Along the plane of incidence, and across it.
    var level = vec2<f32>();
    if anisotropy > 0.0 && dot(tangent, tangent) > 0.0 {
        let unit = octagloss_source_from_world(probe, tangent);
        let across = cross(surface.normal, surface.towards);
        level = vec2<f32>(dot(unit, surface.towards), dot(unit, across));
    }
    if dot(level, level) < 1e-10 {
        return octagloss_reflected_isotropic(probe, surface, roughness, f0, f90);
    }
    let alpha = octagloss_row_alphas(roughness, min(anisotropy, 1.0));
    let share = octagloss_row_share(alpha);
    let sum = share * octagloss_reflect_in_row(probe, surface, normalize(level), alpha, f0, f90);
    if share == 1.0 {
        return sum;
    }
    let round = sqrt(sqrt(alpha.x * alpha.y));
    return sum + (1.0 - share) * octagloss_reflected_isotropic(probe, surface, round, f0, f90);
}

// What a surface reflects of a white world, f0 times the first plus f90 times the second: for multiple
// scattering, and for what lies under a clear coat. `cosine` is n.v. With anisotropy it is the mean over the
// tangent's directions.
fn octagloss_albedo(cosine: f32, roughness: f32, anisotropy: f32) -> vec2<f32> {
    if anisotropy <= 0.0 {
        return octagloss_round_albedo(cosine, roughness);
    }
    let alpha = octagloss_row_alphas(roughness, min(anisotropy, 1.0));
    let seen = clamp(cosine, octagloss_LEAST_COSINE, 1.0);
    let more = octagloss_row_more(alpha, seen, vec2<f32>(1.0, 0.0)).zw;
    return octagloss_faded_albedo(alpha, seen, octagloss_row_albedo(alpha, seen, 0.5, more));
}

// The same along a tangent: `along` is t.v, the tangent of length 1 and at right angles to the normal.
fn octagloss_albedo_along(cosine: f32, along: f32, roughness: f32, anisotropy: f32) -> vec2<f32> {
    if anisotropy <= 0.0 {
        return octagloss_round_albedo(cosine, roughness);
    }
    let alpha = octagloss_row_alphas(roughness, min(anisotropy, 1.0));
    let seen = clamp(cosine, octagloss_LEAST_COSINE, 1.0);
    let x = min(abs(along) / max(sqrt(1.0 - seen * seen), 1e-4), 1.0);
    let more = octagloss_row_more(alpha, seen, vec2<f32>(x, sqrt(1.0 - x * x))).xy;
    return octagloss_faded_albedo(alpha, seen, octagloss_row_albedo(alpha, seen, x * x, more));
}

// `own` where the row has its whole share, else partly that of a round lobe.
fn octagloss_faded_albedo(alpha: vec2<f32>, cosine: f32, own: vec2<f32>) -> vec2<f32> {
    return mix(octagloss_round_albedo(cosine, sqrt(sqrt(alpha.x * alpha.y))), own, octagloss_row_share(alpha));
}

// Squares of the array. The finest mip of the others has the mirror and the sharp level, the coarsest of the
// second the cosine.
const octagloss_LEVELS = 0i;
const octagloss_MIRROR = 1i;
const octagloss_SHARP = 2i;

// Texels of the tables: layers of nodes side by side, each with a column on either side and a row below that
// repeat its edges; four rows of weights; and the albedo, row after row. Samplers may round to a share of a
// texel.
const octagloss_TABLES = vec2<f32>(864.0, 39.0);

fn octagloss_map_inner() -> f32 {
    return f32(textureDimensions(octagloss_maps).x) * (16.0 / 17.0);
}

fn octagloss_map_border() -> f32 {
    return f32(textureDimensions(octagloss_maps).x) / 34.0;
}

fn octagloss_node_weights(node: u32) -> array<vec4<f32>, 4> {
    var weights = array<vec4<f32>, 4>();
    for (var row = 0u; row < 4u; row++) {
        weights[row] = textureLoad(octagloss_tables, vec2<u32>(node, 27u + row), 0i);
    }
    return weights;
}

fn octagloss_read_mirror(probe: u32, at: vec2<f32>) -> vec3<f32> {
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, octagloss_MIRROR, 0.0).xyz;
}

fn octagloss_read_sharp(probe: u32, at: vec2<f32>) -> vec3<f32> {
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, octagloss_SHARP, 0.0).xyz;
}

// Between levels, 0 the finest.
fn octagloss_read_levels(probe: u32, at: vec2<f32>, level: f32) -> vec3<f32> {
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, octagloss_LEVELS, level).xyz;
}

fn octagloss_read_cosine(probe: u32, at: vec2<f32>) -> vec3<f32> {
    let last = round(log2(octagloss_map_inner() / 32.0));
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, octagloss_MIRROR, last).xyz;
}

fn octagloss_read_reflections(layer: u32, at: vec2<f32>) -> vec4<f32> {
    let corner = vec2<f32>(1.0 + f32(layer) * (octagloss_NODES.x + 2.0), 0.0);
    return textureSampleLevel(octagloss_tables, octagloss_linear, (at * octagloss_NODES + corner) / octagloss_TABLES, 0.0);
}

// A texel of the table of src/pyramid/albedo.rs.
fn octagloss_read_albedo(texel: u32) -> vec4<f32> {
    let width = u32(octagloss_TABLES.x);
    return textureLoad(octagloss_tables, vec2<u32>(texel % width, 31u + texel / width), 0);
}

// The table of src/pyramid/anisotropic.rs, between texels.
fn octagloss_read_rows(at: vec3<f32>) -> vec4<f32> {
    return textureSampleLevel(octagloss_rows, octagloss_linear, at, 0.0);
}
