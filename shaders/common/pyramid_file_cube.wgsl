// Reads of a pyramid on a cube in its files: a MIP level for each map. There are no middle levels.
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

// A map: 0 is the mirror, 1 the sharp level, then come the levels from fine to coarse.
fn read_map(probe: u32, at: MapPlace, map: u32) -> vec3<f32> {
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, f32(map)).xyz;
}

fn read_middle(probe: u32, at: MapPlace, middle: u32) -> vec3<f32> {
    return vec3<f32>();
}

// The clamped cosine, to order 4.
fn read_cosine(probe: u32, at: MapPlace) -> vec3<f32> {
    return harmonics_around(probe, at, array<f32, 5>(1.0, 0.66666667, 0.25, 0.0, -0.041666667));
}
