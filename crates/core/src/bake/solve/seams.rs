//! Edges and corners of faces: what lies beyond them, and neighbours across them.

use super::grid::{Grid, MARGIN, MIN_CUBIC, Taps, VALUES, cubic_tap, linear_taps, read_row};
use crate::common::parallel;
use crate::light::chain_lookup::LevelLookup;
use crate::sphere::cube::{Face, cube_from_direction, cube_point};
use std::collections::BinaryHeap;
use std::iter::zip;

/// Difference of two neighbours, relative to the brighter, from which their order is kept entirely.
const TIE: f64 = 0.01;

/// Edge to which smaller levels are upsampled.
const FINE: usize = 16;

/// The places beyond the edges of faces, which hold neighbours' outermost texels, and those beyond corners,
/// which hold the mean of the three around.
pub(super) struct Seams {
    n: usize,
    lookup: LevelLookup,
    /// Place, and for each face that of the texel there with its face.
    edges: Vec<(usize, [(usize, usize); 6])>,
    /// Place, and the three around.
    corners: [(usize, [usize; 3]); 4],
}

impl Seams {
    pub(super) fn new(n: usize) -> Self {
        let lookup = LevelLookup::new(n as u32);
        let side = n + 2 * MARGIN;
        let at = |i: usize, j: usize| (j + 1) * side + i + 1;
        let source = |texel: u32| {
            let texel = texel as usize;
            (at(texel % n + 1, texel / n % n + 1), texel / (n * n))
        };
        let edge = |(i, j): (usize, usize)| {
            let texel = |face| source(lookup.texel(face, i, j).expect("no corner"));
            (at(i, j), Face::ALL.map(texel))
        };
        let edges = (1..=n).flat_map(|k| [(k, 0), (k, n + 1), (0, k), (n + 1, k)]).map(edge).collect();
        let ends = [(0, 1), (n + 1, n)];
        let corner = |k: usize| {
            let ((i, inner_i), (j, inner_j)) = (ends[k % 2], ends[k / 2]);
            (at(i, j), [at(inner_i, inner_j), at(i, inner_j), at(inner_i, j)])
        };
        Self { n, edges, corners: std::array::from_fn(corner), lookup }
    }

    /// Fills the places around the faces of `grid`.
    pub(super) fn fill(&self, grid: &mut Grid) {
        for (place, sources) in &self.edges {
            for (face, (source, other)) in sources.iter().enumerate() {
                for c in 0..3 {
                    grid.places[*place][3 * face + c] = grid.places[*source][3 * other + c];
                }
            }
        }
        for (place, around) in &self.corners {
            grid.places[*place] =
                std::array::from_fn(|l| around.iter().map(|k| grid.places[*k][l]).sum::<f32>() / 3.0);
        }
    }

    /// Adds what the places around the faces of `grid` hold to where [`Self::fill`] takes it from.
    pub(super) fn fold(&self, grid: &mut Grid) {
        for (place, around) in &self.corners {
            for (l, value) in grid.places[*place].into_iter().enumerate() {
                around.iter().for_each(|k| grid.places[*k][l] += value / 3.0);
            }
        }
        for (place, sources) in &self.edges {
            for (face, (source, other)) in sources.iter().enumerate() {
                for c in 0..3 {
                    grid.places[*source][3 * other + c] += grid.places[*place][3 * face + c];
                }
            }
        }
    }

    /// Calls `visit` with the places of the eight texels around place `k` on `face`, seven at corners, and
    /// their faces.
    fn for_each_neighbour(&self, k: usize, face: usize, mut visit: impl FnMut(usize, usize)) {
        let side = self.n + 2 * MARGIN;
        let (i, j) = (k % side - 1, k / side - 1);
        let inside = 2..self.n;
        if inside.contains(&i) && inside.contains(&j) {
            for row in [k - side, k, k + side] {
                (row - 1..=row + 1).filter(|other| *other != k).for_each(|other| visit(other, face));
            }
            return;
        }
        for (i, j) in (0..9).filter(|m| *m != 4).map(|m| (i + m % 3 - 1, j + m / 3 - 1)) {
            if let Some(texel) = self.lookup.texel(Face::ALL[face], i, j) {
                let texel = texel as usize;
                visit(self.place(texel), texel / (self.n * self.n));
            }
        }
    }

    /// The place of a texel.
    fn place(&self, texel: usize) -> usize {
        (texel / self.n % self.n + MARGIN) * (self.n + 2 * MARGIN) + texel % self.n + MARGIN
    }

