//! Look-ups in octahedral maps: texture coordinates, and the mip level of a pixel's cell.
//!
//! Engelhardt and Dachsbacher 2008, section 4.2. The cell of a pixel is spanned by its direction and those of
//! two neighbours. Its extent in the texture selects the mip level (equation 4). Where the unfolding
//! separates neighbours, coordinates jump and equation 4 alone selects a level that is far too coarse.

use super::octahedral::oct_from_direction;
use glam::{DVec2, DVec3};

/// The directions of a pixel and of its neighbours to the right and below, of any length but zero.
pub type Cell = [DVec3; 3];

/// Texture coordinates in [0, 1]^2 of `direction` in the quadratic layout.
///
/// The listing of section 4.2, corrected: its upper half keeps `d.xy` where the map has `d.xz`, and its
/// `sign` is 0 in the planes x = 0 and z = 0.
pub fn quadratic_coordinates(direction: DVec3) -> DVec2 {
    oct_from_direction(direction) * 0.5 + 0.5
}

/// Equation 4: the mip level of a cell with `corners` in texels of level 0; negative for magnification.
pub fn level_of_corners(corners: [DVec2; 3]) -> f64 {
    let [own, right, below] = corners;
    0.5 * (right - own).length_squared().max((below - own).length_squared()).log2()
}

/// Equation 4 for `cell` in a quadratic layout of `inner` texels, as it is: too coarse where the cell
/// crosses x = 0 or z = 0 in the lower hemisphere.
pub fn level_of_cell(cell: Cell, inner: u32) -> f64 {
    level_of_corners(cell.map(|direction| quadratic_coordinates(direction) * f64::from(inner)))
}

/// The mip level of `cell` in a quadratic layout of `inner` texels: the smaller of the levels of the cell and
/// of its reflection at the plane y = 0.
///
/// The reflection has the same shape in the texture and the cuts of the other hemisphere, so one of the two
/// is contiguous, except around ±X and ±Z, where both jump by less than the cell's own size.
pub fn quadratic_level(cell: Cell, inner: u32) -> f64 {
    let mirrored = cell.map(|direction| DVec3::new(direction.x, -direction.y, direction.z));
    level_of_cell(cell, inner).min(level_of_cell(mirrored, inner))
}

/// Array layer (0 for y >= 0, else 1) and coordinates in [-1, 1]^2 of `direction` in the rectangular layout
/// with one layer per hemisphere: equation 3 without its shift.
pub fn rectangular_place(direction: DVec3) -> (u32, DVec2) {
    let p = direction / (direction.x.abs() + direction.y.abs() + direction.z.abs());
    if p.y >= 0.0 { (0, DVec2::new(p.x - p.z, p.x + p.z)) } else { (1, DVec2::new(p.z - p.x, p.x + p.z)) }
}

/// The greatest mip level whose bilinear look-ups are right in a texture of `inner` texels with a safety
/// border of `border` texels on every side; `None` without a border, where not even level 0 is.
///
/// A look-up at the edge of the square reads half a texel beyond it: level k needs a border of 2^(k-1)
/// texels. The whole side must halve k times, or texels of level k are not means of whole texels.
pub const fn greatest_level(inner: u32, border: u32) -> Option<u32> {
    if border == 0 {
        return None;
    }
    let (halvings, reach) = ((inner + 2 * border).trailing_zeros(), border.ilog2() + 1);
    Some(if halvings < reach { halvings } else { reach })
}
