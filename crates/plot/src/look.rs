//! Colours of figures and charts, in addition to the common style.

use octagloss_drawing::style::Colour;

/// Lines over heat maps.
pub const THIN: Colour = [138, 144, 154];
/// Area of a map's rectangle outside its domain.
pub const OUTSIDE: Colour = [240, 241, 243];
/// Parallels.
pub const LATITUDE: Colour = [0, 104, 180];
/// Meridians.
pub const LONGITUDE: Colour = [196, 82, 0];
/// Series of a chart and parts of a curve, as 0xRRGGBB: Okabe and Ito's colour-blind-safe palette, and
/// grey.
pub const SERIES: [u32; 7] = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x646870];
/// Pastels of the eight octants, as 0xRRGGBB: bit 0 is set where x is negative, bit 1 for y, bit 2 for z.
pub const OCTANTS: [u32; 8] =
    [0xffded6, 0xd6ecff, 0xe4c8e2, 0xcbcdf0, 0xfff0c8, 0xd8f3d6, 0xf0d6bc, 0xc4e0de];
