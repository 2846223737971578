// Four sibling cells, field by field: `Quad` of crates/core/src/cpu/cells.rs as QUAD_FIELDS vectors. Lengths
// are in radii of the sphere; luminance and colours are of energies (radiance times solid angle).
#include "common/luminance.wgsl"

const QUAD_FIELDS = 34u;
const FIELD_X = 0u;
const FIELD_Y = 1u;
const FIELD_Z = 2u;
// xx, yy, zz, yz, zx, xy.
const FIELD_COVARIANCE = 3u;
const FIELD_RADIUS = 9u;
const FIELD_LUMINANCE = 10u;
const FIELD_RED = 11u;
const FIELD_GREEN = 12u;
const FIELD_BLUE = 13u;
// Tints of red and blue (crates/core/src/geometry/tint.rs): dipole x, y, z; quadrupole xx, yy, zz, yz, zx,
// xy; variation.
const FIELD_RED_TINT = 14u;
const FIELD_BLUE_TINT = 24u;
const TINT_FIELDS = 10u;
