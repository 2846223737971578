//! Source texels as spherical polygons, in bands for parallel processing.

use super::Chords;
use super::index::{Target, diagonal_columns, pack};
use crate::light::environment::Layout;
use crate::sphere::cube::{self, Face, cube_point};
use crate::sphere::octahedral::for_each_face_piece;
use crate::sphere::projected_solid_angle;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

/// Maximum distance of a chord from its parallel, in target texels: among texels that differ by a factor of
/// ten, means are off by less than twice that, and by a fortieth of it in RMS.
const CHORD_SAG: f64 = 5e-5;

/// A source texel or a piece of one: its polygon and the texel's index, packed for an octant or whole.
pub(super) struct Cell<'a> {
    pub(super) corners: &'a [DVec3],
    pub(super) index: u32,
    /// Exact, in steradians.
    pub(super) solid_angle: f64,
}

/// Bands of rows of the first octant, for a cube three quarter faces in sequence, or of the whole source, for
/// a cube its faces in sequence.
pub(super) fn bands(source: Layout, of_octant: bool) -> Vec<Range<u32>> {
    let rows = match source {
        Layout::Panorama { height, .. } if of_octant => height.div_ceil(2),
        Layout::Panorama { height, .. } => height,
        Layout::Cube { size } if of_octant => 3 * (size / 2),
        Layout::Cube { size } => 6 * size,
        Layout::Octahedral { size } if of_octant => size / 2,
        Layout::Octahedral { size } => size,
    };
    // Enough bands for all cores, few enough to amortise the parallels at their edges.
    let band = rows.div_ceil(64).max(4);
    (0..rows).step_by(band as usize).map(|start| start..(start + band).min(rows)).collect()
}

