//! Rasterises polygons over a target's grid: area and first moments of every overlapped texel, by Green's
//! theorem.

use super::index::{self, Target};
use crate::sphere::clip;
use glam::{DMat3, DVec2, DVec3};

/// Smaller overlaps, as a share of their polygon, are rounding errors.
const NEGLIGIBLE: f64 = 1e-11;

/// Wider polygons on the octant's plane are halved: the error of the centroid rule is about half the square
/// of a piece's width.
const WIDEST: f64 = 1.0 / 40.0;

/// Area and first moments of a grid cell's overlap, and the cover passed to the cells on its right.
#[derive(Clone, Copy, Default)]
pub(in crate::geometry) struct Accumulator {
    area: f64,
    moment: DVec2,
    cover: f64,
    cover_moment: f64,
}

/// Maps polygons of an octant to a target's texels; reuses its buffers.
pub(super) struct Walker {
    target: Target,
    outline: Vec<DVec2>,
    clipped: [Vec<DVec3>; 2],
    window: Vec<Accumulator>,
}

impl Walker {
    pub(super) fn new(target: Target) -> Self {
        Self { target, outline: Vec::new(), clipped: [Vec::new(), Vec::new()], window: Vec::new() }
    }

    /// Calls `emit` with every texel that the polygon `corners` (points of the mirrored octant, any length,
    /// in order) overlaps, and the solid angle of the overlap. `octant` is the octant it was mirrored from.
    pub(super) fn walk(&mut self, corners: &[DVec3], octant: usize, emit: &mut impl FnMut(u32, f32)) {
        let (low, high) = extent(corners);
        let (extent, middle) = (high - low, (low + high) / 2.0);
        if extent.max_element() <= WIDEST {
            return self.walk_piece(corners, octant, emit);
        }
        // Halved by the plane through the octant's own axis that halves the longer side.
        let depth = |c: DVec3| {
            let sum = c.x + c.y + c.z;
            if extent.x >= extent.y { c.x - middle.x * sum } else { c.z - middle.y * sum }
        };
        for sign in [1.0, -1.0] {
            let mut half = Vec::with_capacity(corners.len() + 2);
            clip(corners, |c| sign * depth(c), &mut half);
            if half.len() >= 3 {
                self.walk(&half, octant, emit);
            }
        }
    }

    /// [`Walker::walk`] for a polygon of at most [`WIDEST`].
    fn walk_piece(&mut self, corners: &[DVec3], octant: usize, emit: &mut impl FnMut(u32, f32)) {
        match self.target {
            Target::Octahedral(n) => {
                let half = f64::from(n) / 2.0;
                let lower = octant & 2 != 0;
                self.outline.clear();
                self.outline.extend(corners.iter().map(|c| {
                    let p = *c / (c.x + c.y + c.z);
                    let folded = if lower { DVec2::new(1.0 - p.z, 1.0 - p.x) } else { DVec2::new(p.x, p.z) };
                    (folded + 1.0) * half
                }));
                walk_outline(&self.outline, &mut self.window, |x, y, overlap| {
                    let (area, centroid) = (overlap.area, overlap.centroid(x, y));
                    let uv = centroid / half - 1.0;
                    let p = if lower { DVec2::new(1.0 - uv.y, 1.0 - uv.x) } else { uv };
                    let y3 = 1.0 - p.x - p.y;
                    let squared = p.length_squared() + y3 * y3;
                    let solid_angle = area / (half * half * squared * squared.sqrt());
                    emit(index::octahedral_texel(n, octant, x.min(n - 1), y.min(n - 1)), solid_angle as f32);
                });
            }
            Target::Cube(n) => {
                let half = f64::from(n) / 2.0;
                for family in 0..3 {
                    let Some(piece) = clip_to_family(corners, family, &mut self.clipped) else { continue };
                    self.outline.clear();
                    self.outline.extend(piece.iter().map(|c| {
                        let st = match family {
                            0 => DVec2::new(c.z, c.y) / c.x,
                            1 => DVec2::new(c.x, c.z) / c.y,
                            _ => DVec2::new(c.x, c.y) / c.z,
                        };
                        (st + 1.0) * half
                    }));
                    walk_outline(&self.outline, &mut self.window, |i, j, overlap| {
                        let (area, centroid) = (overlap.area, overlap.centroid(i, j));
                        let squared = 1.0 + (centroid / half - 1.0).length_squared();
                        let solid_angle = area / (half * half * squared * squared.sqrt());
                        let texel = index::cube_texel(n, family, octant, i.min(n - 1), j.min(n - 1));
                        emit(texel, solid_angle as f32);
                    });
                }
            }
        }
    }
}

