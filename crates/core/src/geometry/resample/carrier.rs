//! Carries texels to a target: outlines that are flat there are rasterised over its texels.

use super::BLOCK;
use super::chart::{Chart, Piece};
use super::plane::Plane;
use crate::geometry::overlap::{Share, scale_to};
use crate::sphere::grid::Grid;
use crate::sphere::map::Place;
use glam::DVec2;
use std::ops::Range;

/// Flatness tolerance: distance of a texel's centre from the mean of its corners, in target texels.
const BEND: f64 = 0.02;

/// Greatest error of interpolated corners at the points that are checked, in target texels: a twentieth of
/// [`BEND`].
const OFF: f64 = 0.001;

/// Numbers of a block's texels, by row and column; `None` for those not carried.
pub(super) type Numbers = [[Option<u32>; BLOCK as usize]; BLOCK as usize];

/// Up to [`BLOCK`] x [`BLOCK`] texels.
#[derive(Clone, Copy)]
pub(super) struct Block {
    /// The first corner, in texels.
    pub(super) low: DVec2,
    /// Columns and rows.
    pub(super) count: [u32; 2],
}

impl Block {
    /// The part of the plane that it covers.
    pub(super) fn piece(self) -> Piece {
        Piece { low: self.low, high: self.low + DVec2::from(self.count.map(f64::from)) }
    }

    /// The first corner of the texel in column `x`, row `y`.
    pub(super) fn corner(self, x: u32, y: u32) -> DVec2 {
        self.low + DVec2::new(f64::from(x), f64::from(y))
    }
}

/// Least and greatest number of quarterings of a texel, one of `from` on the sphere, whose outline is not
/// flat: down to parts of 1/32 of its edge, or of 1/8 of the edge of one of `to`. Parts on a seam are
/// assigned by their centre.
pub(super) fn quarterings(from: usize, to: usize) -> Range<u32> {
    let halvings = |count: usize| (count as f64 / from as f64).sqrt().log2().ceil().max(0.0) as u32;
    // Larger parts may look flat because their corners coincide, as at a pole.
    halvings(SMALL)..5.max(3 + halvings(to))
}

/// Number of small texels on the sphere.
const SMALL: usize = 1024;

/// Positions of a part's corners in the target, clockwise; `None` for a corner outside the chart.
type Corners = [Option<Place>; 4];

/// Carries texels of one chart.
pub(super) struct Carrier<'a, C> {
    pub(super) chart: C,
    plane: Plane<'a>,
    quarterings: Range<u32>,
}

impl<'a, C: Chart> Carrier<'a, C> {
    /// Quarters texels by `quarterings`.
    pub(super) fn new(chart: C, target: &'a Grid, quarterings: Range<u32>) -> Self {
        Self { chart, plane: Plane::new(target), quarterings }
    }

    fn place(&self, at: DVec2) -> Option<Place> {
        self.chart.direction(at).map(|direction| self.plane.locate(direction))
    }

    /// Appends the shares of the texels of `block` with `numbers`, each on its own.
    pub(super) fn singly(&mut self, block: Block, numbers: &Numbers, shares: &mut Vec<Share>) {
        let [columns, rows] = block.count;
        let line = |carrier: &Self, y: u32| -> Vec<Option<Place>> {
            (0..=columns).map(|x| carrier.place(block.corner(x, y))).collect()
        };
        let mut above = line(self, 0);
        for y in 0..rows {
            let below = line(self, y + 1);
            for (x, number) in (0..columns).zip(numbers[y as usize]) {
                let Some(number) = number else { continue };
                let corner = block.corner(x, y);
                let weight = self.chart.weight(corner);
                if weight <= 0.0 {
                    continue;
                }
                let k = x as usize;
                let corners = [above[k], above[k + 1], below[k + 1], below[k]];
                let start = shares.len();
                self.carry(Piece::texel(corner), corners, 0, number, shares);
                if shares.len() == start
                    && let Some(place) = corners.into_iter().flatten().next()
                {
                    // The chart has less than the smallest parts of the texel.
                    let target = self.plane.index(place.component, self.plane.in_texels(place));
                    shares.push(Share { target, source: number, solid_angle: weight as f32 });
                }
                scale_to(weight, &mut shares[start..]);
            }
            above = below;
        }
    }

