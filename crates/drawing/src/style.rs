//! Colours, text sizes and margins of all pictures.

/// An 8-bit sRGB colour.
pub type Colour = [u8; 3];

/// Background.
pub const PAPER: Colour = [255, 255, 255];
/// Text and outlines.
pub const INK: Colour = [32, 36, 44];
/// Captions and tick labels.
pub const SOFT: Colour = [62, 68, 78];
/// Grid lines and empty parts of a rectangle.
pub const FAINT: Colour = [222, 225, 230];

/// Text sizes in pixels per em.
pub const TITLE: f64 = 24.0;
/// Names of axes, labels of components.
pub const LABEL: f64 = 16.0;
/// Ticks and captions.
pub const SMALL: f64 = 14.5;
/// Marks inside a drawing.
pub const TINY: f64 = 13.0;

/// Pixels around a figure.
pub const MARGIN: f64 = 26.0;
/// Pixels between the parts of a figure.
pub const GAP: f64 = 16.0;

/// Distance of the baselines of lines of text, in ems.
pub const LINE: f64 = 1.45;

/// The colour 0xRRGGBB.
pub const fn rgb(number: u32) -> Colour {
    let [_, red, green, blue] = number.to_be_bytes();
    [red, green, blue]
}

/// Interpolates from `a` (0) to `b` (1).
pub fn mix(a: Colour, b: Colour, share: f64) -> Colour {
    std::array::from_fn(|c| {
        let (a, b) = (f64::from(a[c]), f64::from(b[c]));
        (a + (b - a) * share).round() as u8
    })
}
