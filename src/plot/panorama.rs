//! Draws a panorama in a map's layout.

use super::catalogue::Content;
use super::figure::Figure;
use super::layout::MOST;
use super::sheet::Sheet;
use crate::environment::{Environment, Layout, Rgb};
use crate::geometry::resample::resample;
use crate::image::drawing::page::{WIDTH, page};
use crate::image::exposure;
use crate::image::tone::display;
use crate::sphere::grid::Grid;
use crate::sphere::map::Texel;
use crate::sphere::registry::{NamedMap, named};

pub(super) fn panorama(name: String, map: &'static NamedMap, content: &Content) -> Figure {
    let title = format!("{}: {}", map.title, content.panorama_name);
    let caption = format!(
        "{} resampled to the map by overlaps of texels, and shown at the exposure that brings its \
         log-average luminance to middle grey. Grey is outside the domain. Dots: the axes.",
        content.panorama_name
    );
    let sheet = Sheet::fitting(map, MOST);
    let (mut scene, body) = page(WIDTH, sheet.extent().y, &title, &caption);
    let sheet = sheet.placed(&body);
    let texels = resampled(&content.panorama, &sheet.grid);
    let exposure = exposure::of_environment(&content.panorama).exp2();
    sheet.fill(&mut scene, 1, |component, uv| {
        let rectangle = map.map.component(component);
        let at = (uv - rectangle.low) / sheet.grid.step(&rectangle);
        let texel = Texel { component, x: at.x as u32, y: at.y as u32 };
        display(texels[sheet.grid.index(texel)], exposure).0
    });
    sheet.frames(&mut scene);
    sheet.axes(&mut scene);
    Figure::new(name, title, caption, scene)
}

/// Mean radiance of `environment` over every texel of `target`.
fn resampled(environment: &Environment, target: &Grid) -> Vec<Rgb> {
    let (map, size) = match environment.layout() {
        Layout::Panorama { height, .. } => ("equirect", height),
        Layout::Cube { size } => ("cube", size),
        Layout::Octahedral { size } => ("octahedral", size),
    };
    let map = named(map).expect("one of the maps");
    let source = Grid::new(map.map, size).expect("an environment's size");
    resample(&source, environment.texels(), environment.source_from_world().transpose(), target)
}
