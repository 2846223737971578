//! The source's texels, each constant over its own solid angle: moments of every texel and of pieces of it.
//!
//! Coarse texels are cut into 2^k x 2^k, which keeps the source's light and makes all sides shorter than 1/5:
//! three nodes per side then integrate directions to 3e-8 and their spread to 1e-5 of itself. Even sizes
//! follow for octahedral squares, so that only fold diagonals cross texels, from corner to corner.

use crate::geometry::panorama_row::{PanoramaRow, Row};
use crate::geometry::quadrant::Quadrant;
use crate::geometry::tent::{Moments, Patch, Texel};
use crate::light::environment::Layout;
use crate::sphere::cube::{Face, cube_point};
use crate::sphere::quadrature::THREE_NODES;
use glam::{DMat3, DVec2, DVec3, Mat3, Vec3};
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

/// A texel, or a part of one by halving its sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    /// Halvings.
    pub(crate) depth: u8,
    /// Column and row among the 2^depth x 2^depth pieces of the texel.
    place: [u64; 2],
}

impl Piece {
    /// The whole texel.
    pub(crate) const WHOLE: Self = Self { depth: 0, place: [0; 2] };

    pub(crate) fn quarters(self) -> [Self; 4] {
        let [i, j] = self.place.map(|k| 2 * k);
        [[i, j], [i + 1, j], [i, j + 1], [i + 1, j + 1]].map(|place| Self { depth: self.depth + 1, place })
    }

    /// Its corners, in texels.
    pub(crate) fn corners(self) -> [DVec2; 2] {
        let side = 0.5_f64.powi(i32::from(self.depth));
        let low = DVec2::from(self.place.map(|k| k as f64)) * side;
        [low, low + side]
    }
}

/// A panorama's rows, and cosine and sine of the columns' longitudes.
#[derive(Debug)]
struct Panorama {
    rows: Vec<Row>,
    columns: Vec<(f64, f64)>,
}

impl Panorama {
    fn new(width: u32, height: u32) -> Self {
        let longitude = |i: u32| ((f64::from(i) + 0.5) / f64::from(width) - 0.5) * TAU;
        let row = |j: u32| {
            let integrated = integrated(&panorama_nodes([width, height], 0.0, j, Piece::WHOLE));
            let DVec3 { x, y, .. } = integrated.0.centroid;
            Row { centroid: DVec2::new(x, y), texel: rounded_texel(integrated) }
        };
        let columns = (0..width).map(|i| (longitude(i).cos(), longitude(i).sin())).collect();
        Self { rows: (0..height).map(row).collect(), columns }
    }

    /// The texel in column `x` of row `y`, and its centroid.
    #[inline(always)]
    fn at(&self, x: usize, y: usize) -> (Texel, DVec3) {
        let Row { centroid, texel: Texel { patch, solid_angle } } = self.rows[y];
        let (cos, sin) = self.columns[x];
        let (c, s) = (cos as f32, sin as f32);
        let Vec3 { x: radial, y: upright, z: tangential } = patch.diagonal;
        // Radial and upright deviations are correlated, tangential ones with neither.
        let leaning = patch.mixed.z;
        let centroid = DVec3::new(centroid.x * cos, centroid.y, centroid.x * sin);
        let patch = Patch {
            centroid: centroid.as_vec3(),
            diagonal: Vec3::new(
                radial * c * c + tangential * s * s,
                upright,
                radial * s * s + tangential * c * c,
            ),
            mixed: Vec3::new(leaning * s, (radial - tangential) * s * c, leaning * c),
            radius: patch.radius,
        };
        (Texel { patch, solid_angle }, centroid)
    }
}

/// Halvings of a panorama's texels whose pieces have tables.
const TABLED: usize = 3;

/// Moments from which those of all texels follow.
#[derive(Debug)]
enum Table {
    /// Texels, cosine and sine of their columns' longitudes in single precision, and the pieces by one and
    /// more halvings, which are texels of finer panoramas.
    Panorama {
        texels: Panorama,
        rounded: Vec<(f32, f32)>,
        pieces: Box<[OnceLock<Panorama>; TABLED]>,
    },
    /// Those of a face, in the coordinates s, normal, t.
    Cube {
        face: Quadrant<Texel>,
        frames: Box<[(DMat3, Mat3); 6]>,
    },
    Octahedral(Quadrant<Texel>),
}