    /// Restores the order of `sampled` in `solved`: the brighter of two neighbours stays no darker than the
    /// other. This adds no second maximum. Neighbours nearer than [`TIE`] are ordered in part, the less the
    /// nearer they are: otherwise rounding, which differs between engines, would decide about whole steps.
    pub(super) fn ordered(&self, sampled: &Grid, mut solved: Grid) -> Grid {
        self.fill(&mut solved);
        let disordered = self.disordered(sampled, &solved);
        let [raised, lowered] = [Change::Raise, Change::Lower].map(|change| {
            let mut changed = solved.clone();
            // Texels by their sampled values, the darkest first to be raised, the brightest to be lowered.
            let key = |value: f32, texel: u32| {
                let bits = if change == Change::Raise { !value.to_bits() } else { value.to_bits() };
                (u64::from(bits) << 32) | u64::from(texel)
            };
            let mut queued = vec![false; solved.places.len() * VALUES];
            let mut queue = BinaryHeap::new();
            for texel in disordered[change as usize].iter() {
                queued[*texel as usize] = true;
                queue.push(key(sampled.places.as_flattened()[*texel as usize], *texel));
            }
            while let Some(next) = queue.pop() {
                let texel = next as u32 as usize;
                let (k, face, c) = (texel / VALUES, texel % VALUES / 3, texel % 3);
                let own = sampled.places[k][texel % VALUES];
                let mut value = changed.places[k][texel % VALUES];
                self.for_each_neighbour(k, face, |other, face| {
                    let theirs = sampled.places[other][3 * face + c];
                    let (brighter, darker, sign) = match change {
                        Change::Raise => (own, theirs, 1.0),
                        Change::Lower => (theirs, own, -1.0),
                    };
                    if darker < brighter {
                        let share =
                            (f64::from(brighter - darker) / (TIE * f64::from(brighter))).min(1.0) as f32;
                        let step = (sign * (changed.places[other][3 * face + c] - value)).max(0.0);
                        value += sign * share * step;
                    }
                });
                changed.places[k][texel % VALUES] = value;
                self.for_each_neighbour(k, face, |other, face| {
                    let (at, theirs) = (other * VALUES + 3 * face + c, sampled.places[other][3 * face + c]);
                    let (follows, is_beyond) = match change {
                        Change::Raise => (theirs > own, value > changed.places[other][3 * face + c]),
                        Change::Lower => (theirs < own, value < changed.places[other][3 * face + c]),
                    };
                    if follows && is_beyond && !queued[at] {
                        queued[at] = true;
                        queue.push(key(theirs, at as u32));
                    }
                });
            }
            changed
        });
        for (k, place) in solved.places.iter_mut().enumerate() {
            for l in 0..VALUES {
                place[l] = ((f64::from(lowered.places[k][l]) + f64::from(raised.places[k][l])) / 2.0) as f32;
            }
        }
        solved
    }

    /// The values of `solved` below those of neighbours that are darker in `sampled`, and those above
    /// neighbours that are brighter; both grids are filled.
    fn disordered(&self, sampled: &Grid, solved: &Grid) -> [Vec<u32>; 2] {
        let side = sampled.side();
        let row = |j: usize| {
            let mut found = [Vec::new(), Vec::new()];
            for k in j * side + MARGIN..(j + 1) * side - MARGIN {
                let (own, value) = (&sampled.places[k], &solved.places[k]);
                let (mut low, mut high) = ([false; VALUES], [false; VALUES]);
                for row in [k - side, k, k + side] {
                    for other in row - 1..=row + 1 {
                        if self.corners.iter().any(|(corner, _)| *corner == other) {
                            continue;
                        }
                        let (others, values) = (&sampled.places[other], &solved.places[other]);
                        for l in 0..VALUES {
                            low[l] |= (others[l] < own[l]) & (values[l] > value[l]);
                            high[l] |= (others[l] > own[l]) & (values[l] < value[l]);
                        }
                    }
                }
                for (lanes, found) in zip([low, high], &mut found) {
                    found.extend((0..VALUES).filter(|l| lanes[*l]).map(|l| (k * VALUES + l) as u32));
                }
            }
            found
        };
        let rows = parallel::map(MARGIN..side - MARGIN, row);
        [0, 1].map(|change| rows.iter().flat_map(|row| &row[change]).copied().collect())
    }
}

/// How texels are ordered.
#[derive(Clone, Copy, PartialEq)]
enum Change {
    Raise,
    Lower,
}

impl Grid {
    /// Prepares cubic interpolation: fills the margin. Levels of too few texels are first interpolated
    /// linearly.
    pub(super) fn smooth(mut self) -> Self {
        if self.n < MIN_CUBIC {
            Seams::new(self.n).fill(&mut self);
            let taps = linear_taps(self.n, FINE);
            let (mut fine, mut blended, mut values) =
                (Self::black(FINE), Vec::new(), vec![[0.0; VALUES]; FINE]);
            let side = fine.side();
            for (tap, row) in zip(&taps, fine.places.chunks_mut(side).skip(MARGIN)) {
                read_row(&self, *tap, &taps, &mut blended, &mut values);
                zip(&mut row[MARGIN..], &values)
                    .for_each(|(place, value)| *place = value.map(|value| value as f32));
            }
            return fine.smooth();
        }
        let (n, side) = (self.n, self.side());
        let inside = MARGIN..n + MARGIN;
        // Extend the face's plane beyond its edges.
        let extended = |k: usize| {
            let centre = |k: usize| (2.0 * k as f64 - 3.0) / n as f64 - 1.0;
            let mut place = [0.0; VALUES];
            for (own, values) in Face::ALL.into_iter().zip(place.as_chunks_mut::<3>().0) {
                let point = cube_point(own, centre(k % side), centre(k / side));
                let (face, s, t) = cube_from_direction(point);
                // The neighbour's margin is not filled yet.
                let tap = |x: f64| cubic_tap((x + 1.0) / 2.0 * n as f64 + 0.5, (2, n - 2));
                *values = self.interpolated(face, tap(s), tap(t));
            }
            place
        };
        let is_outside = |k: &usize| !(inside.contains(&(k % side)) && inside.contains(&(k / side)));
        let margin: Vec<usize> = (0..side * side).filter(is_outside).collect();
        let places = parallel::values(margin.len(), |k| extended(margin[k]));
        margin.into_iter().zip(places).for_each(|(k, place)| self.places[k] = place);
        self
    }

    /// Value of `face` by the weights of four columns and rows.
    fn interpolated(&self, face: Face, (left, across): Taps<4>, (top, down): Taps<4>) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for (j, down) in (top..).zip(down) {
            for (place, across) in zip(&self.row(j)[left..], across) {
                for c in 0..3 {
                    sum[c] += down * across * f64::from(place[3 * face.index() + c]);
                }
            }
        }
        sum.map(|value| value as f32)
    }
}
