//! Draws a panorama in a map's layout.

use super::content::FigureContent;
use super::layout::MAX;
use super::sheet::Sheet;
use glam::DMat3;
use octagloss_core::files::image::exposure;
use octagloss_core::geometry::light::Light;
use octagloss_core::geometry::resample::resample;
use octagloss_core::sphere::map::Texel;
use octagloss_core::sphere::registry::NamedMap;
use octagloss_drawing::page::{WIDTH, page};
use octagloss_drawing::tone::display;
use octagloss_plot::figure::Figure;

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
        let rectangle = map.map().component(component);
        let at = (uv - rectangle.low) / sheet.grid.step(&rectangle);
        let texel = Texel { component, x: at.x as u32, y: at.y as u32 };
        display(texels[sheet.grid.index(texel)], exposure)
    });
    sheet.frames(&mut scene);
    sheet.axes(&mut scene);
    Figure::new(title, caption, scene)
}