/// The grid of a source's texels as `shaders/adaptive.wgsl` takes it.
#[derive(Clone, Copy, Debug, Default)]
pub struct SourceGrid {
    /// [`PANORAMA`], [`CUBE`], 3 for octahedral squares, 0 for none.
    pub source: u32,
    /// Columns and rows of one image.
    pub sides: [u32; 2],
    /// Halvings of the source's columns and rows that lead to them.
    pub shift: [u32; 2],
}

/// [`SourceGrid::source`] of a panorama.
pub(crate) const PANORAMA: u32 = 1;

/// [`SourceGrid::source`] of a cube.
pub(crate) const CUBE: u32 = 2;

/// The texels of a source, cut if they are coarse.
#[derive(Debug)]
pub struct SourceTexels {
    source: Layout,
    grid: Layout,
    /// Halvings of a source texel's sides.
    shift: [u32; 2],
    table: Table,
}

/// Texels along an edge of a grid, at least: sides below 1/5.
const MIN_WIDTH: u32 = 32;
const MIN_HEIGHT: u32 = 16;
const MIN_CUBE: u32 = 16;
const MIN_SQUARE: u32 = 32;

/// The grid of a source of `layout`, and the halvings of columns and rows that lead to it.
fn grid_of(layout: Layout) -> (Layout, [u32; 2]) {
    // Sizes from 1 on reach the least ones after five halvings.
    let halvings = |size: u32, least: u32, even: bool| {
        (0..5).find(|k| size << k >= least && (!even || (size << k).is_multiple_of(2))).unwrap_or(5)
    };
    match layout {
        Layout::Panorama { width, height } => {
            let [x, y] = [halvings(width, MIN_WIDTH, false), halvings(height, MIN_HEIGHT, false)];
            (Layout::Panorama { width: width << x, height: height << y }, [x, y])
        }
        Layout::Cube { size } => {
            let shift = halvings(size, MIN_CUBE, true);
            (Layout::Cube { size: size << shift }, [shift; 2])
        }
        Layout::Octahedral { size } => {
            let shift = halvings(size, MIN_SQUARE, true);
            (Layout::Octahedral { size: size << shift }, [shift; 2])
        }
    }
}

/// Cells along an edge for a source of `layout`, at most `most`: so many that each holds about two texels.
/// They are subdivided down to texels, and cells of a finer grid cost more than they save.
pub fn cells_across(layout: Layout, most: u32) -> u32 {
    let texels = grid_of(layout).0.texel_count();
    ((texels as f64 / 2.0).sqrt().ceil() as u32).next_power_of_two().min(most)
}

/// The most runs of texels that cells of `width` x `width` hold for a source of `layout`: cells' edges cut a
/// row less often than four times their number along an edge.
pub fn most_runs(layout: Layout, width: u32) -> u64 {
    let (columns, rows) = grid_of(layout).0.sides();
    let images = if matches!(layout, Layout::Cube { .. }) { 6 } else { 1 };
    let most = columns.div_ceil(longest_run(columns)).saturating_add(4 * width + 4).min(columns);
    images * u64::from(rows) * u64::from(most)
}

/// Most texels of a run in a row of `columns`. Runs are summed in single precision: over k texels the
/// centroid is in error by about k 2^-24 of the run's length, 2 pi k / columns, which this keeps below 2^-23.
pub(crate) fn longest_run(columns: u32) -> u32 {
    (columns / 3).isqrt().clamp(1, 16)
}

