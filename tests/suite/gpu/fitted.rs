//! The real-time tier: blurred tables equal the CPU's to the last bit; harmonics and radiance lie within
//! float32 error bounds.

use super::emitters::Open;
use super::transfer::{Upload as _, bake_one, read_blurred, read_harmonics};
use super::{UNIT, exceeds, in_full, wait, with_passes};
use crate::cpu::adaptive::{ask, reflector};
use crate::support::common::{Look, Random, environment, landmarks, oem, texels};
use glam::{DVec2, DVec3};
use octagloss::internals::bake::{BakeSettings, bake};
use octagloss::internals::cpu::blur::blurred;
use octagloss::internals::filter::{Answer, Filter};
use octagloss::internals::gpu::engine::{Engine, GpuReflector};
use octagloss::internals::gpu::fitted::FittedTables;
use octagloss::internals::gpu::octaves::BORDER;
use octagloss::internals::gpu::{Context, OemPlanes, SatPlanes};
use octagloss::internals::gpu::{build_fitted, emitters, harmonics as of_table};
use octagloss::internals::lobe::{self, Lobe};
use octagloss::internals::oem::{Oem, OemSize};
use octagloss::internals::realtime::emitters::{Emitter, extracted};
use octagloss::internals::realtime::tables::triangle::{Grid, triangle_from_oct};
use octagloss::internals::realtime::tables::{COUNTS, KNOTS, SoftBox, Table};
use octagloss::internals::reflector::{Reflector as CpuReflector, ReflectorSettings};
use octagloss::internals::sat::{Sat, Scan};
use octagloss::internals::sh;
use octagloss::internals::sphere::octahedral::{oct_from_direction, wrap_texel};
use octagloss::{Environment, Layout};

/// Returns the octaves whose tables are read for `inner` texels.
fn octaves(inner: u32) -> std::ops::RangeInclusive<u32> {
    1..=(inner / 4).ilog2().min(6)
}

fn random_oem(random: &mut Random, size: OemSize, look: Look) -> Oem {
    oem(size, &texels(random, look, Layout::Octahedral { size: size.inner }))
}

/// Builds the tables of `oem` on the GPU.
fn tables(context: &Context, oem: &Oem, count: u32) -> FittedTables {
    let planes = OemPlanes::upload(context, oem).expect("small planes");
    let tables = FittedTables::new(context, oem.size().inner, count).expect("small tables");
    let stages = build_fitted::stages(context, Scan::Blocks, &planes, &tables).expect("small planes");
    context.submit(|encoder| stages.iter().for_each(|stage| stage.record(encoder)));
    tables
}

/// Returns the first entry of the bordered table that differs from the CPU's table of the unfolded plane.
fn difference(expected: &Sat, entries: &[[u64; 4]], [inner, border]: [u32; 2]) -> Option<String> {
    assert_eq!(expected.size().inner, inner, "texels of the blurred square");
    let (n, b) = (i64::from(inner), i64::from(border));
    let side = n + 2 * b + 1;
    assert_eq!(entries.len() as i64, side * side, "entries");
    (0..side * side).find_map(|k| {
        let (x, y) = (k % side, k / side);
        let found = entries[k as usize];
        let expected = expected.plane_box(-b, -b, x - b, y - b);
        (found != expected).then(|| format!("entry ({x}, {y}): {found:x?}, not {expected:x?}"))
    })
}

