//! Draws the border of the octahedral square: the interior texel that each border texel copies.

use glam::DVec2;
use octagloss_core::sphere::octahedral::wrap_texel;
use octagloss_drawing::font::text_width;
use octagloss_drawing::page::page;
use octagloss_drawing::scene::{Anchor, Frame};
use octagloss_drawing::style::{Colour, INK, LABEL, MARGIN, PAPER, SMALL, SOFT, TINY, mix};
use octagloss_plot::figure::Figure;

/// Least width of the figure: the square and its labels.
const WIDTH: f64 = 760.0;

/// Pixels left of the square for labels, and as many on its right.
const BESIDE: f64 = 60.0;

/// Figure 4 of the octahedron paper.
pub(super) fn border(size: u32, border: u32) -> Figure {
    let texels = if size == 1 { "texel" } else { "texels" };
    let title = format!("Octahedral square of {size} {texels} with a border of {border}");
    let caption = "As figure 4 of Engelhardt and Dachsbacher 2008. Every texel has the colour and the name, \
                   column and row, of the texel inside the square that it shows. Beyond a side lies the \
                   square turned by 180\u{b0}, beyond a corner the square itself.";
    let count = f64::from(size + 2 * border);
    let around = 2.0 * (MARGIN + BESIDE);
    // Every name fits its texel.
    let least = text_width(&format!("{0},{0}", size - 1), TINY).ceil() + 5.0;
    let texel = ((WIDTH - around) / count).floor().min(64.0).max(least);
    let height = texel * count + 56.0;
    let (mut scene, body) = page(WIDTH.max(texel * count + around), height, &title, caption);
    let left = (body.low.x + body.high.x - texel * count) / 2.0 + 20.0;
    let origin = DVec2::new(left, body.low.y + 48.0);
    let (n, b) = (i64::from(size), i64::from(border));
    for (y, x) in (-b..n + b).flat_map(|y| (-b..n + b).map(move |x| (y, x))) {
        let inner = wrap_texel(size, x, y);
        let low = origin + DVec2::new((x + b) as f64, (y + b) as f64) * texel;
        let frame = Frame::new(low, low + texel);
        let is_inside = (0..n).contains(&x) && (0..n).contains(&y);
        let colour = colour_of(size, inner);
        scene.polygon(frame.corners(), if is_inside { colour } else { mix(colour, PAPER, 0.45) });
        scene.outline(frame.corners(), 0.8, PAPER);
        let ink = if is_inside { INK } else { SOFT };
        scene.centred((frame.low + frame.high) / 2.0, &format!("{},{}", inner.0, inner.1), TINY, ink);
    }
    let inner = Frame::new(origin + f64::from(border) * texel, origin + f64::from(border + size) * texel);
    let outer = Frame::new(origin, origin + count * texel);
    scene.outline(inner.corners(), 2.4, INK);
    scene.outline(outer.corners(), 1.2, INK);
    // Dimensions at the top and left.
    let [own, around] = [format!("s = {size}"), format!("b = {border}")];
    let spans =
        [(outer.low, inner.low, &around), (inner.low, inner.high, &own), (inner.high, outer.high, &around)];
    for (from, to, text) in spans {
        if from.x == to.x {
            continue;
        }
        let (y, x) = (origin.y - 14.0, origin.x - 14.0);
        let middle = (from + to) / 2.0;
        scene.arrow(DVec2::new(middle.x, y), DVec2::new(from.x, y), 1.2, INK);
        scene.arrow(DVec2::new(middle.x, y), DVec2::new(to.x, y), 1.2, INK);
        scene.text(DVec2::new(middle.x, y - 9.0), text, SMALL, Anchor::Middle, INK);
        scene.arrow(DVec2::new(x, middle.y), DVec2::new(x, from.y), 1.2, INK);
        scene.arrow(DVec2::new(x, middle.y), DVec2::new(x, to.y), 1.2, INK);
        scene.upwards(DVec2::new(x - 14.0, middle.y), text, LABEL - 1.5, INK);
    }
    Figure::new(title, caption.to_owned(), scene)
}

/// A unique colour for every texel of the square.
fn colour_of(size: u32, (x, y): (u32, u32)) -> Colour {
    let share = |k: u32| (f64::from(k) + 0.5) / f64::from(size);
    let above = mix([250, 200, 130], [240, 150, 150], share(x));
    let below = mix([150, 215, 165], [150, 175, 235], share(x));
    mix(above, below, share(y))
}
