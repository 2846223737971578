//! Moments of runs of texels in a row of a panorama, weighted by light.

use crate::geometry::tent::{Patch, Texel};
use crate::geometry::tint::Tint;
use glam::{DVec2, DVec3, Vec2, Vec3};

/// Moments of a row's texel at longitude 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Its distance from the axis and height.
    pub(super) centroid: DVec2,
    pub(super) texel: Texel,
}

/// A row of a panorama.
pub(crate) struct PanoramaRow<'a> {
    pub(super) row: Row,
    /// Cosine and sine of the columns' longitudes, in double and single precision.
    pub(super) columns: &'a [(f64, f64)],
    pub(super) rounded: &'a [(f32, f32)],
}

/// Sums over a run of texels, weighted by light: of 1 and of the cosines and sines of longitudes, as
/// differences from the run's first.
#[derive(Clone, Copy, Default)]
pub(crate) struct RunSums {
    weight: f32,
    cos: f32,
    sin: f32,
    cos_squared: f32,
    sin_squared: f32,
    product: f32,
    /// Tints of red and blue.
    colours: [ColourSums; 2],
}

/// Sums over a run of the energy of one channel times cosines and sines, and times their squares, and a bound
/// of the sum of its distance from `ratio` times the luminance.
#[derive(Clone, Copy, Default)]
struct ColourSums {
    linear: Vec2,
    squared: Vec2,
    product: f32,
    /// Energy over luminance of the first lit texel.
    ratio: f32,
    apart: f32,
    /// Sum of squares of the energy over the luminance.
    squares: f32,
}

impl ColourSums {
    /// A bound of the sum of the distance of the energies, `energy` in all, from their share of the
    /// luminance, `weight` in all.
    fn variation(&self, energy: f32, weight: f32) -> f32 {
        // The share is off the first texel's ratio by as much in sum; exact where all texels are grey.
        let from_first = (self.apart + (energy - self.ratio * weight).abs()) * (1.0 + 1e-5);
        // Cauchy and Schwarz; with sums of sixteen terms rounded.
        let (all, squares) = (f64::from(energy), f64::from(weight) * f64::from(self.squares));
        let from_squares = (squares * (1.0 + 4e-6) - all * all).max(0.0).sqrt() * (1.0 + 1e-6);
        from_first.min(from_squares as f32)
    }
}

