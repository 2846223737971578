//! Sizes that the containers of targets can hold.

use crate::common::error::{Result, wrong};
use crate::files::io::pyramid_write;
use crate::pyramid::Octaves;

/// Checks that an `.env` can hold a chain of `levels` from `size` down.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if the reader would reject it.
pub(crate) fn check_env(size: u32, levels: u32) -> Result<()> {
    if size.is_power_of_two() && levels == size.ilog2() + 1 {
        return Ok(());
    }
    wrong(format!(
        "an .env needs a `size` that is a power of two and all its levels down to 1; {size} with {levels} \
         levels is not"
    ))
}

pub(crate) const EXTENSION: &str = "EXT_lights_image_based";

/// Checks that a chain from `size` down can be a light.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if the extension forbids it.
pub(crate) fn check_glb(size: u32) -> Result<()> {
    if size.is_power_of_two() {
        return Ok(());
    }
    wrong(format!("{EXTENSION} needs a `size` that is a power of two; {size} is not"))
}

/// Levels of PlayCanvas's atlas.
pub(crate) const ATLAS_LEVELS: u32 = 6;

/// Checks that an atlas can hold a chain of `levels` from `size` down.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if the reader would look up other levels, or none.
pub(crate) fn check_atlas(size: u32, levels: u32) -> Result<()> {
    if size.is_power_of_two() && size >= 1 << (ATLAS_LEVELS - 1) && levels == ATLAS_LEVELS {
        return Ok(());
    }
    wrong(format!(
        "an atlas needs a `size` that is a power of two from 32, and {ATLAS_LEVELS} levels; {size} with \
         {levels} levels is not"
    ))
}

/// Checks that a pyramid over a map of `size` can be written.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if it cannot, or if it has other than `levels` levels.
pub(crate) fn check_pyramid(size: u32, levels: u32) -> Result<()> {
    pyramid_write::check_size(size)?;
    let own = Octaves::over(size)?.count();
    if levels == own {
        return Ok(());
    }
    wrong(format!("a pyramid of `size` {size} has {own} levels, not {levels}; omit `levels`"))
}
