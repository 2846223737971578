//! A lobe around one direction, in the oracle's own formulas.

use crate::lobe::{Lobe, MIN_CHARLIE_ROUGHNESS};
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, SQRT_2};

/// The lobe's profile.
#[derive(Clone, Copy, Debug)]
pub enum Profile {
    /// GGX of this alpha^2.
    Ggx(f64),
    /// This power of the cosine.
    Phong(f64),
    /// Constant up to the angle of this cosine.
    Cone(f64),
    /// The cosine.
    Cosine,
    /// This power of the versine, times the cosine.
    Charlie(f64),
}

/// Where a cap lies with respect to the boundary of a lobe's support.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The kernel vanishes on the whole cap.
    Outside,
    /// The boundary may run through the cap.
    Across,
    /// The kernel is smooth on the whole cap.
    Inside,
}

/// Minus the logarithm of the share of the peak below which a lobe counts as nothing, 1e-30, and below which
/// a Phong's integrals need not be as exact in relation to themselves, 1e-8.
const NOTHING: f64 = 69.0;
const FAINT: f64 = 18.4;

/// The kernel of one query.
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    /// Its axis.
    pub direction: DVec3,
    /// Its profile.
    pub profile: Profile,
    /// Chord of the support's half-angle.
    pub support: f64,
    /// Chord beyond which there is nothing: the support's, or less where the kernel has fallen to nothing.
    pub vanishes: f64,
}

impl Kernel {
    /// `roughness` in (0, 1], `direction` of unit length.
    pub fn new(lobe: Lobe, roughness: f64, direction: DVec3) -> Self {
        let alpha_squared = roughness.powi(4);
        let half_angle = if lobe == Lobe::Cone { roughness * FRAC_PI_2 } else { FRAC_PI_2 };
        let profile = match lobe {
            Lobe::Ggx => Profile::Ggx(alpha_squared),
            // At roughness 1 the exponent is 0 and the lobe a hemisphere.
            Lobe::Phong if roughness == 1.0 => Profile::Cone(0.0),
            Lobe::Phong => Profile::Phong(2.0 / alpha_squared - 2.0),
            Lobe::Cone => Profile::Cone(half_angle.cos()),
            Lobe::Cosine => Profile::Cosine,
            Lobe::Charlie => Profile::Charlie(1.0 / (2.0 * roughness.max(MIN_CHARLIE_ROUGHNESS).powi(2))),
        };
        let support = match profile {
            Profile::Cone(_) => 2.0 * (half_angle / 2.0).sin(),
            Profile::Ggx(_) | Profile::Phong(_) | Profile::Cosine | Profile::Charlie(_) => SQRT_2,
        };
        let vanishes = match profile {
            Profile::Phong(exponent) => (-2.0 * (-NOTHING / exponent).exp_m1()).sqrt().min(support),
            _ => support,
        };
        Self { direction, profile, support, vanishes }
    }

    /// The same profile around another direction.
    #[must_use]
    pub const fn around(self, direction: DVec3) -> Self {
        Self { direction, ..self }
    }

    /// Whether the support ends at a great circle.
    pub fn is_hemisphere(&self) -> bool {
        match self.profile {
            Profile::Cone(cosine) => cosine < 1e-15,
            _ => true,
        }
    }

    /// Signed distance of `point` (any length) from the boundary of the support, positive inside, in units of
    /// the point's length times a slope: linear in `point` where the boundary is a great circle.
    pub fn depth(&self, point: DVec3) -> f64 {
        let along = self.direction.dot(point);
        match self.profile {
            Profile::Cone(cosine) => along - cosine * point.length(),
            _ => along,
        }
    }

    /// Where the cap of chord `radius` around the unit vector `centre` lies.
    pub fn side(&self, centre: DVec3, radius: f64) -> Side {
        let distance = centre.distance(self.direction);
        if distance - radius >= self.vanishes {
            Side::Outside
        } else if distance + radius <= self.support {
            Side::Inside
        } else {
            Side::Across
        }
    }

    /// The kernel at `point` of squared length `length_squared`.
    pub fn at(&self, point: DVec3, length_squared: f64) -> f64 {
        let cosine = self.direction.dot(point) / length_squared.sqrt();
        if let Profile::Cone(edge) = self.profile {
            return f64::from(u8::from(cosine >= edge));
        }
        if cosine <= 0.0 {
            return 0.0;
        }
        // sin^2(theta/2) = sin^2(theta) / (2 + 2 cos(theta)): exact to rounding at the peak.
        let half = self.direction.cross(point).length_squared() / (2.0 * length_squared * (1.0 + cosine));
        match self.profile {
            Profile::Ggx(alpha_squared) => {
                let spread = alpha_squared + (1.0 - alpha_squared) * half;
                FRAC_1_PI * alpha_squared * cosine / (spread * spread)
            }
            Profile::Phong(exponent) if half < 0.25 => (exponent * (-2.0 * half).ln_1p()).exp(),
            Profile::Phong(exponent) => cosine.powf(exponent),
            Profile::Charlie(power) => (2.0 * half).powf(power) * cosine,
            Profile::Cosine | Profile::Cone(_) => cosine,
        }
    }

