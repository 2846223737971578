//! Figures: catalogue, legible text, colours, both formats.

use glam::DVec3;
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::sphere::equirect::direction_from_equirect;
use octagloss_core::sphere::registry::MAPS;
use octagloss_drawing::scale::{ANISOTROPY, RELATIVE_SOLID_ANGLE};
use octagloss_plot::figure::{Figure, Form};
use octagloss_workbench::figures::catalogue::{Entry, FigureContent, entries, kinds};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// A small panorama.
fn content() -> FigureContent {
    let texel = |k: u32| {
        let d: DVec3 =
            direction_from_equirect((f64::from(k % 32) + 0.5) / 32.0, (f64::from(k / 32) + 0.5) / 16.0);
        [(1.0 + d.x) as f32, (1.0 + d.y) as f32, (1.0 + d.z) as f32]
    };
    let panorama =
        Environment::new(Layout::Panorama { width: 32, height: 16 }, (0..512).map(texel).collect())
            .expect("sound");
    FigureContent {
        panorama,
        panorama_name: "a & b".to_owned(),
        size: 8,
        border: 2,
        lobes: crate::laboratory::small(),
    }
}

fn entry(name: &str) -> Entry {
    entries().into_iter().find(|entry| entry.name() == name).expect("a figure")
}

/// Parses the elements of an XML document; panics unless tags nest and attributes are quoted.
pub(super) fn elements(document: &str) -> Vec<&str> {
    let (mut open, mut all) = (Vec::new(), Vec::new());
    let mut rest = document;
    while let Some(start) = rest.find('<') {
        assert!(!rest[..start].contains('>'), "a bare > in {:?}", &rest[..start]);
        let end = start + rest[start..].find('>').expect("a tag ends");
        let tag = &rest[start + 1..end];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "closed in order");
        } else {
            assert!(tag.matches('"').count().is_multiple_of(2) && !tag.contains('<'), "{tag}");
            let name = tag.split([' ', '/']).next().expect("a name");
            all.push(name);
            if !tag.ends_with('/') {
                open.push(name);
            }
        }
        rest = &rest[end + 1..];
    }
    assert!(open.is_empty() && rest.trim().is_empty(), "left open: {open:?}");
    assert!(
        document.split('&').skip(1).all(|after| after.split(';').next().is_some_and(|name| name.len() <= 4))
    );
    all
}

#[test]
fn every_map_has_its_figures() {
    let names: BTreeSet<String> = entries().iter().map(Entry::name).collect();
    assert_eq!(names.len(), entries().len(), "names differ");
    for map in &MAPS {
        for kind in ["solid-angle", "anisotropy", "layout", "panorama"] {
            assert!(names.contains(&format!("{kind}-{}", map.name)), "{kind} {}", map.name);
        }
    }
    let others = [
        "compared",
        "unfolding",
        "border",
        "seam",
        "sampling",
        "lookup-level",
        "lookup-border",
        "lookup-greatest",
        "lookup-weights",
        "lookup-rectangular",
        "lobes-box",
        "lobes-stack",
        "lobes-adaptive",
        "lobes-sphere",
    ];
    for name in others {
        assert!(names.contains(name), "{name}");
        assert!(kinds().any(|kind| kind == name), "{name}");
    }
    assert_eq!(kinds().count(), 4 + others.len());
    assert_eq!(names.len(), 4 * MAPS.len() + others.len());
}

#[test]
fn no_text_is_cut_off_or_covers_another() {
    let content = content();
    // All layouts, which differ most, plus one figure of every other kind.
    let is_drawn = |entry: &Entry| {
        entry.kind == "layout" || entry.map.is_none_or(|map| map.name == "polar-capped-conformal")
    };
    let drawn: Vec<Entry> = entries().into_iter().filter(is_drawn).collect();
    assert_eq!(drawn.len(), MAPS.len() + 3 + 14);
    let figures: Vec<(String, Figure)> =
        drawn.par_iter().map(|entry| (entry.name(), entry.draw(&content).expect("a figure"))).collect();
    for (name, figure) in figures {
        let (texts, frame) = (figure.scene.labels(), figure.scene.frame());
        for (k, (text, own)) in texts.iter().enumerate() {
            assert!(frame.holds(own), "{name}: {text:?} is cut off");
            for (other, others) in &texts[..k] {
                assert!(!own.overlaps(others), "{name}: {text:?} covers {other:?}");
            }
        }
    }
}

