//! What an OEM texel looks like on the sphere under the reconstruction that is served: its energy spread by a tent,
//! two texels wide, in (u, v) (constant inside a texel, convolved with a one-texel box).

use crate::sphere::octahedral::{direction_from_oct, texel_centre, wrap_oct};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Mean direction, spread and reach of a patch of the sphere under a weight.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    /// Mean of the unit directions: a point inside the sphere.
    pub(super) centroid: DVec3,
    /// Mean squared distance from the centroid, 1 - |centroid|^2.
    pub(super) spread: f64,
    /// Greatest distance of a direction from the centroid.
    pub(super) radius: f64,
}

/// The tents of all texels of an n x n square: one table for its four mirror images.
pub(super) struct Tents {
    n: u32,
    quadrant: Vec<Moments>,
}

impl Tents {
    pub(super) fn new(n: u32) -> Self {
        let half = n.div_ceil(2);
        let first = n - half;
        let quadrant = (0..half)
            .into_par_iter()
            .flat_map_iter(|y| (0..half).map(move |x| tent(n, texel_centre(n, first + x, first + y))))
            .collect();
        Self { n, quadrant }
    }

    pub(super) fn at(&self, x: u32, y: u32) -> Moments {
        let half = self.n.div_ceil(2);
        let first = self.n - half;
        let fold = |k: u32| if k >= first { (k - first, 1.0) } else { (self.n - 1 - k - first, -1.0) };
        let ((x, sign_x), (y, sign_z)) = (fold(x), fold(y));
        let mut moments = self.quadrant[y as usize * half as usize + x as usize];
        moments.centroid *= DVec3::new(sign_x, 1.0, sign_z);
        moments
    }
}

/// Whether the map has a kink (axis, fold diagonal or edge of the square) nearer than `reach` to `centre`, u, v >= 0.
fn near_kink(centre: DVec2, reach: f64) -> bool {
    let most = centre.max_element();
    centre.min_element() < reach || most > 1.0 - reach || (1.0 - centre.x - centre.y).abs() < 2.0 * reach
}

/// Moments of the tent around `centre` (u, v >= 0).
fn tent(n: u32, centre: DVec2) -> Moments {
    let h = 2.0 / f64::from(n);
    let direction = |offset: DVec2| direction_from_oct(wrap_oct(centre + offset * h));
    let smooth = !near_kink(centre, h);
    let centroid = if smooth {
        // Three nodes a side with the tent's own second and fourth moments, h^2/6 and h^4/15.
        const NODES: [(f64, f64); 3] = [
            (-0.632_455_532_033_675_9, 5.0 / 24.0),
            (0.0, 14.0 / 24.0),
            (0.632_455_532_033_675_9, 5.0 / 24.0),
        ];
        let mut sum = DVec3::ZERO;
        for (v, weight_v) in NODES {
            for (u, weight_u) in NODES {
                sum += direction(DVec2::new(u, v)) * (weight_u * weight_v);
            }
        }
        sum
    } else {
        kinked_centroid(direction)
    };
    // Kinks meet the tent's outline at its corners and half-texel points only; between them the patch is a spherical
    // polygon, and the farthest point of a polygon is a corner.
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
        radius_squared = radius_squared.max(direction(corner).distance_squared(centroid));
    }
    if n < 4 {
        // So coarse that a tent may reach around the sphere.
        radius_squared = 4.0;
    }
    Moments { centroid, spread: (1.0 - centroid.length_squared()).max(0.0), radius: radius_squared.sqrt() }
}

/// The centroid where kinks cross the tent: half-texel squares, each cut along both diagonals, Gauss points in each
/// triangle. Axes, edges and fold diagonals all run along those cuts.
fn kinked_centroid(direction: impl Fn(DVec2) -> DVec3) -> DVec3 {
    const NODES: [(f64, f64); 3] =
        [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
    let mut sum = DVec3::ZERO;
    for j in 0..4 {
        for i in 0..4 {
            let low = DVec2::new(f64::from(i), f64::from(j)) / 2.0 - 1.0;
            let middle = low + 0.25;
            let corners = [low, low + DVec2::new(0.5, 0.0), low + 0.5, low + DVec2::new(0.0, 0.5)];
            for k in 0..4 {
                let (a, b) = (corners[k], corners[(k + 1) % 4]);
                for (along, weight_along) in NODES {
                    for (across, weight_across) in NODES {
                        // Collapsed coordinates: the triangle's point shrinks towards the middle.
                        let point = middle + (a.lerp(b, across) - middle) * along;
                        let area = along * 0.125 * weight_along * weight_across;
                        let tent = (1.0 - point.x.abs()) * (1.0 - point.y.abs());
                        sum += direction(point) * (tent * area);
                    }
                }
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_rules_find_the_brute_force_centroid() {
        for n in [16, 17] {
            let tents = Tents::new(n);
            for (x, y) in [(0, 0), (3, 9), (12, 12), (11, 14), (8, 8), (15, 2), (4, 13)] {
                let (centre, h) = (texel_centre(n, x, y), 2.0 / f64::from(n));
                let count = 200;
                let mut sum = DVec3::ZERO;
                for j in 0..count {
                    for i in 0..count {
                        let p =
                            (DVec2::new(f64::from(i), f64::from(j)) + 0.5) * (2.0 / f64::from(count)) - 1.0;
                        let weight = (1.0 - p.x.abs()) * (1.0 - p.y.abs()) * (2.0 / f64::from(count)).powi(2);
                        sum += direction_from_oct(wrap_oct(centre + p * h)) * weight;
                    }
                }
                let moments = tents.at(x, y);
                assert!(
                    moments.centroid.distance(sum) < 3e-5,
                    "n {n} ({x}, {y}): {} against {sum}",
                    moments.centroid
                );
            }
        }
    }
}
