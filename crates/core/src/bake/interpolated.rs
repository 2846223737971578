//! Levels of cubes whose texels are much finer than their GGX lobe: lobes at nodes several texels apart, and
//! cubic interpolation in between, with certified bounds.
//!
//! Along an edge of a face at abscissa s, R moves on a great circle, by at most 1 per unit of s. With
//! P (1 - 2 S)/(1 + q S)^2 for the kernel k of S = |l - R|^2/4, and G for k without its cosine, 1 - 2 S, the
//! fourth derivative of a light's share is at most D G: in the plane around R, where S is a quarter of the
//! squared distance, 4.5 q^2 G, at the peak, and the sphere adds terms of lower order;
//! D = 4.7 q^2 + 20 q^1.5 + 60 q + 60 was found by search, and a test compares it with other lights. G grows
//! by at most exp(sqrt(q) d) over a distance of d, is at most 1.25 k where S <= 1/10, and G(1/10) beyond.
//! Four nodes h apart leave |t (t-1) (t-2) (t-3)|/24 h^4 of the fourth derivative, at t distances from the
//! first, and what the nodes of one axis leave the other axis weights, |w|.
//!
//! Beyond the horizon k is 0 instead of its continuation, which falls by at most P/(1 + q/2)^2 per unit of
//! distance: a hinge. Its slope changes by at most four times itself per unit, and the nodes around a texel
//! are within 3 sqrt(2) h of each other, so that this adds 17 h of the hinge. Interpolation misses a hinge of
//! slope 1 by at most 0.2 h, wherever it is; that was found by search, and a test looks again.

use super::level::{Advance, BakedLevel, LevelJob, Part};
use super::sparse::{FEWEST_CELLS, Nodes, share};
use super::{Engine, FINEST};
use crate::common::error::Result;
use crate::common::parallel;
use crate::geometry::energy::energy;
use crate::light::environment::{Environment, Layout, exact_luminance};
use crate::light::light_scale::rounded_up;
use crate::lobe::filter::{Answer, Bound, Filter};
use crate::lobe::kernel::{Kernel, KernelShape};
use crate::lobe::profiles::Ggx;
use std::f64::consts::PI;

/// The greatest bound that interpolation adds in the middle of a cell, over the radiance around it.
const SMOOTH: f64 = 0.012;

/// The greatest bound that it adds for lights at the horizon, over the mean radiance.
const BENT: f64 = 0.02;

/// Tolerance of the nodes' lobes over that of the level's: interpolation weights their bounds by up to 1.56.
const FINER: f64 = 0.6;

/// Error of both axes in the middle of a cell, where weights add up to 5/4, over [`CubicError::smooth`].
const MIDDLE: f64 = 2.25 * 3.0 / 128.0;

/// What interpolation misses a hinge by, over its slope and the distance of nodes.
const HINGE: f64 = 0.22;

/// How a level is interpolated.
pub(super) struct Interpolation {
    /// Texels from node to node.
    stride: u32,
    /// Tolerance of the nodes' lobes.
    tolerance: f64,
    cubic: CubicError,
}

/// Bounds of the error of cubic interpolation.
#[derive(Clone, Copy, Debug)]
struct CubicError {
    /// Along one axis, over the radiance around, per unit of t (t-1) (t-2) (t-3)/24.
    smooth: f64,
    /// Radiance to add to that around, per unit of energy.
    far: f64,
    /// Of lights at the horizon, per unit of energy.
    bent: f64,
}

/// The greatest fourth derivative of a GGX kernel of steepness `steep` along an edge of a face, over the
/// kernel without the cosine.
fn fourth_derivative(steep: f64) -> f64 {
    4.7 * steep * steep + 20.0 * steep * steep.sqrt() + 60.0 * steep + 60.0
}

