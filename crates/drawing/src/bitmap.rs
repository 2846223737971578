//! Pictures in memory. Those of the crate `image` bring resizing, filters and conversions of all pixels,
//! which took a fifteenth of the program's build.

use super::style::Colour;

/// A picture of 8-bit sRGB colours, row by row from the top left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bitmap {
    width: u32,
    height: u32,
    pixels: Vec<Colour>,
}

impl Bitmap {
    /// A picture of `colour`.
    pub fn filled(width: u32, height: u32, colour: Colour) -> Self {
        Self { width, height, pixels: vec![colour; width as usize * height as usize] }
    }

    /// A picture of `pixels`.
    ///
    /// # Panics
    /// If they are not `width` times `height`.
    pub fn new(width: u32, height: u32, pixels: Vec<Colour>) -> Self {
        assert_eq!(pixels.len(), width as usize * height as usize, "pixels of {width}x{height}");
        Self { width, height, pixels }
    }

    /// A picture whose pixels are `colour(column, row)`.
    pub fn from_fn(width: u32, height: u32, colour: impl Fn(u32, u32) -> Colour) -> Self {
        let row = |y: u32| (0..width).map(move |x| (x, y));
        Self::new(width, height, (0..height).flat_map(row).map(|(x, y)| colour(x, y)).collect())
    }

    /// Columns.
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// The pixel in column `x` of row `y`.
    pub fn pixel(&self, x: u32, y: u32) -> Colour {
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// The same, to change it.
    pub fn pixel_mut(&mut self, x: u32, y: u32) -> &mut Colour {
        &mut self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// Three bytes a pixel.
    pub fn bytes(&self) -> &[u8] {
        self.pixels.as_flattened()
    }

    /// Puts `other` over the pixels from (`left`, `top`) on; what lies outside is left out.
    pub fn put(&mut self, other: &Self, left: i64, top: i64) {
        let inside = |at: i64, length: u32| u32::try_from(at).ok().filter(|at| *at < length);
        for y in 0..other.height {
            let Some(row) = inside(top + i64::from(y), self.height) else { continue };
            for x in 0..other.width {
                if let Some(column) = inside(left + i64::from(x), self.width) {
                    *self.pixel_mut(column, row) = other.pixel(x, y);
                }
            }
        }
    }
}
