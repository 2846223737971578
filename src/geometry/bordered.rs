//! Fills the borders in pictures of a whole map.

use crate::environment::Rgb;
use crate::sphere::grid::Grid;
use crate::sphere::map::Texel;
use glam::DVec3;
use rayon::prelude::*;

/// Draws the components `texels` of `target` as one row-major picture, black elsewhere, with `border` texels
/// around every component. Border texels follow the map's gluing if it maps texels onto texels, else they are
/// the mean of 4 x 4 directions of `look`.
pub fn bordered_picture(
    target: &Grid,
    texels: &[Rgb],
    border: u32,
    look: impl Fn(DVec3) -> Rgb + Sync,
) -> Vec<Rgb> {
    let [width, height] = target.picture_sides(border).map(|side| side as usize);
    let mut picture = vec![[0.0; 3]; width * height];
    let map = target.map();
    for component in 0..map.components() {
        let sides = target.sides(component).map(i64::from);
        let origin = target.picture_origin(component, border).map(i64::from);
        let border = i64::from(border);
        let rows: Vec<Vec<Rgb>> = (-border..sides[1] + border)
            .into_par_iter()
            .map(|y| {
                (-border..sides[0] + border)
                    .map(|x| {
                        let inside = (0..sides[0]).contains(&x) && (0..sides[1]).contains(&y);
                        let texel = if inside {
                            Some(Texel { component, x: x as u32, y: y as u32 })
                        } else {
                            map.wrap_texel(target.size(), component, x, y)
                        };
                        match texel {
                            Some(texel) => texels[target.index(texel)],
                            None => mean_around(target, component, x, y, &look),
                        }
                    })
                    .collect()
            })
            .collect();
        for (row, y) in rows.into_iter().zip(origin[1] - border..) {
            let start = y as usize * width + (origin[0] - border) as usize;
            picture[start..start + row.len()].copy_from_slice(&row);
        }
    }
    picture
}

/// The mean of `look` over 4 x 4 directions of the texel in column `x`, row `y`, outside its image.
pub(crate) fn mean_around(target: &Grid, component: u32, x: i64, y: i64, look: impl Fn(DVec3) -> Rgb) -> Rgb {
    let mut sum = [0.0_f64; 3];
    for k in 0..16 {
        let share = |k: u32| (f64::from(k) + 0.5) / 4.0;
        let uv = target.uv(component, x as f64 + share(k % 4), y as f64 + share(k / 4));
        for (sum, value) in sum.iter_mut().zip(look(target.map().direction(component, uv))) {
            *sum += f64::from(value) / 16.0;
        }
    }
    sum.map(|sum| sum as f32)
}
