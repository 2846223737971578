//! What a picture of a scene shows.

use super::super::look::{Look, Tone};
use crate::look::camera::Camera;
use octagloss_core::common::error::Result;
use octagloss_core::common::names::named;
use octagloss_core::files::image::exposure::Exposure;

/// Shape of the surroundings that reflections are corrected for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Proxy {
    /// Infinitely far away.
    #[default]
    None,
    /// The box around the parts that do not move.
    Box,
    /// The sphere around that box's centre.
    Sphere,
}

named!(Proxy { None = "none", Box = "box", Sphere = "sphere" });

/// What a picture of a scene shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneLook {
    /// The camera.
    pub camera: Camera,
    /// Roughness of all glossy parts; `None` for their own.
    pub roughness: Option<f64>,
    /// Exposure in powers of two.
    pub exposure: f64,
    /// Tone mapping.
    pub tone: Tone,
    /// Correction of parallax.
    pub proxy: Proxy,
}

impl Default for SceneLook {
    fn default() -> Self {
        Self {
            camera: Camera { pitch: 7_f64.to_radians(), ..Camera::default() },
            roughness: None,
            exposure: 0.0,
            tone: Tone::default(),
            proxy: Proxy::default(),
        }
    }
}

impl SceneLook {
    /// Checks that every value is in its range.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] naming the value and its range.
    pub fn check(&self) -> Result<()> {
        // The ranges of what a scene's look shares with others.
        let roughness = self.roughness.unwrap_or(0.0);
        let exposure = Exposure::Ev(self.exposure);
        Look { camera: self.camera, roughness, exposure, ..Look::default() }.check()
    }
}
