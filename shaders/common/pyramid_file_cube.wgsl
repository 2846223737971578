// Reads of a pyramid on a cube in its files: MIP level 0 has the mirror, 1 the sharp level, then the levels
// come from fine to coarse. There are no middle levels.
#include "common/pyramid_file_tables.wgsl"

// A unit vector.
alias MapPlace = vec3<f32>;

fn place_of(direction: vec3<f32>) -> MapPlace {
    return direction;
}

// The table's first row of weights.
const WEIGHTS_FROM = 32u;

fn map_inner() -> f32 {
    return f32(textureDimensions(octagloss_maps).x);
}

fn read_mirror(probe: u32, at: MapPlace) -> vec3<f32> {
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, 0.0).xyz;
}

fn read_sharp(probe: u32, at: MapPlace) -> vec3<f32> {
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, 1.0).xyz;
}

// Between levels, 0 the finest.
fn read_levels(probe: u32, at: MapPlace, level: f32) -> vec3<f32> {
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, level + 2.0).xyz;
}

fn read_middle(probe: u32, at: MapPlace, middle: f32) -> vec3<f32> {
    return vec3<f32>();
}

// The clamped cosine, to order 4.
fn read_cosine(probe: u32, at: MapPlace) -> vec3<f32> {
    return harmonics_around(probe, at, array<f32, 5>(1.0, 0.66666667, 0.25, 0.0, -0.041666667));
}
