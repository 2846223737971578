//! Filters: methods of evaluating a lobe.

use crate::common::error::{Result, wrong};
use crate::light::environment::{Rgb, is_wrong};
use crate::light::sat::Scan;
use crate::lobe::Lobe;
use crate::pyramid::Levels;

/// The least error that [`Filter::Adaptive`] takes.
///
/// Float32 sums set it: a share of the light takes 32 roundings of 2^-24, 1.9e-6 together, whatever the
/// tolerance. Measured with hdr/studio.hdr at roughness 0.5, the certified bound falls until E = 1e-6 and
/// rises below, where additional leaves add more rounding than they remove; the answers have an error of 7e-6
/// at 1e-6 and of 1e-5 at 3e-7.
const MIN_ERROR: f64 = 1e-6;

/// Method of evaluating a lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Adaptive quadrature with a certified bound; the value is the target relRMSE over the sphere, in
    /// [`MIN_ERROR`, 1).
    Adaptive(f64),
    /// The real-time tier: levels and suns whose weighted sum is GGX, see `docs/pyramid.md`. Irradiance
    /// uses [`Filter::Adaptive`] with 0.005.
    Pyramid,
    /// The single box of the 2008 paper.
    Box,
    /// Exhaustive integration over the source texels in double precision: slow, for auditing.
    Reference,
}

impl Default for Filter {
    fn default() -> Self {
        Self::Adaptive(0.005)
    }
}

/// Writes the filter as on the command line and in reports.
impl std::fmt::Display for Filter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Adaptive(error) => write!(f, "adaptive:{error}"),
            Self::Pyramid => f.write_str("pyramid"),
            Self::Box => f.write_str("box"),
            Self::Reference => f.write_str("reference"),
        }
    }
}

impl Filter {
    /// Filter for a chain's secondary lobes, sheen and irradiance: pyramids support only GGX.
    #[must_use]
    pub const fn for_other_lobes(self) -> Self {
        match self {
            Self::Pyramid => Self::Adaptive(0.005),
            other => other,
        }
    }

    /// Whether the filter reads a summed-area table.
    #[must_use]
    pub const fn reads_sat(self) -> bool {
        matches!(self, Self::Box)
    }

    /// Checks that the filter reads a summed-area table if a `scan` other than the default is requested.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for a filter without such a table, and those of
    /// [`Scan::check`].
    pub fn check_scan(self, scan: Scan) -> Result<()> {
        if scan != Scan::default() && !self.reads_sat() {
            return wrong(format!(
                "`scan` {scan} is for the filter over a summed-area table; use `filter` box"
            ));
        }
        scan.check()
    }

    /// Checks that the filter supports `lobe`, and an OEM of `inner` texels if given.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for an adaptive error outside [1e-6, 1); for a pyramid of a
    /// lobe other than GGX, or over an OEM that is not a power of two from 32 to 2048.
    pub fn check(self, lobe: Lobe, inner: Option<u32>) -> Result<()> {
        match self {
            Self::Adaptive(error) if !(MIN_ERROR..1.0).contains(&error) => wrong(format!(
                "adaptive:{error} is outside [{MIN_ERROR:e}, 1): smaller errors are below float32 precision"
            )),
            Self::Box if lobe == Lobe::Charlie => {
                wrong("the box filter does not support Charlie; use `filter` adaptive:E")
            }
            Self::Pyramid if lobe != Lobe::Ggx => {
                wrong(format!("pyramid supports ggx only; for {} use adaptive:E", lobe.name()))
            }
            Self::Pyramid => inner.map_or(Ok(()), |inner| Levels::over(inner).map(|_| ())),
            _ => Ok(()),
        }
    }
}

/// Parses a filter's name with its number, as on the command line and in reports.
///
/// # Errors
/// A message that names the choices.
pub fn parsed(text: &str) -> Result<Filter, String> {
    let (name, value) = text.split_once(':').map_or((text, None), |(name, value)| (name, Some(value)));
    match (name, value) {
        ("adaptive", None) => Ok(Filter::Adaptive(0.005)),
        ("adaptive", Some(value)) => match value.parse() {
            Ok(error) if (MIN_ERROR..1.0).contains(&error) => Ok(Filter::Adaptive(error)),
            _ => Err(format!(
                "the error of adaptive:E must be at least {MIN_ERROR:e}, the float32 limit, and below 1"
            )),
        },
        ("pyramid", None) => Ok(Filter::Pyramid),
        ("box", None) => Ok(Filter::Box),
        ("reference", None) => Ok(Filter::Reference),
        ("fitted", _) => Err(FITTED.to_owned()),
        _ => Err("choose one of adaptive:E, pyramid, box, reference".to_owned()),
    }
}

/// What names of the filter before [`Filter::Pyramid`] are answered with.
pub const FITTED: &str = "fitted:K is no more; use pyramid";

impl std::ops::Add for Bound {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            channels: std::array::from_fn(|c| self.channels[c] + other.channels[c]),
            luminance: self.luminance + other.luminance,
        }
    }
}

/// The answer to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Radiance of the lobe.
    pub radiance: Rgb,
    /// Certified bounds of the errors against exhaustive integration over the source, constant over each
    /// texel's solid angle; `None` if the filter has none.
    ///
    /// Lobes of less than four texels of the octahedral map blend into bilinear interpolation of the map;
    /// there the bounds are against the same blend.
    pub bound: Option<Bound>,
}

/// Certified bounds of an answer's errors, in units of radiance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bound {
    /// Bounds of red, green and blue.
    pub channels: Rgb,
    /// Bound of the luminance.
    pub luminance: f32,
}

impl Bound {
    /// Bounds of answers without any, such as mirrors'.
    pub const NONE: Self = Self { channels: [f32::INFINITY; 3], luminance: f32::INFINITY };

    /// The bounds after `change` of each.
    #[must_use]
    pub fn map(self, change: impl Fn(f32) -> f32) -> Self {
        Self { channels: self.channels.map(&change), luminance: change(self.luminance) }
    }

    /// The greatest of both bounds of each.
    pub(crate) fn max(self, other: Self) -> Self {
        let [red, green, blue] = std::array::from_fn(|c| self.channels[c].max(other.channels[c]));
        Self { channels: [red, green, blue], luminance: self.luminance.max(other.luminance) }
    }

    /// The bounds of luminance, red, green and blue.
    #[must_use]
    pub const fn values(self) -> [f32; 4] {
        let [red, green, blue] = self.channels;
        [self.luminance, red, green, blue]
    }
}

impl Answer {
    /// First radiance or bound value that is NaN, infinite or negative.
    pub(crate) fn wrong_value(&self) -> Option<f32> {
        let bounds = self.bound.into_iter().flat_map(Bound::values);
        let mut values = self.radiance.into_iter().chain(bounds);
        values.find(|value| is_wrong(*value))
    }
}
