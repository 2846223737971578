//! Draws the octahedron unfolded to the square and to the rectangle.

use super::globe::Globe;
use super::sheet::Sheet;
use glam::{DVec2, DVec3};
use octagloss_core::sphere::registry::named;
use octagloss_drawing::page::{WIDTH, page};
use octagloss_drawing::scene::{Anchor, Frame, Scene};
use octagloss_drawing::style::{INK, LABEL, rgb};
use octagloss_plot::figure::Figure;
use octagloss_plot::look::OCTANTS;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

pub(super) fn unfolding() -> Figure {
    let title = "The octahedron and its unfolding".to_owned();
    let caption = "As figure 1 of Engelhardt and Dachsbacher 2008. The upper faces are flattened onto the \
                   plane y\u{a0}=\u{a0}0; the edges at \u{2212}Y are cut, and the lower faces turn outwards \
                   around the equator. This gives the square, whose four corners are \u{2212}Y. The \
                   rectangle has the upper faces in its left half and the lower ones in its right half.";
    let (mut scene, body) = page(WIDTH, 776.0, &title, caption);
    let third = body.extent().x / 3.0;
    let eye = DVec3::new(0.45, 0.95, 1.0);
    for (place, share, radius, label) in [
        (0.5, 0.0, 128.0, "octahedron"),
        (1.5, 0.5, 112.0, "lower faces turn outwards"),
        (2.5, 0.85, 96.0, "nearly flat"),
    ] {
        let centre = DVec2::new(body.low.x + third * place, body.low.y + 130.0);
        draw_octahedron(&mut scene, &Globe::new(centre, radius, eye), share);
        let below = DVec2::new(centre.x, body.low.y + 302.0);
        scene.text(below, label, LABEL, Anchor::Middle, INK);
    }
    let top = body.low.y + 338.0;
    let square = Frame::new(DVec2::new(body.low.x, top), DVec2::new(body.low.x + 400.0, body.high.y));
    let rectangle = Frame::new(DVec2::new(body.low.x + 410.0, top + 60.0), body.high);
    for (map, frame, label) in [
        ("octahedral", square, "quadratic layout (equation 2)"),
        ("octahedral-rectangular", rectangle, "rectangular layout (equation 3)"),
    ] {
        let map = named(map).expect("one of the maps");
        let sheet = Sheet::fitting(map, frame.extent() - DVec2::new(0.0, 34.0)).placed(&frame);
        sheet.fill_octants(&mut scene);
        sheet.graticule(&mut scene, 90);
        sheet.frames(&mut scene);
        sheet.octant_names(&mut scene);
        sheet.axes(&mut scene);
        let own = sheet.frame(0);
        let below = DVec2::new((own.low.x + own.high.x) / 2.0, own.high.y + 42.0);
        scene.text(below, label, LABEL, Anchor::Middle, INK);
    }
    Figure::new(title, caption.to_owned(), scene)
}

/// The octahedron with its upper faces flattened and its lower ones rotated by the fraction `share`.
fn draw_octahedron(scene: &mut Scene, globe: &Globe, share: f64) {
    let mut faces: Vec<(f64, usize, [DVec3; 3])> = (0..8_usize)
        .map(|octant| {
            let sign = |bit: usize| if octant & bit == 0 { 1.0 } else { -1.0 };
            let (x, z) = (DVec3::X * sign(1), DVec3::Z * sign(4));
            let apex = if octant & 2 == 0 { DVec3::Y * (1.0 - share) } else { lower_apex(x + z, share) };
            let middle = (x + z + apex) / 3.0;
            (globe.depth(middle), octant, [x, z, apex])
        })
        .collect();
    // Sort back to front.
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, octant, corners) in &faces {
        let corners = corners.map(|corner| globe.place(corner).0);
        scene.polygon(corners, rgb(OCTANTS[*octant]));
        scene.outline(corners, 1.4, INK);
    }
    let bounds = Frame::new(globe.centre - globe.radius * 2.2, globe.centre + globe.radius * 2.2);
    let mut corners =
        vec![(DVec3::X, "+X"), (DVec3::Z, "+Z"), (DVec3::NEG_X, "\u{2212}X"), (DVec3::NEG_Z, "\u{2212}Z")];
    if share == 0.0 {
        corners.extend([(DVec3::Y, "+Y"), (DVec3::NEG_Y, "\u{2212}Y")]);
    } else {
        let below = [1.0, -1.0].into_iter().flat_map(|x| [1.0, -1.0].map(|z| DVec3::new(x, 0.0, z)));
        corners.extend(below.map(|side| (lower_apex(side, share), "\u{2212}Y")));
        corners.push((DVec3::Y * (1.0 - share), "+Y"));
    }
    for (corner, name) in corners {
        if !faces.iter().any(|(.., face)| hides(globe, *face, corner)) {
            scene.point(globe.place(corner).0, name, &bounds);
        }
    }
}

/// Whether the triangle `face` occludes `point`.
fn hides(globe: &Globe, face: [DVec3; 3], point: DVec3) -> bool {
    let [a, b, c] = face.map(|corner| globe.place(corner).0);
    let at = globe.place(point).0;
    let whole = (b - a).perp_dot(c - a);
    let shares = [(b - at).perp_dot(c - at), (c - at).perp_dot(a - at), (a - at).perp_dot(b - at)];
    let depth: f64 = shares.iter().zip(face).map(|(share, corner)| share / whole * globe.depth(corner)).sum();
    shares.iter().all(|share| share / whole > 1e-6) && depth > globe.depth(point) + 1e-6
}

/// Position of -Y on the face at the edge between `side`'s x and z, at the fraction `share` of the unfolding.
fn lower_apex(side: DVec3, share: f64) -> DVec3 {
    let outwards = side / SQRT_2;
    let middle = side / 2.0;
    // Rotate about the edge's midpoint from the octahedron's -Y to the square's corner.
    let from = DVec2::new(-FRAC_1_SQRT_2, -1.0);
    let to = DVec2::new(FRAC_1_SQRT_2, 0.0);
    let (start, end) = (from.to_angle(), to.to_angle());
    let length = from.length() + (to.length() - from.length()) * share;
    let at = DVec2::from_angle(start + (end - start) * share) * length;
    middle + outwards * at.x + DVec3::Y * at.y
}
