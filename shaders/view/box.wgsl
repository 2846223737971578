// Viewer pipeline for single boxes, and its pictures of the tables. Entries are 64-bit fixed point, as in
// crates/core/src/light/sat.rs.
@group(1) @binding(0) var<uniform> octagloss_table: OctaglossTable;
@group(1) @binding(1) var octagloss_low: texture_2d<u32>;
@group(1) @binding(2) var octagloss_high: texture_2d<u32>;
#include "common/sat.wgsl"
#include "common/view_draw.wgsl"
#include "common/view_split.wgsl"

fn radiance(direction: vec3<f32>, roughness: f32, pixel: vec2<f32>) -> vec3<f32> {
    return octagloss_ggx(direction, roughness);
}

// Pictures of the tables are opaque in their square and clear around it. Position of a pixel in the centred
// square as high or wide as the picture: 0 to 1 inside.
fn place_in_square(pixel: vec2<f32>) -> vec2<f32> {
    let side = min(frame.size.x, frame.size.y);
    return (pixel - 0.5 * (frame.size - side)) / side;
}

fn in_square(place: vec2<f32>) -> bool {
    return all(place >= vec2<f32>(0.0)) && all(place < vec2<f32>(1.0));
}

@fragment
fn oem(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let place = place_in_square(at.xy);
    if !in_square(place) {
        return vec4<f32>();
    }
    let n = f32(octagloss_table.inner);
    let texel = vec2<i32>(place * n);
    let light = floats_from_sum(plane_box(texel, texel + 1));
    return exposed(light);
}

// Shows the mean radiance of the box from the upper left corner of the bordered table to the pixel. Reads one
// corner: with four, Mesa's llvmpipe 22.3 overruns its stack.
@fragment
fn sat(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let place = place_in_square(at.xy);
    if !in_square(place) {
        return vec4<f32>();
    }
    let corner = vec2<i32>(place * f32(octagloss_table.inner)) + i32(octagloss_table.border) + 1;
    return exposed(floats_from_sum(table_prefix(corner.x, corner.y)));
}

fn exposed(sum: vec4<f32>) -> vec4<f32> {
    let up = octagloss_table.exponents.a - octagloss_table.exponents.rgb;
    let light = vec3<f32>(
        scale_by_power(sum.r, up.r), scale_by_power(sum.g, up.g), scale_by_power(sum.b, up.b)) / sum.a;
    return vec4<f32>(min(light * frame.exposure, vec3<f32>(GREATEST)), 1.0);
}
