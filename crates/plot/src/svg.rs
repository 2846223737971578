//! Renders scenes as SVG. Coordinates are quarter pixels, in whole numbers.

use super::png::png;
use glam::DVec2;
use octagloss_drawing::font::FAMILY;
use octagloss_drawing::scene::{Anchor, Item, Scene, Text};
use octagloss_drawing::style::Colour;

/// Units of the document per pixel.
const SCALE: f64 = 4.0;

/// Offset of a text's baseline below its place in ems.
const BASELINE: f64 = 0.76;

/// Renders `scene` as an SVG document with `title` and description `caption`. Embeds pictures as PNG.
pub(super) fn svg(scene: &Scene, title: &str, caption: &str) -> String {
    let [width, height] = [scene.width, scene.height].map(|side| f64::from(side) * SCALE);
    let elements: String = scene.items.iter().map(element).collect();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {width} \
                                                                                        {height}\">\n\
         <title>{}</title>\n<desc>{}</desc>\n\
         <g stroke-linejoin=\"round\" stroke-linecap=\"round\">\n\
         <rect x=\"0\" y=\"0\" width=\"{width}\" height=\"{height}\" fill=\"#FFFFFF\"/>\n\
         {elements}</g>\n</svg>\n",
        scene.width,
        scene.height,
        escaped(title),
        escaped(caption),
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn place(at: DVec2) -> (i32, i32) {
    let at = (at * SCALE).round();
    (at.x as i32, at.y as i32)
}

fn places(points: &[DVec2]) -> String {
    let listed = |(x, y): (i32, i32)| format!("{x},{y} ");
    points.iter().copied().map(place).map(listed).collect()
}

fn hex([red, green, blue]: Colour) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

fn element(item: &Item) -> String {
    match item {
        Item::Polygon { points, fill } => {
            format!("<polygon opacity=\"1\" fill=\"{}\" points=\"{}\"/>\n", hex(*fill), places(points))
        }
        Item::Line { points, width, colour } => format!(
            "<polyline fill=\"none\" opacity=\"1\" stroke=\"{}\" stroke-width=\"{}\" points=\"{}\"/>\n",
            hex(*colour),
            (width * SCALE).round().max(1.0),
            places(points)
        ),
        Item::Disc { centre, radius, fill } => {
            let ((x, y), radius) = (place(*centre), (radius * SCALE).round());
            format!(
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" opacity=\"1\" fill=\"{}\" stroke=\"none\" \
                 stroke-width=\"1\"/>\n",
                hex(*fill)
            )
        }
        Item::Text(text) => text_element(text),
        Item::Picture { low, high, pixels } => {
            let ((x, y), (right, bottom)) = (place(*low), place(*high));
            format!(
                "<image x=\"{x}\" y=\"{y}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
                 href=\"data:image/png;base64,{}\"/>\n",
                right - x,
                bottom - y,
                base64::encode(png(pixels))
            )
        }
    }
}

fn text_element(text: &Text) -> String {
    let anchor = match text.anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    let up = BASELINE * text.em;
    let way = if text.upwards { DVec2::new(up, 0.0) } else { DVec2::new(0.0, up) };
    let (x, y) = place(text.at - way);
    let turn = if text.upwards { format!(" transform=\"rotate(270, {x}, {y})\"") } else { String::new() };
    format!(
        "<text x=\"{x}\" y=\"{y}\" dy=\"{BASELINE}em\" text-anchor=\"{anchor}\" font-family=\"{FAMILY}\" \
         font-size=\"{}\" opacity=\"1\" fill=\"{}\"{turn}>\n{}\n</text>\n",
        // Rounded as it always was, so that equal figures stay equal files.
        text.em * 1.24 * SCALE / 1.24,
        hex(text.colour),
        escaped(&text.text).replace('"', "&quot;").replace('\'', "&apos;")
    )
}
