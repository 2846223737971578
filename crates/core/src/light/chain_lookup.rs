//! Seamless bilinear look-ups of levels, and trilinear ones of chains.
//!
//! Cubes as defined by graphics APIs: interpolation across edges between the outermost texels of two faces;
//! at a corner, where three texels meet, the fourth sample is their mean. Panoramas wrap around and clamp at
//! the poles. Octahedral squares are folded: beyond an edge lies the same edge, reversed.

use crate::light::chain::Level;
use crate::light::environment::{Layout, Rgb};
use crate::sphere::cube::{Face, cube_from_direction, texel_around};
use crate::sphere::equirect::equirect_from_direction;
use crate::sphere::octahedral::{oct_from_direction, wrap_texel};
use glam::DVec3;

/// Texel indices for look-ups of a cube of fixed size.
#[derive(Clone, Debug)]
pub struct LevelLookup {
    size: usize,
    /// Per face, indices of the texels beyond its edges: above, below, left and right.
    beyond: Vec<u32>,
}

/// Maximum texels per look-up.
pub(crate) const MAX_TAPS: usize = 4;

/// Texels of one look-up and their weights, which sum to 1; unused entries have weight 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taps {
    /// Indices of a level's texels.
    pub texels: [u32; MAX_TAPS],
    /// Their weights.
    pub weights: [f64; MAX_TAPS],
    /// Number of used entries.
    pub count: usize,
}

impl LevelLookup {
    /// Prepares look-ups of levels with `size` texels per edge.
    pub fn new(size: u32) -> Self {
        let n = size as usize;
        let index = |place: usize| {
            let (face, edge, k) = (place / (4 * n), place / n % 4, (place % n) as i64);
            let end = i64::from(size);
            let (x, y) = [(k, -1), (k, end), (-1, k), (end, k)][edge];
            texel_around(size, Face::ALL[face], x, y) as u32
        };
        Self { size: n, beyond: (0..24 * n).map(index).collect() }
    }

    /// Index of the texel in column `i` and row `j` of `face`, counted from 1; 0 and one more than the size
    /// are beyond its edges. `None` for corners.
    pub(crate) fn texel(&self, face: Face, i: usize, j: usize) -> Option<u32> {
        let n = self.size;
        let beyond = |edge: usize, k: usize| Some(self.beyond[(4 * face.index() + edge) * n + k - 1]);
        match ((1..=n).contains(&i), (1..=n).contains(&j)) {
            (true, true) => Some(((face.index() * n + j - 1) * n + i - 1) as u32),
            (true, false) => beyond(usize::from(j > 0), i),
            (false, true) => beyond(2 + usize::from(i > 0), j),
            (false, false) => None,
        }
    }

    /// Texels read by a look-up along `direction` (any nonzero length).
    pub(crate) fn taps(&self, direction: DVec3) -> Taps {
        self.taps_at(cube_from_direction(direction))
    }

    /// Texels read by a look-up at (s, t) of a face.
    pub(crate) fn taps_at(&self, (face, s, t): (Face, f64, f64)) -> Taps {
        let n = self.size;
        let split = |x: f64| {
            let place = (x + 1.0) / 2.0 * n as f64 + 0.5;
            let low = (place.max(0.0) as usize).min(n);
            (low, place - low as f64)
        };
        let ((i, a), (j, b)) = (split(s), split(t));
        let square = [
            (self.texel(face, i, j), (1.0 - a) * (1.0 - b)),
            (self.texel(face, i + 1, j), a * (1.0 - b)),
            (self.texel(face, i, j + 1), (1.0 - a) * b),
            (self.texel(face, i + 1, j + 1), a * b),
        ];
        let missing: f64 = square.iter().filter(|(texel, _)| texel.is_none()).map(|(_, weight)| weight).sum();
        let mut taps = Taps { texels: [0; MAX_TAPS], weights: [0.0; MAX_TAPS], count: 0 };
        for (texel, weight) in square.into_iter().filter_map(|(texel, weight)| Some((texel?, weight))) {
            taps.texels[taps.count] = texel;
            taps.weights[taps.count] = weight + missing / 3.0;
            taps.count += 1;
        }
        taps
    }
}

