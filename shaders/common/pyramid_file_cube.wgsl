// Reads of a pyramid on a cube in its files: a MIP level for each map.
#include "common/pyramid_file_tables.wgsl"

// A unit vector.
alias MapPlace = vec3<f32>;

fn place_of(direction: vec3<f32>) -> MapPlace {
    return direction;
}

// Octaves between the widths of levels.
const LEVEL_OCTAVES = 1.0f;

fn map_inner() -> f32 {
    return f32(textureDimensions(octagloss_maps).x);
}

// The widest level: the last one has eight texels along an edge of a face.
fn last_map() -> f32 {
    return log2(map_inner()) - 3.0;
}

// A map: 0 is the mirror, then come the Gaussians from fine to coarse.
fn read_map(probe: u32, at: MapPlace, map: u32) -> vec3<f32> {
    return textureSampleLevel(octagloss_maps, octagloss_linear, at, f32(map)).xyz;
}

// The clamped cosine, to order 4.
fn read_cosine(probe: u32, at: MapPlace) -> vec3<f32> {
    return harmonics_around(probe, at, array<f32, 5>(1.0, 0.66666667, 0.25, 0.0, -0.041666667));
}
