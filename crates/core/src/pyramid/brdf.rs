//! The reflection that pyramids serve and the oracle sums: GGX with the height-correlated masking of Smith,
//! seen from anywhere, along a tangent if it is anisotropic.
//!
//! ```text
//! L(v) = integral of L(l) F D(h) V(l, v) (n.l) dl,   F = f0 + (f90 - f0) (1 - v.h)^5
//! D(h) = 1 / (pi ax ay ((h.t / ax)^2 + (h.b / ay)^2 + (h.n)^2)^2)
//! V    = 0.5 / (n.l S(v) + n.v S(l)),   S(w) = sqrt((ax w.t)^2 + (ay w.b)^2 + (w.n)^2)
//! ax   = r^2 + (1 - r^2) anisotropy^2,   ay = r^2
//! ```

use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Alpha along the tangent and across it at `roughness` and `anisotropy` in [0, 1].
pub fn alphas(roughness: f64, anisotropy: f64) -> DVec2 {
    let alpha = roughness * roughness;
    DVec2::new(alpha + (1.0 - alpha) * anisotropy * anisotropy, alpha)
}

/// The reflection seen from one direction.
#[derive(Clone, Copy, Debug)]
pub struct Brdf {
    /// Towards the viewer, in axes of the surface.
    view: DVec3,
    /// Alpha along the tangent and across it.
    alpha: DVec2,
}

impl Brdf {
    /// The reflection at `roughness` in (0, 1] and `anisotropy` in [0, 1].
    pub fn new(view: DVec3, roughness: f64, anisotropy: f64) -> Self {
        Self::of_alphas(view, alphas(roughness, anisotropy))
    }

    /// The reflection with `alpha` along the tangent and across it.
    pub const fn of_alphas(view: DVec3, alpha: DVec2) -> Self {
        Self { view, alpha }
    }

    /// Radiance per irradiance from the unit vector `light`, F = 1, and the factor (1 - v.h)^5 of f90.
    pub fn at(&self, light: DVec3) -> (f64, f64) {
        if light.z <= 0.0 {
            return (0.0, 0.0);
        }
        let half = (self.view + light).normalize();
        let shape = self.shape();
        let bend = half.dot(shape * half);
        let cosine = self.view.dot(half);
        (shape.z / (PI * bend * bend) * self.visible(light), (1.0 - cosine).max(0.0).powi(5))
    }

    /// Their mean over a disc whose mean squared distance from its centre `light` is `spread`. Of a disc that
    /// the horizon crosses counts a smaller one above, with its share of the light.
    ///
    /// ```text
    /// integral of D (h.n) dh = integral of cos / pi     over a cone of half vectors, stretched by 1 / alpha
    /// D (n.l) V dl           = D (h.n) dh times 4 (v.h) (n.l) V / (h.n)
    /// ```
    ///
    /// The disc's rim lies in a plane, and h = v + l there: an elliptic cone, and of any such the clamped
    /// cosine has a closed form, with the one positive root of a cubic. What it is multiplied by varies less,
    /// and is taken at the cone's axis.
    pub fn around(&self, light: DVec3, spread: f64) -> (f64, f64) {
        let radius = (2.0 * spread).sqrt();
        if light.z <= -radius {
            return (0.0, 0.0);
        }
        let left = (0.5 * (light.z + radius) / radius.max(1e-9)).min(1.0);
        let light = light.with_z(light.z.max(left * radius)).normalize();
        let spread = spread * left * left;
        // The axis of the disc's plane, and the quadratic form of GGX, times both alphas.
        let middle = self.view + (1.0 - spread) * light;
        let length2 = middle.length_squared();
        let half = middle / length2.sqrt();
        let shape = self.shape();
        let bent = shape * half;
        let (bend, along) = (half.dot(bent), half.dot(light));
        // The ellipse around its plane's foot, all over the distance to its centre: trace and determinant of
        // its squared axes, the square of the plane's distance, and what else the cubic has.
        let size = spread * (2.0 - spread) / (length2 * bend);
        let trace = size * shape.dot(1.0 - light * light);
        let aside = trace - size * light.cross(bent).length_squared() / bend;
        let masking = self.masking(light);
        let determinant = (size * masking).powi(2);
        let near = shape.z * (along / masking).powi(2) / bend;
        let last = determinant * near;
        // x (x^2 + trace x + determinant) = x^2 + aside x + last, by two steps of Newton's method for the
        // quotient of both sides, from below.
        let linear = 1.0 - trace;
        let mut x = (0.5 * (linear + (linear * linear + 4.0 * trace * near).sqrt())).max(near);
        let (mut side, mut slope) = (0.0, 1.0);
        for _ in 0..3 {
            x += side * (side - ((x + trace) * x + determinant) * x) / slope;
            side = (x + aside) * x + last;
            let square = 3.0 * last + trace * aside - determinant;
            slope = (((x + 2.0 * aside) * x + square) * x + 2.0 * trace * last) * x + determinant * last;
        }
        let inverse = (size * shape + x).recip();
        let towards = size * light.dot(inverse * bent) / (x * light.dot(inverse * light));
        let axis = (inverse * (half + towards * light)).normalize();
        let cosine = self.view.dot(axis);
        let lobe = (side / (x * slope * bend * axis.dot(shape * axis))).sqrt() * shape.z / (PI * bend);
        let share = left.powf(1.25) * (1.0 - 0.5 * spread);
        let visible = self.visible(2.0 * cosine * axis - self.view);
        (share * 4.0 * along * cosine / length2 * lobe * visible, (1.0 - cosine).max(0.0).powi(5))
    }

    /// The quadratic form of h that GGX falls with, times both alphas.
    fn shape(&self) -> DVec3 {
        let [x, y] = self.alpha.to_array();
        DVec3::new(y / x, x / y, x * y)
    }

    /// Smith's S.
    fn masking(&self, w: DVec3) -> f64 {
        (self.alpha * w.truncate()).length().hypot(w.z)
    }

    /// V (n.l).
    fn visible(&self, light: DVec3) -> f64 {
        let cosine = light.z.max(0.0);
        0.5 * cosine / (cosine * self.masking(self.view) + self.view.z * self.masking(light))
    }
}
