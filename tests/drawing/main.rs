//! Pictures' drawing: the font, shapes by the share of each pixel that they cover, names of any length.

use epaint_default_fonts::UBUNTU_LIGHT;
use glam::DVec2;
use octagloss_drawing::bitmap::Bitmap;
use octagloss_drawing::font::{fitted, text_width};
use octagloss_drawing::scene::{Anchor, Scene};
use octagloss_drawing::style::Colour;
use ttf_parser::Face;

const BLACK: Colour = [0; 3];

fn pixel(picture: &Bitmap, x: u32, y: u32) -> u8 {
    picture.pixel(x, y)[0]
}

/// `text` at 40 pixels per em.
fn written(text: &str) -> Bitmap {
    let mut scene = Scene::new(200.0, 60.0);
    scene.text(DVec2::new(4.0, 45.0), text, 40.0, Anchor::Start, BLACK);
    scene.picture()
}

#[test]
fn text_has_the_widths_of_the_font() {
    let face = Face::parse(UBUNTU_LIGHT, 0).expect("a font");
    let mut compared = 0;
    // The ranges of the example that writes the outlines.
    let ranges = [' '..='\u{17f}', '\u{391}'..='\u{3c9}', '\u{2010}'..='\u{2265}'];
    let is_drawn = |character: &char| !character.is_whitespace() && !character.is_control();
    for character in ranges.into_iter().flatten().filter(is_drawn) {
        let Some(id) = face.glyph_index(character) else { continue };
        let advance = f64::from(face.glyph_hor_advance(id).expect("an advance"));
        // Doubles; one division and one product round.
        let width = text_width(&character.to_string(), f64::from(face.units_per_em()));
        assert!((width - advance).abs() < 1e-9, "{character:?}: {width} is not {advance}");
        compared += 1;
    }
    assert!(compared > 370, "{compared} characters");
}

#[test]
fn long_names_keep_their_ends_and_never_grow() {
    assert_eq!(fitted("sky.exr", 10.0, 1000.0), "sky.exr");
    let long = "a_very_long_name_of_a_panorama_from_somewhere_4k.exr";
    for width in [20.0, 60.0, 100.0, 200.0] {
        let short = fitted(long, 10.0, width);
        assert!(text_width(&short, 10.0) <= width, "{short}");
        assert!(short.contains('\u{2026}') && short.chars().count() < long.len(), "{short}");
    }
    assert!(fitted(long, 10.0, 200.0).ends_with(".exr"));
    assert_eq!(fitted("\u{5929}\u{7a7a}", 10.0, 0.0), "");
}

#[test]
fn characters_that_the_font_lacks_differ() {
    let blank = written("");
    assert_ne!(written("\u{5929}"), written("\u{7a7a}"));
    assert_ne!(written("\u{5929}"), blank);
    assert_eq!(written("\u{9}\u{3000}"), blank);
    assert!(text_width("\u{1f600}", 10.0) > text_width("\u{5929}", 10.0), "five digits");
}

#[test]
fn shapes_cover_the_share_of_a_pixel_that_they_cover() {
    let mut scene = Scene::new(12.0, 8.0);
    let at = DVec2::new;
    scene.polygon([at(2.0, 2.0), at(5.5, 2.0), at(5.5, 4.25), at(2.0, 4.25)], BLACK);
    let drawn = scene.picture();
    let found = [pixel(&drawn, 1, 2), pixel(&drawn, 2, 2), pixel(&drawn, 5, 2), pixel(&drawn, 3, 4)];
    // Half of a pixel covered is 127.5, a quarter leaves 191.25.
    assert_eq!(found, [255, 0, 128, 191]);
    assert_eq!((pixel(&drawn, 5, 4), pixel(&drawn, 7, 3)), (223, 255));
}

#[test]
fn lines_have_their_width_in_every_direction_and_shapes_beyond_the_edge_are_cut_off() {
    for (from, to) in [([2.0, 8.0], [14.0, 8.0]), ([14.0, 8.0], [2.0, 8.0]), ([8.0, 2.0], [8.0, 14.0])] {
        let mut scene = Scene::new(16.0, 16.0);
        scene.line([DVec2::from_array(from), DVec2::from_array(to)], 3.0, BLACK);
        let sum: u32 = scene.picture().bytes().chunks(3).map(|pixel| 255 - u32::from(pixel[0])).sum();
        // Rounding of a byte in each pixel of both edges.
        assert!(sum.abs_diff(36 * 255) <= 24, "{sum}");
    }
    let mut scene = Scene::new(4.0, 4.0);
    scene.disc(DVec2::new(-1.0, 2.0), 3.0, BLACK);
    scene.text(DVec2::new(2.0, 3.0), "beyond", 20.0, Anchor::Start, BLACK);
    let drawn = scene.picture();
    assert_eq!((pixel(&drawn, 0, 2), drawn.width(), drawn.height()), (0, 4, 4));
}

#[test]
fn text_is_where_its_frame_says() {
    for upwards in [false, true] {
        let mut scene = Scene::new(120.0, 120.0);
        let place = DVec2::new(60.0, 60.0);
        if upwards {
            scene.upwards(place, "Hxp 7", 20.0, BLACK);
        } else {
            scene.centred(place, "Hxp 7", 20.0, BLACK);
        }
        let frame = scene.labels()[0].1;
        let drawn = scene.picture();
        let inked: Vec<DVec2> = (0..drawn.height())
            .flat_map(|y| (0..drawn.width()).map(move |x| (x, y)))
            .filter(|(x, y)| pixel(&drawn, *x, *y) < 128)
            .map(|(x, y)| DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5))
            .collect();
        assert!(inked.len() > 60, "{} pixels", inked.len());
        let strange =
            inked.iter().find(|at| at.cmplt(frame.low - 1.0).any() || at.cmpgt(frame.high + 1.0).any());
        assert_eq!(strange, None, "{frame:?}");
    }
}

#[test]
fn pictures_are_copied_or_stretched() {
    let pixels = Bitmap::from_fn(2, 2, |x, y| [(100 * x + 50 * y) as u8; 3]);
    let mut scene = Scene::new(10.0, 10.0);
    scene.picture_at(DVec2::new(1.0, 1.0), DVec2::new(3.0, 3.0), pixels.clone());
    scene.picture_at(DVec2::new(4.0, 4.0), DVec2::new(10.0, 10.0), pixels.clone());
    scene.picture_at(DVec2::new(1.0, 5.0), DVec2::new(2.0, 6.0), pixels);
    let drawn = scene.picture();
    let found = [(1, 1), (2, 1), (2, 2), (4, 4), (9, 4), (9, 9), (1, 5)].map(|(x, y)| pixel(&drawn, x, y));
    assert_eq!(found, [0, 100, 150, 0, 100, 150, 75]);
}
