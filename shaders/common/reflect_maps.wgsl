// Reads of the tables of reflections in textures of their own, and all look-ups.
#include "common/pyramid_maps.wgsl"
#include "common/anisotropic.wgsl"

fn read_reflections(layer: u32, at: vec2<f32>) -> vec4<f32> {
    return textureSampleLevel(octagloss_reflections, octagloss_linear, at, layer, 0.0);
}

// A texel of the table of crates/core/src/pyramid/albedo.rs, which fills the layers after those of the reads.
fn read_albedo(texel: u32) -> vec4<f32> {
    let size = vec2<u32>(NODES);
    let at = vec2<u32>(texel % size.x, texel / size.x % size.y);
    return textureLoad(octagloss_reflections, at, LAYERS + texel / (size.x * size.y), 0);
}

// The table of crates/core/src/pyramid/anisotropic.rs, between texels.
fn read_rows(at: vec3<f32>) -> vec4<f32> {
    return textureSampleLevel(octagloss_rows, octagloss_linear, at, 0.0);
}
