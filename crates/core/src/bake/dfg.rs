//! The split-sum DFG (BRDF integration) lookup table: the reflectance of a rough surface in a white
//! environment, over the cosine of the view angle and the roughness.
//!
//! GGX with height-correlated Smith visibility (Heitz 2014) and Schlick's Fresnel, in Karis's form (a scale
//! and a bias for f0) or in the one for multiple scattering; and Charlie with Neubelt's visibility (Estevez
//! and Kulla 2017, Neubelt and Pettineo 2013), which glTF and Filament use for sheen and cloth. Computed by
//! Gauss-Legendre quadrature over half vectors, on pieces where the integrand is smooth: deterministic and
//! free of noise.

use crate::common::error::{Result, wrong};
use crate::common::parallel;
use crate::lobe::reflectance;
use crate::sphere::quadrature::gauss_legendre;
use std::sync::atomic::{AtomicU64, Ordering};

/// Form of the red and green channels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum DfgForm {
    /// Specular = f0 * red + f90 * green (Karis 2013; Khronos's sampler and viewer, three.js, Bevy).
    #[default]
    SplitSum,
    /// Specular = mix(red, green, f0), green is the reflectance of f0 = 1; 1/green - 1 compensates for
    /// multiple scattering (Filament, cmgen --ibl-dfg-multiscatter).
    MultipleScattering,
}

/// A table of `size` x `size` texels: column i has the cosine (i+1/2)/size, row j the perceptual roughness
/// (j+1/2)/size.
#[derive(Clone, Debug, PartialEq)]
pub struct DfgTable {
    /// Texels along an edge.
    pub size: u32,
    /// Row-major; red and green according to the form; blue is the reflectance of a Charlie lobe, or 0.
    pub texels: Vec<[f32; 3]>,
}

/// Content of the blue channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DfgBlue {
    /// 0.
    Empty,
    /// The reflectance of a Charlie lobe (sheen).
    Charlie,
}

/// Computes the table of `size` texels a side.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for a size of 0 or above 1024.
pub fn dfg_table(size: u32, form: DfgForm, blue: DfgBlue) -> Result<DfgTable> {
    dfg_table_with(size, form, blue, &|_, _| ())
}

