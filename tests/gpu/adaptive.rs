//! The adaptive filter: certified bounds against exhaustive integration, replays of the CPU's cuts, and the
//! GPU's own cuts.

use crate::transfer::{Upload as _, tree_of_cells, tree_of_leaves};
use glam::DVec3;
use octagloss_core::cpu::adaptive::Adaptive;
use octagloss_core::cpu::cells::Cells;
use octagloss_core::cpu::leaves::{LANES, Packet as CpuPacket, Scratch};
use octagloss_core::cpu::reflector::{Reflector, ReflectorSettings};
use octagloss_core::cpu::reparameterise::oem_from_environment;
use octagloss_core::geometry::tent::Reconstruction;
use octagloss_core::light::environment::Layout;
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::light::synth::synth;
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::Filter;
use octagloss_core::lobe::kernel::{Kernel, leaf_share};
use octagloss_core::sphere::cube::{Face, direction_from_texel};
use octagloss_fixtures::adapters::{UNIT, exceeds, in_full, wait, with_passes};
use octagloss_fixtures::bounds::{Outcome, Question, judge, luminance};
use octagloss_fixtures::common::{Random, environment, landmarks, oem, sweep};
use octagloss_fixtures::scenes::octahedral::{FURNACE, TestScene};
use octagloss_gpu::engine::GpuReflector;
use octagloss_gpu::stages::adaptive::{self, Answers, LobePart, Packet};
use octagloss_gpu::stages::cells::{self, CellTree};
use octagloss_gpu::{Context, OemPlanes};
use rayon::prelude::*;

/// Builds the cell tree of `oem` on the GPU.
fn tree(context: &Context, oem: &Oem, block: u32, spread: Reconstruction) -> CellTree {
    let planes = OemPlanes::upload(context, oem).expect("small planes");
    let (stage, tree) = cells::stage(context, &planes, block, spread).expect("a small tree");
    context.submit(|encoder| stage.record(encoder));
    tree
}

fn evaluate(context: &Context, cells: &CellTree, kernel: Kernel, error: f64, packets: &[Packet]) -> Answers {
    let parts = [LobePart { cells, kernel, error, share: 1.0 }];
    wait(context, adaptive::evaluate(context, &parts, packets))
}

/// Draws the test scenes of `seed`, with `lobe` or any lobe.
fn test_scenes(
    lobe: Option<Lobe>,
    seed: u64,
    scenes: u64,
    questions: usize,
    size: fn(&mut Random) -> u32,
) -> Vec<TestScene> {
    (0..scenes).into_par_iter().map(|index| TestScene::new(lobe, seed, index, questions, size)).collect()
}

/// Runs the questions of `test_scene` on the GPU, over the OEM `served`.
fn outcomes(context: &Context, test_scene: &TestScene, served: &Oem) -> Vec<Outcome> {
    let TestScene { scene, spread, questions } = test_scene;
    let cells = tree(context, served, 1, *spread);
    let outcome = |(question, truth): &(Question, [f64; 3])| {
        let Question { directions, lane, lobe, roughness, error } = question;
        let kernel = Kernel::new(*lobe, roughness * roughness);
        let answers = evaluate(context, &cells, kernel, *error, &[Packet::new(directions)]);
        let answer = answers.lanes[*lane];
        Outcome::new(scene, question, answer.radiance, answer.bound.expect("a certified bound"), *truth)
    };
    questions.iter().map(outcome).collect()
}

fn judge_bounds(name: &str, test_scenes: &[TestScene]) {
    in_full(name, |context| {
        let of = |test_scene: &TestScene| outcomes(context, test_scene, &test_scene.scene.oem);
        let outcomes: Vec<Outcome> = test_scenes.iter().flat_map(of).collect();
        let asked = test_scenes.iter().map(|test_scene| test_scene.questions.len()).sum();
        judge(&format!("{name}, {}", context.describe()), &outcomes, asked);
    });
}