/// Calls `visit` with every cell of the first octant in `band`, or of its half next to the X meridian if the
/// other half is its mirror image ([`diagonal_columns`]); indices are packed.
pub(super) fn for_each_octant_cell(
    source: Layout,
    target: Target,
    band: Range<u32>,
    mut visit: impl FnMut(Cell<'_>),
) {
    match source {
        Layout::Panorama { width, height } => {
            // Columns count from the X meridian to the Z meridian, or half way.
            let count = diagonal_columns(source).map_or(width.div_ceil(4), |columns| columns / 2);
            let columns: Vec<f64> =
                (0..=count).map(|k| (f64::from(k) * TAU / f64::from(width)).min(FRAC_PI_2)).collect();
            let row = |k: u32| (f64::from(k) * PI / f64::from(height)).min(FRAC_PI_2);
            panorama_cells(&columns, row, target, band, |i, j, corners, solid_angle| {
                visit(Cell { corners, index: pack(0, i, j), solid_angle });
            });
        }
        Layout::Cube { size } => {
            let half = size / 2;
            for row in band {
                let (family, j) = (row / half, row % half);
                for i in 0..half {
                    let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                        .map(|(i, j)| Target::Cube(size).octant_corner(family, i, j));
                    let solid_angle = cube::texel_solid_angle(size, half + i, half + j);
                    visit(Cell { corners: &corners, index: pack(family, half + i, half + j), solid_angle });
                }
            }
        }
        Layout::Octahedral { size } => {
            let half = size / 2;
            let point = |x: u32, y: u32| Target::Octahedral(size).octant_corner(0, x, y);
            for y in band {
                for x in 0..half - y {
                    // The last cell of a row is cut by the fold diagonal.
                    let on_fold = x + y + 1 == half;
                    let all = [point(x, y), point(x + 1, y), point(x + 1, y + 1), point(x, y + 1)];
                    let cut = [all[0], all[1], all[3]];
                    let corners: &[DVec3] = if on_fold { &cut } else { &all };
                    let solid_angle = projected_solid_angle(corners);
                    visit(Cell { corners, index: pack(0, half + x, half + y), solid_angle });
                }
            }
        }
    }
}

/// Calls `visit` with every cell of the whole source in `band`, in pieces smaller than a hemisphere; indices
/// are whole.
pub(super) fn for_each_cell(
    source: Layout,
    target: Target,
    band: Range<u32>,
    mut visit: impl FnMut(Cell<'_>),
) {
    match source {
        Layout::Panorama { width, height } => {
            // Split columns and rows wider than an eighth of the circle.
            let pieces = 8_u32.div_ceil(width);
            let count = width * pieces;
            let columns: Vec<f64> =
                (0..=count).map(|k| (f64::from(k) / f64::from(count) - 0.5) * TAU).collect();
            let row_pieces = 4_u32.div_ceil(height);
            let row = |k: u32| f64::from(k) / f64::from(height * row_pieces) * PI;
            let band = band.start * row_pieces..band.end * row_pieces;
            panorama_cells(&columns, row, target, band, |i, j, corners, solid_angle| {
                visit(Cell { corners, index: (j / row_pieces) * width + i / pieces, solid_angle });
            });
        }
        Layout::Cube { size } => {
            // Halve the single texel of a face for n = 1; polygons must be smaller.
            let pieces = if size == 1 { 2 } else { 1 };
            let edge = |k: u32| f64::from(k) / f64::from(size * pieces) * 2.0 - 1.0;
            for row in band {
                let (face, j) = (row / size, row % size);
                for j in j * pieces..(j + 1) * pieces {
                    for i in 0..size * pieces {
                        let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                            .map(|(i, j)| cube_point(Face::ALL[face as usize], edge(i), edge(j)));
                        let solid_angle = cube::texel_solid_angle(size * pieces, i, j);
                        visit(Cell {
                            corners: &corners,
                            index: (face * size + j / pieces) * size + i / pieces,
                            solid_angle,
                        });
                    }
                }
            }
        }
        Layout::Octahedral { size } => {
            let edge = |k: u32| (2.0 * f64::from(k) - f64::from(size)) / f64::from(size);
            for y in band {
                for x in 0..size {
                    octahedral_pieces([edge(x), edge(x + 1)], [edge(y), edge(y + 1)], |corners| {
                        visit(Cell {
                            corners,
                            index: y * size + x,
                            solid_angle: projected_solid_angle(corners),
                        });
                    });
                }
            }
        }
    }
}

/// Cuts a rectangle of the octahedral square along the axes and the fold diagonals.
fn octahedral_pieces(u: [f64; 2], v: [f64; 2], mut visit: impl FnMut(&[DVec3])) {
    let halves = |span: [f64; 2]| {
        let straddles = span[0] < 0.0 && span[1] > 0.0;
        if straddles { vec![[span[0], 0.0], [0.0, span[1]]] } else { vec![span] }
    };
    for u in halves(u) {
        for v in halves(v) {
            let corners = [
                DVec2::new(u[0], v[0]),
                DVec2::new(u[1], v[0]),
                DVec2::new(u[1], v[1]),
                DVec2::new(u[0], v[1]),
            ];
            for_each_face_piece(corners, &mut visit);
        }
    }
}

/// Cells of a panorama between meridians at `columns` and parallels at `row(k)` from +Y, k in `band`.
///
/// A parallel's chords are shared by the cells above and below it, so no area is lost or counted twice.
fn panorama_cells(
    columns: &[f64],
    row: impl Fn(u32) -> f64,
    target: Target,
    band: Range<u32>,
    mut visit: impl FnMut(u32, u32, &[DVec3], f64),
) {
    let meridians: Vec<(f64, f64)> = columns.iter().map(|phi| (phi.cos(), phi.sin())).collect();
    let mut above = Parallel::default();
    let mut below = Parallel::default();
    above.chord(row(band.start), &meridians, target);
    let mut corners = Vec::new();
    for j in band {
        let (top, bottom) = (row(j), row(j + 1));
        below.chord(bottom, &meridians, target);
        // cos(top) - cos(bottom), without its cancellation at the poles.
        let height = 2.0 * ((top + bottom) / 2.0).sin() * ((bottom - top) / 2.0).sin();
        for (i, sides) in (0..).zip(columns.windows(2)) {
            corners.clear();
            corners.extend_from_slice(above.arc(i));
            corners.extend(below.arc(i).iter().rev());
            visit(i, j, &corners, height * (sides[1] - sides[0]));
        }
        std::mem::swap(&mut above, &mut below);
    }
}

/// A parallel, cut at the meridians.
type Parallel = Chords<DVec3>;

impl Parallel {
    fn chord(&mut self, theta: f64, meridians: &[(f64, f64)], target: Target) {
        self.points.clear();
        self.starts.clear();
        let (sin_theta, cos_theta) = theta.sin_cos();
        let at =
            |(cos_phi, sin_phi): (f64, f64)| DVec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi);
        // Texels a radian: at most 3/2 of the square's, and as many on the cube's faces.
        let texels = f64::from(target.edge()) * 1.5;
        for pair in meridians.windows(2) {
            let (a, b) = (at(pair[0]), at(pair[1]));
            // Chord and arc differ most in the middle, by sin(theta) cos(theta) * (1 - cos(half width)).
            let half_width_squared =
                ((pair[1].0 - pair[0].0).powi(2) + (pair[1].1 - pair[0].1).powi(2)) / 4.0;
            let sag = sin_theta * cos_theta.abs() * half_width_squared / 2.0 * texels;
            let chords = (sag / CHORD_SAG).sqrt().ceil().max(1.0);
            // Chords cut off two thirds of their sag, and points between them, moved outwards, restore it.
            let outwards = 1.0 + half_width_squared / (3.0 * chords * (chords - 1.0));
            self.starts.push(self.points.len());
            self.points.push(a);
            for k in 1..chords as u32 {
                // Even steps along the chord, projected back to the parallel, are nearly even along the arc.
                let step = f64::from(k) / chords;
                let (x, z) = (a.x + (b.x - a.x) * step, a.z + (b.z - a.z) * step);
                let lift = outwards * sin_theta / (x * x + z * z).sqrt();
                self.points.push(DVec3::new(x * lift, cos_theta, z * lift));
            }
        }
        self.starts.push(self.points.len());
        self.points.push(at(meridians[meridians.len() - 1]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::equirect::direction_from_equirect;

    #[test]
    fn cells_of_a_panorama_lie_where_its_map_says() {
        let source = Layout::Panorama { width: 8, height: 4 };
        let mut count = 0;
        for_each_cell(source, Target::Octahedral(4), 0..4, |cell| {
            let centre = cell.corners.iter().sum::<DVec3>().normalize();
            let (i, j) = (cell.index % 8, cell.index / 8);
            let expected = direction_from_equirect((f64::from(i) + 0.5) / 8.0, (f64::from(j) + 0.5) / 4.0);
            assert!(centre.dot(expected) > 0.9, "texel ({i}, {j}) at {centre}, expected {expected}");
            count += 1;
        });
        assert_eq!(count, 32, "every texel once");
    }
}
