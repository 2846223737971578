//! The triangle of directions u >= v >= 0, u + v <= 1, to which the octahedral map's sixteen symmetries
//! reduce the sphere, and grids of nodes over it.

use glam::DVec2;

/// The symmetry of the unfolded plane that maps a point into the triangle.
#[derive(Clone, Copy, Debug)]
pub struct Fold {
    signs: DVec2,
    swapped: bool,
    reflected: bool,
}

/// The point of the triangle that is equivalent to `uv` in [-1, 1]^2, and the symmetry between them.
#[must_use]
pub fn triangle_from_oct(uv: DVec2) -> (DVec2, Fold) {
    let signs = DVec2::new(1.0_f64.copysign(uv.x), 1.0_f64.copysign(uv.y));
    let mut point = uv.abs();
    let swapped = point.y > point.x;
    if swapped {
        point = DVec2::new(point.y, point.x);
    }
    let reflected = point.x + point.y > 1.0;
    if reflected {
        point = DVec2::new(1.0 - point.y, 1.0 - point.x);
    }
    (point, Fold { signs, swapped, reflected })
}

impl Fold {
    /// Maps an offset in the triangle's plane to one around the original point.
    #[must_use]
    pub fn oct_from_triangle(self, offset: DVec2) -> DVec2 {
        let mut offset = offset;
        if self.reflected {
            offset = DVec2::new(-offset.y, -offset.x);
        }
        if self.swapped {
            offset = DVec2::new(offset.y, offset.x);
        }
        offset * self.signs
    }
}

/// Interpolation weights of a point: three nodes of the grid and their shares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridPoint {
    /// Nodes.
    pub nodes: [usize; 3],
    /// Their shares, which sum to 1.
    pub shares: [f64; 3],
}

/// A triangular grid: column i from 0 to the number of intervals, row j from 0 to i.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grid {
    /// The whole triangle: u + v and u - v are linear in column and row.
    Triangle,
    /// Its corner at the cone point (1, 0), in column 0. There the plane is a cone of 180 degrees, so that
    /// offsets of boxes grow with the root of the distance. Therefore e = 1 - u + v is quadratic in the
    /// column, and a = 1 - u - v linear in column and in row. In the cell at the cone point both are linear,
    /// so that radiance has no cusp there.
    Cone,
}

/// e at the outer side of [`Grid::Cone`]: the least that contains all directions within 0.3 of the cone
/// point, rounded up.
pub const CONE_REACH: f64 = 0.475;

/// Index of the node in column `i`, row `j` <= `i` of a grid.
#[must_use]
pub const fn node(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}

impl Grid {
    /// Intervals along a side.
    #[must_use]
    pub const fn intervals(self) -> usize {
        match self {
            Self::Triangle => 11,
            Self::Cone => 6,
        }
    }

    /// Number of nodes.
    #[must_use]
    pub const fn node_count(self) -> usize {
        node(self.intervals() + 1, 0)
    }

    /// Columns and rows of all nodes, by index.
    pub fn nodes(self) -> impl Iterator<Item = (usize, usize)> {
        (0..=self.intervals()).flat_map(|i| (0..=i).map(move |j| (i, j)))
    }

    /// Column and row of a point of the triangle.
    fn coordinates(self, point: DVec2) -> [f64; 2] {
        let most = self.intervals() as f64;
        let at = match self {
            Self::Triangle => [point.x + point.y, point.x - point.y].map(|value| value * most),
            Self::Cone => {
                let scale = CONE_REACH / (most * most);
                let [e, a] = [1.0 - point.x + point.y, 1.0 - point.x - point.y].map(|value| value / scale);
                let stretch = e.max(1.0).sqrt();
                [e / stretch, a / stretch]
            }
        };
        at.map(|value| value.clamp(0.0, most))
    }

    /// The nodes around `point` of the triangle. Cells are split from the node of least column and row.
    #[must_use]
    pub fn place(self, point: DVec2) -> GridPoint {
        let [p, q] = self.coordinates(point);
        let cell = |value: f64| (value as usize).min(self.intervals() - 1);
        let i = cell(p);
        let j = cell(q).min(i);
        let (p, q) = (p - i as f64, q - j as f64);
        if q <= p || i == j {
            let q = q.min(p);
            GridPoint { nodes: [node(i, j), node(i + 1, j), node(i + 1, j + 1)], shares: [1.0 - p, p - q, q] }
        } else {
            GridPoint { nodes: [node(i, j), node(i, j + 1), node(i + 1, j + 1)], shares: [1.0 - q, q - p, p] }
        }
    }
}
