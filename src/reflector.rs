//! Point queries: an environment made ready once, then asked for any direction and roughness.

use crate::bake::Filter;
use crate::environment::{Environment, Rgb};
use crate::error::Result;
use crate::lobe::Lobe;
use crate::oem::OemSize;
use glam::DVec3;

/// An environment's OEM and tables, ready to answer.
#[derive(Debug)]
pub struct Reflector {
    size: OemSize,
}

/// The answer to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Radiance of the lobe.
    pub radiance: Rgb,
    /// Certified bound of its luminance's distance from exhaustive integration over the OEM; `None` where the filter
    /// has none.
    pub bound: Option<f32>,
}

impl Reflector {
    /// Makes `environment` ready. `oem_size` and `border`: `None` for the defaults.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] where the table would not fit.
    pub fn new(_environment: &Environment, _oem_size: Option<u32>, _border: Option<u32>) -> Result<Self> {
        Err(crate::Error::Parameter("the reflector is under construction".to_owned()))
    }

    /// The OEM's size.
    #[must_use]
    pub const fn oem_size(&self) -> OemSize {
        self.size
    }

    /// Radiance of `lobe` at `roughness` in [0, 1] around `direction` (of the world, any length but zero).
    #[must_use]
    pub fn query(&self, _direction: DVec3, _roughness: f64, _lobe: Lobe, _filter: Filter) -> Answer {
        Answer { radiance: [0.0; 3], bound: None }
    }
}
