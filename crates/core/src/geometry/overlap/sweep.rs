//! Means of a fine panorama over target texels: rasterises every target texel's outline over the panorama's
//! grid.
//!
//! A target texel's edges are great circles, smooth curves in longitude and polar angle. For many source
//! texels it is much cheaper to rasterise one octant's outlines and apply the weights to all eight octants
//! than to map every source texel to the target.

use super::Chords;
use super::grid::{CellOverlap, walk_outline};
use super::index::{self, SourceMap, Target, pack};
use crate::common::parallel;
use crate::light::environment::{Environment, Layout, Rgb};
use glam::{DVec2, DVec3, Vec4};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Minimum rows of a fine panorama: the sine at an overlap's centroid approximates its mean with a relative
/// error below (pi/rows)^2/24 = 6e-6.
const FINE: u32 = 256;

/// Area error allowed for an edge's chords, as a share of the texel's area.
const MISPLACED: f64 = 3e-5;

/// Minimum distance of an edge from the pole, in edge lengths, for the cubic approximation, whose error is
/// below (length/distance)^3/60 of the texel's width.
const POLAR: f64 = 12.0;

/// Rows of the target processed together.
const BAND: usize = 16;
/// Columns processed together: few enough that a tile's shares stay in the cache while all octants' texels
/// are read.
const TILE: u32 = 32;

/// Rows of the source read together.
const STRIP: u32 = 4;

/// Whether a source of `layout` is a fine panorama with more texels than `target`.
pub(super) fn serves(layout: Layout, target: Target) -> bool {
    matches!(layout, Layout::Panorama { height, .. } if height >= FINE)
        && target.texel_count() <= layout.texel_count()
}

/// What `make` makes of every texel of `target` and the mean radiance over it; `None` unless `environment` is
/// a fine panorama with more texels than `target`. Both must be symmetric.
pub(super) fn of_mean_radiances<T: Copy + Default + Send>(
    environment: &Environment,
    target: Target,
    make: &(impl Fn(usize, Rgb) -> T + Sync),
) -> Option<Vec<T>> {
    let Layout::Panorama { width, height } = environment.layout() else { return None };
    if !serves(environment.layout(), target) {
        return None;
    }
    let half = target.edge() / 2;
    let families = match target {
        Target::Octahedral(_) => 1,
        Target::Cube(_) => 3,
    };
    let sweep = Sweep::new(environment, width, height, target);
    let side = half as usize;
    let mut octants = vec![[[0.0; 3]; 8]; families as usize * side * side];
    let bands = (0..families).zip(octants.chunks_mut(side * side)).flat_map(|(family, means)| {
        (0..half).step_by(BAND).zip(means.chunks_mut(BAND * side)).map(move |band| (family, band))
    });
    parallel::for_each(bands, |(family, (first, means))| {
        sweep.band(family, first..half.min(first + BAND as u32), means);
    });
    let mean = |texel| match index::octants_of_texel(target, texel) {
        // The fold halves a texel evenly.
        [Some((a, row_a)), Some((b, row_b))] => {
            let (a, b) = (octants[row_a][a], octants[row_b][b]);
            std::array::from_fn(|c| ((f64::from(a[c]) + f64::from(b[c])) / 2.0) as f32)
        }
        [one, other] => one.or(other).map_or([0.0; 3], |(octant, row)| octants[row][octant]),
    };
    Some(parallel::values(target.texel_count(), |texel| make(texel, mean(texel))))
}

/// One octant of a target over the grid of a panorama.
struct Sweep<'a> {
    texels: &'a [Rgb],
    target: Target,
    source_maps: [SourceMap; 8],
    /// Grid cells a radian, along longitude and polar angle.
    scale: DVec2,
    /// Sine and cosine of the polar angle in the middle of every row.
    middles: Vec<(f64, f64)>,
    arch: crate::common::vector::Arch,
}

/// A cell of the grid, packed, and its weight in a target texel.
type Share = (u32, f32);

