//! Draws the seam of the tennis ball, on the sphere and around both panels.

use super::globe::{FRONT, Globe};
use super::sheet::Sheet;
use glam::{DVec2, DVec3};
use octagloss_core::sphere::map::{Place, SphereMap as _};
use octagloss_core::sphere::registry::named;
use octagloss_core::sphere::tennis_ball::{TennisBall, panel, seam_point};
use octagloss_drawing::page::{WIDTH, page};
use octagloss_drawing::scene::{Anchor, Scene};
use octagloss_drawing::style::{Colour, INK, LABEL, mix, rgb};
use octagloss_plot::figure::Figure;
use octagloss_plot::look::SERIES;

/// Fill colours of both panels.
const PANELS: [Colour; 2] = [[236, 243, 203], [222, 232, 245]];

/// Points along each half circle.
const STEPS: u32 = 120;

fn half_circle(k: u32) -> Vec<DVec3> {
    // Stop just short of the ends, which also belong to the next half circle.
    let share = |step: u32| (f64::from(step) / f64::from(STEPS)).clamp(1e-9, 1.0 - 1e-9);
    (0..=STEPS).map(|step| seam_point((f64::from(k) + share(step)) / 4.0)).collect()
}

pub(super) fn seam() -> Figure {
    let title = "Tennis-ball: the seam on the sphere and around both panels".to_owned();
    let caption = "The seam is four half circles, in the half planes y\u{a0}=\u{a0}\u{b1}\u{221a}\u{bd} \
                   where z is positive and x\u{a0}=\u{a0}\u{b1}\u{221a}\u{bd} where it is negative (Herron, \
                   section 2.1). Each has one colour on the sphere and in the panels, whose sides it forms. \
                   Dashed: the parts behind the sphere. C\u{2081} lies around +Z, C\u{2082} around \
                   \u{2212}Z; u is \u{3c6}, v is \u{2212}\u{3b8}.";
    let height = 780.0;
    let (mut scene, body) = page(WIDTH, height, &title, caption);
    let radius = 165.0;
    let half = body.extent().x / 2.0;
    let halves: Vec<Vec<DVec3>> = (0..4).map(half_circle).collect();
    for (k, (eye, label)) in
        [(FRONT, "seen from +X +Y +Z"), (-FRONT, "from the other side")].into_iter().enumerate()
    {
        let centre = DVec2::new(body.low.x + half * (k as f64 + 0.5), body.low.y + radius + 6.0);
        let globe = Globe::new(centre, radius, eye);
        globe.fill(&mut scene, |direction| {
            // Darken slightly towards the rim.
            let fill = PANELS[panel(direction) as usize];
            mix(fill, INK, 0.16 * (1.0 - globe.depth(direction)).powi(2))
        });
        for (half, colour) in halves.iter().zip(SERIES.map(rgb)) {
            for piece in globe.pieces(half, false) {
                scene.dashed(&piece, 1.6, mix(colour, PANELS[1], 0.35), 6.0);
            }
            globe.line(&mut scene, half, 4.0, colour);
        }
        globe.axes(&mut scene);
        scene.text(centre + DVec2::new(0.0, radius + 26.0), label, LABEL, Anchor::Middle, INK);
    }
    let map = named("tennis-ball").expect("one of the maps");
    let top = body.low + DVec2::new(0.0, 2.0 * radius + 46.0);
    let room = octagloss_drawing::scene::Frame::new(top, body.high);
    let sheet = Sheet::fitting(map, room.extent()).placed(&room);
    sheet.fill(&mut scene, 1, |component, _| PANELS[component as usize]);
    sheet.frames(&mut scene);
    for (half, colour) in halves.iter().zip(SERIES.map(rgb)) {
        draw_on_panels(&mut scene, &sheet, half, colour);
    }
    sheet.axes(&mut scene);
    Figure::new(title, caption.to_owned(), scene)
}

/// Draws the seam's curve `points` in both panels.
fn draw_on_panels(scene: &mut Scene, sheet: &Sheet, points: &[DVec3], colour: Colour) {
    for component in 0..2 {
        let middle = TennisBall.direction(component, DVec2::ZERO);
        // Move slightly inside the panel, towards its middle line.
        let inside = |point: &DVec3| {
            let towards = if component == 0 {
                DVec3::new(point.x, 0.0, point.z)
            } else {
                DVec3::new(0.0, point.y, point.z)
            };
            (*point + (towards + middle * 0.2) * 1e-6).normalize()
        };
        let places: Vec<Place> = points.iter().map(|point| TennisBall.locate(inside(point))).collect();
        let line: Vec<DVec2> = places
            .into_iter()
            .filter(|place| place.component == component)
            .map(|place| sheet.at(place))
            .collect();
        scene.line(line, 4.0, colour);
    }
}
