//! Overlaps of source and target texels: a sparse matrix of solid angles.
//!
//! Source and target are cut into the eight octants of the sphere, each mirrored to x, y, z >= 0. On an
//! octant's plane x + y + z = 1 great circles are straight lines, so the texels of cubes and octahedra are
//! polygons there, and so are a panorama's after its parallels (conics) are replaced by chords. `grid`
//! rasterises these polygons over the target's grid.
//!
//! Where source and target are both symmetric in the three coordinate planes (every even size without
//! rotation) only one octant is computed; the other seven use the same matrix through index maps. If x and z
//! can be exchanged too (panoramas with a meridian at 45 degrees), only half an octant is computed and the
//! other half mirrored.

mod cells;
mod grid;
mod index;
mod panorama;
mod sweep;

use crate::common::error::{Error, Result};
use crate::common::parallel;
use crate::light::environment::{Environment, Layout, Rgb};
use cells::Cell;
use glam::{DMat3, DVec3};
use index::SourceMap;

pub(super) use grid::{Accumulator, walk_outline};
pub use index::Target;

/// Overlap of a source texel with a target texel.
#[derive(Clone, Copy)]
pub(super) struct Share {
    pub(super) target: u32,
    pub(super) source: u32,
    pub(super) solid_angle: f32,
}

/// Scales `shares` to the sum `solid_angle`, which conserves the energy of a texel. Returns whether they have
/// a sum to scale.
pub(super) fn scale_to(solid_angle: f64, shares: &mut [Share]) -> bool {
    let sum: f64 = shares.iter().map(|share| f64::from(share.solid_angle)).sum();
    if sum > 0.0 {
        let scale = (solid_angle / sum) as f32;
        shares.iter_mut().for_each(|share| share.solid_angle *= scale);
    }
    sum > 0.0
}

/// A line as chords, and where its corners are among their ends.
#[derive(Default)]
struct Chords<P> {
    points: Vec<P>,
    starts: Vec<usize>,
}

impl<P> Chords<P> {
    /// The chords between corner `i` and the next, both included.
    fn arc(&self, i: u32) -> &[P] {
        &self.points[self.starts[i as usize]..=self.starts[i as usize + 1]]
    }
}

/// What `make` makes of every texel of `target` and the mean radiance over it of `environment`, turned by
/// `turn`.
///
/// # Errors
/// [`Error::Limit`] if the overlaps do not fit.
pub(crate) fn of_mean_radiances<T: Copy + Default + Send>(
    environment: &Environment,
    turn: DMat3,
    target: Target,
    make: impl Fn(usize, Rgb) -> T + Sync,
) -> Result<Vec<T>> {
    if is_symmetric(environment.layout(), turn, target)
        && let Some(made) = sweep::of_mean_radiances(environment, target, &make)
    {
        return Ok(made);
    }
    let overlaps = Overlaps::new(environment.layout(), turn, target)?;
    let texels = environment.texels();
    Ok(parallel::values(target.texel_count(), |texel| make(texel, overlaps.mean_radiance(texel, texels))))
}

/// Whether unrotated sources of `layout` are resampled to `target` without a matrix.
fn is_swept(layout: Layout, target: Target) -> bool {
    index::is_symmetric(layout, target) && sweep::serves(layout, target)
}

/// Whether unrotated sources of `layout` are resampled to `target` without a matrix, or the matrix has far
/// fewer entries than it may have.
pub(crate) fn surely_fits(layout: Layout, target: Target) -> bool {
    let overlaps = most_overlaps(layout.texel_count(), target.texel_count());
    is_swept(layout, target) || overlaps < u32::MAX as usize / 64
}

/// The mean radiance of `environment` over every texel of a `width` x `height` panorama of the world.
///
/// # Errors
/// [`Error::Limit`] if the overlaps do not fit.
pub(crate) fn panorama_mean_radiances(
    environment: &Environment,
    width: u32,
    height: u32,
) -> Result<Vec<Rgb>> {
    let target = match environment.layout() {
        Layout::Panorama { width: columns, height: rows } => {
            return Ok(panorama::mean_radiances(environment, [columns, rows], [width, height]));
        }
        Layout::Cube { size } => Target::Cube(size),
        Layout::Octahedral { size } => Target::Octahedral(size),
    };
    // The matrix supports panoramas only as sources: build it in reverse and read it by columns.
    let overlaps =
        Overlaps::new(Layout::Panorama { width, height }, environment.source_from_world(), target)?;
    let mut sums = vec![[0.0_f64; 4]; width as usize * height as usize];
    for (texel, radiance) in environment.texels().iter().enumerate() {
        // Shares are relative to a texel's exact solid angle, which conserves its energy.
        let mut whole = 0.0;
        overlaps.for_each_source(texel, |_, solid_angle| whole += f64::from(solid_angle));
        let scale = environment.layout().solid_angle_at(texel) / whole;
        overlaps.for_each_source(texel, |place, solid_angle| {
            let weight = f64::from(solid_angle) * scale;
            for (sum, value) in sums[place].iter_mut().zip(radiance) {
                *sum += weight * f64::from(*value);
            }
            sums[place][3] += weight;
        });
    }
    Ok(sums.into_iter().map(|[r, g, b, w]| [r, g, b].map(|sum| (sum / w) as f32)).collect())
}

