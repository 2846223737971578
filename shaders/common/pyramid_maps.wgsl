// Reads of pyramids in textures that several environments share, and their look-ups.
#include "common/pyramid.wgsl"
#include "common/pyramid_squares.wgsl"

// The table of crates/core/src/pyramid/fit.rs, and the maps' size.
struct OctaglossPyramid {
    // Texels along an edge of the finest maps, and of their border.
    inner: f32,
    border: f32,
    pad_a: u32,
    pad_b: u32,
    // Weights at a node: mirror, sharp level, seven levels from fine to coarse, cosine, harmonics of order 0
    // to 4, 1 over the integral of GGX.
    weights: array<array<vec4<f32>, 4>, INTERVALS + 1u>,
}

fn map_inner() -> f32 {
    return octagloss_pyramid.inner;
}

fn map_border() -> f32 {
    return octagloss_pyramid.border;
}

fn node_weights(node: u32) -> array<vec4<f32>, 4> {
    return octagloss_pyramid.weights[node];
}

fn read_mirror(probe: u32, at: vec2<f32>) -> vec3<f32> {
    return textureSampleLevel(octagloss_sharp, octagloss_linear, at, 2u * probe, 0.0).xyz;
}

fn read_sharp(probe: u32, at: vec2<f32>) -> vec3<f32> {
    return textureSampleLevel(octagloss_sharp, octagloss_linear, at, 2u * probe + 1u, 0.0).xyz;
}

// Between levels, 0 the finest.
fn read_levels(probe: u32, at: vec2<f32>, level: f32) -> vec3<f32> {
    return textureSampleLevel(octagloss_levels, octagloss_linear, at, probe, level).xyz;
}

fn read_cosine(probe: u32, at: vec2<f32>) -> vec3<f32> {
    return textureSampleLevel(octagloss_cosine, octagloss_linear, place_in_cosine(at), probe, 0.0).xyz;
}