#[test]
fn figures_are_the_same_every_time_in_both_forms() {
    for name in ["layout-tennis-ball", "panorama-cube", "solid-angle-cube", "border"] {
        let figure = entry(name).draw(&content()).expect("a figure");
        let again = entry(name).draw(&content()).expect("a figure");
        let png = figure.bytes(Form::Png);
        assert!(png == again.bytes(Form::Png), "{name}");
        let picture = image::load_from_memory(&png).expect("a PNG").to_rgb8();
        assert_eq!([picture.width(), picture.height()], [figure.scene.width, figure.scene.height], "{name}");
        assert!(picture.pixels().any(|pixel| pixel.0 == [32, 36, 44]), "{name}: ink");

        let svg = figure.bytes(Form::Svg);
        assert!(svg == again.bytes(Form::Svg), "{name}");
        assert!(svg.len() < 2_000_000, "{name}: {} bytes", svg.len());
        let svg = String::from_utf8(svg).expect("text");
        let elements = elements(&svg);
        assert_eq!(elements[..3], ["svg", "title", "desc"], "{name}");
        assert!(elements.contains(&"text") && elements.contains(&"polyline"), "{name}");
        assert_eq!(elements.contains(&"image"), name != "border", "{name}");
        let plain = svg.replace("&apos;", "\'").replace("&amp;", "&");
        for (text, _) in figure.scene.labels() {
            assert!(plain.contains(&format!(">\n{text}\n<")), "{name} lacks {text:?}");
        }
        assert!(plain.contains(&figure.caption), "{name}");
    }
}

#[test]
fn axes_and_captions_are_told() {
    let content = content();
    let texts = |name: &str| -> Vec<String> {
        entry(name)
            .draw(&content)
            .expect("a figure")
            .scene
            .labels()
            .into_iter()
            .map(|(text, _)| text)
            .collect()
    };
    let layout = texts("layout-tennis-ball");
    for text in ["Tennis-ball: layout", "u", "v", "3\u{3c0}/4", "C\u{2081}", "+Z", "\u{2212}Y"] {
        assert!(layout.contains(&text.to_owned()), "{text}: {layout:?}");
    }
    let angles = texts("solid-angle-cube");
    for text in ["solid angle / mean", "1/4", "1", "4", "+X", "\u{2212}X"] {
        assert!(angles.contains(&text.to_owned()), "{text}: {angles:?}");
    }
    // Names of all texels: interior ones once, plus border ones.
    let border = texts("border");
    assert_eq!(border.iter().filter(|text| *text == "0,0").count(), 4, "the corner and three copies");
    assert!(border.contains(&"b = 2".to_owned()) && border.contains(&"s = 8".to_owned()), "{border:?}");
}

#[test]
fn colours_are_those_of_the_scale() {
    let scale = RELATIVE_SOLID_ANGLE;
    assert_eq!(scale.range(), [0.25, 4.0]);
    assert_eq!(scale.colour(1.0), [247, 247, 245], "the mean is neutral");
    assert_eq!(scale.colour(0.25), [11, 83, 40]);
    assert_eq!(scale.colour(4.0), [69, 14, 92]);
    assert_eq!(scale.colour(2.0), [186, 148, 202], "half way, for the scale is logarithmic");
    assert_eq!([scale.colour(0.01), scale.colour(100.0)], [scale.colour(0.25), scale.colour(4.0)]);
    assert_eq!(scale.colour(f64::NAN), [128; 3]);
    assert_eq!(ANISOTROPY.colour(1.0), [253, 251, 226]);
    assert_eq!(ANISOTROPY.colour(2.0), [80, 174, 190]);
    assert_eq!(ANISOTROPY.colour(f64::INFINITY), [20, 28, 84]);
}

