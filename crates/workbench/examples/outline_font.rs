//! Writes the outlines of pictures' text: `cargo run --release -p octagloss-workbench --example outline_font
//! [FILE]`. FILE is by default the file of the library in `src/image/drawing`. The format is that of
//! `crates/drawing/src/font.rs`.

use epaint_default_fonts::UBUNTU_LIGHT;
use std::process::ExitCode;
use ttf_parser::{Face, OutlineBuilder};

/// Latin with accents, Greek, punctuation, currencies, arrows and signs of mathematics: what the npm package
/// has room for.
const RANGES: [std::ops::RangeInclusive<char>; 3] =
    [' '..='\u{17f}', '\u{391}'..='\u{3c9}', '\u{2010}'..='\u{2265}'];

fn main() -> ExitCode {
    let path = std::env::args().nth(1);
    let path = path.unwrap_or_else(|| "src/image/drawing/ubuntu-light.bin".to_owned());
    let face = Face::parse(UBUNTU_LIGHT, 0).expect("a font");
    if let Err(error) = std::fs::write(&path, outlines(&face)) {
        eprintln!("{path}: {error}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

/// Units per em, then for each character its step from the last, its advance and its outline.
fn outlines(face: &Face<'_>) -> Vec<u8> {
    let mut bytes = Vec::new();
    unsigned(&mut bytes, u32::from(face.units_per_em()));
    let mut last = 0;
    for character in RANGES.into_iter().flatten() {
        let Some(glyph) = face.glyph_index(character) else { continue };
        let mut outline = Outline::default();
        face.outline_glyph(glyph, &mut outline);
        unsigned(&mut bytes, u32::from(character) - last);
        last = u32::from(character);
        unsigned(&mut bytes, u32::from(face.glyph_hor_advance(glyph).unwrap_or(0)));
        unsigned(&mut bytes, outline.commands);
        bytes.extend(outline.bytes);
    }
    bytes
}

/// Commands, each the number of its points (0 to close, 1 to draw a line, 2 a curve, 3 to move) and the
/// points, relative to the point before.
#[derive(Default)]
struct Outline {
    commands: u32,
    bytes: Vec<u8>,
    at: [i32; 2],
}

impl Outline {
    fn command(&mut self, code: u32, points: &[[f32; 2]]) {
        self.commands += 1;
        unsigned(&mut self.bytes, code);
        for point in points {
            let point = point.map(|c| c.round() as i32);
            for (from, to) in self.at.into_iter().zip(point) {
                let step = to - from;
                unsigned(&mut self.bytes, ((step << 1) ^ (step >> 31)) as u32);
            }
            self.at = point;
        }
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.command(3, &[[x, y]]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.command(1, &[[x, y]]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.command(2, &[[x1, y1], [x, y]]);
    }

    fn curve_to(&mut self, _: f32, _: f32, _: f32, _: f32, _: f32, _: f32) {
        unreachable!("TrueType outlines are quadratic");
    }

    fn close(&mut self) {
        self.command(0, &[]);
    }
}

/// Appends `value`, seven bits a byte, the lowest first.
fn unsigned(bytes: &mut Vec<u8>, mut value: u32) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}
