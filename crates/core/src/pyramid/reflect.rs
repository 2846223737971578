//! Looks reflections of the true BRDF up: [`Pyramid::reflect`].

use super::Pyramid;
use super::albedo::albedo_at;
use super::anisotropic::{self, ASIDE, MIDDLE, PAIRS, Row, aside};
use super::brdf::{Brdf, alphas};
use super::fit::smooth;
use super::places::READS;
use super::reads::{AROUND, COSINE_FROM, HARMONICS, LAYERS, level_of, node_at};
use crate::common::frame::{Frame, LEAST_COSINE};
use crate::light::environment::Rgb;
use crate::light::sh::basis;
use glam::{DVec2, DVec3, Vec3A};

/// Weights of the harmonics in the texels `pairs` for (f0, f90), by direction of [`AROUND`] and order.
fn harmonic_weights(pairs: &[[f32; 4]]) -> [[[f32; 2]; 5]; 5] {
    let mut weights = [[[0.0; 2]; 5]; 5];
    let mut pairs = (0..HARMONICS).map(|k| {
        let texel = pairs[k / 2];
        [texel[2 * (k % 2)], texel[2 * (k % 2) + 1]]
    });
    for (k, orders) in weights.iter_mut().enumerate() {
        for (weight, pair) in orders.iter_mut().skip(k).zip(&mut pairs) {
            *weight = pair;
        }
    }
    weights
}

/// The sum of weights for (f0, f90).
fn sum_of(weights: impl IntoIterator<Item = [f32; 2]>) -> [f32; 2] {
    weights.into_iter().fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d])
}

/// Alpha along the tangent over that across it, less 1, up to which isotropic reflections fade out.
const BLEND: f64 = 0.1;

/// The share of the row along the tangent in a reflection; the rest is isotropic.
fn row_share(alpha: DVec2) -> f32 {
    smooth((alpha.x - alpha.y) / (BLEND * alpha.y.max(1e-6))) as f32
}

/// Roughness of the isotropic lobe of the same peak.
fn mean_roughness(alpha: DVec2) -> f32 {
    (alpha.x * alpha.y).powf(0.25) as f32
}

/// The tangent along the plane of incidence and across it, where the view's direction in the surface is
/// `level_view`.
fn tangent_of(level_view: DVec2) -> DVec2 {
    level_view * DVec2::new(1.0, -1.0)
}

impl Pyramid {
    /// Radiance that a surface of `roughness` and `anisotropy` in [0, 1] reflects to the viewer of `frame`
    /// (in the map's space).
    ///
    /// GGX with the height-correlated masking of Smith and Fresnel's term of Schlick, f0 + (f90 - f0) (1 -
    /// v.h)^5. It is not normalised: a white world gives [`Self::albedo`]. Alphas are those of
    /// KHR_materials_anisotropy; a frame without a tangent reflects isotropically.
    pub fn reflect(&self, frame: &Frame, roughness: f32, anisotropy: f32, f0: Rgb, f90: f32) -> Rgb {
        let f0 = Vec3A::from_array(f0);
        if anisotropy == 0.0 || !frame.has_tangent {
            let albedo = albedo_at(roughness, frame.view.z as f32);
            return self.isotropic(frame, roughness, albedo, f0, f90).to_array();
        }
        let alpha = alphas(f64::from(roughness), f64::from(anisotropy));
        let share = row_share(alpha);
        let level_view = frame.view.truncate().normalize_or(DVec2::X);
        let albedo = anisotropic::albedo_along(alpha, frame.view.z, tangent_of(level_view));
        let along_tangent = self.anisotropic(frame, level_view, alpha, albedo, f0, f90);
        if share == 1.0 {
            return along_tangent.to_array();
        }
        self.isotropic(frame, mean_roughness(alpha), albedo, f0, f90).lerp(along_tangent, share).to_array()
    }

