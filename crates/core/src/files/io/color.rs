//! Converts file primaries to Rec. 709.

use crate::light::environment::Rgb;
use glam::{DMat3, DVec3};

/// CIE 1931 x, y of red, green, blue and the white point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Primaries(pub(super) [[f64; 2]; 4]);

/// Rec. 709 and sRGB.
pub(super) const REC709: Primaries = Primaries([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], D65]);
const D65: [f64; 2] = [0.3127, 0.3290];
const EQUAL_ENERGY: [f64; 2] = [1.0 / 3.0, 1.0 / 3.0];

/// Tolerance: files give chromaticities to three or four digits.
const SAME: f64 = 1e-3;

/// The Bradford cone responses, by rows (Lam 1985).
const BRADFORD: DMat3 = DMat3::from_cols_array(&[
    0.8951, -0.7502, 0.0389, //
    0.2664, 1.7135, -0.0685, //
    -0.1614, 0.0367, 1.0296,
]);

fn is_same(a: [f64; 2], b: [f64; 2]) -> bool {
    (a[0] - b[0]).abs() < SAME && (a[1] - b[1]).abs() < SAME
}

fn xyz_from_xy([x, y]: [f64; 2]) -> DVec3 {
    DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
}

impl Primaries {
    /// Whether these are Rec. 709 within the rounding of their digits.
    fn are_rec709(&self) -> bool {
        self.0.iter().zip(REC709.0).all(|(own, other)| is_same(*own, other))
    }

    /// XYZ (white has Y = 1) from linear RGB; `None` if the primaries are degenerate.
    fn xyz_from_rgb(&self) -> Option<DMat3> {
        let [red, green, blue, white] = self.0.map(xyz_from_xy);
        let columns = DMat3::from_cols(red, green, blue);
        let scale = invertible(columns)?.inverse() * white;
        invertible(columns * DMat3::from_diagonal(scale))
    }

    /// Converts `texels` to Rec. 709 if these primaries, which their file names `what`, are others. Returns a
    /// warning.
    pub(super) fn converted(&self, what: &str, texels: &mut [Rgb]) -> Option<String> {
        if self.are_rec709() {
            return None;
        }
        let Some(matrix) = self.rec709_from_rgb() else {
            return Some(format!("its {what} are degenerate; ignored"));
        };
        transform(texels, matrix);
        Some(format!("its {what} are not Rec. 709; converted"))
    }

    /// Rec. 709 from these primaries, with Bradford adaptation; `None` if they are degenerate.
    fn rec709_from_rgb(&self) -> Option<DMat3> {
        Some(rec709_from_xyz(self.0[3])? * self.xyz_from_rgb()?)
    }

    /// The weights of red, green and blue in Y.
    pub(super) fn luminance_weights(&self) -> Option<[f64; 3]> {
        self.xyz_from_rgb().map(|matrix| matrix.row(1).to_array())
    }
}

/// Rec. 709 from XYZ with the equal-energy white, as in Radiance XYZE files.
pub(super) fn rec709_from_equal_energy_xyz() -> DMat3 {
    rec709_from_xyz(EQUAL_ENERGY).expect("constants span a gamut")
}

fn rec709_from_xyz(white: [f64; 2]) -> Option<DMat3> {
    let rec709_from_d65 = REC709.xyz_from_rgb()?.inverse();
    if is_same(white, D65) {
        return Some(rec709_from_d65);
    }
    let gains = (BRADFORD * xyz_from_xy(D65)) / (BRADFORD * xyz_from_xy(white));
    let adapted = BRADFORD.inverse() * DMat3::from_diagonal(gains) * BRADFORD;
    invertible(adapted).map(|adapted| rec709_from_d65 * adapted)
}

/// Returns `matrix` if it is invertible.
fn invertible(matrix: DMat3) -> Option<DMat3> {
    (matrix.is_finite() && matrix.determinant().abs() > 1e-6).then_some(matrix)
}

/// Applies `matrix` to every texel. Finite texels stay finite: values are clamped to the float32 range.
pub(super) fn transform(texels: &mut [Rgb], matrix: DMat3) {
    let single = matrix.as_mat3();
    for texel in texels {
        let before = glam::Vec3::from_array(*texel);
        let mut after = single * before;
        if before.is_finite() && !after.is_finite() {
            let end = f64::from(f32::MAX);
            after = (matrix * before.as_dvec3()).clamp(DVec3::splat(-end), DVec3::splat(end)).as_vec3();
        }
        *texel = after.to_array();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rec709_maps_to_itself() {
        let matrix = REC709.rec709_from_rgb().unwrap();
        assert!(matrix.abs_diff_eq(DMat3::IDENTITY, 1e-12), "{matrix}");
        let weights = REC709.luminance_weights().unwrap();
        assert!((weights[1] - 0.7152).abs() < 1e-4, "{weights:?}");
    }

    #[test]
    fn white_stays_white_under_every_white_point() {
        let aces = Primaries([[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077], [0.32168, 0.33767]]);
        let matrix = aces.rec709_from_rgb().unwrap();
        assert!((matrix * DVec3::ONE).abs_diff_eq(DVec3::ONE, 1e-9), "{}", matrix * DVec3::ONE);
        // ACES AP0 to linear sRGB with Bradford, as published with the ACES transforms.
        assert!((matrix.x_axis.x - 2.5217).abs() < 1e-3, "{matrix}");
        assert!((rec709_from_equal_energy_xyz() * DVec3::ONE).abs_diff_eq(DVec3::ONE, 1e-9), "white");
    }

    #[test]
    fn finite_light_stays_finite() {
        let wide = Primaries([[0.708, 0.292], [0.17, 0.797], [0.131, 0.046], D65]);
        let matrix = wide.rec709_from_rgb().unwrap();
        let mut texels =
            [[f32::MAX, 0.0, 0.0], [f32::MAX, f32::MAX, 0.0], [1e-45, 0.0, 0.0], [f32::NAN, 0.0, 0.0]];
        transform(&mut texels, matrix);
        assert!(texels[..3].as_flattened().iter().all(|c| c.is_finite()), "{texels:?}");
        assert_eq!(texels[0][0], f32::MAX);
        assert!(texels[3][0].is_nan(), "non-finite values stay, to be reported");
    }

    #[test]
    fn collinear_primaries_span_nothing() {
        let flat = Primaries([[0.2, 0.2], [0.3, 0.3], [0.4, 0.4], D65]);
        assert!(flat.rec709_from_rgb().is_none(), "collinear");
        let zero = Primaries([[0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2]]);
        assert!(zero.rec709_from_rgb().is_none(), "zero");
    }
}