#[test]
fn certified_bounds_hold() {
    judge_bounds("bounds", &test_scenes(None, 1000, sweep(6, 40), 20, |random| 32 + random.below(65)));
}

#[test]
fn certified_bounds_hold_for_tiny_oems() {
    judge_bounds(
        "bounds of tiny OEMs",
        &test_scenes(None, 3000, sweep(10, 40), 8, |random| 1 + random.below(9)),
    );
}

#[test]
fn certified_bounds_of_sheen_hold() {
    let scenes = sweep(5, 60);
    let sizes = |random: &mut Random| 16 + random.below(33);
    judge_bounds("bounds of sheen", &test_scenes(Some(Lobe::Charlie), 5000, scenes, 6, sizes));
}

#[test]
fn certified_bounds_of_sheen_hold_for_tiny_oems() {
    let scenes = sweep(10, 60);
    let sizes = |random: &mut Random| 1 + random.below(9);
    judge_bounds("bounds of sheen, tiny OEMs", &test_scenes(Some(Lobe::Charlie), 4000, scenes, 6, sizes));
}

#[test]
fn one_wrong_texel_breaks_a_bound() {
    let mut random = Random::new(71);
    // Charlie's band takes many more leaves, and their bounds add.
    for (lobe, times) in [(Lobe::Ggx, 10.0), (Lobe::Charlie, 300.0)] {
        let cases: Vec<_> = (0..10).map(|_| TestScene::with_wrong_texel(&mut random, lobe, times)).collect();
        in_full("one wrong texel", |context| {
            let outcomes = cases.iter().flat_map(|(case, wrong)| outcomes(context, case, wrong));
            let broken = outcomes.filter(|outcome| !outcome.holds()).count();
            assert!(broken >= 18, "{lobe:?}: only {broken} of 20 comparisons failed");
        });
    }
}

/// Largest difference between the engines' sums over the same `leaves`, relative to the sum: the rounding
/// that each certifies (see `Kernel::rounding` and `LobePart::uniform`). `width` is the distance over which
/// the kernel changes.
fn rounding(width: f64, leaves: usize) -> f64 {
    (10.0 / width + 160.0 + 2.0 * leaves as f64) * UNIT
}

/// The width of a lobe for [`rounding`]; Charlie's is 1/12 of the reciprocal of its power 1/(2 alpha).
fn width(lobe: Lobe, roughness: f64) -> f64 {
    match lobe {
        Lobe::Cosine => 1.0,
        Lobe::Charlie => roughness * roughness / 6.0,
        _ => roughness * roughness,
    }
}

/// Returns the texel directions of one cube level in tiles of sixteen.
fn tiles(size: u32) -> Vec<Vec<DVec3>> {
    let mut tiles = Vec::new();
    for face in Face::ALL {
        for (left, top) in (0..size / 4).flat_map(|top| (0..size / 4).map(move |left| (4 * left, 4 * top))) {
            let texel = |k: u32| direction_from_texel(face, size, left + k % 4, top + k / 4);
            tiles.push((0..16).map(texel).collect());
        }
    }
    tiles
}

/// Returns the OEMs of the synthetic environments.
fn synthetic(inner: u32) -> Vec<(&'static str, Oem)> {
    ["sky", "studio", "labelled", "furnace"]
        .map(|name| {
            let environment = synth(name).expect("a recipe");
            let size = OemSize { inner, border: 0 };
            (name, oem_from_environment(&environment, size).expect("a small matrix"))
        })
        .into()
}

/// The lobes of a bake, and sharper and other ones. Discontinuous lobes (cones, the widest Phong lobes) are
/// left to the certified bounds: they may differ by a whole leaf where a step lies within rounding of its
/// centroid.
const LOBES: [(Lobe, f64); 11] = [
    (Lobe::Ggx, 0.1),
    (Lobe::Ggx, 0.25),
    (Lobe::Ggx, 0.5),
    (Lobe::Ggx, 0.75),
    (Lobe::Ggx, 1.0),
    (Lobe::Phong, 0.4),
    (Lobe::Phong, 0.8),
    (Lobe::Cosine, 1.0),
    (Lobe::Charlie, 0.3),
    (Lobe::Charlie, 0.5),
    (Lobe::Charlie, 1.0),
];

