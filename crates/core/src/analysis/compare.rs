//! Measures a bake against its exhaustively integrated source, or against another bake.

use crate::analysis::channels::{ErrorSums, Greatest, Relative, differences, relative_to};
use crate::analysis::oracle::Oracle;
use crate::analysis::sun::texel_width;
use crate::common::error::{Result, wrong};
use crate::common::finite::finite;
use crate::common::parallel;
use crate::common::smoothstep::smoothstep;
use crate::geometry::footprints::footprints_over;
use crate::geometry::tiling::edge;
use crate::light::chain::{Chain, Level};
use crate::light::environment::{Environment, Layout, exact_luminance};
use crate::lobe::{Lobe, full_width_at_half_maximum};
use crate::sphere::cube::{Face, texel_around};
use glam::DVec3;
use serde::Serialize;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicU64, Ordering};

/// Minimum lobe width in source texels; narrower lobes measure texel reconstruction, not the lobe.
const NARROW: f64 = 2.0;

/// Selection of a level's texels to compare, deterministic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// All texels.
    All,
    /// At most this many, at random.
    Random(usize),
    /// At most this many on a grid that covers every face (six at least), for pictures; at random where the
    /// level is not a cube.
    Grid(usize),
}

impl Sampling {
    /// Maximum number of texels.
    const fn most(self) -> Option<usize> {
        match self {
            Self::All => None,
            Self::Random(count) | Self::Grid(count) => Some(count),
        }
    }

    /// Grid points along a face edge for a level in `layout`; `None` for other maps than cubes.
    fn grid(self, layout: Layout) -> Option<u32> {
        let Layout::Cube { size } = layout else { return None };
        match self {
            Self::All => Some(size),
            Self::Random(count) => (count >= 6 * size as usize * size as usize).then_some(size),
            Self::Grid(count) => Some(u32::try_from((count / 6).isqrt()).unwrap_or(size).clamp(1, size)),
        }
    }

    /// The selected texels of a level in `layout`, in order.
    fn picks(self, layout: Layout) -> Vec<usize> {
        match self.grid(layout) {
            Some(grid) => grid_places(layout.sides().1, grid),
            None => sample(layout.texel_count(), self.most()),
        }
    }
}

/// The texels nearest the centres of a grid of `grid` x `grid` on each face of a level of `size`, in order.
fn grid_places(size: u32, grid: u32) -> Vec<usize> {
    let (size, grid) = (size as usize, grid as usize);
    let line = |k: usize| (2 * k + 1) * size / (2 * grid);
    let texel = |k: usize| (k / (grid * grid) * size + line(k / grid % grid)) * size + line(k % grid);
    (0..6 * grid * grid).map(texel).collect()
}

/// The texels of `level` that a [`LevelErrors::reference`] of `size` was compared with.
pub fn grid_of(level: &Level, size: u32) -> Level {
    let texels =
        grid_places(level.size(), size.min(level.size())).into_iter().map(|at| level.texels[at]).collect();
    Level::cube(size.min(level.size()), level.roughness, texels)
}

/// Errors of one level, in luminance and in every channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LevelErrors {
    /// The level's number.
    pub level: usize,
    /// Texels along an edge of a face or square; the height of a panorama.
    pub size: u32,
    /// Its roughness.
    pub roughness: f64,
    /// Number of texels compared.
    pub texels: usize,
    /// Root mean square errors over the mean of the reference: of the texels of a cube, of the sphere for
    /// other maps.
    #[serde(flatten)]
    pub rmse: Relative,
    /// Mean absolute error of luminance over the mean of the reference.
    #[serde(serialize_with = "finite")]
    pub l1: f64,
    /// The same of red, green and blue.
    #[serde(serialize_with = "finite")]
    pub channel_l1: [f64; 3],
    /// The texel with the largest relative error of luminance or a channel.
    pub worst: WorstTexel,
    /// Seam measure of the bake at cube edges.
    #[serde(serialize_with = "finite")]
    pub seam: Option<f64>,
    /// Seam measure of the reference at cube edges.
    ///
    /// Mean step between texels on either side of an edge over the mean step between neighbours within a
    /// face, each divided by the angle between the texels. About 1 without a seam; `None` for a constant
    /// level and for other maps than cubes.
    #[serde(serialize_with = "finite")]
    pub reference_seam: Option<f64>,
    /// The reference level, if all texels or a grid of them were compared; `grid_of` gives the bake's
    /// texels of the same grid.
    #[serde(skip)]
    pub reference: Option<Level>,
}