/// A target texel of a tile.
struct TargetTexel {
    /// Among the means.
    at: usize,
    shares: Range<usize>,
    /// The sum of their weights.
    total: f64,
}

/// Means of a tile's texels in all octants, compiled for the widest available vectors.
struct Means<'a> {
    texels: &'a [Rgb],
    source_maps: &'a [SourceMap; 8],
    shares: &'a [Share],
    places: &'a [TargetTexel],
    means: &'a mut [[Rgb; 8]],
}

/// Shares summed in single precision before they are added to the total.
const RUN: usize = 16;

impl pulp::NullaryFnOnce for Means<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let values = self.texels.as_flattened();
        // A fourth value fills the vector: the next texel's first value, or a substitute after the last.
        let last = values.len() - 3;
        let end = [values[last], values[last + 1], values[last + 2], 0.0];
        // Process octants in sequence: a panorama's rows, a power of two apart, evict each other from the
        // caches.
        for (octant, map) in self.source_maps.iter().enumerate() {
            let [origin, step_i, step_j] = map.families[0].map(|texels| 3 * texels as isize);
            for place in self.places {
                let shares = &self.shares[place.shares.clone()];
                let mut sums = [0.0_f64; 3];
                for run in shares.chunks(RUN) {
                    let mut sum = Vec4::ZERO;
                    for &(cell, weight) in run {
                        let (column, row) = unpack(cell);
                        let at = (origin + column as isize * step_i + row as isize * step_j) as usize;
                        sum +=
                            weight * values.get(at..at + 4).map_or(Vec4::from_array(end), Vec4::from_slice);
                    }
                    sums = std::array::from_fn(|c| sums[c] + f64::from(sum[c]));
                }
                self.means[place.at][octant] = sums.map(|sum| (sum / place.total) as f32);
            }
        }
    }
}

/// Column and row of a packed cell of a panorama.
const fn unpack(cell: u32) -> (u32, u32) {
    (cell & 0x7fff, cell >> 15)
}

impl<'a> Sweep<'a> {
    fn new(environment: &'a Environment, width: u32, height: u32, target: Target) -> Self {
        let source = environment.layout();
        let middle = |row: u32| (f64::from(row) + 0.5) * PI / f64::from(height);
        Self {
            texels: environment.texels(),
            target,
            source_maps: std::array::from_fn(|octant| SourceMap::new(source, octant)),
            scale: DVec2::new(f64::from(width) / TAU, f64::from(height) / PI),
            middles: (0..height.div_ceil(2)).map(|row| middle(row).sin_cos()).collect(),
            arch: crate::common::vector::Arch::new(),
        }
    }

    /// The `means` over the octant's texels in `rows` of `family`, one for each octant.
    fn band(&self, family: u32, rows: Range<u32>, means: &mut [[Rgb; 8]]) {
        let half = self.target.edge() / 2;
        let lines: Vec<Line> = (rows.start..=rows.end).map(|j| Line::new(self, family, j)).collect();
        let mut sides = vec![[Vec::new(), Vec::new()]; rows.len()];
        let (mut outline, mut window) = (Vec::new(), Vec::new());
        let (mut shares, mut places) = (Vec::new(), Vec::new());
        // Process tile by tile, across the band before along it, for locality.
        for i in 0..half {
            for (row, [left, right]) in sides.iter_mut().enumerate() {
                let j = rows.start + row as u32;
                let lines = [&lines[row], &lines[row + 1]];
                if i + 1 >= self.corners(j) {
                    // Beyond the fold.
                    break;
                }
                if i == 0 {
                    self.side(family, i, j, lines, left);
                }
                outline.clear();
                outline.extend_from_slice(lines[0].arc(i));
                // The last texel before the fold is a triangle, its third side the equator.
                if i + 1 < self.corners(j + 1) {
                    self.side(family, i + 1, j, lines, right);
                    outline.extend_from_slice(right);
                    outline.extend(lines[1].arc(i).iter().rev());
                }
                outline.extend(left.iter().rev());
                std::mem::swap(left, right);
                let first = shares.len();
                walk_outline(&outline, &mut window, |column, row, overlap| {
                    shares.push(self.share(column, row, overlap));
                });
                places.push(TargetTexel {
                    at: row * half as usize + i as usize,
                    shares: first..shares.len(),
                    total: shares[first..].iter().map(|(_, weight)| f64::from(*weight)).sum(),
                });
            }
            if i + 1 == half || (i + 1) % TILE == 0 {
                places.sort_unstable_by_key(|place: &TargetTexel| {
                    strip_and_column(shares[place.shares.start].0)
                });
                self.arch.dispatch(Means {
                    texels: self.texels,
                    source_maps: &self.source_maps,
                    shares: &shares,
                    places: &places,
                    means,
                });
                shares.clear();
                places.clear();
            }
        }
    }

