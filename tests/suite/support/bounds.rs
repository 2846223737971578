//! Checks certified bounds against exhaustive integration.

use super::common::{Random, landmarks};
use super::oem_oracle::OemOracle;
use glam::DVec3;
use octagloss::Environment;
use octagloss::internals::analysis::oracle::Oracle;
use octagloss::internals::cpu::leaves::LANES;
use octagloss::internals::environment::LUMINANCE;
use octagloss::internals::filter::Bound;
use octagloss::internals::lobe::Lobe;
use octagloss::internals::oem::bilinear_share;
use std::fmt::Display;

pub(crate) fn luminance(rgb: [f64; 3]) -> f64 {
    (0..3).map(|c| f64::from(LUMINANCE[c]) * rgb[c]).sum()
}

/// Relative error of exhaustive integration over an OEM.
pub(crate) const ORACLE: f64 = 1e-7;

/// Relative error of exhaustive integration over a source.
pub(crate) const SOURCE_ORACLE: f64 = 2e-5;

/// The same for cones, whose edge texels are halved, not cut.
pub(crate) const SOURCE_ORACLE_OF_CONES: f64 = 2e-3;

/// Exhaustive integration of what a reflector serves: over the source, and over the OEM to the bilinear
/// share.
pub(crate) struct ServedOracle<'a> {
    environment: &'a Environment,
    source: Oracle<'a>,
    pub(crate) oem: OemOracle,
    inner: u32,
}

impl<'a> ServedOracle<'a> {
    /// `oem` holds `inner` x `inner` texels made from `environment`.
    pub(crate) fn new(environment: &'a Environment, oem: OemOracle, inner: u32) -> Self {
        Self { environment, source: Oracle::new(environment), oem, inner }
    }

    /// The lobe's radiance around `direction` of the world.
    pub(crate) fn reflect(&self, lobe: Lobe, roughness: f64, direction: DVec3) -> [f64; 3] {
        let share = bilinear_share(lobe, roughness * roughness, self.inner);
        let over_oem = || {
            let direction = self.environment.source_from_world() * direction;
            self.oem.reflect_with_share(lobe, roughness, direction, 1.0)
        };
        self.mixed(lobe, roughness, direction, share, over_oem)
    }

    /// The same with the radiance `over_oem` of the bilinear share.
    pub(crate) fn mixed(
        &self,
        lobe: Lobe,
        roughness: f64,
        direction: DVec3,
        share: f64,
        over_oem: impl FnOnce() -> [f64; 3],
    ) -> [f64; 3] {
        let mut sum = [0.0; 3];
        if share > 0.0 {
            over_oem().iter().zip(&mut sum).for_each(|(value, sum)| *sum += share * value);
        }
        if share < 1.0 {
            let over_source = self.source.reflect(lobe, roughness, direction).expect("valid");
            over_source.iter().zip(&mut sum).for_each(|(value, sum)| *sum += (1.0 - share) * value);
        }
        sum
    }

    /// Relative error of the answers.
    pub(crate) fn accuracy(lobe: Lobe) -> f64 {
        if lobe == Lobe::Cone { SOURCE_ORACLE_OF_CONES } else { SOURCE_ORACLE }
    }
}

/// A query: directions, lobe, roughness and tolerance.
pub(crate) struct Question {
    pub(crate) directions: Vec<DVec3>,
    pub(crate) lane: usize,
    pub(crate) lobe: Lobe,
    pub(crate) roughness: f64,
    pub(crate) error: f64,
}

impl Question {
    /// A random query with a lobe that every engine supports, towards `brightest` or elsewhere.
    pub(crate) fn new(random: &mut Random, brightest: DVec3) -> Self {
        let lobe = match random.below(10) {
            0 => Lobe::Phong,
            1 => Lobe::Cosine,
            2 => Lobe::Cone,
            _ => Lobe::Ggx,
        };
        let roughness = if random.below(4) == 0 {
            10_f64.powf(random.between(-2.0, 0.0))
        } else {
            random.between(0.03, 1.0)
        };
        let axis = match random.below(4) {
            0 => landmarks()[random.below(26) as usize],
            1 => (brightest + random.direction() * 10_f64.powf(random.between(-3.0, 0.3))).normalize(),
            _ => random.direction(),
        };
        // A single direction, or a packet up to half a lobe wide.
        let count = if random.below(2) == 0 { 1 } else { 1 + random.below(LANES as u32) as usize };
        let spread = 0.5 * roughness * roughness * random.unit();
        let directions: Vec<DVec3> =
            (0..count)
                .map(|k| {
                    if count == 1 || k == 0 { axis } else { (axis + random.direction() * spread).normalize() }
                })
                .collect();
        Self {
            lane: random.below(count as u32) as usize,
            directions,
            lobe,
            roughness,
            error: 10_f64.powf(random.between(-3.5, -0.7)),
        }
    }
}

