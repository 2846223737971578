//! Windows for spherical harmonics: attenuate high bands to reduce the ringing of bright sources.

use crate::common::error::{Result, wrong};
use crate::light::sh::scale::{ShScale, scaled};
use crate::light::sh::{MAX_COUNT, band, basis};
use glam::DVec3;
use std::f64::consts::PI;
use std::fmt;

/// The factor of each band. W > 0 is the width in bands; bands from W up vanish.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ShWindow {
    /// No window.
    #[default]
    None,
    /// (1 + cos(pi l/W))/2 (Sloan 2008, "Stupid Spherical Harmonics Tricks").
    Hanning(f64),
    /// sinc(pi l/W) (Sloan 2008).
    Lanczos(f64),
    /// sinc(pi l/W)^4, cmgen's (libs/ibl/src/CubemapSH.cpp, `sincWindow`).
    Sinc4(f64),
    /// [`ShWindow::Sinc4`] with the largest W for which irradiance is nowhere negative in any channel; no
    /// window if it is nonnegative already. cmgen's `--sh-window=auto` searches the same W up to 13, in steps
    /// of 0.1.
    Nonnegative,
}

impl ShWindow {
    /// Checks the width.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] if it is not finite and above 0.
    pub(crate) fn check(self) -> Result<()> {
        match self {
            Self::Hanning(width) | Self::Lanczos(width) | Self::Sinc4(width)
                if !(width.is_finite() && width > 0.0) =>
            {
                wrong(format!("`sh_window` of width {width}; it must be finite and above 0"))
            }
            _ => Ok(()),
        }
    }

    /// The factor of band `l`, of a window of known width.
    fn factor(self, l: usize) -> f64 {
        let (width, window): (f64, fn(f64) -> f64) = match self {
            Self::None => return 1.0,
            Self::Hanning(width) => (width, |x| (1.0 + x.cos()) / 2.0),
            Self::Lanczos(width) => (width, |x| x.sin() / x),
            Self::Sinc4(width) => (width, |x| (x.sin() / x).powi(4)),
            Self::Nonnegative => unreachable!("`settled` replaces it"),
        };
        let l = l as f64;
        match l {
            0.0 => 1.0,
            _ if l >= width => 0.0,
            _ => window(PI * l / width),
        }
    }

    /// Multiplies `coefficients` of radiance by the window.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] if its width is not finite and above 0.
    pub fn apply(self, coefficients: &[[f64; 3]]) -> Result<Vec<[f64; 3]>> {
        self.check()?;
        Ok(self.settled(coefficients).applied(coefficients))
    }

    /// Multiplies `coefficients` by the window, which must have been settled.
    pub(crate) fn applied(self, coefficients: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let windowed = |(index, rgb): (usize, &[f64; 3])| rgb.map(|value| value * self.factor(band(index)));
        coefficients.iter().enumerate().map(windowed).collect()
    }

    /// Replaces [`ShWindow::Nonnegative`] by the window whose width the `coefficients` of radiance require.
    #[must_use]
    pub(crate) fn settled(self, coefficients: &[[f64; 3]]) -> Self {
        let holds =
            |window: Self| least_irradiance(&window.applied(coefficients)).iter().all(|least| *least >= 0.0);
        if self != Self::Nonnegative {
            return self;
        }
        if holds(Self::None) {
            return Self::None;
        }
        // A width of one band keeps only the mean, which is non-negative.
        let (mut narrow, mut wide) = (1.0, 64.0);
        for _ in 0..40 {
            let middle: f64 = f64::midpoint(narrow, wide);
            if holds(Self::Sinc4(middle)) {
                narrow = middle;
            } else {
                wide = middle;
            }
        }
        Self::Sinc4(narrow)
    }
}

impl fmt::Display for ShWindow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("none"),
            Self::Hanning(width) => write!(f, "hanning:{width}"),
            Self::Lanczos(width) => write!(f, "lanczos:{width}"),
            Self::Sinc4(width) => write!(f, "sinc4:{width}"),
            Self::Nonnegative => f.write_str("nonnegative"),
        }
    }
}

/// Parses a window's name with its width, as on the command line and in reports.
///
/// # Errors
/// A message that names the choices.
pub fn parsed(text: &str) -> Result<ShWindow, String> {
    let width = |text: &str| match text.parse() {
        Err(_) => Err("not a number".to_owned()),
        Ok(width) if width > 0.0 && f64::is_finite(width) => Ok(width),
        _ => Err("the width of a window must be above 0 and finite".to_owned()),
    };
    match text.split_once(':') {
        None if text == "none" => Ok(ShWindow::None),
        None if text == "nonnegative" => Ok(ShWindow::Nonnegative),
        Some(("hanning", value)) => width(value).map(ShWindow::Hanning),
        Some(("lanczos", value)) => width(value).map(ShWindow::Lanczos),
        Some(("sinc4", value)) => width(value).map(ShWindow::Sinc4),
        _ => Err("choose one of none, hanning:W, lanczos:W, sinc4:W, nonnegative".to_owned()),
    }
}

/// Number of candidate directions; the search starts at the lowest few. They are 4 degrees apart; minima of a
/// function of band 4 are 45 degrees apart.
const STARTS: u32 = 2000;

