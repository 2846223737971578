//! Statistics of an environment.

use crate::analysis::sun::Sun;
use crate::light::environment::{Environment, Rgb, exact_luminance};
use half::f16;
use serde::Serialize;
use std::f64::consts::PI;

/// Statistics of an environment.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistics {
    /// Least value of each channel.
    pub min: Rgb,
    /// Greatest value of each channel.
    pub max: Rgb,
    /// Mean radiance over the sphere, weighted by solid angle.
    pub mean: [f64; 3],
    /// The brightest region, if one stands out.
    pub sun: Option<Sun>,
    /// Loss in half floats.
    pub half: HalfLoss,
}

/// Loss from clamping to the maximum half float, 65504.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct HalfLoss {
    /// Texels with a channel above it.
    #[serde(rename = "clipped_texels")]
    pub texels: u64,
    /// Share of the luminance energy above it.
    #[serde(rename = "lost_energy_share")]
    pub energy_share: f64,
}

impl Statistics {
    /// Computes the statistics of `environment`.
    #[must_use]
    pub fn new(environment: &Environment) -> Self {
        let limit = f16::MAX.to_f32();
        let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        let (mut energy, mut lost, mut texels) = ([0.0; 3], [0.0; 3], 0);
        environment.for_each_texel(|_, solid_angle, texel| {
            let mut above = false;
            for c in 0..3 {
                min[c] = min[c].min(texel[c]);
                max[c] = max[c].max(texel[c]);
                energy[c] += f64::from(texel[c]) * solid_angle;
                if texel[c] > limit {
                    lost[c] += f64::from(texel[c] - limit) * solid_angle;
                    above = true;
                }
            }
            texels += u64::from(above);
        });
        let share = |part: [f64; 3]| match exact_luminance(energy) {
            0.0 => 0.0,
            whole => exact_luminance(part) / whole,
        };
        Self {
            min,
            max,
            mean: energy.map(|e| e / (4.0 * PI)),
            sun: Sun::find(environment),
            half: HalfLoss { texels, energy_share: share(lost) },
        }
    }

    /// The sun's share of the luminance energy; 0 without a sun.
    #[must_use]
    pub fn sun_share(&self) -> f64 {
        self.sun
            .as_ref()
            .map_or(0.0, |sun| exact_luminance(sun.irradiance) / (exact_luminance(self.mean) * 4.0 * PI))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::environment::Layout;

    #[test]
    fn figures_of_a_sky_with_one_hot_texel() {
        let layout = Layout::Cube { size: 16 };
        let mut texels = vec![[0.5, 1.0, 2.0]; layout.texel_count()];
        texels[100] = [1e6, 1e6, 0.0];
        let statistics = Statistics::new(&Environment::new(layout, texels).expect("valid"));
        assert_eq!(statistics.min, [0.5, 1.0, 0.0]);
        assert_eq!(statistics.max, [1e6, 1e6, 2.0]);
        assert_eq!(statistics.half.texels, 1);
        assert!((0.93..0.94).contains(&statistics.half.energy_share), "{statistics:?}");
        assert!(statistics.sun_share() > 0.99, "{statistics:?}");
        assert_eq!(statistics.sun.map(|sun| sun.texels), Some(1));
    }
}
