//! Compares emitters and the residual map on the GPU with the CPU's, within derived bounds.

use super::transfer::{Upload as _, read_emitters};
use super::{UNIT, exceeds, in_full, wait};
use crate::support::common::{Look, Random, oem, texels};
use glam::DVec3;
use octagloss::Layout;
use octagloss::internals::gpu::emitters as of_oem;
use octagloss::internals::gpu::fitted::FittedTables;
use octagloss::internals::gpu::{Context, OemPlanes};
use octagloss::internals::lobe::{Lobe, kernel_integral};
use octagloss::internals::oem::{Oem, OemSize};
use octagloss::internals::realtime::emitters::{Emitter, GRID, extracted};
use octagloss::internals::sphere::octahedral::oct_from_direction;

/// Error bounds of float32 for the emitters of one OEM.
///
/// Both sides add the same terms in the same order. A quotient is off by 5 units of 2^-24 on the GPU and by 1
/// on the CPU. Brightness and the brightest remaining cell are quotients, and their quotient is one more.
/// What a cell keeps has a relative error of 18 units, and so, with a product, have the residual texels. The
/// extracted energy is off by 19 units of the cell's total.
pub(super) struct Open {
    block: u32,
    /// Directions: 8 units of a component of each texel's direction, 8 of its share, sums of `block`^2 of
    /// them, and a quotient.
    direction: f64,
    /// Mean squared distance: twice the cell's reach times the error of directions, twice.
    spread: f64,
}

/// Relative error of what a cell keeps, and of the residual map.
const KEPT: f64 = 20.0 * UNIT;

impl Open {
    pub(super) fn new(inner: u32) -> Self {
        let block = (inner / GRID).max(1);
        let sums = f64::from(block * block);
        let direction = (28.0 + sums) * UNIT;
        // A texel reaches at most 4.25/inner from its centre on the sphere, as derived for the lamp in src.
        let reach = 4.25 * f64::from(block) / f64::from(inner);
        Self { block, direction, spread: 4.0 * reach * direction + (16.0 + sums) * UNIT * reach * reach }
    }

    /// Returns column and row of the cell of `oem` that `emitter` comes from.
    fn cell(&self, oem: &Oem, emitter: &Emitter) -> [u32; 2] {
        let place = (oct_from_direction(emitter.direction) + 1.0) * f64::from(oem.size().inner) / 2.0;
        [place.x, place.y].map(|place| place as u32 / self.block)
    }

    /// Returns the energy of that cell, including what it keeps.
    fn energy(&self, oem: &Oem, emitter: &Emitter) -> [f64; 3] {
        let corner = self.cell(oem, emitter).map(|cell| cell * self.block);
        let mut sum = [0.0; 3];
        for (i, j) in (0..self.block).flat_map(|j| (0..self.block).map(move |i| (i, j))) {
            let texel = oem.texel(corner[0] + i, corner[1] + j);
            sum = std::array::from_fn(|c| sum[c] + f64::from(texel[c]));
        }
        sum
    }

    /// Bounds the difference of `emitter`'s contribution to a lobe of `alpha` around `direction` from the
    /// CPU's.
    ///
    /// s is off by d/2 times the error of directions: relative to s + alpha^2, at most that error over
    /// 2 alpha, counted twice. alpha^2 is off by half of the spread's error, counted three times. At the
    /// horizon, where the lobe ends, the error is the tail of its peak.
    pub(super) fn of_radiance(&self, oem: &Oem, emitter: &Emitter, alpha: f64, direction: DVec3) -> [f64; 3] {
        let sums = f64::from(self.block * self.block);
        let off = self.direction + 4.0 * UNIT;
        let relative = off / alpha + 1.5 * self.spread / (alpha * alpha) + (30.0 + sums) * UNIT;
        let integral = kernel_integral(Lobe::Ggx, alpha);
        let value = emitter.radiance(alpha, integral, direction);
        let whole = Emitter { energy: self.energy(oem, emitter), ..*emitter };
        let wholes = whole.radiance(alpha, integral, direction);
        let horizon = 8.0 * alpha * alpha * off;
        std::array::from_fn(|c| relative * value[c] + KEPT * wholes[c] + horizon * emitter.energy[c])
    }
}

/// Extracts emitters of `oem` on the GPU; returns them with the residual map.
fn taken_out_by_gpu(context: &Context, oem: &Oem) -> (Vec<Emitter>, Oem) {
    let planes = OemPlanes::upload(context, oem).expect("small planes");
    let tables = FittedTables::new(context, oem.size().inner, 1).expect("small tables");
    let rest = planes.of_the_same_solid_angles(context);
    let stage = of_oem::stage(context, &planes, &rest, &tables);
    context.submit(|encoder| stage.record(encoder));
    (wait(context, read_emitters(context, &tables)), wait(context, rest.read(context)))
}

