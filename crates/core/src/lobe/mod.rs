//! Reflection lobes: radially symmetric kernels K over the sphere, all functions of
//! s = sin^2(theta/2) = |l - R|^2 / 4, which float32 resolves near the peak where cos(theta) does not.

pub mod filter;
pub mod kernel;
pub mod ladder;
pub(crate) mod profiles;
pub(crate) mod radial;
pub(crate) mod reflectance;

use crate::common::names::named;
use std::f64::consts::PI;

/// A family of lobes; the roughness selects one member.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Lobe {
    /// GGX with N = V = R (the split sum): D(theta/2) * cos(theta), alpha = roughness^2.
    #[default]
    Ggx,
    /// cos^n theta, n = 2/alpha^2 - 2.
    Phong,
    /// Constant within a half-angle of roughness * pi/2.
    Cone,
    /// cos theta: irradiance over pi. Has no roughness.
    Cosine,
    /// Charlie, the sheen of Estevez and Kulla 2017, with N = V = R: D(theta/2) * cos(theta), D =
    /// sin^(1/alpha), a band towards the horizon. Khronos's sampler draws half vectors with density D cos,
    /// which makes directions with density D/4, and weights them by cos(theta) (lib/shaders/filter.frag):
    /// this kernel. Below `MIN_CHARLIE_ROUGHNESS` the kernel of that roughness applies.
    Charlie,
}

/// Every lobe.
pub const LOBES: [Lobe; 5] = Lobe::ALL;

/// The least roughness of a Charlie lobe, four degrees across: level 1 of nine. At 0 it would be the
/// horizon's circle, which no texel resolves. The sampler's level 0 is black: none of its half vectors has
/// light above the horizon.
pub(crate) const MIN_CHARLIE_ROUGHNESS: f64 = 0.125;

named!(Lobe { Ggx = "ggx", Phong = "phong", Cone = "cone", Cosine = "cosine", Charlie = "charlie" });

impl Lobe {
    /// Whether it narrows to a mirror at roughness 0.
    #[must_use]
    pub const fn has_mirror(self) -> bool {
        matches!(self, Self::Ggx | Self::Phong | Self::Cone)
    }

    /// The effective roughness for a requested `roughness`.
    #[must_use]
    pub const fn served_roughness(self, roughness: f64) -> f64 {
        match self {
            Self::Charlie => roughness.max(MIN_CHARLIE_ROUGHNESS),
            _ => roughness,
        }
    }
}

/// GGX's integral over the sphere in closed form: W = 2a^2/k^2 * (ln(a^2/b) + b/a^2 - 1), k = (a^2-1)/2,
/// b = (a^2+1)/2; W(1) = 1. `alpha` in (0, 1].
pub(crate) fn ggx_integral(alpha: f64) -> f64 {
    let a2 = alpha * alpha;
    // With t = b/a^2 - 1 = (1 - a^2)/(2 a^2), W = 2 a^2 / k^2 * (t - ln(1 + t)) and k = -a^2 t, so
    // W = 2/a^2 * (t - ln(1 + t)) / t^2. Only t - ln(1 + t) cancels; near 0 use its series.
    let t = (1.0 - a2) / (2.0 * a2);
    let bracket = if t < 1e-2 {
        // (t - ln(1+t))/t^2 = 1/2 - t/3 + t^2/4 - ...; the first omitted term is below 1e-2^8/10.
        (0..8).rev().fold(0.0, |sum, k| 1.0 / f64::from(k + 2) - t * sum)
    } else {
        (t - t.ln_1p()) / (t * t)
    };
    2.0 / a2 * bracket
}

/// The exponent of the Phong lobe of `alpha` in (0, 1].
pub(crate) fn phong_exponent(alpha: f64) -> f64 {
    2.0 / (alpha * alpha) - 2.0
}

/// p of the Charlie lobe s^p (1 - 2s) of `alpha` in [0, 1]: 1/(2 alpha), since its sine is that of half the
/// angle.
pub(crate) fn charlie_power(alpha: f64) -> f64 {
    0.5 / alpha.max(MIN_CHARLIE_ROUGHNESS * MIN_CHARLIE_ROUGHNESS)
}

/// Kernel value at `s` = sin^2(theta/2) for `alpha` in (0, 1], in double precision: the definition.
pub fn kernel(lobe: Lobe, alpha: f64, s: f64) -> f64 {
    let cos_theta = 1.0 - 2.0 * s;
    if lobe != Lobe::Cone && cos_theta <= 0.0 {
        return 0.0;
    }
    match lobe {
        Lobe::Ggx => ggx(alpha * alpha, s),
        Lobe::Phong => (phong_exponent(alpha) * (-2.0 * s).ln_1p()).exp(),
        Lobe::Cone => f64::from(u8::from(s <= cone_edge(alpha))),
        Lobe::Cosine => cos_theta,
        Lobe::Charlie => (2.0 * s).powf(charlie_power(alpha)) * cos_theta,
    }
}