impl PanoramaRow<'_> {
    /// Solid angle of a texel.
    pub(crate) const fn solid_angle(&self) -> f32 {
        self.row.texel.solid_angle
    }

    /// Adds the texel in column `x` of a run from column `first` on: `energy`, whose luminance is `weight`.
    #[inline(always)]
    pub(crate) fn add(&self, sums: &mut RunSums, first: u32, x: u32, energy: Vec3, weight: f32) {
        // Differences of rounded values are exact, and in error by what centroids are.
        let ((cos_first, sin_first), (cos, sin)) = (self.rounded[first as usize], self.rounded[x as usize]);
        let (cos, sin) = (cos - cos_first, sin - sin_first);
        let (weighted_cos, weighted_sin) = (weight * cos, weight * sin);
        let dark = sums.weight == 0.0;
        sums.weight += weight;
        sums.cos += weighted_cos;
        sums.sin += weighted_sin;
        sums.cos_squared += weighted_cos * cos;
        sums.sin_squared += weighted_sin * sin;
        sums.product += weighted_cos * sin;
        let at = Vec2::new(cos, sin);
        for (colour, energy) in sums.colours.iter_mut().zip([energy.x, energy.z]) {
            colour.linear += at * energy;
            colour.squared += at * at * energy;
            colour.product += cos * sin * energy;
            if dark && weight > 0.0 {
                colour.ratio = energy / weight;
            }
            colour.apart += (energy - colour.ratio * weight).abs();
            if weight > 0.0 {
                // Of at most 14 times the energy.
                colour.squares += energy * (energy / weight);
            }
        }
    }

    /// What sets red and blue apart from the luminance in a run whose whole light is `energy`, from column
    /// `first` on.
    pub(crate) fn tints(&self, sums: &RunSums, first: u32, energy: Vec3) -> [Tint; 2] {
        let per_weight = 1.0 / sums.weight;
        let centre = Vec2::new(sums.cos, sums.sin) * per_weight;
        let squares = Vec2::new(sums.cos_squared, sums.sin_squared) * per_weight;
        let product = sums.product * per_weight;
        let rho = self.row.centroid.x as f32;
        let (cos, sin) = self.rounded[first as usize];
        let (cos, sin) = (cos + centre.x, sin + centre.y);
        let [radial, _, tangential] = self.row.texel.patch.diagonal.to_array();
        let leaning = self.row.texel.patch.mixed.z;
        let tint = |colour: &ColourSums, energy: f32| {
            let dipole = colour.linear - centre * energy;
            // Around the centre, in excess of the luminance's.
            let excess = colour.squared - squares * energy - 2.0 * centre * dipole;
            let mixed = colour.product - product * energy - centre.x * dipole.y - centre.y * dipole.x;
            // The texels' own covariances turn with the longitude.
            let turned = excess + 2.0 * Vec2::new(cos, sin) * dipole;
            let crossed = mixed + cos * dipole.y + sin * dipole.x;
            Tint {
                dipole: Vec3::new(dipole.x * rho, 0.0, dipole.y * rho),
                diagonal: Vec3::new(
                    rho * rho * excess.x + radial * turned.x + tangential * turned.y,
                    0.0,
                    rho * rho * excess.y + radial * turned.y + tangential * turned.x,
                ),
                mixed: Vec3::new(
                    leaning * dipole.y,
                    rho * rho * mixed + (radial - tangential) * crossed,
                    leaning * dipole.x,
                ),
                variation: colour.variation(energy, sums.weight),
            }
        };
        [tint(&sums.colours[0], energy.x), tint(&sums.colours[1], energy.z)]
    }

    /// Moments of the light summed from column `first` on; columns `lit` are the first and last with light.
    pub(crate) fn patch(&self, sums: &RunSums, first: u32, lit: [u32; 2]) -> Patch {
        let per_weight = 1.0 / f64::from(sums.weight);
        let mean = |sum: f32| f64::from(sum) * per_weight;
        let (cos, sin) = (mean(sums.cos), mean(sums.sin));
        let (cos_first, sin_first) = self.rounded[first as usize];
        let (c, s) = (f64::from(cos_first) + cos, f64::from(sin_first) + sin);
        // Deviations of cosine and sine.
        let cos_squared = (mean(sums.cos_squared) - cos * cos).max(0.0);
        let sin_squared = (mean(sums.sin_squared) - sin * sin).max(0.0);
        let product = mean(sums.product) - cos * sin;
        let own = self.row.texel.patch;
        let [radial, upright, tangential] = own.diagonal.as_dvec3().to_array();
        let leaning = f64::from(own.mixed.z);
        let rho = self.row.centroid.x;
        // Means of squares, for the texels' own covariances.
        let (cc, ss, cs) = (c * c + cos_squared, s * s + sin_squared, c * s + product);
        let centroid = DVec3::new(rho * c, self.row.centroid.y, rho * s);
        let reach = lit.map(|x| {
            let (cos, sin) = self.columns[x as usize];
            DVec3::new(rho * cos, self.row.centroid.y, rho * sin).distance(centroid)
        });
        let diagonal = DVec3::new(
            rho * rho * cos_squared + radial * cc + tangential * ss,
            upright,
            rho * rho * sin_squared + radial * ss + tangential * cc,
        );
        let mixed = DVec3::new(leaning * s, rho * rho * product + (radial - tangential) * cs, leaning * c);
        Patch {
            centroid: centroid.as_vec3(),
            diagonal: diagonal.as_vec3(),
            mixed: mixed.as_vec3(),
            // The farthest point of a run from its centroid is a corner of a texel at one end.
            radius: (reach[0].max(reach[1]) as f32 + own.radius) * (1.0 + 1e-6),
        }
    }
}
