//! Light over the whole range of float32, mixed within one image: answers are finite and within their bounds.

use crate::support::bounds::{Outcome, Question, ServedOracle};
use crate::support::common::{Random, environment};
use crate::support::oem_oracle::OemOracle;
use glam::DVec3;
use octagloss::internals::filter::{Answer, Bound, Filter};
use octagloss::internals::lobe::{Lobe, kernel_integral};
use octagloss::internals::oem::{OemSize, bilinear_share};
use octagloss::internals::reflector::{Reflector, ReflectorSettings, Workspace};
use octagloss::internals::sphere::octahedral;
use octagloss::{Environment, Layout, Rgb};
use std::fmt::{Display, Formatter};

/// Lobes below this roughness may be served as mirrors, which have no bound.
const MIRROR: f64 = 8e-4;

/// Questions per group of environments.
const QUESTIONS: u64 = 4;

/// Draws an OEM's size, mostly tiny: the time of exhaustive integration grows with the texels.
fn any_size(random: &mut Random) -> u32 {
    match random.below(500) {
        0 => 9 + random.below(8),
        1..30 => 4 + random.below(5),
        _ => 1 + random.below(4),
    }
}

/// An environment with light anywhere in float32's range, and the size of its OEM.
pub(crate) struct Light {
    pub(crate) environment: Environment,
    pub(crate) inner: u32,
    name: String,
    brightest: DVec3,
}

impl Display for Light {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {:?} over {}^2", self.name, self.environment.layout(), self.inner)
    }
}

/// Draws log-uniformly from all positive float32, from 1e-45 to 3.4e38.
fn any_light(random: &mut Random) -> f32 {
    (2_f64.powf(random.between(-149.0, 128.0)) as f32).clamp(f32::from_bits(1), f32::MAX)
}

/// Returns texels of one of several looks, and the look's name.
fn radiance(random: &mut Random, count: usize) -> (&'static str, Vec<Rgb>) {
    let (one, other) = (any_light(random), any_light(random));
    let near = |random: &mut Random, value: f32| {
        (f64::from(value) * 10_f64.powf(random.between(-2.0, 2.0))).clamp(0.0, f64::from(f32::MAX)) as f32
    };
    let place = random.below(count as u32) as usize;
    let (name, mut texels): (_, Vec<Rgb>) = match random.below(10) {
        0 => ("anything", (0..count).map(|_| [0; 3].map(|_| any_light(random))).collect()),
        1 => ("anything grey", (0..count).map(|_| [any_light(random); 3]).collect()),
        2 => ("one magnitude", (0..count).map(|_| [0; 3].map(|_| near(random, one))).collect()),
        3 => ("one lit texel", {
            let mut texels = vec![[0.0; 3]; count];
            texels[place] = [one; 3];
            texels
        }),
        4 => ("a sun", {
            let mut texels: Vec<Rgb> = (0..count).map(|_| [near(random, one); 3]).collect();
            texels[place] = [other; 3];
            texels
        }),
        5 => ("halves", (0..count).map(|k| [if k < count / 2 { one } else { other }; 3]).collect()),
        6 => ("constant", vec![[one, other, one]; count]),
        8 => ("saturated", {
            let texel = |random: &mut Random| {
                let mut texel = [0.0; 3];
                texel[random.below(3) as usize] = near(random, one);
                texel
            };
            (0..count).map(|_| texel(random)).collect()
        }),
        7 => ("ends", {
            let ends = [0.0, f32::from_bits(1), f32::MIN_POSITIVE, 1.0, f32::MAX, 3e38];
            (0..count).map(|_| [ends[random.below(6) as usize]; 3]).collect()
        }),
        _ => ("black and bright rows", {
            (0..count).map(|k| [if k / 3 % 2 == 0 { 0.0 } else { f32::MAX }; 3]).collect()
        }),
    };
    if random.below(4) == 0 {
        for _ in 0..count / 3 {
            texels[random.below(count as u32) as usize] = [0.0; 3];
        }
    }
    if random.below(4) == 0 {
        let only = random.below(3) as usize;
        texels
            .iter_mut()
            .for_each(|texel| *texel = std::array::from_fn(|c| if c == only { texel[c] } else { 0.0 }));
    }
    (name, texels)
}

