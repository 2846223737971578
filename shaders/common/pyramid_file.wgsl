// Reads of a pyramid in its files: crates/core/src/files/io/pyramid_write.rs has their layout.
#include "common/anisotropic.wgsl"

// Squares of the array. The finest mip of the others has the mirror and the sharp level, the coarsest of the
// second the cosine.
const LEVELS = 0i;
const MIRROR = 1i;
const SHARP = 2i;

// Texels of the tables: layers of nodes side by side, each with a column on either side and a row below that
// repeat its edges; four rows of weights; and the albedo, row after row. Samplers may round to a share of a
// texel.
const TABLES = vec2<f32>(864.0, 39.0);

fn map_inner() -> f32 {
    return f32(textureDimensions(octagloss_maps).x) * (16.0 / 17.0);
}

fn map_border() -> f32 {
    return f32(textureDimensions(octagloss_maps).x) / 34.0;
}

fn node_weights(node: u32) -> array<vec4<f32>, 4> {
    var weights = array<vec4<f32>, 4>();
    for (var row = 0u; row < 4u; row++) {
        weights[row] = textureLoad(octagloss_tables, vec2<u32>(node, 27u + row), 0i);
    }
    return weights;
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

fn read_cosine(probe: u32, at: vec2<f32>) -> vec3<f32> {
    let last = round(log2(map_inner() / 32.0));
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, MIRROR, last).xyz;
}

fn read_reflections(layer: u32, at: vec2<f32>) -> vec4<f32> {
    let corner = vec2<f32>(1.0 + f32(layer) * (NODES.x + 2.0), 0.0);
    return textureSampleLevel(octagloss_tables, octagloss_linear, (at * NODES + corner) / TABLES, 0.0);
}

// A texel of the table of crates/core/src/pyramid/albedo.rs.
fn read_albedo(texel: u32) -> vec4<f32> {
    let width = u32(TABLES.x);
    return textureLoad(octagloss_tables, vec2<u32>(texel % width, 31u + texel / width), 0);
}

// The table of crates/core/src/pyramid/anisotropic.rs, between texels.
fn read_rows(at: vec3<f32>) -> vec4<f32> {
    return textureSampleLevel(octagloss_rows, octagloss_linear, at, 0.0);
}
