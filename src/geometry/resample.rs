//! Resamples between any two maps of the sphere by overlaps of their texels.
//!
//! A source texel's corners are mapped to the target's coordinates. The quadrilateral between them is
//! rasterised over the target's texels, which gives the overlap areas, and with the target's density the
//! solid angles. Where the mapping is smooth the corners of a block of texels are interpolated from a few of
//! its points. At kinks, seams and poles a texel is quartered until the mapping is flat or its parts are
//! negligible. Shares are scaled to the source texel's exact solid angle, which conserves energy; a target
//! texel is the mean over its shares, which reproduces constants. The remaining energy error, a few parts in
//! a million, is corrected by one factor a channel.
//!
//! Where coordinate planes are mirrors of both maps, only the part of the sphere on their positive sides is
//! computed, an eighth at best: a share stands for as many shares as there are images of the part. Each image
//! has its own source texel, and its own sums in the target texel.

mod mirrors;
mod sums;

use super::overlap::walk_outline;
use crate::environment::Rgb;
use crate::sphere::grid::Grid;
use crate::sphere::map::{Place, Texel};
use glam::{DMat3, DVec2, DVec3};
use mirrors::{Mirrors, Side};
use rayon::prelude::*;
use std::ops::Range;
use sums::Sums;

/// Flatness tolerance: distance of a texel's centre from the mean of its corners, in target texels.
const BEND: f64 = 0.02;

/// Maximum number of quarterings: parts are 1/32 of a texel. Parts on a seam are assigned by their centre.
const MOST_QUARTERINGS: u32 = 5;

/// Texels along the edge of a block whose corners are interpolated.
const BLOCK: u32 = 8;

/// Greatest error of interpolated corners at the points that are checked, in target texels: a twentieth of
/// [`BEND`].
const OFF: f64 = 0.001;

/// Rows processed as one task.
const BAND: u32 = 16;

/// Bands processed in parallel before their shares are summed; bounds memory.
const BANDS_AT_ONCE: usize = 16;

/// Overlap of a source texel, by its number among those of a band, with target texel `target`.
#[derive(Clone, Copy)]
struct Share {
    target: u32,
    source: u32,
    solid_angle: f32,
}

/// Numbers of a block's texels, by row and column; `None` for those not computed.
type Sources = [[Option<u32>; BLOCK as usize]; BLOCK as usize];

/// Shares of the texels of some rows.
#[derive(Default)]
struct Band {
    shares: Vec<Share>,
    /// Images of each source texel, in the mirrors' order.
    sources: Vec<u32>,
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
    mirrors: &'a Mirrors,
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
    let mirrors = if world_from_source == DMat3::IDENTITY {
        Mirrors::shared(source, target)
    } else {
        Mirrors::default()
    };
    resample_by(&mirrors, source, texels, world_from_source, target)
        .or_else(|| resample_by(&Mirrors::default(), source, texels, world_from_source, target))
        .expect("without mirrors nothing is cut by them")
}

/// [`resample`] by `mirrors` of both grids. `None` if a mirror cuts texels of the source.
fn resample_by(
    mirrors: &Mirrors,
    source: &Grid,
    texels: &[Rgb],
    world_from_source: DMat3,
    target: &Grid,
) -> Option<Vec<Rgb>> {
    let mut sums = Sums::new(mirrors.images(), target.texel_count());
    let bands: Vec<(u32, Range<u32>)> = (0..source.map().components())
        .flat_map(|component| {
            let rows = source.sides(component)[1];
            (0..rows).step_by(BAND as usize).map(move |row| (component, row..(row + BAND).min(rows)))
        })
        .collect();
    for some in bands.chunks(BANDS_AT_ONCE) {
        let bands: Vec<Band> = some
            .par_iter()
            .map(|(component, rows)| {
                Carrier::new(source, target, world_from_source, *component, mirrors).band(rows.clone())
            })
            .collect::<Option<_>>()?;
        sums.add(&bands, texels);
    }
    let look = |texel: Texel| {
        let direction = world_from_source.transpose() * target.direction_from_texel(texel);
        texels[source.index(source.texel_from_direction(direction))]
    };
    sums.means(mirrors, target, look)
}