/// One packet's cut and radiance on the CPU.
struct Cut {
    radiance: [[f32; 3]; LANES],
    leaves: usize,
    fields: Vec<[f32; 34]>,
}

fn cut(cells: &Cells, kernel: Kernel, error: f64, directions: &[DVec3]) -> Cut {
    let packet = CpuPacket::new(directions);
    let mut scratch = Scratch::default();
    let shares = Adaptive::new(cells, kernel, error).evaluate(&packet, &mut scratch);
    let fields = scratch.leaf_fields(cells, &packet);
    assert_eq!(fields.len(), shares.leaves);
    Cut { radiance: shares.radiance, leaves: shares.leaves, fields }
}

/// Returns the first lane where `found` differs from `expected` by more than `relative` of it plus
/// `absolute`.
fn beyond(expected: &[[f32; 3]], found: &Answers, relative: f64, absolute: [f64; 3]) -> Option<String> {
    assert_eq!(expected.len(), found.lanes.len(), "lanes");
    expected.iter().zip(&found.lanes).enumerate().find_map(|(lane, (expected, found))| {
        let far = (0..3).any(|c| {
            let (e, f) = (f64::from(expected[c]), f64::from(found.radiance[c]));
            exceeds((e - f).abs(), relative * e + absolute[c])
        });
        far.then(|| format!("lane {lane} is {:?}, not {expected:?} within {relative:e}", found.radiance))
    })
}

#[test]
fn cuts_of_the_cpu_replayed_agree() {
    let oems = synthetic(64);
    let tiles = tiles(8);
    in_full("replayed cuts", |context| {
        // Of Charlie and of other lobes.
        let (mut replayed, mut seen) = (0, [0; 2]);
        for (name, oem) in &oems {
            let cells = Cells::new(oem, 1, Reconstruction::Constant);
            for (k, (lobe, roughness)) in LOBES.into_iter().enumerate() {
                let kernel = Kernel::new(lobe, roughness * roughness);
                for directions in tiles.iter().skip(k % 3).step_by(3) {
                    let cut = cut(&cells, kernel, 0.005, directions);
                    let packets = [Packet::new(directions)];
                    let replay = |leaves: &[[f32; 34]]| {
                        let tree = tree_of_leaves(context, leaves, cells.least());
                        evaluate(context, &tree, kernel, 0.0, &packets)
                    };
                    let found = replay(&cut.fields);
                    let case = format!("{name} {lobe:?} {roughness} on {}", context.describe());
                    assert_eq!(found.leaves as usize, cut.leaves, "leaves: {case}");
                    let allowed = rounding(width(lobe, roughness), cut.leaves);
                    assert_eq!(beyond(&cut.radiance, &found, allowed, [0.0; 3]), None, "{case}");
                    if roughness >= 0.25 {
                        // The tolerance of a bake's levels.
                        assert_eq!(
                            beyond(&cut.radiance, &found, 1e-5_f64.min(allowed), [0.0; 3]),
                            None,
                            "{case}"
                        );
                    }
                    replayed += 1;
                    // Scaling the heaviest leaf must change the answer.
                    if cut.leaves > 1 && cut.leaves < 200 {
                        let heaviest =
                            (0..cut.leaves).max_by(|a, b| cut.fields[*a][10].total_cmp(&cut.fields[*b][10]));
                        let mut fewer = cut.fields.clone();
                        fewer[heaviest.expect("leaves")][12] *= 1.01;
                        seen[usize::from(lobe != Lobe::Charlie)] +=
                            u32::from(beyond(&cut.radiance, &replay(&fewer), allowed, [0.0; 3]).is_some());
                    }
                }
            }
        }
        assert_eq!(replayed, 4 * 8 * LOBES.len());
        println!("replayed cuts: detected a leaf made 1 % brighter in {seen:?} cuts");
        assert!(seen[0] > 5 && seen[1] > 20, "a leaf made 1 % brighter was detected in only {seen:?} cuts");
    });
}