/// Minimum and maximum position of a polygon on the octant's plane, along x and z.
fn extent(corners: &[DVec3]) -> (DVec2, DVec2) {
    let on_plane = corners.iter().map(|c| DVec2::new(c.x, c.z) / (c.x + c.y + c.z));
    on_plane.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

/// The part of a polygon where the family's axis is the greatest; `None` where there is none.
fn clip_to_family<'a>(
    corners: &'a [DVec3],
    family: usize,
    buffers: &'a mut [Vec<DVec3>; 2],
) -> Option<&'a [DVec3]> {
    let depths: [fn(DVec3) -> f64; 2] = match family {
        0 => [|c| c.x - c.y, |c| c.x - c.z],
        1 => [|c| c.y - c.x, |c| c.y - c.z],
        _ => [|c| c.z - c.x, |c| c.z - c.y],
    };
    if depths.iter().any(|depth| corners.iter().all(|c| depth(*c) <= 0.0)) {
        return None;
    }
    if depths.iter().all(|depth| corners.iter().all(|c| depth(*c) >= 0.0)) {
        return Some(corners);
    }
    let [first, second] = buffers;
    clip(corners, depths[0], first);
    clip(first, depths[1], second);
    (second.len() >= 3).then_some(second)
}

/// Cuts polygons anywhere on the sphere into octants; reuses its buffers.
#[derive(Default)]
pub(super) struct OctantClipper {
    turned: Vec<DVec3>,
    buffers: [Vec<DVec3>; 2],
}

impl OctantClipper {
    /// Calls `visit` with every octant that the polygon `corners`, turned by `turn`, meets, and its part
    /// there, mirrored to x, y, z >= 0. The polygon must be smaller than a hemisphere.
    pub(super) fn clip(&mut self, corners: &[DVec3], turn: DMat3, mut visit: impl FnMut(usize, &[DVec3])) {
        self.turned.clear();
        self.turned.extend(corners.iter().map(|c| turn * *c));
        for octant in 0..8 {
            let signs = index::octant_signs(octant);
            let outside = |axis: usize| self.turned.iter().all(|c| c[axis] * signs[axis] <= 0.0);
            if (0..3).any(outside) {
                continue;
            }
            let [current, other] = &mut self.buffers;
            current.clear();
            current.extend(self.turned.iter().map(|c| *c * signs));
            for axis in 0..3 {
                if current.iter().any(|c| c[axis] < 0.0) {
                    clip(current, |c| c[axis], other);
                    std::mem::swap(current, other);
                }
            }
            if current.len() >= 3 {
                visit(octant, current);
            }
        }
    }
}

/// Overlap of a polygon with a grid cell.
#[derive(Clone, Copy)]
pub(in crate::geometry) struct CellOverlap {
    pub(in crate::geometry) area: f64,
    /// First moments about the cell's own corner.
    pub(super) moment: DVec2,
}

impl CellOverlap {
    /// The centroid, in cell (`x`, `y`).
    #[inline]
    pub(in crate::geometry) fn centroid(self, x: u32, y: u32) -> DVec2 {
        let inside = if self.area == 0.0 { DVec2::splat(0.5) } else { self.moment / self.area };
        DVec2::new(f64::from(x), f64::from(y)) + inside.clamp(DVec2::ZERO, DVec2::ONE)
    }
}