/// About the most overlaps of the texels of two maps with these numbers of texels: lines of one cut texels of
/// the other.
pub(crate) fn most_overlaps(source: usize, target: usize) -> usize {
    source + target + 3 * (source as f64 * target as f64).sqrt() as usize
}

/// The most bytes that the mean radiances over the texels of `target` take, themselves included, for a source
/// of `source` that `turn` leads to the world.
pub(crate) fn most_bytes(source: Layout, target: Layout, turn: DMat3) -> u64 {
    let texels = target.texel_count();
    let means = size_of::<Rgb>() * texels;
    // Entries before and after they are sorted, and two numbers a row.
    let matrix = |entries: usize, rows: usize| (12 + 2 * 8) * entries + 2 * 4 * rows;
    let overlaps = most_overlaps(source.texel_count(), texels);
    let grid = match target {
        Layout::Octahedral { size } => Target::Octahedral(size),
        Layout::Cube { size } => Target::Cube(size),
        Layout::Panorama { .. } => {
            let is_panorama = matches!(source, Layout::Panorama { .. });
            let sums = size_of::<[f64; 4]>() * texels;
            let reverse = if is_panorama { 0 } else { matrix(overlaps, source.texel_count()) + sums };
            return (means + reverse) as u64;
        }
    };
    let work = if !is_symmetric(source, turn, grid) {
        matrix(overlaps, texels)
    } else if is_swept(source, grid) {
        // The octants' means; half of an octahedral square of an octant is beyond the fold.
        2 * means
    } else {
        matrix(overlaps / 8, texels / 4)
    };
    (means + work) as u64
}

/// Whether one octant represents all eight.
fn is_symmetric(source: Layout, turn: DMat3, target: Target) -> bool {
    turn == DMat3::IDENTITY && index::is_symmetric(source, target)
}

/// The matrix: for every target texel its source texels and the overlaps in steradians.
#[derive(Debug)]
pub struct Overlaps {
    target: Target,
    /// The source texels of every octant's packed cells.
    source_maps: [SourceMap; 8],
    /// Whether rows are the first octant's texels and sources are packed, to be mapped to every octant; else
    /// both are whole indices.
    symmetric: bool,
    starts: Vec<u32>,
    entries: Vec<(u32, f32)>,
}

