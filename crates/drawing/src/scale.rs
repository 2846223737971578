//! Colour scales.

use super::style::{Colour, mix, rgb};
use crate::tone::srgb;

/// Colour scale over the logarithm of a positive value.
#[derive(Clone, Copy, Debug)]
pub struct ColourScale {
    shade: Shade,
    low: f64,
    high: f64,
    pub ticks: &'static [(f64, &'static str)],
}

/// Colours along a scale.
#[derive(Clone, Copy, Debug)]
enum Shade {
    /// Interpolates between colours (0xRRGGBB), in 32 steps, whose edges form contour lines.
    Stops(&'static [u32]),
    /// Black for 0, then blue over red to pale yellow. Perceived lightness is linear in the logarithm (a
    /// spiral in Ottosson's OKLab, 2020).
    Spiral,
}

/// Relative solid angles, the range of figure 5 of the octahedron paper: green texels are smaller than the
/// mean (oversampled), purple ones larger (undersampled).
pub const RELATIVE_SOLID_ANGLE: ColourScale = ColourScale {
    shade: Shade::Stops(&[
        0x0b5328, 0x3e9150, 0x8fc78f, 0xcfe9ca, 0xf7f7f5, 0xe5d0e8, 0xba94ca, 0x83509e, 0x450e5c,
    ]),
    low: 0.25,
    high: 4.0,
    ticks: &[(0.25, "1/4"), (0.5, "1/2"), (1.0, "1"), (2.0, "2"), (4.0, "4")],
};

/// Anisotropy: ratio of both stretches.
pub const ANISOTROPY: ColourScale = ColourScale {
    shade: Shade::Stops(&[0xfdfbe2, 0xd5eaba, 0x94d1ba, 0x50aebe, 0x267cb2, 0x244892, 0x141c54]),
    low: 1.0,
    high: 4.0,
    ticks: &[
        (1.0, "1"),
        (std::f64::consts::SQRT_2, "1.41"),
        (2.0, "2"),
        (2.0 * std::f64::consts::SQRT_2, "2.83"),
        (4.0, "4"),
    ],
};

/// Errors of lobes in per cent of the mean.
pub const LOBE_ERROR: ColourScale = ColourScale {
    shade: ANISOTROPY.shade,
    low: 0.5,
    high: 8.0,
    ticks: &[(0.5, "0.5"), (1.0, "1"), (2.0, "2"), (4.0, "4"), (8.0, "8")],
};

/// Relative errors of luminance, in error pictures and the viewer.
pub const RELATIVE_ERROR: ColourScale = ColourScale {
    shade: Shade::Spiral,
    low: 1e-4,
    high: 1.0,
    ticks: &[(1e-4, "0.01 %"), (1e-3, "0.1 %"), (1e-2, "1 %"), (0.1, "10 %"), (1.0, "100 %")],
};

/// Steps of a scale; every tick is at the middle of a step.
const STEPS: f64 = 32.0;

impl ColourScale {
    /// Minimum and maximum of the scale.
    pub const fn range(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Position of `value` between the scale's ends, 0 to 1.
    pub fn share(&self, value: f64) -> f64 {
        ((value / self.low).ln() / (self.high / self.low).ln()).clamp(0.0, 1.0)
    }

    /// The colour of `value`; values beyond an end get the end's colour, NaN is grey.
    pub fn colour(&self, value: f64) -> Colour {
        match self.shade {
            _ if value.is_nan() => [128; 3],
            Shade::Spiral if value <= 0.0 => [0; 3],
            _ => self.colour_at(self.share(value)),
        }
    }

    /// The colour of `share` of the scale, 0 to 1.
    pub fn colour_at(&self, share: f64) -> Colour {
        let Shade::Stops(stops) = self.shade else { return spiral(share) };
        let at = (share * STEPS).round() / STEPS * (stops.len() - 1) as f64;
        let k = (at as usize).min(stops.len() - 2);
        mix(rgb(stops[k]), rgb(stops[k + 1]), at - k as f64)
    }
}

/// The colour of [`Shade::Spiral`] at `t`, 0 to 1.
fn spiral(t: f64) -> Colour {
    let lightness = 0.22 + 0.74 * t;
    let hue = (265.0 + 205.0 * t).to_radians();
    let chroma = 0.04 + 0.13 * (t * std::f64::consts::PI).sin();
    let (a, b) = (chroma * hue.cos(), chroma * hue.sin());
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    let linear = [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ];
    srgb(linear.map(|c| c as f32))
}
