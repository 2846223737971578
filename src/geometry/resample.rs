//! Resamples between any two maps of the sphere by overlaps of their texels.
//!
//! A source texel's corners are mapped to the target's coordinates. The quadrilateral between them is
//! rasterised over the target's texels, which gives the overlap areas, and with the target's density the
//! solid angles. At kinks, seams and poles a texel is quartered until the mapping is flat or its parts are
//! negligible. Shares are scaled to the source texel's exact solid angle, which conserves energy; a target
//! texel is the mean over its shares, which reproduces constants. The remaining energy error, a few parts in
//! a million, is corrected by one factor a channel.

use super::overlap::walk_outline;
use crate::environment::Rgb;
use crate::sphere::grid::Grid;
use crate::sphere::map::{Place, Texel};
use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;
use std::ops::Range;

/// Flatness tolerance: distance of a texel's centre from the mean of its corners, in target texels.
const BEND: f64 = 0.02;

/// Maximum number of quarterings: parts are 1/32 of a texel. Parts on a seam are assigned by their centre.
const MOST_QUARTERINGS: u32 = 5;

/// Rows whose shared corners are computed once.
const BAND: u32 = 16;

/// Bands processed in parallel before their shares are summed; bounds memory.
const BANDS_AT_ONCE: usize = 16;

/// Overlap of source texel `source` with target texel `target`.
#[derive(Clone, Copy)]
struct Share {
    target: u32,
    source: u32,
    solid_angle: f32,
}

/// A texel or a part of one, from `low` to `high` in texels of its image.
#[derive(Clone, Copy)]
struct Piece {
    low: DVec2,
    high: DVec2,
}

/// Positions of a part's corners in the target, clockwise; `None` for a corner outside the source's domain.
type Corners = [Option<Place>; 4];

/// Maps texels of one component of the source to the target.
struct Carrier<'a> {
    source: &'a Grid,
    target: &'a Grid,
    world_from_source: DMat3,
    component: u32,
    /// Of the source component: least coordinates, a texel's extent, columns and rows.
    frame: (DVec2, DVec2, DVec2),
    /// Of every target component: least coordinates, texels per unit, columns and rows, first texel.
    frames: Vec<(DVec2, DVec2, [u32; 2], usize)>,
    window: Vec<super::overlap::Accumulator>,
}

/// The radiance of `texels` of `source`, turned into the world by `world_from_source`, over every texel of
/// `target`: the mean over the overlaps with the part of the target texel in its domain. Texels outside the
/// domain follow the target's continuation.
///
/// # Panics
/// If the number of `texels` is not that of `source`.
#[must_use]
pub fn resample(source: &Grid, texels: &[Rgb], world_from_source: DMat3, target: &Grid) -> Vec<Rgb> {
    assert_eq!(texels.len(), source.texel_count(), "texels of the source");
    let mut sums = vec![[0.0_f64; 4]; target.texel_count()];
    let bands: Vec<(u32, Range<u32>)> = (0..source.map().components())
        .flat_map(|component| {
            let rows = source.sides(component)[1];
            (0..rows).step_by(BAND as usize).map(move |row| (component, row..(row + BAND).min(rows)))
        })
        .collect();
    for some in bands.chunks(BANDS_AT_ONCE) {
        let shares: Vec<Vec<Share>> = some
            .par_iter()
            .map(|(component, rows)| {
                Carrier::new(source, target, world_from_source, *component).band(rows.clone())
            })
            .collect();
        for share in shares.iter().flatten() {
            let weight = f64::from(share.solid_angle);
            let radiance = texels[share.source as usize];
            let sum = &mut sums[share.target as usize];
            for (sum, value) in sum.iter_mut().zip(radiance) {
                *sum += weight * f64::from(value);
            }
            sum[3] += weight;
        }
    }
    let look = |direction: DVec3| {
        texels[source.index(source.texel_from_direction(world_from_source.transpose() * direction))]
    };
    // Correct the energy error of each channel from rounding and curvature by one factor.
    let places: Vec<Texel> = target.texels().collect();
    let energies = |[r, g, b, weight]: [f64; 4], texel: Texel| {
        let mean = if weight > 0.0 { target.solid_angle(texel) / weight } else { 0.0 };
        [[r, g, b], [r * mean, g * mean, b * mean]]
    };
    let totals: Vec<[[f64; 3]; 2]> = sums
        .par_chunks(1 << 14)
        .zip(places.par_chunks(1 << 14))
        .map(|(sums, places)| {
            let all = sums.iter().zip(places).map(|(sums, texel)| energies(*sums, *texel));
            all.fold([[0.0; 3]; 2], add)
        })
        .collect();
    let [arrived, held] = totals.into_iter().fold([[0.0; 3]; 2], add);
    let scale: [f64; 3] = std::array::from_fn(|c| if held[c] > 0.0 { arrived[c] / held[c] } else { 1.0 });
    sums.into_par_iter()
        .zip(places)
        .map(|(sums, texel)| {
            if sums[3] > 0.0 {
                std::array::from_fn(|c| (sums[c] / sums[3] * scale[c]) as f32)
            } else {
                look(target.direction_from_texel(texel))
            }
        })
        .collect()
}