/// [`dfg_table`] with progress: calls `progress` with the rows done and their total, from any thread.
///
/// # Errors
/// Those of [`dfg_table`].
pub fn dfg_table_with(
    size: u32,
    form: DfgForm,
    blue: DfgBlue,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<DfgTable> {
    if !(1..=1024).contains(&size) {
        return wrong(format!("a table of {size} texels; `size` must be 1 to 1024"));
    }
    let (rule, fine) = (gauss_legendre(NODES), gauss_legendre(2 * NODES));
    let centre = |k: u32| (f64::from(k) + 0.5) / f64::from(size);
    let texel = |index: u32| {
        let (cosine, roughness) = (centre(index % size), centre(index / size));
        let [scale, bias] = reflectance::ggx(cosine, roughness, &rule);
        let [red, green] = match form {
            DfgForm::SplitSum => [scale, bias],
            DfgForm::MultipleScattering => [bias, scale + bias],
        };
        let blue = match blue {
            DfgBlue::Charlie => reflectance::charlie(cosine, roughness, &fine),
            DfgBlue::Empty => 0.0,
        };
        [red, green, blue].map(|value| value as f32)
    };
    let mut texels = vec![[0.0; 3]; size as usize * size as usize];
    let done = AtomicU64::new(0);
    parallel::for_each(texels.chunks_mut(size as usize).zip(0..size), |(row, j)| {
        row.iter_mut().zip(j * size..).for_each(|(value, index)| *value = texel(index));
        progress(done.fetch_add(1, Ordering::Relaxed) + 1, u64::from(size));
    });
    Ok(DfgTable { size, texels })
}

/// Nodes per piece and axis. Doubling them changes GGX by less than 1e-4 and Charlie by less than half-float
/// rounding.
const NODES: u32 = 48;

/// Scale and bias of f0 for GGX at the view's `cosine` in (0, 1] and the perceptual `roughness` in \[0, 1\];
/// their sum is the single-scattering reflectance of a white surface of that roughness.
pub fn ggx(cosine: f64, roughness: f64) -> [f64; 2] {
    reflectance::ggx(cosine, roughness, &gauss_legendre(NODES))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use std::f64::consts::PI;

    /// Reflectance of a Charlie lobe at the view's `cosine` in (0, 1] and the perceptual sheen `roughness` in
    /// (0, 1].
    fn charlie_reflectance(cosine: f64, roughness: f64) -> f64 {
        reflectance::charlie(cosine, roughness, &gauss_legendre(2 * NODES))
    }

    /// The same integral over light directions instead of half vectors, by midpoints: an independent method.
    fn over_lights(cosine: f64, f: impl Fn(DVec3, DVec3) -> [f64; 2]) -> [f64; 2] {
        let view = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        let (rings, sectors) = (1500, 1500);
        let mut sum = [0.0; 2];
        for j in 0..rings {
            let z = (f64::from(j) + 0.5) / f64::from(rings);
            for i in 0..sectors {
                let (sin, cos) = (PI * (f64::from(i) + 0.5) / f64::from(sectors)).sin_cos();
                let radius = (1.0 - z * z).sqrt();
                let light = DVec3::new(radius * cos, radius * sin, z);
                let values = f(light, (view + light).normalize());
                sum = [sum[0] + values[0], sum[1] + values[1]];
            }
        }
        sum.map(|s| s * 2.0 * PI / f64::from(rings) / f64::from(sectors))
    }

    #[test]
    fn ggx_agrees_with_integration_over_lights() {
        for (cosine, roughness) in [(0.05, 0.5), (0.3, 0.4), (0.5, 0.7), (0.9, 0.5), (1.0, 1.0), (0.2, 1.0)] {
            let alpha: f64 = roughness * roughness;
            let a2 = alpha * alpha;
            let exact = over_lights(cosine, |light, half| {
                let d = a2 / (PI * (half.z * half.z * (a2 - 1.0) + 1.0).powi(2));
                let smith = |z: f64| (z * z * (1.0 - a2) + a2).sqrt();
                let v = 0.5 / (light.z * smith(cosine) + cosine * smith(light.z));
                let bias = (1.0 - light.dot(half)).powi(5);
                [d * v * light.z * (1.0 - bias), d * v * light.z * bias]
            });
            let ours = ggx(cosine, roughness);
            for c in 0..2 {
                assert!(
                    (ours[c] - exact[c]).abs() < 2e-4,
                    "{cosine} {roughness}: {ours:?} against {exact:?}"
                );
            }
        }
    }

    #[test]
    fn charlie_agrees_with_integration_over_lights() {
        for (cosine, roughness) in [(0.1, 0.3), (0.3, 0.5), (0.7, 0.8), (1.0, 1.0), (0.9, 0.2)] {
            let alpha: f64 = roughness * roughness;
            let [exact, _] = over_lights(cosine, |light, half| {
                let d = (2.0 + 1.0 / alpha) * (1.0 - half.z * half.z).powf(0.5 / alpha) / (2.0 * PI);
                [d * light.z / (4.0 * (light.z + cosine - light.z * cosine)), 0.0]
            });
            let ours = charlie_reflectance(cosine, roughness);
            assert!((ours - exact).abs() < 2e-4, "{cosine} {roughness}: {ours} against {exact}");
        }
    }

    #[test]
    fn twice_the_nodes_change_nothing_that_half_floats_show() {
        for cosine in [1.0 / 256.0, 0.02, 0.1, 0.37, 0.8, 255.0 / 256.0, 1.0] {
            for roughness in [1.0 / 256.0, 0.03, 0.1, 0.25, 0.5, 0.8, 1.0] {
                let (once, twice) =
                    (ggx(cosine, roughness), reflectance::ggx(cosine, roughness, &gauss_legendre(2 * NODES)));
                for c in 0..2 {
                    let change = (once[c] - twice[c]).abs();
                    assert!(change < 1e-4, "{cosine} {roughness}: {once:?} {twice:?}");
                }
                let (once, twice) = (
                    charlie_reflectance(cosine, roughness),
                    reflectance::charlie(cosine, roughness, &gauss_legendre(4 * NODES)),
                );
                let rounding = twice.max(1.0) / 2048.0;
                assert!((once - twice).abs() < rounding, "Charlie {cosine} {roughness}: {once} {twice}");
            }
        }
    }

    #[test]
    fn mirrors_and_forms_are_what_they_are_defined_to_be() {
        for cosine in [0.1_f64, 0.5, 1.0] {
            let [scale, bias] = ggx(cosine, 0.0);
            assert!((scale + bias - 1.0).abs() < 1e-12 && (bias - (1.0 - cosine).powi(5)).abs() < 1e-12);
            let near = ggx(cosine, 0.01);
            assert!((near[0] + near[1] - 1.0).abs() < 1e-3, "{cosine}: {near:?}");
        }
        let split = dfg_table(8, DfgForm::SplitSum, DfgBlue::Charlie).unwrap();
        let multiple = dfg_table(8, DfgForm::MultipleScattering, DfgBlue::Empty).unwrap();
        for (a, b) in split.texels.iter().zip(&multiple.texels) {
            assert!((a[1] - b[0]).abs() < 1e-6 && (a[0] + a[1] - b[1]).abs() < 1e-6, "{a:?} {b:?}");
            assert!(a[2] > 0.0 && b[2] == 0.0 && a.iter().all(|v| v.is_finite()), "{a:?} {b:?}");
        }
        assert!(dfg_table(0, DfgForm::SplitSum, DfgBlue::Empty).is_err());
        let rows = AtomicU64::new(0);
        dfg_table_with(8, DfgForm::SplitSum, DfgBlue::Empty, &|_, total| {
            assert_eq!(total, 8);
            rows.fetch_add(1, Ordering::Relaxed);
        })
        .unwrap();
        assert_eq!(rows.into_inner(), 8);
    }
}