/// Shifts E by more than the engines' decisions can differ. A cell's expected error is a third-order term, or
/// a quarter of an interval of the kernel, whose ends differ between the engines by the kernel's rounding: of
/// an interval of a 64th of the kernel that is 64 times as much. Few cells near the tolerance have less.
fn margin(width: f64) -> f64 {
    64.0 * rounding(width, 0)
}

#[test]
fn own_cuts_agree_but_for_decisions_within_rounding() {
    let oems = synthetic(64);
    let tiles: Vec<_> = tiles(8).into_iter().step_by(sweep(3, 1)).collect();
    in_full("own cuts", |context| {
        let (mut strict, mut all) = (0, 0);
        for (name, oem) in &oems {
            let spread = Reconstruction::Constant;
            let cells = Cells::new(oem, 1, spread);
            let tree = tree(context, oem, 1, spread);
            let uploaded = tree_of_cells(context, &cells, oem.size().inner, 1, spread);
            let totals = oem.totals();
            let mean = luminance([totals[0], totals[1], totals[2]]) / (4.0 * std::f64::consts::PI);
            for (lobe, roughness) in LOBES.into_iter().filter(|(_, roughness)| *roughness >= 0.25) {
                let kernel = Kernel::new(lobe, roughness * roughness);
                let margin = margin(width(lobe, roughness));
                let error = 0.005;
                let packets: Vec<Packet> = tiles.iter().map(|tile| Packet::new(tile)).collect();
                let cuts: Vec<[Cut; 3]> = tiles
                    .par_iter()
                    .map(|tile| {
                        [1.0, 1.0 - margin, 1.0 + margin].map(|by| cut(&cells, kernel, error * by, tile))
                    })
                    .collect();
                for tree in [&tree, &uploaded] {
                    let found = evaluate(context, tree, kernel, error, &packets);
                    for (k, [own, finer, coarser]) in cuts.iter().enumerate() {
                        let lanes = found.lanes[k * LANES..(k + 1) * LANES].to_vec();
                        let found = Answers { lanes, leaves: 0 };
                        let same = finer.radiance == coarser.radiance;
                        let flips =
                            if same { 0.0 } else { finer.leaves.abs_diff(coarser.leaves).max(1) as f64 };
                        // And one: a cell's error is estimated by one of two rules, and E does not shift
                        // which.
                        let absolute = [(flips + 1.0) * leaf_share(error) * mean; 3];
                        let far = beyond(&own.radiance, &found, 1e-5, absolute);
                        assert_eq!(
                            far,
                            None,
                            "{name} {lobe:?} {roughness}, {flips} decisions open, on {}",
                            context.describe()
                        );
                        let close = beyond(&own.radiance, &found, 1e-5, [0.0; 3]).is_none();
                        strict += u32::from(same && close);
                        all += 1;
                    }
                }
            }
        }
        println!("own cuts: {strict} of {all} have no decision within rounding");
        assert!(strict > all * 3 / 4, "only {strict} of {all} packets compared to 1e-5");
    });
}

/// Queries `directions` through the engine.
fn ask(
    reflector: &GpuReflector<'_>,
    context: &Context,
    directions: &[DVec3],
    lobe: Lobe,
    roughness: f64,
    filter: Filter,
) -> Vec<[f64; 3]> {
    let answers = wait(context, reflector.query(directions, lobe, roughness, filter));
    assert_eq!(answers.len(), directions.len(), "one answer per direction");
    answers.iter().map(|answer| answer.radiance.map(f64::from)).collect()
}

