// Reads of the tables in a pyramid's files: crates/core/src/files/io/pyramid_write.rs has their layout.
#include "common/anisotropic.wgsl"

// Texels of the tables: layers of nodes side by side, each with a column on either side and a row below that
// repeat its edges; five rows of weights; and the albedo, row after row. Samplers may round to a share of a
// texel.
const TABLES = vec2<f32>(864.0, 40.0);

fn node_weights(node: u32) -> array<vec4<f32>, 5> {
    var weights = array<vec4<f32>, 5>();
    for (var row = 0u; row < 5u; row++) {
        weights[row] = textureLoad(octagloss_tables, vec2<u32>(node, 27u + row), 0i);
    }
    return weights;
}

fn read_reflections(layer: u32, at: vec2<f32>) -> vec4<f32> {
    let corner = vec2<f32>(1.0 + f32(layer) * (NODES.x + 2.0), 0.0);
    return textureSampleLevel(octagloss_tables, octagloss_linear, (at * NODES + corner) / TABLES, 0.0);
}

// A texel of the table of crates/core/src/pyramid/albedo.rs.
fn read_albedo(texel: u32) -> vec4<f32> {
    let width = u32(TABLES.x);
    return textureLoad(octagloss_tables, vec2<u32>(texel % width, 32u + texel / width), 0);
}

// The table of crates/core/src/pyramid/anisotropic.rs, between texels.
fn read_rows(at: vec3<f32>) -> vec4<f32> {
    return textureSampleLevel(octagloss_rows, octagloss_linear, at, 0.0);
}
