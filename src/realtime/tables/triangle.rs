//! The triangle of directions u >= v >= 0, u + v <= 1, to which the octahedral map's sixteen symmetries
//! reduce the sphere, and its grid.

use glam::DVec2;

/// Intervals of the grid along a side.
pub(crate) const INTERVALS: usize = 11;

/// Nodes of the grid.
pub const NODES: usize = (INTERVALS + 1) * (INTERVALS + 2) / 2;

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

/// Index of the node in column `i`, row `j` <= `i` of the grid: u + v = i/INTERVALS, u - v = j/INTERVALS.
#[must_use]
pub const fn node(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}

/// Columns and rows of all nodes, by index.
pub fn nodes() -> impl Iterator<Item = (usize, usize)> {
    (0..=INTERVALS).flat_map(|i| (0..=i).map(move |j| (i, j)))
}

/// The point of node (`i`, `j`).
#[must_use]
pub fn node_point(i: usize, j: usize) -> DVec2 {
    let (i, j) = (i as f64 / INTERVALS as f64, j as f64 / INTERVALS as f64);
    DVec2::new(i + j, i - j) / 2.0
}

/// The nodes around `point` of the triangle; each cell is split along the direction of v = 0.
#[must_use]
pub fn place(point: DVec2) -> GridPoint {
    let at = |value: f64| (value * INTERVALS as f64).clamp(0.0, INTERVALS as f64);
    let (p, q) = (at(point.x + point.y), at(point.x - point.y));
    let cell = |value: f64| (value as usize).min(INTERVALS - 1);
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
pub const fn sides(i: usize, j: usize) -> [bool; 3] {
    [i == j, j == 0, i == INTERVALS]
}

/// The up to six nodes next to node (`i`, `j`).
pub fn neighbours(i: usize, j: usize) -> impl Iterator<Item = (usize, usize)> {
    [(-1, -1), (-1, 0), (0, -1), (0, 1), (1, 0), (1, 1)].into_iter().filter_map(move |(di, dj)| {
        let (i, j) = (i.checked_add_signed(di)?, j.checked_add_signed(dj)?);
        (i <= INTERVALS && j <= i).then_some((i, j))
    })
}

/// The up to six cells around node (`i`, `j`), each by its other two nodes.
pub(crate) fn cells_around(i: usize, j: usize) -> impl Iterator<Item = ((usize, usize), (usize, usize))> {
    let around = [(1_isize, 0_isize), (1, 1), (0, 1), (-1, 0), (-1, -1), (0, -1)];
    let at = move |k: usize| {
        let (di, dj) = around[k % 6];
        let (i, j) = (i.checked_add_signed(di)?, j.checked_add_signed(dj)?);
        (i <= INTERVALS && j <= i).then_some((i, j))
    };
    (0..6).filter_map(move |k| at(k).zip(at(k + 1)))
}
