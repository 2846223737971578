// What later passes need of an OEM's seeds: `seek` of pyramid/seeds.wgsl finds it.
#include "common/light.wgsl"

// Bits of a brightness that do not count, and half of these.
const BELOW = 255u;
const HALF = 128u;
// Areas along an edge, in which seeds are sought.
const AREAS = 16u;

struct Seeds {
    // Of `OctaglossLight`.
    scale: f32,
    unscale: f32,
    clamp: f32,
    pad: f32,
    directions: array<vec4<f32>, SUNS>,
}