impl SourceTexels {
    /// The moments of the texels of `source`, for one texel of each kind.
    pub fn new(source: Layout) -> Self {
        let (grid, shift) = grid_of(source);
        let table = match grid {
            Layout::Panorama { width, height } => {
                let texels = Panorama::new(width, height);
                let rounded = texels.columns.iter().map(|(cos, sin)| (*cos as f32, *sin as f32)).collect();
                Table::Panorama { texels, rounded, pieces: Box::default() }
            }
            Layout::Cube { size } => {
                let texel = |x: u32, y: u32| {
                    rounded_texel(integrated(&cube_nodes(size, DMat3::IDENTITY, [x, y], Piece::WHOLE)))
                };
                let frames = Box::new(Face::ALL.map(|face| {
                    let normal = cube_point(face, 0.0, 0.0);
                    let [s, t] = [cube_point(face, 1.0, 0.0), cube_point(face, 0.0, 1.0)];
                    let frame = DMat3::from_cols(s - normal, normal, t - normal);
                    (frame, frame.as_mat3())
                }));
                Table::Cube { face: Quadrant::new(size, texel), frames }
            }
            Layout::Octahedral { size } => {
                let texel =
                    |x: u32, y: u32| rounded_texel(integrated(&octahedral_nodes(size, [x, y], Piece::WHOLE)));
                Table::Octahedral(Quadrant::new(size, texel))
            }
        };
        Self { source, grid, shift, table }
    }

    /// Columns of the texels, and rows of all images.
    pub(crate) fn sides(&self) -> (u32, u32) {
        let (columns, rows) = self.grid.sides();
        (columns, if matches!(self.grid, Layout::Cube { .. }) { 6 * rows } else { rows })
    }

    /// The texels' grid, for shaders.
    pub(crate) fn grid(&self) -> SourceGrid {
        let source = match self.grid {
            Layout::Panorama { .. } => PANORAMA,
            Layout::Cube { .. } => CUBE,
            Layout::Octahedral { .. } => 3,
        };
        let (columns, rows) = self.grid.sides();
        SourceGrid { source, sides: [columns, rows], shift: self.shift }
    }

    /// Cosine and sine of the middle longitudes of a panorama's columns, then of the middle polar angles of
    /// its rows; one pair for other layouts.
    pub(crate) fn angles(&self) -> Vec<[f32; 2]> {
        let Layout::Panorama { width, height } = self.grid else { return vec![[0.0; 2]] };
        let longitudes = (0..width).map(|i| ((f64::from(i) + 0.5) / f64::from(width) - 0.5) * TAU);
        let polar = (0..height).map(|j| (f64::from(j) + 0.5) / f64::from(height) * PI);
        longitudes.chain(polar).map(|angle| [angle.cos() as f32, angle.sin() as f32]).collect()
    }

    /// Index of the source's texel that the texel in column 0 of row `y` is a part of.
    pub(crate) fn source_row(&self, y: u32) -> usize {
        let (_, rows) = self.grid.sides();
        let (columns, source_rows) = self.source.sides();
        let (image, y) = (y / rows, y % rows);
        (image * source_rows + (y >> self.shift[1])) as usize * columns as usize
    }

    /// Column of the source's texel that a texel in column `x` is a part of.
    #[inline(always)]
    pub(crate) const fn source_column(&self, x: u32) -> usize {
        (x >> self.shift[0]) as usize
    }

    /// The texel in column `x` of row `y`.
    #[inline]
    pub(crate) fn at(&self, x: u32, y: u32) -> Texel {
        match &self.table {
            Table::Panorama { texels, .. } => texels.at(x as usize, y as usize).0,
            Table::Cube { face, frames } => {
                let size = face.side();
                let Texel { patch, solid_angle } = face.at(x, y % size);
                Texel { patch: patch.moved(frames[(y / size) as usize].1), solid_angle }
            }
            Table::Octahedral(square) => square.at(x, y),
        }
    }

    /// Calls `visit` with the centroid of every texel in row `y`, within 2^-23.
    #[inline(always)]
    pub(crate) fn for_each_centroid(&self, y: u32, mut visit: impl FnMut(Vec3)) {
        if let Table::Panorama { texels, rounded, .. } = &self.table {
            let [rho, up] = texels.rows[y as usize].centroid.as_vec2().to_array();
            for (cos, sin) in rounded {
                visit(Vec3::new(rho * cos, up, rho * sin));
            }
        } else {
            (0..self.sides().0).for_each(|x| visit(self.at(x, y).patch.centroid));
        }
    }

