//! Common parts of pictures: title, caption, colour bar.

use super::bitmap::Bitmap;
use super::font::fitted;
use super::scale::ColourScale;
use super::scene::{Anchor, Frame, Scene, wrapped};
use super::style::{GAP, INK, LINE, MARGIN, SMALL, SOFT, TITLE};
use glam::DVec2;

/// Width of most figures in pixels.
pub const WIDTH: f64 = 1000.0;

/// Creates a scene with `title` above, shortened to the width, `caption` below, and a frame `height` pixels
/// high in between.
pub fn page(width: f64, height: f64, title: &str, caption: &str) -> (Scene, Frame) {
    let inner = width - 2.0 * MARGIN;
    let lines = wrapped(caption, SMALL, inner).len() as f64;
    let top = MARGIN + TITLE + 18.0;
    let bottom = top + height;
    let mut scene = Scene::new(width, bottom + GAP + lines * LINE * SMALL + MARGIN - 6.0);
    let shown = fitted(title, TITLE, inner);
    scene.text(DVec2::new(MARGIN, MARGIN + 0.72 * TITLE), &shown, TITLE, Anchor::Start, INK);
    scene.paragraph(DVec2::new(MARGIN, bottom + GAP + SMALL), caption, SMALL, inner);
    (scene, Frame::new(DVec2::new(MARGIN, top), DVec2::new(width - MARGIN, bottom)))
}

/// Width of [`colour_bar`].
pub const BAR_WIDTH: f64 = 96.0;

/// Draws a colour bar at the left of `frame`, with ticks and `name`. An end exceeded by `range` is drawn as a
/// tip.
pub fn colour_bar(scene: &mut Scene, frame: &Frame, scale: &ColourScale, name: &str, range: [f64; 2]) {
    let (left, right) = (frame.low.x, frame.low.x + 20.0);
    let tip = 12.0;
    let (top, bottom) = (frame.low.y + tip, frame.high.y - tip);
    let rows = 256;
    let gradient =
        Bitmap::from_fn(1, rows, |_, y| scale.colour_at(1.0 - (f64::from(y) + 0.5) / f64::from(rows)));
    scene.picture_at(DVec2::new(left, top), DVec2::new(right, bottom), gradient);
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