/// Minimum irradiance over all normals, per channel, from coefficients of radiance.
pub(crate) fn least_irradiance(coefficients: &[[f64; 3]]) -> [f64; 3] {
    let irradiance = scaled(coefficients, ShScale::Irradiance);
    std::array::from_fn(|c| {
        let value = |direction: DVec3| {
            let functions: [f64; MAX_COUNT] = basis(direction);
            irradiance.iter().zip(functions).map(|(rgb, function)| rgb[c] * function).sum::<f64>()
        };
        // A spiral of equal areas.
        let spiral = (0..STARTS).map(|k| {
            let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(STARTS);
            let (sin, cos) = (f64::from(k) * PI * (3.0 - 5.0_f64.sqrt())).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            DVec3::new(radius * cos, radius * sin, z)
        });
        let mut starts: Vec<(f64, DVec3)> = spiral.map(|direction| (value(direction), direction)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        starts.truncate(8);
        starts.into_iter().map(|start| descended(start, &value)).fold(f64::INFINITY, f64::min)
    })
}

/// Descends from a start point with halving steps.
fn descended((mut least, mut place): (f64, DVec3), value: &impl Fn(DVec3) -> f64) -> f64 {
    let mut step = 0.05;
    while step > 1e-8 {
        let (across, along) = place.any_orthonormal_pair();
        let around = [across, -across, along, -along].map(|way| (place + way * step).normalize());
        let best = around.into_iter().map(|place| (value(place), place)).min_by(|a, b| a.0.total_cmp(&b.0));
        match best {
            Some(best) if best.0 < least => (least, place) = best,
            _ => step /= 2.0,
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::environment::{Environment, Layout};
    use crate::light::sh::{count, spherical_harmonics};

    /// Coefficients of a sky of 1 with one texel of `sun`.
    fn sky_with(sun: f32, order: u32) -> Vec<[f64; 3]> {
        let layout = Layout::Cube { size: 16 };
        let mut texels = vec![[1.0; 3]; layout.texel_count()];
        texels[2 * 256 + 5 * 16 + 9] = [sun, 0.5 * sun, 1.0];
        let environment = Environment::new(layout, texels).expect("valid");
        spherical_harmonics(&environment, order).expect("an order")
    }

    /// The least value on a grid of a degree, of radiance or of irradiance.
    fn least_on_a_grid(coefficients: &[[f64; 3]]) -> f64 {
        let mut least = f64::INFINITY;
        for j in 0..=180 {
            let (radius, z) = f64::from(j).to_radians().sin_cos();
            for i in 0..360 {
                let (sin, cos) = f64::from(i).to_radians().sin_cos();
                let functions = basis(DVec3::new(radius * cos, radius * sin, z));
                for c in 0..3 {
                    let sum: f64 = coefficients.iter().zip(functions).map(|(rgb, f)| rgb[c] * f).sum();
                    least = least.min(sum);
                }
            }
        }
        least
    }

    #[test]
    fn windows_take_the_negative_lobes_of_a_small_sun() {
        for order in 2..=4 {
            let sun = sky_with(1e6, order);
            let mean = sun[0][1] / (4.0 * PI).sqrt();
            assert!(least_on_a_grid(&sun) < -0.2 * mean, "order {order}: radiance rings");
            let irradiance = |sh: &[[f64; 3]]| least_on_a_grid(&scaled(sh, ShScale::Irradiance));
            assert!(irradiance(&sun) < -0.1 * mean, "order {order}: and so does irradiance");
            let width = f64::from(order) + 1.0;
            for (window, share) in [(ShWindow::Hanning(width), 0.25), (ShWindow::Lanczos(width), 0.5)] {
                let left = least_on_a_grid(&window.applied(&sun));
                assert!(left > share * least_on_a_grid(&sun), "order {order}: {window} leaves {left}");
            }
            let window = ShWindow::Nonnegative.settled(&sun);
            let ShWindow::Sinc4(width) = window else { panic!("{window}") };
            let least = irradiance(&window.applied(&sun));
            assert!(
                (0.0..0.01 * mean).contains(&(least + 1e-9 * mean)),
                "order {order}: {window} leaves {least}"
            );
            let wider = ShWindow::Sinc4(1.01 * width).applied(&sun);
            assert!(irradiance(&wider) < 0.0, "order {order}: no wider one will do");
            assert_eq!(window.applied(&sun)[0], sun[0], "the mean stays");
        }
        let even = sky_with(2.0, 4);
        assert_eq!(ShWindow::Nonnegative.settled(&even), ShWindow::None);
    }

    #[test]
    fn the_least_irradiance_is_that_of_a_grid() {
        for order in 2..=4 {
            let sun = sky_with(1e5, order);
            let least = least_irradiance(&sun).into_iter().fold(f64::INFINITY, f64::min);
            let grid = least_on_a_grid(&scaled(&sun, ShScale::Irradiance));
            assert!(least <= grid && grid - least < 1e-3 * sun[0][0], "order {order}: {least} {grid}");
        }
    }

    #[test]
    fn factors_fall_from_one_to_nothing() {
        for window in [ShWindow::Hanning(3.5), ShWindow::Lanczos(3.5), ShWindow::Sinc4(3.5)] {
            let factors: Vec<f64> = (0..=4).map(|l| window.factor(l)).collect();
            assert!(factors[0] == 1.0 && factors[4] == 0.0, "{window}: {factors:?}");
            assert!(factors.windows(2).all(|pair| pair[0] > pair[1]), "{window}: {factors:?}");
        }
        let sun = sky_with(1e4, 4);
        assert_eq!((ShWindow::None.applied(&sun), sun.len()), (sun.clone(), count(4)));
    }
}