impl Light {
    /// Draws any light in any layout, for any size of OEM.
    pub(crate) fn new(random: &mut Random) -> Self {
        let inner = any_size(random);
        Self::over(random, inner)
    }

    /// Draws the same for an OEM of `inner` texels.
    fn over(random: &mut Random, inner: u32) -> Self {
        let layout = match random.below(5) {
            0 => Layout::Panorama { width: 2 + random.below(15), height: 1 + random.below(8) },
            1 => Layout::Cube { size: 1 + random.below(4) },
            _ => Layout::Octahedral { size: inner },
        };
        let (name, texels) = radiance(random, layout.texel_count());
        let mut brightest = (DVec3::Y, 0.0);
        let source = environment(layout, texels);
        source.for_each_texel(|direction, _, texel| {
            let value = texel.into_iter().fold(0.0, f32::max);
            if value > brightest.1 {
                brightest = (direction, value);
            }
        });
        Self { environment: source, inner, name: name.to_owned(), brightest: brightest.0 }
    }

    pub(crate) fn settings(&self) -> ReflectorSettings {
        ReflectorSettings { oem_size: Some(self.inner), ..ReflectorSettings::default() }
    }

    /// Returns the greatest radiance of any channel.
    pub(crate) fn greatest(&self) -> f32 {
        self.environment.texels().as_flattened().iter().copied().fold(0.0, f32::max)
    }

    /// Exhaustive integration over the OEM in the source's units: from the source's texels if the OEM has the
    /// same, else from the reflector's OEM, whose scale is undone in double precision.
    fn oracle(&self, reflector: &Reflector<'_>) -> (OemOracle, [f64; 3]) {
        let n = self.inner;
        let exact = self.environment.layout() == (Layout::Octahedral { size: n });
        let per_unit = f64::from(-reflector.light_exponent()).exp2();
        assert_eq!(reflector.oem().size(), OemSize { inner: n, border: 0 });
        let texel = |x: u32, y: u32| {
            if exact {
                let w = f64::from(octahedral::texel_solid_angle(n, x, y) as f32);
                let [r, g, b] = self.environment.texels()[(y * n + x) as usize].map(f64::from);
                [r * w, g * w, b * w, w]
            } else {
                let [r, g, b, w] = reflector.oem().texel(x, y).map(f64::from);
                [r * per_unit, g * per_unit, b * per_unit, w]
            }
        };
        let mut energy = [0.0; 3];
        for (x, y) in (0..n).flat_map(|y| (0..n).map(move |x| (x, y))) {
            let own = texel(x, y);
            (0..3).for_each(|c| energy[c] += own[c]);
        }
        (OemOracle::of_texels(n, texel), energy)
    }
}

/// Counts of the outcomes of questions.
#[derive(Default)]
pub(crate) struct Tally {
    /// Answers compared with exhaustive integration.
    pub(crate) compared: u64,
    /// Answers without a bound: mirrors and the other filters.
    pub(crate) unbounded: u64,
    /// Answers with a radiance or bound that is not finite or is negative.
    pub(crate) not_finite: Vec<String>,
    /// Bounds that do not hold, and filters that exceed the source's range.
    pub(crate) violations: Vec<String>,
    /// The greatest ratio of error to bound.
    pub(crate) worst: f64,
    /// The sum of those ratios.
    pub(crate) ratios: f64,
}

impl Tally {
    pub(crate) fn join(mut self, other: Self) -> Self {
        self.compared += other.compared;
        self.unbounded += other.unbounded;
        self.not_finite.extend(other.not_finite);
        self.violations.extend(other.violations);
        self.worst = self.worst.max(other.worst);
        self.ratios += other.ratios;
        self
    }

    pub(crate) fn is_sound(&self) -> bool {
        self.not_finite.is_empty() && self.violations.is_empty()
    }

