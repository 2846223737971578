//! Lobes in the engines' form: float32 kernels of s = |l - R|^2/4.

use super::profiles::{Charlie, Cone, Cosine, Ggx, Phong, WidePhong};
use crate::lobe::{self, Lobe};
use std::f64::consts::PI;

/// A lobe at one roughness.
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    pub(crate) shape: KernelShape,
    /// Integral over the sphere, in closed form.
    pub(crate) integral: f64,
    /// GGX's alpha or its equivalent: the distance over which the kernel changes.
    width: f64,
    /// A leaf's share of the tolerance, relative to lobes with a peak.
    leaf_share: f64,
}

/// k(s) of each lobe, scaled as in [`lobe::kernel`].
#[derive(Clone, Copy, Debug)]
pub(crate) enum KernelShape {
    Ggx(Ggx),
    Phong(Phong),
    WidePhong(WidePhong),
    Cone(Cone),
    Cosine(Cosine),
    Charlie(Charlie),
}

/// Shape numbers in `shaders/common/kernel.wgsl`.
pub mod shape {
    pub(crate) const GGX: u32 = 0;
    pub(crate) const PHONG: u32 = 1;
    pub(crate) const WIDE_PHONG: u32 = 2;
    pub(crate) const CONE: u32 = 3;
    pub(crate) const COSINE: u32 = 4;
    /// Not a number there: Charlie has a pipeline of its own.
    pub const CHARLIE: u32 = 5;
}

/// Evaluates `$body` with `$radial` bound to the kernel that `$shape` holds.
macro_rules! with_radial {
    ($shape:expr, $radial:ident => $body:expr) => {
        match $shape {
            $crate::lobe::kernel::KernelShape::Ggx($radial) => $body,
            $crate::lobe::kernel::KernelShape::Phong($radial) => $body,
            $crate::lobe::kernel::KernelShape::WidePhong($radial) => $body,
            $crate::lobe::kernel::KernelShape::Cone($radial) => $body,
            $crate::lobe::kernel::KernelShape::Cosine($radial) => $body,
            $crate::lobe::kernel::KernelShape::Charlie($radial) => $body,
        }
    };
}
pub(crate) use with_radial;

impl Kernel {
    /// `lobe` at `alpha` in (0, 1].
    pub fn new(lobe: Lobe, alpha: f64) -> Self {
        let shape = match lobe {
            Lobe::Ggx => {
                let squared = alpha * alpha;
                KernelShape::Ggx(Ggx {
                    peak: (1.0 / (PI * squared)) as f32,
                    steep: ((1.0 - squared) / squared) as f32,
                })
            }
            Lobe::Phong => {
                let exponent = lobe::phong_exponent(alpha) as f32;
                if exponent >= 2.0 {
                    KernelShape::Phong(Phong { exponent })
                } else {
                    KernelShape::WidePhong(WidePhong { exponent })
                }
            }
            Lobe::Cone => KernelShape::Cone(Cone { edge: lobe::cone_edge(alpha) as f32 }),
            Lobe::Cosine => KernelShape::Cosine(Cosine),
            Lobe::Charlie => KernelShape::Charlie(Charlie::new(lobe::charlie_power(alpha) as f32)),
        };
        let width = match lobe {
            Lobe::Cosine => 1.0,
            // The power multiplies every relative error of s: those of its terms and of the logarithm.
            Lobe::Charlie => 1.0 / (12.0 * lobe::charlie_power(alpha)),
            _ => alpha,
        };
        let leaf_share = match lobe {
            // The narrower the band, the more leaves it takes, and all their errors have the same sign.
            // Measured: roughness 0 is as far off as requested, in the worst channel of a photograph with a
            // sun.
            Lobe::Charlie => (4.0 / (1.0 + lobe::charlie_power(alpha))).sqrt().min(1.0),
            _ => 1.0,
        };
        Self { shape, integral: lobe::kernel_integral(lobe, alpha), width, leaf_share }
    }

    /// Acceptable error of a leaf for a relRMSE of `error`, in units of the kernel, divided by the mean
    /// radiance.
    pub fn tolerance_per_mean(&self, error: f64) -> f64 {
        leaf_share(error) * self.leaf_share * self.integral
    }

    /// The kernel's integral over the sphere.
    pub const fn integral(&self) -> f64 {
        self.integral
    }

    /// The distance over which the kernel changes: alpha, or 1 for the cosine.
    pub const fn width(&self) -> f64 {
        self.width
    }

