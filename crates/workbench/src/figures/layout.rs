//! Draws a map's layout: domains, faces, parallels and meridians.

use super::sheet::Sheet;
use glam::DVec2;
use octagloss_core::sphere::registry::NamedMap;
use octagloss_drawing::page::{WIDTH, page};
use octagloss_plot::figure::Figure;

/// Maximum pixels of a layout.
pub(super) const MAX: DVec2 = DVec2::new(930.0, 640.0);

pub(super) fn layout(map: &'static NamedMap) -> Figure {
    let title = format!("{}: layout", map.title);
    let components = map.map().components();
    let parts = match components {
        1 => "one component".to_owned(),
        _ => format!("{components} components, numbered or named above"),
    };
    let caption = format!(
        "The map's domain, {parts}; grey is outside it. Blue: parallels, orange: meridians, every 15\u{b0}; \
         the equator and the planes x\u{a0}=\u{a0}0 and z\u{a0}=\u{a0}0 are thick. Pastels: the eight \
         octants of directions. Dots: the axes. Source: {}.",
        map.source
    );
    let sheet = Sheet::fitting(map, MAX);
    let (mut scene, body) = page(WIDTH, sheet.extent().y, &title, &caption);
    let sheet = sheet.placed(&body);
    sheet.fill_octants(&mut scene);
    sheet.graticule(&mut scene, 15);
    sheet.frames(&mut scene);
    if map.name.starts_with("octahedral") || map.name == "low-distortion" {
        sheet.octant_names(&mut scene);
    }
    sheet.axes(&mut scene);
    Figure::new(title, caption, scene)
}