/// The parabola through `nodes` at 0, 1/2 and 1.
#[inline]
fn quadratic([a, b, c]: [DVec2; 3], t: f64) -> DVec2 {
    a + (b - a) * (2.0 * t) + (a - 2.0 * b + c) * (t * (2.0 * t - 1.0))
}

impl<'a> Carrier<'a> {
    fn new(
        source: &'a Grid,
        target: &'a Grid,
        world_from_source: DMat3,
        component: u32,
        mirrors: &'a Mirrors,
    ) -> Self {
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
        let window = Vec::new();
        Self { source, target, world_from_source, component, frame, frames, mirrors, window }
    }

    /// The shares of the texels of `rows` on the mirrors' positive sides; `None` if a mirror cuts a texel.
    fn band(mut self, rows: Range<u32>) -> Option<Band> {
        let columns = self.source.sides(self.component)[0];
        let mut band = Band::default();
        for top in rows.clone().step_by(BLOCK as usize) {
            for left in (0..columns).step_by(BLOCK as usize) {
                let low = [left, top];
                let high = [(left + BLOCK).min(columns), (top + BLOCK).min(rows.end)];
                let sources = self.sources(low, high, &mut band.sources)?;
                if sources.iter().flatten().all(Option::is_none) {
                    continue;
                }
                if !self.smooth_block(low, high, &sources, &mut band.shares) {
                    self.block(low, high, &sources, &mut band.shares);
                }
            }
        }
        Some(band)
    }