impl CubicError {
    /// For `kernel`, and nodes `apart` in units of a face's half edge; `None` for lobes other than GGX.
    fn new(kernel: &Kernel, apart: f64) -> Option<Self> {
        let KernelShape::Ggx(Ggx { peak, steep }) = kernel.shape else { return None };
        let (peak, steep) = (f64::from(peak), f64::from(steep));
        let at = |s: f64| peak / (1.0 + steep * s).powi(2) / kernel.integral();
        // No point is farther from a node than half of the diagonal.
        let growth = (0.5_f64.sqrt() * apart * steep.sqrt()).exp();
        let bent = HINGE * apart * (1.0 + 17.0 * apart) * at(0.5);
        Some(Self {
            smooth: 1.25 * fourth_derivative(steep) * growth * apart.powi(4),
            far: 0.8 * at(0.1),
            bent,
        })
    }
}

impl Interpolation {
    /// How `level` is interpolated; `None` if it is not.
    pub(super) fn of(level: &LevelJob) -> Option<Self> {
        let Filter::Adaptive(error) = level.filter else { return None };
        let Layout::Cube { size } = level.spec.layout else { return None };
        if !level.sparse || level.spec.roughness == 0.0 {
            return None;
        }
        let kernel = Kernel::new(level.lobe, level.spec.roughness * level.spec.roughness);
        let certified = |stride: u32| {
            let error = CubicError::new(&kernel, 2.0 * f64::from(stride) / f64::from(size))?;
            let fits = size.is_multiple_of(stride)
                && size / stride >= FEWEST_CELLS
                && MIDDLE * error.smooth <= SMOOTH
                && 4.0 * PI * error.bent <= BENT;
            fits.then_some((stride, error))
        };
        let (stride, cubic) =
            std::iter::successors(Some(2), |stride| Some(2 * stride)).map_while(certified).last()?;
        Some(Self { stride, tolerance: (FINER * error).max(FINEST), cubic })
    }

    /// Bakes `level`, of lobes over `environment`, by the answers of `engine`.
    pub(super) async fn bake<E: Engine>(
        &self,
        engine: &E,
        environment: &Environment,
        level: &LevelJob,
        advance: Advance<'_>,
    ) -> Result<BakedLevel> {
        let (size, texels) = (level.spec.layout.sides().1, level.spec.layout.texel_count() as u64);
        let nodes = Nodes::new(self.stride, size / self.stride);
        let (places, packets) = nodes.gathered(|_, _, _| true);
        let done: Part<'_> = &|part, parts| advance(share(texels, part, parts));
        let (answers, work) = engine.answers(level, self.tolerance, &packets, done).await?;
        let mut grid = answers.clone();
        for (place, answer) in places.iter().zip(answers) {
            grid[*place] = answer;
        }
        let energies = with_luminance(energy(environment.layout(), environment.texels()));
        let axes: Vec<(u32, Axis)> = (0..size)
            .map(|texel| {
                let place = (f64::from(texel) + 0.5) / f64::from(self.stride);
                let (first, weights) = nodes.weights(place);
                (first, Axis::new(weights, place - f64::from(first)))
            })
            .collect();
        let side = (nodes.cells() + 1) as usize;
        let row = |row: u32| {
            let (face, y) = ((row / size) as usize, row % size);
            let (above, down) = &axes[y as usize];
            let first = (face * side + *above as usize) * side;
            let rows: [&[Answer]; 4] =
                std::array::from_fn(|j| &grid[first + j * side..first + (j + 1) * side]);
            let columns: Vec<Column> = (0..side).map(|i| Column::new(rows.map(|row| row[i]), down)).collect();
            axes.iter()
                .map(|(left, across)| {
                    let columns = &columns[*left as usize..*left as usize + 4];
                    self.cubic.answer(columns, [across, down], &energies)
                })
                .collect::<Vec<Answer>>()
        };
        let rows = parallel::map(0..6 * size, row);
        Ok(BakedLevel::new(E::PROCESSOR, rows.into_iter().flatten(), work))
    }
}

