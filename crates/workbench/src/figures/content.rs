//! Content of figures other than the maps.

use crate::laboratory::measure::Settings;
use octagloss_core::common::error::{Result, wrong};
use octagloss_core::light::environment::Environment;

/// What figures show of the maps.
#[derive(Clone, Debug)]
pub struct FigureContent {
    /// The environment of the figure `panorama`.
    pub panorama: Environment,
    /// Its name in captions.
    pub panorama_name: String,
    /// Texels along the square of the figure `border`, 1 to `MAX_SIZE`.
    pub size: u32,
    /// Width of its border in texels, at most the size.
    pub border: u32,
    /// What the figures of lobes measure.
    pub lobes: Settings,
}

/// The largest square of the figure `border` with room for texel names.
const MAX_SIZE: u32 = 12;

impl FigureContent {
    /// Returns the synthetic sky, and 8 texels with a border of 2.
    ///
    /// # Errors
    /// As [`octagloss_core::light::synth::synth`].
    pub fn new() -> Result<Self> {
        let panorama = octagloss_core::light::synth::synth("sky")?;
        // Those of the table, so that the figures show its numbers.
        let lobes = Settings::default();
        Ok(Self { panorama, panorama_name: "hdr/sky.exr".to_owned(), size: 8, border: 2, lobes })
    }

    /// Checks that the square and its border can be drawn.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] naming the size or the border.
    pub fn check(&self) -> Result<()> {
        let Self { size, border, .. } = *self;
        if size == 0 || size > MAX_SIZE {
            return wrong(format!("`size` {size} must be 1 to {MAX_SIZE} texels"));
        }
        if border > size {
            return wrong(format!("`border` {border} exceeds the map's side of {size} texels"));
        }
        Ok(())
    }
}
