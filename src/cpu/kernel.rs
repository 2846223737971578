//! Lobes as the engine evaluates them: float32, bounds beside values.

use crate::lobe::{self, Lobe};
use std::f64::consts::PI;

/// A lobe at one roughness.
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    shape: Shape,
    /// Integral over the sphere, closed form.
    pub(super) integral: f64,
    /// GGX's alpha or the like: the angle on which the kernel changes.
    width: f64,
}

/// k(s) of each lobe, scaled as in [`lobe::kernel`].
#[derive(Clone, Copy, Debug)]
enum Shape {
    /// peak (1 - 2 s) w^2, w = 1/(1 + steep s), peak = 1/(pi alpha^2), steep = (1 - alpha^2)/alpha^2.
    Ggx { peak: f32, steep: f32 },
    /// (1 - 2 s)^n.
    Phong { exponent: f32 },
    /// 1 up to the edge.
    Cone { edge: f32 },
    /// 1 - 2 s.
    Cosine,
}

impl Kernel {
    /// `lobe` at `alpha` in (0, 1].
    #[must_use]
    pub fn new(lobe: Lobe, alpha: f64) -> Self {
        let shape = match lobe {
            Lobe::Ggx => {
                let squared = alpha * alpha;
                Shape::Ggx { peak: (1.0 / (PI * squared)) as f32, steep: ((1.0 - squared) / squared) as f32 }
            }
            Lobe::Phong => Shape::Phong { exponent: lobe::phong_exponent(alpha) as f32 },
            Lobe::Cone => Shape::Cone { edge: lobe::cone_edge(alpha) as f32 },
            Lobe::Cosine => Shape::Cosine,
        };
        let width = if lobe == Lobe::Cosine { 1.0 } else { alpha };
        Self { shape, integral: lobe::kernel_integral(lobe, alpha), width }
    }

    /// Lower end of a cell's interval and the second-order term above it, at mean `s` and spread, an energy of 1.
    #[inline(always)]
    pub(super) fn share(&self, s: f32, spread: f32) -> (f32, f32) {
        let cosine = (1.0 - 2.0 * s).max(0.0);
        match self.shape {
            Shape::Ggx { peak, steep } => {
                let w = 1.0 / (1.0 + steep * s);
                let steep_w = steep * w;
                let peak_w2 = peak * w * w;
                let value = peak_w2 * cosine;
                // q/4 s (1 - s) k''; more than the value itself is no second-order term any more.
                let curvature = peak_w2 * steep_w * (8.0 + 6.0 * steep_w * cosine);
                (value, (0.25 * spread * s * (1.0 - s) * curvature).min(value))
            }
            Shape::Phong { exponent } => {
                let value = cosine.powf(exponent);
                if exponent < 2.0 || cosine <= 0.0 {
                    return (value, 0.0);
                }
                let curvature = 4.0 * exponent * (exponent - 1.0) * value / (cosine * cosine);
                (value, (0.25 * spread * s * (1.0 - s) * curvature).min(value))
            }
            Shape::Cone { edge } => (if s <= edge { 1.0 } else { 0.0 }, 0.0),
            Shape::Cosine => (cosine, 0.0),
        }
    }

    /// Width of the interval of a cell at `distance` from a packet's axis, for the worst of its directions, an energy
    /// of 1. See [`super::adaptive`] for the derivation.
    #[inline(always)]
    pub(super) fn gap(&self, distance: f32, radius: f32, packet: f32, spread: f32) -> f32 {
        let near = (distance - radius - packet).max(0.0);
        let low = 0.25 * near * near;
        let far = distance + packet;
        let high = 0.25 * (far + radius) * (far + radius);
        let cosine = (1.0 - 2.0 * low).max(0.0);
        // The chord is at least the sine; the centroid lies up to half its spread inside the sphere.
        let sine = (far + 0.5 * spread).min(1.0);
        let deviation = 0.5 * spread.sqrt() * (sine + 0.5 * radius);
        match self.shape {
            Shape::Ggx { peak, steep } => {
                let w = 1.0 / (1.0 + steep * low);
                let peak_w2 = peak * w * w;
                let ratio = steep * w * deviation;
                let curved = peak_w2 * (4.0 * ratio * deviation + 3.0 * cosine * ratio * ratio);
                let w_horizon = 1.0 / (1.0 + 0.5 * steep);
                let kink = if high > 0.5 { peak * w_horizon * w_horizon * deviation } else { 0.0 };
                let curved = if low < 0.5 { curved } else { 0.0 };
                (curved + kink).min(peak_w2 * cosine)
            }
            Shape::Phong { exponent } => {
                let most = cosine.powf(exponent);
                if exponent < 2.0 {
                    return most - (1.0 - 2.0 * high).max(0.0).powf(exponent);
                }
                let curvature = 4.0 * exponent * (exponent - 1.0) * cosine.powf(exponent - 2.0);
                (0.5 * curvature * deviation * deviation).min(most)
            }
            Shape::Cone { edge } => {
                if low <= edge && high >= edge {
                    1.0
                } else {
                    0.0
                }
            }
            Shape::Cosine => {
                if high > 0.5 {
                    deviation.min(cosine)
                } else {
                    0.0
                }
            }
        }
    }

    /// Width of the first-order interval k(nearest) - k(farthest), for cells whose centroid is not known exactly.
    pub(super) fn first_order_gap(&self, distance: f32, radius: f32, packet: f32) -> f32 {
        let near = (distance - radius - packet).max(0.0);
        let far = distance + radius + packet;
        self.share(0.25 * near * near, 0.0).0 - self.share((0.25 * far * far).min(1.0), 0.0).0
    }

    /// Relative rounding error of a sum over `leaves`.
    ///
    /// Float32 centroids are off by 2^-24, and k changes by at most 1/width of itself for a unit of distance (GGX:
    /// |dk/d(distance)|/k <= distance/(s + alpha^2) <= 1/alpha); a share takes fewer than 16 roundings and the sum
    /// one a leaf, each 2^-24, of which all but a few standard deviations cancel.
    pub(super) fn rounding(&self, leaves: usize) -> f64 {
        let unit = 1.0 / f64::from(1_u32 << 24);
        unit * (2.0 / self.width + 16.0 + leaves as f64)
    }
}
