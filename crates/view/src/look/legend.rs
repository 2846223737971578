//! Legends of debug views: what they show, its unit and its range.

use crate::look::{Look, Show};
use crate::picture::light::Light;
use glam::DVec2;
use half::f16;
use octagloss_core::common::percent::percent;
use octagloss_core::light::environment::exact_luminance;
use octagloss_core::light::oem::OemSize;
use octagloss_drawing::bitmap::Bitmap;
use octagloss_drawing::font::text_width;
use octagloss_drawing::page::{BAR_WIDTH, colour_bar};
use octagloss_drawing::scale::RELATIVE_ERROR;
use octagloss_drawing::scene::{Anchor, Frame, Scene, wrapped};
use octagloss_drawing::style::{FAINT, GAP, INK, LABEL, LINE, SMALL, SOFT};

/// Least width and height of a picture with a legend, in pixels.
pub const MIN: [u32; 2] = [480, 270];

/// Pixels between a legend and the edges of its picture.
pub const INSET: u32 = 12;

/// Widest text without and with a colour bar beside it, in pixels.
const TEXT: [f64; 2] = [240.0, 190.0];

/// Height of the colour bar in pixels.
const BAR: f64 = 150.0;

/// Figures of what a picture shows: relative errors, or luminance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// The mean over the pixels.
    pub mean: f64,
    /// The least.
    pub least: f64,
    /// The greatest; of luminance beyond the range of half floats, a lower bound.
    pub greatest: f64,
}

/// Figures of a picture of `look` with these linear `values`, exposed by `exposure` powers of two.
pub fn shown(look: &Look, values: &[[f16; 4]], exposure: f64) -> Shown {
    let value = |[red, green, blue, extra]: &[f16; 4]| match look.show {
        Show::Error => Some(extra.to_f64()),
        // Clear around the table.
        Show::Scene | Show::Oem | Show::Sat if extra.to_f64() < 0.5 => None,
        Show::Scene | Show::Oem | Show::Sat => {
            Some(exact_luminance([red, green, blue].map(|c| c.to_f32())) * (-exposure).exp2())
        }
    };
    let (mut sum, mut count) = (0.0, 0.0);
    let (mut least, mut greatest) = (f64::INFINITY, 0.0_f64);
    for value in values.iter().filter_map(value) {
        (sum, count) = (sum + value, count + 1.0);
        (least, greatest) = (least.min(value), greatest.max(value));
    }
    Shown { mean: sum / f64::max(count, 1.0), least: least.min(greatest), greatest }
}

/// The legend of a picture of `look`, `size` pixels wide and high; `None` for the scene and for small
/// pictures.
pub fn legend(look: &Look, light: &Light, size: [u32; 2], shown: Shown) -> Option<Bitmap> {
    if size[0] < MIN[0] || size[1] < MIN[1] {
        return None;
    }
    legend_scene(look, light.oem, look.exposure.ev(light.exposure()), shown).map(|scene| scene.picture())
}

/// The legend as a drawing; `ev` is the picture's exposure.
pub fn legend_scene(look: &Look, OemSize { inner, border }: OemSize, ev: f64, shown: Shown) -> Option<Scene> {
    let Shown { mean, least, greatest } = shown;
    let luminance = || {
        let ev = format!("{ev:+.2}").replace('-', "\u{2212}");
        vec![
            format!("luminance {} to {}, mean {}", number(least), number(greatest), number(mean)),
            format!("in the file's unit, at {ev}\u{a0}EV"),
        ]
    };
    match look.show {
        Show::Scene => None,
        Show::Error => {
            let [mean, greatest] = [mean, greatest].map(|share| percent(share).replace(' ', "\u{a0}"));
            let lines = vec![
                format!("of luminance, against adaptive:{:e}", look.tolerance()),
                format!("mean {mean}, greatest {greatest}"),
            ];
            let title = if look.judges_reflections() {
                "Relative error of true reflections".to_owned()
            } else {
                format!("Relative error of {}", look.filter)
            };
            Some(plate(&title, &lines, Some([least, shown.greatest])))
        }
        Show::Oem => {
            let around = if border > 0 { format!(", border {border} not shown") } else { String::new() };
            let lines = [vec![format!("{inner} \u{d7} {inner} texels{around}")], luminance()].concat();
            Some(plate("Octahedral map", &lines, None))
        }
        Show::Sat => {
            let side = inner + 2 * border;
            let what = "mean of the box from the upper left corner to the pixel".to_owned();
            let lines = [vec![format!("{side} \u{d7} {side} texels"), what], luminance()].concat();
            Some(plate("Summed-area table", &lines, None))
        }
    }
}

/// Three significant digits.
fn number(value: f64) -> String {
    let digits = match value.abs() {
        0.0 => return "0".to_owned(),
        v if !(1e-3..1e6).contains(&v) => return format!("{value:.2e}").replace('-', "\u{2212}"),
        v => (2 - v.log10().floor() as i32).max(0) as usize,
    };
    format!("{value:.digits$}")
}

/// A plate with a title and lines; beside a bar of errors in `range`, if there is one.
fn plate(title: &str, lines: &[String], range: Option<[f64; 2]>) -> Scene {
    let left = if range.is_some() { BAR_WIDTH + GAP } else { GAP };
    let most = TEXT[usize::from(range.is_some())];
    let wrapped = |text, size| wrapped(text, size, most).into_iter().map(move |line| (line, size));
    let lines = lines.iter().flat_map(|line| wrapped(line, SMALL));
    let lines: Vec<(String, f64)> = wrapped(title, LABEL).chain(lines).collect();
    let widest = lines.iter().map(|(line, size)| text_width(line, *size)).fold(0.0, f64::max);
    let text: f64 = lines.iter().map(|(_, size)| LINE * size).sum();
    let body = if range.is_some() { BAR.max(text) } else { text };
    let mut scene = Scene::new(left + widest + GAP, body + 2.0 * GAP - 4.0);
    scene.outline(scene.frame().inset(0.5).corners(), 1.0, FAINT);
    if let Some(range) = range {
        let frame = Frame::new(DVec2::splat(GAP), DVec2::new(GAP + BAR_WIDTH, GAP + BAR - 4.0));
        colour_bar(&mut scene, &frame, &RELATIVE_ERROR, "relative error", range);
    }
    let mut top = GAP;
    for (line, size) in lines {
        let colour = if size == LABEL { INK } else { SOFT };
        scene.text(DVec2::new(left, top + 0.72 * size), &line, size, Anchor::Start, colour);
        top += LINE * size;
    }
    scene
}

/// Puts `legend` into the lower left corner of `picture`.
pub fn put(picture: &mut Bitmap, legend: &Bitmap) {
    let top = i64::from(picture.height()) - i64::from(legend.height() + INSET);
    picture.put(legend, i64::from(INSET), top);
}
