//! Mean radiances over the texels of a map.

use crate::common::error::Result;
use crate::geometry::overlap::{Target, of_mean_radiances, panorama_mean_radiances};
use crate::light::environment::{Environment, Layout, Rgb};

/// The mean radiances over the texels of `layout`, in the world.
///
/// # Errors
/// [`crate::common::error::Error::Limit`] if the overlaps do not fit.
pub fn footprints_over(environment: &Environment, layout: Layout) -> Result<Vec<Rgb>> {
    let target = match layout {
        Layout::Cube { size } => Target::Cube(size),
        Layout::Octahedral { size } => Target::Octahedral(size),
        Layout::Panorama { width, height } => return panorama_mean_radiances(environment, width, height),
    };
    of_mean_radiances(environment, environment.source_from_world().transpose(), target, |_, mean| mean)
}
