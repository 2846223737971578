//! Draws a panorama in a map's layout.

use super::content::FigureContent;
use super::figure::Figure;
use super::layout::MAX;
use super::sheet::Sheet;
use crate::geometry::light::Light;
use crate::geometry::resample::resample;
use crate::image::drawing::page::{WIDTH, page};
use crate::image::exposure;
use crate::image::tone::display;
use crate::sphere::map::Texel;
use crate::sphere::registry::NamedMap;
use glam::DMat3;

pub(super) fn panorama(map: &'static NamedMap, content: &FigureContent) -> Figure {
    let title = format!("{}: {}", map.title, content.panorama_name);
    let caption = format!(
        "{} resampled to the map by overlaps of texels, and shown at the exposure that brings its \
         log-average luminance to middle grey. Grey is outside the domain. Dots: the axes.",
        content.panorama_name
    );
    let sheet = Sheet::fitting(map, MAX);
    let (mut scene, body) = page(WIDTH, sheet.extent().y, &title, &caption);
    let sheet = sheet.placed(&body);
    let light = Light::new(&content.panorama, DMat3::IDENTITY).expect("files are 2:1");
    let texels = resample(&light, &sheet.grid);
    let exposure = exposure::of_environment(&content.panorama).exp2();
    sheet.fill(&mut scene, 1, |component, uv| {
        let rectangle = map.map.component(component);
        let at = (uv - rectangle.low) / sheet.grid.step(&rectangle);
        let texel = Texel { component, x: at.x as u32, y: at.y as u32 };
        display(texels[sheet.grid.index(texel)], exposure).0
    });
    sheet.frames(&mut scene);
    sheet.axes(&mut scene);
    Figure::new(title, caption, scene)
}