/// Returns the first difference of `found` from the CPU's emitters and residual map of `oem`.
fn difference(oem: &Oem, (emitters, rest): &(Vec<Emitter>, Oem)) -> Option<String> {
    let (expected, expected_rest) = extracted(oem);
    let open = Open::new(oem.size().inner);
    for ((found, expected), before) in rest.texels().iter().zip(expected_rest.texels()).zip(oem.texels()) {
        let off = |c: usize| f64::from((found[c] - expected[c]).abs());
        if (0..3).any(|c| exceeds(off(c), KEPT * f64::from(expected[c]))) || found[3] != before[3] {
            return Some(format!("a texel of {before:?} is {found:?}, not {expected:?}"));
        }
    }
    let mut left: Vec<&Emitter> = expected.iter().collect();
    for emitter in emitters {
        let energy = open.energy(oem, emitter);
        let place = left.iter().position(|other| open.cell(oem, other) == open.cell(oem, emitter));
        let Some(other) = place.map(|place| left.remove(place)) else {
            // A cell as bright as the brightest remaining one may or may not be an emitter.
            if (0..3).any(|c| exceeds(emitter.energy[c], KEPT * energy[c])) {
                return Some(format!("{emitter:?} of {energy:?} is none of the CPU's"));
            }
            continue;
        };
        let sums = f64::from(open.block * open.block);
        let far = (0..3).any(|c| {
            let allowed = KEPT * energy[c] + (2.0 + sums) * UNIT * other.energy[c];
            exceeds((emitter.energy[c] - other.energy[c]).abs(), allowed)
        });
        if far
            || exceeds(emitter.direction.distance(other.direction), open.direction)
            || exceeds((emitter.spread - other.spread).abs(), open.spread)
        {
            return Some(format!("{emitter:?}, not {other:?}"));
        }
    }
    left.into_iter()
        .find(|other| (0..3).any(|c| exceeds(other.energy[c], KEPT * open.energy(oem, other)[c])))
        .map(|other| format!("{other:?} is missing"))
}

/// Radiances at which sums of three overflow float32, and energies barely above its subnormals.
#[test]
fn extreme_light_makes_emitters_too() {
    in_full("extreme emitters", |context| {
        for power in [3e38_f32, 2e-33] {
            let mut radiance = vec![[0.0; 3]; 64 * 64];
            radiance[20 * 64 + 9] = [power; 3];
            let oem = oem(OemSize { inner: 64, border: 0 }, &radiance);
            let (found, rest) = taken_out_by_gpu(context, &oem);
            let (expected, _) = extracted(&oem);
            let name = format!("{power:e} on {}", context.describe());
            assert!(
                rest.totals()[..3].iter().all(|total| *total == 0.0),
                "the residual map of {name} must be black"
            );
            assert_eq!((found.len(), expected.len()), (1, 1), "{name}");
            let apart = found[0].direction.distance(expected[0].direction);
            assert!(!exceeds(apart, Open::new(64).direction), "{name}: directions differ by {apart:e}");
            let ratio = found[0].energy[1] / expected[0].energy[1];
            assert!(!exceeds((ratio - 1.0).abs(), KEPT), "{name}: {ratio} times the energy");
        }
    });
}

/// Compares emitters and residual maps of random squares (inner texels, border, look) with the CPU's.
pub(super) fn emitters(context: &Context, cases: &[(u32, u32, Look)]) {
    let mut random = Random::new(133);
    for &(inner, border, look) in cases {
        let size = OemSize { inner, border };
        let oem = oem(size, &texels(&mut random, look, Layout::Octahedral { size: inner }));
        let found = taken_out_by_gpu(context, &oem);
        let name = format!("{look:?} {inner} + {border} on {}", context.describe());
        assert_eq!(difference(&oem, &found), None, "{name}");
        let seen = |fault: &dyn Fn(&mut Emitter)| {
            let mut wrong = found.clone();
            fault(&mut wrong.0[0]);
            difference(&oem, &wrong).is_some()
        };
        let whole = Open::new(inner).energy(&oem, &found.0[0]);
        assert!(seen(&|emitter| emitter.energy[2] += 1e-5 * whole[2]), "slightly more energy, {name}");
        let side = found.0[0].direction.any_orthonormal_vector();
        assert!(seen(&|emitter| emitter.direction += 1e-4 * side), "slightly displaced, {name}");
        assert!(seen(&|emitter| emitter.spread *= 1.3), "30 % wider, {name}");
        let missing = (found.0[1..].to_vec(), found.1.clone());
        assert!(difference(&oem, &missing).is_some(), "one missing, {name}");
        let mut texels = found.1.texels().to_vec();
        texels[5][0] = texels[5][0] * 1.00001 + if look == Look::Lone { 1e-5 } else { 0.0 };
        let brighter = (found.0.clone(), Oem::from_bordered(size, texels));
        assert!(difference(&oem, &brighter).is_some(), "a texel slightly brighter, {name}");
    }
}

#[test]
fn emitters_and_the_residual_match_the_cpu() {
    let cases = [
        (16, 0, Look::Noise),
        (64, 7, Look::Suns),
        (128, 0, Look::Smooth),
        (512, 3, Look::Noise),
        (1024, 0, Look::Suns),
        (256, 0, Look::Lone),
    ];
    in_full("emitters", |context| emitters(context, &cases));
}