    /// Without a tangent, where a white world gives `albedo`.
    fn isotropic(&self, frame: &Frame, roughness: f32, albedo: [f32; 2], f0: Vec3A, f90: f32) -> Vec3A {
        let node = node_at(self.levels, roughness, frame.view.z as f32);
        // Of a white world the weights give their sum; of the harmonics, the first. Where nothing is
        // reflected, shares mean nothing.
        let has_cosine = roughness > COSINE_FROM;
        let reads = &node[..READS - usize::from(has_cosine)];
        let ([mean, grazing, ..], [.., a, b]) = (node[READS], node[LAYERS - 1]);
        let white = sum_of(reads.iter().map(|[.., a, b]| [*a, *b]).chain([[mean, grazing], [a, b]]));
        let [scale, bias] = [0, 1].map(|k| (albedo[k] + 1e-4) / (white[k].max(0.0) + 1e-4));
        let sunlit = (f0, f90);
        let (f0, f90) = (f0 * scale, f90 * bias);
        let coloured = |[a, b]: [f32; 2]| f0 * a + f90 * b;
        let (view, normal) = (frame.axes * frame.view, frame.axes.z_axis);
        let along = frame.axes * frame.view.with_z(0.0);
        let mut sum = Vec3A::ZERO;
        if has_cosine {
            sum += coloured([a, b]) * self.cosine_around(normal);
        }
        let mut in_mirror = 0.0;
        for [slope, level, a, b] in reads.iter().copied() {
            let half = (normal + f64::from(slope) * along).normalize();
            let direction = half * (2.0 * view.dot(half)) - view;
            sum += coloured([a, b]) * self.between_levels(direction, level);
            in_mirror += (a + b) * (1.0 - level).max(0.0);
        }
        sum += self.harmonics_reflected(frame, &node[READS..], f0, f90);
        let sum = self.unscaled(sum.max(Vec3A::ZERO));
        let alpha = DVec2::splat(f64::from(roughness).powi(2));
        let share = (1.0 - in_mirror / (white[0] + white[1])).max(0.0);
        sum + share * self.suns_reflected(frame, alpha, sunlit.0, sunlit.1)
    }

    /// With `alpha` along the tangent and across it, where a white world gives `albedo`. `level_view` is the
    /// view's direction in the surface.
    fn anisotropic(
        &self,
        frame: &Frame,
        level_view: DVec2,
        alpha: DVec2,
        albedo: [f32; 2],
        f0: Vec3A,
        f90: f32,
    ) -> Vec3A {
        let tangent = tangent_of(level_view);
        let azimuth = tangent.y.abs().atan2(tangent.x.abs());
        let node = anisotropic::node_at(self.levels, alpha, frame.view.z, azimuth);
        let row = Row::new(alpha, tangent, frame.view.z);
        // From axes of the plane of incidence to those of the tangent.
        let axis = level_view * row.axis.x + level_view.perp() * row.axis.y;
        let white = sum_of(node[..=PAIRS].iter().zip(0..).flat_map(|([a, b, c, d], texel)| {
            // The harmonics' texels begin with the one that has a mean.
            [[*a, *b], if texel == PAIRS { [0.0; 2] } else { [*c, *d] }]
        }));
        let [scale, bias] = [0, 1].map(|k| albedo[k] / white[k]);
        let sunlit = (f0, f90);
        let (f0, f90) = (f0 * scale, f90 * bias);
        let coloured = |[a, b]: [f32; 2]| f0 * a + f90 * b;
        let mut sum = coloured([node[0][2], node[0][3]]) * self.cosine_around(frame.axes.z_axis);
        let mut in_mirror = 0.0;
        for (distance, [a, b, c, d]) in node[..PAIRS].iter().copied().enumerate() {
            let (own, other) = ([a, b], if distance == 0 { [a, b] } else { [c, d] });
            for side in if distance == 0 { &[1.0][..] } else { &[1.0, -1.0] } {
                let [a, b] = [0, 1]
                    .map(|k| 0.5 * (own[k] + other[k]) + side * row.skew as f32 * 0.5 * (own[k] - other[k]));
                let read = if *side > 0.0 { MIDDLE + distance } else { MIDDLE - distance };
                let [slope, width] = row.reads[read];
                let half = (slope * axis).extend(1.0).normalize();
                let direction = frame.axes * (half * (2.0 * frame.view.dot(half)) - frame.view);
                let level = level_of(self.levels, width) as f32;
                sum += coloured([a, b]) * self.between_levels(direction, level);
                in_mirror += (scale * a + bias * b) * (1.0 - level).max(0.0);
            }
        }
        let pairs = &node[PAIRS..];
        sum += self.harmonics_reflected(frame, pairs, f0, f90);
        // The table is for tangents on one side of the plane of incidence.
        let side = if tangent.x * tangent.y < 0.0 { -1.0 } else { 1.0 };
        let along = frame.axes * level_view.extend(0.0);
        let across = frame.axes * (side * level_view.perp()).extend(0.0);
        let mut skew = (HARMONICS..).map(|k| &pairs[k / 2][2 * (k % 2)..]);
        for (first, direction) in (1..).zip(ASIDE.map(aside)) {
            let [own, other] = [1.0, -1.0].map(|side| {
                basis(along * direction.x + across * (side * direction.y) + frame.axes.z_axis * direction.z)
            });
            for (order, weights) in (first..5).zip(&mut skew) {
                let colour = coloured([weights[0], weights[1]]);
                for k in order * order..(order + 1) * (order + 1) {
                    sum += colour * ((own[k] - other[k]) as f32) * self.harmonics[k];
                }
            }
        }
        let sum = self.unscaled(sum.max(Vec3A::ZERO));
        let share = (1.0 - in_mirror / (albedo[0] + albedo[1])).max(0.0);
        sum + share * self.suns_reflected(frame, alpha, sunlit.0, sunlit.1)
    }

