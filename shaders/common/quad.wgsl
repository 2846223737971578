// Four sibling cells, field by field: `Quad` of crates/core/src/cpu/cells.rs as QUAD_FIELDS vectors. Lengths
// are in radii of the sphere; luminance and colours are of energies (radiance times solid angle).
#include "common/luminance.wgsl"

const QUAD_FIELDS = 34u;
// The centroid: x, y, z.
const FIELD_X = 0u;
// xx, yy, zz, yz, zx, xy.
const FIELD_COVARIANCE = 3u;
const FIELD_RADIUS = 9u;
const FIELD_LUMINANCE = 10u;
// Energy: red, green, blue.
const FIELD_RED = 11u;
// Tints of red and blue (crates/core/src/geometry/tint.rs): dipole x, y, z; quadrupole xx, yy, zz, yz, zx,
// xy; variation.
const FIELD_RED_TINT = 14u;
const FIELD_BLUE_TINT = 24u;
const TINT_FIELDS = 10u;
