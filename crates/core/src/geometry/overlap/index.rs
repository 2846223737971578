//! Index maps between an octant and the whole sphere.
//!
//! An octant is three bits: 1 where x < 0, 2 where y < 0, 4 where z < 0. Grid positions in an octant are
//! those of the mirrored octant x, y, z >= 0; along an axis with n texels they run from n/2 to n, and
//! mirroring takes cell c to n - 1 - c, for odd n too.

use crate::light::environment::Layout;
use glam::DVec3;

/// Target grid of the energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// An octahedral square of this many texels along an edge.
    Octahedral(u32),
    /// A cube with faces of this many texels along an edge.
    Cube(u32),
}

impl Target {
    /// Total number of texels.
    #[must_use]
    pub const fn texel_count(self) -> usize {
        match self {
            Self::Octahedral(n) => n as usize * n as usize,
            Self::Cube(n) => 6 * n as usize * n as usize,
        }
    }

    /// Texels along an edge.
    #[must_use]
    pub const fn edge(self) -> u32 {
        match self {
            Self::Octahedral(n) | Self::Cube(n) => n,
        }
    }

    /// The corner before texel (`i`, `j`) of the octant x, y, z >= 0, on the octahedron or the cube.
    pub(super) fn octant_corner(self, family: u32, i: u32, j: u32) -> DVec3 {
        let half = f64::from(self.edge() / 2);
        let (i, j) = (f64::from(i), f64::from(j));
        let (a, b) = (i / half, j / half);
        match (self, family) {
            (Self::Octahedral(_), _) => DVec3::new(a, (half - i - j) / half, b),
            (Self::Cube(_), 0) => DVec3::new(1.0, b, a),
            (Self::Cube(_), 1) => DVec3::new(a, 1.0, b),
            (Self::Cube(_), _) => DVec3::new(a, b, 1.0),
        }
    }
}

/// Whether both grids are the same in all eight octants.
pub(super) fn is_symmetric(source: Layout, target: Target) -> bool {
    let even = |n: u32| n.is_multiple_of(2);
    let source_even = match source {
        // Rows are symmetric in y for every height; columns in x and z once the centre is a boundary.
        Layout::Panorama { width, .. } => even(width),
        Layout::Cube { size } | Layout::Octahedral { size } => even(size),
    };
    source_even && even(target.edge())
}

/// The mirror signs of an octant.
pub(super) fn octant_signs(octant: usize) -> DVec3 {
    let sign = |bit: usize| if octant & bit == 0 { 1.0 } else { -1.0 };
    DVec3::new(sign(1), sign(2), sign(4))
}

const fn mirrored(n: u32, cell: u32, negative: bool) -> u32 {
    if negative { n - 1 - cell } else { cell }
}

/// Texel of the octahedral square from an octant's cell: (`x`, `y`) along |u|, |v|.
pub(super) fn octahedral_texel(n: u32, octant: usize, x: u32, y: u32) -> u32 {
    mirrored(n, y, octant & 4 != 0) * n + mirrored(n, x, octant & 1 != 0)
}

/// Texel of the cube from an octant's cell (`i`, `j`) along |s|, |t| of `family`: 0, 1, 2 for the faces
/// across x, y, z.
pub(super) fn cube_texel(n: u32, family: usize, octant: usize, i: u32, j: u32) -> u32 {
    let (x, y, z) = (octant & 1 != 0, octant & 2 != 0, octant & 4 != 0);
    // From the face table: where s or t decreases along its mirrored axis.
    let (face, flip_s, flip_t) = match family {
        0 => (u32::from(x), x == z, !y),
        1 => (2 + u32::from(y), x, y != z),
        _ => (4 + u32::from(z), x != z, !y),
    };
    (face * n + mirrored(n, j, flip_t)) * n + mirrored(n, i, flip_s)
}