    /// The kernel as a function of the cosine, and its second derivative; inside the support.
    pub fn curve(&self, cosine: f64) -> (f64, f64) {
        match self.profile {
            Profile::Ggx(alpha_squared) => {
                let slope = (1.0 - alpha_squared) / 2.0;
                let inverse = 1.0 / (alpha_squared + slope * (1.0 - cosine));
                let scale = FRAC_1_PI * alpha_squared * inverse * inverse;
                (scale * cosine, scale * slope * inverse * (4.0 + 6.0 * slope * cosine * inverse))
            }
            Profile::Phong(exponent) => {
                let value = cosine.powf(exponent);
                (value, exponent * (exponent - 1.0) * value / (cosine * cosine))
            }
            Profile::Cone(_) => (1.0, 0.0),
            Profile::Cosine => (cosine, 0.0),
            Profile::Charlie(power) => {
                let versine = 1.0 - cosine;
                let rise = versine.powf(power);
                let bend = power * rise / versine * ((power - 1.0) * cosine / versine - 2.0);
                (rise * cosine, bend)
            }
        }
    }

    /// The kernel's mean over a texel across the edge of the support, as if cosines were spread evenly over
    /// `cosine` +- `half_width`; and how far off that may be.
    pub fn mean_at_edge(&self, cosine: f64, half_width: f64) -> (f64, f64) {
        if let Profile::Cone(edge) = self.profile {
            return (((cosine - edge) / half_width / 2.0 + 0.5).clamp(0.0, 1.0), 0.3);
        }
        let inside = (cosine + half_width).clamp(0.0, 2.0 * half_width);
        let mean = if cosine > half_width { cosine } else { inside * inside / (4.0 * half_width) };
        match self.profile {
            Profile::Phong(exponent) => (mean.powf(exponent), (2.0 * half_width).powf(exponent)),
            Profile::Ggx(alpha_squared) => {
                let slope = 4.0 * FRAC_1_PI * alpha_squared / ((1.0 + alpha_squared) * (1.0 + alpha_squared));
                (slope * mean, slope * half_width / 8.0)
            }
            Profile::Charlie(power) => {
                let rise = (1.0 - mean).powf(power);
                (rise * mean, half_width / 8.0 + power * half_width * half_width)
            }
            Profile::Cosine | Profile::Cone(_) => (mean, half_width / 8.0),
        }
    }

    /// How far the kernel is from its nearest complex pole, seen from a chord `distance` off its axis: the
    /// length over which quadrature must resolve it. At most 1, where the maps of the sphere have theirs.
    pub fn reach(&self, distance: f64) -> f64 {
        match self.profile {
            Profile::Ggx(alpha_squared) => (distance * distance + 4.0 * alpha_squared).sqrt().min(1.0),
            // An entire function: the length over which it changes by a factor e^3.
            Profile::Phong(exponent) => {
                let felt = distance.min((2.0 * FAINT / (exponent + 1.0)).sqrt());
                (3.0 / ((exponent + 1.0).sqrt() + exponent * felt)).min(1.0)
            }
            Profile::Charlie(power) => charlie_reach(power, distance, 3.0),
            Profile::Cone(_) | Profile::Cosine => 1.0,
        }
    }

    /// The same for quadrature alone, which takes entire functions of larger pieces than second moments do:
    /// Gauss's rule of order 8 misses 1e-9 of a change by a factor e^7.
    pub fn panel(&self, distance: f64) -> f64 {
        match self.profile {
            Profile::Charlie(power) => charlie_reach(power, distance, 6.0),
            _ => self.reach(distance),
        }
    }
}

/// A power of the distance from the axis, which is its branch point: felt where it is not nothing, and
/// changing by a factor e^`change` over `change`/(2 power) of the distance.
fn charlie_reach(power: f64, distance: f64, change: f64) -> f64 {
    // What is nearer to the axis holds too little to be split further, and a panorama's pole too many pieces.
    let felt = distance.max(SQRT_2 * (-NOTHING / (2.0 * power)).exp()).max(1e-4);
    (felt * (0.5 * change / power).min(1.0)).min(1.0)
}

/// Below this roughness a lobe is narrower than the rounding of a direction: the mirror.
pub const MIRROR: f64 = 3e-5;
