//! Boxes on the tennis ball's two bordered rectangles.
//!
//! A panel's coordinates are longitude and latitude of its own, and orthogonal: a box has the same length
//! along both on the sphere, the root of the solid angle. The seam curves through the rectangle, so boxes
//! across it cannot be cut into boxes of the other panel. Instead the panel's coordinates continue: texels
//! outside the domain and in a border around the rectangle repeat the directions beyond the seam, and a box
//! is one read. The border is half of the widest box beyond the seam; nothing reads past it.

use super::charts::{Charts, Piece};
use glam::DVec2;
use octagloss_core::sphere::grid::Grid;
use octagloss_core::sphere::map::Place;
use octagloss_core::sphere::tennis_ball::seam;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// The two panels.
#[derive(Clone, Copy, Debug)]
pub(super) struct TennisBallCharts;

impl Charts for TennisBallCharts {
    fn name(&self) -> &'static str {
        "tennis-ball"
    }

    fn sides(&self, place: Place, solid_angle: f64) -> DVec2 {
        let side = solid_angle.sqrt();
        DVec2::new(side / place.uv.y.cos(), side)
    }

    fn border(&self, size: u32, solid_angle: f64) -> u32 {
        let per_unit = f64::from(size) / FRAC_PI_2;
        // A one-texel box is added in quadrature, see `boxes`.
        let half = |side: f64| 0.5 * (side * side * per_unit * per_unit + 1.0).sqrt();
        // Beyond the rectangle's long sides, and beyond its ends from every point of the seam.
        let mut widest = half(solid_angle.sqrt());
        let steps = 256;
        for k in 0..=steps {
            let phi = FRAC_PI_2 + FRAC_PI_4 * f64::from(k) / f64::from(steps);
            let side = solid_angle.sqrt() / seam(phi).cos();
            widest = widest.max(half(side) - (3.0 * FRAC_PI_4 - phi) * per_unit);
        }
        // One more texel for points between the steps, where the reach changes by less than a step.
        widest.ceil() as u32 + 1 + (FRAC_PI_4 * per_unit / f64::from(steps)).ceil() as u32
    }

    fn continued_solid_angle(&self, _: u32, low: DVec2, high: DVec2) -> f64 {
        // Over a pole of the panel's coordinates the latitude's cosine changes its sign.
        let band = |from: f64, to: f64| (to.sin() - from.sin()).abs();
        let pole = FRAC_PI_2.copysign(low.y + high.y);
        let bands = if low.y < pole && pole < high.y {
            band(low.y, pole) + band(pole, high.y)
        } else {
            band(low.y, high.y)
        };
        bands * (high.x - low.x)
    }

    fn split(&self, _: &Grid, piece: Piece, visit: &mut dyn FnMut(Piece)) {
        visit(piece);
    }
}
