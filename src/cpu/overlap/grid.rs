//! Walks polygons over a target's grid: area and first moments of every texel met, by Green's theorem.

use super::index::{self, Target};
use glam::{DMat3, DVec2, DVec3};

/// Overlaps smaller than this share of their polygon are rounding, not area.
const NEGLIGIBLE: f64 = 1e-11;

/// Area and first moments of a grid cell's overlap, and what the cells to its right inherit.
#[derive(Clone, Copy, Default)]
struct Accumulator {
    area: f64,
    moment: DVec2,
    cover: f64,
    cover_moment: f64,
}

/// Carries polygons of an octant to a target's texels; keeps its buffers between calls.
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

    /// Calls `emit` with every texel that the polygon `corners` (points of the mirrored octant, any length, in order)
    /// meets and the solid angle of the overlap. `octant` says which octant it was mirrored from.
    pub(super) fn walk(&mut self, corners: &[DVec3], octant: usize, mut emit: impl FnMut(u32, f32)) {
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
                walk_outline(&self.outline, &mut self.window, |x, y, area, centroid| {
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
                    walk_outline(&self.outline, &mut self.window, |i, j, area, centroid| {
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
    clip_by(corners, depths[0], first);
    clip_by(first, depths[1], second);
    (second.len() >= 3).then_some(second)
}

/// Sutherland and Hodgman: the part of a polygon where `depth` is not negative.
fn clip_by(corners: &[DVec3], depth: impl Fn(DVec3) -> f64, out: &mut Vec<DVec3>) {
    out.clear();
    for (k, &a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % corners.len()];
        let (depth_a, depth_b) = (depth(a), depth(b));
        if depth_a >= 0.0 {
            out.push(a);
        }
        if (depth_a > 0.0 && depth_b < 0.0) || (depth_a < 0.0 && depth_b > 0.0) {
            out.push(a.lerp(b, depth_a / (depth_a - depth_b)));
        }
    }
}

/// Cuts polygons anywhere on the sphere into octants; keeps its buffers between calls.
#[derive(Default)]
pub(super) struct OctantClipper {
    turned: Vec<DVec3>,
    buffers: [Vec<DVec3>; 2],
}

impl OctantClipper {
    /// Calls `visit` with every octant that the polygon `corners`, turned by `turn`, meets, and its part there,
    /// mirrored to x, y, z >= 0. The polygon must be smaller than a hemisphere.
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
                    clip_by(current, |c| c[axis], other);
                    std::mem::swap(current, other);
                }
            }
            if current.len() >= 3 {
                visit(octant, current);
            }
        }
    }
}

/// Calls `emit` with every grid cell (x, y) that `outline` meets, the overlap's area and its centroid.
fn walk_outline(
    outline: &[DVec2],
    window: &mut Vec<Accumulator>,
    mut emit: impl FnMut(u32, u32, f64, DVec2),
) {
    let (mut low, mut high) = (outline[0], outline[0]);
    for &p in outline {
        low = low.min(p);
        high = high.max(p);
    }
    let (origin, far) = (low.floor(), high.floor());
    // One column more takes the cover that leaves the window on the right.
    let width = (far.x - origin.x) as usize + 2;
    let height = (far.y - origin.y) as usize + 1;
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
    // Edges going down (growing y) have the inside counted to their right: positive for one orientation only.
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
                let corner = origin + DVec2::new(x as f64, y as f64);
                let centroid = corner + (moment / area).clamp(DVec2::ZERO, DVec2::ONE);
                emit(corner.x as u32, corner.y as u32, area, centroid);
            }
        }
    }
}

/// Adds one edge: cut at the grid lines, every piece counts the area between it and its cell's right side, and covers
/// the cells further right.
fn walk_edge(from: DVec2, to: DVec2, width: usize, window: &mut [Accumulator]) {
    if from.y == to.y {
        return;
    }
    let slope = (to.x - from.x) / (to.y - from.y);
    let down = to.y > from.y;
    let mut a = from;
    loop {
        // The piece of the edge inside one grid row.
        let row = if down { a.y.floor() } else { a.y.ceil() - 1.0 };
        let limit = if down { row + 1.0 } else { row };
        let last = if down { to.y <= limit } else { to.y >= limit };
        let b = if last { to } else { DVec2::new(from.x + (limit - from.y) * slope, limit) };
        walk_row(a, b, row, width, window);
        if last {
            break;
        }
        a = b;
    }
}

/// The part of an edge inside one grid row, cut at the columns.
fn walk_row(from: DVec2, to: DVec2, row: f64, width: usize, window: &mut [Accumulator]) {
    let line = &mut window[row as usize * width..][..width];
    let right = to.x > from.x;
    let mut a = from;
    loop {
        let column = if right || from.x == to.x { a.x.floor() } else { (a.x.ceil() - 1.0).max(0.0) };
        let limit = if right { column + 1.0 } else { column };
        let last = from.x == to.x || if right { to.x <= limit } else { to.x >= limit };
        let b = if last {
            to
        } else {
            DVec2::new(limit, from.y + (to.y - from.y) * ((limit - from.x) / (to.x - from.x)))
        };
        let (p, q) = (a - DVec2::new(column, row), b - DVec2::new(column, row));
        let dy = q.y - p.y;
        let cell = &mut line[column as usize];
        cell.area += dy * (1.0 - (p.x + q.x) / 2.0);
        cell.moment.x += dy * (0.5 - (p.x * p.x + p.x * q.x + q.x * q.x) / 6.0);
        let y_times_x = (2.0 * p.y * p.x + p.y * q.x + q.y * p.x + 2.0 * q.y * q.x) / 6.0;
        let y_mean = (p.y + q.y) / 2.0;
        cell.moment.y += dy * (y_mean - y_times_x);
        let next = &mut line[column as usize + 1];
        next.cover += dy;
        next.cover_moment += dy * y_mean;
        if last {
            break;
        }
        a = b;
    }
}