    /// Compares `answer` to `question` with the `truth`.
    fn compare(
        &mut self,
        (seed, group): (u64, u64),
        asked: &Asked<'_>,
        question: &Question,
        answer: Answer,
        truth: [f64; 3],
    ) {
        let Question { lobe, roughness, error, .. } = *question;
        let light = asked.light;
        let case = || format!("seed {seed} group {group} {light} {lobe:?} roughness {roughness} E {error}");
        if !self.is_finite(&answer, &case) {
            return;
        }
        let Some(bound) = answer.bound.filter(|_| roughness > MIRROR || !lobe.has_mirror()) else {
            self.unbounded += 1;
            return;
        };
        // Inside a coarse texel of constant energy, radiance is up to 5.2 times its mean and may overflow
        // float32, whereas answers are limited to f32::MAX.
        let truth = truth.map(|truth| truth.min(f64::from(f32::MAX)));
        let doubt = std::array::from_fn(|c| doubt(lobe, roughness, truth[c], asked.energy[c]));
        let outcome = Outcome::new(light, question, answer.radiance, bound, truth).doubting(doubt);
        self.compared += 1;
        self.ratios += outcome.ratio();
        if !outcome.holds() {
            self.violations.push(format!("seed {seed} group {group}: {}", outcome.case()));
        }
        self.worst = self.worst.max(outcome.ratio());
    }

    /// Returns whether an answer is finite, and records it if not.
    fn is_finite(&mut self, answer: &Answer, case: &dyn Fn() -> String) -> bool {
        let mut values = answer.radiance.into_iter().chain(answer.bound.into_iter().flat_map(Bound::values));
        let finite = values.all(|value| value.is_finite() && value >= 0.0);
        if !finite {
            self.not_finite.push(format!("{answer:?}: {}", case()));
        }
        finite
    }
}

/// Draws any lobe, including those that the GPU lacks.
fn question(random: &mut Random, light: &Light) -> Question {
    let mut question = Question::new(random, light.brightest);
    // Exhaustive integration is slowest for cones and Charlie lobes.
    question.lobe = match random.below(16) {
        0..7 => Lobe::Ggx,
        7..11 => Lobe::Phong,
        11..14 => Lobe::Cosine,
        14 => Lobe::Cone,
        _ => Lobe::Charlie,
    };
    match random.below(16) {
        0 => question.roughness = 0.0,
        1 => question.roughness = 1.0,
        2 => question.roughness = 10_f64.powf(random.between(-4.0, -1.0)),
        _ => {}
    }
    question
}

/// An environment prepared for questions.
struct Asked<'a> {
    light: &'a Light,
    reflector: Reflector<'a>,
    oracle: ServedOracle<'a>,
    /// Luminance of the whole sphere's energy.
    energy: [f64; 3],
}

