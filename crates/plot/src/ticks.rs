//! Ticks of a map's rectangle.

use glam::DVec2;
use octagloss_drawing::scene::{Anchor, Frame, Scene};
use octagloss_drawing::style::{INK, LABEL, SMALL, SOFT};
use std::f64::consts::PI;

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
pub fn rectangle_ticks(scene: &mut Scene, frame: &Frame, low: DVec2, high: DVec2, sides: [bool; 2]) {
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