/// Compares the blurred tables of random squares (inner texels, border, look) with the CPU's.
pub(super) fn blurred_tables(context: &Context, cases: &[(u32, u32, Look)]) {
    let mut random = Random::new(91);
    for &(inner, border, look) in cases {
        let oem = random_oem(&mut random, OemSize { inner, border }, look);
        let tables = tables(context, &oem, 4);
        // Read back the GPU's residual map: its floats may differ from the CPU's.
        let planes = OemPlanes::upload(context, &oem).expect("small planes");
        let rest = planes.of_the_same_solid_angles(context);
        let stage = emitters::stage(context, &planes, &rest, &tables);
        context.submit(|encoder| stage.record(encoder));
        let rest = wait(context, rest.read(context));
        assert_ne!(rest, oem, "emitters must be extracted");
        let sat = Sat::new(&rest, Scan::default());
        for octave in octaves(inner) {
            let expected = blurred(&sat, octave);
            let (mut entries, size) = wait(context, read_blurred(context, &tables, octave));
            let wrong = difference(&expected, &entries, size);
            let name = format!("{look:?} {inner} + {border} octave {octave} on {}", context.describe());
            assert_eq!(wrong, None, "{name}");
            // The comparator detects one unit in one channel of one entry.
            let at = random.below(entries.len() as u32) as usize;
            entries[at][random.below(4) as usize] ^= 1;
            assert!(difference(&expected, &entries, size).is_some(), "one wrong bit, {name}");
        }
    }
}

#[test]
fn blurred_tables_equal_the_cpu_to_the_last_bit() {
    let cases = [(16, 0, Look::Noise), (32, 3, Look::Suns), (128, 0, Look::Suns), (256, 0, Look::Noise)];
    in_full("blurred tables", |context| blurred_tables(context, &cases));
}

/// Returns the first coefficient that differs from the CPU's by more than the error of float32 sums.
fn harmonics_difference(expected: &[[f64; 4]; 25], found: &[[f64; 4]; 25]) -> Option<String> {
    (0..25).flat_map(|k| (0..4).map(move |c| (k, c))).find_map(|(k, c)| {
        let (e, f) = (expected[k][c], found[k][c]);
        // A term takes 24 roundings, including those of its basis of at most sqrt((2n + 1)/4pi). It then
        // passes through 128 sums of a batch, 4 of a workgroup and 128 of all. The integral of the basis is
        // at most that of its greatest value.
        let order = (k as f64).sqrt().floor();
        let total = expected[0][c] * (4.0 * std::f64::consts::PI).sqrt();
        let bound =
            (24.0 + 260.0) * UNIT * total * ((2.0 * order + 1.0) / (4.0 * std::f64::consts::PI)).sqrt();
        exceeds((e - f).abs(), bound)
            .then(|| format!("coefficient {k}, channel {c}: {f}, not {e} within {bound}"))
    })
}

/// Compares the harmonics of random squares (inner texels, border, look) with the CPU's.
pub(super) fn harmonics(context: &Context, cases: &[(u32, u32, Look)]) {
    let mut random = Random::new(92);
    for &(inner, border, look) in cases {
        let oem = random_oem(&mut random, OemSize { inner, border }, look);
        let sat = Sat::new(&oem, Scan::default());
        let planes = SatPlanes::upload(context, &sat).expect("small planes");
        let tables = FittedTables::new(context, inner, 1).expect("small tables");
        let stage = of_table::stage(context, &planes, &tables);
        context.submit(|encoder| stage.record(encoder));
        let expected = sh::table_harmonics(&sat);
        let mut found = wait(context, read_harmonics(context, &tables, sat.fixed_point()));
        let wrong = harmonics_difference(&expected, &found);
        assert_eq!(wrong, None, "{look:?} {inner} + {border} on {}", context.describe());
        found[7][1] += 1e-4 * expected[0][1];
        assert!(harmonics_difference(&expected, &found).is_some(), "an error of 0.01 % is not detected");
    }
}

#[test]
fn harmonics_match_the_cpu() {
    let cases = [(16, 0, Look::Noise), (64, 7, Look::Suns), (512, 0, Look::Lone)];
    in_full("harmonics", |context| harmonics(context, &cases));
}

/// Returns the octaves whose parameters serve `alpha` for `inner` texels, and the alpha that they serve.
fn served(inner: u32, alpha: f64) -> (std::ops::RangeInclusive<u32>, f64) {
    let finest = *octaves(inner).end();
    let alpha = alpha.max((KNOTS[0] - f64::from(finest)).exp2());
    let own = (KNOTS[0] - alpha.log2()).ceil().clamp(2.0, f64::from(finest)) as u32;
    (own..=(own + 1).min(finest), alpha)
}