/// The cube's greatest relative solid angle, 6/pi, is at face centres, so the colour there is known.
#[test]
fn heat_maps_show_the_value_of_the_direction() {
    let figure = entry("solid-angle-cube").draw(&content()).expect("a figure");
    let picture = image::load_from_memory(&figure.bytes(Form::Png)).expect("a PNG").to_rgb8();
    let expected = RELATIVE_SOLID_ANGLE.colour(6.0 / std::f64::consts::PI);
    let count = picture.pixels().filter(|pixel| pixel.0 == expected).count();
    assert!(count > 1000, "{count} pixels of {expected:?}");
    // An equal-area map has one colour throughout.
    let figure = entry("solid-angle-low-distortion").draw(&content()).expect("a figure");
    let picture = image::load_from_memory(&figure.bytes(Form::Png)).expect("a PNG").to_rgb8();
    let neutral = picture.pixels().filter(|pixel| pixel.0 == RELATIVE_SOLID_ANGLE.colour(1.0)).count();
    assert!(neutral > 200_000, "{neutral} neutral pixels");
}

#[test]
fn sizes_and_borders_that_cannot_be_drawn_are_named() {
    for (size, border, words) in [
        (0, 0, "`size` 0 must be 1 to 12 texels"),
        (13, 0, "`size` 13 must be 1 to 12 texels"),
        (4, 5, "`border` 5 exceeds the map's side of 4 texels"),
    ] {
        let error = entry("border").draw(&FigureContent { size, border, ..content() }).expect_err(words);
        assert!(error.to_string().contains(words), "{error}");
    }
    for (size, border) in [(1, 0), (1, 1), (12, 0), (12, 1), (12, 12), (11, 11), (10, 10)] {
        let figure = entry("border").draw(&FigureContent { size, border, ..content() }).expect("a figure");
        let texts = figure.scene.labels();
        let side = (size + 2 * border) as usize;
        assert!(texts.len() > side * side, "a name for every texel");
        for (k, (text, own)) in texts.iter().enumerate() {
            assert!(figure.scene.frame().holds(own), "{size}, {border}: {text:?} is cut off");
            let covered = texts[..k].iter().find(|(_, others)| own.overlaps(others));
            assert!(covered.is_none(), "{size}, {border}: {text:?} covers {covered:?}");
        }
    }
    let one = entry("border").draw(&FigureContent { size: 1, border: 1, ..content() }).expect("a figure");
    assert!(one.scene.labels().iter().any(|(text, _)| text.contains("square of 1 texel with")), "one texel");
}

/// Pixels of coarse pictures whose centres lie beyond the rim show the nearest one inside, not paper.
#[test]
fn spheres_of_pixels_are_filled_up_to_their_rims() {
    let figure = entry("lookup-level").draw(&content()).expect("a figure");
    let picture = image::load_from_memory(&figure.bytes(Form::Png)).expect("a PNG").to_rgb8();
    // Both spheres by their inked circles: the first and last columns with ink in a row of the lower halves,
    // where no label is.
    let (row, width) = (360, picture.width());
    for half in [0..width / 2, width / 2..width] {
        let ink: Vec<u32> =
            half.filter(|x| picture.get_pixel(*x, row).0.iter().all(|channel| *channel < 120)).collect();
        let (left, right) = (ink[0], *ink.last().expect("a circle"));
        let radius = 205.0_f64;
        let (x, y) = (
            f64::from(left + right) / 2.0,
            f64::from(row) - (radius.powi(2) - (f64::from(right - left) / 2.0).powi(2)).sqrt(),
        );
        let mut shown = 0;
        for degrees in 10..170 {
            // Downwards, past the label of -Y.
            let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
            for share in [0.96, 0.97, 0.98, 0.985] {
                let at = [x + cos * radius * share, y + sin * radius * share].map(|c| c.round() as u32);
                assert_ne!(picture.get_pixel(at[0], at[1]).0, [255; 3], "paper at {at:?}");
                shown += 1;
            }
        }
        assert_eq!(shown, 640);
    }
}
