//! Renders scenes as PNG and SVG with plotters.
//!
//! Draws both at four times the size. PNG averages 4 x 4 pixels for antialiasing; SVG gets coordinates in
//! quarter pixels, since plotters uses integers.

use super::look::{Colour, PAPER};
use super::scene::{Anchor, Item, Scene, Text};
use glam::DVec2;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _, RgbImage};
use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color as _, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, TextStyle};
use plotters::style::{ShapeStyle, register_font};
use std::fmt::Write as _;
use std::sync::LazyLock;

/// Supersampling factor along each axis.
const SCALE: u32 = 4;

/// Font families in SVG; PNG uses the first, which is embedded.
const FAMILY: &str = "Ubuntu, Arial, sans-serif";

/// Ratio of plotters' font size to the em in PNG: ascent plus descent of Ubuntu Light.
const BITMAP_SIZE: f64 = 1.121;
/// Ratio of plotters' font size to the em in SVG.
const SVG_SIZE: f64 = 1.24;
/// Offset of the baseline below a top-anchored text's point in plotters, in font sizes.
const BITMAP_BASELINE: f64 = 0.5;
/// The same offset in SVG: 0.76 em.
const SVG_BASELINE: f64 = 0.76 / SVG_SIZE;

/// Registers the font once; true on success.
static FONT: LazyLock<bool> =
    LazyLock::new(|| register_font(FAMILY, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT).is_ok());

fn font(size: f64) -> FontDesc<'static> {
    assert!(*FONT, "the program's own font is readable");
    FontDesc::new(FontFamily::Name(FAMILY), size, FontStyle::Normal)
}

/// Width of `text` in pixels at `em` pixels per em.
pub(super) fn text_width(text: &str, em: f64) -> f64 {
    let size = em * BITMAP_SIZE * f64::from(SCALE);
    let (width, _) = font(size).box_size(text).expect("the program's own font is registered");
    f64::from(width) / f64::from(SCALE)
}

/// Differences between the two formats.
#[derive(Clone, Copy)]
struct Form {
    size: f64,
    baseline: f64,
    /// Whether to draw lines segment by segment; plotters' wide lines have artefacts at crossings.
    pieces: bool,
}

const BITMAP: Form = Form { size: BITMAP_SIZE, baseline: BITMAP_BASELINE, pieces: true };
const SVG: Form = Form { size: SVG_SIZE, baseline: SVG_BASELINE, pieces: false };

/// Renders `scene` as a picture.
pub(super) fn picture(scene: &Scene) -> RgbImage {
    let (width, height) = (scene.width * SCALE, scene.height * SCALE);
    let mut large = RgbImage::from_pixel(width, height, image::Rgb(PAPER));
    {
        let mut backend = BitMapBackend::with_buffer(&mut large, (width, height));
        for item in &scene.items {
            if let Item::Picture { low, high, pixels } = item {
                let (low, high) = (point(*low), point(*high));
                let sides = ((high.0 - low.0).max(1) as u32, (high.1 - low.1).max(1) as u32);
                drawn(backend.blit_bitmap(low, sides, &stretched(pixels, sides)));
            } else {
                draw(&mut backend, item, BITMAP);
            }
        }
        drawn(backend.present());
    }
    let (row, scale) = (3 * width as usize, SCALE as usize);
    let mut means = Vec::with_capacity(large.as_raw().len() / (scale * scale));
    for rows in large.as_raw().chunks_exact(row * scale) {
        for left in (0..row).step_by(3 * scale) {
            for channel in left..left + 3 {
                let sample = |k: usize| u32::from(rows[k / scale * row + channel + k % scale * 3]);
                let sum: u32 = (0..scale * scale).map(sample).sum();
                means.push(((sum + SCALE * SCALE / 2) / (SCALE * SCALE)) as u8);
            }
        }
    }
    RgbImage::from_raw(scene.width, scene.height, means).expect("a mean for every pixel")
}