/// Returns the boxes of `octave` around `uv`, with the offsets and half-widths that apply there.
fn boxes(table: &Table, octave: u32, alpha: f64, uv: DVec2) -> (Vec<SoftBox>, [f64; 5]) {
    let (point, fold) = triangle_from_oct(uv);
    let mut boxes = Vec::new();
    let weights = table.kernel(octave, alpha, point, |soft| {
        let (offset, half) = (fold.oct_from_triangle(soft.offset), fold.oct_from_triangle(soft.half).abs());
        boxes.push(SoftBox { offset, half, ..soft });
    });
    (boxes, weights)
}

/// Whether `table` has a share of the lobes around `direction`.
fn serves(table: &Table, direction: DVec3) -> bool {
    let square = direction * direction;
    let angle = (square.y + square.x.min(square.z)).sqrt().asin();
    match table.shape().grid {
        Grid::Triangle => true,
        Grid::Cone => angle < 0.31,
    }
}

/// An OEM, the CPU's answers over it, and the inputs of the error bounds.
struct Judge {
    name: String,
    environment: Environment,
    inner: u32,
    emitters: Vec<Emitter>,
    open: Open,
    /// The greatest radiance of the blurred tables, per octave and channel.
    peaks: Vec<[f64; 3]>,
    mean: [f64; 3],
}

impl Judge {
    fn new(random: &mut Random, inner: u32, look: Look) -> Self {
        let layout = Layout::Octahedral { size: inner };
        let environment = environment(layout, texels(random, look, layout));
        let (emitters, rest) = extracted(reflector(&environment, inner).oem());
        let sat = Sat::new(&rest, Scan::default());
        let fixed = sat.fixed_point();
        let peak = |octave| {
            let table = blurred(&sat, octave);
            let n = i64::from(table.size().inner);
            let mut most = [0.0_f64; 3];
            for (x, y) in (0..n * n).map(|k| (k % n, k / n)) {
                let [r, g, b, w] = fixed.values(table.bordered_box(x, y, x + 1, y + 1));
                most = std::array::from_fn(|c| most[c].max([r, g, b][c] / w));
            }
            most
        };
        let peaks = std::iter::once([0.0; 3]).chain(octaves(inner).map(peak)).collect();
        let totals = rest.totals();
        let mean = std::array::from_fn(|c| totals[c] / totals[3]);
        let name = format!("{look:?} {inner}");
        Self { name, environment, inner, emitters, open: Open::new(inner), peaks, mean }
    }