/// Packs a source cell of the first octant: family and position along each axis.
pub(super) const fn pack(family: u32, i: u32, j: u32) -> u32 {
    family << 30 | j << 15 | i
}

/// Maps one octant's packed cells to source texels: affine in a cell's position, one map a family.
#[derive(Clone, Copy, Debug)]
pub(super) struct SourceMap {
    /// Texel of position (0, 0), and the steps along i and j.
    pub(super) families: [[i64; 3]; 3],
}

impl SourceMap {
    /// The map of `octant`; even sizes only.
    pub(super) fn new(source: Layout, octant: usize) -> Self {
        let families = [0, 1, 2].map(|family| {
            let at = |i: i64, j: i64| source_index(source, octant, family, i, j);
            let origin = at(0, 0);
            [origin, at(1, 0) - origin, at(0, 1) - origin]
        });
        Self { families }
    }

    /// The texel of a packed cell.
    #[inline]
    pub(super) fn texel(&self, packed: u32) -> usize {
        let [origin, step_i, step_j] = self.families[(packed >> 30) as usize];
        let (i, j) = (i64::from(packed & 0x7fff), i64::from((packed >> 15) & 0x7fff));
        (origin + i * step_i + j * step_j) as usize
    }
}

/// The source texel of cell (`i`, `j`) of `family` in `octant`, for positions inside the source.
fn source_index(source: Layout, octant: usize, family: usize, i: i64, j: i64) -> i64 {
    let mirrored = |n: u32, cell: i64, negative: bool| if negative { i64::from(n) - 1 - cell } else { cell };
    let (x, y, z) = (octant & 1 != 0, octant & 2 != 0, octant & 4 != 0);
    match source {
        Layout::Panorama { width, height } => {
            // Columns count from the +-X meridian towards +-Z.
            let half = i64::from(width / 2);
            let column = match (x, z) {
                (false, false) => half + i,
                (false, true) => half - 1 - i,
                (true, false) => i64::from(width) - 1 - i,
                (true, true) => i,
            };
            mirrored(height, j, y) * i64::from(width) + column
        }
        Layout::Cube { size } => i64::from(cube_texel(size, family, octant, i as u32, j as u32)),
        Layout::Octahedral { size } => {
            // Below the fold the diagonal |u| + |v| = 1 mirrors the cells.
            let (half, top) = (i64::from(size / 2), i64::from(size) - 1);
            let (u, v) = if y { (top - (j - half), top - (i - half)) } else { (i, j) };
            mirrored(size, v, z) * i64::from(size) + mirrored(size, u, x)
        }
    }
}

/// Rows of a symmetric matrix: the first octant's texels.
pub(super) const fn octant_rows(target: Target) -> usize {
    let half = target.edge() as usize / 2;
    match target {
        Target::Octahedral(_) => half * half,
        Target::Cube(_) => 3 * half * half,
    }
}

/// Row of a symmetric matrix from a texel of the first octant.
pub(super) const fn octant_row(target: Target, texel: u32) -> usize {
    let (n, texel) = (target.edge() as usize, texel as usize);
    let half = n / 2;
    match target {
        Target::Octahedral(_) => (texel / n - half) * half + (texel % n - half),
        Target::Cube(_) => {
            // The first octant sees +X with s and t flipped, +Y as it is, +Z with t flipped.
            let (face, j, i) = (texel / (n * n), texel / n % n, texel % n);
            let j = if face == 2 { j } else { n - 1 - j };
            let i = if face == 0 { n - 1 - i } else { i };
            ((face / 2) * half + (j - half)) * half + (i - half)
        }
    }
}

/// Columns per octant of a panorama that is symmetric under exchange of x and z; `None` for other sources.
pub(super) const fn diagonal_columns(source: Layout) -> Option<u32> {
    match source {
        Layout::Panorama { width, .. } if width.is_multiple_of(8) => Some(width / 4),
        _ => None,
    }
}