    /// Number and parameters of the shape in `shaders/common/kernel.wgsl`.
    pub fn parameters(&self) -> (u32, [f32; 4]) {
        match self.shape {
            KernelShape::Ggx(Ggx { peak, steep }) => (shape::GGX, [peak, steep, 0.0, 0.0]),
            KernelShape::Phong(Phong { exponent }) => (shape::PHONG, [exponent, 0.0, 0.0, 0.0]),
            KernelShape::WidePhong(WidePhong { exponent }) => (shape::WIDE_PHONG, [exponent, 0.0, 0.0, 0.0]),
            KernelShape::Cone(Cone { edge }) => (shape::CONE, [edge, 0.0, 0.0, 0.0]),
            KernelShape::Cosine(Cosine) => (shape::COSINE, [0.0; 4]),
            KernelShape::Charlie(Charlie { power, crest, turn, turning }) => {
                (shape::CHARLIE, [power, crest, turn, turning])
            }
        }
    }

    /// The greatest value that single precision flushes to 0: the tails of Phong lobes underflow.
    pub const fn underflow(&self) -> f32 {
        match self.shape {
            KernelShape::Phong(_) | KernelShape::WidePhong(_) => f32::MIN_POSITIVE,
            KernelShape::Ggx(_) | KernelShape::Cone(_) | KernelShape::Cosine(_) | KernelShape::Charlie(_) => {
                0.0
            }
        }
    }

    /// Greatest |dk/ds| from s = 1/4 to the horizon, for lobes that are smooth there: the effect of an error
    /// of s where k is near 0. Other lobes take the extremes over a leaf.
    pub(crate) fn grazing_slope(&self) -> f64 {
        match self.shape {
            // Convex, so steepest at 1/4: k = (1 - 2 s) g, and g' = -2 steep w g.
            KernelShape::Ggx(Ggx { peak, steep }) => {
                let (peak, steep) = (f64::from(peak), f64::from(steep));
                let w = 1.0 / (1.0 + 0.25 * steep);
                peak * w * w * (2.0 + steep * w)
            }
            KernelShape::Phong(Phong { exponent }) => {
                let n = f64::from(exponent);
                2.0 * n * 0.5_f64.powf(n - 1.0)
            }
            // Charlie's two terms have opposite signs, and neither is above 2.
            KernelShape::Cosine(_) | KernelShape::Charlie(_) => 2.0,
            KernelShape::WidePhong(_) | KernelShape::Cone(_) => 0.0,
        }
    }

    /// Relative rounding error of a sum over `leaves`, without the term of [`Self::grazing_slope`].
    ///
    /// Float32 centroids have an error of 2^-24, and k changes by at most 1/width of itself per unit of
    /// distance (GGX: |dk/d(distance)|/k <= distance/(s + alpha^2) <= 1/alpha). A share takes fewer than 32
    /// roundings and the sum one per leaf, each 2^-24.
    pub(crate) fn rounding(&self, leaves: usize) -> f64 {
        (2.0 / self.width + 32.0 + leaves as f64) / f64::from(1_u32 << 24)
    }
}

/// The acceptable error of a leaf, as a share of the mean radiance, for a relRMSE of `error` over the sphere.
///
/// Measured, see the table of errors in docs/benchmarks.md: the leaves' errors have random signs and mostly
/// lie far inside their intervals, farther with more leaves. With this share the error of the worst channel
/// stays below the request from roughness 0.29 up.
pub fn leaf_share(error: f64) -> f64 {
    0.66 * error * (error / 0.005).sqrt().min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grazing_slopes_are_the_greatest_of_their_lobes() {
        for (lobe, roughness) in
            [(Lobe::Ggx, 0.3), (Lobe::Ggx, 0.6), (Lobe::Ggx, 1.0), (Lobe::Phong, 0.3), (Lobe::Phong, 0.7)]
        {
            let alpha: f64 = roughness * roughness;
            let k = |s: f64| lobe::kernel(lobe, alpha, s);
            let slope =
                |step: u32| (k(0.25 + 1e-5 * f64::from(step)) - k(0.25 + 1e-5 * f64::from(step + 1))) * 1e5;
            let greatest = (0..25_000).map(slope).fold(0.0, f64::max);
            let stated = Kernel::new(lobe, alpha).grazing_slope();
            assert!((greatest / stated - 1.0).abs() < 0.01, "{lobe:?} {roughness}: {greatest}, not {stated}");
        }
    }
}
