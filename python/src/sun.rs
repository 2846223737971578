//! The sun, or the brightest region.

use octagloss::recipes::SunReport;
use octagloss::suns::{Brightest, Sun as Found};
use pyo3::prelude::*;

/// The brightest region of an environment.
///
/// It is the region connected to the brightest texel and at least a tenth as bright. It is a sun if it is 100
/// times as bright as its surroundings and covers at most 0.01 sr (or nine texels).
#[pyclass(frozen, get_all, module = "octagloss")]
#[derive(Clone, Debug)]
pub(crate) struct Sun {
    /// Whether a directional light can replace it; else it is larger or dimmer than a sun.
    is_sun: bool,
    /// Unit vector towards it.
    direction: (f64, f64, f64),
    /// Degrees from +X towards +Z.
    azimuth_degrees: f64,
    /// Degrees above the horizon.
    elevation_degrees: f64,
    /// Radiance of its brightest texel.
    peak: (f32, f32, f32),
    /// Irradiance on a surface that faces it.
    irradiance: (f64, f64, f64),
    /// Irradiance over its largest channel.
    color: (f64, f64, f64),
    /// Steradians.
    solid_angle: f64,
    /// Number of texels.
    texels: usize,
    /// Its share of the environment's energy, by luminance.
    energy_share: f64,
    /// Median luminance around it.
    surroundings: f64,
}

impl Sun {
    pub(crate) fn new(sun: &Found, energy_share: f64) -> Self {
        let is_sun = sun.kind == Brightest::Sun;
        Self::of(&SunReport::new(sun, energy_share), is_sun)
    }

    pub(crate) fn of(report: &SunReport, is_sun: bool) -> Self {
        Self {
            is_sun,
            direction: report.direction.into(),
            azimuth_degrees: report.azimuth_degrees,
            elevation_degrees: report.elevation_degrees,
            peak: report.peak.into(),
            irradiance: report.irradiance.into(),
            color: report.color.into(),
            solid_angle: report.solid_angle,
            texels: report.texels,
            energy_share: report.energy_share,
            surroundings: report.surroundings,
        }
    }
}

#[pymethods]
impl Sun {
    fn __repr__(&self) -> String {
        let (x, y, z) = self.direction;
        let what = if self.is_sun { "sun" } else { "brightest region" };
        format!(
            "<octagloss.Sun: {what} at ({x:.4}, {y:.4}, {z:.4}), {:.3e} sr, {:.1} % of the energy>",
            self.solid_angle,
            100.0 * self.energy_share
        )
    }
}