#[test]
fn a_furnace_is_white() {
    let layouts = [
        Layout::Panorama { width: 64, height: 32 },
        Layout::Cube { size: 16 },
        Layout::Octahedral { size: 9 },
    ];
    with_passes("furnace", |context, passes| {
        let mut random = Random::new(72);
        let mut directions = landmarks();
        directions.extend((0..sweep(6, 20)).map(|_| random.direction()));
        let constant = [0.25, 1.0, 3e4];
        for (k, layout) in layouts.into_iter().enumerate() {
            let furnace = environment(layout, vec![constant.map(|c| c as f32); layout.texel_count()]);
            let mut spotted = furnace.texels().to_vec();
            spotted[0][1] = 2.0;
            let spotted = environment(layout, spotted);
            let made_ready = |environment, inner| {
                let settings = ReflectorSettings { oem_size: Some(inner), ..ReflectorSettings::default() };
                GpuReflector::new(passes, environment, &settings).expect("a small OEM")
            };
            let worst = |reflector: &GpuReflector<'_>, lobe: Lobe, roughness: f64, filter: Filter| {
                let answers = ask(reflector, context, &directions, lobe, roughness, filter);
                let off = answers.iter().flat_map(|rgb| (0..3).map(|c| (rgb[c] / constant[c] - 1.0).abs()));
                off.fold(0.0, f64::max)
            };
            // The pairs form a Latin square: every lobe meets every layout and every size, in a third of the
            // combinations.
            for (row, inner) in [1, [3, 17, 5][k], 64].into_iter().enumerate() {
                let reflector = made_ready(&furnace, inner);
                let lobes = LOBES.into_iter().chain([(Lobe::Ggx, 0.01), (Lobe::Cone, 0.3)]);
                for (lobe, roughness) in lobes.skip((k + row) % 3).step_by(3) {
                    let filters = [Filter::Adaptive(0.005), Filter::Box];
                    for filter in filters.into_iter().filter(|filter| filter.check(lobe, None).is_ok()) {
                        let off = worst(&reflector, lobe, roughness, filter);
                        let case = format!("{layout:?} {inner} {lobe:?} {roughness} {filter:?}");
                        assert!(off <= FURNACE, "{case}: off by {off:e} on {}", context.describe());
                    }
                }
            }
            for filter in [Filter::Adaptive(0.005), Filter::Box] {
                let off = worst(&made_ready(&spotted, 64), Lobe::Ggx, 0.5, filter);
                assert!(
                    off > FURNACE,
                    "{layout:?} {filter:?}: one texel twice as bright is not detected: {off:e}"
                );
            }
        }
    });
}

