//! Common parts of figures: title, caption, colour bar, ticks.

use super::look::{ColourScale, INK, LABEL, MARGIN, SMALL, SOFT, TITLE};
use super::scene::{Anchor, Frame, Scene, wrapped};
use glam::DVec2;
use image::RgbImage;
use std::f64::consts::PI;

/// Width of most figures in pixels.
pub(super) const WIDTH: f64 = 1000.0;

/// Creates a scene with `title` above, `caption` below, and a frame `height` pixels high in between.
pub(super) fn page(width: f64, height: f64, title: &str, caption: &str) -> (Scene, Frame) {
    let inner = width - 2.0 * MARGIN;
    let lines = wrapped(caption, SMALL, inner).len() as f64;
    let top = MARGIN + TITLE + 18.0;
    let bottom = top + height;
    let mut scene = Scene::new(width, bottom + 16.0 + lines * 1.45 * SMALL + MARGIN - 6.0);
    scene.text(DVec2::new(MARGIN, MARGIN + 0.72 * TITLE), title, TITLE, Anchor::Start, INK);
    scene.paragraph(DVec2::new(MARGIN, bottom + 16.0 + SMALL), caption, SMALL, inner);
    (scene, Frame::new(DVec2::new(MARGIN, top), DVec2::new(width - MARGIN, bottom)))
}

/// Width of [`colour_bar`].
pub(super) const BAR_WIDTH: f64 = 96.0;

/// Draws a colour bar at the left of `frame`, with ticks and `name`. An end exceeded by `range` is drawn as a
/// tip.
pub(super) fn colour_bar(scene: &mut Scene, frame: &Frame, scale: &ColourScale, name: &str, range: [f64; 2]) {
    let (left, right) = (frame.low.x, frame.low.x + 20.0);
    let tip = 12.0;
    let (top, bottom) = (frame.low.y + tip, frame.high.y - tip);
    let rows = 256;
    let gradient = RgbImage::from_fn(1, rows, |_, y| {
        image::Rgb(scale.colour_at(1.0 - (f64::from(y) + 0.5) / f64::from(rows)))
    });
    scene.picture(DVec2::new(left, top), DVec2::new(right, bottom), gradient);
    let [low, high] = scale.range();
    let ends = [
        (range[1] > high * 1.001, DVec2::new(left, top), DVec2::new(right, top), -tip, 1.0),
        (range[0] < low / 1.001, DVec2::new(right, bottom), DVec2::new(left, bottom), tip, 0.0),
    ];
    let mut rim = Vec::new();
    for (is_open, from, to, way, share) in ends {
        rim.push(from);
        if is_open {
            let end = (from + to) / 2.0 + DVec2::new(0.0, way);
            scene.polygon([from, end, to], scale.colour_at(share));
            rim.push(end);
        }
        rim.push(to);
    }
    scene.outline(rim, 1.0, INK);
    for (value, text) in scale.ticks {
        let y = bottom + (top - bottom) * scale.share(*value);
        scene.line(vec![DVec2::new(right, y), DVec2::new(right + 6.0, y)], 1.0, INK);
        scene.text(DVec2::new(right + 10.0, y + 0.35 * SMALL), text, SMALL, Anchor::Start, SOFT);
    }
    scene.upwards(DVec2::new(right + 62.0, (top + bottom) / 2.0), name, SMALL, INK);
}

/// Formats `value` as a multiple of pi/4 if it is one, else as a short number.
pub(super) fn number(value: f64) -> String {
    let quarters = value / (PI / 4.0);
    if value != 0.0 && (quarters - quarters.round()).abs() < 1e-9 {
        let count = quarters.round().abs() as u64;
        let sign = if value < 0.0 { "\u{2212}" } else { "" };
        let (above, below) = match count {
            _ if count.is_multiple_of(4) => (count / 4, 1),
            _ if count.is_multiple_of(2) => (count / 2, 2),
            _ => (count, 4),
        };
        let above = if above == 1 { "\u{3c0}".to_owned() } else { format!("{above}\u{3c0}") };
        return if below == 1 { format!("{sign}{above}") } else { format!("{sign}{above}/{below}") };
    }
    let text = format!("{value:.2}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.replace('-', "\u{2212}") }
}

/// Draws three ticks from `low` to `high` below and left of `frame`, with the names of both axes.
pub(super) fn rectangle_ticks(scene: &mut Scene, frame: &Frame, low: DVec2, high: DVec2, sides: [bool; 2]) {
    for share in [0.0, 0.5, 1.0] {
        let at = frame.low + frame.extent() * share;
        let value = low + (high - low) * share;
        if sides[0] {
            let y = frame.high.y;
            scene.line(vec![DVec2::new(at.x, y), DVec2::new(at.x, y + 4.0)], 1.0, INK);
            scene.text(DVec2::new(at.x, y + 17.0), &number(value.x), SMALL - 2.0, Anchor::Middle, SOFT);
        }
        if sides[1] {
            let x = frame.low.x;
            scene.line(vec![DVec2::new(x - 4.0, at.y), DVec2::new(x, at.y)], 1.0, INK);
            let baseline = at.y + 0.35 * (SMALL - 2.0);
            scene.text(DVec2::new(x - 7.0, baseline), &number(value.y), SMALL - 2.0, Anchor::End, SOFT);
        }
    }
    if sides[0] {
        let middle = (frame.low.x * 0.75) + frame.high.x * 0.25;
        scene.text(DVec2::new(middle, frame.high.y + 17.0), "u", LABEL - 1.0, Anchor::Middle, INK);
    }
    if sides[1] {
        let middle = frame.low.y * 0.75 + frame.high.y * 0.25;
        scene.text(DVec2::new(frame.low.x - 10.0, middle + 4.0), "v", LABEL - 1.0, Anchor::End, INK);
    }
}
