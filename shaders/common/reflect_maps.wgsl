// Reads of the table of reflections in a texture of its own, and the look-ups of both files.
#include "common/pyramid_maps.wgsl"
#include "common/reflect.wgsl"

fn read_reflections(layer: u32, at: vec2<f32>) -> vec4<f32> {
    return textureSampleLevel(octagloss_reflections, octagloss_linear, at, layer, 0.0);
}