fn add(sum: [[f64; 3]; 2], term: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    std::array::from_fn(|k| std::array::from_fn(|c| sum[k][c] + term[k][c]))
}

impl<'a> Carrier<'a> {
    fn new(source: &'a Grid, target: &'a Grid, world_from_source: DMat3, component: u32) -> Self {
        let frames = (0..target.map().components())
            .map(|k| {
                let rectangle = target.map().component(k);
                let step = target.step(&rectangle);
                (rectangle.low, DVec2::ONE / step, target.sides(k), target.first_texel(k))
            })
            .collect();
        let rectangle = source.map().component(component);
        let sides = DVec2::from(source.sides(component).map(f64::from));
        let frame = (rectangle.low, source.step(&rectangle), sides);
        Self { source, target, world_from_source, component, frame, frames, window: Vec::new() }
    }

    /// The shares of all texels of `rows`.
    fn band(mut self, rows: Range<u32>) -> Vec<Share> {
        let columns = self.source.sides(self.component)[0];
        let first = self.source.first_texel(self.component);
        let line = |carrier: &Self, y: u32| -> Vec<Option<Place>> {
            (0..=columns).map(|x| carrier.place(DVec2::new(f64::from(x), f64::from(y)))).collect()
        };
        let mut shares = Vec::new();
        let mut above = line(&self, rows.start);
        for y in rows {
            let below = line(&self, y + 1);
            for x in 0..columns {
                let low = DVec2::new(f64::from(x), f64::from(y));
                let part = Piece { low, high: low + 1.0 };
                let map = self.source.map();
                let solid_angle = map.solid_angle(self.component, self.uv(part.low), self.uv(part.high));
                if solid_angle <= 0.0 {
                    continue;
                }
                let k = x as usize;
                let corners = [above[k], above[k + 1], below[k + 1], below[k]];
                let start = shares.len();
                let source = u32::try_from(first + y as usize * columns as usize + k).expect("texels fit");
                self.carry(part, corners, 0, source, &mut shares);
                let sum: f64 = shares[start..].iter().map(|share| f64::from(share.solid_angle)).sum();
                let scale = (solid_angle / sum) as f32;
                shares[start..].iter_mut().for_each(|share| share.solid_angle *= scale);
            }
            above = below;
        }
        shares
    }

    /// Coordinates of `at`, in texels of the source's image.
    fn uv(&self, at: DVec2) -> DVec2 {
        let (low, step, _) = self.frame;
        low + step * at
    }

    /// Position of `at`, in texels of the source's image, in the target; `None` outside the source's domain.
    fn place(&self, at: DVec2) -> Option<Place> {
        let map = self.source.map();
        let uv = self.uv(at);
        let inside = map.contains(self.component, uv) || {
            // Points on the rectangle's own sides count as inside: nudge them towards the centre.
            let (.., sides) = self.frame;
            let on_side = at.cmpeq(DVec2::ZERO).any() || at.cmpeq(sides).any();
            on_side && map.contains(self.component, uv.lerp(self.uv(sides / 2.0), 1e-12))
        };
        inside.then(|| self.target.map().locate(self.world_from_source * map.direction(self.component, uv)))
    }