/// Asks the adaptive filter [`QUESTIONS`] questions over each of `count` environments, the `group`th of
/// `seed`. They share the OEM's size and the questions, so that one exhaustive integration over OEMs serves
/// them all.
/// Applies `alter` to the answers before comparing every direction.
pub(crate) fn examine(seed: u64, group: u64, count: u32, alter: &dyn Fn(Answer) -> Answer) -> Tally {
    let mut random = Random::new(seed.wrapping_add(group.wrapping_mul(0x9e37_79b9)));
    let inner = any_size(&mut random);
    let lights: Vec<Light> = (0..count)
        .map(|_| {
            let mut light = Light::over(&mut random, inner);
            if random.below(2) == 0 {
                light.environment =
                    light.environment.rotated_y(random.between(-180.0, 180.0)).expect("an angle");
            }
            light
        })
        .collect();
    let asked: Vec<Asked<'_>> = lights
        .iter()
        .map(|light| {
            let reflector = Reflector::new(&light.environment, &light.settings()).expect("a small OEM");
            let (oracle, energy) = light.oracle(&reflector);
            let oracle = ServedOracle::new(&light.environment, oracle, inner);
            Asked { light, reflector, oracle, energy }
        })
        .collect();
    let oracles: Vec<&OemOracle> = asked.iter().map(|asked| &asked.oracle.oem).collect();
    let mut tally = Tally::default();
    for number in 0..QUESTIONS {
        let first = &lights[(number % u64::from(count)) as usize];
        // Directions in the source's space.
        let mut question = question(&mut random, first);
        let Question { lobe, roughness, error, .. } = question;
        let share = bilinear_share(lobe, roughness * roughness, inner);
        let over_oems: Vec<Vec<[f64; 3]>> = if share > 0.0 {
            let each = |d: &DVec3| OemOracle::reflect_each(&oracles, lobe, roughness, *d, 1.0);
            question.directions.iter().map(each).collect()
        } else {
            Vec::new()
        };
        for (k, asked) in asked.iter().enumerate() {
            let world_from_source = asked.light.environment.source_from_world().transpose();
            let directions: Vec<DVec3> = question.directions.iter().map(|d| world_from_source * *d).collect();
            let lobes = asked
                .reflector
                .lobes(lobe, roughness, Filter::Adaptive(error))
                .expect("a roughness and an error");
            let mut answers = Vec::new();
            lobes.evaluate(&directions, &mut Workspace::default(), &mut answers).expect("unit vectors");
            for (lane, answer) in answers.into_iter().enumerate() {
                question.lane = lane;
                let over_oem = || over_oems[lane][k];
                let truth = asked.oracle.mixed(lobe, roughness, directions[lane], share, over_oem);
                tally.compare((seed, group), asked, &question, alter(answer), truth);
            }
        }
    }
    tally
}

/// Error of exhaustive integration besides a relative 1e-7, for light with more decades than its accuracy is
/// stated for; `energy` is the whole sphere's.
fn doubt(lobe: Lobe, roughness: f64, truth: f64, energy: f64) -> f64 {
    let alpha = roughness * roughness;
    let source = ServedOracle::accuracy(lobe) * truth;
    match lobe {
        // Phong lobes omit values below 1e-30 of the peak, and faint values are less exact.
        Lobe::Phong => source + 1e-6 * truth + 1.1e-30 * energy / kernel_integral(lobe, alpha),
        _ => source,
    }
}

/// Asks the filters without a bound: where they promise it, answers must stay within the source's range.
pub(crate) fn examine_unbounded(seed: u64, index: u64) -> Tally {
    let mut random = Random::new(seed.wrapping_add(index.wrapping_mul(0x9e37_79b9)));
    let mut light = Light::new(&mut random);
    light.inner = 32;
    let reflector = Reflector::new(&light.environment, &light.settings()).expect("a small OEM");
    let greatest = f64::from(light.greatest());
    let mut tally = Tally::default();
    for filter in [Filter::Box, Filter::Pyramid, Filter::Reference, Filter::Adaptive(0.01)] {
        let question = question(&mut random, &light);
        let lobe = if filter.check(question.lobe, Some(32)).is_ok() { question.lobe } else { Lobe::Ggx };
        let (direction, roughness) = (question.directions[0], question.roughness);
        let lobes = reflector.lobes(lobe, roughness, filter).expect("served");
        let mut answers = Vec::new();
        lobes.evaluate(&[direction], &mut Workspace::default(), &mut answers).expect("unit vectors");
        let case = || format!("seed {seed} index {index} {light} {filter:?} {lobe:?} roughness {roughness}");
        if !tally.is_finite(&answers[0], &case) {
            continue;
        }
        tally.unbounded += 1;
        let most = answers[0].radiance.into_iter().fold(0.0, f32::max);
        // Means do; levels that weigh less than 0 and the uneven texels of an OEM may overshoot slightly.
        let allowed = if matches!(filter, Filter::Box | Filter::Reference) { 1.0 + 1e-6 } else { 1.5 };
        if f64::from(most) > allowed * greatest {
            tally.violations.push(format!("{most} is above {greatest}: {}", case()));
        }
    }
    tally
}
