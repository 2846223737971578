//! Coordinate planes that are mirrors of two maps at once.

use super::chart::{Chart as _, Domain, Piece};
use crate::sphere::grid::Grid;
use crate::sphere::map::Texel;
use glam::{DMat3, DVec2, DVec3};

/// Directions so little behind a plane count as on it.
const ON_PLANE: f64 = 1e-9;

/// Coordinate planes that map texels of source and target onto texels. The part of the sphere on the positive
/// sides of all of them has [`Mirrors::images`] images, itself among them. `Default` has no mirrors.
#[derive(Clone, Debug, Default)]
pub(super) struct Mirrors {
    /// 0 to 2 for x = 0 to z = 0.
    axes: Vec<usize>,
}

/// Where directions lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// Behind one of the planes.
    Behind,
    /// On the positive sides of all planes.
    Ahead,
    /// On both sides of a plane, or close to one.
    Unknown,
}

impl Mirrors {
    /// Mirrors that both grids have.
    pub(super) fn shared(source: &Grid, target: &Grid) -> Self {
        let is_mirror = |axis: &usize| has_mirror(source, *axis) && has_mirror(target, *axis);
        Self { axes: (0..3).filter(is_mirror).collect() }
    }

    /// Number of images of the part that is computed.
    pub(super) fn images(&self) -> usize {
        1 << self.axes.len()
    }

    /// Whether one of the planes cuts `texel` of `grid`: then it is its own image.
    pub(super) fn cut(&self, grid: &Grid, texel: Texel) -> bool {
        self.axes.iter().any(|axis| grid.mirrored(texel, *axis) == Some(texel))
    }

    /// Whether the unit vector `direction` is behind one of the planes.
    pub(super) fn is_behind(&self, direction: DVec3) -> bool {
        self.axes.iter().any(|axis| direction[*axis] < -ON_PLANE)
    }

    /// The image of `texel` of `grid` that is behind none of the planes. `None` if one is not a texel.
    pub(super) fn ahead(&self, grid: &Grid, texel: Texel) -> Option<Texel> {
        let domain = Domain::new(grid, texel.component, DMat3::IDENTITY);
        let piece = Piece::texel(DVec2::new(f64::from(texel.x), f64::from(texel.y)));
        let middle = domain.direction(piece.middle());
        let mut image = texel;
        for axis in &self.axes {
            let is_behind = match middle {
                Some(direction) if direction[*axis].abs() > ON_PLANE => direction[*axis] < 0.0,
                // Cut by the plane.
                _ if grid.mirrored(texel, *axis)? == texel => false,
                _ => {
                    let mut corners = piece.corners().into_iter().filter_map(|at| domain.direction(at));
                    corners.any(|direction| direction[*axis] < -ON_PLANE)
                }
            };
            if is_behind {
                image = grid.mirrored(image, *axis)?;
            }
        }
        Some(image)
    }

    /// The side of `directions` if they are farther than `margin` from the planes that matter.
    pub(super) fn side(&self, directions: &[DVec3], margin: f64) -> Side {
        let all = |axis: &usize, sign: f64| directions.iter().all(|d| sign * d[*axis] > margin);
        if self.axes.iter().any(|axis| all(axis, -1.0)) {
            Side::Behind
        } else if self.axes.iter().all(|axis| all(axis, 1.0)) {
            Side::Ahead
        } else {
            Side::Unknown
        }
    }

    /// Appends the indices of the images of `texel`, the texel first. `None` if one is not a texel.
    pub(super) fn append(&self, grid: &Grid, texel: Texel, images: &mut Vec<u32>) -> Option<()> {
        let mut places = [grid.centre(texel); 8];
        let mut count = 1;
        for axis in &self.axes {
            let (known, new) = places.split_at_mut(count);
            for (new, known) in new.iter_mut().zip(known) {
                *new = grid.map().mirrored(*known, *axis)?;
            }
            count *= 2;
        }
        for place in &places[..count] {
            let index = grid.index(grid.texel_from_centre(*place)?);
            images.push(u32::try_from(index).expect("texels fit"));
        }
        Some(())
    }
}

/// Whether the plane maps texels of the corners and the middle of every component onto texels.
fn has_mirror(grid: &Grid, axis: usize) -> bool {
    (0..grid.map().components()).all(|component| {
        let [width, height] = grid.sides(component);
        let places = |side: u32| [0, side / 2, side - 1];
        places(height).into_iter().all(|y| {
            places(width).into_iter().all(|x| grid.mirrored(Texel { component, x, y }, axis).is_some())
        })
    })
}
