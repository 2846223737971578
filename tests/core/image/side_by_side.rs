//! Two bakes side by side: both errors in one scale, on spheres that mirror what the camera faces.

use glam::DVec3;
use octagloss_core::analysis::channels::Relative;
use octagloss_core::files::image::side_by_side::{Column, TILE, directions, side_by_side};
use octagloss_drawing::scale::RELATIVE_ERROR;

#[test]
fn a_sphere_reflects_the_sun_and_what_is_behind_it_at_its_rim() {
    let count = (TILE * TILE) as usize;
    for sun in [None, Some(DVec3::new(0.6, 0.64, 0.48)), Some(DVec3::Y)] {
        let seen = directions(sun);
        assert_eq!(seen.len(), count);
        assert!(seen.iter().all(|direction| direction.is_normalized()));
        // The middle reflects the camera, the rim the background.
        let (middle, rim) = (seen[count / 2 + TILE as usize / 2], seen[0]);
        assert!(middle.dot(rim) < -0.99, "{middle} {rim}");
        if let Some(sun) = sun {
            let nearest = seen.iter().map(|direction| direction.dot(sun)).fold(-1.0, f64::max);
            assert!(nearest > 0.999, "{sun} is not reflected: {nearest}");
        }
    }
}

#[test]
fn the_errors_of_both_bakes_have_the_colours_of_one_scale() {
    let count = (TILE * TILE) as usize;
    let error = |luminance: f64| Relative { luminance, channels: [luminance; 3] };
    let column = Column {
        roughness: 0.5,
        reference: vec![[1.0; 3]; count],
        // The second has a wrong hue of the same luminance.
        bakes: [vec![[1.02; 3]; count], vec![[1.2, 1.0 - 0.2 * 0.2126 / 0.7152, 1.0]; count]],
        errors: [error(0.02), error(0.0)],
    };
    let picture = side_by_side(["a.ktx2", "b"], "sky.exr", &[column]).picture();
    let share = 1.0 + 1e-3;
    let shown = [0.02 / share, 0.2 / share].map(|error| RELATIVE_ERROR.colour(error));
    // Colours of the middle of the column, from above: three spheres and two of errors.
    let x = 26 + 96 + TILE / 2;
    let mut found = Vec::new();
    for y in 0..picture.height() {
        let colour = picture.pixel(x, y);
        let near = |(a, b): (&u8, &u8)| a.abs_diff(*b) <= 1;
        let kind = shown.iter().position(|shown| shown.iter().zip(&colour).all(near));
        if let Some(kind) = kind
            && found.last() != Some(&kind)
        {
            found.push(kind);
        }
    }
    assert_eq!(found, [0, 1], "the errors of a, then of b");
}
