// Four sibling cells, field by field: `Quad` of src/cpu/cells.rs as QUAD_FIELDS vectors. Lengths are in radii
// of the sphere; luminance and colours are of energies (radiance times solid angle).
#include "common/luminance.wgsl"

const QUAD_FIELDS = 20u;
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
// Dipoles of red and blue around the luminance's centroid: x, y, z.
const FIELD_RED_DIPOLE = 14u;
const FIELD_BLUE_DIPOLE = 17u;
