//! The filters against exhaustive integration over OEM and source: certified bounds, furnace, continuity.

use crate::support::bounds::ServedOracle;
pub(crate) use crate::support::bounds::{Outcome, Question, judge, luminance};
use crate::support::common::{Look, Random, environment, landmarks, oem, sweep, texels};
use glam::DVec3;
use octagloss::internals::analysis::oracle::{OemOracle, Oracle};
use octagloss::internals::bake::{BakeSettings, bake};
use octagloss::internals::cpu::adaptive::Adaptive;
use octagloss::internals::cpu::cells::Cells;
use octagloss::internals::cpu::leaves::{Packet, Scratch};
use octagloss::internals::filter::Filter;
use octagloss::internals::geometry::tent::Reconstruction;
use octagloss::internals::lobe::kernel::Kernel;
use octagloss::internals::lobe::{LOBES, Lobe};
use octagloss::internals::oem::{Oem, OemSize};
use octagloss::internals::reflector::{Reflector, ReflectorSettings, Workspace};
use octagloss::internals::sphere::{cube, octahedral};
use octagloss::{Environment, Layout};
use rayon::prelude::*;

/// An OEM of some look, and its brightest place.
pub(crate) struct Scene {
    pub(crate) oem: Oem,
    pub(crate) look: Look,
    brightest: DVec3,
}

impl std::fmt::Display for Scene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?} {}^2", self.look, self.oem.size().inner)
    }
}

impl Scene {
    pub(crate) fn new(random: &mut Random, inner: u32) -> Self {
        let look = Look::ALL[random.below(5) as usize];
        let radiance = texels(random, look, Layout::Octahedral { size: inner });
        let place = (0..radiance.len()).max_by(|a, b| radiance[*a][1].total_cmp(&radiance[*b][1]));
        let place = place.expect("texels") as u32;
        let brightest =
            octahedral::direction_from_oct(octahedral::texel_centre(inner, place % inner, place / inner));
        Self { oem: oem(OemSize { inner, border: 0 }, &radiance), look, brightest }
    }
}

/// The reconstructions of cells, each with the share of a texel's box that the oracle adds for it.
pub(crate) const SPREADS: [(Reconstruction, f64); 2] =
    [(Reconstruction::Bilinear, 1.0), (Reconstruction::Constant, 0.0)];

/// Answers `question` by exhaustive integration.
pub(crate) fn truth(oracle: &OemOracle, question: &Question, share: f64) -> f64 {
    let direction = question.directions[question.lane];
    luminance(oracle.reflect_with_share(question.lobe, question.roughness, direction, share))
}

/// Compares the CPU's answer to `question` with the `truth`.
fn outcome(scene: &Scene, cells: &Cells, question: &Question, truth: f64) -> Outcome {
    let alpha = question.roughness * question.roughness;
    let adaptive = Adaptive::new(cells, Kernel::new(question.lobe, alpha), question.error);
    let shares = adaptive.evaluate(&Packet::new(&question.directions), &mut Scratch::default());
    Outcome::new(scene, question, shares.radiance[question.lane], shares.bound[question.lane], truth)
}

/// Asks `questions`, of `lobe` or of any lobe, of each of `scenes` OEMs of sizes drawn by `size`.
fn outcomes(
    lobe: Option<Lobe>,
    seed: u64,
    scenes: u64,
    questions: usize,
    size: impl Fn(&mut Random) -> u32 + Sync,
) -> Vec<Outcome> {
    (0..scenes)
        .into_par_iter()
        .flat_map_iter(|scene| {
            let Examination { scene, spread, questions } =
                Examination::new(lobe, seed, scene, questions, &size);
            let cells = Cells::new(&scene.oem, 1, spread);
            questions
                .into_iter()
                .map(|(question, truth)| outcome(&scene, &cells, &question, truth))
                .collect::<Vec<_>>()
        })
        .collect()
}

/// A scene with questions and their answers by exhaustive integration.
pub(crate) struct Examination {
    pub(crate) scene: Scene,
    pub(crate) spread: Reconstruction,
    pub(crate) questions: Vec<(Question, f64)>,
}

