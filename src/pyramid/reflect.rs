//! Looks reflections of the true BRDF up: [`Pyramid::reflect`].

use super::Pyramid;
use super::brdf::Brdf;
use super::reads::{AROUND, HARMONICS, Node, READS, node_at};
use crate::environment::Rgb;
use crate::frame::{Frame, LEAST_COSINE};
use crate::sh::basis;
use glam::{DVec3, Vec3A};

/// Weights of the harmonics of `node` for (f0, f90), by direction of [`AROUND`] and order.
fn harmonic_weights(node: &Node) -> [[[f32; 2]; 5]; 5] {
    let mut weights = [[[0.0; 2]; 5]; 5];
    let mut pairs = (0..HARMONICS).map(|k| {
        let texel = node[READS + 1 + k / 2];
        [texel[2 * (k % 2)], texel[2 * (k % 2) + 1]]
    });
    for (k, orders) in weights.iter_mut().enumerate() {
        for (weight, pair) in orders.iter_mut().skip(k).zip(&mut pairs) {
            *weight = pair;
        }
    }
    weights
}

impl Pyramid {
    /// Radiance that a surface of `roughness` in [0, 1] reflects to the viewer of `frame` (in the map's
    /// space).
    ///
    /// GGX with the height-correlated masking of Smith and Fresnel's term of Schlick, f0 + (f90 - f0) (1 -
    /// v.h)^5. It is not normalised: a white world gives [`Self::albedo`].
    #[must_use]
    pub fn reflect(&self, frame: &Frame, roughness: f32, f0: Rgb, f90: f32) -> Rgb {
        let f0 = Vec3A::from_array(f0);
        let coloured = |[a, b]: [f32; 2]| f0 * a + f90 * b;
        let node = node_at(self.octaves, roughness, frame.view.z as f32);
        let (view, normal) = (frame.axes * frame.view, frame.axes.z_axis);
        let along = frame.axes * frame.view.with_z(0.0);
        let mut sum = Vec3A::ZERO;
        let mut in_mirror = 0.0;
        for [slope, level, a, b] in node[..READS].iter().copied() {
            let half = (normal + f64::from(slope) * along).normalize();
            let direction = half * (2.0 * view.dot(half)) - view;
            sum += coloured([a, b]) * self.between_levels(direction, level);
            in_mirror += (a + b) * (1.0 - level).max(0.0);
        }
        let [a, b, ..] = node[READS];
        sum += coloured([a, b]) * self.cosine.around(normal);
        let towards = along.normalize_or_zero();
        for (angle, weights) in AROUND.into_iter().zip(harmonic_weights(&node)) {
            let functions = basis(normal * angle.cos() + towards * angle.sin());
            for (k, (value, harmonic)) in functions.into_iter().zip(self.harmonics).enumerate() {
                sum += coloured(weights[k.isqrt()]) * value as f32 * harmonic;
            }
        }
        let sum = self.unscaled(sum.max(Vec3A::ZERO));
        let [.., a, b] = node[READS];
        (sum + (1.0 - in_mirror / (a + b)).max(0.0) * self.suns_reflected(frame, roughness, f0, f90))
            .to_array()
    }

    /// The suns in the BRDF itself.
    fn suns_reflected(&self, frame: &Frame, roughness: f32, f0: Vec3A, f90: f32) -> Vec3A {
        let least = 0.5 * self.octaves.mirror_width();
        let brdf = Brdf::new(frame.view, f64::from(roughness).max(least.sqrt()), 0.0);
        let mut sum = Vec3A::ZERO;
        for sun in self.suns.suns {
            for (c, channel) in sun.channels.into_iter().enumerate() {
                let light = frame.axes.transpose() * channel.direction.as_dvec3();
                let (value, fresnel) = brdf.around(light, f64::from(channel.spread));
                sum[c] += channel.energy * value as f32 * (f0[c] + (f90 - f0[c]) * fresnel as f32);
            }
        }
        sum
    }

    /// Light around the unit vector `direction` between two levels: 0 the mirror, 1 the sharp one.
    fn between_levels(&self, direction: DVec3, level: f32) -> Vec3A {
        let whole = level as usize;
        let low = self.maps[whole].around(direction);
        match self.maps.get(whole + 1) {
            Some(map) if level > whole as f32 => low.lerp(map.around(direction), level.fract()),
            _ => low,
        }
    }

    /// What a surface reflects of a white world, f0 times the first plus f90 times the second: for multiple
    /// scattering, and for what lies under a clear coat. `cosine` is n.v.
    #[cfg(any(test, feature = "internals"))]
    #[must_use]
    pub fn albedo(&self, cosine: f32, roughness: f32) -> [f32; 2] {
        let cosine = cosine.max(LEAST_COSINE as f32).min(1.0);
        let [.., a, b] = node_at(self.octaves, roughness, cosine)[READS];
        [a, b]
    }
}