/// A texel and both values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorstTexel {
    /// Face of a cube, as in file names.
    pub face: Option<&'static str>,
    /// Column.
    pub i: u32,
    /// Row.
    pub j: u32,
    /// Unit direction of its centre.
    pub direction: [f64; 3],
    /// Radiance of the bake.
    #[serde(serialize_with = "finite")]
    pub value: [f64; 3],
    /// Radiance of the reference.
    #[serde(serialize_with = "finite")]
    pub reference: [f64; 3],
    /// Error over the reference, of luminance or the channel `of`, over luminance for a channel that is
    /// nearly black; 1 if only the reference is black.
    #[serde(serialize_with = "finite")]
    pub relative: f64,
    /// `luminance`, `red`, `green` or `blue`: where the error is greatest.
    pub of: &'static str,
}

impl LevelErrors {
    /// The mean absolute errors.
    pub const fn mean(&self) -> Relative {
        Relative { luminance: self.l1, channels: self.channel_l1 }
    }
}

/// Compares every texel of two bakes; errors are relative to `reference`.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if they differ in levels, sizes or roughness.
pub fn errors_against_bake(bake: &Chain, reference: &Chain) -> Result<Vec<LevelErrors>> {
    if bake.levels.len() != reference.levels.len() {
        return wrong(format!(
            "the bakes have {} and {} levels; bake both with equal `size` and `levels`",
            bake.levels.len(),
            reference.levels.len()
        ));
    }
    let pairs = bake.levels.iter().zip(&reference.levels).enumerate();
    pairs
        .map(|(index, (a, b))| {
            if a.layout != b.layout || (a.roughness - b.roughness).abs() > 1e-4 {
                return wrong(format!(
                    "level {index} is {} of {} at roughness {:.4} in one bake and {} of {} at {:.4} in the \
                     other; bake both with equal layout, `size`, `levels` and `ladder`",
                    a.layout.name(),
                    a.size(),
                    a.roughness,
                    b.layout.name(),
                    b.size(),
                    b.roughness
                ));
            }
            Ok(errors_against_texels(index, a, b))
        })
        .collect()
}

/// Compares every texel of two levels in one layout; `index` is the level's number.
pub fn errors_against_texels(index: usize, level: &Level, reference: &Level) -> LevelErrors {
    let value = |at: usize| reference.texels[at].map(f64::from);
    level_errors(index, level, &value, Sampling::All)
}

/// Whether `level` can be measured against a source in `layout`: its lobe spans several source texels.
///
/// Narrower lobes depend on the reconstruction of texels, in which bake and reference may differ.
pub fn is_measurable(level: &Level, lobe: Lobe, layout: Layout) -> bool {
    lobe == Lobe::Cosine || lobe_width(level, lobe) >= NARROW * texel_width(layout)
}

/// Compares every texel of a mirror level with the mean of `source` over the texel's footprint; `index` is
/// the level's number.
///
/// # Errors
/// [`crate::common::error::Error::Limit`] if the overlaps of the texels do not fit.
pub fn errors_against_footprints(index: usize, level: &Level, source: &Environment) -> Result<LevelErrors> {
    let means = footprints_over(source, level.layout)?;
    Ok(level_errors(index, level, &|at| means[at].map(f64::from), Sampling::All))
}

fn lobe_width(level: &Level, lobe: Lobe) -> f64 {
    full_width_at_half_maximum(lobe, level.roughness * level.roughness)
}