impl Examination {
    /// Draws the `index`th examination of `seed`, with `lobe` or any lobe.
    pub(crate) fn new(
        lobe: Option<Lobe>,
        seed: u64,
        index: u64,
        questions: usize,
        size: impl Fn(&mut Random) -> u32,
    ) -> Self {
        let mut random = Random::new(seed + index);
        let inner = size(&mut random);
        let (spread, share) = SPREADS[index as usize % 2];
        let scene = Scene::new(&mut random, inner);
        let oracle = OemOracle::new(&scene.oem);
        let questions = (0..questions)
            .map(|_| {
                let question = Question::new(&mut random, scene.brightest);
                let question = Question { lobe: lobe.unwrap_or(question.lobe), ..question };
                let truth = truth(&oracle, &question, share);
                (question, truth)
            })
            .collect();
        Self { scene, spread, questions }
    }

    /// Returns questions about one texel, and an OEM to serve in which it is brighter by ten times the mean.
    pub(crate) fn with_wrong_texel(random: &mut Random) -> (Self, Oem) {
        let scene = Scene::new(random, 32);
        let mut square = scene.oem.texels().to_vec();
        let k = random.below(32 * 32);
        let [r, g, b, w] = square[k as usize];
        let more = w * (10.0 * scene.oem.totals()[1] / (4.0 * std::f64::consts::PI)) as f32;
        square[k as usize] = [r + more, g + more, b + more, w];
        let wrong = Oem::from_square(scene.oem.size(), square);
        let direction = octahedral::direction_from_oct(octahedral::texel_centre(32, k % 32, k / 32));
        let oracle = OemOracle::new(&scene.oem);
        let questions = [0.1, 0.3].map(|roughness| {
            let question =
                Question { directions: vec![direction], lane: 0, lobe: Lobe::Ggx, roughness, error: 0.001 };
            let truth = truth(&oracle, &question, 1.0);
            (question, truth)
        });
        (Self { scene, spread: Reconstruction::Bilinear, questions: questions.into() }, wrong)
    }
}

/// Four questions about each of 250 scenes, or of the first 100 of them: all sizes, looks and reconstructions
/// occur.
#[test]
fn certified_bounds_hold() {
    let sizes = |random: &mut Random| 32 + random.below(97);
    let scenes = sweep(100, 250);
    judge("32^2 to 128^2", &outcomes(None, 1000, scenes, 4, sizes), 4 * scenes as usize);
}

#[test]
fn certified_bounds_hold_at_512() {
    let scenes = sweep(5, 10);
    judge("512^2", &outcomes(None, 2000, scenes, 2, |_| 512), 2 * scenes as usize);
}

#[test]
fn certified_bounds_hold_for_tiny_oems() {
    let sizes = |random: &mut Random| 1 + random.below(9);
    let scenes = sweep(50, 200);
    judge("1^2 to 9^2", &outcomes(None, 3000, scenes, 5, sizes), 5 * scenes as usize);
}

#[test]
fn certified_bounds_of_sheen_hold() {
    let sizes = |random: &mut Random| 16 + random.below(33);
    judge("Charlie, 16^2 to 48^2", &outcomes(Some(Lobe::Charlie), 5000, 25, 4, sizes), 100);
}

#[test]
fn certified_bounds_of_sheen_hold_for_tiny_oems() {
    let sizes = |random: &mut Random| 1 + random.below(9);
    let scenes = sweep(20, 50);
    judge("Charlie, 1^2 to 9^2", &outcomes(Some(Lobe::Charlie), 4000, scenes, 6, sizes), 6 * scenes as usize);
}

