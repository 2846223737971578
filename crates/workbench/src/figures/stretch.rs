//! Draws the stretch of maps on the sphere: relative solid angle and anisotropy.

use super::globe::{FRONT, Globe};
use crate::stretch::{Stretch, measure};
use glam::{DVec2, DVec3};
use octagloss_core::sphere::map::SphereMap;
use octagloss_core::sphere::registry::{NamedMap, named};
use octagloss_drawing::page::{BAR_WIDTH, WIDTH, colour_bar, page};
use octagloss_drawing::scale::{ANISOTROPY, ColourScale, RELATIVE_SOLID_ANGLE};
use octagloss_drawing::scene::Frame;
use octagloss_drawing::style::{INK, LABEL, SMALL, SOFT};
use octagloss_plot::figure::Figure;
use std::f64::consts::PI;

/// Height of the drawing with two spheres.
const HEIGHT: f64 = 430.0;

/// The solid angle of a small texel of `map` at `direction` over the mean of all texels.
fn relative_solid_angle(map: &dyn SphereMap, direction: DVec3) -> f64 {
    let place = map.locate(direction);
    let component = map.component(place.component);
    let texels = |k: u32| f64::from(map.component(k).cells.iter().product::<u32>());
    let own = texels(place.component);
    let all: f64 = (0..map.components()).map(texels).sum();
    map.density(place.component, place.uv) * component.area() / own * all / (4.0 * PI)
}

/// The ratio of both stretches of `map` at `direction`.
fn anisotropy_at(map: &dyn SphereMap, direction: DVec3) -> f64 {
    let place = map.locate(direction);
    let component = map.component(place.component);
    // Step towards the rectangle's centre, so no difference crosses its edge.
    let middle = (component.low + component.high) / 2.0;
    let uv = middle.lerp(place.uv, 1.0 - 1e-5);
    let ratio = Stretch::at(map, place.component, uv, 1e-7 * component.extent().min_element()).anisotropy();
    if ratio.is_nan() { f64::INFINITY } else { ratio }
}

/// Formats `value` with two digits, or as the infinity sign.
fn shown(value: f64) -> String {
    if value.is_finite() { format!("{value:.2}") } else { "\u{221e}".to_owned() }
}

pub(super) fn solid_angle(map: &'static NamedMap) -> Figure {
    let [least, greatest] = measure(map.map()).relative_solid_angle;
    let caption = format!(
        "Solid angle of a texel over the mean of all texels, from {} to {}. Purple texels are larger than \
         the mean (undersampled), green ones smaller (oversampled). Dark lines: rims of the map's \
         rectangles and domains. Grey lines: the planes x\u{a0}=\u{a0}0, y\u{a0}=\u{a0}0 and \
         z\u{a0}=\u{a0}0. Left: +X, +Y and +Z face the reader; right: the other side.",
        shown(least),
        shown(greatest)
    );
    let title = format!("{}: relative solid angle", map.title);
    two_views(
        map,
        title,
        caption,
        &RELATIVE_SOLID_ANGLE,
        "solid angle / mean",
        [least, greatest],
        |direction| relative_solid_angle(map.map(), direction),
    )
}

pub(super) fn anisotropy(map: &'static NamedMap) -> Figure {
    let greatest = measure(map.map()).anisotropy;
    let caption = format!(
        "Greater over lesser stretch of a texel, up to {}; 1 is conformal. Dark lines: rims of the map's \
         rectangles and domains. Grey lines: the planes x\u{a0}=\u{a0}0, y\u{a0}=\u{a0}0 and \
         z\u{a0}=\u{a0}0. Left: +X, +Y and +Z face the reader; right: the other side.",
        shown(greatest)
    );
    let title = format!("{}: anisotropy", map.title);
    two_views(map, title, caption, &ANISOTROPY, "greater / lesser stretch", [1.0, greatest], |direction| {
        anisotropy_at(map.map(), direction)
    })
}

/// A figure of `map` from both sides, with `value` of each direction in `colours`; the bar has the `name` of
/// the values and their `range`.
fn two_views(
    map: &NamedMap,
    title: String,
    caption: String,
    colours: &ColourScale,
    name: &str,
    range: [f64; 2],
    value: impl Fn(DVec3) -> f64 + Sync,
) -> Figure {
    let (mut scene, body) = page(WIDTH, HEIGHT, &title, &caption);
    let radius = HEIGHT / 2.0 - 24.0;
    let room = body.extent().x - BAR_WIDTH - 20.0;
    for (share, eye) in [(0.25, FRONT), (0.75, -FRONT)] {
        let centre = DVec2::new(body.low.x + room * share, (body.low.y + body.high.y) / 2.0);
        let globe = Globe::new(centre, radius, eye);
        globe.show(&mut scene, map.map(), |direction| colours.colour(value(direction)));
    }
    let bar =
        Frame::new(DVec2::new(body.high.x - BAR_WIDTH, body.low.y + 30.0), body.high - DVec2::new(0.0, 30.0));
    colour_bar(&mut scene, &bar, colours, name, range);
    Figure::new(title, caption, scene)
}

/// Figure 5 of the octahedron paper.
pub(super) fn compared() -> Figure {
    let title = "Relative solid angle: planar octahedral, perspective octahedral, cube".to_owned();
    let caption = "As figure 5 of Engelhardt and Dachsbacher 2008, in its range of 1/4 to 4: solid angle of \
                   a texel over the mean of all texels. Purple: undersampled, green: oversampled. The \
                   perspective projection has the octahedron's faces as image planes, and is then the \
                   planar projection; the paper shows \
                   another one and does not say which. +X, +Y and +Z face the reader; the other side has \
                   the same values.";
    let height = 336.0;
    let (mut scene, body) = page(WIDTH, height, &title, caption);
    let radius = 133.0;
    let room = body.extent().x - BAR_WIDTH - 10.0;
    let mut extremes = [1.0_f64; 2];
    let maps = ["octahedral", "octahedral-perspective", "cube"];
    for (k, map) in maps.into_iter().enumerate() {
        let map = named(map).expect("one of the maps");
        let x = body.low.x + room * (k as f64 + 0.5) / 3.0;
        let globe = Globe::new(DVec2::new(x, body.low.y + 52.0 + radius), radius, FRONT);
        globe
            .show(&mut scene, map.map(), |d| RELATIVE_SOLID_ANGLE.colour(relative_solid_angle(map.map(), d)));
        let [least, greatest] = measure(map.map()).relative_solid_angle;
        extremes = [extremes[0].min(least), extremes[1].max(greatest)];
        let range = format!("{} to {}", shown(least), shown(greatest));
        scene.centred(DVec2::new(x, body.low.y + 10.0), map.title, LABEL, INK);
        scene.centred(DVec2::new(x, body.low.y + 32.0), &range, SMALL, SOFT);
    }
    let bar =
        Frame::new(DVec2::new(body.high.x - BAR_WIDTH, body.low.y + 40.0), body.high - DVec2::new(0.0, 4.0));
    colour_bar(&mut scene, &bar, &RELATIVE_SOLID_ANGLE, "solid angle / mean", extremes);
    Figure::new(title, caption.to_owned(), scene)
}
