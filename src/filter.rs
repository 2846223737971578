//! How a lobe is evaluated.

use crate::cpu::adaptive::LEAST_ERROR;
use crate::environment::Rgb;
use crate::error::{Error, Result};
use crate::lobe::Lobe;
use crate::realtime::tables::COUNTS;

/// How a lobe is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Quadrature with a certified bound; the number is the relRMSE aimed at over the sphere, in
    /// [[`LEAST_ERROR`], 1).
    Adaptive(f64),
    /// The real-time tier: this many soft boxes (1, 2, 4 or 8) and a harmonic term, fitted to GGX; see
    /// [`crate::realtime::tables`]. Irradiance is by [`Filter::Adaptive`] of 0.005.
    Fitted(u32),
    /// The paper's single box.
    Box,
    /// Exhaustive integration over the source texels in double precision: slow, for auditing.
    Reference,
}

impl Filter {
    /// The filter of the lobes that come beside a chain's own, sheen and irradiance: fitted lobes are GGX
    /// alone.
    #[must_use]
    pub const fn beside(self) -> Self {
        match self {
            Self::Fitted(_) => Self::Adaptive(0.005),
            other => other,
        }
    }

    /// Whether it serves `lobe`, over an OEM of `inner` texels where that is settled.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an adaptive error outside [1e-6, 1); for fitted lobes other than GGX, of a
    /// count of boxes that there is not, or over an OEM that is no power of two from 16 on.
    pub fn check(self, lobe: Lobe, inner: Option<u32>) -> Result<()> {
        let wrong = |message: String| Err(Error::Parameter(message));
        match self {
            Self::Adaptive(error) if !(LEAST_ERROR..1.0).contains(&error) => wrong(format!(
                "adaptive:{error} is outside [{LEAST_ERROR:e}, 1): float32 sums reach no smaller error"
            )),
            Self::Box if lobe == Lobe::Charlie => wrong(
                "one box around a direction is no Charlie lobe, which is dark there; use `filter` adaptive:E"
                    .to_owned(),
            ),
            Self::Fitted(count) if !COUNTS.contains(&count) => {
                wrong(format!("fitted:{count}: there are 1, 2, 4 and 8 boxes"))
            }
            Self::Fitted(count) if lobe != Lobe::Ggx => {
                wrong(format!("fitted:{count} is fitted to ggx; for {} take adaptive:E", lobe.name()))
            }
            Self::Fitted(count) => match inner {
                Some(inner) if !inner.is_power_of_two() || inner < 16 => wrong(format!(
                    "an OEM of {inner} texels: fitted:{count} needs `oem_size` to be a power of two from 16 on"
                )),
                _ => Ok(()),
            },
            _ => Ok(()),
        }
    }
}

/// The answer to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Radiance of the lobe.
    pub radiance: Rgb,
    /// Certified bound of its luminance's distance from exhaustive integration over the OEM; `None` where the
    /// filter has none.
    pub bound: Option<f32>,
}

impl Answer {
    /// A radiance or bound that is NaN, infinite or negative.
    pub(crate) fn wrong_value(&self) -> Option<f32> {
        let values = self.radiance.into_iter().chain(self.bound);
        values.into_iter().find(|value| !(value.is_finite() && *value >= 0.0))
    }
}