    /// Bounds the difference of an answer from the CPU's `value`, per channel.
    ///
    /// In float32, coordinates (u, v) take 6 roundings of values up to 1, and each end of a box 6 more of
    /// values up to 2 or 3: 24 units. Node weights change by eleven times that, and the position among knots
    /// by less; around cone points, columns and rows change by 6^2 / 0.475 = 76 times that. Neighbouring
    /// nodes differ by about 1 in their parameters (logarithms, roots, half-widths), so half-widths, offsets
    /// and heights have a relative error of 300 units, or 2000. Moving an edge by e exchanges e over the
    /// half-width of the box's mass for texels as bright as the blurred table's brightest, whose density is
    /// up to 5.2 times that at the lobe, in energy and in solid angle. Harmonics of order n are off by 284
    /// units of (2n + 1) means (derived in their test), again in both. For mirrors, positions move by 2^-22 n
    /// of a texel, which exchanges that share of four texels. Emitters have a separate bound.
    fn bound(&self, table: &Table, direction: DVec3, roughness: f64, oem: &Oem, value: [f64; 3]) -> [f64; 3] {
        let uv = oct_from_direction(direction);
        let (octaves, alpha) = served(self.inner, roughness * roughness);
        let mut sum = value.map(|value| 32.0 * UNIT * value);
        let mut add = |mean: [f64; 3], share: f64| {
            for (sum, mean) in sum.iter_mut().zip(mean) {
                *sum += share * mean;
            }
        };
        let of_orders = |weights: [f64; 5]| -> f64 {
            let order = |(n, weight): (usize, &f64)| (2 * n + 1) as f64 * weight.abs();
            2.0 * 284.0 * UNIT * weights.iter().enumerate().map(order).sum::<f64>()
        };
        add(self.mean, of_orders(lobe::zonal_weights(Lobe::Ggx, alpha)));
        // The share of the table around cone points changes by less than 200 units, less than its nodes do.
        let tables = [Some(table), table.beside_cone_points()];
        for (octave, table) in octaves.flat_map(|octave| tables.map(|table| (octave, table))) {
            let Some(table) = table.filter(|table| serves(table, direction)) else { continue };
            let (boxes, weights) = boxes(table, octave, alpha, uv);
            add(self.mean, of_orders(weights));
            for SoftBox { mass, offset, half, octave } in boxes {
                let nodes = if table.shape().grid == Grid::Cone { 2000.0 } else { 300.0 };
                let edge = UNIT * (24.0 + nodes * (offset.length() + half.length()));
                let moved = edge / half.x + edge / half.y + 2.0 * nodes * UNIT;
                add(self.peaks[octave as usize], 2.0 * 5.2 * mass * moved);
            }
        }
        for emitter in &self.emitters {
            add(self.open.of_radiance(oem, emitter, alpha, direction), 1.0);
        }
        let corner = ((uv + 1.0) * (f64::from(self.inner) / 2.0) - 0.5).floor();
        let mut brightest = [0.0_f64; 3];
        for (dx, dy) in (-1..=2).flat_map(|dy| (-1..=2).map(move |dx| (dx, dy))) {
            let (x, y) = wrap_texel(self.inner, corner.x as i64 + dx, corner.y as i64 + dy);
            let radiance = oem.radiance(x, y);
            brightest = std::array::from_fn(|c| brightest[c].max(f64::from(radiance[c])));
        }
        add(brightest, 4.0 * 5.2 * (4.0 * f64::from(self.inner) + 24.0) * UNIT);
        sum
    }
}

/// Returns the first answer beyond its bound.
fn radiance_difference(
    judge: &Judge,
    count: u32,
    roughness: f64,
    directions: &[DVec3],
    found: &[[f32; 3]],
) -> Option<String> {
    assert!(!directions.is_empty() && directions.len() == found.len(), "one answer per direction");
    let reflector = reflector(&judge.environment, judge.inner);
    let table = Table::of(count).expect("a supported count");
    let expected = ask(&reflector, Lobe::Ggx, roughness, Filter::Fitted(count), directions);
    directions.iter().zip(expected).zip(found).find_map(|((direction, expected), found)| {
        let bound = judge.bound(table, *direction, roughness, reflector.oem(), expected);
        let far = (0..3).any(|c| exceeds((f64::from(found[c]) - expected[c]).abs(), bound[c]));
        far.then(|| {
            format!("fitted:{count} {roughness} {direction}: {found:?}, not {expected:?} within {bound:?}")
        })
    })
}

/// Roughness at both ends, in the fades of octaves, of the mirror and of the harmonics, and between.
const ROUGHNESS: [f64; 14] = [0.0, 0.02, 0.1, 0.135, 0.15, 0.2, 0.3, 0.33, 0.4, 0.46, 0.55, 0.68, 0.74, 1.0];

/// Returns directions at the folds and corners of the map, near them, and anywhere.
fn directions(random: &mut Random) -> Vec<DVec3> {
    let mut directions = landmarks();
    for landmark in landmarks() {
        directions.push((landmark + 0.01 * random.direction()).normalize());
    }
    directions.extend((0..40).map(|_| random.direction()));
    directions
}

