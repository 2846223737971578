//! Reconstruction of OEM texels on the sphere: energy constant in (u, v) over the texel, or spread by a tent
//! two texels wide (the constant convolved with a one-texel box), which at roughness 0 is bilinear
//! interpolation.

use super::quadrant::{Mirrored, Quadrant};
use crate::sphere::octahedral::{direction_from_oct, texel_centre, wrap_oct};
use crate::sphere::quadrature::THREE_NODES;
use glam::{DVec2, DVec3, Mat3, Vec3, Vec3Swizzles as _};

/// Spread of a texel's energy around its centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reconstruction {
    /// Constant over the texel: for lobes much wider than it.
    Constant,
    /// A tent over two texels: for lobes of the texel's size or sharper.
    Bilinear,
}

impl Reconstruction {
    /// Half of the spread's width in texels.
    pub const fn reach(self) -> f64 {
        match self {
            Self::Constant => 0.5,
            Self::Bilinear => 1.0,
        }
    }

    /// The spread's density at `offset` from the centre along one axis, in texels.
    fn density(self, offset: f64) -> f64 {
        match self {
            Self::Constant => 1.0,
            Self::Bilinear => 1.0 - offset.abs(),
        }
    }

    /// Nodes per side and weights that reproduce the spread's moments: up to the fourth, or from [`FINE`] on
    /// up to the second, because the fourth is below float32 precision.
    const fn nodes(self, n: u32) -> &'static [(f64, f64)] {
        match (self, n < FINE) {
            // Gauss and Legendre on [-1/2, 1/2].
            (Self::Constant, true) => &[
                (-0.387_298_334_620_741_7, 5.0 / 18.0),
                (0.0, 8.0 / 18.0),
                (0.387_298_334_620_741_7, 5.0 / 18.0),
            ],
            (Self::Constant, false) => &[(-0.288_675_134_594_812_9, 0.5), (0.288_675_134_594_812_9, 0.5)],
            // Moments 1/6 and 1/15.
            (Self::Bilinear, true) => &[
                (-0.632_455_532_033_675_9, 5.0 / 24.0),
                (0.0, 14.0 / 24.0),
                (0.632_455_532_033_675_9, 5.0 / 24.0),
            ],
            (Self::Bilinear, false) => &[(-0.408_248_290_463_863, 0.5), (0.408_248_290_463_863, 0.5)],
        }
    }
}

/// Below this size texels are too curved for the small rules.
const CURVED: u32 = 32;

/// From this size on the map is flat enough for two nodes per side: (2/n)^4 is 2e-10.
const FINE: u32 = 512;

/// First two moments and radius of energy on the sphere.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    /// Mean of the unit directions: a point inside the sphere.
    pub(crate) centroid: DVec3,
    /// Covariance of the unit directions: xx, yy, zz.
    pub(crate) diagonal: DVec3,
    /// Covariance of the unit directions: yz, zx, xy.
    pub(crate) mixed: DVec3,
    /// Maximum distance of a direction from the centroid.
    pub(crate) radius: f64,
}

impl Moments {
    /// Moments of weighted directions; weights sum to 1. The radius is left 0.
    pub(crate) fn from_weighted(weighted: impl Iterator<Item = (DVec3, f64)> + Clone) -> Self {
        let mut moments = Self::default();
        for (direction, weight) in weighted.clone() {
            moments.centroid += direction * weight;
        }
        for (direction, weight) in weighted {
            let apart = direction - moments.centroid;
            moments.diagonal += apart * apart * weight;
            moments.mixed += apart.yzx() * apart.zxy() * weight;
        }
        moments
    }
}

/// [`Moments`] in float32, from which cells are built.
#[derive(Clone, Copy, Debug, Default)]
pub struct Patch {
    /// See [`Moments`].
    pub centroid: Vec3,
    /// Covariance of x, y and z with themselves.
    pub diagonal: Vec3,
    /// Covariance of yz, xz and xy.
    pub mixed: Vec3,
    /// Radius around the centroid.
    pub radius: f32,
}

impl From<Moments> for Patch {
    fn from(moments: Moments) -> Self {
        Self {
            centroid: moments.centroid.as_vec3(),
            diagonal: moments.diagonal.as_vec3(),
            mixed: moments.mixed.as_vec3(),
            // Rounded up, as bounds require.
            radius: (moments.radius * (1.0 + 1e-6)) as f32,
        }
    }
}

/// A texel's moments and its solid angle.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Texel {
    pub(crate) patch: Patch,
    pub(crate) solid_angle: f32,
}

impl Mirrored for Patch {
    fn turned(mut self) -> Self {
        self.centroid = self.centroid.zyx();
        self.diagonal = self.diagonal.zyx();
        self.mixed = self.mixed.zyx();
        self
    }

    fn mirrored(mut self, signs: Vec3) -> Self {
        self.centroid *= signs;
        self.mixed *= signs.yzx() * signs.zxy();
        self
    }
}