/// Compares the [measurable](is_measurable) ones of `levels`, sharpest first, with `lobe` integrated over
/// `source`, at the texels selected by `sampling`. The lobe is evaluated at the texel's centre, or averaged
/// over the footprint of a texel that is wide for the lobe, as in a bake. `progress` receives the
/// integrations done and their total, from any thread.
pub fn errors_against_source(
    levels: &[Level],
    source: &Environment,
    lobe: Lobe,
    sampling: Sampling,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Vec<LevelErrors> {
    let oracle = Oracle::new(source);
    let levels: Vec<_> =
        levels.iter().enumerate().filter(|(_, level)| is_measurable(level, lobe, source.layout())).collect();
    // Each compared texel and each end of a sampled step is an integration.
    let total = levels.iter().map(|(_, level)| integrations(level, sampling)).sum();
    let done = AtomicU64::new(0);
    levels
        .into_iter()
        .map(|(index, level)| {
            let value = |at: usize| {
                let answer = footprint_mean(level, lobe, at, &|direction| {
                    oracle.reflected(lobe, level.roughness, direction)
                });
                progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
                answer
            };
            level_errors(index, level, &value, sampling)
        })
        .collect()
}

/// Mean of `radiance` over the footprint of texel `at`: a point if the texel is narrower than a third of the
/// lobe's full width at half maximum, the whole texel from a half on.
fn footprint_mean(level: &Level, lobe: Lobe, at: usize, radiance: &dyn Fn(DVec3) -> [f64; 3]) -> [f64; 3] {
    let (image, i, j) = level.layout.place(at);
    let share = edge(level.layout, i, j) / lobe_width(level, lobe);
    let fade = (share - 1.0 / 3.0) * 6.0;
    if fade <= 0.0 {
        return radiance(level.layout.direction_from_texel(image, i, j));
    }
    let extent = smoothstep(fade);
    // Points at most a quarter of a lobe apart, weighted by solid angle.
    let count = (4.0 * share).ceil().clamp(4.0, 64.0) as u32;
    let coordinate = |texel: u32, k: u32| {
        let offset = ((f64::from(k) + 0.5) / f64::from(count) - 0.5) * extent;
        f64::from(texel) + 0.5 + offset
    };
    let (mut sum, mut whole) = (DVec3::ZERO, 0.0);
    for (a, b) in (0..count).flat_map(|b| (0..count).map(move |a| (a, b))) {
        let (direction, weight) = level.layout.direction_within(image, coordinate(i, a), coordinate(j, b));
        whole += weight;
        sum += weight * DVec3::from(radiance(direction));
    }
    (sum / whole).to_array()
}

fn integrations(level: &Level, sampling: Sampling) -> u64 {
    let picks = sampling.picks(level.layout).len();
    let Some(count) = sampling.most().filter(|_| picks < level.texels.len()) else { return picks as u64 };
    let steps = |steps: usize| 2 * count.div_ceil(4).min(steps);
    let steps = match level.layout {
        Layout::Cube { size: 2.. } => steps(steps_within(level.size())) + steps(steps_across(level.size())),
        _ => 0,
    };
    (picks + steps) as u64
}

fn level_errors(
    index: usize,
    level: &Level,
    reference: &(dyn Fn(usize) -> [f64; 3] + Sync),
    sampling: Sampling,
) -> LevelErrors {
    let picks = sampling.picks(level.layout);
    let texels = sampling.most();
    let references = parallel::map(&picks, |at| reference(*at));

    let mut sums = ErrorSums::default();
    let mut worst = (0, Greatest { error: -1.0, of: "" });
    let is_cube = matches!(level.layout, Layout::Cube { .. });
    for (pick, (at, expected)) in picks.iter().zip(&references).enumerate() {
        let got = level.texels[*at].map(f64::from);
        // A cube's texels are nearly alike; a panorama's shrink to nothing.
        let weight = if is_cube { 1.0 } else { level.layout.solid_angle_at(*at) };
        sums.add(weight, got, *expected);
        let here = relative_to(differences(got, *expected), *expected).greatest();
        if here.error > worst.1.error {
            worst = (pick, here);
        }
    }
    let l1 = sums.l1();
    let at = picks[worst.0];
    let (image, i, j) = level.layout.place(at);
    let bake = |at: usize| exact_luminance(level.texels[at]);
    // Reuse the integrals if all texels are compared.
    let all = picks.len() == level.texels.len();
    let expected = |at: usize| exact_luminance(if all { references[at] } else { reference(at) });
    LevelErrors {
        level: index,
        size: level.size(),
        roughness: level.roughness,
        texels: picks.len(),
        rmse: sums.rel_rmse(),
        l1: l1.luminance,
        channel_l1: l1.channels,
        worst: WorstTexel {
            face: is_cube.then(|| Face::ALL[image as usize].short_name()),
            i,
            j,
            direction: level.layout.direction_from_texel(image, i, j).to_array(),
            value: level.texels[at].map(f64::from),
            reference: references[worst.0],
            relative: worst.1.error,
            of: worst.1.of,
        },
        seam: if is_cube { seam(level.size(), texels, &bake) } else { None },
        reference_seam: if is_cube { seam(level.size(), texels, &expected) } else { None },
        reference: sampling.grid(level.layout).map(|size| {
            let texels = references.iter().map(|rgb| rgb.map(|c| c as f32)).collect();
            Level::cube(size, level.roughness, texels)
        }),
    }
}

/// Mean step across cube edges over mean step within faces.
fn seam(size: u32, texels: Option<usize>, value: &(dyn Fn(usize) -> f64 + Sync)) -> Option<f64> {
    let layout = Layout::Cube { size };
    let mean = |count: usize, step: fn(u32, usize) -> (usize, usize)| {
        // Together as many integrations as for the texels.
        let picks = sample(count, texels.map(|count| count.div_ceil(4)));
        let steps = parallel::map(&picks, |pick| {
            let (a, b) = step(size, *pick);
            let angle = layout.direction_at(a).angle_between(layout.direction_at(b));
            (value(a) - value(b)).abs() / angle
        });
        steps.iter().sum::<f64>() / steps.len() as f64
    };
    if size < 2 {
        return None;
    }
    let within = mean(steps_within(size), step_within);
    (within > 0.0).then(|| mean(steps_across(size), step_across) / within)
}

fn steps_within(size: u32) -> usize {
    12 * size as usize * (size as usize - 1)
}

/// Step `k` within faces: to the right for the first half, down for the second.
fn step_within(size: u32, k: usize) -> (usize, usize) {
    let n = size as usize;
    let half = 6 * n * (n - 1);
    let (line, along) = (k % half / (n - 1), k % half % (n - 1));
    if k < half {
        (line * n + along, line * n + along + 1)
    } else {
        let at = line / n * n * n + along * n + line % n;
        (at, at + n)
    }
}

fn steps_across(size: u32) -> usize {
    24 * size as usize
}

/// Step `k` across an edge, outwards; each edge counts from both sides.
fn step_across(size: u32, k: usize) -> (usize, usize) {
    let n = size as usize;
    let (face, side, along) = (Face::ALL[k / (4 * n)], k / n % 4, (k % n) as i64);
    let last = i64::from(size) - 1;
    let (inside, outside) = match side {
        0 => ((last, along), (last + 1, along)),
        1 => ((0, along), (-1, along)),
        2 => ((along, last), (along, last + 1)),
        _ => ((along, 0), (along, -1)),
    };
    (texel_around(size, face, inside.0, inside.1), texel_around(size, face, outside.0, outside.1))
}

/// `amount` of the numbers below `count`, or all, in order; deterministic.
fn sample(count: usize, amount: Option<usize>) -> Vec<usize> {
    match amount.filter(|amount| *amount < count) {
        None => (0..count).collect(),
        Some(amount) => {
            // Floyd's algorithm: every subset is equally likely.
            // Steele, Lea and Flood 2014.
            let mut state = 1_u64;
            let mut random = || {
                state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
                let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
                z ^ (z >> 31)
            };
            let mut picks = BTreeSet::new();
            for top in count - amount..count {
                let pick = (random() % (top as u64 + 1)) as usize;
                if !picks.insert(pick) {
                    picks.insert(top);
                }
            }
            picks.into_iter().collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::environment::Rgb;
    use std::f64::consts::PI;

    fn level(size: u32, value: impl Fn(DVec3) -> f32) -> Level {
        let count = 6 * size as usize * size as usize;
        let texels: Vec<Rgb> =
            (0..count).map(|at| [value(Layout::Cube { size }.direction_at(at)); 3]).collect();
        Level::cube(size, 0.5, texels)
    }

    #[test]
    fn one_wrong_texel_is_found() {
        let good = Chain { levels: vec![level(8, |d| 2.0 + d.x as f32)] };
        let same = &errors_against_bake(&good, &good).expect("equal shapes")[0];
        assert_eq!((same.rmse.luminance, same.l1, same.worst.relative), (0.0, 0.0, 0.0));

        let mut bad = good.clone();
        let at = (4 * 8 + 3) * 8 + 6;
        bad.levels[0].texels[at] = [8.0; 3];
        let errors = &errors_against_bake(&bad, &good).expect("equal shapes")[0];
        assert_eq!((errors.worst.face, errors.worst.i, errors.worst.j), (Some("pz"), 6, 3));
        assert_eq!(errors.worst.value, [8.0; 3]);
        let expected = f64::from(good.levels[0].texels[at][0]);
        assert!((errors.worst.relative - (8.0 - expected) / expected).abs() < 1e-6, "{errors:?}");
        let rel_rmse = (8.0 - expected) / (384_f64).sqrt() / 2.0;
        assert!((errors.rmse.luminance / rel_rmse - 1.0).abs() < 1e-5, "{errors:?}");
    }

    #[test]
    fn texels_of_every_map_count_by_their_share_of_the_sphere() {
        for layout in [Layout::Panorama { width: 16, height: 8 }, Layout::Octahedral { size: 9 }] {
            let (width, height) = layout.sides();
            let texels = vec![[2.0; 3]; layout.texel_count()];
            let good = Chain { levels: vec![Level { layout, roughness: 0.5, texels, bounds: None }] };
            let mut bad = good.clone();
            let at = (3 * width + 5) as usize;
            bad.levels[0].texels[at] = [4.0; 3];
            let errors = &errors_against_bake(&bad, &good).expect("equal shapes")[0];
            let place = (errors.worst.face, errors.worst.i, errors.worst.j);
            assert_eq!((place, errors.texels), ((None, 5, 3), (width * height) as usize), "{layout:?}");
            let direction = layout.direction_from_texel(0, 5, 3).to_array();
            assert_eq!((errors.worst.direction, errors.seam), (direction, None));
            let share = layout.texel_solid_angle(5, 3) / (4.0 * PI);
            assert!(
                (errors.rmse.luminance - share.sqrt()).abs() < 1e-9,
                "{layout:?}: {}",
                errors.rmse.luminance
            );
            assert!((errors.l1 - share).abs() < 1e-9, "{layout:?}: {}", errors.l1);
            let cube = Chain { levels: vec![level(height, |_| 2.0)] };
            assert!(errors_against_bake(&good, &cube).is_err(), "{layout:?} is no cube");
        }
    }

    #[test]
    fn footprints_lie_inside_their_texel() {
        for layout in [Layout::Panorama { width: 16, height: 8 }, Layout::Octahedral { size: 9 }] {
            let (width, _) = layout.sides();
            for (i, j) in [(0, 0), (5, 3), (8, 7)] {
                let centre = layout.direction_from_texel(0, i, j);
                let (found, _) = layout.direction_within(0, f64::from(i) + 0.5, f64::from(j) + 0.5);
                assert!(found.distance(centre) < 1e-12, "{layout:?} ({i}, {j}): {found} is not {centre}");
                // The mean of 1 over the texel, weighted, and of y, against the texel's own.
                let count = 400;
                let (mut area, mut height) = (0.0, 0.0);
                for k in 0..count * count {
                    let offset = |k: u32| (f64::from(k) + 0.5) / f64::from(count);
                    let (x, y) = (f64::from(i) + offset(k % count), f64::from(j) + offset(k / count));
                    let (direction, weight) = layout.direction_within(0, x, y);
                    area += weight / f64::from(count * count);
                    height += weight * direction.y / f64::from(count * count);
                }
                let per_area = match layout {
                    Layout::Panorama { .. } => PI / 8.0 * PI / 8.0,
                    _ => (2.0 / f64::from(width)).powi(2),
                };
                let exact = layout.texel_solid_angle(i, j);
                assert!((area * per_area / exact - 1.0).abs() < 1e-4, "{layout:?} ({i}, {j}): {area}");
                assert!((height / area - centre.y).abs() < 0.1, "{layout:?} ({i}, {j}): {height}");
            }
        }
    }

    #[test]
    fn a_smooth_sky_has_no_seam_and_a_face_of_its_own_has() {
        let smooth = level(32, |d| 3.0 + (d.x + d.y * d.z) as f32);
        let mut patched = smooth.clone();
        for texel in &mut patched.texels[..32 * 32] {
            *texel = texel.map(|c| c + 0.5);
        }
        let of = |level: &Level| {
            let chain = Chain { levels: vec![level.clone()] };
            errors_against_bake(&chain, &chain).expect("equal shapes")[0].seam.expect("steps")
        };
        assert!((0.7..1.3).contains(&of(&smooth)), "{}", of(&smooth));
        assert!(of(&patched) > 3.0, "{}", of(&patched));
    }

    #[test]
    fn steps_join_neighbours_and_no_others() {
        for size in [2, 3, 8] {
            let step = PI / 2.0 / f64::from(size);
            let within = (0..steps_within(size)).map(|k| step_within(size, k));
            for (a, b) in within.chain((0..steps_across(size)).map(|k| step_across(size, k))) {
                let layout = Layout::Cube { size };
                let angle = layout.direction_at(a).angle_between(layout.direction_at(b));
                assert!(a != b && angle < 1.5 * step, "{size}: {a} to {b} is {angle}");
            }
            let pairs: BTreeSet<_> = (0..steps_within(size)).map(|k| step_within(size, k)).collect();
            assert_eq!(pairs.len(), steps_within(size));
        }
    }

    #[test]
    fn a_wide_texel_is_measured_over_its_footprint() {
        let wide = level(1, |_| 0.0);
        // Over a whole face d.x has the mean 6/(4 pi) * the integral of cos over it, Lambert's formula:
        // 0.8310.
        let mean = footprint_mean(&wide, Lobe::Ggx, 0, &|d| [d.x, 1.0, d.y]);
        assert!((mean[0] - 0.831).abs() < 2e-3 && mean[1] == 1.0 && mean[2].abs() < 1e-9, "{mean:?}");
        let narrow = level(64, |_| 0.0);
        assert_eq!(
            footprint_mean(&narrow, Lobe::Ggx, 9, &|d| d.to_array()),
            Layout::Cube { size: 64 }.direction_at(9).to_array()
        );
    }

    #[test]
    fn a_grid_covers_every_face_and_its_picture_is_of_its_texels() {
        let (level, cube) = (level(8, |d| 2.0 + d.x as f32), Layout::Cube { size: 8 });
        for (asked, size) in [(1, 1), (6, 1), (24, 2), (53, 2), (54, 3), (384, 8), (100_000, 8)] {
            assert_eq!(Sampling::Grid(asked).grid(cube), Some(size), "{asked}");
            let picks = Sampling::Grid(asked).picks(cube);
            assert_eq!(picks.len(), 6 * (size * size) as usize);
            assert!(picks.windows(2).all(|pair| pair[0] < pair[1]) && picks[picks.len() - 1] < 384);
            let errors =
                level_errors(0, &level, &|at| level.texels[at].map(f64::from), Sampling::Grid(asked));
            let reference = errors.reference.expect("a grid has a picture");
            assert_eq!((reference.size(), errors.rmse.luminance), (size, 0.0));
            assert_eq!(reference.texels, grid_of(&level, size).texels);
        }
        assert_eq!(grid_places(8, 8), (0..384).collect::<Vec<_>>());
        assert_eq!((Sampling::Random(383).grid(cube), Sampling::Random(384).grid(cube)), (None, Some(8)));
    }

    #[test]
    fn samples_are_distinct_and_within() {
        assert_eq!(sample(5, Some(9)), [0, 1, 2, 3, 4]);
        let picks = sample(1000, Some(300));
        assert_eq!(picks.len(), 300);
        assert!(picks.windows(2).all(|pair| pair[0] < pair[1]) && picks[299] < 1000);
    }
}