/// Calls `emit` with every grid cell (x, y) that `outline` meets and the overlap.
pub(in crate::geometry) fn walk_outline(
    outline: &[DVec2],
    window: &mut Vec<Accumulator>,
    mut emit: impl FnMut(u32, u32, CellOverlap),
) {
    let (mut low, mut high) = (outline[0], outline[0]);
    for &p in outline {
        low = low.min(p);
        high = high.max(p);
    }
    // Coordinates are not negative: casts round down.
    let (left, top) = (low.x as usize, low.y as usize);
    let origin = DVec2::new(left as f64, top as f64);
    if high.x as usize == left && high.y as usize == top {
        return emit(left as u32, top as u32, whole(outline, origin));
    }
    // An extra column receives the cover that leaves the window on the right.
    let width = high.x as usize - left + 2;
    let height = high.y as usize - top + 1;
    window.clear();
    window.resize(width * height, Accumulator::default());

    let mut area_twice = 0.0;
    let mut from = outline[outline.len() - 1] - origin;
    for &to in outline {
        let to = to - origin;
        area_twice += from.x * to.y - to.x * from.y;
        walk_edge(from, to, width, window);
        from = to;
    }
    let smallest = NEGLIGIBLE * area_twice.abs() / 2.0;
    // Edges with growing y count the area to their right, which is positive for one orientation only.
    let sign = if area_twice > 0.0 { -1.0 } else { 1.0 };

    for y in 0..height {
        let (mut cover, mut cover_moment) = (0.0, 0.0);
        for x in 0..width - 1 {
            let cell = window[y * width + x];
            cover += cell.cover;
            cover_moment += cell.cover_moment;
            let area = sign * (cell.area + cover);
            if area > smallest {
                let moment = (cell.moment + DVec2::new(cover / 2.0, cover_moment)) * sign;
                emit((left + x) as u32, (top + y) as u32, CellOverlap { area, moment });
            }
        }
    }
}

/// A polygon inside the cell at `origin`, from triangles around that.
fn whole(outline: &[DVec2], origin: DVec2) -> CellOverlap {
    let (mut area_twice, mut moment) = (0.0, DVec2::ZERO);
    let mut from = outline[outline.len() - 1] - origin;
    for &to in outline {
        let to = to - origin;
        let cross = from.x * to.y - to.x * from.y;
        area_twice += cross;
        moment += (from + to) * cross;
        from = to;
    }
    CellOverlap { area: area_twice.abs() / 2.0, moment: moment * (area_twice.signum() / 6.0) }
}

/// Adds one edge: cut at the grid lines, every piece counts the area between it and its cell's right side,
/// and covers the cells further right. Coordinates are within the window and not negative, so that casts
/// round down.
fn walk_edge(from: DVec2, to: DVec2, width: usize, window: &mut [Accumulator]) {
    if from.y == to.y {
        return;
    }
    let slope = (to.x - from.x) / (to.y - from.y);
    let down = to.y > from.y;
    let mut a = from;
    let mut row = if down { a.y as i64 } else { row_above(a.y) };
    loop {
        // The piece of the edge inside one grid row.
        let limit = (row + i64::from(down)) as f64;
        let last = if down { to.y <= limit } else { to.y >= limit };
        let b = if last { to } else { DVec2::new(from.x + (limit - from.y) * slope, limit) };
        walk_row(a, b, row as usize, width, window);
        if last {
            break;
        }
        a = b;
        row += if down { 1 } else { -1 };
    }
}

/// The cell that an edge enters when it leaves `at` towards smaller coordinates.
fn row_above(at: f64) -> i64 {
    let cell = at as i64;
    if cell as f64 == at { cell - 1 } else { cell }
}

/// The part of an edge inside one grid row, cut at the columns.
fn walk_row(from: DVec2, to: DVec2, row: usize, width: usize, window: &mut [Accumulator]) {
    let line = &mut window[row * width..][..width];
    let right = to.x >= from.x;
    let mut a = from;
    let mut column = if right { a.x as i64 } else { row_above(a.x).max(0) };
    loop {
        let limit = (column + i64::from(right)) as f64;
        let last = if right { to.x <= limit } else { to.x >= limit };
        let b = if last {
            to
        } else {
            DVec2::new(limit, from.y + (to.y - from.y) * ((limit - from.x) / (to.x - from.x)))
        };
        let corner = DVec2::new(column as f64, row as f64);
        add_piece(a - corner, b - corner, &mut line[column as usize..column as usize + 2]);
        if last {
            break;
        }
        a = b;
        column += if right { 1 } else { -1 };
    }
}

/// One piece of an edge inside one cell, from `p` to `q` in the cell's own coordinates; `cells` are it and
/// the next.
#[inline]
fn add_piece(p: DVec2, q: DVec2, cells: &mut [Accumulator]) {
    let dy = q.y - p.y;
    let y_mean = (p.y + q.y) / 2.0;
    cells[0].area += dy * (1.0 - (p.x + q.x) / 2.0);
    cells[0].moment.x += dy * (0.5 - (p.x * p.x + p.x * q.x + q.x * q.x) / 6.0);
    let y_times_x = (2.0 * p.y * p.x + p.y * q.x + q.y * p.x + 2.0 * q.y * q.x) / 6.0;
    cells[0].moment.y += dy * (y_mean - y_times_x);
    cells[1].cover += dy;
    cells[1].cover_moment += dy * y_mean;
}
