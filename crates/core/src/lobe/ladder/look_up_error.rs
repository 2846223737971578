//! Estimated error of trilinear look-ups in a chain, from its ladder and sizes alone.
//!
//! Model: sampled GGX levels of an environment that is one point light at a random direction. A look-up is
//! then a mixture of two levels' lobes, each sampled at texel centres and interpolated bilinearly at a random
//! phase. All of it is diagonal in spherical harmonics: band l has the lobe's zonal weight, the mean factor
//! of bilinear interpolation at l cycles per turn, and the power that sampling aliases.

use super::{Ladder, edges_of_a_face};
use crate::light::environment::Map;
use crate::lobe::{Lobe, zonal_nodes};
use std::array;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
use std::sync::LazyLock;

/// Bands of the spherical harmonics: lobes of roughness 0.6 have less than 1e-6 of their power beyond.
const BANDS: usize = 128;

/// Roughnesses at which look-ups are judged: from 0.6 to 1, by which default chains are chosen too.
const JUDGED: usize = 17;

/// The judged roughnesses and the bands of their lobes: ladders are compared by the same ones.
static JUDGED_LOBES: LazyLock<[(f64, [f64; BANDS]); JUDGED]> = LazyLock::new(|| {
    array::from_fn(|index| {
        let roughness = 0.6 + 0.4 * index as f64 / (JUDGED - 1) as f64;
        (roughness, zonal_bands(roughness))
    })
});

impl Ladder {
    /// Greatest relative RMS error of trilinear look-ups at roughness 0.6 to 1 in a sampled GGX chain of
    /// `levels` levels below a level 0 of `size` texels of `map`. Estimated for a point light; on panoramas
    /// the measured error is within a factor of two of it.
    #[must_use]
    pub fn look_up_error(self, map: Map, size: u32, levels: u32) -> f64 {
        let face = f64::from(size) / f64::from(edges_of_a_face(map));
        // Levels below the one that serves 0.6 are never read.
        let first = self.lod(0.6, levels, size) as u32;
        let sampled: Vec<LevelBands> = (first..levels.max(1))
            .map(|level| {
                let edge = (face / f64::from(level).exp2()).max(1.0);
                LevelBands::new(self.roughness(level, levels, size), edge)
            })
            .collect();
        let error = |(judged, exact): &(f64, [f64; BANDS])| {
            let lod = self.lod(*judged, levels, size) - f64::from(first);
            let low = (lod as usize).min(sampled.len() - 1);
            let high = (low + 1).min(sampled.len() - 1);
            mixture_error(exact, &sampled[low], &sampled[high], lod - low as f64)
        };
        JUDGED_LOBES.iter().map(error).fold(0.0, f64::max)
    }
}

/// A sampled level in spherical harmonics.
struct LevelBands {
    /// Factor of each band in a look-up, over all phases of the texels.
    mean: [f64; BANDS],
    /// Variance of that factor over the phases.
    variance: [f64; BANDS],
}

impl LevelBands {
    /// The level of `roughness` on a cube of `edge` texels.
    fn new(roughness: f64, edge: f64) -> Self {
        let lobe = zonal_bands(roughness);
        let factors: [(f64, f64); BANDS] = array::from_fn(|band| interpolation(band as f64, edge));
        Self {
            mean: array::from_fn(|band| lobe[band] * factors[band].0),
            variance: array::from_fn(|band| lobe[band] * lobe[band] * factors[band].1),
        }
    }
}

/// Relative RMS error of `low` and `high`, mixed by `share` of the latter, against the lobe `exact`.
fn mixture_error(exact: &[f64; BANDS], low: &LevelBands, high: &LevelBands, share: f64) -> f64 {
    let (mut error, mut power) = (0.0, 0.0);
    for band in 0..BANDS {
        let harmonics = 2.0 * band as f64 + 1.0;
        let mean = (1.0 - share) * low.mean[band] + share * high.mean[band];
        let variance =
            (1.0 - share) * (1.0 - share) * low.variance[band] + share * share * high.variance[band];
        error += harmonics * ((exact[band] - mean) * (exact[band] - mean) + variance);
        power += harmonics * exact[band] * exact[band];
    }
    (error / power).sqrt()
}

/// Mean and variance, over the texels' phases, of the factor that sampling and bilinear interpolation put on
/// a plane wave of `band` cycles per turn. A cube's texel is taken as a quarter turn over `edge`.
///
/// In one dimension at f cycles per texel the mean is sinc^2 f and the mean square (2 + cos 2 pi f)/3; two
/// dimensions multiply. Averaged over the wave's direction.
fn interpolation(band: f64, edge: f64) -> (f64, f64) {
    const DIRECTIONS: u32 = 8;
    let cycles = band * FRAC_PI_2 / (TAU * edge);
    let sinc = |f: f64| if f == 0.0 { 1.0 } else { (PI * f).sin() / (PI * f) };
    let (mut mean, mut square) = (0.0, 0.0);
    for k in 0..DIRECTIONS {
        let (sine, cosine) = ((f64::from(k) + 0.5) / f64::from(DIRECTIONS) * FRAC_PI_4).sin_cos();
        let along = [cycles * cosine, cycles * sine];
        mean += along.map(|f| sinc(f).powi(2)).iter().product::<f64>();
        square += along.map(|f| (2.0 + (TAU * f).cos()) / 3.0).iter().product::<f64>();
    }
    let (mean, square) = (mean / f64::from(DIRECTIONS), square / f64::from(DIRECTIONS));
    (mean, (square - mean * mean).max(0.0))
}

