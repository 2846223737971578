//! Renders scenes as SVG with plotters, which uses integers: coordinates are quarter pixels.

use super::png::png;
use glam::DVec2;
use octagloss_drawing::font::FAMILY;
use octagloss_drawing::scene::{Anchor, Item, Scene, Text};
use octagloss_drawing::style::Colour;
use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::style::ShapeStyle;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color as _, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, TextStyle};
use std::fmt::Write as _;

/// Units of the document per pixel.
const SCALE: u32 = 4;

/// Ratio of plotters' font size to the em.
const SIZE: f64 = 1.24;
/// Offset of the baseline below a top-anchored text's point in ems.
const BASELINE: f64 = 0.76;

/// Renders `scene` as an SVG document with `title` and description `caption`. Embeds pictures as PNG.
pub(super) fn svg(scene: &Scene, title: &str, caption: &str) -> String {
    let (width, height) = (scene.width * SCALE, scene.height * SCALE);
    let mut document = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {width} \
                                                                                        {height}\">\n\
         <title>{}</title>\n<desc>{}</desc>\n\
         <g stroke-linejoin=\"round\" stroke-linecap=\"round\">\n\
         <rect x=\"0\" y=\"0\" width=\"{width}\" height=\"{height}\" fill=\"#FFFFFF\"/>\n",
        scene.width,
        scene.height,
        escaped(title),
        escaped(caption),
    );
    let is_picture = |item: &Item| matches!(item, Item::Picture { .. });
    // Embedding pictures with plotters would need a second version of `image`.
    for items in scene.items.chunk_by(|a, b| !is_picture(a) && !is_picture(b)) {
        if let [Item::Picture { low, high, pixels }] = items {
            let ((x, y), (right, bottom)) = (point(*low), point(*high));
            let png = png(pixels);
            writeln!(
                document,
                "<image x=\"{x}\" y=\"{y}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
                 href=\"data:image/png;base64,{}\"/>",
                right - x,
                bottom - y,
                base64::encode(png),
            )
            .expect("writing to a string cannot fail");
            continue;
        }
        let mut part = String::new();
        {
            let mut backend = SVGBackend::with_string(&mut part, (width, height));
            items.iter().for_each(|item| draw(&mut backend, item));
            drawn(backend.present());
        }
        // Extract the content between the document's tags.
        let start = part.find('\n').map_or(0, |at| at + 1);
        let end = part.rfind("</svg>").unwrap_or(part.len());
        document.push_str(&part[start..end]);
    }
    document.push_str("</g>\n</svg>\n");
    document
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Drawing to memory cannot fail.
fn drawn<T, E: std::fmt::Debug>(result: Result<T, E>) -> T {
    result.expect("drawing to memory cannot fail")
}

fn point(at: DVec2) -> (i32, i32) {
    let at = (at * f64::from(SCALE)).round();
    (at.x as i32, at.y as i32)
}

fn colour(colour: Colour) -> RGBColor {
    RGBColor(colour[0], colour[1], colour[2])
}

fn draw(backend: &mut SVGBackend<'_>, item: &Item) {
    match item {
        Item::Polygon { points, fill } => {
            drawn(backend.fill_polygon(points.iter().copied().map(point), &colour(*fill)));
        }
        Item::Line { points, width, colour: ink } => {
            let thick = ((width * f64::from(SCALE)).round() as u32).max(1);
            let style = ShapeStyle { color: colour(*ink).to_rgba(), filled: false, stroke_width: thick };
            drawn(backend.draw_path(points.iter().copied().map(point), &style));
        }
        Item::Disc { centre, radius, fill } => {
            let radius = (radius * f64::from(SCALE)).round() as u32;
            drawn(backend.draw_circle(point(*centre), radius, &colour(*fill), true));
        }
        Item::Text(text) => draw_text(backend, text),
        Item::Picture { .. } => unreachable!("drawn by the caller"),
    }
}

fn draw_text(backend: &mut SVGBackend<'_>, text: &Text) {
    let across = match text.anchor {
        Anchor::Start => HPos::Left,
        Anchor::Middle => HPos::Center,
        Anchor::End => HPos::Right,
    };
    let up = BASELINE * text.em;
    let (at, transform) = if text.upwards {
        (text.at - DVec2::new(up, 0.0), FontTransform::Rotate270)
    } else {
        (text.at - DVec2::new(0.0, up), FontTransform::None)
    };
    let size = text.em * SIZE * f64::from(SCALE);
    let font = FontDesc::new(FontFamily::Name(FAMILY), size, FontStyle::Normal).transform(transform);
    let ink = colour(text.colour);
    let style = TextStyle::from(font).color(&ink).pos(Pos::new(across, VPos::Top));
    drawn(backend.draw_text(&text.text, &style, point(at)));
}
