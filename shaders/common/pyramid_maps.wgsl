// Reads of pyramids in textures that several environments share, and their look-ups.
#include "common/pyramid.wgsl"
#include "common/pyramid_squares.wgsl"

const NODES_A_ROW = 32u;

// Texels along an edge of the finest maps, without their borders. The table has them beside its nodes: so
// every look-up uses it, and layouts that are derived from shaders have it.
fn map_inner() -> f32 {
    return weights_texel(INTERVALS + 1u, 0u).x;
}

// A node of the table of crates/core/src/pyramid/fit.rs: weights of the mirror, nine Gaussians from fine to
// coarse, the cosine, harmonics of order 0 to 4; 1 over the integral of GGX.
// In a texture: the pixels of a group read several nodes, which uniform buffers serve one after another.
fn node_weights(node: u32) -> array<vec4<f32>, 5> {
    return array<vec4<f32>, 5>(
        weights_texel(node, 0u), weights_texel(node, 1u), weights_texel(node, 2u), weights_texel(node, 3u),
        weights_texel(node, 4u));
}

// Four weights of a node.
fn weights_texel(node: u32, part: u32) -> vec4<f32> {
    return textureLoad(octagloss_weights, vec2<u32>(node % NODES_A_ROW * 5u + part, node / NODES_A_ROW), 0);
}