/// GGX at `s` below 1/2, for `a2` the square of alpha.
pub(crate) fn ggx(a2: f64, s: f64) -> f64 {
    let denominator = s + a2 * (1.0 - s);
    a2 / (PI * denominator * denominator) * (1.0 - 2.0 * s)
}

/// sin^2 of half the cone's half-angle, roughness * pi/2 with roughness = sqrt(alpha).
pub(crate) fn cone_edge(alpha: f64) -> f64 {
    (alpha.sqrt() * PI / 4.0).sin().powi(2)
}

/// The kernel's integral over the sphere, in closed form, for `alpha` in (0, 1].
pub fn kernel_integral(lobe: Lobe, alpha: f64) -> f64 {
    match lobe {
        Lobe::Ggx => ggx_integral(alpha),
        Lobe::Phong => 2.0 * PI / (phong_exponent(alpha) + 1.0),
        Lobe::Cone => 4.0 * PI * cone_edge(alpha),
        Lobe::Cosine => PI,
        // 2 pi B(p + 1, 2).
        Lobe::Charlie => {
            let power = charlie_power(alpha);
            2.0 * PI / ((power + 1.0) * (power + 2.0))
        }
    }
}

/// Values of cos(theta) with weights proportional to the kernel there, for integrals over the lobe; `alpha`
/// in (0, 1].
pub(crate) fn zonal_nodes(lobe: Lobe, alpha: f64) -> impl Iterator<Item = (f64, f64)> {
    // Midpoints in the logarithm of s + alpha^2, in which GGX is flat.
    const COUNT: u32 = 1024;
    let a2 = alpha * alpha;
    let step = ((0.5 + a2) / a2).ln() / f64::from(COUNT);
    (0..COUNT).map(move |k| {
        let shifted = a2 * ((f64::from(k) + 0.5) * step).exp();
        (1.0 - 2.0 * (shifted - a2), kernel(lobe, alpha, shifted - a2) * shifted)
    })
}

/// Legendre's polynomials of order 0 to 4 at `x`.
pub fn legendre(x: f64) -> [f64; 5] {
    let x2 = x * x;
    [1.0, x, (3.0 * x2 - 1.0) / 2.0, (5.0 * x2 - 3.0) * x / 2.0, ((35.0 * x2 - 30.0) * x2 + 3.0) / 8.0]
}

/// Full width of the peak at half its value, in radians, for `alpha` in [0, 1]; 2.57 alpha for a narrow GGX.
/// For a Charlie lobe, whose peak is a band, the width of the band.
pub(crate) fn full_width_at_half_maximum(lobe: Lobe, alpha: f64) -> f64 {
    if alpha <= 0.0 && lobe.has_mirror() {
        return 0.0;
    }
    // s of the peak.
    let peak = match lobe {
        Lobe::Charlie => {
            let power = charlie_power(alpha);
            power / (power + 1.0) / 2.0
        }
        _ => 0.0,
    };
    let half = kernel(lobe, alpha, peak) / 2.0;
    // Bisection in theta, away from the peak on either side.
    let end = |far: f64| {
        let (mut inside, mut outside) = (2.0 * peak.sqrt().asin(), far);
        for _ in 0..60 {
            let theta = f64::midpoint(inside, outside);
            if kernel(lobe, alpha, (theta / 2.0).sin().powi(2)) > half {
                inside = theta;
            } else {
                outside = theta;
            }
        }
        inside
    };
    if lobe == Lobe::Charlie { end(PI / 2.0) - end(0.0) } else { 2.0 * end(PI / 2.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_are_the_published_ones_and_match_quadrature() {
        for (roughness, value) in
            [(0.05, 3.999_461), (0.3, 3.760_598), (0.5, 3.049_207), (0.75, 1.883_731), (1.0, 1.0)]
        {
            let alpha: f64 = roughness * roughness;
            assert!((ggx_integral(alpha) - value).abs() < 5e-7, "W({roughness}) = {}", ggx_integral(alpha));
        }
        for lobe in LOBES {
            for roughness in [0.2, 0.5, 0.8, 0.995, 1.0] {
                let alpha: f64 = roughness * roughness;
                // d(omega) = 4 pi ds; midpoints in ln(s + tiny) resolve the peak.
                let (low, high, count) = (1e-9_f64.ln(), 1.0_f64.ln(), 400_000);
                let step = (high - low) / f64::from(count);
                let sum: f64 = (0..count)
                    .map(|k| {
                        let s = (low + (f64::from(k) + 0.5) * step).exp();
                        kernel(lobe, alpha, s) * s * step * 4.0 * PI
                    })
                    .sum::<f64>()
                    + kernel(lobe, alpha, 0.0) * 4.0 * PI * 1e-9;
                let exact = kernel_integral(lobe, alpha);
                assert!((sum / exact - 1.0).abs() < 1e-4, "{lobe:?} {roughness}: {sum} against {exact}");
            }
        }
    }
}
