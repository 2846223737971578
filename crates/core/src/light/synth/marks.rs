//! Marks of the labelled environment: a few signs of 5 x 7 cells.

/// Cells across a glyph.
const GLYPH_WIDTH: u32 = 5;
/// Cells down a glyph.
const GLYPH_HEIGHT: u32 = 7;

/// Rows from the top, the leftmost cell in bit 4.
const GLYPHS: [(char, [u8; 7]); 6] = [
    ('X', [0x11, 0x11, 0x0a, 0x04, 0x0a, 0x11, 0x11]),
    ('Y', [0x11, 0x11, 0x0a, 0x04, 0x04, 0x04, 0x04]),
    ('Z', [0x1f, 0x01, 0x02, 0x04, 0x08, 0x10, 0x1f]),
    ('+', [0x00, 0x04, 0x04, 0x1f, 0x04, 0x04, 0x00]),
    ('-', [0x00, 0x00, 0x00, 0x1f, 0x00, 0x00, 0x00]),
    ('^', [0x04, 0x0e, 0x15, 0x04, 0x04, 0x04, 0x04]),
];

/// Width of `text` in cells, with one cell between glyphs.
pub(super) fn text_width(text: &str) -> u32 {
    (text.chars().count() as u32 * (GLYPH_WIDTH + 1)).saturating_sub(1)
}

/// Whether the cell (`x`, `y`) of `text`, from the top left, is inked. `^` is an upward arrow;
/// unknown characters are blanks.
pub(super) fn is_inked(text: &str, x: u32, y: u32) -> bool {
    let (at, column) = ((x / (GLYPH_WIDTH + 1)) as usize, x % (GLYPH_WIDTH + 1));
    let Some(character) = text.chars().nth(at) else { return false };
    if column == GLYPH_WIDTH || y >= GLYPH_HEIGHT {
        return false;
    }
    GLYPHS
        .iter()
        .find(|(glyph, _)| *glyph == character)
        .is_some_and(|(_, rows)| (rows[y as usize] >> (GLYPH_WIDTH - 1 - column)) & 1 == 1)
}