/// Compares answers over random squares (inner texels, look) by boxes of every count with the CPU's. Returns
/// how many boxes left the tables' border, and how many there were.
pub(super) fn radiance(
    context: &Context,
    passes: &Engine,
    cases: &[(u32, Look)],
    all_roughness: &[f64],
) -> [u32; 2] {
    let mut random = Random::new(93);
    let (mut beyond, mut all) = (0, 0);
    for &(inner, look) in cases {
        let judge = Judge::new(&mut random, inner, look);
        let directions = directions(&mut random);
        let reflector = reflector(&judge.environment, inner);
        let tables = tables(context, reflector.oem(), 4);
        let ask = |roughness: f64| {
            let queries: Vec<_> = directions.iter().map(|direction| (*direction, roughness)).collect();
            wait(context, passes.fitted.radiance(context, &tables, &queries))
        };
        for count in COUNTS {
            tables.set_count(context, count).expect("a supported count");
            for &roughness in all_roughness {
                let far = radiance_difference(&judge, count, roughness, &directions, &ask(roughness));
                assert_eq!(far, None, "{} on {}", judge.name, context.describe());
                for direction in &directions {
                    beyond += leaves_border(count, inner, roughness, *direction);
                    all += count;
                }
            }
        }
        // Wrong roughness, count or order of answers must be detected, except where a sun makes the bounds
        // wide.
        for count in COUNTS.into_iter().filter(|_| look == Look::Noise) {
            tables.set_count(context, count).expect("a supported count");
            let seen = |found: &[[f32; 3]], count| {
                radiance_difference(&judge, count, 0.4, &directions, found).is_some()
            };
            assert!(seen(&ask(0.404), count), "roughness 1 % greater, fitted:{count}");
            let mut right = ask(0.4);
            let other = if count == 4 { 2 } else { 4 };
            assert!(!seen(&right, count) && seen(&right, other), "fitted:{other} is not fitted:{count}");
            right.rotate_left(1);
            assert!(seen(&right, count), "answers shifted by one, fitted:{count}");
        }
    }
    [beyond, all]
}

#[test]
fn radiance_lies_within_its_bound_of_the_cpu() {
    let cases = [(16, Look::Noise), (64, Look::Suns), (256, Look::Smooth)];
    with_passes("fitted radiance", |context, passes| {
        let [beyond, all] = radiance(context, passes, &cases, &ROUGHNESS);
        assert!(beyond > 0 && beyond * 100 < all, "{beyond} of {all} boxes leave the border");
    });
}

/// Counts boxes around `direction`, of those in its own octave, that exceed the tables' border.
fn leaves_border(count: u32, inner: u32, roughness: f64, direction: DVec3) -> u32 {
    let uv = oct_from_direction(direction);
    let (octaves, alpha) = served(inner, roughness * roughness);
    let table = Table::of(count).expect("a supported count");
    let (boxes, _) = boxes(table, *octaves.start(), alpha, uv);
    let leaves = |soft: &SoftBox| {
        let coarse = f64::from(inner.min(8 << soft.octave));
        let reach = ((uv + soft.offset).abs() + soft.half) * (coarse / 2.0);
        reach.max_element() > coarse / 2.0 + f64::from(BORDER)
    };
    boxes.iter().filter(|soft| leaves(soft)).count() as u32
}

/// Error bound of the furnace: harmonics of radiance and of 1 are each off by 284 units (see their test).
const FURNACE: f64 = 2.0 * 284.0 * UNIT;