/// A sun of four source texels over a sky: its highlight is exact for any size of the OEM, as far as lobes
/// are wider than four of its texels.
#[test]
fn a_sun_of_a_few_texels_is_sharp_at_any_map_size() {
    let mut random = Random::new(39);
    let layout = Layout::Panorama { width: 512, height: 256 };
    let mut sky = texels(&mut random, Look::Noise, layout);
    for (x, y) in [(100, 60), (101, 60), (100, 61), (101, 61)] {
        sky[y * 512 + x] = [3e4, 2.5e4, 2e4];
    }
    let environment = environment(layout, sky);
    let mean = {
        let (mut sum, mut total) = (0.0, 0.0);
        environment.for_each_texel(|_, solid_angle, rgb| {
            sum += solid_angle * luminance(rgb.map(f64::from));
            total += solid_angle;
        });
        sum / total
    };
    let sun = layout.direction_from_texel(0, 100, 60);
    let directions: Vec<DVec3> =
        (0..60).map(|_| (sun + random.direction() * 0.06 * random.unit()).normalize()).collect();
    let roughness = 0.2;
    let truths: Vec<f64> = {
        let oracle = Oracle::new(&environment);
        directions.par_iter().map(|d| luminance(oracle.reflect(Lobe::Ggx, roughness, *d))).collect()
    };
    for inner in [200, 256, 512] {
        let reflector = reflector(&environment, inner);
        let answers = ask(&reflector, Lobe::Ggx, roughness, Filter::Adaptive(0.001), &directions);
        for (answer, truth) in answers.iter().zip(&truths) {
            let off = (luminance(*answer) - truth).abs();
            assert!(off < 0.02 * mean + 0.002 * truth, "{inner}^2: {off} of {truth} off, mean {mean}");
        }
    }
    // The map's own texels spread the sun.
    let cells = Cells::new(reflector(&environment, 256).oem(), 1, Reconstruction::Constant);
    let alpha = roughness * roughness;
    let adaptive = Adaptive::new(&cells, Kernel::new(Lobe::Ggx, alpha), 0.001);
    let worst = directions.iter().zip(&truths).map(|(direction, truth)| {
        let shares = adaptive.evaluate(&Packet::new(&[*direction]), &mut Scratch::default());
        (luminance(shares.radiance[0].map(f64::from)) - truth).abs() / (0.02 * mean + 0.002 * truth)
    });
    let worst = worst.fold(0.0, f64::max);
    assert!(worst > 5.0, "a spread sun is not detected: {worst} of the allowed error");
}

/// Environments of every layout and shape, among them coarse ones, against exhaustive integration over their
/// texels.
#[test]
fn certified_bounds_hold_against_the_source() {
    let layouts = |random: &mut Random| match random.below(3) {
        0 => Layout::Panorama { width: 2 + random.below(90), height: 1 + random.below(60) },
        1 => Layout::Cube { size: 1 + random.below(30) },
        _ => Layout::Octahedral { size: 1 + random.below(60) },
    };
    let scenes = sweep(50_u64, 120);
    let outcomes: Vec<Outcome> = (0..scenes)
        .into_par_iter()
        .flat_map_iter(|seed| {
            let mut random = Random::new(6000 + seed);
            let layout = layouts(&mut random);
            let look = Look::ALL[seed as usize % 5];
            let environment = environment(layout, texels(&mut random, look, layout));
            let inner = 32 + random.below(225);
            let reflector = reflector(&environment, inner);
            let oracle = served(&environment, &reflector);
            (0..5)
                .map(|_| {
                    let brightest = random.direction();
                    let question = Question::new(&mut random, brightest);
                    let Question { lobe, roughness, error, .. } = question;
                    let lobes = reflector.lobes(lobe, roughness, Filter::Adaptive(error)).expect("served");
                    let (mut workspace, mut answers) = (Workspace::default(), Vec::new());
                    lobes.evaluate(&question.directions, &mut workspace, &mut answers);
                    let answer = answers[question.lane];
                    let direction = question.directions[question.lane];
                    let truth = luminance(oracle.reflect(lobe, roughness, direction));
                    let scene = format!("{look:?} {layout:?} over {inner}^2");
                    let bound = answer.bound.expect("a certified bound");
                    Outcome::new(&scene, &question, answer.radiance, bound, truth)
                        .doubting(ServedOracle::accuracy(lobe) * truth)
                })
                .collect::<Vec<_>>()
        })
        .collect();
    judge("against the source", &outcomes, 5 * scenes as usize);
}

#[test]
fn one_wrong_texel_breaks_a_bound() {
    let mut random = Random::new(31);
    let (mut broken, mut compared) = (0, 0);
    for _ in 0..20 {
        let (examination, wrong) = Examination::with_wrong_texel(&mut random);
        let cells = Cells::new(&wrong, 1, examination.spread);
        for (question, truth) in &examination.questions {
            broken += usize::from(!outcome(&examination.scene, &cells, question, *truth).holds());
            compared += 1;
        }
    }
    assert!(compared == 40 && broken >= 36, "only {broken} of {compared} comparisons failed");
}