/// Zonal weights of the normalised GGX lobe of `roughness`; of a mirror all are 1.
fn zonal_bands(roughness: f64) -> [f64; BANDS] {
    let alpha = roughness * roughness;
    // Narrower lobes have all their power in the bands.
    if alpha < 1e-5 {
        return [1.0; BANDS];
    }
    let (nodes, mut weighted): (Vec<f64>, Vec<f64>) = zonal_nodes(Lobe::Ggx, alpha).unzip();
    // Legendre polynomials of two successive bands at all nodes, times the nodes' weights. All nodes of a
    // band take the same two factors, so that the compiler can vectorise the loop.
    let mut before = vec![0.0; nodes.len()];
    let mut bands = [0.0; BANDS];
    for (l, band) in bands.iter_mut().enumerate() {
        // Several sums, none of which waits for the others.
        let mut sums = [0.0; 8];
        for weighted in weighted.chunks(8) {
            sums.iter_mut().zip(weighted).for_each(|(sum, value)| *sum += value);
        }
        *band = sums.iter().sum();
        let l = l as f64;
        let (along, back) = ((2.0 * l + 1.0) / (l + 1.0), l / (l + 1.0));
        for ((x, before), weighted) in nodes.iter().zip(&mut before).zip(&mut weighted) {
            (*before, *weighted) = (*weighted, along * x * *weighted - back * *before);
        }
    }
    let integral = bands[0];
    bands.map(|band| band / integral)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lobe::legendre;

    /// Factors of the harmonics of order 0 to 4 under convolution with the normalised lobe: 2 pi times the
    /// integral over cos(theta) of the kernel times Legendre's polynomials. `alpha` in (0, 1]; accurate to
    /// 1e-6 from 0.1 on.
    fn zonal_weights(lobe: Lobe, alpha: f64) -> [f64; 5] {
        let mut sums = [0.0; 5];
        for (cosine, weight) in zonal_nodes(lobe, alpha) {
            for (sum, value) in sums.iter_mut().zip(legendre(cosine)) {
                *sum += weight * value;
            }
        }
        sums.map(|sum| sum / sums[0])
    }

    #[test]
    fn bands_are_the_zonal_weights() {
        for roughness in [0.3, 0.6, 1.0] {
            let expected = zonal_weights(Lobe::Ggx, roughness * roughness);
            for (band, own) in expected.iter().zip(zonal_bands(roughness)) {
                assert!((band - own).abs() < 1e-12, "roughness {roughness}: {own} instead of {band}");
            }
        }
        assert_eq!(zonal_bands(0.0), [1.0; BANDS]);
    }

    /// Bilinear interpolation of a wave, summed over phases, against the closed forms.
    #[test]
    fn interpolation_is_the_mean_over_phases() {
        let (edge, band) = (4.0, 5.0_f64);
        let step = FRAC_PI_2 / edge;
        let (mut mean, mut square) = (0.0, 0.0);
        let (directions, phases) = (8, 48);
        for k in 0..directions {
            let (sine, cosine) = ((f64::from(k) + 0.5) / f64::from(directions) * FRAC_PI_4).sin_cos();
            // Products of one-dimensional interpolations: the mean factor and the mean square of each.
            let along = |frequency: f64| {
                let (mut re, mut power) = (0.0, 0.0);
                for phase in 0..phases {
                    let t = (f64::from(phase) + 0.5) / f64::from(phases);
                    // The wave's value at t is 1; its neighbours are t and 1 - t texels away.
                    let (low, high) = (-t * step * frequency, (1.0 - t) * step * frequency);
                    let value =
                        [(1.0 - t) * low.cos() + t * high.cos(), (1.0 - t) * low.sin() + t * high.sin()];
                    re += value[0];
                    power += value[0] * value[0] + value[1] * value[1];
                }
                (re / f64::from(phases), power / f64::from(phases))
            };
            let (x, y) = (along(band * cosine), along(band * sine));
            mean += x.0 * y.0 / f64::from(directions);
            square += x.1 * y.1 / f64::from(directions);
        }
        let (own_mean, own_variance) = interpolation(band, edge);
        assert!((own_mean - mean).abs() < 1e-3, "{own_mean} instead of {mean}");
        assert!((own_variance - (square - mean * mean)).abs() < 1e-3, "{own_variance}");
    }

    /// The orders that delivered look-ups on panoramas have: docs/benchmarks.md.
    #[test]
    fn a_last_level_of_one_texel_costs_most() {
        let error = |ladder: Ladder, size, levels| ladder.look_up_error(Map::Cube, size, levels);
        let (seven, nine) = (error(Ladder::Linear, 256, 7), error(Ladder::Linear, 256, 9));
        assert!((0.04..0.09).contains(&seven), "{seven}");
        assert!((0.2..0.6).contains(&nine), "{nine}");
        let fine = error(Ladder::Linear, 640, 8);
        assert!(fine < 0.05, "{fine}");
        assert!(error(Ladder::Linear, 256, 1) > 1.0 && error(Ladder::Linear, 256, 2) > 0.5);
    }
}