    /// Corners of texels along line `j`.
    const fn corners(&self, j: u32) -> u32 {
        let half = self.target.edge() / 2;
        match self.target {
            Target::Octahedral(_) => half - j + 1,
            Target::Cube(_) => half + 1,
        }
    }

    /// Draws the side between the texels `i` - 1 and `i` of row `j`, from its line `above` to the one
    /// `below`.
    fn side(&self, family: u32, i: u32, j: u32, [above, below]: [&Line; 2], out: &mut Vec<DVec2>) {
        out.clear();
        let ends = [self.target.octant_corner(family, i, j), self.target.octant_corner(family, i, j + 1)];
        let places = [above.corner(i), below.corner(i)];
        self.edge(ends, places, out);
        out.push(places[1]);
    }

    /// Position of `point` on the grid; the pole has longitude 0.
    fn place(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.z.atan2(point.x), axis_distance(point).atan2(point.y)) * self.scale
    }

    /// Derivative of a point's grid position along `step`.
    fn velocity(&self, point: DVec3, step: DVec3) -> DVec2 {
        let rho = axis_distance(point);
        let rho_step = (point.x * step.x + point.z * step.z) / rho;
        let longitude = (point.x * step.z - point.z * step.x) / (rho * rho);
        let polar = (point.y * rho_step - rho * step.y) / (rho * rho + point.y * point.y);
        DVec2::new(longitude, polar) * self.scale
    }

    /// Appends the chords of the edge between two points at `places` to `out`, without the end point.
    fn edge(&self, [from, to]: [DVec3; 2], places: [DVec2; 2], out: &mut Vec<DVec2>) {
        let [a, b] = places;
        let nearest = axis_distance(from).min(axis_distance(to));
        if nearest == 0.0 {
            // A meridian; at the pole use the longitude of the other end.
            let x = a.x.max(b.x);
            return out.extend([DVec2::new(x, a.y), DVec2::new(x, b.y)]);
        }
        let step = to - from;
        let velocities = [self.velocity(from, step), self.velocity(to, step)];
        let middle = (from + to) / 2.0;
        let texel = step.abs().max_element().powi(2) * self.scale.element_product()
            / (middle.length_squared() * axis_distance(middle));
        // One chord cuts off a twelfth of curvature times length, n chords 1/n^2 of that. Moving the inner
        // points outwards restores the area.
        let cut = (velocities[0] - velocities[1]).perp_dot(b - a).abs() / 12.0;
        let chords = (cut / (MISPLACED * texel)).sqrt().ceil().clamp(1.0, 4096.0);
        let polar = nearest < POLAR * step.length();
        out.push(a);
        let outwards = (velocities[0] - velocities[1]) / (12.0 * chords * (chords - 1.0));
        for k in 1..chords as u32 {
            let t = f64::from(k) / chords;
            out.push(
                outwards + if polar { self.place(from + step * t) } else { cubic(places, velocities, t) },
            );
        }
    }

    /// The weight of an overlap: its area on the grid times the sine of its centroid's polar angle.
    fn share(&self, column: u32, row: u32, overlap: CellOverlap) -> Share {
        let row = row.min(self.middles.len() as u32 - 1);
        let (sine, cosine) = self.middles[row as usize];
        // The centroid's distance from the middle of the row, times the area.
        let off = (overlap.moment.y - 0.5 * overlap.area) / self.scale.y;
        (pack(0, column, row), (overlap.area * sine + off * cosine) as f32)
    }
}

