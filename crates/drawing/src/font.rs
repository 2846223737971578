//! The font of all pictures: outlines of a subset of Ubuntu Light, under the Ubuntu Font Licence 1.0, beside
//! this file. `examples/outline_font.rs` writes them.
//!
//! A character that the font lacks is a box with its number in hexadecimal, so that names stay distinct.

use super::path::Path;
use glam::DVec2;
use std::collections::HashMap;
use std::sync::LazyLock;

/// Font family in SVG, which names the same font.
pub const FAMILY: &str = "Ubuntu, Arial, sans-serif";

static OUTLINES: &[u8] = include_bytes!("ubuntu-light.bin");

static GLYPHS: LazyLock<HashMap<char, Glyph>> =
    LazyLock::new(|| read(OUTLINES).expect("the program's own font is whole"));

/// Offset of a second copy of each outline in pixels, which makes the light font legible.
const WEIGHT: f64 = 0.25;

/// Height of capitals and digits in ems.
const CAPITALS: f64 = 0.693;

/// Side of the box of a character that the font lacks, its digits' size and the space around both, in ems.
const BOX: f64 = 0.96;
const BOX_DIGITS: f64 = 0.52;
const BOX_GAP: f64 = 0.06;

#[derive(Debug)]
struct Glyph {
    advance: f64,
    /// Quadratic curves in ems to the right and upwards.
    pieces: Vec<[DVec2; 3]>,
}

/// Reads outlines; `None` if they end early.
fn read(bytes: &[u8]) -> Option<HashMap<char, Glyph>> {
    let mut bytes = bytes.iter().copied();
    let units = f64::from(unsigned(&mut bytes)?);
    let (mut glyphs, mut last) = (HashMap::new(), 0);
    while let Some(step) = unsigned(&mut bytes) {
        last += step;
        let advance = f64::from(unsigned(&mut bytes)?) / units;
        let commands = unsigned(&mut bytes)?;
        let (mut pieces, mut at, mut start) = (Vec::new(), [0; 2], [0; 2]);
        let place = |[x, y]: [i32; 2]| DVec2::new(f64::from(x), f64::from(y)) / units;
        for _ in 0..commands {
            let code = unsigned(&mut bytes)?;
            let mut point = |from: [i32; 2]| -> Option<[i32; 2]> {
                Some([from[0] + signed(&mut bytes)?, from[1] + signed(&mut bytes)?])
            };
            let from = at;
            match code {
                0 | 1 => {
                    at = if code == 0 { start } else { point(from)? };
                    let [from, to] = [from, at].map(place);
                    pieces.push([from, from.midpoint(to), to]);
                }
                2 => {
                    let control = point(from)?;
                    at = point(control)?;
                    pieces.push([from, control, at].map(place));
                }
                _ => {
                    at = point(from)?;
                    start = at;
                }
            }
        }
        glyphs.insert(char::from_u32(last)?, Glyph { advance, pieces });
    }
    Some(glyphs)
}

/// Reads a number of seven bits a byte, the lowest first.
fn unsigned(bytes: &mut impl Iterator<Item = u8>) -> Option<u32> {
    let (mut value, mut shift) = (0, 0);
    loop {
        let byte = bytes.next()?;
        value |= u32::from(byte & 0x7f).checked_shl(shift)?;
        if byte < 0x80 {
            return Some(value);
        }
        shift += 7;
    }
}

/// Reads a number whose sign is in its lowest bit.
fn signed(bytes: &mut impl Iterator<Item = u8>) -> Option<i32> {
    unsigned(bytes).map(|value| (value >> 1) as i32 ^ -((value & 1) as i32))
}

/// The glyph of `character`, or a box with its number. Spaces and controls are blank.
fn drawn(character: char) -> Drawn {
    let shown = if character.is_control() || character.is_whitespace() { ' ' } else { character };
    match GLYPHS.get(&shown) {
        Some(glyph) => Drawn::Glyph(glyph),
        None => {
            let digits = format!("{:04X}", u32::from(character));
            let middle = digits.len().div_ceil(2);
            Drawn::Box([digits[..middle].to_owned(), digits[middle..].to_owned()])
        }
    }
}

