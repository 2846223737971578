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
pub(crate) const CONE_REACH: f64 = 0.475;

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

    /// The point of the triangle at column `i`, row `j`, between nodes too.
    #[must_use]
    pub fn point(self, [i, j]: [f64; 2]) -> DVec2 {
        let most = self.intervals() as f64;
        match self {
            Self::Triangle => DVec2::new(i + j, i - j) / (2.0 * most),
            Self::Cone => {
                let (e, a) = (i * i.max(1.0), j * i.max(1.0));
                let scale = CONE_REACH / (most * most);
                DVec2::X + scale * DVec2::new(-e - a, e - a) / 2.0
            }
        }
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

    /// Which of the sides v = 0, u = v and u + v = 1 node (`i`, `j`) lies on.
    #[must_use]
    pub const fn sides(self, i: usize, j: usize) -> [bool; 3] {
        match self {
            Self::Triangle => [i == j, j == 0, i == self.intervals()],
            Self::Cone => [i == j, false, j == 0],
        }
    }

    /// Node (`i`, `j`), or `None` beyond the grid.
    fn node_at(self, i: Option<usize>, j: Option<usize>) -> Option<(usize, usize)> {
        let (i, j) = (i?, j?);
        (i <= self.intervals() && j <= i).then_some((i, j))
    }

    /// The up to six nodes next to node (`i`, `j`).
    pub fn neighbours(self, i: usize, j: usize) -> impl Iterator<Item = (usize, usize)> {
        let around = [(-1, -1), (-1, 0), (0, -1), (0, 1), (1, 0), (1, 1)];
        around
            .into_iter()
            .filter_map(move |(di, dj)| self.node_at(i.checked_add_signed(di), j.checked_add_signed(dj)))
    }

    /// The up to six cells around node (`i`, `j`), each by its other two nodes.
    pub(crate) fn cells_around(
        self,
        i: usize,
        j: usize,
    ) -> impl Iterator<Item = ((usize, usize), (usize, usize))> {
        let around = [(1_isize, 0_isize), (1, 1), (0, 1), (-1, 0), (-1, -1), (0, -1)];
        let at = move |k: usize| {
            let (di, dj) = around[k % 6];
            self.node_at(i.checked_add_signed(di), j.checked_add_signed(dj))
        };
        (0..6).filter_map(move |k| at(k).zip(at(k + 1)))
    }
}