impl Taps {
    /// The weighted mean of the texels, whose values `texel` gives by index.
    pub fn mean(&self, texel: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (place, weight) in self.texels.iter().zip(self.weights).take(self.count) {
            for (sum, value) in sum.iter_mut().zip(texel(*place as usize)) {
                *sum += weight * value;
            }
        }
        sum
    }
}

/// Bilinear look-ups of one level.
#[derive(Clone, Debug)]
pub struct SeamlessLevel<'a> {
    texels: &'a [Rgb],
    map: MapLookup,
}

/// Texel indices for look-ups of one layout.
#[derive(Clone, Debug)]
enum MapLookup {
    Cube(LevelLookup),
    /// Columns and rows.
    Panorama(u32, u32),
    /// Texels along an edge.
    Octahedral(u32),
}

impl MapLookup {
    fn taps(&self, direction: DVec3) -> Taps {
        match self {
            Self::Cube(lookup) => lookup.taps(direction),
            Self::Panorama(width, height) => {
                let (u, v) = equirect_from_direction(direction);
                bilinear(u * f64::from(*width), v * f64::from(*height), |x, y| {
                    let row = y.clamp(0, i64::from(*height) - 1) as u32;
                    row * width + x.rem_euclid(i64::from(*width)) as u32
                })
            }
            Self::Octahedral(size) => {
                let place = (oct_from_direction(direction) + 1.0) / 2.0 * f64::from(*size);
                bilinear(place.x, place.y, |x, y| {
                    let (x, y) = wrap_texel(*size, x, y);
                    y * size + x
                })
            }
        }
    }
}

/// The four texels around the point (`x`, `y`) of an image, in texels from its corner; `texel` gives the
/// index of a column and row, which may lie one outside.
pub(crate) fn bilinear(x: f64, y: f64, texel: impl Fn(i64, i64) -> u32) -> Taps {
    let (i, j) = ((x - 0.5).floor(), (y - 0.5).floor());
    let (a, b) = (x - 0.5 - i, y - 0.5 - j);
    let (i, j) = (i as i64, j as i64);
    Taps {
        texels: [texel(i, j), texel(i + 1, j), texel(i, j + 1), texel(i + 1, j + 1)],
        weights: [(1.0 - a) * (1.0 - b), a * (1.0 - b), (1.0 - a) * b, a * b],
        count: MAX_TAPS,
    }
}

impl<'a> SeamlessLevel<'a> {
    /// Prepares look-ups of `level`.
    pub fn new(level: &'a Level) -> Self {
        let map = match level.layout {
            Layout::Cube { size } => MapLookup::Cube(LevelLookup::new(size)),
            Layout::Panorama { width, height } => MapLookup::Panorama(width, height),
            Layout::Octahedral { size } => MapLookup::Octahedral(size),
        };
        Self { texels: &level.texels, map }
    }

    /// Radiance along `direction` (any nonzero length).
    pub fn radiance(&self, direction: DVec3) -> [f64; 3] {
        self.map.taps(direction).mean(|texel| self.texels[texel].map(f64::from))
    }
}

/// Trilinear look-ups of a whole chain.
#[derive(Clone, Debug)]
pub struct ChainLookup<'a> {
    levels: Vec<SeamlessLevel<'a>>,
}

impl<'a> ChainLookup<'a> {
    /// Prepares look-ups of `levels`.
    pub fn new(levels: &'a [Level]) -> Self {
        Self { levels: levels.iter().map(SeamlessLevel::new).collect() }
    }

    /// Trilinear look-up along `direction` at `lod`, clamped to the existing levels.
    pub fn read(&self, direction: DVec3, lod: f64) -> [f64; 3] {
        let lod = lod.clamp(0.0, (self.levels.len() - 1) as f64);
        let low = lod as usize;
        let share = lod - low as f64;
        let of = |level: usize| self.levels[level].radiance(direction);
        if share == 0.0 {
            return of(low);
        }
        let (low, high) = (of(low), of(low + 1));
        std::array::from_fn(|c| low[c] * (1.0 - share) + high[c] * share)
    }
}