/// Returns a reflector of `environment` with an OEM of `inner` texels.
pub(crate) fn reflector(environment: &Environment, inner: u32) -> Reflector<'_> {
    let settings = ReflectorSettings { oem_size: Some(inner), ..ReflectorSettings::default() };
    Reflector::new(environment, &settings).expect("a small OEM")
}

/// Exhaustive integration of what `reflector` serves.
fn served<'a>(environment: &'a Environment, reflector: &Reflector<'_>) -> ServedOracle<'a> {
    ServedOracle::new(environment, OemOracle::new(reflector.oem()), reflector.oem().size().inner)
}

/// Returns one filter's answers, direction by direction.
pub(crate) fn ask(
    reflector: &Reflector<'_>,
    lobe: Lobe,
    roughness: f64,
    filter: Filter,
    directions: &[DVec3],
) -> Vec<[f64; 3]> {
    let lobes = reflector.lobes(lobe, roughness, filter).expect("roughness in [0, 1]");
    let (mut workspace, mut answers) = (Workspace::default(), Vec::new());
    for direction in directions {
        lobes.evaluate(&[*direction], &mut workspace, &mut answers);
    }
    answers.into_iter().map(|answer| answer.radiance.map(f64::from)).collect()
}

#[test]
fn answers_of_a_reflector_lie_within_their_bounds() {
    let mut random = Random::new(32);
    let mut compared = 0;
    for look in Look::ALL {
        let layout = Layout::Panorama { width: 48, height: 24 };
        let environment = environment(layout, texels(&mut random, look, layout)).rotated_y(20.0);
        let reflector = reflector(&environment, 48);
        let oracle = served(&environment, &reflector);
        for _ in 0..60 {
            let (direction, roughness) = (random.direction(), random.between(0.02, 1.0));
            let filter = Filter::Adaptive(10_f64.powf(random.between(-3.0, -1.5)));
            let answer =
                reflector.query(direction, roughness, Lobe::Ggx, filter).expect("roughness in [0, 1]");
            let value = luminance(answer.radiance.map(f64::from));
            let truth = luminance(oracle.reflect(Lobe::Ggx, roughness, direction));
            let bound = f64::from(answer.bound.expect("a certified bound"));
            assert!(
                (value - truth).abs() <= bound + ServedOracle::accuracy(Lobe::Ggx) * truth,
                "{look:?} {roughness} {direction}: {value} against {truth}, bound {bound}"
            );
            compared += 1;
        }
    }
    assert_eq!(compared, 300);
}

/// Greatest relative error allowed in a constant environment.
pub(crate) const FURNACE: f64 = 1e-6;

pub(crate) fn furnace_error(
    environment: &Environment,
    inner: u32,
    lobe: Lobe,
    filter: Filter,
    directions: &[DVec3],
) -> f64 {
    let reflector = reflector(environment, inner);
    let mut worst: f64 = 0.0;
    for roughness in [0.0, 1e-4, 1e-3, 0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.75, 0.9, 0.999, 1.0] {
        let answers = ask(&reflector, lobe, roughness, filter, directions);
        assert_eq!(answers.len(), directions.len());
        for answer in answers {
            for (value, constant) in answer.into_iter().zip([0.25, 1.0, 3e4]) {
                worst = worst.max((value / constant - 1.0).abs());
            }
        }
    }
    worst
}

#[test]
fn a_furnace_is_white() {
    let layouts = [
        Layout::Panorama { width: 64, height: 32 },
        Layout::Cube { size: 16 },
        Layout::Octahedral { size: 9 },
    ];
    let mut random = Random::new(33);
    let directions: Vec<DVec3> = landmarks().into_iter().chain((0..20).map(|_| random.direction())).collect();
    for layout in layouts {
        let furnace = environment(layout, vec![[0.25, 1.0, 3e4]; layout.texel_count()]);
        for inner in [1, 3, 17, 64, 256] {
            for lobe in LOBES {
                let filters = [Filter::Adaptive(0.005), Filter::Adaptive(0.1), Filter::Box];
                for filter in filters.into_iter().filter(|filter| filter.check(lobe, None).is_ok()) {
                    let error = furnace_error(&furnace, inner, lobe, filter, &directions);
                    assert!(error <= FURNACE, "{layout:?} {inner} {lobe:?} {filter:?}: off by {error:e}");
                }
            }
        }
        let mut spotted = furnace.texels().to_vec();
        spotted[0][1] = 1.01;
        let spotted = environment(layout, spotted);
        for filter in [Filter::Adaptive(0.005), Filter::Box] {
            let error = furnace_error(&spotted, 64, Lobe::Ggx, filter, &directions);
            assert!(
                error > FURNACE,
                "{layout:?} {filter:?}: one texel 1 % brighter is not detected: {error:e}"
            );
        }
    }
}

