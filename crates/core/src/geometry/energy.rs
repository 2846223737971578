//! Energy of radiances over the texels of a layout.

use super::quadrant::Quadrant;
use super::solid_angles::solid_angles;
use crate::common::parallel;
use crate::light::environment::{Layout, Rgb};
use crate::sphere::{cube, equirect};

/// Energy of every channel of `texels` over `layout`.
pub(crate) fn energy(layout: Layout, texels: &[Rgb]) -> [f64; 3] {
    match layout {
        Layout::Panorama { width, height } => {
            let of_row = |row| equirect::texel_solid_angle(width, height, row);
            let rows: Vec<f64> = (0..height).map(of_row).collect();
            weighted(layout, texels, |_, y| rows[y as usize])
        }
        Layout::Cube { size } => {
            let face = Quadrant::new(size, |x, y| cube::texel_solid_angle(size, x, y));
            weighted(layout, texels, |x, y| face.at(x, y))
        }
        Layout::Octahedral { size } => {
            let square = solid_angles(size);
            weighted(layout, texels, |x, y| f64::from(square.at(x, y)))
        }
    }
}

/// Sums of `texels` over `layout`, weighted by the solid angles of an image's texels.
fn weighted(layout: Layout, texels: &[Rgb], solid_angle: impl Fn(u32, u32) -> f64 + Sync) -> [f64; 3] {
    let (columns, rows) = layout.sides();
    let of_row = |(row, texels): (usize, &[Rgb])| {
        let y = (row % rows as usize) as u32;
        let mut sums = [0.0; 3];
        for (texel, x) in texels.iter().zip(0..) {
            let weight = solid_angle(x, y);
            sums.iter_mut().zip(texel).for_each(|(sum, value)| *sum += weight * f64::from(*value));
        }
        sums
    };
    let sums = parallel::map(texels.chunks(columns as usize).enumerate(), of_row);
    std::array::from_fn(|channel| sums.iter().map(|row| row[channel]).sum())
}