#[test]
fn a_fitted_furnace_is_white() {
    let layout = Layout::Cube { size: 16 };
    let furnace = environment(layout, vec![[0.25, 1.0, 3e4]; layout.texel_count()]);
    let mut spotted = furnace.texels().to_vec();
    spotted[0][1] = 1.01;
    let spotted = environment(layout, spotted);
    let directions = directions(&mut Random::new(94));
    with_passes("fitted furnace", |context, passes| {
        let settings = ReflectorSettings { oem_size: Some(64), ..ReflectorSettings::default() };
        let [furnace, spotted] = [&furnace, &spotted]
            .map(|environment| GpuReflector::new(passes, environment, &settings).expect("a small OEM"));
        let error = |reflector: &GpuReflector<'_>, count, roughness| {
            let answers = reflector.query(&directions, Lobe::Ggx, roughness, Filter::Fitted(count));
            let off = |answer: &Answer| {
                let pairs = answer.radiance.into_iter().zip([0.25, 1.0, 3e4]);
                pairs.map(|(value, constant)| (f64::from(value) / constant - 1.0).abs()).fold(0.0, f64::max)
            };
            wait(context, answers).iter().map(off).fold(0.0, f64::max)
        };
        for (count, roughness) in COUNTS.into_iter().flat_map(|count| ROUGHNESS.map(|r| (count, r))) {
            let off = error(&furnace, count, roughness);
            assert!(!exceeds(off, FURNACE), "fitted:{count} {roughness}: off by {off:e}");
        }
        let off = error(&spotted, 4, 0.2);
        assert!(off > FURNACE, "one texel 1 % brighter is not detected: {off:e}");
    });
}

#[test]
fn queries_and_bakes_match_the_cpu() {
    let layout = Layout::Panorama { width: 64, height: 32 };
    let sky = environment(layout, texels(&mut Random::new(95), Look::Smooth, layout))
        .rotated_y(40.0)
        .expect("an angle");
    // Boxes of a smooth sky change by a few times its brightest over a radian, and coordinates are off by
    // 2^-20; the test of harmonics derives their error.
    let brightest = f64::from(sky.texels().iter().flatten().copied().fold(0.0, f32::max));
    let allowed = brightest * (2.0 * 284.0 * 5.0 * UNIT + 4e-6);
    let far = |expected: &[[f32; 3]], found: &[[f32; 3]]| {
        assert!(!expected.is_empty() && expected.len() == found.len(), "the same number of answers");
        let pairs = expected.as_flattened().iter().zip(found.as_flattened());
        pairs.map(|(e, f)| f64::from((e - f).abs())).fold(0.0, f64::max)
    };
    let directions = directions(&mut Random::new(96));
    with_passes("fitted queries and bakes", |context, passes| {
        let settings = ReflectorSettings { oem_size: Some(64), ..ReflectorSettings::default() };
        let on_cpu = CpuReflector::new(&sky, &settings).expect("a small OEM");
        let on_gpu = GpuReflector::new(passes, &sky, &settings).expect("a small OEM");
        for (count, roughness) in [(4, 0.25), (1, 0.25), (8, 0.6), (2, 0.9)] {
            let filter = Filter::Fitted(count);
            let expected: Vec<[f32; 3]> = directions
                .iter()
                .map(|d| on_cpu.query(*d, roughness, Lobe::Ggx, filter).expect("an answer").radiance)
                .collect();
            let ask = |roughness| {
                let answers = wait(context, on_gpu.query(&directions, Lobe::Ggx, roughness, filter));
                answers.iter().map(|answer| answer.radiance).collect::<Vec<_>>()
            };
            let (off, other) = (far(&expected, &ask(roughness)), far(&expected, &ask(roughness + 0.05)));
            assert!(off <= allowed && other > allowed, "fitted:{count} {roughness}: {off:e}, {other:e}");
        }
        let settings =
            BakeSettings { size: 16, levels: Some(4), filter: Filter::Fitted(4), ..BakeSettings::default() };
        let expected = bake(&sky, &settings).expect("a small bake");
        let found = wait(context, bake_one(passes, &sky, &settings));
        let other =
            wait(context, bake_one(passes, &sky, &BakeSettings { filter: Filter::Fitted(1), ..settings }));
        for (level, (e, f)) in expected.chain.levels.iter().zip(&found.chain.levels).enumerate() {
            let off = far(&e.texels, &f.texels);
            assert!(off <= allowed, "level {level}: {off:e} of {allowed:e} on {}", context.describe());
        }
        let off = far(&expected.chain.levels[1].texels, &other.chain.levels[1].texels);
        assert!(off > allowed, "fitted:1 is not detected: {off:e}");
    });
}