/// One comparison of an engine with the oracle, of the luminance and of every channel.
pub(crate) struct Outcome {
    /// Luminance, red, green and blue.
    compared: [Compared; 4],
    case: String,
}

/// One number compared.
#[derive(Clone, Copy)]
struct Compared {
    value: f64,
    truth: f64,
    bound: f64,
    /// Absolute error of the oracle.
    doubt: f64,
}

impl Compared {
    fn error(&self) -> f64 {
        (self.value - self.truth).abs()
    }

    /// The error over the allowed error.
    fn ratio(&self) -> f64 {
        if self.error() == 0.0 { 0.0 } else { self.error() / (self.bound + self.doubt) }
    }
}

/// Luminance, red, green and blue of `rgb`.
pub(crate) fn with_luminance(rgb: [f64; 3]) -> [f64; 4] {
    [luminance(rgb), rgb[0], rgb[1], rgb[2]]
}

impl Outcome {
    /// Compares an engine's radiance and bounds over `scene` with the `truth`.
    pub(crate) fn new(
        scene: &dyn Display,
        question: &Question,
        radiance: [f32; 3],
        bound: Bound,
        truth: [f64; 3],
    ) -> Self {
        let Question { directions, lane, lobe, roughness, error } = question;
        let (values, truths) = (with_luminance(radiance.map(f64::from)), with_luminance(truth));
        let bounds = bound.values().map(f64::from);
        let case = format!(
            "{scene} {lobe:?} roughness {roughness} E {error} {} lanes {}: {values:?} against {truths:?}, \
             bounds {bounds:?}",
            directions.len(),
            directions[*lane],
        );
        let compared = std::array::from_fn(|k| Compared {
            value: values[k],
            truth: truths[k],
            bound: bounds[k],
            doubt: ORACLE * truths[k],
        });
        Self { compared, case }
    }

    /// Adds `doubt` to the oracle's error of each channel.
    pub(crate) fn doubting(mut self, doubt: [f64; 3]) -> Self {
        self.compared.iter_mut().zip(with_luminance(doubt)).for_each(|(one, doubt)| one.doubt += doubt);
        self
    }

    pub(crate) fn holds(&self) -> bool {
        self.compared.iter().all(|one| one.error() <= one.bound + one.doubt)
    }

    /// The greatest error over the allowed one.
    pub(crate) fn ratio(&self) -> f64 {
        self.compared.iter().map(Compared::ratio).fold(0.0, f64::max)
    }

    /// The case, for messages.
    pub(crate) fn case(&self) -> &str {
        &self.case
    }
}

/// Fails with the worst violations; prints the tightness of the bounds.
pub(crate) fn judge(name: &str, outcomes: &[Outcome], expected: usize) {
    assert_eq!(outcomes.len(), expected, "questions were asked");
    let mut wrong: Vec<&Outcome> = outcomes.iter().filter(|outcome| !outcome.holds()).collect();
    wrong.sort_by(|a, b| b.ratio().total_cmp(&a.ratio()));
    // Of the luminance, and of the channels.
    for (what, range) in [("luminance", 0..1), ("channels", 1..4)] {
        let mut tightness: Vec<f64> = outcomes
            .iter()
            .flat_map(|outcome| &outcome.compared[range.clone()])
            .filter(|one| one.error() > ORACLE * one.truth)
            .map(|one| one.bound / one.error())
            .collect();
        tightness.sort_by(f64::total_cmp);
        let at = |share: f64| tightness[((tightness.len() - 1) as f64 * share) as usize];
        println!(
            "{name}, {what}: bound/error median {:.1}, 5 % {:.2}, 95 % {:.0}, least {:.3} ({} counted)",
            at(0.5),
            at(0.05),
            at(0.95),
            at(0.0),
            tightness.len()
        );
    }
    let case: Vec<&str> = wrong.iter().take(10).map(|outcome| outcome.case()).collect();
    assert!(wrong.is_empty(), "{} bounds do not hold, the worst:\n{}", wrong.len(), case.join("\n"));
}
