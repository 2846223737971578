// The light of an OEM above the clamp: pyramid/suns.wgsl sums it for each area, pyramid/light.wgsl makes suns
// of the sums.
#include "common/seeds.wgsl"

// Moments of a channel's energy: of offsets from the seed, all; of products xx, yy, zz; of xy, yz, zx.
const MOMENTS = 10u;
// Of a sun's three channels, with two to spare.
const MOMENTS_OF_SUN = 32u;
// Moments of all suns.
const MOMENTS_OF_AREA = SUNS * MOMENTS_OF_SUN;

struct Excess {
    // Whether an area has light above the clamp.
    is_bright: array<u32, AREAS * AREAS>,
    // Of each such area.
    moments: array<array<f32, MOMENTS_OF_AREA>, AREAS * AREAS>,
}