    /// Appends the shares of the texels of `block` with `numbers` if the mapping is smooth there: nine points
    /// give their corners by quadratic interpolation, four more confirm it. Returns whether it is.
    pub(super) fn at_once(&mut self, block: Block, numbers: &Numbers, shares: &mut Vec<Share>) -> bool {
        if self.quarterings.start > 0 {
            return false;
        }
        let extent = DVec2::from(block.count.map(f64::from));
        let mut component = None;
        let mut at = |s: f64, t: f64| {
            let place = self.place(block.low + extent * DVec2::new(s, t))?;
            (*component.get_or_insert(place.component) == place.component)
                .then(|| self.plane.in_texels(place))
        };
        let mut nodes = [[DVec2::ZERO; 3]; 3];
        for (row, t) in nodes.iter_mut().zip([0.0, 0.5, 1.0]) {
            for (node, s) in row.iter_mut().zip([0.0, 0.5, 1.0]) {
                let Some(found) = at(s, t) else { return false };
                *node = found;
            }
        }
        for (s, t) in [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)] {
            let Some(found) = at(s, t) else { return false };
            let row = nodes.map(|row| quadratic(row, s));
            if (quadratic(row, t) - found).abs().max_element() > OFF {
                return false;
            }
        }
        // A texel's share of the block's second differences; `carry` has the same limits.
        let second = |a: DVec2, b: DVec2, c: DVec2| (a - 2.0 * b + c).abs() * 4.0;
        let mut bend = DVec2::ZERO;
        for k in 0..3 {
            let along = second(nodes[k][0], nodes[k][1], nodes[k][2]) / (extent.x * extent.x);
            let across = second(nodes[0][k], nodes[1][k], nodes[2][k]) / (extent.y * extent.y);
            bend = bend.max((along + across) / 8.0);
        }
        let [[a, .., b], _, [d, .., c]] = nodes;
        let twist = (a + c - b - d).abs() / (extent.x * extent.y);
        if bend.max_element() > BEND || twist.max_element() > 8.0 * BEND {
            return false;
        }
        let component = component.expect("points were found");
        let sides = self.plane.sides(component);
        let line = |y: u32| {
            let row = |k: usize| quadratic([nodes[0][k], nodes[1][k], nodes[2][k]], f64::from(y) / extent.y);
            let row = [row(0), row(1), row(2)];
            let mut line = [DVec2::ZERO; BLOCK as usize + 1];
            for (x, place) in (0..=block.count[0]).zip(&mut line) {
                *place = quadratic(row, f64::from(x) / extent.x).clamp(DVec2::ZERO, sides);
            }
            line
        };
        let [columns, rows] = block.count;
        let mut above = line(0);
        for y in 0..rows {
            let below = line(y + 1);
            // Texels of a row often weigh the same.
            let weight_at = |carrier: &Self, x: u32| carrier.chart.weight(block.corner(x, y));
            let of_row = weight_at(self, 0);
            let is_equal = |x: u32| (weight_at(self, x) / of_row - 1.0).abs() < 1e-12;
            let are_equal = is_equal(columns / 2) && is_equal(columns - 1);
            for (x, number) in (0..columns).zip(numbers[y as usize]) {
                let Some(number) = number else { continue };
                let weight = if are_equal { of_row } else { weight_at(self, x) };
                if weight > 0.0 {
                    let k = x as usize;
                    let outline = [above[k], above[k + 1], below[k + 1], below[k]];
                    self.plane.walk(component, outline, weight, number, shares);
                }
            }
            above = below;
        }
        true
    }

    /// Appends the shares of `part`, quartered `depth` times, in steradians up to the part's own error.
    fn carry(&mut self, part: Piece, corners: Corners, depth: u32, number: u32, shares: &mut Vec<Share>) {
        let middle = part.middle();
        let centre = self.place(middle);
        if depth >= self.quarterings.start
            && let [Some(a), Some(b), Some(c), Some(d)] = corners
            && let Some(centre) = centre
            && [a, b, c, d].iter().all(|corner| corner.component == centre.component)
        {
            let outline = [a, b, c, d].map(|place| self.plane.in_texels(place));
            let mean = (outline[0] + outline[1] + outline[2] + outline[3]) / 4.0;
            let off = (self.plane.in_texels(centre) - mean).abs().max_element();
            // Diagonals with equal centres may still cross a fold; then they differ in length.
            if off <= BEND
                && (outline[0] + outline[2] - outline[1] - outline[3]).abs().max_element() <= 8.0 * BEND
            {
                let size = self.chart.size_of(part);
                return self.plane.walk(centre.component, outline, size, number, shares);
            }
        }
        if depth == self.quarterings.end {
            if let Some(place) = centre {
                let target = self.plane.index(place.component, self.plane.in_texels(place));
                let solid_angle = self.chart.size_of(part) as f32;
                shares.push(Share { target, source: number, solid_angle });
            }
            return;
        }
        let [top, right, bottom, left] = [
            DVec2::new(middle.x, part.low.y),
            DVec2::new(part.high.x, middle.y),
            DVec2::new(middle.x, part.high.y),
            DVec2::new(part.low.x, middle.y),
        ]
        .map(|at| self.place(at));
        let quarter = |low: DVec2, high: DVec2| Piece { low, high };
        let [a, b, c, d] = corners;
        let parts = [
            (quarter(part.low, middle), [a, top, centre, left]),
            (
                quarter(DVec2::new(middle.x, part.low.y), DVec2::new(part.high.x, middle.y)),
                [top, b, right, centre],
            ),
            (quarter(middle, part.high), [centre, right, c, bottom]),
            (
                quarter(DVec2::new(part.low.x, middle.y), DVec2::new(middle.x, part.high.y)),
                [left, centre, bottom, d],
            ),
        ];
        for (part, corners) in parts {
            self.carry(part, corners, depth + 1, number, shares);
        }
    }
}

/// The parabola through `nodes` at 0, 1/2 and 1.
#[inline]
fn quadratic([a, b, c]: [DVec2; 3], t: f64) -> DVec2 {
    a + (b - a) * (2.0 * t) + (a - 2.0 * b + c) * (t * (2.0 * t - 1.0))
}
