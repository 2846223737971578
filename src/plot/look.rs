//! Colours of figures and charts, in addition to the common style.

use crate::image::drawing::style::Colour;

/// Lines over heat maps.
pub(super) const THIN: Colour = [138, 144, 154];
/// Area of a map's rectangle outside its domain.
pub(super) const OUTSIDE: Colour = [240, 241, 243];
/// Parallels.
pub(super) const LATITUDE: Colour = [0, 104, 180];
/// Meridians.
pub(super) const LONGITUDE: Colour = [196, 82, 0];
/// Series of a chart and parts of a curve: Okabe and Ito's colour-blind-safe palette, and
/// grey.
pub(super) const SERIES: [Colour; 7] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [100, 104, 112],
];
/// Pastels of the eight octants: bit 0 is set where x is negative, bit 1 for y, bit 2 for z.
pub(super) const OCTANTS: [Colour; 8] = [
    [255, 222, 214],
    [214, 236, 255],
    [228, 200, 226],
    [203, 205, 240],
    [255, 240, 200],
    [216, 243, 214],
    [240, 214, 188],
    [196, 224, 222],
];