/// Returns directions on every crease of the map, each with a way across: the three coordinate planes, which
/// contain the fold, the axes and the square's edges, and the vertices.
fn creases(random: &mut Random) -> Vec<(DVec3, DVec3)> {
    let mut all = Vec::new();
    for (normal, along) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::Z), (DVec3::Z, DVec3::X)] {
        let other = normal.cross(along);
        for k in 0..64 {
            // On the vertices, near them, and anywhere.
            let angle = match k % 4 {
                0 => f64::from(k) / 32.0 * std::f64::consts::PI,
                1 => f64::from(k / 16) * std::f64::consts::FRAC_PI_2 + 1e-9 * random.between(-1.0, 1.0),
                _ => random.between(0.0, std::f64::consts::TAU),
            };
            all.push((along * angle.cos() + other * angle.sin(), normal));
        }
    }
    all
}

#[test]
fn boxes_are_continuous_across_every_fold() {
    let mut random = Random::new(34);
    let mut compared = 0;
    for n in [8, 17, 32] {
        let layout = Layout::Octahedral { size: n };
        let environment = environment(layout, texels(&mut random, Look::Noise, layout));
        let reflector = reflector(&environment, n);
        let brightest = environment.texels().iter().flatten().copied().fold(0.0, f32::max);
        for lobe in [Lobe::Ggx, Lobe::Cone] {
            for roughness in [0.0, 0.05, 0.2, 0.4, 0.7, 1.0] {
                for (at, across) in creases(&mut random) {
                    let step = 1e-7;
                    let pair = [(at - across * step).normalize(), (at + across * step).normalize()];
                    let answers = ask(&reflector, lobe, roughness, Filter::Box, &pair);
                    for c in 0..3 {
                        // The box has at least one texel's weight. A direction's step moves it by 3 sqrt(3)
                        // times as much in (u, v) and the density resizes it by as much again. It exchanges
                        // at most 4 sides' worth of texels that are up to 5.2 times heavier.
                        let allowed =
                            f64::from(brightest) * 2.0 * step * 5.2 * f64::from(n) / 2.0 * 8.0 * 5.2;
                        let change = (answers[0][c] - answers[1][c]).abs();
                        assert!(
                            change <= allowed + 2e-7 * answers[0][c],
                            "{n} {lobe:?} {roughness} {at}: a step of {change:e}, {allowed:e} allowed"
                        );
                        compared += 1;
                    }
                }
            }
        }
    }
    assert_eq!(compared, 3 * 2 * 6 * 192 * 3);
}