impl Mirrored for Texel {
    fn turned(self) -> Self {
        Self { patch: self.patch.turned(), ..self }
    }

    fn mirrored(self, signs: Vec3) -> Self {
        Self { patch: self.patch.mirrored(signs), ..self }
    }
}

impl Patch {
    /// The image under `motion`, a rotation or reflection.
    pub(crate) fn moved(self, motion: Mat3) -> Self {
        let ([xx, yy, zz], [yz, zx, xy]) = (self.diagonal.to_array(), self.mixed.to_array());
        let covariance = motion
            * Mat3::from_cols_array_2d(&[[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
            * motion.transpose();
        Self {
            centroid: motion * self.centroid,
            diagonal: Vec3::new(covariance.x_axis.x, covariance.y_axis.y, covariance.z_axis.z),
            mixed: Vec3::new(covariance.y_axis.z, covariance.z_axis.x, covariance.x_axis.y),
            radius: self.radius,
        }
    }
}

/// The spreads of all texels of an n x n square.
pub fn tents(n: u32, reconstruction: Reconstruction) -> Quadrant<Patch> {
    Quadrant::new(n, |x, y| spread(n, texel_centre(n, x, y), reconstruction).into())
}

/// Whether the map has a kink (axis, fold diagonal or edge of the square) nearer than `reach` to `centre`, u,
/// v >= 0.
fn near_kink(centre: DVec2, reach: f64) -> bool {
    // A texel's outline may touch a kink.
    let reach = reach * (1.0 - 1e-9);
    let most = centre.max_element();
    centre.min_element() < reach || most > 1.0 - reach || (1.0 - centre.x - centre.y).abs() < 2.0 * reach
}

/// Moments of the spread around `centre` (u, v >= 0).
fn spread(n: u32, centre: DVec2, reconstruction: Reconstruction) -> Moments {
    let h = 2.0 / f64::from(n);
    let reach = reconstruction.reach();
    let smooth = n >= CURVED && !near_kink(centre, reach * h);
    // No wrapping is needed away from kinks.
    let direction = |offset: DVec2| {
        let uv = centre + offset * h;
        direction_from_oct(if smooth { uv } else { wrap_oct(uv) })
    };
    let mut moments = if smooth {
        let nodes = reconstruction.nodes(n);
        let mut weighted = [(DVec3::ZERO, 0.0); 9];
        let weighted = &mut weighted[..nodes.len() * nodes.len()];
        for (k, node) in weighted.iter_mut().enumerate() {
            let ((u, weight_u), (v, weight_v)) = (nodes[k % nodes.len()], nodes[k / nodes.len()]);
            *node = (direction(DVec2::new(u, v)), weight_u * weight_v);
        }
        Moments::from_weighted(weighted.iter().copied())
    } else {
        let rule: &[(f64, f64)] = if n < CURVED { &SIX_NODES } else { &THREE_NODES };
        kinked(SQUARES, rule, direction, reconstruction)
    };
    // Kinks meet the outline only at its corners and half-texel points. Between them the patch is a spherical
    // polygon, whose farthest point is a corner.
    let step = if smooth { 4 } else { 1 };
    let mut radius_squared = 0.0_f64;
    for k in (0..16).step_by(step) {
        let along = f64::from(k % 4) / 2.0 - 1.0;
        let corner = match k / 4 {
            0 => DVec2::new(along, -1.0),
            1 => DVec2::new(1.0, along),
            2 => DVec2::new(-along, 1.0),
            _ => DVec2::new(-1.0, -along),
        };
        radius_squared = radius_squared.max(direction(corner * reach).distance_squared(moments.centroid));
    }
    // On very coarse maps a spread may reach around the sphere.
    moments.radius = if n < 4 { 2.0 } else { radius_squared.sqrt() };
    moments
}

/// Gauss and Legendre's nodes and weights on [0, 1].
const SIX_NODES: [(f64, f64); 6] = [
    (0.033_765_242_898_423_99, 0.085_662_246_189_585_17),
    (0.169_395_306_766_867_74, 0.180_380_786_524_069_3),
    (0.380_690_406_958_401_56, 0.233_956_967_286_345_53),
    (0.619_309_593_041_598_4, 0.233_956_967_286_345_53),
    (0.830_604_693_233_132_3, 0.180_380_786_524_069_3),
    (0.966_234_757_101_576, 0.085_662_246_189_585_17),
];

/// Squares along an edge of a spread, so that axes, edges and fold diagonals all run along their edges and
/// diagonals.
const SQUARES: u32 = 4;

/// Moments where kinks cross the spread: `squares` a side, a multiple of [`SQUARES`], each cut along both
/// diagonals, and the nodes of `rule` in each triangle.
fn kinked(
    squares: u32,
    rule: &[(f64, f64)],
    direction: impl Fn(DVec2) -> DVec3,
    reconstruction: Reconstruction,
) -> Moments {
    let reach = reconstruction.reach();
    let mut weighted = Vec::with_capacity(4 * (squares * squares) as usize * rule.len() * rule.len());
    let side = 2.0 / f64::from(squares);
    for (i, j) in (0..squares).flat_map(|j| (0..squares).map(move |i| (i, j))) {
        let low = DVec2::new(f64::from(i), f64::from(j)) * side - 1.0;
        let middle = low + 0.5 * side;
        let corners = [low, low + DVec2::new(side, 0.0), low + side, low + DVec2::new(0.0, side)];
        for k in 0..4 {
            let (a, b) = (corners[k], corners[(k + 1) % 4]);
            for (along, weight_along) in rule {
                for (across, weight_across) in rule {
                    // Collapsed coordinates: the triangle's point shrinks towards the middle.
                    let point = (middle + (a.lerp(b, *across) - middle) * *along) * reach;
                    let area = along * 0.5 * weight_along * weight_across * (side * reach) * (side * reach);
                    let density = reconstruction.density(point.x) * reconstruction.density(point.y);
                    weighted.push((direction(point), density * area));
                }
            }
        }
    }
    Moments::from_weighted(weighted.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_rules_find_the_brute_force_moments() {
        for (n, reconstruction) in [
            (16, Reconstruction::Bilinear),
            (17, Reconstruction::Bilinear),
            (16, Reconstruction::Constant),
            (17, Reconstruction::Constant),
        ] {
            let tents = tents(n, reconstruction);
            let reach = reconstruction.reach();
            for (x, y) in [(0, 0), (3, 9), (12, 12), (11, 14), (8, 8), (15, 2), (4, 13)] {
                let (centre, h) = (texel_centre(n, x, y), 2.0 / f64::from(n));
                let count = 200;
                let weighted: Vec<(DVec3, f64)> = (0..count * count)
                    .map(|k| {
                        let p = (DVec2::new(f64::from(k % count), f64::from(k / count)) + 0.5)
                            * (2.0 / f64::from(count))
                            - 1.0;
                        let p = p * reach;
                        let density = reconstruction.density(p.x) * reconstruction.density(p.y);
                        let area = (2.0 * reach / f64::from(count)).powi(2);
                        (direction_from_oct(wrap_oct(centre + p * h)), density * area)
                    })
                    .collect();
                let expected = Moments::from_weighted(weighted.iter().copied());
                let found = tents.at(x, y);
                let (centroid, diagonal, mixed) =
                    (found.centroid.as_dvec3(), found.diagonal.as_dvec3(), found.mixed.as_dvec3());
                assert!(centroid.distance(expected.centroid) < 3e-5, "n {n} ({x}, {y}) {reconstruction:?}");
                assert!(diagonal.distance(expected.diagonal) < 2e-5, "n {n} ({x}, {y}) {reconstruction:?}");
                assert!(mixed.distance(expected.mixed) < 2e-5, "n {n} ({x}, {y}) {reconstruction:?}");
                let reached = weighted.iter().map(|(d, _)| d.distance(centroid)).fold(0.0, f64::max);
                assert!(
                    reached <= f64::from(found.radius),
                    "n {n} ({x}, {y}): {reached} within {}",
                    found.radius
                );
            }
        }
    }

    #[test]
    fn centroids_are_exact_at_every_size() {
        for n in [1, 2, 3, 4, 5, 8, 15, 16, 31, 32, 33, 64, 511, 512] {
            for reconstruction in [Reconstruction::Constant, Reconstruction::Bilinear] {
                let tents = tents(n, reconstruction);
                let h = 2.0 / f64::from(n);
                // All texels of small maps; for others a subset that includes the last column and row.
                for (x, y) in (0..n).flat_map(|y| (0..n).map(move |x| (x, y))) {
                    if n > 16 && (x % 31 != n % 31 || y % 15 != n % 15) {
                        continue;
                    }
                    let centre = texel_centre(n, x, y);
                    let direction = |offset: DVec2| direction_from_oct(wrap_oct(centre + offset * h));
                    let expected = kinked(2 * SQUARES, &SIX_NODES, direction, reconstruction);
                    let found = tents.at(x, y);
                    let off = found.centroid.as_dvec3().distance(expected.centroid);
                    // Three components, each rounded to 2^-24 of 1, and 2e-8.
                    assert!(off < 7.2e-8, "n {n} ({x}, {y}) {reconstruction:?}: centroid off by {off:e}");
                    let off = found.diagonal.as_dvec3().distance(expected.diagonal);
                    assert!(
                        off < 3e-5 * expected.diagonal.element_sum() + 1e-8,
                        "n {n} ({x}, {y}) {reconstruction:?}: covariance off by {off:e}"
                    );
                }
            }
        }
    }
}
