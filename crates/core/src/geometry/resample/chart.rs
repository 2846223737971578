//! Pieces of a source that are resampled: parts of the sphere on a plane that is cut into texels.

use crate::sphere::grid::Grid;
use glam::{DMat3, DVec2, DVec3};

/// A part of a plane, from `low` to `high` in texels.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    pub(super) low: DVec2,
    pub(super) high: DVec2,
}

impl Piece {
    /// The texel whose first corner is at `corner`.
    pub(super) fn texel(corner: DVec2) -> Self {
        Self { low: corner, high: corner + 1.0 }
    }

    pub(super) fn middle(self) -> DVec2 {
        (self.low + self.high) / 2.0
    }

    /// Corners, clockwise.
    pub(super) fn corners(self) -> [DVec2; 4] {
        let Self { low, high } = self;
        [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)]
    }
}

/// A plane whose points are directions.
pub(super) trait Chart {
    /// Direction at `at`, in texels, in the target's space; `None` outside the chart.
    fn direction(&self, at: DVec2) -> Option<DVec3>;

    /// The sum of the shares of the texel with its first corner at `corner`. By default all weigh the same.
    fn weight(&self, corner: DVec2) -> f64 {
        let _ = corner;
        1.0
    }

    /// Approximate solid angle of `part`; by default the area between its corners' directions.
    fn size_of(&self, part: Piece) -> f64 {
        match part.corners().map(|corner| self.direction(corner)) {
            [Some(a), Some(b), Some(c), Some(d)] => (c - a).cross(d - b).length() / 2.0,
            _ => 0.0,
        }
    }
}

/// A component's image and its continuation outside its domain.
pub(super) struct Continued<'a> {
    grid: &'a Grid,
    component: u32,
    low: DVec2,
    step: DVec2,
    /// Turns the component's map into the target's space.
    turn: DMat3,
}

impl<'a> Continued<'a> {
    pub(super) fn new(grid: &'a Grid, component: u32, turn: DMat3) -> Self {
        let rectangle = grid.map().component(component);
        Self { grid, component, low: rectangle.low, step: grid.step(&rectangle), turn }
    }

    fn uv(&self, at: DVec2) -> DVec2 {
        self.low + self.step * at
    }

    /// Direction at `at`, also outside the domain.
    pub(super) fn direction_anywhere(&self, at: DVec2) -> DVec3 {
        self.turn * self.grid.map().direction(self.component, self.uv(at))
    }
}

impl Chart for Continued<'_> {
    fn direction(&self, at: DVec2) -> Option<DVec3> {
        Some(self.direction_anywhere(at))
    }
}

/// The domain of a source's component. Texels weigh their exact solid angle.
pub(super) struct Domain<'a> {
    pub(super) image: Continued<'a>,
    sides: DVec2,
}

impl<'a> Domain<'a> {
    pub(super) fn new(grid: &'a Grid, component: u32, target_from_source: DMat3) -> Self {
        let sides = DVec2::from(grid.sides(component).map(f64::from));
        Self { image: Continued::new(grid, component, target_from_source), sides }
    }
}

impl Chart for Domain<'_> {
    fn direction(&self, at: DVec2) -> Option<DVec3> {
        let Continued { grid, component, .. } = self.image;
        let (map, uv) = (grid.map(), self.image.uv(at));
        let inside = map.contains(component, uv) || {
            // Points on the rectangle's own sides count as inside: nudge them towards the centre.
            let on_side = at.cmpeq(DVec2::ZERO).any() || at.cmpeq(self.sides).any();
            on_side && map.contains(component, uv.lerp(self.image.uv(self.sides / 2.0), 1e-12))
        };
        inside.then(|| self.image.direction_anywhere(at))
    }

    fn weight(&self, corner: DVec2) -> f64 {
        let Continued { grid, component, .. } = self.image;
        grid.map().solid_angle(component, self.image.uv(corner), self.image.uv(corner + 1.0))
    }

    fn size_of(&self, part: Piece) -> f64 {
        let Continued { grid, component, step, .. } = self.image;
        let area = (part.high - part.low) * step;
        grid.map().density(component, self.image.uv(part.middle())) * area.x * area.y
    }
}

/// A square of one texel around a direction, on the sphere's tangent plane.
pub(super) struct Around {
    middle: DVec3,
    /// Half of its sides.
    sides: [DVec3; 2],
}

impl Around {
    /// The square of `solid_angle`, up to the sphere's curvature, around the unit vector `middle`.
    pub(super) fn new(middle: DVec3, solid_angle: f64) -> Self {
        let (a, b) = middle.any_orthonormal_pair();
        let half = solid_angle.sqrt() / 2.0;
        Self { middle, sides: [a * half, b * half] }
    }
}

impl Chart for Around {
    fn direction(&self, at: DVec2) -> Option<DVec3> {
        let off = at * 2.0 - 1.0;
        Some((self.middle + self.sides[0] * off.x + self.sides[1] * off.y).normalize())
    }
}
