//! Style of all figures: colours, text sizes, colour scales.

/// An 8-bit sRGB colour.
pub type Colour = [u8; 3];

/// Background.
pub(super) const PAPER: Colour = [255, 255, 255];
/// Text and outlines.
pub(super) const INK: Colour = [32, 36, 44];
/// Captions and tick labels.
pub(super) const SOFT: Colour = [62, 68, 78];
/// Grid lines and empty parts of a rectangle.
pub(super) const FAINT: Colour = [222, 225, 230];
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

/// Text sizes in pixels per em.
pub(super) const TITLE: f64 = 24.0;
/// Names of axes, labels of components.
pub(super) const LABEL: f64 = 16.0;
/// Ticks and captions.
pub(super) const SMALL: f64 = 14.5;
/// Marks inside a drawing.
pub(super) const TINY: f64 = 13.0;

/// Pixels around a figure.
pub(super) const MARGIN: f64 = 26.0;

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

/// Colour scale over the logarithm of a positive value, in 32 steps; step edges form contour lines.
#[derive(Clone, Copy, Debug)]
pub struct ColourScale {
    stops: &'static [Colour],
    low: f64,
    high: f64,
    pub(super) ticks: &'static [(f64, &'static str)],
}

/// Relative solid angles, the range of figure 5 of the octahedron paper: green texels are smaller than the
/// mean (oversampled), purple ones larger (undersampled).
pub const RELATIVE_SOLID_ANGLE: ColourScale = ColourScale {
    stops: &[
        [11, 83, 40],
        [62, 145, 80],
        [143, 199, 143],
        [207, 233, 202],
        [247, 247, 245],
        [229, 208, 232],
        [186, 148, 202],
        [131, 80, 158],
        [69, 14, 92],
    ],
    low: 0.25,
    high: 4.0,
    ticks: &[(0.25, "1/4"), (0.5, "1/2"), (1.0, "1"), (2.0, "2"), (4.0, "4")],
};

/// Anisotropy: ratio of both stretches.
pub const ANISOTROPY: ColourScale = ColourScale {
    stops: &[
        [253, 251, 226],
        [213, 234, 186],
        [148, 209, 186],
        [80, 174, 190],
        [38, 124, 178],
        [36, 72, 146],
        [20, 28, 84],
    ],
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
pub(super) const LOBE_ERROR: ColourScale = ColourScale {
    stops: ANISOTROPY.stops,
    low: 0.5,
    high: 8.0,
    ticks: &[(0.5, "0.5"), (1.0, "1"), (2.0, "2"), (4.0, "4"), (8.0, "8")],
};

/// Steps of a scale; every tick is at the middle of a step.
const STEPS: f64 = 32.0;

impl ColourScale {
    /// Minimum and maximum of the scale.
    #[must_use]
    pub const fn range(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Position of `value` between the scale's ends, 0 to 1.
    pub(super) fn share(&self, value: f64) -> f64 {
        ((value / self.low).ln() / (self.high / self.low).ln()).clamp(0.0, 1.0)
    }

    /// The colour of `value`; values beyond an end get the end's colour, NaN is grey.
    #[must_use]
    pub fn colour(&self, value: f64) -> Colour {
        if value.is_nan() {
            return [128; 3];
        }
        self.colour_at(self.share(value))
    }

    /// The colour of the step nearest to `share` of the scale, 0 to 1.
    pub(super) fn colour_at(&self, share: f64) -> Colour {
        let at = (share * STEPS).round() / STEPS * (self.stops.len() - 1) as f64;
        let k = (at as usize).min(self.stops.len() - 2);
        mix(self.stops[k], self.stops[k + 1], at - k as f64)
    }
}

/// Interpolates from `a` (0) to `b` (1).
pub(super) fn mix(a: Colour, b: Colour, share: f64) -> Colour {
    std::array::from_fn(|c| {
        let (a, b) = (f64::from(a[c]), f64::from(b[c]));
        (a + (b - a) * share).round() as u8
    })
}