/// A packed cell of such a panorama with x and z exchanged.
pub(super) const fn diagonal_cell(columns: u32, packed: u32) -> u32 {
    let (i, j) = (packed & 0x7fff, (packed >> 15) & 0x7fff);
    pack(0, columns - 1 - i, j)
}

/// Row of a symmetric matrix with x and z exchanged.
pub(super) const fn diagonal_row(target: Target, row: usize) -> usize {
    let half = target.edge() as usize / 2;
    let (family, j, i) = (row / (half * half), row / half % half, row % half);
    match (target, family) {
        // Families 0 and 2 have y along their rows.
        (Target::Cube(_), 0 | 2) => ((2 - family) * half + j) * half + i,
        _ => (family * half + i) * half + j,
    }
}

/// The octants that a target texel lies in (two on a fold diagonal), each with its row of a symmetric matrix.
#[inline]
pub(super) fn octants_of_texel(target: Target, texel: usize) -> [Option<(usize, usize)>; 2] {
    let n = target.edge() as usize;
    let half = n / 2;
    match target {
        Target::Octahedral(_) => {
            let (x, y) = (texel % n, texel / n);
            let fold = |k: usize| if k >= half { (0, k - half) } else { (1, half - 1 - k) };
            let ((sign_x, x), (sign_y, y)) = (fold(x), fold(y));
            let upper = sign_x | sign_y << 2;
            let lower_row = (half - 1 - x) * half + (half - 1 - y);
            [
                (x + y < half).then_some((upper, y * half + x)),
                (x + y + 1 >= half).then_some((upper | 2, lower_row)),
            ]
        }
        Target::Cube(_) => {
            let (face, j, i) = (texel / (n * n), texel / n % n, texel % n);
            // The inverse of `cube_texel`: a face's own axis, and where s and t grow along theirs.
            let (negative, left, above) = (face & 1 == 1, i < half, j < half);
            let signs = match face / 2 {
                0 => [negative, !above, negative == left],
                1 => [left, negative, negative != above],
                _ => [negative != left, !above, negative],
            };
            let octant = signs.iter().rev().fold(0, |octant, sign| octant << 1 | usize::from(*sign));
            let fold = |k: usize| if k >= half { k - half } else { half - 1 - k };
            [Some((octant, ((face / 2) * half + fold(j)) * half + fold(i))), None]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::cube::{Face, cube_from_direction, direction_from_texel};

    #[test]
    fn texels_of_a_cube_lie_in_their_octants() {
        let n = 6;
        for texel in 0..Target::Cube(n).texel_count() {
            let (face, at) = (texel / 36, texel as u32 % 36);
            let direction = direction_from_texel(Face::ALL[face], n, at % n, at / n);
            let [Some((octant, _)), None] = octants_of_texel(Target::Cube(n), texel) else {
                panic!("texel {texel} is not in one octant");
            };
            assert!((direction * octant_signs(octant)).min_element() > 0.0, "texel {texel}: octant {octant}");
        }
    }

    #[test]
    fn quarter_faces_agree_with_the_face_table() {
        let n = 6;
        for octant in 0..8 {
            for family in 0..3 {
                for (i, j) in [(3, 3), (5, 3), (3, 5), (4, 5)] {
                    let (s, t) = ((f64::from(i) + 0.5) / 3.0 - 1.0, (f64::from(j) + 0.5) / 3.0 - 1.0);
                    let local = match family {
                        0 => DVec3::new(1.0, t, s),
                        1 => DVec3::new(s, 1.0, t),
                        _ => DVec3::new(s, t, 1.0),
                    };
                    let (face, s, t) = cube_from_direction(local * octant_signs(octant));
                    let cell = |x: f64| ((x + 1.0) * 3.0) as u32;
                    let expected = (face.index() as u32 * n + cell(t)) * n + cell(s);
                    assert_eq!(
                        cube_texel(n, family, octant, i, j),
                        expected,
                        "octant {octant} family {family}"
                    );
                }
            }
        }
    }
}