/// Orders packed cells by strips of rows, then by columns, for locality.
const fn strip_and_column(cell: u32) -> u32 {
    let (column, row) = unpack(cell);
    (row / STRIP) << 15 | column
}

/// Distance from the poles' axis.
fn axis_distance(point: DVec3) -> f64 {
    (point.x * point.x + point.z * point.z).sqrt()
}

/// Hermite's cubic from `a` to `b`.
fn cubic([a, b]: [DVec2; 2], [start, end]: [DVec2; 2], t: f64) -> DVec2 {
    let u = 1.0 - t;
    a * (u * u * (1.0 + 2.0 * t)) + start * (t * u * u) + b * (t * t * (3.0 - 2.0 * t)) - end * (t * t * u)
}

/// A line of the target on the panorama's grid, cut at the texels' corners.
type Line = Chords<DVec2>;

impl Line {
    /// Line `j` of `family`.
    fn new(sweep: &Sweep<'_>, family: u32, j: u32) -> Self {
        let (mut points, mut starts) = (Vec::new(), Vec::new());
        let mut from = sweep.target.octant_corner(family, 0, j);
        let mut place = sweep.place(from);
        for i in 1..sweep.corners(j) {
            let to = sweep.target.octant_corner(family, i, j);
            let next = sweep.place(to);
            starts.push(points.len());
            sweep.edge([from, to], [place, next], &mut points);
            (from, place) = (to, next);
        }
        starts.push(points.len());
        points.push(place);
        Self { points, starts }
    }

    fn corner(&self, i: u32) -> DVec2 {
        self.points[self.starts[i as usize]]
    }
}

#[cfg(test)]
mod tests {
    use super::super::Overlaps;
    use super::*;
    use glam::DMat3;

    /// Maximum relative difference from the matrix's result.
    fn off(environment: &Environment, target: Target, means: &[Rgb]) -> f32 {
        let matrix = Overlaps::new(environment.layout(), DMat3::IDENTITY, target).expect("a moderate matrix");
        let texel = |k: usize| matrix.mean_radiance(k, environment.texels());
        let differences = (0..target.texel_count()).flat_map(|k| {
            let own = texel(k);
            (0..3).map(move |c| (means[k][c] / own[c] - 1.0).abs())
        });
        differences.fold(0.0, f32::max)
    }

    #[test]
    fn sweeps_agree_with_the_matrix() {
        // With and without columns shared by octants and rows cut by the equator.
        for (width, height) in [(512, 256), (514, 257)] {
            let mut state = 1_u32;
            let mut noise = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                1.0 + 9.0 * (state >> 8) as f32 / 16_777_216.0
            };
            let texels = (0..width * height).map(|_| [noise(), noise(), noise()]).collect();
            let environment = Environment::new(Layout::Panorama { width, height }, texels).expect("noise");
            for target in [2, 6, 34, 128, 300]
                .map(Target::Octahedral)
                .into_iter()
                .chain([2, 6, 34, 128].map(Target::Cube))
            {
                let means =
                    of_mean_radiances(&environment, target, &|_, mean| mean).expect("a fine panorama");
                // Each of four sides misplaces its share, among texels that differ by a factor of ten.
                let error = off(&environment, target, &means);
                assert!(error < 40.0 * MISPLACED as f32, "{width}x{height} to {target:?}: {error:e}");
                let mut wrong = means;
                let last = wrong.len() - 1;
                wrong[last][1] *= 1.01;
                assert!(off(&environment, target, &wrong) > 5e-3, "a wrong texel shows");
            }
        }
    }
}
