//! Energy of radiances over the texels of a layout.

use super::quadrant::Quadrant;
use super::solid_angles::solid_angles;
use crate::common::parallel;
use crate::light::environment::{Layout, Rgb};
use crate::sphere::{cube, equirect};

/// Solid angles of a layout's texels.
enum Weights {
    /// A panorama's, by row.
    Rows(Vec<f64>),
    /// Those of a cube's face.
    Face(Quadrant<f64>),
    Square(Quadrant<f32>),
}

impl Weights {
    fn new(layout: Layout) -> Self {
        match layout {
            Layout::Panorama { width, height } => {
                Self::Rows((0..height).map(|row| equirect::texel_solid_angle(width, height, row)).collect())
            }
            Layout::Cube { size } => {
                Self::Face(Quadrant::new(size, |x, y| cube::texel_solid_angle(size, x, y)))
            }
            Layout::Octahedral { size } => Self::Square(solid_angles(size)),
        }
    }

    fn at(&self, x: u32, y: u32) -> f64 {
        match self {
            Self::Rows(rows) => rows[y as usize],
            Self::Face(face) => face.at(x, y),
            Self::Square(square) => f64::from(square.at(x, y)),
        }
    }
}

/// Energy of every channel of `texels` over `layout`.
pub(crate) fn energy(layout: Layout, texels: &[Rgb]) -> [f64; 3] {
    let weights = Weights::new(layout);
    let (columns, rows) = layout.sides();
    let of_row = |(row, texels): (usize, &[Rgb])| {
        let y = (row % rows as usize) as u32;
        let mut sums = [0.0; 3];
        for (texel, x) in texels.iter().zip(0..) {
            let weight = weights.at(x, y);
            sums.iter_mut().zip(texel).for_each(|(sum, value)| *sum += weight * f64::from(*value));
        }
        sums
    };
    let sums = parallel::map(texels.chunks(columns as usize).enumerate(), of_row);
    std::array::from_fn(|channel| sums.iter().map(|row| row[channel]).sum())
}
