//! Resamples the environment to the OEM by area: every source texel's energy is kept, and a constant stays
//! constant.

use crate::common::error::Result;
use crate::common::parallel;
use crate::geometry::overlap::{Target, of_mean_radiances, surely_fits};
use crate::geometry::solid_angles::solid_angles;
use crate::light::environment::{Environment, Layout, Rgb};
use crate::light::oem::{Oem, OemSize};
use glam::DMat3;

/// Whether [`oem_from_environment`] cannot fail for sources of `layout`.
pub(crate) fn is_infallible(layout: Layout, size: OemSize) -> bool {
    layout == (Layout::Octahedral { size: size.inner }) || surely_fits(layout, Target::Octahedral(size.inner))
}

/// The OEM of `environment` in the source's own space; queries are rotated instead.
///
/// # Errors
/// [`crate::common::error::Error::Limit`] if the overlaps do not fit in memory.
pub fn oem_from_environment(environment: &Environment, size: OemSize) -> Result<Oem> {
    let n = size.inner;
    let weights = solid_angles(n);
    let energy = |k: usize, [r, g, b]: Rgb| {
        let (x, y) = (k % n as usize, k / n as usize);
        let solid_angle = weights.at(x as u32, y as u32);
        [r * solid_angle, g * solid_angle, b * solid_angle, solid_angle]
    };
    let square = if environment.layout() == (Layout::Octahedral { size: n }) {
        let texels = environment.texels();
        parallel::values(texels.len(), |k| energy(k, texels[k]))
    } else {
        of_mean_radiances(environment, DMat3::IDENTITY, Target::Octahedral(n), energy)?
    };
    Ok(Oem::from_square(size, square))
}