impl Overlaps {
    /// The overlaps of the texels of `source`, turned by `turn`, with those of `target`.
    ///
    /// # Errors
    /// [`Error::Limit`] for more than 2^32 entries.
    pub fn new(source: Layout, turn: DMat3, target: Target) -> Result<Self> {
        let symmetric = is_symmetric(source, turn, target);
        let parts = parallel::map(cells::bands(source, symmetric), |band| {
            let mut walker = grid::Walker::new(target);
            let mut clipper = grid::OctantClipper::default();
            let mut entries = Vec::new();
            let carry = |cell: Cell<'_>| {
                let first = entries.len();
                let mut walk = |octant: usize, corners: &[DVec3]| {
                    walker.walk(corners, octant, &mut |target, solid_angle| {
                        entries.push(Share { target, source: cell.index, solid_angle });
                    });
                };
                if symmetric {
                    walk(0, cell.corners);
                } else {
                    clipper.clip(cell.corners, turn, walk);
                }
                scale_to(cell.solid_angle, &mut entries[first..]);
            };
            if symmetric {
                cells::for_each_octant_cell(source, target, band, carry);
            } else {
                cells::for_each_cell(source, target, band, carry);
            }
            entries
        });
        // Mirroring doubles the entries.
        let count: usize = 2 * parts.iter().map(Vec::len).sum::<usize>();
        if u32::try_from(count).is_err() {
            return Err(Error::Limit {
                what: "the overlap of source and target texels".to_owned(),
                needed: count as u64 * 8,
                available: u64::from(u32::MAX) * 8,
                remedy: "bake from a smaller source or to a smaller size".to_owned(),
            });
        }
        let rows = if symmetric { index::octant_rows(target) } else { target.texel_count() };
        let row_of = |texel: u32| if symmetric { index::octant_row(target, texel) } else { texel as usize };
        let other_half = index::diagonal_columns(source).filter(|_| symmetric);
        let visit_all = |visit: &mut dyn FnMut(usize, u32, f32)| {
            for Share { target: texel, source, solid_angle } in parts.iter().flatten() {
                visit(row_of(*texel), *source, *solid_angle);
            }
            let Some(columns) = other_half else { return };
            for Share { target: texel, source, solid_angle } in parts.iter().flatten() {
                let row = index::diagonal_row(target, row_of(*texel));
                visit(row, index::diagonal_cell(columns, *source), *solid_angle);
            }
        };
        let (starts, entries) = sort_by_row(rows, visit_all);
        let source_maps = std::array::from_fn(|octant| SourceMap::new(source, octant));
        Ok(Self { target, source_maps, symmetric, starts, entries })
    }

    /// The raw matrix for the GPU engine: start of each row's entries, and all entries.
    pub fn rows(&self) -> (&[u32], &[(u32, f32)]) {
        (&self.starts, &self.entries)
    }

    /// Whether rows are the first octant's texels and sources packed cells.
    pub const fn is_symmetric(&self) -> bool {
        self.symmetric
    }

    /// Index map from packed cells to source texels of every octant: by family, the texel of position (0, 0)
    /// and the steps along i and j.
    pub fn source_maps(&self) -> [[[i32; 4]; 3]; 8] {
        self.source_maps.map(|map| {
            map.families.map(|[origin, step_i, step_j]| [origin as i32, step_i as i32, step_j as i32, 0])
        })
    }

    /// Calls `visit` with every source texel that overlaps target texel `target` and the overlap in
    /// steradians, in a fixed order.
    #[inline]
    fn for_each_source(&self, target: usize, mut visit: impl FnMut(usize, f32)) {
        let row = |row: usize| &self.entries[self.starts[row] as usize..self.starts[row + 1] as usize];
        if self.symmetric {
            for (octant, octant_row) in index::octants_of_texel(self.target, target).into_iter().flatten() {
                let source = &self.source_maps[octant];
                for &(packed, solid_angle) in row(octant_row) {
                    visit(source.texel(packed), solid_angle);
                }
            }
        } else {
            for &(source, solid_angle) in row(target) {
                visit(source as usize, solid_angle);
            }
        }
    }

    /// Overlap-weighted mean of the sources of one target texel, in double precision: radiance spans more
    /// decades than sums in single precision preserve.
    fn mean_radiance(&self, target: usize, texels: &[Rgb]) -> Rgb {
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        self.for_each_source(target, |source, solid_angle| {
            let weight = f64::from(solid_angle);
            sum += weight * DVec3::from(texels[source].map(f64::from));
            total += weight;
        });
        (sum * (1.0 / total)).as_vec3().to_array()
    }
}

/// Stable counting sort: within a row the sources keep the order of `visit_all`.
fn sort_by_row(
    rows: usize,
    visit_all: impl Fn(&mut dyn FnMut(usize, u32, f32)),
) -> (Vec<u32>, Vec<(u32, f32)>) {
    let mut starts = vec![0_u32; rows + 1];
    visit_all(&mut |row, _, _| starts[row + 1] += 1);
    for row in 0..rows {
        starts[row + 1] += starts[row];
    }
    let mut next = starts.clone();
    let mut entries = vec![(0, 0.0); starts[rows] as usize];
    visit_all(&mut |row, source, solid_angle| {
        let place = &mut next[row];
        entries[*place as usize] = (source, solid_angle);
        *place += 1;
    });
    (starts, entries)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panoramas_of_other_maps_count_their_sums_and_the_matrix() {
        let (source, target) = (Layout::Cube { size: 64 }, Layout::Panorama { width: 256, height: 128 });
        let (texels, rows) = (target.texel_count(), source.texel_count());
        let least = (12 + 32) * texels + 28 * most_overlaps(rows, texels);
        let bytes = most_bytes(source, target, DMat3::IDENTITY);
        assert!((least as u64..2 * least as u64).contains(&bytes), "{bytes} for {least} and the rows");
    }

    #[test]
    fn overlaps_are_no_more_than_stated() {
        let turn = DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(0.4);
        // Texels so small that none is cut into pieces.
        for (source, size) in [(Layout::Cube { size: 256 }, 256), (Layout::Octahedral { size: 320 }, 288)] {
            for target in [Target::Cube(size), Target::Octahedral(size)] {
                let count = Overlaps::new(source, turn, target).expect("a moderate matrix").entries.len();
                let most = most_overlaps(source.texel_count(), target.texel_count());
                assert!(count <= most, "{source:?} to {target:?}: {count}, above {most}");
            }
        }
    }
}
