//! Spherical harmonics in the scalings that engines expect.
//!
//! A radiance whose coefficients (see `sh`) are c gives a surface of normal n the irradiance
//! sum A_l c_lm Y_lm(n), with A = pi, 2 pi/3, pi/4, 0, -pi/24 (Ramamoorthi and Hanrahan 2001).

use crate::light::sh::{MAX_COUNT, band};
use std::f64::consts::PI;

/// Scaling of coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShScale {
    /// 1: radiance in the orthonormal basis, as in three.js's `LightProbe` (src/math/SphericalHarmonics3.js
    /// applies the cosine to compute irradiance).
    Radiance,
    /// A_l: irradiance in the orthonormal basis, as `irradianceCoefficients` of EXT_lights_image_based
    /// (Babylon.js's loader divides it by pi); the extension stores the first nine.
    Irradiance,
    /// A_l / pi and the constants of the basis: Filament's `sh`, a polynomial of the normal that gives
    /// irradiance over pi (cmgen's "irradiance, pre-scaled base", libs/ibl/src/CubemapSH.cpp).
    Filament,
}

/// A_l over pi.
pub(crate) const COSINE: [f64; 5] = [1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0];

/// `coefficients` of radiance, scaled: the first nine for Filament, and at most 25 (L4) for irradiance.
#[must_use]
pub fn scaled(coefficients: &[[f64; 3]], scale: ShScale) -> Vec<[f64; 3]> {
    let constant = (1.0 / (4.0 * PI)).sqrt();
    let linear = (3.0 / (4.0 * PI)).sqrt();
    let quadratic = (15.0 / (4.0 * PI)).sqrt();
    let zonal = (5.0 / (16.0 * PI)).sqrt();
    let basis = [constant, linear, linear, linear, quadratic, quadratic, zonal, quadratic, quadratic / 2.0];
    let count = match scale {
        ShScale::Radiance => coefficients.len(),
        ShScale::Irradiance => MAX_COUNT,
        ShScale::Filament => basis.len(),
    };
    let factor = |index: usize| match scale {
        ShScale::Radiance => 1.0,
        ShScale::Irradiance => PI * COSINE[band(index)],
        ShScale::Filament => COSINE[band(index)] * basis[index],
    };
    coefficients.iter().take(count).enumerate().map(|(index, rgb)| rgb.map(|c| c * factor(index))).collect()
}

/// Irradiance over pi at the unit `normal`, from coefficients of [`ShScale::Filament`], as evaluated by
/// Filament's shader (shaders/src/surface_light_indirect.fs, `Irradiance_SphericalHarmonics`).
pub fn filament_irradiance(coefficients: &[[f64; 3]], normal: glam::DVec3) -> [f64; 3] {
    let n = normal;
    let terms =
        [1.0, n.y, n.z, n.x, n.x * n.y, n.y * n.z, 3.0 * n.z * n.z - 1.0, n.z * n.x, n.x * n.x - n.y * n.y];
    std::array::from_fn(|c| terms.iter().zip(coefficients).map(|(term, rgb)| term * rgb[c]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::oracle::Oracle;
    use crate::light::sh::spherical_harmonics;
    use crate::light::synth::synth;
    use glam::DVec3;

    #[test]
    fn filaments_polynomial_is_the_irradiance_of_a_smooth_sky() {
        // Radiance 1 + y/2 + z x: bands 0, 1 and 2 only, so nine coefficients are exact.
        let layout = crate::light::environment::Layout::Cube { size: 32 };
        let mut texels = Vec::new();
        let blank = crate::light::environment::Environment::new(layout, vec![[0.0; 3]; layout.texel_count()])
            .expect("valid");
        blank.for_each_texel(|d, _, _| {
            texels.push([(1.0 + d.y / 2.0 + d.z * d.x) as f32, 1.0, d.x.max(0.0) as f32])
        });
        let sky = crate::light::environment::Environment::new(layout, texels).expect("valid");
        let sh = scaled(&spherical_harmonics(&sky, 2).expect("an order"), ShScale::Filament);
        let oracle = Oracle::new(&sky);
        for normal in
            [DVec3::X, DVec3::NEG_Y, DVec3::new(0.6, 0.0, 0.8), DVec3::new(-2.0, 1.0, 3.0).normalize()]
        {
            let exact = oracle.reflect(crate::lobe::Lobe::Cosine, 1.0, normal).expect("valid");
            let ours = filament_irradiance(&sh, normal);
            assert!((ours[0] - exact[0]).abs() < 2e-3 * exact[0], "{normal}: {ours:?} against {exact:?}");
            assert!((ours[1] - 1.0).abs() < 1e-9, "{normal}: {ours:?}");
        }
    }

    #[test]
    fn irradiance_up_to_l4_is_nearer_than_up_to_l2() {
        let sky = synth("studio").expect("there");
        let all = scaled(&spherical_harmonics(&sky, 4).expect("an order"), ShScale::Irradiance);
        let oracle = Oracle::new(&sky);
        let (mut second, mut fourth, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
        for k in 0..40 {
            let (sin, cos) = (f64::from(k) * 2.4).sin_cos();
            let y = 1.0 - (f64::from(k) + 0.5) / 20.0;
            let normal = DVec3::new((1.0 - y * y).sqrt() * cos, y, (1.0 - y * y).sqrt() * sin);
            let exact = PI * oracle.reflect(crate::lobe::Lobe::Cosine, 1.0, normal).expect("valid")[1];
            let functions = crate::light::sh::basis(normal);
            let sum = |count: usize| (0..count).map(|k| all[k][1] * functions[k]).sum::<f64>();
            second = second.max((sum(9) - exact).abs());
            fourth = fourth.max((sum(25) - exact).abs());
            most = most.max(exact);
        }
        // The truncation error is A_6 = pi/64 or less of the next band.
        assert!(fourth < 0.5 * second && fourth < 0.03 * most, "{fourth} {second} of {most}");
    }

    #[test]
    fn scalings_differ_by_the_cosine_lobe_and_the_basis() {
        let sh = spherical_harmonics(&synth("studio").expect("there"), 2).expect("an order");
        let irradiance = scaled(&sh, ShScale::Irradiance);
        let filament = scaled(&sh, ShScale::Filament);
        assert_eq!(scaled(&sh, ShScale::Radiance), sh);
        // The mean radiance of the sphere, in both: c_00 / sqrt(4 pi).
        let mean = sh[0][1] / (4.0 * PI).sqrt();
        assert!((filament[0][1] - mean).abs() < 1e-12 * mean);
        assert!((irradiance[0][1] / (4.0 * PI).sqrt() / PI - mean).abs() < 1e-12 * mean);
        for (index, norm) in [(1, 0.488_603), (4, 1.092_548), (6, 0.315_392), (8, 0.546_274)] {
            let ratio = filament[index][0] * PI / irradiance[index][0];
            assert!((ratio - norm).abs() < 1e-6, "{index}: {ratio}");
        }
    }
}
