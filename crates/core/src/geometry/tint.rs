//! How one channel's light in a cell differs from the luminance's.
//!
//! With E and L the energies of channel and luminance, the channel's light over the cell's directions l is
//! e(l) = E/L lum(l) + delta(l). The rest, delta, has zero total; a tint holds its moments around the
//! centroid m of the luminance, and a bound of its absolute value. A grey cell has none.

use super::tent::Patch;
use glam::{Vec3, Vec3Swizzles as _};

/// Numbers of a [`Tint`].
pub(crate) const TINT_FIELDS: usize = 10;

/// Place of [`Tint::variation`] among them.
pub(crate) const VARIATION: usize = 9;

/// Moments of what sets a channel's light in a cell apart from its share of the luminance's.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tint {
    /// Sum of delta (l - m).
    pub(crate) dipole: Vec3,
    /// Sum of delta (l - m)(l - m)^T, the quadrupole: xx, yy, zz.
    pub(crate) diagonal: Vec3,
    /// Quadrupole: yz, zx, xy.
    pub(crate) mixed: Vec3,
    /// Bound of the sum of |delta|.
    pub(crate) variation: f32,
}

impl Tint {
    pub(crate) const fn to_fields(self) -> [f32; TINT_FIELDS] {
        let Self { dipole: d, diagonal: a, mixed: b, variation } = self;
        [d.x, d.y, d.z, a.x, a.y, a.z, b.x, b.y, b.z, variation]
    }

    /// The tint of cell `k`.
    #[inline(always)]
    pub(crate) fn from_fields(fields: &[[f32; 4]; TINT_FIELDS], k: usize) -> Self {
        let vector = |first: usize| Vec3::new(fields[first][k], fields[first + 1][k], fields[first + 2][k]);
        Self { dipole: vector(0), diagonal: vector(3), mixed: vector(6), variation: fields[VARIATION][k] }
    }

    /// Adds the tint of a part whose centroid is `apart` from the whole's, and whose energy exceeds its share
    /// of the whole's, by luminance, by `excess`; `patch` has the part's covariance.
    #[inline(always)]
    pub(crate) fn absorb(&mut self, part: &Self, patch: &Patch, apart: Vec3, excess: f32) {
        let Self { dipole, diagonal, mixed, variation } = *part;
        self.dipole += dipole + apart * excess;
        self.diagonal += diagonal + 2.0 * apart * dipole + (patch.diagonal + apart * apart) * excess;
        self.mixed += mixed
            + apart.yzx() * dipole.zxy()
            + apart.zxy() * dipole.yzx()
            + (patch.mixed + apart.yzx() * apart.zxy()) * excess;
        self.variation += (variation + excess.abs()) * (1.0 + 1e-6);
    }
}