/// The weights of four nodes.
struct Axis {
    weights: [f64; 4],
    /// Their absolute values' sum.
    share: f64,
    /// |t (t-1) (t-2) (t-3)|/24.
    rest: f64,
}

impl Axis {
    /// `weights` at `t` distances from the first node.
    fn new(weights: [f64; 4], t: f64) -> Self {
        Self {
            weights,
            share: weights.iter().map(|weight| weight.abs()).sum(),
            rest: (t * (t - 1.0) * (t - 2.0) * (t - 3.0)).abs() / 24.0,
        }
    }
}

/// Four nodes in a column: their radiance at a row of texels, and the greatest of all four.
struct Column {
    radiance: [f64; 3],
    /// Luminance, red, green and blue: bounds, and radiance with its bound.
    bounds: [f64; 4],
    most: [f64; 4],
}

impl Column {
    fn new(nodes: [Answer; 4], down: &Axis) -> Self {
        let mut column = Self { radiance: [0.0; 3], bounds: [0.0; 4], most: [0.0; 4] };
        for (answer, weight) in nodes.iter().zip(down.weights) {
            let radiance = answer.radiance.map(f64::from);
            let bounds = answer.bound.unwrap_or(Bound::NONE).values().map(f64::from);
            column.radiance.iter_mut().zip(radiance).for_each(|(sum, value)| *sum += weight * value);
            for (q, value) in with_luminance(radiance).into_iter().enumerate() {
                column.bounds[q] = column.bounds[q].max(bounds[q]);
                column.most[q] = column.most[q].max(value + bounds[q]);
            }
        }
        column
    }
}

fn with_luminance([red, green, blue]: [f64; 3]) -> [f64; 4] {
    [exact_luminance([red, green, blue]), red, green, blue]
}