    /// The row of a panorama, for sums along it; `None` for other layouts.
    pub(crate) fn panorama_row(&self, y: u32) -> Option<PanoramaRow<'_>> {
        let Table::Panorama { texels: Panorama { rows, columns }, rounded, .. } = &self.table else {
            return None;
        };
        Some(PanoramaRow { row: rows[y as usize], columns, rounded })
    }

    /// `piece` of the texel in column `x` of row `y`, and its centroid.
    pub(crate) fn piece(&self, x: u32, y: u32, piece: Piece) -> (Texel, DVec3) {
        let nodes = match (&self.table, self.grid) {
            (Table::Panorama { pieces, .. }, Layout::Panorama { width, height }) => {
                if let Some(table) = usize::from(piece.depth).checked_sub(1).and_then(|k| pieces.get(k)) {
                    let table =
                        table.get_or_init(|| Panorama::new(width << piece.depth, height << piece.depth));
                    let [i, j] = piece.place.map(|k| k as usize);
                    return table.at(((x as usize) << piece.depth) + i, ((y as usize) << piece.depth) + j);
                }
                let [low, high] = piece.corners();
                let longitude = ((f64::from(x) + (low.x + high.x) / 2.0) / f64::from(width) - 0.5) * TAU;
                panorama_nodes([width, height], longitude, y, piece)
            }
            (Table::Cube { frames, .. }, Layout::Cube { size }) => {
                cube_nodes(size, frames[(y / size) as usize].0, [x, y % size], piece)
            }
            (_, grid) => octahedral_nodes(grid.sides().0, [x, y], piece),
        };
        let integrated = integrated(&nodes);
        (rounded_texel(integrated), integrated.0.centroid)
    }
}

/// A texel of such moments and solid angle.
fn rounded_texel((moments, solid_angle): (Moments, f64)) -> Texel {
    Texel { patch: moments.into(), solid_angle: solid_angle as f32 }
}

/// Directions and solid angles of nodes, and the corners.
struct Nodes {
    weighted: [(DVec3, f64); 18],
    count: usize,
    corners: [DVec3; 4],
}

impl Nodes {
    /// Nodes of the parallelogram, or of half of it, that `point` and `density` map to the sphere from the
    /// unit square.
    fn add(&mut self, density: impl Fn(DVec2) -> (DVec3, f64)) {
        for (u, weight_u) in THREE_NODES {
            for (v, weight_v) in THREE_NODES {
                let (direction, density) = density(DVec2::new(u, v));
                self.weighted[self.count] = (direction, density * weight_u * weight_v);
                self.count += 1;
            }
        }
    }

    fn at_corners(corners: [DVec3; 4]) -> Self {
        Self { weighted: [(DVec3::ZERO, 0.0); 18], count: 0, corners }
    }
}

/// Moments, reach and solid angle. The farthest point of a piece from its centroid is a corner: its sides are
/// great circles or parallels shorter than a quarter of the circle.
fn integrated(nodes: &Nodes) -> (Moments, f64) {
    let weighted = &nodes.weighted[..nodes.count];
    let solid_angle: f64 = weighted.iter().map(|(_, weight)| weight).sum();
    let mut moments =
        Moments::from_weighted(weighted.iter().map(|(direction, weight)| (*direction, weight / solid_angle)));
    let apart = nodes.corners.iter().map(|corner| corner.distance_squared(moments.centroid));
    moments.radius = apart.fold(0.0, f64::max).sqrt();
    (moments, solid_angle)
}

/// A piece of the texel in row `j` of a panorama whose middle has `longitude`.
fn panorama_nodes([width, height]: [u32; 2], longitude: f64, j: u32, piece: Piece) -> Nodes {
    let [low, high] = piece.corners();
    let step = DVec2::new(TAU / f64::from(width), PI / f64::from(height));
    let extent = (high - low) * step;
    let top = (f64::from(j) + low.y) * step.y;
    // Sines and cosines once for each row and column of nodes, and for the edges.
    let polar = |v: f64| (top + v * extent.y).sin_cos();
    let around = |u: f64| (longitude + (u - 0.5) * extent.x).sin_cos();
    let direction =
        |(across, along): (f64, f64), (sin, cos): (f64, f64)| DVec3::new(sin * along, cos, sin * across);
    let ([left, right], [above, below]) = ([0.0, 1.0].map(around), [0.0, 1.0].map(polar));
    let corners = [(left, above), (right, above), (right, below), (left, below)];
    let mut nodes = Nodes::at_corners(corners.map(|(u, v)| direction(u, v)));
    let rows = THREE_NODES.map(|(v, weight)| (polar(v), weight));
    for (u, weight_u) in THREE_NODES.map(|(u, weight)| (around(u), weight)) {
        for (v, weight_v) in rows {
            let density = v.0 * extent.x * extent.y;
            nodes.weighted[nodes.count] = (direction(u, v), density * weight_u * weight_v);
            nodes.count += 1;
        }
    }
    nodes
}

