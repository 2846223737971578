//! Stretch of maps of the sphere: singular values, sampling requirements, anisotropy, solid angles of texels.
//!
//! Herron, *The Tennis-ball Map*, section 4.1, after Snyder and Mitchell, *Sampling-Efficient Mapping of
//! Spherical Images* (2001). Measured numerically from a map's directions only.

use glam::{DVec2, DVec3};
use octagloss_core::sphere::map::SphereMap;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::PI;

/// Stretch of a map at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// The greater singular value of the Jacobian (equation 5): radians per unit of (u, v).
    pub greatest: f64,
    /// The lesser one.
    pub least: f64,
    /// The inverse length of the shortest vector of the lattice dual to that of texels of unit sides: the
    /// spacing of isotropic samples of the same resolution.
    pub spacing: f64,
}

impl Stretch {
    /// From the derivatives of the direction by u and v.
    pub fn from_derivatives(by_u: DVec3, by_v: DVec3) -> Self {
        let (a, b, c) = (by_u.length_squared(), by_u.dot(by_v), by_v.length_squared());
        let root = ((a - c) * (a - c) + 4.0 * b * b).sqrt();
        let greatest = ((a + c + root) / 2.0).sqrt();
        // Use the product of both, the area: the difference in equation 5 cancels if they differ much.
        let area = by_u.cross(by_v).length();
        let shortest = shortest_vector_squared(c, -b, a);
        Self { greatest, least: area / greatest, spacing: area / shortest.sqrt() }
    }

    /// At `uv` of `component`, by central differences of `step`; the map must be smooth within `step`.
    pub fn at(map: &dyn SphereMap, component: u32, uv: DVec2, step: f64) -> Self {
        let by = |way: DVec2| {
            (map.direction(component, uv + way * step) - map.direction(component, uv - way * step))
                / (2.0 * step)
        };
        Self::from_derivatives(by(DVec2::X), by(DVec2::Y))
    }

    /// Greater over lesser singular value, at least 1.
    pub fn anisotropy(&self) -> f64 {
        self.greatest / self.least
    }

    /// Steradians per unit of area.
    pub fn area(&self) -> f64 {
        self.greatest * self.least
    }
}

/// Smallest non-zero value of a x^2 + 2 b x y + c y^2 over integers, by Lagrange's reduction.
fn shortest_vector_squared(mut a: f64, mut b: f64, mut c: f64) -> f64 {
    // Each round at least halves c; a form elongated by 2^60 is degenerate.
    for _ in 0..60 {
        if a > c {
            (a, c) = (c, a);
        }
        let turns = (b / a).round();
        if turns == 0.0 || !turns.is_finite() {
            break;
        }
        c += turns * (turns * a - 2.0 * b);
        b -= turns * a;
    }
    a.min(c)
}

/// Metrics of a map over its whole domain. Infinite if the stretch is unbounded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Metrics {
    /// Equation 6, summed over components: area of the rectangle times the square of the greatest stretch.
    pub sampling: f64,
    /// Maximum ratio of the singular values.
    pub anisotropy: f64,
    /// Number of components; `None` for infinitely many.
    pub components: Option<u32>,
    /// As `sampling`, with [`Stretch::spacing`] instead of the greatest stretch: the requirement of ideal,
    /// possibly anisotropic reconstruction. At most `sampling`.
    pub lattice: f64,
    /// Minimum and maximum solid angle of a small texel in the domain, relative to 4 pi over the number of
    /// all texels (section 5.1 of the octahedron paper).
    pub relative_solid_angle: [f64; 2],
    /// Share of texels inside the domain.
    pub used: f64,
}

/// Cells of the grid of points along each side of a component. A multiple of 2 and 3: folds along diagonals
/// and axes pass through its corners, and so do the centres of octahedron faces.
const CELLS: u32 = 96;

/// Maximum and minimum values over a component.
#[derive(Clone, Copy, Debug)]
struct Extremes {
    greatest: f64,
    spacing: f64,
    anisotropy: f64,
    area: [f64; 2],
}

impl Extremes {
    const NONE: Self = Self { greatest: 0.0, spacing: 0.0, anisotropy: 1.0, area: [f64::INFINITY, 0.0] };

    fn of(stretch: Stretch) -> Self {
        let Stretch { greatest, spacing, .. } = stretch;
        Self { greatest, spacing, anisotropy: stretch.anisotropy(), area: [stretch.area(); 2] }
    }