    /// `place` in texels of its image.
    fn in_texels(&self, place: Place) -> DVec2 {
        let (low, per_unit, [width, height], _) = self.frames[place.component as usize];
        ((place.uv - low) * per_unit).clamp(DVec2::ZERO, DVec2::new(f64::from(width), f64::from(height)))
    }

    /// Appends the shares of `part`, quartered `depth` times, in steradians up to the part's own error.
    fn carry(&mut self, part: Piece, corners: Corners, depth: u32, source: u32, shares: &mut Vec<Share>) {
        let middle = (part.low + part.high) / 2.0;
        let centre = self.place(middle);
        if let [Some(a), Some(b), Some(c), Some(d)] = corners
            && let Some(centre) = centre
            && [a, b, c, d].iter().all(|corner| corner.component == centre.component)
        {
            let outline = [a, b, c, d].map(|place| self.in_texels(place));
            let mean = (outline[0] + outline[1] + outline[2] + outline[3]) / 4.0;
            let off = (self.in_texels(centre) - mean).abs().max_element();
            // Diagonals with equal centres may still cross a fold; then they differ in length.
            if off <= BEND
                && (outline[0] + outline[2] - outline[1] - outline[3]).abs().max_element() <= 8.0 * BEND
            {
                return self.walk(centre.component, outline, self.size_of(part), source, shares);
            }
        }
        if depth == MOST_QUARTERINGS {
            if let Some(place) = centre {
                let at = self.in_texels(place);
                let target = self.index(place.component, at.x as u32, at.y as u32);
                shares.push(Share { target, source, solid_angle: self.size_of(part) as f32 });
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
            self.carry(part, corners, depth + 1, source, shares);
        }
    }

    /// Approximate solid angle of `part`: the density at its centre times its area.
    fn size_of(&self, part: Piece) -> f64 {
        let extent = part.high - part.low;
        let middle = (part.low + part.high) / 2.0;
        let (_, step, _) = self.frame;
        let area = extent * step;
        self.source.map().density(self.component, self.uv(middle)) * area.x * area.y
    }

    /// Appends the overlaps of the quadrilateral `outline` with the texels of `component`; they sum to
    /// `solid_angle`.
    fn walk(
        &mut self,
        component: u32,
        outline: [DVec2; 4],
        solid_angle: f64,
        source: u32,
        shares: &mut Vec<Share>,
    ) {
        let (low, per_unit, [width, height], first) = self.frames[component as usize];
        let texel = outline[0].floor();
        if outline.iter().all(|corner| corner.floor() == texel) {
            let target = self.index(component, texel.x as u32, texel.y as u32);
            return shares.push(Share { target, source, solid_angle: solid_angle as f32 });
        }
        let start = shares.len();
        let mut window = std::mem::take(&mut self.window);
        let map = self.target.map();
        walk_outline(&outline, &mut window, |x, y, overlap| {
            let uv = low + overlap.centroid(x, y) / per_unit;
            let (x, y) = (x.min(width - 1), y.min(height - 1));
            let target = u32::try_from(first + y as usize * width as usize + x as usize).expect("texels fit");
            let solid_angle = (overlap.area * map.density(component, uv)) as f32;
            shares.push(Share { target, source, solid_angle });
        });
        self.window = window;
        let sum: f64 = shares[start..].iter().map(|share| f64::from(share.solid_angle)).sum();
        if sum > 0.0 {
            let scale = (solid_angle / sum) as f32;
            shares[start..].iter_mut().for_each(|share| share.solid_angle *= scale);
        } else {
            // Negligible area: assign all of it to one texel.
            shares.truncate(start);
            let target = self.index(component, texel.x as u32, texel.y as u32);
            shares.push(Share { target, source, solid_angle: solid_angle as f32 });
        }
    }

    fn index(&self, component: u32, x: u32, y: u32) -> u32 {
        let (_, _, [width, height], first) = self.frames[component as usize];
        let at = y.min(height - 1) as usize * width as usize + x.min(width - 1) as usize;
        u32::try_from(first + at).expect("texels fit")
    }
}
