//! Reflection lobes: radially symmetric kernels K over the sphere, all functions of
//! s = sin^2(theta/2) = |l - R|^2 / 4, which float32 resolves near the peak where cos(theta) does not.

use std::f64::consts::PI;

/// A family of lobes; a roughness picks one of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
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
}

impl Lobe {
    /// Name on the command line and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ggx => "ggx",
            Self::Phong => "phong",
            Self::Cone => "cone",
            Self::Cosine => "cosine",
        }
    }
}

/// GGX's integral over the sphere in closed form: W = 2a^2/k^2 * (ln(a^2/b) + b/a^2 - 1), k = (a^2-1)/2,
/// b = (a^2+1)/2; W(1) = 1. `alpha` in (0, 1].
#[must_use]
pub fn ggx_integral(alpha: f64) -> f64 {
    let a2 = alpha * alpha;
    let b = (a2 + 1.0) / 2.0;
    // With t = b/a^2 - 1 = (1 - a^2)/(2 a^2), W = 2 a^2 / k^2 * (t - ln(1 + t)) and k = -a^2 t, so
    // W = 2/a^2 * (t - ln(1 + t)) / t^2: no cancellation but in t - ln(1 + t), which has a series near 0.
    let t = (1.0 - a2) / (2.0 * a2);
    let bracket = if t < 1e-2 {
        // (t - ln(1+t))/t^2 = 1/2 - t/3 + t^2/4 - ...; the first term left out is below 1e-2^8/10.
        (0..8).rev().fold(0.0, |sum, k| 1.0 / f64::from(k + 2) - t * sum)
    } else {
        (t - t.ln_1p()) / (t * t)
    };
    debug_assert!(b > 0.0, "a lobe has a width");
    2.0 / a2 * bracket
}

/// The exponent of the Phong lobe of `alpha` in (0, 1].
#[must_use]
pub fn phong_exponent(alpha: f64) -> f64 {
    2.0 / (alpha * alpha) - 2.0
}

/// Kernel value at `s` = sin^2(theta/2) for `alpha` in (0, 1]: the definition, in double precision.
#[must_use]
pub fn kernel(lobe: Lobe, alpha: f64, s: f64) -> f64 {
    let cos_theta = 1.0 - 2.0 * s;
    if lobe != Lobe::Cone && cos_theta <= 0.0 {
        return 0.0;
    }
    match lobe {
        Lobe::Ggx => {
            let a2 = alpha * alpha;
            let denominator = s + a2 * (1.0 - s);
            a2 / (PI * denominator * denominator) * cos_theta
        }
        Lobe::Phong => (phong_exponent(alpha) * (-2.0 * s).ln_1p()).exp(),
        Lobe::Cone => f64::from(u8::from(s <= cone_edge(alpha))),
        Lobe::Cosine => cos_theta,
    }
}

/// sin^2 of half the cone's half-angle, roughness * pi/2 with roughness = sqrt(alpha).
#[must_use]
pub fn cone_edge(alpha: f64) -> f64 {
    (alpha.sqrt() * PI / 4.0).sin().powi(2)
}

/// The kernel's integral over the sphere, in closed form, for `alpha` in (0, 1].
#[must_use]
pub fn kernel_integral(lobe: Lobe, alpha: f64) -> f64 {
    match lobe {
        Lobe::Ggx => ggx_integral(alpha),
        Lobe::Phong => 2.0 * PI / (phong_exponent(alpha) + 1.0),
        Lobe::Cone => 4.0 * PI * cone_edge(alpha),
        Lobe::Cosine => PI,
    }
}

/// What convolution with the lobe, whose integral is made 1, leaves of harmonics of order 0 to 4: 2 pi times the integral
/// over cos(theta) of the kernel times Legendre's polynomials. `alpha` in (0, 1]; exact to 1e-6 from 0.1 on.
#[must_use]
pub fn zonal_weights(lobe: Lobe, alpha: f64) -> [f64; 5] {
    // Midpoints in the logarithm of s + alpha^2, which GGX is flat in.
    const COUNT: u32 = 1024;
    let a2 = alpha * alpha;
    let step = ((0.5 + a2) / a2).ln() / f64::from(COUNT);
    let mut sums = [0.0; 5];
    for k in 0..COUNT {
        let shifted = a2 * ((f64::from(k) + 0.5) * step).exp();
        let weight = kernel(lobe, alpha, shifted - a2) * shifted;
        for (sum, value) in sums.iter_mut().zip(legendre(1.0 - 2.0 * (shifted - a2))) {
            *sum += weight * value;
        }
    }
    sums.map(|sum| sum / sums[0])
}

/// Legendre's polynomials of order 0 to 4 at `x`.
#[must_use]
pub fn legendre(x: f64) -> [f64; 5] {
    let x2 = x * x;
    [1.0, x, (3.0 * x2 - 1.0) / 2.0, (5.0 * x2 - 3.0) * x / 2.0, ((35.0 * x2 - 30.0) * x2 + 3.0) / 8.0]
}

/// Angle across the peak at half its value, in radians, for `alpha` in [0, 1]; 2.57 alpha for a narrow GGX.
#[must_use]
pub fn full_width_at_half_maximum(lobe: Lobe, alpha: f64) -> f64 {
    if alpha <= 0.0 && lobe != Lobe::Cosine {
        return 0.0;
    }
    let half = kernel(lobe, alpha, 0.0) / 2.0;
    // Bisection of a decreasing function in theta, from the horizon down.
    let (mut low, mut high) = (0.0_f64, PI / 2.0);
    for _ in 0..60 {
        let theta = (low + high) / 2.0;
        if kernel(lobe, alpha, (theta / 2.0).sin().powi(2)) > half {
            low = theta;
        } else {
            high = theta;
        }
    }
    2.0 * low
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
        for lobe in [Lobe::Ggx, Lobe::Phong, Lobe::Cone, Lobe::Cosine] {
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
