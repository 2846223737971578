//! Fills the borders in pictures of a whole map.

use super::resample::Continuation;
use crate::common::parallel;
use crate::light::environment::Rgb;
use crate::sphere::grid::Grid;
use crate::sphere::map::Texel;

/// Rows filled together.
const BAND: usize = 16;

/// Draws the components `texels` of `target` as one row-major picture, black elsewhere, with `border` texels
/// around every component. Border texels follow the map's gluing if it maps texels onto texels, else they are
/// the means over their own footprints, by its `continuation`.
pub fn bordered_picture(
    target: &Grid,
    texels: &[Rgb],
    border: u32,
    continuation: &Continuation<'_>,
) -> Vec<Rgb> {
    let [width, height] = target.picture_sides(border).map(|side| side as usize);
    let mut picture = vec![[0.0; 3]; width * height];
    let map = target.map();
    for component in 0..map.components() {
        let sides = target.sides(component).map(i64::from);
        let origin = target.picture_origin(component, border).map(i64::from);
        let border = i64::from(border);
        let texel = |x: i64, y: i64| {
            let inside = (0..sides[0]).contains(&x) && (0..sides[1]).contains(&y);
            let own = inside.then_some(Texel { component, x: x as u32, y: y as u32 });
            own.or_else(|| map.wrap_texel(target.size(), component, x, y))
        };
        let columns = -border..sides[0] + border;
        let (left, top) = ((origin[0] - border) as usize, (origin[1] - border) as usize);
        let last = sides[1] + border;
        let tops = (-border..last).step_by(BAND);
        let bands = picture[top * width..].chunks_mut(BAND * width);
        parallel::for_each(bands.zip(tops), |(rows, top)| {
            let band = top..last.min(top + BAND as i64);
            let mut outside = continuation
                .means(component, columns.clone(), band.clone(), |x, y| texel(x, y).is_none())
                .into_iter();
            for (row, y) in rows.chunks_exact_mut(width).zip(band) {
                for (place, x) in row[left..].iter_mut().zip(columns.clone()) {
                    let mean = outside.next().expect("a mean for every texel");
                    *place = texel(x, y).map_or(mean, |texel| texels[target.index(texel)]);
                }
            }
        });
    }
    picture
}