#[test]
fn boxes_are_continuous_in_roughness_down_to_the_mirror() {
    let mut random = Random::new(35);
    let n = 32;
    let layout = Layout::Octahedral { size: n };
    let environment = environment(layout, texels(&mut random, Look::Noise, layout));
    let reflector = reflector(&environment, n);
    let brightest = environment.texels().iter().flatten().copied().fold(0.0, f32::max);
    let directions: Vec<DVec3> = landmarks().into_iter().chain((0..30).map(|_| random.direction())).collect();
    let step = 1e-6;
    let mut compared = 0;
    for lobe in [Lobe::Ggx, Lobe::Phong, Lobe::Cone] {
        let starts = [0.0, 1e-5, 1e-4, 1e-3, 0.01, 0.05, 0.2].into_iter();
        for roughness in starts.chain((0..20).map(|k| f64::from(k) / 20.0)) {
            let before = ask(&reflector, lobe, roughness, Filter::Box, &directions);
            let after = ask(&reflector, lobe, roughness + step, Filter::Box, &directions);
            for (before, after) in before.iter().zip(&after) {
                for c in 0..3 {
                    // A side grows by at most 2 n per unit of roughness; the rim has 4 sides, of texels up to
                    // 5.2 times heavier, over a box of at least one texel.
                    let allowed = f64::from(brightest) * 4.0 * 2.0 * f64::from(n) * 5.2 * step;
                    let change = (before[c] - after[c]).abs();
                    assert!(
                        change <= allowed + 2e-7 * before[c],
                        "{lobe:?} {roughness}: a step of {change:e}"
                    );
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, 3 * 27 * 56 * 3);
}

#[test]
fn adaptive_is_continuous_in_roughness_down_to_the_mirror() {
    let mut random = Random::new(36);
    let n = 64;
    let layout = Layout::Octahedral { size: n };
    let directions: Vec<DVec3> = landmarks().into_iter().chain((0..20).map(|_| random.direction())).collect();
    let mut compared = 0;
    for look in [Look::Noise, Look::Smooth, Look::Suns] {
        let environment = environment(layout, texels(&mut random, look, layout));
        let reflector = reflector(&environment, n);
        let totals = reflector.oem().totals();
        let mean = luminance([totals[0], totals[1], totals[2]]) / (4.0 * std::f64::consts::PI);
        let error = 0.001;
        let filter = Filter::Adaptive(error);
        let mirror = ask(&reflector, Lobe::Ggx, 0.0, filter, &directions);
        for roughness in [1e-5, 2e-4, 3e-4, 1e-3] {
            let sharp = ask(&reflector, Lobe::Ggx, roughness, filter, &directions);
            for ((mirror, sharp), direction) in mirror.iter().zip(&sharp).zip(&directions) {
                // A lobe of alpha up to 1e-6 is a mirror except for the interpolation's slope over a few
                // alpha. The difference is the adaptive filter's error, a few E of the mean for lobes this
                // sharp. Without interpolation it would be up to a texel's contrast.
                let (mirror, sharp) = (luminance(*mirror), luminance(*sharp));
                let allowed = 20.0 * error * mean + 1e-4 * mirror;
                assert!(
                    (mirror - sharp).abs() <= allowed,
                    "{look:?} roughness {roughness} {direction}: {mirror} against {sharp}"
                );
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 3 * 4 * 46);
}

#[test]
fn the_mirror_matches_the_oracle() {
    let mut random = Random::new(37);
    let (mut compared, mut seen) = (0, 0);
    // The least radiance and the answer are float32, 2^-24 each. The first counts 1 - w/(texel's solid angle
    // here) times, at most pi - 1.
    let tolerance = std::f64::consts::PI / f64::from(1_u32 << 24);
    for n in [1, 2, 5, 32, 63] {
        for look in [Look::Noise, Look::Smooth, Look::Suns] {
            let layout = Layout::Octahedral { size: n };
            let environment = environment(layout, texels(&mut random, look, layout));
            let reflector = reflector(&environment, n);
            let oracle = OemOracle::new(reflector.oem());
            let mut square = reflector.oem().texels().to_vec();
            for texel in square.iter_mut().step_by(3) {
                texel[1] *= 1.001;
            }
            let wrong = OemOracle::new(&Oem::from_square(reflector.oem().size(), square));
            let directions: Vec<DVec3> =
                landmarks().into_iter().chain((0..30).map(|_| random.direction())).collect();
            let answers = ask(&reflector, Lobe::Ggx, 0.0, Filter::Adaptive(0.005), &directions);
            for (answer, direction) in answers.iter().zip(&directions) {
                let expected = oracle.reflect(Lobe::Ggx, 0.0, *direction);
                for c in 0..3 {
                    let off = (answer[c] / expected[c] - 1.0).abs();
                    assert!(off <= tolerance, "{look:?} {n} {direction}: {answer:?} against {expected:?}");
                    compared += 1;
                }
                let other = wrong.reflect(Lobe::Ggx, 0.0, *direction);
                seen += usize::from((answer[1] / other[1] - 1.0).abs() > tolerance);
            }
        }
    }
    assert_eq!(compared, 5 * 3 * 56 * 3);
    assert!(seen > 400, "texels 0.1 % brighter were detected in {seen} directions of 840");
}

/// Returns root mean squares of the steps of `values` between neighbours: inside packets, between packets,
/// across the map's creases, and across the edges of faces.
fn steps(size: u32, values: &[f64]) -> [f64; 4] {
    let n = size as usize;
    let mut sums = [(0.0, 0.0); 4];
    for (k, value) in values.iter().enumerate() {
        let (face, i, j) = (cube::Face::ALL[k / (n * n)], k as u32 % size, k as u32 / size % size);
        let at = |i: i64, j: i64| {
            let place = |k: i64| (k as f64 + 0.5) / f64::from(size) * 2.0 - 1.0;
            cube::cube_point(face, place(i), place(j))
        };
        let here = at(i64::from(i), i64::from(j));
        for (di, dj) in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
            let there = at(i64::from(i) + di, i64::from(j) + dj);
            let (other_face, s, t) = cube::cube_from_direction(there);
            let place = |t: f64| (((t + 1.0) / 2.0 * f64::from(size)) as usize).min(n - 1);
            let other = (other_face.index() * n + place(t)) * n + place(s);
            let crossed = (0..3).any(|axis| here[axis] * there[axis] < 0.0);
            let side =
                |k: u32, d: i64| (k / PACKET) as i64 != (i64::from(k) + d).div_euclid(i64::from(PACKET));
            let kind = if other_face != face {
                3
            } else if crossed {
                2
            } else {
                usize::from(side(i, di) || side(j, dj))
            };
            sums[kind].0 += (value - values[other]).powi(2);
            sums[kind].1 += 1.0;
        }
    }
    assert!(sums.iter().all(|(_, count)| *count > 100.0), "steps of every kind: {sums:?}");
    sums.map(|(sum, count): (f64, f64)| (sum / count).sqrt())
}

/// Texels along an edge of a bake's packets.
const PACKET: u32 = 4;

#[test]
fn steps_of_a_bake_are_no_larger_at_edges_than_inside() {
    let mut random = Random::new(38);
    let layout = Layout::Panorama { width: 64, height: 32 };
    let environment = environment(layout, texels(&mut random, Look::Smooth, layout));
    let settings = BakeSettings {
        size: 64,
        levels: Some(3),
        filter: Filter::Adaptive(0.005),
        oem_size: Some(64),
        ..BakeSettings::default()
    };
    let bake = bake(&environment, &settings).expect("a small bake");
    let oracle = served(&environment, &reflector(&environment, 64));
    let level = &bake.chain.levels[1];
    let size = level.size();
    assert_eq!((size, level.roughness), (32, 0.5));
    let baked: Vec<f64> = level.texels.iter().map(|rgb| luminance(rgb.map(f64::from))).collect();
    let truth: Vec<f64> = (0..6 * size * size)
        .into_par_iter()
        .map(|k| {
            let face = cube::Face::ALL[(k / (size * size)) as usize];
            let direction = cube::direction_from_texel(face, size, k % size, k / size % size);
            luminance(oracle.reflect(Lobe::Ggx, 0.5, direction))
        })
        .collect();
    let (served_steps, true_steps) = (steps(size, &baked), steps(size, &truth));
    let ratios: [f64; 4] = std::array::from_fn(|kind| served_steps[kind] / true_steps[kind]);
    println!("steps over the oracle's: inside, packets, creases, faces {ratios:.4?}");
    for (ratio, kind) in ratios[1..].iter().zip(["packets", "creases", "faces"]) {
        assert!(*ratio <= 1.05 * ratios[0], "{kind}: {ratio} of the oracle's steps, {} inside", ratios[0]);
    }
    // Steps of E of the mean between packets must be detected.
    let mean = truth.iter().sum::<f64>() / truth.len() as f64;
    let n = size as usize;
    let mut torn = baked.clone();
    for (k, value) in torn.iter_mut().enumerate() {
        let (i, j) = (k % n / PACKET as usize, k / n / PACKET as usize);
        *value += if (i + j) % 2 == 0 { 0.01 * mean } else { 0.0 };
    }
    let torn = steps(size, &torn);
    assert!(
        torn[1] / true_steps[1] > 1.05 * torn[0] / true_steps[0],
        "torn packets are not detected: {torn:?}"
    );
}

#[test]
fn adaptive_steps_little_beyond_the_oracle_s_own_step() {
    let scenes = sweep(30_u64, 60);
    let outcome: Vec<(f64, String)> = (0..scenes)
        .into_par_iter()
        .flat_map_iter(|seed| {
            let mut random = Random::new(4000 + seed);
            let look = Look::ALL[seed as usize % 5];
            let n = 24 + random.below(20);
            let layout = Layout::Octahedral { size: n };
            let environment = environment(layout, texels(&mut random, look, layout));
            let reflector = reflector(&environment, n);
            let oracle = served(&environment, &reflector);
            let totals = reflector.oem().totals();
            let mean = luminance([totals[0], totals[1], totals[2]]) / (4.0 * std::f64::consts::PI);
            let creases = creases(&mut random);
            (0..40)
                .map(|k| {
                    let (at, across) = if k % 2 == 0 {
                        creases[random.below(creases.len() as u32) as usize]
                    } else {
                        (random.direction(), random.direction())
                    };
                    let step = 10_f64.powf(random.between(-6.0, -1.5));
                    let pair = [(at - across * step).normalize(), (at + across * step).normalize()];
                    let roughness = random.between(0.1, 1.0);
                    let error = 10_f64.powf(random.between(-3.0, -1.5));
                    let answers = ask(&reflector, Lobe::Ggx, roughness, Filter::Adaptive(error), &pair);
                    let step_served = luminance(answers[1]) - luminance(answers[0]);
                    let truth = pair.map(|d| luminance(oracle.reflect(Lobe::Ggx, roughness, d)));
                    let doubt = ServedOracle::accuracy(Lobe::Ggx) * (truth[0] + truth[1]);
                    let excess = (step_served - (truth[1] - truth[0])).abs() - doubt;
                    (
                        excess / (error * mean),
                        format!("{look:?} {n}^2 roughness {roughness} E {error} {pair:?}"),
                    )
                })
                .collect::<Vec<_>>()
        })
        .collect();
    assert_eq!(outcome.len() as u64, 40 * scenes, "steps were compared");
    let mut sorted: Vec<f64> = outcome.iter().map(|(excess, _)| *excess).collect();
    sorted.sort_by(f64::total_cmp);
    println!(
        "excess step over E of the mean: median {:.4}, 99 % {:.3}, greatest {:.3}",
        sorted[sorted.len() / 2],
        sorted[sorted.len() * 99 / 100],
        sorted[sorted.len() - 1]
    );
    let (excess, case) = outcome.iter().max_by(|a, b| a.0.total_cmp(&b.0)).expect("steps");
    assert!(*excess <= 1.0, "a step of {excess} times E of the mean beyond the oracle's: {case}");
}

/// Discontinuous and steep lobes, for the directions of one tile together and one by one: the edge of every
/// direction is resolved, whichever direction is nearest to a cell.
#[test]
fn edges_are_resolved_for_every_direction_of_a_packet() {
    let layout = Layout::Panorama { width: 64, height: 32 };
    let mut texels = vec![[0.0; 3]; layout.texel_count()];
    for (x, y) in (20..26).flat_map(|x| (8..12).map(move |y| (x, y))) {
        texels[y * 64 + x] = [50.0; 3];
    }
    let environment = environment(layout, texels);
    let reflector = reflector(&environment, 64);
    let oracle = served(&environment, &reflector);
    let mean = luminance([0, 1, 2].map(|c| reflector.oem().totals()[c])) / (4.0 * std::f64::consts::PI);
    let mut compared = 0;
    for (lobe, roughness) in
        [(Lobe::Cone, 0.2), (Lobe::Cone, 0.45), (Lobe::Cone, 1.0), (Lobe::Phong, 1.0), (Lobe::Phong, 0.93)]
    {
        let lobes = reflector.lobes(lobe, roughness, Filter::Adaptive(0.005)).expect("served");
        for face in cube::Face::ALL.into_iter().step_by(sweep(3, 1)) {
            let directions: Vec<DVec3> =
                (0..16).map(|k| cube::direction_from_texel(face, 4, k % 4, k / 4)).collect();
            let (mut workspace, mut answers) = (Workspace::default(), Vec::new());
            lobes.evaluate(&directions, &mut workspace, &mut answers);
            for (direction, answer) in directions.iter().zip(&answers) {
                let truth = luminance(oracle.reflect(lobe, roughness, *direction));
                let off = (luminance(answer.radiance.map(f64::from)) - truth).abs();
                assert!(off < 0.03 * (mean + truth), "{lobe:?} {roughness} {direction}: {off} off {truth}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 5 * sweep(32, 96));
}
