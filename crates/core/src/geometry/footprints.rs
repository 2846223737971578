//! Mean radiances over the texels of a map.

use crate::common::error::Result;
use crate::geometry::overlap::{Space, Target, mean_radiances, panorama_mean_radiances};
use crate::light::environment::{Environment, Layout, Rgb};

/// Mean radiance over every texel's footprint of a cube in the world: `size` x `size` x 6 texels.
///
/// # Errors
/// [`crate::common::error::Error::Limit`] if the overlaps do not fit.
pub fn footprints_from_environment(environment: &Environment, size: u32) -> Result<Vec<Rgb>> {
    mean_radiances(environment, Target::Cube(size), Space::World)
}

/// The mean radiances over the texels of `layout`, in the world.
///
/// # Errors
/// [`crate::common::error::Error::Limit`] if the overlaps do not fit.
pub fn footprints_over(environment: &Environment, layout: Layout) -> Result<Vec<Rgb>> {
    match layout {
        Layout::Cube { size } => footprints_from_environment(environment, size),
        Layout::Octahedral { size } => mean_radiances(environment, Target::Octahedral(size), Space::World),
        Layout::Panorama { width, height } => panorama_mean_radiances(environment, width, height),
    }
}