/// A lit texel in every layout, at places where texels have other shapes: both engines subdivide it into the
/// same pieces, so that they agree far closer than their bounds.
#[test]
fn texels_of_the_source_are_subdivided_as_on_the_cpu() {
    // Columns and rows of texels beside a pole, on the fold diagonal, in a corner, and elsewhere.
    let cases = [
        (Layout::Panorama { width: 64, height: 32 }, vec![(0, 0), (63, 31), (20, 9), (33, 16)]),
        (Layout::Panorama { width: 6, height: 3 }, vec![(2, 0), (3, 1)]),
        (Layout::Cube { size: 16 }, vec![(0, 0), (7, 20), (15, 47), (3, 90), (8, 55), (2, 70)]),
        (Layout::Cube { size: 1 }, vec![(0, 2), (0, 5)]),
        (Layout::Octahedral { size: 32 }, vec![(0, 0), (4, 11), (20, 27), (15, 15), (31, 2)]),
        (Layout::Octahedral { size: 5 }, vec![(2, 2), (0, 3)]),
    ];
    with_passes("texels of the source", |context, passes| {
        let mut random = Random::new(79);
        let mut compared = 0;
        for (layout, places) in &cases {
            for (x, y) in places {
                let (columns, rows) = layout.sides();
                let at = (y * columns + x) as usize;
                let mut texels = vec![[0.25, 0.5, 0.125]; layout.texel_count()];
                texels[at] = [400.0, 300.0, 200.0];
                let source = environment(*layout, texels);
                let lit = layout.direction_from_texel(y / rows, *x, y % rows);
                let settings = ReflectorSettings { oem_size: Some(256), ..ReflectorSettings::default() };
                let on_gpu = GpuReflector::new(passes, &source, &settings).expect("a small OEM");
                let on_cpu = Reflector::new(&source, &settings).expect("a small OEM");
                let mut around = |centre: DVec3| {
                    let mut directions = vec![centre];
                    directions.extend((0..6).map(|_| (centre + random.direction() * 0.1).normalize()));
                    directions
                };
                let (peak, band) = (around(lit), around(lit.any_orthonormal_vector()));
                for (lobe, roughness, directions) in [
                    (Lobe::Ggx, 0.2, &peak),
                    (Lobe::Ggx, 0.5, &peak),
                    (Lobe::Phong, 0.4, &peak),
                    (Lobe::Charlie, 0.2, &band),
                    (Lobe::Charlie, 0.7, &band),
                    (Lobe::Charlie, 1.0, &peak),
                ] {
                    let filter = Filter::Adaptive(0.002);
                    let found = wait(context, on_gpu.query(directions, lobe, roughness, filter));
                    for (answer, direction) in found.iter().zip(directions) {
                        let expected =
                            on_cpu.query(*direction, roughness, lobe, filter).expect("a finite answer");
                        let [a, b] = [answer, &expected].map(|a| luminance(a.radiance.map(f64::from)));
                        let case = format!("{layout:?} ({x}, {y}) {lobe:?} {roughness} {direction}");
                        assert!((a - b).abs() <= 2e-4 * b, "{case}: {a}, not {b}, on {}", context.describe());
                        let bounds =
                            [answer, &expected].map(|a| f64::from(a.bound.expect("a bound").luminance));
                        assert!(bounds[0] <= 1.5 * bounds[1] + 1e-4 * b, "{case}: bounds {bounds:?}");
                        for c in 0..3 {
                            let [a, b] = [answer, &expected].map(|a| f64::from(a.radiance[c]));
                            assert!((a - b).abs() <= 2e-4 * b, "{case}: channel {c} is {a}, not {b}");
                            let bounds =
                                [answer, &expected].map(|a| f64::from(a.bound.expect("bounds").channels[c]));
                            assert!(
                                bounds[0] <= 1.5 * bounds[1] + 3e-4 * b,
                                "{case}: {c}: bounds {bounds:?}"
                            );
                        }
                        compared += 1;
                    }
                }
            }
        }
        assert_eq!(compared, 21 * 7 * 6);
    });
}

#[test]
fn packets_of_every_row_of_a_dispatch_are_served() {
    // A dispatch has rows of 32768 packets. No texel exceeds the least radiance here; otherwise drivers would
    // take minutes. Served lanes hold the least radiance, the others hold nothing.
    let count = 32_768 + 100;
    let packets = vec![Packet::new(&[DVec3::X]); count];
    let oem = oem(OemSize { inner: 2, border: 0 }, &[[1.0; 3]; 4]);
    in_full("rows of packets", |context| {
        let cells = Cells::new(&oem, 2, Reconstruction::Constant);
        let cells = tree_of_cells(context, &cells, 2, 2, Reconstruction::Constant);
        let found = evaluate(context, &cells, Kernel::new(Lobe::Ggx, 0.5), 0.5, &packets).lanes;
        assert_eq!(found.len(), count * LANES);
        let served = |lane: &octagloss_core::lobe::filter::Answer| lane.radiance == [1.0; 3];
        assert_eq!(found.iter().position(|lane| !served(lane)), None, "a lane that was not served");
    });
}