enum Drawn {
    Glyph(&'static Glyph),
    Box([String; 2]),
}

impl Drawn {
    /// Ems to the next character.
    fn advance(&self) -> f64 {
        match self {
            Self::Glyph(glyph) => glyph.advance,
            Self::Box(rows) => box_width(rows) + 2.0 * BOX_GAP,
        }
    }
}

fn box_width(rows: &[String; 2]) -> f64 {
    text_width(&rows[0], BOX_DIGITS).max(text_width(&rows[1], BOX_DIGITS)) + 2.0 * BOX_GAP
}

/// Width of `text` in pixels at `em` pixels per em.
pub fn text_width(text: &str, em: f64) -> f64 {
    text.chars().map(|character| drawn(character).advance()).sum::<f64>() * em
}

/// The outline of `text` at `em` pixels per em. `place` maps pixels to the right of the text's start and
/// above its baseline to those of the picture.
pub fn text_path(text: &str, em: f64, place: impl Fn(DVec2) -> DVec2) -> Path {
    let mut path = Path::default();
    for copy in 0..2 {
        let shift = DVec2::new(WEIGHT * f64::from(copy), 0.0);
        add_text(&mut path, text, em, &|at| place(at + shift));
    }
    path
}

fn add_text(path: &mut Path, text: &str, em: f64, place: &dyn Fn(DVec2) -> DVec2) {
    let mut start = 0.0;
    for character in text.chars() {
        let drawn = drawn(character);
        let at = |point: DVec2| place((point + DVec2::new(start, 0.0)) * em);
        match &drawn {
            Drawn::Glyph(glyph) => {
                glyph.pieces.iter().for_each(|points| path.curve(points.map(at)));
            }
            Drawn::Box(rows) => {
                let low = DVec2::new(BOX_GAP, CAPITALS / 2.0 - BOX / 2.0);
                let high = low + DVec2::new(box_width(rows), BOX);
                // A rim, one pixel wide: the inner rectangle runs the other way round.
                let inner = DVec2::splat(1.0 / em);
                path.polygon(&rectangle(low, high).map(at));
                let mut hole = rectangle(low + inner, high - inner);
                hole.reverse();
                path.polygon(&hole.map(at));
                let digits = CAPITALS * BOX_DIGITS;
                let space = (BOX - 2.0 * digits) / 3.0;
                for (row, bottom) in rows.iter().zip([2.0 * space + digits, space]) {
                    let left = low.x + (box_width(rows) - text_width(row, BOX_DIGITS)) / 2.0;
                    let origin = DVec2::new(left, low.y + bottom);
                    add_text(path, row, BOX_DIGITS * em, &|point| at(origin + point / em));
                }
            }
        }
        start += drawn.advance();
    }
}

fn rectangle(low: DVec2, high: DVec2) -> [DVec2; 4] {
    [low, DVec2::new(low.x, high.y), high, DVec2::new(high.x, low.y)]
}

/// `text` if it is at most `width` pixels wide, else its start and end around an ellipsis.
pub fn fitted(text: &str, em: f64, width: f64) -> String {
    if text_width(text, em) <= width {
        return text.to_owned();
    }
    let characters: Vec<char> = text.chars().collect();
    let shortened = |kept: usize| {
        let (start, end) = (kept.div_ceil(2), kept / 2);
        let start: String = characters[..start].iter().collect();
        let end: String = characters[characters.len() - end..].iter().collect();
        format!("{}\u{2026}{}", start.trim_end(), end.trim_start())
    };
    let fits = |kept: &usize| text_width(&shortened(*kept), em) <= width;
    (0..characters.len()).rev().find(fits).map_or_else(String::new, shortened)
}