    fn and(self, other: Self) -> Self {
        Self {
            greatest: self.greatest.max(other.greatest),
            spacing: self.spacing.max(other.spacing),
            anisotropy: self.anisotropy.max(other.anisotropy),
            area: [self.area[0].min(other.area[0]), self.area[1].max(other.area[1])],
        }
    }
}

/// Metrics of `map`.
///
/// Extremes lie in cell centres, on folds and on rims. Points are sampled near every grid corner, at two
/// distances, and in the cell centres; the limit is extrapolated. A value that doubles between the distances
/// is infinite.
pub fn measure(map: &dyn SphereMap) -> Metrics {
    let components: Vec<_> = (0..map.components()).map(|k| map.component(k)).collect();
    let cells: f64 = components.iter().map(|c| f64::from(c.cells[0] * c.cells[1])).sum();
    let mut metrics = Metrics {
        sampling: 0.0,
        anisotropy: 1.0,
        components: Some(map.components()),
        lattice: 0.0,
        relative_solid_angle: [f64::INFINITY, 0.0],
        used: 0.0,
    };
    for (component, index) in components.iter().zip(0..) {
        let [far, near] = [1e-3, 1e-4].map(|inset| extremes(map, index, inset));
        let limit = |value: fn(&Extremes) -> f64| {
            let (far, near) = (value(&far), value(&near));
            if near > 2.0 * far { f64::INFINITY } else { near + (near - far) / 9.0 }
        };
        metrics.sampling += component.area() * limit(|e| e.greatest).powi(2);
        metrics.lattice += component.area() * limit(|e| e.spacing).powi(2);
        metrics.anisotropy = metrics.anisotropy.max(limit(|e| e.anisotropy));
        let own_cells = f64::from(component.cells[0] * component.cells[1]);
        let per_texel = component.area() / own_cells * cells / (4.0 * PI);
        let [least, greatest] = &mut metrics.relative_solid_angle;
        *least = least.min(limit(|e| e.area[0]).max(0.0) * per_texel);
        *greatest = greatest.max(limit(|e| e.area[1]) * per_texel);
        metrics.used += used_share(map, index) * own_cells / cells;
    }
    metrics
}

/// Extremes of `component` over points at `inset` of a cell from the grid's corners, and over cell centres.
fn extremes(map: &dyn SphereMap, component: u32, inset: f64) -> Extremes {
    let rectangle = map.component(component);
    let cell = rectangle.extent() / f64::from(CELLS);
    // Near a cone point derivatives change over the distance to it.
    let step = cell.min_element() * inset / 100.0;
    // Different offsets avoid the diagonals. The last two approach a corner along a line of the grid: where
    // stretch depends on the direction of approach, it may be greatest along a fold.
    let (a, b) = (inset, 2.0 * inset);
    let (along, across) = (100.0 * inset, inset / 5.0);
    let offsets = [
        (a, b, step),
        (1.0 - b, a, step),
        (b, 1.0 - a, step),
        (1.0 - a, 1.0 - b, step),
        (0.5 + a, 0.5 + b, step),
        (along, across, step / 5.0),
        (across, along, step / 5.0),
    ];
    let around_corner = |k: u32| {
        let corner = DVec2::new(f64::from(k % CELLS), f64::from(k / CELLS));
        let stretches = offsets.into_iter().filter_map(|(right, down, step)| {
            let uv = rectangle.low + cell * (corner + DVec2::new(right, down));
            map.contains(component, uv).then(|| Extremes::of(Stretch::at(map, component, uv, step)))
        });
        stretches.fold(Extremes::NONE, Extremes::and)
    };
    (0..CELLS * CELLS).into_par_iter().map(around_corner).reduce(|| Extremes::NONE, Extremes::and)
}

/// Share of the rectangle of `component` in its domain, counted over 1024 x 1024 points.
fn used_share(map: &dyn SphereMap, component: u32) -> f64 {
    let rectangle = map.component(component);
    let n = 1024;
    let is_inside = |k: &u32| {
        let share = DVec2::new(f64::from(k % n) + 0.5, f64::from(k / n) + 0.5) / f64::from(n);
        map.contains(component, rectangle.low + rectangle.extent() * share)
    };
    (0..n * n).into_par_iter().filter(is_inside).count() as f64 / f64::from(n * n)
}
