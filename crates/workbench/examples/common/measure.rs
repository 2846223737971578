//! What examples that measure share: random directions, errors, the sun.

use glam::DVec3;
use octagloss::{Environment, Layout};
use std::f64::consts::{PI, TAU};

/// Numbers in [0, 1): splitmix64.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Evenly over the cap of `angle` around `centre`.
    pub(crate) fn within(&mut self, centre: DVec3, angle: f64) -> DVec3 {
        let cosine = 1.0 - self.unit() * (1.0 - angle.cos());
        let (sine, turn) = ((1.0 - cosine * cosine).sqrt(), TAU * self.unit());
        let (s, t) = (centre.any_orthonormal_vector(), centre.cross(centre.any_orthonormal_vector()));
        (centre * cosine + (s * turn.cos() + t * turn.sin()) * sine).normalize()
    }

    /// Evenly over the sphere.
    pub(crate) fn direction(&mut self) -> DVec3 {
        self.within(DVec3::Y, PI)
    }
}

/// Direction of the brightest texel of a panorama.
pub(crate) fn brightest(environment: &Environment) -> DVec3 {
    let Layout::Panorama { width, .. } = environment.layout() else { panic!("a panorama") };
    let sum = |texel: &[f32; 3]| texel.iter().sum::<f32>();
    let texels = environment.texels();
    let brightest = (0..texels.len()).max_by(|a, b| sum(&texels[*a]).total_cmp(&sum(&texels[*b])));
    let k = brightest.expect("texels") as u32;
    environment.layout().direction_from_texel(0, k % width, k / width)
}

/// Worst channel's relRMSE, epsilon and greatest error over the peak.
pub(crate) fn measures(found: &[DVec3], truth: &[DVec3]) -> [f64; 3] {
    let count = truth.len() as f64;
    let mut worst = [0.0_f64; 3];
    for c in 0..3 {
        let (mut error, mut square, mut mean, mut most, mut peak) = (0.0, 0.0, 0.0, 0.0_f64, 0.0_f64);
        for (found, truth) in found.iter().zip(truth) {
            let off = found[c] - truth[c];
            error += off * off;
            square += truth[c] * truth[c];
            mean += truth[c];
            most = most.max(off.abs());
            peak = peak.max(truth[c]);
        }
        let own = [(error / count).sqrt() / (mean / count), (error / square).sqrt(), most / peak];
        worst.iter_mut().zip(own).for_each(|(worst, own)| *worst = worst.max(own));
    }
    worst
}

pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    f64::midpoint(values[(values.len() - 1) / 2], values[values.len() / 2])
}