impl CubicError {
    /// The answer between four `columns`, for light of `energies`.
    fn answer(&self, columns: &[Column], [across, down]: [&Axis; 2], energies: &[f64; 4]) -> Answer {
        let mut radiance = [0.0; 3];
        let (mut bounds, mut most) = ([0.0_f64; 4], [0.0_f64; 4]);
        for (column, weight) in columns.iter().zip(across.weights) {
            radiance.iter_mut().zip(column.radiance).for_each(|(sum, value)| *sum += weight * value);
            for q in 0..4 {
                bounds[q] = bounds[q].max(column.bounds[q]);
                most[q] = most[q].max(column.most[q]);
            }
        }
        let share = across.share * down.share;
        let smooth = self.smooth * (across.rest + across.share * down.rest);
        let [luminance, channels @ ..] = std::array::from_fn::<f64, 4, _>(|q| {
            // The answer is rounded.
            smooth.mul_add(most[q] + self.far * energies[q], share * bounds[q])
                + self.bent * energies[q]
                + most[q] / f64::from(1 << 23)
        })
        .map(rounded_up);
        let radiance = radiance.map(|value| value.clamp(0.0, f64::from(f32::MAX)) as f32);
        Answer { radiance, bound: Some(Bound { channels, luminance }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::{bake_level, ready};
    use crate::cpu::reflector::{Reflector, ReflectorSettings, Workspace};
    use crate::light::chain::LevelSpec;
    use crate::light::environment::lamps;
    use crate::lobe::Lobe;
    use crate::sphere::cube::{Face, direction_from_cube};
    use glam::DVec3;

    /// Number `k` of Halton's sequence, in [0, 1).
    fn halton(k: u32, base: u32) -> f64 {
        let (mut k, mut share, mut value) = (k + 1, 1.0, 0.0);
        while k > 0 {
            share /= f64::from(base);
            value += share * f64::from(k % base);
            k /= base;
        }
        value
    }

    #[test]
    fn fourth_derivatives_are_within_their_bound() {
        for alpha in [0.01, 0.04, 0.2, 0.6] {
            let KernelShape::Ggx(Ggx { steep, .. }) = Kernel::new(Lobe::Ggx, alpha).shape else { panic!() };
            let steep = f64::from(steep);
            let plain = |s: f64| (1.0 + steep * s).powi(-2);
            let step = 0.05 / steep.sqrt().max(1.0);
            let mut greatest = 0.0_f64;
            for k in 0..20_000 {
                let halton = |base: u32| halton(k, base);
                let (s, t) = (2.0 * halton(2) - 1.0, 2.0 * halton(3) - 1.0);
                let own = direction_from_cube(Face::PosX, s, t);
                // Mostly within a few lobes.
                let apart = 8.0 * alpha * halton(5).powi(2);
                let around = std::f64::consts::TAU * halton(7);
                let (x, y) = own.any_orthonormal_pair();
                let light = (own + apart * (x * around.cos() + y * around.sin())).normalize();
                let share = |s: f64| light.distance_squared(direction_from_cube(Face::PosX, s, t)) / 4.0;
                let value = |k: f64| {
                    let s = share(s + k * step);
                    (1.0 - 2.0 * s) * plain(s)
                };
                let fourth =
                    value(-2.0) - 4.0 * value(-1.0) + 6.0 * value(0.0) - 4.0 * value(1.0) + value(2.0);
                // The step averages, so that it is compared with the greatest around.
                let around =
                    [-2.0, 0.0, 2.0].map(|k| plain(share(s + k * step))).into_iter().fold(0.0, f64::max);
                greatest = greatest.max(fourth.abs() / step.powi(4) / around);
            }
            let ratio = greatest / fourth_derivative(steep);
            assert!((0.1..1.0).contains(&ratio), "alpha {alpha}: {ratio} of the bound");
        }
    }

    #[test]
    fn hinges_are_missed_by_no_more_than_stated() {
        for cells in [128, 64] {
            let (nodes, apart) = (Nodes::new(1, cells), 2.0 / f64::from(cells));
            let mut greatest = 0.0_f64;
            for k in 0..40_000 {
                let places = [2, 3].map(|base| f64::from(cells) * halton(k, base));
                let [(left, across), (above, down)] = places.map(|place| nodes.weights(place));
                let at = |x: f64, y: f64| direction_from_cube(Face::PosX, x * apart - 1.0, y * apart - 1.0);
                let own = at(places[0], places[1]);
                // A light near the horizon of `own`.
                let (x, y) = own.any_orthonormal_pair();
                let (turn, beyond) =
                    (std::f64::consts::TAU * halton(k, 5), 3.0 * apart * (2.0 * halton(k, 7) - 1.0));
                let light = (x * turn.cos() + y * turn.sin()) * (1.0 - beyond * beyond).sqrt() - beyond * own;
                let hinge = |direction: DVec3| (-light.dot(direction)).max(0.0);
                let row = |j: usize| -> f64 {
                    let node = |i: usize| at(f64::from(left) + i as f64, f64::from(above) + j as f64);
                    (0..4).map(|i| across[i] * hinge(node(i))).sum()
                };
                let read: f64 = (0..4).map(|j| down[j] * row(j)).sum();
                greatest = greatest.max((read - hinge(own)).abs() / apart);
            }
            assert!((0.14..HINGE).contains(&greatest), "{greatest} of {apart}");
        }
    }

    #[test]
    fn interpolated_levels_are_within_their_bounds() {
        let environment = lamps([0.999, 3000.0]);
        let reflector = Reflector::new(&environment, &ReflectorSettings::default()).expect("a reflector");
        for (roughness, stride) in [(0.24, 2), (0.5, 4), (1.0, 2)] {
            let spec = LevelSpec { layout: Layout::Cube { size: 256 }, roughness };
            let level = LevelJob { spec, lobe: Lobe::Ggx, filter: Filter::Adaptive(0.005), sparse: true };
            let found = Interpolation::of(&level).map(|interpolation| interpolation.stride);
            assert_eq!(found, Some(stride), "roughness {roughness}");
            within_bounds(&reflector, &level);
        }
    }

    /// Checks a few hundred texels of `level`, a cube of 256.
    fn within_bounds(reflector: &Reflector<'_>, level: &LevelJob) {
        let LevelSpec { layout, roughness } = level.spec;
        let baked =
            ready(bake_level(reflector, reflector.environment(), level, &|_| Ok(()))).expect("a level");
        let (bounds, greatest) = (baked.bounds.expect("bounds"), baked.channel_bounds.expect("bounds"));
        let lobes = reflector.lobes(Lobe::Ggx, roughness, Filter::Adaptive(1e-4)).expect("lobes");
        let (mut squares, mut sum, mut bound, mut worst) = ([0.0; 3], [0.0; 3], 0.0, 0.0_f64);
        let step = 613;
        for k in (0..baked.texels.len()).step_by(step) {
            let (face, x, y) = (k / 65536, k as u32 % 256, k as u32 / 256 % 256);
            let direction = layout.direction_from_texel(face as u32, x, y);
            let mut truth = Vec::new();
            lobes.evaluate_units(&[direction], &mut Workspace::default(), &mut truth);
            let own = truth[0].bound.expect("a bound");
            let off: [f64; 3] =
                std::array::from_fn(|c| f64::from(baked.texels[k][c]) - f64::from(truth[0].radiance[c]));
            for c in 0..3 {
                squares[c] += off[c] * off[c];
                sum[c] += f64::from(truth[0].radiance[c]);
                assert!(off[c].abs() <= f64::from(greatest[c] + own.channels[c]), "texel {k}, channel {c}");
            }
            worst = worst.max(exact_luminance(off).abs() / f64::from(bounds[k] + own.luminance));
            bound += f64::from(bounds[k]);
        }
        assert!(worst <= 1.0, "roughness {roughness}: off by {worst} of the bound");
        let count = baked.texels.len().div_ceil(step) as f64;
        let relative: [f64; 3] = std::array::from_fn(|c| (squares[c] * count).sqrt() / sum[c]);
        assert!(relative.iter().all(|error| *error < 0.005), "relative RMS errors {relative:?}");
        assert!(bound < 0.3 * exact_luminance(sum), "bounds of {bound} for {sum:?}");
    }

    #[test]
    fn only_fine_levels_of_ggx_are_interpolated() {
        let of = |size: u32, roughness: f64, lobe: Lobe, sparse: bool| {
            let spec = LevelSpec { layout: Layout::Cube { size }, roughness };
            let level = LevelJob { spec, lobe, filter: Filter::Adaptive(0.005), sparse };
            Interpolation::of(&level).map(|interpolation| interpolation.stride)
        };
        assert_eq!([256, 512, 1024].map(|size| of(size, 0.24, Lobe::Ggx, true)), [Some(2), Some(4), Some(8)]);
        let spec = LevelSpec { layout: Layout::Cube { size: 512 }, roughness: 0.24 };
        let least = LevelJob { spec, lobe: Lobe::Ggx, filter: Filter::Adaptive(FINEST), sparse: true };
        assert_eq!(Interpolation::of(&least).map(|own| own.tolerance), Some(FINEST));
        for (size, roughness, lobe, sparse) in [
            (512, 0.2, Lobe::Ggx, false),
            (512, 0.2, Lobe::Phong, true),
            (512, 0.2, Lobe::Charlie, true),
            (511, 0.2, Lobe::Ggx, true),
            (64, 0.2, Lobe::Ggx, true),
            (512, 0.05, Lobe::Ggx, true),
            (512, 0.0, Lobe::Ggx, true),
        ] {
            assert_eq!(of(size, roughness, lobe, sparse), None, "{size} {roughness} {lobe:?} {sparse}");
        }
    }
}