/// Draws `pixels` over an area of `sides`, each as a rectangle.
fn stretched(pixels: &RgbImage, sides: (u32, u32)) -> Vec<u8> {
    let nearest = |k: u32, from: u32, to: u32| (u64::from(k) * u64::from(from) / u64::from(to)) as usize;
    let columns: Vec<usize> = (0..sides.0).map(|x| 3 * nearest(x, pixels.width(), sides.0)).collect();
    let mut bytes = Vec::with_capacity(3 * sides.0 as usize * sides.1 as usize);
    for y in 0..sides.1 {
        let start = 3 * pixels.width() as usize * nearest(y, pixels.height(), sides.1);
        let row = &pixels.as_raw()[start..];
        columns.iter().for_each(|x| bytes.extend_from_slice(&row[*x..*x + 3]));
    }
    bytes
}

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
            items.iter().for_each(|item| draw(&mut backend, item, SVG));
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

/// Encodes `pixels` as PNG without filters, which halves the size of flat colours.
pub(super) fn png(pixels: &RgbImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::NoFilter);
    let (width, height) = pixels.dimensions();
    drawn(encoder.write_image(pixels.as_raw(), width, height, ExtendedColorType::Rgb8));
    bytes
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

fn draw<B: DrawingBackend>(backend: &mut B, item: &Item, form: Form) {
    match item {
        Item::Polygon { points, fill } => {
            drawn(backend.fill_polygon(points.iter().copied().map(point), &colour(*fill)));
        }
        Item::Line { points, width, colour: ink } => {
            let thick = ((width * f64::from(SCALE)).round() as u32).max(1);
            let style = ShapeStyle { color: colour(*ink).to_rgba(), filled: false, stroke_width: thick };
            if !form.pieces {
                return drawn(backend.draw_path(points.iter().copied().map(point), &style));
            }
            for pair in points.windows(2) {
                piece(backend, pair[0], pair[1], *width, *ink);
            }
            // Round joints.
            let inner = points.get(1..points.len() - 1).unwrap_or_default();
            if thick > 3 {
                for joint in inner {
                    let radius = (thick / 2).saturating_sub(1);
                    drawn(backend.draw_circle(point(*joint), radius, &colour(*ink), true));
                }
            }
        }
        Item::Disc { centre, radius, fill } => {
            let radius = (radius * f64::from(SCALE)).round() as u32;
            drawn(backend.draw_circle(point(*centre), radius, &colour(*fill), true));
        }
        Item::Text(text) => draw_text(backend, text, form),
        Item::Picture { .. } => unreachable!("drawn by the caller"),
    }
}

/// A straight piece of a line.
fn piece<B: DrawingBackend>(backend: &mut B, from: DVec2, to: DVec2, width: f64, ink: Colour) {
    let Some(way) = (to - from).try_normalize() else { return };
    let across = way.perp() * width / 2.0;
    let corners = [from + across, to + across, to - across, from - across];
    drawn(backend.fill_polygon(corners.map(point), &colour(ink)));
}

fn draw_text<B: DrawingBackend>(backend: &mut B, text: &Text, form: Form) {
    let size = text.em * form.size * f64::from(SCALE);
    let across = match text.anchor {
        Anchor::Start => HPos::Left,
        Anchor::Middle => HPos::Center,
        Anchor::End => HPos::Right,
    };
    let up = form.baseline * text.em * form.size;
    let (at, transform) = if text.upwards {
        (text.at - DVec2::new(up, 0.0), FontTransform::Rotate270)
    } else {
        (text.at - DVec2::new(0.0, up), FontTransform::None)
    };
    let font = font(size).transform(transform);
    let ink = colour(text.colour);
    let style = TextStyle::from(font).color(&ink).pos(Pos::new(across, VPos::Top));
    let (x, y) = point(at);
    drawn(backend.draw_text(&text.text, &style, (x, y)));
    if form.pieces {
        // Embolden the light font by a quarter pixel.
        drawn(backend.draw_text(&text.text, &style, (x + 1, y)));
    }
}