/// The direction of `point` and the solid angle of `area` around it, in a plane at distance `height` from the
/// centre.
fn projected(point: DVec3, area: f64) -> (DVec3, f64) {
    let squared = point.length_squared();
    let per_length = 1.0 / squared.sqrt();
    (point * per_length, area * per_length / squared)
}

/// A piece of the texel at `place` of a face of `size` x `size`, whose axes s, normal and t are the columns
/// of `frame`.
fn cube_nodes(size: u32, frame: DMat3, place: [u32; 2], piece: Piece) -> Nodes {
    let [low, high] = piece.corners();
    let step = 2.0 / f64::from(size);
    let place = DVec2::from(place.map(f64::from));
    let extent = (high - low) * step;
    let first = (place + low) * step - 1.0;
    let at = |p: DVec2| {
        let st = first + p * extent;
        projected(frame * DVec3::new(st.x, 1.0, st.y), extent.x * extent.y)
    };
    let mut nodes = Nodes::at_corners([DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].map(|p| at(p).0));
    nodes.add(at);
    nodes
}

/// A piece of the texel at `place` of an octahedral square of `size` x `size`.
fn octahedral_nodes(size: u32, place: [u32; 2], piece: Piece) -> Nodes {
    let [low, high] = piece.corners();
    let half = f64::from(size / 2);
    // Texels from the axes, which no texel crosses.
    let axis = |k: u32, low: f64, high: f64| {
        let k = f64::from(k) - half;
        if k >= 0.0 { (k + low, k + high, 1.0) } else { (-k - high, -k - low, -1.0) }
    };
    let (a0, a1, sign_x) = axis(place[0], low.x, high.x);
    let (b0, b1, sign_z) = axis(place[1], low.y, high.y);
    let signs = DVec3::new(sign_x, 1.0, sign_z);
    let point = |a: f64, b: f64| {
        let p = if a + b <= half {
            DVec3::new(a, half - a - b, b)
        } else {
            DVec3::new(half - b, half - a - b, half - a)
        };
        signs * p / half
    };
    let extent = DVec2::new(a1 - a0, b1 - b0);
    let area = extent.x * extent.y / (half * half);
    let corners = [(a0, b0), (a1, b0), (a1, b1), (a0, b1)].map(|(a, b)| point(a, b).normalize());
    let mut nodes = Nodes::at_corners(corners);
    if a0 + b0 < half && a1 + b1 > half {
        // The fold diagonal runs from corner to corner. In each triangle the nodes shrink towards the corner
        // off the diagonal.
        for ([a, b], sign) in [([a0, b0], 1.0), ([a1, b1], -1.0)] {
            nodes.add(|p| {
                let along = extent * DVec2::new(1.0 - p.y, p.y) * (sign * p.x);
                projected(point(a + along.x, b + along.y), area * p.x)
            });
        }
    } else {
        nodes.add(|p| projected(point(a0 + p.x * extent.x, b0 + p.y * extent.y), area));
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::panorama_row::RunSums;
    use glam::swizzles::Vec3Swizzles as _;

    const LAYOUTS: [Layout; 10] = [
        Layout::Panorama { width: 1, height: 1 },
        Layout::Panorama { width: 7, height: 5 },
        Layout::Panorama { width: 64, height: 33 },
        Layout::Cube { size: 1 },
        Layout::Cube { size: 5 },
        Layout::Cube { size: 16 },
        Layout::Octahedral { size: 1 },
        Layout::Octahedral { size: 3 },
        Layout::Octahedral { size: 32 },
        Layout::Octahedral { size: 37 },
    ];

    /// Every texel with its column, row and source texel.
    fn all(texels: &SourceTexels) -> impl Iterator<Item = (u32, u32, usize)> {
        let (columns, rows) = texels.sides();
        (0..rows).flat_map(move |y| {
            (0..columns).map(move |x| (x, y, texels.source_row(y) + texels.source_column(x)))
        })
    }

    #[test]
    fn texels_have_the_solid_angles_of_the_source() {
        for layout in LAYOUTS {
            let texels = SourceTexels::new(layout);
            let mut sums = vec![0.0; layout.texel_count()];
            for (x, y, source) in all(&texels) {
                sums[source] += f64::from(texels.at(x, y).solid_angle);
            }
            let (columns, rows) = layout.sides();
            for (k, sum) in (0..).zip(sums) {
                let expected = layout.texel_solid_angle(k % columns, k / columns % rows);
                assert!((sum / expected - 1.0).abs() < 3e-7, "{layout:?} texel {k}: {sum}, not {expected}");
            }
        }
    }

    #[test]
    fn tables_and_pieces_agree() {
        for layout in LAYOUTS {
            let texels = SourceTexels::new(layout);
            for (x, y, _) in all(&texels).step_by(5) {
                let (Texel { patch: whole, solid_angle }, middle) = texels.piece(x, y, Piece::WHOLE);
                let solid_angle = f64::from(solid_angle);
                let Texel { patch, solid_angle: found } = texels.at(x, y);
                let case = format!("{layout:?} ({x}, {y})");
                assert!((f64::from(found) / solid_angle - 1.0).abs() < 1e-6, "{case}: solid angle");
                let off = patch.centroid.as_dvec3().distance(middle);
                assert!(off < 1.3e-7, "{case}: centroid off by {off:e}");
                let scale = whole.diagonal.element_sum();
                let off = patch.diagonal.distance(whole.diagonal) + patch.mixed.distance(whole.mixed);
                assert!(off < 1e-5 * scale, "{case}: covariance off by {off:e} of {scale:e}");
                assert!((patch.radius / whole.radius - 1.0).abs() < 1e-4, "{case}: reach {}", patch.radius);

                // Pieces have the moments of the whole, with tables and without.
                let mut pieces = vec![Piece::WHOLE];
                for _ in 0..=TABLED {
                    pieces = pieces.into_iter().flat_map(Piece::quarters).collect();
                    let parts: Vec<_> = pieces.iter().map(|piece| texels.piece(x, y, *piece)).collect();
                    let total: f64 = parts.iter().map(|(part, _)| f64::from(part.solid_angle)).sum();
                    assert!((total / solid_angle - 1.0).abs() < 1e-6, "{case}: pieces cover {total}");
                    let mean = |get: &dyn Fn(&Patch, DVec3) -> DVec3| {
                        let sum =
                            |(part, at): &(Texel, DVec3)| get(&part.patch, *at) * f64::from(part.solid_angle);
                        parts.iter().map(sum).sum::<DVec3>() / total
                    };
                    let centroid = mean(&|_, at| at);
                    assert!(centroid.distance(middle) < 6e-8, "{case}: centroid of pieces");
                    let spread = mean(&|patch, at| patch.diagonal.as_dvec3() + (at - centroid).powf(2.0));
                    let off = spread.distance(whole.diagonal.as_dvec3());
                    assert!(off < 2e-5 * f64::from(scale), "{case}: spread of pieces");
                    let reach = f64::from(whole.radius);
                    let within = |(_, at): &(Texel, DVec3)| at.distance(middle) < reach;
                    assert!(parts.iter().all(within), "{case}: a piece outside");
                }
            }
        }
    }

    #[test]
    fn texels_lie_where_the_source_s_map_says() {
        for layout in LAYOUTS {
            let texels = SourceTexels::new(layout);
            let (columns, rows) = layout.sides();
            for (x, y, source) in all(&texels).filter(|_| layout.texel_count() > 100) {
                let k = source as u32;
                let centre =
                    layout.direction_from_texel(k / (columns * rows), k % columns, k / columns % rows);
                let apart = texels.at(x, y).patch.centroid.as_dvec3().distance(centre);
                assert!(apart < 3.0 / f64::from(rows), "{layout:?} ({x}, {y}): {apart} apart");
            }
        }
    }

    #[test]
    fn runs_have_the_moments_of_their_texels() {
        let texels = SourceTexels::new(Layout::Panorama { width: 256, height: 128 });
        for (y, first) in [(0, 0), (1, 250), (40, 17), (64, 128), (127, 3)] {
            let row = texels.panorama_row(y).expect("a panorama");
            let lights = [0.0, 3.0, 1.0, 100.0, 2.0, 0.0_f32];
            let mut sums = RunSums::default();
            // Red decreases along the run, blue increases.
            let energy =
                |x: u32, light: f32| Vec3::new((first + 8 - x) as f32, 1.0, (x - first) as f32) * light;
            let mut all = Vec3::ZERO;
            for (x, light) in (first..).zip(lights) {
                row.add(&mut sums, first, x, energy(x, light), light);
                all += energy(x, light);
            }
            let patch = row.patch(&sums, first, [first + 1, first + 4]);
            let own: Vec<_> =
                (first..).zip(lights).map(|(x, light)| (texels.at(x, y).patch, f64::from(light))).collect();
            let total: f64 = own.iter().map(|(_, light)| light).sum();
            let mean = |get: &dyn Fn(&Patch) -> DVec3| {
                own.iter().map(|(patch, light)| get(patch) * *light).sum::<DVec3>() / total
            };
            let centroid = mean(&|patch| patch.centroid.as_dvec3());
            assert!(patch.centroid.as_dvec3().distance(centroid) < 2e-7, "row {y}: centroid");
            for (c, found) in [0, 2].into_iter().zip(row.tints(&sums, first, all)) {
                let share = f64::from(all[c]) / total;
                let (mut dipole, mut diagonal, mut mixed) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
                let mut variation = 0.0;
                for (x, light) in (first..).zip(lights) {
                    let Patch { centroid: at, diagonal: own, mixed: crossed, .. } = texels.at(x, y).patch;
                    let apart = at.as_dvec3() - centroid;
                    let delta = f64::from(energy(x, light)[c]) - share * f64::from(light);
                    dipole += apart * delta;
                    diagonal += (own.as_dvec3() + apart * apart) * delta;
                    mixed += (crossed.as_dvec3() + apart.yzx() * apart.zxy()) * delta;
                    variation += delta.abs();
                }
                // Directions are in error by 2^-23, and sums of six as much again.
                let energy = f64::from(all[c]);
                let off = found.dipole.as_dvec3().distance(dipole);
                assert!(off < 8e-7 * energy, "row {y}: dipole {c} is off by {off}");
                let reach = f64::from(patch.radius);
                let off =
                    found.diagonal.as_dvec3().distance(diagonal).max(found.mixed.as_dvec3().distance(mixed));
                assert!(off < 2e-6 * reach * energy, "row {y}: quadrupole {c} is off by {off}");
                let bound = f64::from(found.variation);
                assert!((1.0..3.0).contains(&(bound / variation)), "row {y}: variation {bound}, {variation}");
            }
            let apart = |patch: &Patch| patch.centroid.as_dvec3() - centroid;
            let diagonal = mean(&|patch| patch.diagonal.as_dvec3() + apart(patch).powf(2.0));
            let scale = diagonal.element_sum();
            assert!(patch.diagonal.as_dvec3().distance(diagonal) < 1e-4 * scale, "row {y}: variances");
            let mixed = mean(&|patch| {
                let apart = apart(patch);
                patch.mixed.as_dvec3() + DVec3::new(apart.y * apart.z, apart.z * apart.x, apart.x * apart.y)
            });
            assert!(patch.mixed.as_dvec3().distance(mixed) < 1e-4 * scale, "row {y}: covariances");
            for (member, light) in own.iter().filter(|(_, light)| *light > 0.0) {
                let reached = patch.centroid.distance(member.centroid) + member.radius;
                assert!(reached <= patch.radius * (1.0 + 1e-5), "row {y}: light {light} outside");
            }
        }
    }
}