    /// The harmonics with the weights of `pairs`.
    fn harmonics_reflected(&self, frame: &Frame, pairs: &[[f32; 4]], f0: Vec3A, f90: f32) -> Vec3A {
        let normal = frame.axes.z_axis;
        let towards = frame.axes * frame.view.truncate().normalize_or(DVec2::X).extend(0.0);
        let mut sum = Vec3A::ZERO;
        for (angle, weights) in AROUND.into_iter().zip(harmonic_weights(pairs)) {
            let functions = basis(normal * angle.cos() + towards * angle.sin());
            for (k, (value, harmonic)) in functions.into_iter().zip(self.harmonics).enumerate() {
                let [a, b] = weights[k.isqrt()];
                sum += (f0 * a + f90 * b) * value as f32 * harmonic;
            }
        }
        sum
    }

    /// The suns in the BRDF itself, with `alpha` along the tangent and across it.
    fn suns_reflected(&self, frame: &Frame, alpha: DVec2, f0: Vec3A, f90: f32) -> Vec3A {
        let least = DVec2::splat(0.5 * self.levels.width(0));
        let brdf = Brdf::of_alphas(frame.view, alpha.max(least));
        let mut sum = Vec3A::ZERO;
        for sun in self.suns.suns {
            for (c, channel) in sun.channels.into_iter().enumerate() {
                for centre in sun.discs(&channel) {
                    let light = frame.axes.transpose() * centre.as_dvec3();
                    let (value, fresnel) = brdf.around(light, f64::from(channel.spread));
                    let reflected = value as f32 * (f0[c] + (f90 - f0[c]) * fresnel as f32);
                    sum[c] += 0.5 * channel.energy * reflected;
                }
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
    /// scattering, and for what lies under a clear coat. `cosine` is n.v. With anisotropy it is the mean over
    /// the tangent's directions.
    pub fn albedo(&self, cosine: f32, roughness: f32, anisotropy: f32) -> [f32; 2] {
        if anisotropy == 0.0 {
            return albedo_at(roughness, cosine);
        }
        anisotropic::mean_albedo(alphas(f64::from(roughness), f64::from(anisotropy)), seen(cosine))
    }

    /// The same along a tangent: `along` is t.v, the tangent of length 1 and at right angles to the normal.
    pub fn albedo_along(&self, cosine: f32, along: f32, roughness: f32, anisotropy: f32) -> [f32; 2] {
        if anisotropy == 0.0 {
            return albedo_at(roughness, cosine);
        }
        let cosine = seen(cosine);
        let x = (f64::from(along).abs() / (1.0 - cosine * cosine).sqrt().max(1e-4)).min(1.0);
        let tangent = DVec2::new(x, (1.0 - x * x).sqrt());
        anisotropic::albedo_along(alphas(f64::from(roughness), f64::from(anisotropy)), cosine, tangent)
    }
}

/// n.v of a view that is turned up to the horizon.
fn seen(cosine: f32) -> f64 {
    f64::from(cosine.max(LEAST_COSINE as f32).min(1.0))
}
