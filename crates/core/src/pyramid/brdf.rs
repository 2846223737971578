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
        self.around(light, 0.0)
    }

    /// That of a light whose mean squared distance from `light` is `spread`.
    ///
    /// A light of variance v sees the lobe's slopes blurred, by v / 8 in the plane of incidence and more
    /// across it; near its centre, that is a lobe whose squared alphas are greater by four times that.
    pub fn around(&self, light: DVec3, spread: f64) -> (f64, f64) {
        if light.z <= 0.0 {
            return (0.0, 0.0);
        }
        let middle = self.view + light;
        let length = middle.length();
        let half = middle / length;
        let cosine = self.view.dot(half);
        let across = DVec2::new(-self.view.y, self.view.x) / cosine;
        let [xx, yy] = [0, 1].map(|k| self.alpha[k].powi(2) + 0.5 * spread * (1.0 + across[k] * across[k]));
        let xy = 0.5 * spread * across.x * across.y;
        let determinant = xx * yy - xy * xy;
        let slopes = yy * half.x * half.x - 2.0 * xy * half.x * half.y + xx * half.y * half.y;
        let bend = slopes / determinant + half.z * half.z;
        let masking = |w: DVec3| (self.alpha * w.truncate()).length().hypot(w.z);
        let visible = 0.5 * light.z / (light.z * masking(self.view) + self.view.z * masking(light));
        (visible / (PI * determinant.sqrt() * bend * bend), (1.0 - cosine).max(0.0).powi(5))
    }
}