    /// Numbers of the texels from `low` to `high` that are on the mirrors' positive sides, by row and column;
    /// appends their images. `None` if a mirror cuts one of them.
    fn sources(&self, low: [u32; 2], high: [u32; 2], images: &mut Vec<u32>) -> Option<Sources> {
        let mut sources = Sources::default();
        let side = self.side_of_block(low, high);
        if side == Side::Behind {
            return Some(sources);
        }
        for (y, row) in (low[1]..high[1]).zip(&mut sources) {
            for (x, source) in (low[0]..high[0]).zip(row) {
                if side == Side::Unknown {
                    let is_behind = |dx: f64, dy: f64| {
                        let at = DVec2::new(f64::from(x) + dx, f64::from(y) + dy);
                        self.mirrors.is_behind(self.direction(at))
                    };
                    if is_behind(0.5, 0.5) {
                        continue;
                    }
                    if [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
                        .iter()
                        .any(|(dx, dy)| is_behind(*dx, *dy))
                    {
                        return None;
                    }
                }
                let texel = Texel { component: self.component, x, y };
                *source = Some((images.len() / self.mirrors.images()) as u32);
                self.mirrors.append(self.source, texel, images)?;
            }
        }
        Some(sources)
    }

    /// On which side of the mirrors the block from `low` to `high` lies, by nine of its points: farther from
    /// the mirrors than neighbours are from each other, they speak for what is between them.
    fn side_of_block(&self, low: [u32; 2], high: [u32; 2]) -> Side {
        if self.mirrors.images() == 1 {
            return Side::Ahead;
        }
        let [low, high] = [low, high].map(|at| DVec2::from(at.map(f64::from)));
        let node = |k: usize| {
            let share = DVec2::new((k % 3) as f64, (k / 3) as f64) / 2.0;
            self.direction(low + (high - low) * share)
        };
        let nodes: [DVec3; 9] = std::array::from_fn(node);
        let along = (0..9).filter(|k| k % 3 < 2).map(|k| nodes[k].distance(nodes[k + 1]));
        let across = (0..6).map(|k| nodes[k].distance(nodes[k + 3]));
        let spacing = along.chain(across).fold(0.0, f64::max);
        self.mirrors.side(&nodes, spacing)
    }

    /// Direction at `at`, in texels of the source's image, in the source's space.
    fn direction(&self, at: DVec2) -> DVec3 {
        self.source.map().direction(self.component, self.uv(at))
    }

    /// Appends the shares of the texels from `low` to `high`, each on its own.
    fn block(&mut self, low: [u32; 2], high: [u32; 2], sources: &Sources, shares: &mut Vec<Share>) {
        let line = |carrier: &Self, y: u32| -> Vec<Option<Place>> {
            (low[0]..=high[0]).map(|x| carrier.place(DVec2::new(f64::from(x), f64::from(y)))).collect()
        };
        let mut above = line(self, low[1]);
        for y in low[1]..high[1] {
            let below = line(self, y + 1);
            for (x, source) in (low[0]..high[0]).zip(sources[(y - low[1]) as usize]) {
                let Some(source) = source else { continue };
                let solid_angle = self.solid_angle(x, y);
                if solid_angle <= 0.0 {
                    continue;
                }
                let corner = DVec2::new(f64::from(x), f64::from(y));
                let part = Piece { low: corner, high: corner + 1.0 };
                let k = (x - low[0]) as usize;
                let corners = [above[k], above[k + 1], below[k + 1], below[k]];
                let start = shares.len();
                self.carry(part, corners, 0, source, shares);
                let sum: f64 = shares[start..].iter().map(|share| f64::from(share.solid_angle)).sum();
                let scale = (solid_angle / sum) as f32;
                shares[start..].iter_mut().for_each(|share| share.solid_angle *= scale);
            }
            above = below;
        }
    }

    /// Appends the shares of the texels from `low` to `high` if the mapping is smooth there: nine points give
    /// their corners by quadratic interpolation, four more confirm it. Returns whether it is.
    fn smooth_block(
        &mut self,
        low: [u32; 2],
        high: [u32; 2],
        sources: &Sources,
        shares: &mut Vec<Share>,
    ) -> bool {
        let corner = DVec2::new(f64::from(low[0]), f64::from(low[1]));
        let count = [high[0] - low[0], high[1] - low[1]];
        let extent = DVec2::from(count.map(f64::from));
        let mut component = None;
        let mut at = |s: f64, t: f64| {
            let place = self.place(corner + extent * DVec2::new(s, t))?;
            (*component.get_or_insert(place.component) == place.component).then(|| self.in_texels(place))
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
        let sides = DVec2::from(self.frames[component as usize].2.map(f64::from));
        let line = |y: u32| {
            let row = |k: usize| quadratic([nodes[0][k], nodes[1][k], nodes[2][k]], f64::from(y) / extent.y);
            let row = [row(0), row(1), row(2)];
            let mut line = [DVec2::ZERO; BLOCK as usize + 1];
            for (x, place) in (0..=count[0]).zip(&mut line) {
                *place = quadratic(row, f64::from(x) / extent.x).clamp(DVec2::ZERO, sides);
            }
            line
        };
        let mut above = line(0);
        for y in 0..count[1] {
            let below = line(y + 1);
            // Texels of a row are often equal.
            let of_row = self.solid_angle(low[0], low[1] + y);
            let is_equal = |x: u32| (self.solid_angle(x, low[1] + y) / of_row - 1.0).abs() < 1e-12;
            let are_equal = is_equal(low[0] + count[0] / 2) && is_equal(high[0] - 1);
            for (x, source) in (0..count[0]).zip(sources[y as usize]) {
                let Some(source) = source else { continue };
                let solid_angle = if are_equal { of_row } else { self.solid_angle(low[0] + x, low[1] + y) };
                if solid_angle > 0.0 {
                    let k = x as usize;
                    let outline = [above[k], above[k + 1], below[k + 1], below[k]];
                    self.walk(component, outline, solid_angle, source, shares);
                }
            }
            above = below;
        }
        true
    }

    /// Exact solid angle of the source texel in column `x`, row `y`.
    fn solid_angle(&self, x: u32, y: u32) -> f64 {
        let low = DVec2::new(f64::from(x), f64::from(y));
        self.source.map().solid_angle(self.component, self.uv(low), self.uv(low + 1.0))
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
        // Coordinates are not negative: casts round down.
        let texel = |corner: DVec2| [corner.x as u32, corner.y as u32];
        let [x, y] = texel(outline[0]);
        if outline.iter().all(|corner| texel(*corner) == [x, y]) {
            let target = self.index(component, x, y);
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
            let target = self.index(component, x, y);
            shares.push(Share { target, source, solid_angle: solid_angle as f32 });
        }
    }

    fn index(&self, component: u32, x: u32, y: u32) -> u32 {
        let (_, _, [width, height], first) = self.frames[component as usize];
        let at = y.min(height - 1) as usize * width as usize + x.min(width - 1) as usize;
        u32::try_from(first + at).expect("texels fit")
    }
}
