// Reads of a pyramid's squares in its files: crates/core/src/files/io/pyramid_write.rs has their layout.
#include "common/pyramid_file_tables.wgsl"
#include "common/pyramid_squares.wgsl"

// Squares of the array. The finest mip of the others has the mirror and the sharp level, the coarsest of the
// second the cosine, and those before it the middle levels.
const LEVELS = 0i;
const MIRROR = 1i;
const SHARP = 2i;

// The table's first row of weights.
const WEIGHTS_FROM = 27u;

// Texels along an edge of the finest squares, without their borders.
fn map_inner() -> f32 {
    return f32(textureDimensions(octagloss_maps).x) * (16.0 / 17.0);
}

fn read_mirror(probe: u32, at: vec2<f32>) -> vec3<f32> {
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, MIRROR, 0.0).xyz;
}

fn read_sharp(probe: u32, at: vec2<f32>) -> vec3<f32> {
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, SHARP, 0.0).xyz;
}

// Between levels, 0 the finest.
fn read_levels(probe: u32, at: vec2<f32>, level: f32) -> vec3<f32> {
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, LEVELS, level).xyz;
}

// A middle level, 0 the finer.
fn read_middle(probe: u32, at: vec2<f32>, middle: f32) -> vec3<f32> {
    let first = max(coarsest_mip() - 2.0, 1.0);
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, MIRROR, first + middle).xyz;
}

fn read_cosine(probe: u32, at: vec2<f32>) -> vec3<f32> {
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, MIRROR, coarsest_mip()).xyz;
}

fn coarsest_mip() -> f32 {
    return round(log2(map_inner() / 32.0));
}
