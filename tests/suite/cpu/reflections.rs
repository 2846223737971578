//! Reflections by adaptive quadrature against the oracle: no error exceeds its bound.

use crate::support::common::{Look, Random, environment, texels};
use octagloss::Layout;
use octagloss::internals::analysis::oracle::Oracle;
use octagloss::internals::analysis::oracle::reflection::reflection;
use octagloss::internals::cpu::reflection::ReflectedLight;
use octagloss::internals::filter::Answer;
use octagloss::internals::frame::Frame;

/// Frames of one environment.
const FRAMES: u64 = 10;

/// The oracle's own accuracy, and that of sums of many texels.
const ORACLE: f64 = 1e-5;

/// What random frames showed.
#[derive(Debug, Default)]
pub(crate) struct Reflections {
    pub(crate) violations: Vec<String>,
    /// Answers.
    pub(crate) compared: u64,
    /// Squared relative errors of those with a tolerance of .005, and their number.
    squares: f64,
    count: u64,
}

impl Reflections {
    pub(crate) fn join(mut self, other: Self) -> Self {
        self.violations.extend(other.violations);
        self.compared += other.compared;
        self.squares += other.squares;
        self.count += other.count;
        self
    }
}

/// The first channel of `answer` that is farther from `truth` than its bound.
fn beyond(answer: &Answer, truth: [f64; 3]) -> Option<usize> {
    let bound = answer.bound.expect("a bound").channels;
    (0..3).find(|c| {
        let off = (f64::from(answer.radiance[*c]) - truth[*c]).abs();
        off.is_nan() || off > f64::from(bound[*c]) + ORACLE * truth[*c]
    })
}

/// [`FRAMES`] random frames of the random environment `index`.
pub(crate) fn reflections(seed: u64, index: u64) -> Reflections {
    let mut random = Random::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ index);
    let layout = match random.below(3) {
        0 => Layout::Panorama { width: 48, height: 24 },
        1 => Layout::Cube { size: 12 },
        _ => Layout::Octahedral { size: 24 },
    };
    let looks = [Look::Noise, Look::Smooth, Look::Suns, Look::Lone, Look::Split];
    let look = looks[random.below(5) as usize];
    let light = texels(&mut random, look, layout);
    let environment = environment(layout, light).rotated_y(random.between(-180.0, 180.0)).expect("finite");
    let (adaptive, oracle) = (ReflectedLight::new(&environment), Oracle::new(&environment));
    let mut found = Reflections::default();
    for _ in 0..FRAMES {
        let normal = random.direction();
        let lean = random.between(0.0, 1.2);
        let view = random.direction() * lean + normal;
        let frame = Frame::new(normal, view, random.direction()).expect("a frame");
        let roughness = random.between(0.1, 1.0);
        let anisotropy = if random.below(2) == 0 { 0.0 } else { random.between(0.0, 0.95) };
        let f0 = [[1.0; 3], [0.04; 3], [0.5, 0.9, 0.02]][random.below(3) as usize];
        let error = [0.05, 0.005][random.below(2) as usize];
        let answer = adaptive.reflect(&frame, roughness, anisotropy, f0, error);
        let [all, grazing] = reflection(&oracle, &frame, roughness, anisotropy);
        let truth = [0, 1, 2].map(|c| f0[c] * all[c] + (1.0 - f0[c]) * grazing[c]);
        found.compared += 1;
        if let Some(c) = beyond(&answer, truth) {
            found.violations.push(format!(
                "seed {seed}, environment {index}: channel {c} of {truth:?} is {answer:?}: {layout:?}, \
                 {look:?}, {frame:?}, roughness {roughness}, anisotropy {anisotropy}, f0 {f0:?}, error {error}"
            ));
        }
        // Twice the bound away is seen.
        let bound = answer.bound.expect("a bound").channels[1];
        let mut wrong = answer;
        wrong.radiance[1] += 2.0 * bound + 3.0 * ORACLE as f32 * truth[1] as f32 + f32::MIN_POSITIVE;
        assert!(beyond(&wrong, truth).is_some(), "{wrong:?} passes for {truth:?}");
        let mean: f64 = truth.iter().sum::<f64>() / 3.0;
        if mean > 0.0 && error == 0.005 {
            let worst = (0..3).map(|c| (f64::from(answer.radiance[c]) - truth[c]).abs()).fold(0.0, f64::max);
            found.squares += (worst / mean).powi(2);
            found.count += 1;
        }
    }
    found
}

#[test]
fn no_reflection_is_off_by_more_than_its_bound() {
    use rayon::prelude::*;
    let all = (0..24)
        .into_par_iter()
        .map(|index| reflections(5, index))
        .reduce(Default::default, Reflections::join);
    assert!(all.violations.is_empty(), "{:#?}", all.violations);
    let off = (all.squares / all.count as f64).sqrt();
    // Relative to each answer, dark ones, too.
    assert!(all.count > 60 && off < 0.02, "{off} of {}", all.count);
}
