//! Interface of every map of the sphere: components, both direction maps, solid angles, and neighbours across
//! edges.

use glam::{DVec2, DVec3};
use std::fmt::Debug;

/// A flat rectangle that a map covers, wholly or in part, with directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// Minimum coordinates; row 0, column 0 of its image.
    pub low: DVec2,
    /// Maximum coordinates.
    pub high: DVec2,
    /// Columns and rows of its image, in units of the map's size.
    pub cells: [u32; 2],
    /// Its position in a picture of the whole map, from the top left, in the same units.
    pub at: [u32; 2],
}

impl Component {
    /// Width and height of the rectangle.
    #[must_use]
    pub fn extent(&self) -> DVec2 {
        self.high - self.low
    }

    /// Area of the rectangle.
    #[must_use]
    pub fn area(&self) -> f64 {
        let extent = self.extent();
        extent.x * extent.y
    }

    /// The square [-`half`, `half`]^2 as one cell at `at`.
    pub(super) const fn square(half: f64, at: [u32; 2]) -> Self {
        Self { low: DVec2::splat(-half), high: DVec2::splat(half), cells: [1, 1], at }
    }
}

/// A point of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Index of the component.
    pub component: u32,
    /// Coordinates in its rectangle.
    pub uv: DVec2,
}

/// A texel of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Texel {
    /// Index of the component.
    pub component: u32,
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
}

/// A map of the sphere onto one or more rectangles.
///
/// Each component's *domain* is the part of its rectangle that represents directions; domains cover the
/// sphere once. Components are numbered from 0; methods may panic for a missing component.
pub trait SphereMap: Debug + Sync {
    /// Number of components, at least 1.
    fn components(&self) -> u32 {
        1
    }

    /// Rectangle and image of component `index`; by default [-1, 1]^2, one beside another.
    fn component(&self, index: u32) -> Component {
        Component::square(1.0, [index, 0])
    }

    /// Whether `uv`, a point of the rectangle, is in the domain of `component`.
    fn contains(&self, component: u32, uv: DVec2) -> bool {
        let _ = (component, uv);
        true
    }

    /// Unit direction at `uv` of `component`. Outside the domain it continues as documented for the map, to
    /// fill borders.
    fn direction(&self, component: u32, uv: DVec2) -> DVec3;

    /// The place of `direction` (any length but zero), in a domain.
    fn locate(&self, direction: DVec3) -> Place;

    /// Steradians per unit of area at `uv`, a point of the domain of `component`.
    fn density(&self, component: u32, uv: DVec2) -> f64;

    /// Exact solid angle of the intersection of the domain of `component` with the rectangle from `low` to
    /// `high`, a part of the component's rectangle.
    fn solid_angle(&self, component: u32, low: DVec2, high: DVec2) -> f64;

    /// The texel at column `x`, row `y` of the image of `component`, also outside the image, in a map of
    /// `size`. `None` if the gluing does not map texels onto texels; borders are then resampled.
    fn wrap_texel(&self, size: u32, component: u32, x: i64, y: i64) -> Option<Texel> {
        let _ = (size, component, x, y);
        None
    }

    /// The place of the direction at `place` with its coordinate `axis` (0 to 2 for x to z) negated, and for
    /// places outside a domain the continuation's. `None` if the map lacks this symmetry, or its mirror
    /// image does not move rectangles as a whole or cut along lines between texels.
    fn mirrored(&self, place: Place, axis: usize) -> Option<Place> {
        let _ = (place, axis);
        None
    }
}
