//! Lobes by adaptive quadrature over the cells, with a certified bound of the error.
//!
//! A lobe's kernel is a function k of s = |l - R|^2/4, decreasing, convex and with a decreasing second
//! derivative up to the horizon s = 1/2 (GGX, cosine, and Phong from n = 2). Over a cell's energy, with
//! centroid m, covariance C and reach rho, the mean of s is exactly t = (|m - R|^2 + tr C)/4 and its variance
//! exactly V = R.C.R/4, and s stays between a = max(0, |m - R| - rho)^2/4 and b = (|m - R| + rho)^2/4. The
//! means of k that such an s can have form an interval whose ends are those of two-point distributions
//! (Chebyshev, Markov and Krein's extremal problem for the moments 1, s, s^2):
//!
//! ```text
//! greatest:  on a and t + V/(t - a),  with weights V : (t - a)^2
//! least:     on b and t - V/(b - t),  with weights V : (b - t)^2
//! ```
//!
//! At the horizon k has a kink: its slope jumps by kappa. There k is cut in two, k = psi + kappa max(1/2 - s,
//! 0): psi is convex with a decreasing second derivative throughout, 0 beyond the horizon, and bounded as
//! above; the mean of the hinge lies between that of its mean (Jensen) and (sqrt(V + (t - 1/2)^2) + 1/2 -
//! t)/2 (Scarf 1958).
//!
//! The estimate is k(t) + V k''(t)/2, kept inside the interval; the certified error is the greater of the
//! sums of what lies above and what lies below. Lobes that are not smooth (cones, wide Phong) take k(a) and
//! k(b). Charlie, which rises before it falls, has bounds of its own (`kernel`).
//!
//! The channels differ from the luminance by their tints (crates/core/src/geometry/tint.rs). With D, Q and X
//! a tint's dipole, quadrupole and variation, k' (D.(m - R)/2 + tr Q/4) + k'' ((R - m).Q.(R - m))/8 is added
//! to the channel's estimate: the series of k up to second order over light of zero total. What is left over
//! is at most X/2 times the range over [a, b] of k minus that series, which falls from a to b, as k'' does;
//! and the sum is at most X/2 times the range of k, to which it is clipped. So it is continuous in R. The
//! luminance's tint is zero: its estimate and bound are those above.
//!
//! V is used as ((R - m).C.(R - m)), which keeps its precision near the peak; what that leaves out is the
//! radial part (l - m).m, whose deviation is at most sqrt(tr C) rho/2 (Bhatia and Davis 2000 on [1 - rho^2/2,
//! 1]), so V lies within (sqrt((R - m).C.(R - m)) +- sqrt(tr C) rho/2)^2/4.
//!
//! Cells of the source's own texels, each constant over its solid angle, have exact moments; those of the OEM
//! have the moments of a texel's spread. The bound is against the integral over the light so described, with
//! W in closed form.
//!
//! Cells are split where the error to be expected, times their energy, exceeds the tolerance for any
//! direction of the packet, or for most of those that share a cut. The energy is that of the worst channel,
//! relative to its mean. Which cells are leaves decides how tight the bound is, never whether it holds.

use super::cells::{Cells, Finest, Quad, SourceLight};
use super::footprints::{Covariance, Footprints, applied};
use super::leaves::{ALL, LANES, Leaf, NEGLIGIBLE_TINT, Packet, Scratch, Visit, weighted};
use super::subtexel::{self, LitTexels, Spread};
use crate::common::vector::{Extremes as _, Fused as _};
use crate::geometry::tint::Tint;
use crate::light::environment::{LUMINANCE, Rgb, exact_luminance};
use crate::lobe::filter::Bound;
use crate::lobe::kernel::{Kernel, KernelShape, with_radial};
use crate::lobe::radial::{Radial, expected_error};
use glam::Vec3;
use std::f64::consts::PI;

/// The answers to a packet.
#[derive(Clone, Copy, Debug)]
pub struct Shares {
    /// Radiance, lane by lane.
    pub radiance: [Rgb; LANES],
    /// Certified bounds of each lane's error.
    pub bound: [Bound; LANES],
    /// Leaves shared by the packet's lanes.
    pub leaves: usize,
}

/// Error of s where it is above 1/4: a leaf's offset and a direction's are each rounded once (2^-25 of up to
/// 2 in every component; together 6 2^-24 times the distance in half of its square), the square and the trace
/// four times more, and a centroid found by quadrature has an error of 5e-8.
const GRAZING_ROUNDING: f64 = 8.0 / 16_777_216.0;

/// Error of a dipole, over its channel's energy times the cell's reach: differences of energies are rounded
/// at 2^-23 of these, once a merge, and products as often again.
pub(crate) const TINT_ROUNDING: f32 = 8.0 / 8_388_608.0;

/// Where the series' error may exceed the kernel's variation by this factor, it is not used.
pub(crate) const USELESS: f32 = 1000.0;

/// For footprints, cells are divided while they are wider than these by this factor; smaller ones are left to
/// the directions. Measured: with half or twice of it a bake of sharp lobes takes 5 % longer.
const COARSE: f32 = 2.0;

/// Quads evaluated together, to fill the widest vectors.
const QUADS: usize = 4;

/// The expected error of every cell of `quads`, times the energy that counts.
#[inline(always)]
fn expected_errors<R: Radial>(
    kernel: R,
    packet: &Packet,
    quads: &[&Quad; QUADS],
    weights: [f32; 3],
) -> [[f32; 4]; QUADS] {
    let axis = packet.axis.as_vec3();
    let lanes = |field: fn(&Quad) -> [f32; 4]| quads.map(field);
    let (x, y, z) = (lanes(|quad| quad.x), lanes(|quad| quad.y), lanes(|quad| quad.z));
    let [xx, yy, zz] = [
        lanes(|quad| quad.covariance[0]),
        lanes(|quad| quad.covariance[1]),
        lanes(|quad| quad.covariance[2]),
    ];
    let (red, green, blue) = (lanes(|quad| quad.red), lanes(|quad| quad.green), lanes(|quad| quad.blue));
    let [red_x, red_y, red_z] =
        [lanes(|quad| quad.red_tint[0]), lanes(|quad| quad.red_tint[1]), lanes(|quad| quad.red_tint[2])];
    let [blue_x, blue_y, blue_z] =
        [lanes(|quad| quad.blue_tint[0]), lanes(|quad| quad.blue_tint[1]), lanes(|quad| quad.blue_tint[2])];
    let radius = lanes(|quad| quad.radius);
    let flat = |lanes: &[[f32; 4]; QUADS], k: usize| lanes.as_flattened()[k];
    let [mut energy, mut distances, mut reaches, mut traces] = [[0.0; 4 * QUADS]; 4];
    let mut across = false;
    for k in 0..4 * QUADS {
        let (mx, my, mz) = (flat(&x, k), flat(&y, k), flat(&z, k));
        let (x, y, z) = (mx - axis.x, my - axis.y, mz - axis.z);
        let distance = x.times_plus(x, y.times_plus(y, z * z)).sqrt();
        let trace = flat(&xx, k) + flat(&yy, k) + flat(&zz, k);
        let (red, green, blue) = (flat(&red, k), flat(&green, k), flat(&blue, k));
        // Over unit directions the quadrupole's trace is -2 D.m.
        let red_tint =
            -2.0 * mx.times_plus(flat(&red_x, k), my.times_plus(flat(&red_y, k), mz * flat(&red_z, k)));
        let blue_tint =
            -2.0 * mx.times_plus(flat(&blue_x, k), my.times_plus(flat(&blue_y, k), mz * flat(&blue_z, k)));
        let green_tint =
            red_tint.times_plus(-LUMINANCE[0] / LUMINANCE[1], blue_tint * (-LUMINANCE[2] / LUMINANCE[1]));
        let weight = weighted([red, green, blue], weights);
        // The channel that counts most may spread farther around the centroid.
        let spread = (weights[0] * red.times_plus(trace, red_tint))
            .at_least(weights[1] * green.times_plus(trace, green_tint))
            .at_least(weights[2] * blue.times_plus(trace, blue_tint));
        let reach = flat(&radius, k);
        let trace = (spread / weight.at_least(f32::MIN_POSITIVE)).at_least(trace).at_most(reach * reach);
        (energy[k], distances[k]) = (weight, distance);
        (reaches[k], traces[k]) = (reach + packet.reach, trace + packet.trace);
        let far = distance + reaches[k] + packet.judged;
        across |= 0.25 * far * far > 0.499;
    }
    let mut errors = [[0.0; 4]; QUADS];
    let all = errors.as_flattened_mut();
    if across {
        for k in 0..4 * QUADS {
            let error = expected_error::<R, true>(kernel, distances[k], reaches[k], packet.judged, traces[k]);
            all[k] = energy[k] * error;
        }
    } else {
        for k in 0..4 * QUADS {
            let error =
                expected_error::<R, false>(kernel, distances[k], reaches[k], packet.judged, traces[k]);
            all[k] = energy[k] * error;
        }
    }
    errors
}

/// A leaf's [`crate::lobe::radial::Interval`]s, by lanes.
#[derive(Default)]
struct Series {
    estimate: [f32; LANES],
    over: [f32; LANES],
    under: [f32; LANES],
    slope: [f32; LANES],
    bend: [f32; LANES],
    rest: [f32; LANES],
    spread: [f32; LANES],
}

/// Leaves whose intervals are computed before they are summed. WebAssembly's narrow vectors gain nothing, and
/// memory between costs 2 %.
const SUMMED_TOGETHER: usize = if cfg!(target_arch = "wasm32") { 1 } else { 8 };

/// Contributions of the tints of red and blue, by lanes, with bounds of their error.
#[derive(Default)]
struct TintSums {
    light: [[f32; LANES]; 2],
    error: [[f32; LANES]; 2],
}

impl TintSums {
    /// Adds the `tints` of `leaf`.
    #[inline(always)]
    fn add<const SPREAD: bool>(
        &mut self,
        leaf: &Leaf,
        tints: &[Tint; 2],
        (packet, covariance): (&Packet, &Covariance),
        series: &Series,
    ) {
        let [lx, ly, lz] = leaf.offset;
        let rounded = 2.0 * leaf.radius * TINT_ROUNDING;
        let (mut slope, mut bend) = ([0.0; LANES], [0.0; LANES]);
        let (mut rest, mut rounding) = ([0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            // Elsewhere slopes may be infinite.
            let useful = series.rest[k] < USELESS * series.spread[k];
            // With the factors of the first and second order.
            slope[k] = if useful { 0.5 * series.slope[k] } else { 0.0 };
            bend[k] = if useful { 0.25 * series.bend[k] } else { 0.0 };
            rest[k] = series.rest[k].at_most(2.0 * series.spread[k]);
            rounding[k] = rounded * slope[k].abs();
        }
        for ((c, tint), energy) in tints.iter().enumerate().zip([leaf.energy[0], leaf.energy[2]]) {
            let [dx, dy, dz] = tint.dipole.to_array();
            let [xx, yy, zz] = tint.diagonal.to_array();
            let [yz, zx, xy] = tint.mixed.to_array();
            let trace = 0.5 * (xx + yy + zz);
            for k in 0..LANES {
                let (x, y, z) = (lx - packet.x[k], ly - packet.y[k], lz - packet.z[k]);
                let (twice_y, twice_z) = (y + y, z + z);
                let first = x.times_plus(dx, y.times_plus(dy, z.times_plus(dz, trace)));
                let mut second = x.times_plus(
                    x.times_plus(xx, twice_y.times_plus(xy, twice_z * zx)),
                    y.times_plus(y.times_plus(yy, twice_z * yz), z * z * zz),
                );
                if SPREAD {
                    let [ux, uy, uz] = applied(covariance, k, [x, y, z]);
                    second += 2.0 * (dx * ux + dy * uy + dz * uz);
                }
                let light = slope[k].times_plus(first, bend[k] * second);
                // Truth lies within: clipping brings the series nearer to it, and within twice that.
                let most = tint.variation * series.spread[k];
                self.light[c][k] += light.at_most(most).at_least(-most);
                self.error[c][k] =
                    tint.variation.times_plus(rest[k], energy.times_plus(rounding[k], self.error[c][k]));
            }
        }
    }
}

/// Evaluates lobes of one kernel over one environment's cells to one tolerance.
#[derive(Debug)]
pub struct Adaptive<'a> {
    pub(super) cells: &'a Cells,
    /// The light of the source, where the finest cells hold its texels.
    pub(super) light: Option<SourceLight<'a>>,
    kernel: Kernel,
    /// Greatest expected error of a leaf, in units of the kernel times energy.
    pub(super) tolerance: f64,
    /// [`Cells::channel_weights`].
    weights: [f32; 3],
    /// Factor of the answers.
    scale: f64,
    arch: crate::common::vector::Arch,
}

/// Collects the leaves of a cut, compiled for the widest available vectors: a closure would not be inlined
/// there. FAR: of what footprints share.
struct Cut<'a, R, const FAR: bool> {
    adaptive: &'a Adaptive<'a>,
    kernel: R,
    packet: &'a Packet,
    scratch: &'a mut Scratch,
}

impl<R: Radial, const FAR: bool> pulp::NullaryFnOnce for Cut<'_, R, FAR> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.adaptive.cut::<R, FAR>(self.kernel, self.packet, self.scratch);
    }
}

/// Sums the leaves of a [`Cut`], compiled likewise. SPREAD: for footprints of a `covariance`.
struct Sum<'a, R, const SPREAD: bool> {
    adaptive: &'a Adaptive<'a>,
    kernel: R,
    packet: &'a Packet,
    covariance: &'a Covariance,
    scratch: &'a Scratch,
}

impl<R: Radial, const SPREAD: bool> pulp::NullaryFnOnce for Sum<'_, R, SPREAD> {
    type Output = Shares;

    #[inline(always)]
    fn call(self) -> Shares {
        self.adaptive.sum::<R, SPREAD>(self.kernel, (self.packet, self.covariance), self.scratch)
    }
}

impl<'a> Adaptive<'a> {
    /// Lobes of `kernel` to a relRMSE of `error` over the sphere.
    pub fn new(cells: &'a Cells, kernel: Kernel, error: f64) -> Self {
        Self {
            cells,
            light: None,
            kernel,
            tolerance: kernel.tolerance_per_mean(error) * cells.mean_luminance(),
            weights: cells.channel_weights(),
            scale: 1.0,
            arch: crate::common::vector::Arch::new(),
        }
    }

    /// Lobes over [`Cells::of_source`]: subdivides cells down to texels of `light`, and further.
    #[must_use]
    pub(crate) fn lit_by(mut self, light: SourceLight<'a>) -> Self {
        self.light = Some(light);
        self
    }

    /// Scales answers and bounds by `share`, for mixtures.
    #[must_use]
    pub fn scaled(mut self, share: f64) -> Self {
        self.scale = share;
        self
    }

    /// The lobes around a packet's directions.
    pub fn evaluate(&self, packet: &Packet, scratch: &mut Scratch) -> Shares {
        self.start_at_the_root(scratch);
        self.cut_rest(packet, scratch);
        self.sum_leaves(packet, scratch)
    }

    /// Collects the leaves that [`Self::evaluate_far`] left to directions: for `packet`, and for all that
    /// share its cut.
    pub(crate) fn cut_rest(&self, packet: &Packet, scratch: &mut Scratch) {
        with_radial!(self.kernel.shape, kernel => {
            self.arch.dispatch(Cut::<_, false> { adaptive: self, kernel, packet, scratch });
        });
    }

    /// The light of the collected leaves in the lobes around a packet's directions.
    pub(crate) fn sum_leaves(&self, packet: &Packet, scratch: &Scratch) -> Shares {
        let covariance = &[[0.0; LANES]; 6];
        with_radial!(self.kernel.shape, kernel => {
            self.arch.dispatch(Sum::<_, false> { adaptive: self, kernel, packet, covariance, scratch })
        })
    }

    /// Whether [`Self::evaluate_far`] takes these lobes.
    pub(crate) const fn takes_footprints(&self) -> bool {
        matches!(self.kernel.shape, KernelShape::Ggx(_))
    }

    /// The mean lobes over `footprints` of all light that is so far away that they need not be resolved.
    ///
    /// # Panics
    /// If the lobes are not GGX's.
    pub(crate) fn evaluate_far(&self, footprints: &Footprints, scratch: &mut Scratch) -> Shares {
        let KernelShape::Ggx(kernel) = self.kernel.shape else { unreachable!("footprints of other lobes") };
        self.start_at_the_root(scratch);
        let Footprints { packet, covariance } = footprints;
        self.arch.dispatch(Cut::<_, true> { adaptive: self, kernel, packet, scratch });
        self.arch.dispatch(Sum::<_, true> { adaptive: self, kernel, packet, covariance, scratch })
    }

    fn start_at_the_root(&self, scratch: &mut Scratch) {
        let level = u8::try_from(self.cells.levels.len() - 1).expect("few levels");
        scratch.frontier.clear();
        scratch.frontier.push(Visit { level, cells: ALL, i: 0, j: 0 });
    }

    /// Collects the coarsest cells whose intervals are narrow enough for the directions of the packet, from
    /// the frontier on. FAR: makes a new frontier of the cells that are small beside the footprints.
    #[inline(always)]
    fn cut<R: Radial, const FAR: bool>(&self, kernel: R, packet: &Packet, scratch: &mut Scratch) {
        let cells = self.cells;
        let tolerance = self.tolerance as f32;
        scratch.leaves.clear();
        scratch.slack = [0.0; 3];
        scratch.stack.clear();
        scratch.stack.extend_from_slice(&scratch.frontier);
        if FAR {
            scratch.frontier.clear();
        }
        while !scratch.stack.is_empty() {
            let rest = scratch.stack.len().saturating_sub(QUADS);
            let mut visits = [Visit::default(); QUADS];
            let count = scratch.stack.len() - rest;
            visits[..count].copy_from_slice(&scratch.stack[rest..]);
            scratch.stack.truncate(rest);
            let places = visits.map(|Visit { level, i, j, .. }| {
                let place = cells.levels[usize::from(level)];
                place.first + j * place.width + i
            });
            let quads = places.map(|place| &cells.quads[place as usize]);
            let errors = expected_errors(kernel, packet, &quads, self.weights);
            let visited = quads.iter().zip(places).zip(&errors).zip(visits);
            for (((quad, place), errors), visit) in visited.take(count) {
                let level = visit.level;
                let mut left = 0;
                for k in 0..4 {
                    // Cells without luminance contribute nothing.
                    if quad.luminance[k] == 0.0 || visit.cells & (1 << k) == 0 {
                        continue;
                    }
                    let (i, j) = (2 * visit.i + (k as u32 & 1), 2 * visit.j + (k as u32 >> 1));
                    if errors[k] > tolerance {
                        if level > 0 && (!FAR || quad.radius[k] > COARSE * packet.reach) {
                            scratch.stack.push(Visit { level: level - 1, cells: ALL, i, j });
                            continue;
                        }
                        if FAR {
                            left |= 1 << k;
                            continue;
                        }
                        if self.refine(kernel, (i, j), packet, scratch) {
                            continue;
                        }
                    }
                    scratch.leaves.push(Leaf::new(quad, place, k, packet.axis));
                }
                if FAR && left != 0 {
                    scratch.frontier.push(Visit { cells: left, ..visit });
                }
            }
        }
        if let (Finest::Source(members), Some(light), false) =
            (&cells.finest, &self.light, scratch.refined.is_empty())
        {
            let source = LitTexels { members, light, least: Vec3::from(cells.least) };
            subtexel::refine_members((&source, self.weights, self.tolerance), kernel, packet, scratch);
        }
    }

    /// Adds pieces of the finest cell (`i`, `j`) to the leaves, or the cell to those to be refined, if it can
    /// be subdivided.
    #[inline(always)]
    fn refine<R: Radial>(
        &self,
        kernel: R,
        (i, j): (u32, u32),
        packet: &Packet,
        scratch: &mut Scratch,
    ) -> bool {
        match (&self.cells.finest, &self.light) {
            (Finest::Texels { n, reconstruction, energies }, _) => {
                let spread = Spread { n: *n, reconstruction: *reconstruction, energies };
                let limits = (&spread, self.weights, self.tolerance);
                subtexel::refine(limits, kernel, (i, j), packet, scratch);
                true
            }
            (Finest::Source(_), Some(_)) => {
                scratch.refined.push((i, j));
                true
            }
            _ => false,
        }
    }

    /// Sums the leaves for every lane. SPREAD: the directions are centroids of footprints with `covariance`.
    #[inline(always)]
    fn sum<R: Radial, const SPREAD: bool>(
        &self,
        kernel: R,
        (packet, covariance): (&Packet, &Covariance),
        scratch: &Scratch,
    ) -> Shares {
        let mut sums = [[0.0_f32; LANES]; 3];
        // How far the luminance's true value can lie above and below the estimate; how far a channel's can.
        let (mut above, mut below) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        let mut off = [[0.0_f32; LANES]; 3];
        let mut tinted = TintSums::default();
        // Energy with s above 1/4 for some lane, and not beyond the horizon.
        let mut grazing = [0.0_f32; 3];
        // Intervals of some leaves at a time: none waits for the sums of another.
        let mut batch: [Series; SUMMED_TOGETHER] = Default::default();
        for leaves in scratch.leaves.chunks(SUMMED_TOGETHER) {
            for (leaf, series) in leaves.iter().zip(&mut batch) {
                let [lx, ly, lz] = leaf.offset;
                let [xx, yy, zz, yz, zx, xy] = leaf.covariance;
                let trace = xx + yy + zz;
                let radius = if SPREAD { leaf.radius + packet.reach } else { leaf.radius };
                let (distance, reach) = ((lx * lx + ly * ly + lz * lz).sqrt(), packet.radius + radius);
                if (distance + reach > 0.999) & (distance - reach < 1.415) {
                    grazing.iter_mut().zip(leaf.energy).for_each(|(sum, energy)| *sum += energy);
                }
                // Whether s reaches the horizon for any lane.
                let across = 0.25 * (distance + reach) * (distance + reach) > 0.499;
                for k in 0..LANES {
                    let (x, y, z) = (lx - packet.x[k], ly - packet.y[k], lz - packet.z[k]);
                    let squared = x.times_plus(x, y.times_plus(y, z * z));
                    // The covariance applied to (x, y, z) on both sides, row by row.
                    let mut along = x.times_plus(
                        xx.times_plus(x, 2.0 * xy.times_plus(y, zx * z)),
                        y.times_plus(yy.times_plus(y, 2.0 * yz * z), zz * z * z),
                    );
                    let mut trace = trace;
                    if SPREAD {
                        let [ux, uy, uz] = applied(covariance, k, [x, y, z]);
                        along += x * ux + y * uy + z * uz;
                        trace += covariance[0][k] + covariance[1][k] + covariance[2][k];
                    }
                    let share = if across {
                        kernel.interval::<true>(squared, trace, along, radius)
                    } else {
                        kernel.interval::<false>(squared, trace, along, radius)
                    };
                    series.estimate[k] = share.estimate;
                    (series.over[k], series.under[k]) =
                        (share.greatest - share.estimate, share.estimate - share.least);
                    (series.slope[k], series.bend[k]) = (share.slope, share.bend);
                    (series.rest[k], series.spread[k]) = (share.rest, share.spread);
                }
            }
            for (leaf, series) in leaves.iter().zip(&batch) {
                let [red, green, blue] = leaf.energy;
                let luminance = LUMINANCE[0] * red + LUMINANCE[1] * green + LUMINANCE[2] * blue;
                // Green's tint follows from those of the others, and may exceed its energy.
                let beside_green = (1.0 / LUMINANCE[1]).times_plus(luminance, -green);
                for k in 0..LANES {
                    let (estimate, over, under) = (series.estimate[k], series.over[k], series.under[k]);
                    let neglected = NEGLIGIBLE_TINT * series.spread[k];
                    let width = over.at_least(under) + neglected;
                    sums[0][k] = red.times_plus(estimate, sums[0][k]);
                    sums[1][k] = green.times_plus(estimate, sums[1][k]);
                    sums[2][k] = blue.times_plus(estimate, sums[2][k]);
                    above[k] = luminance.times_plus(over, above[k]);
                    below[k] = luminance.times_plus(under, below[k]);
                    off[0][k] = red.times_plus(width, off[0][k]);
                    off[1][k] = green.times_plus(width, beside_green.times_plus(neglected, off[1][k]));
                    off[2][k] = blue.times_plus(width, off[2][k]);
                }
            }
            for (leaf, series) in leaves.iter().zip(&batch) {
                if let Some(tints) = self.cells.tints(leaf.cell) {
                    tinted.add::<SPREAD>(leaf, &tints, (packet, covariance), series);
                }
            }
        }
        let Self { cells, scale, .. } = *self;
        let per_integral = scale / self.kernel.integral;
        let rounding = self.kernel.rounding(scratch.leaves.len());
        let grazing = grazing
            .map(|energy| f64::from(energy) * GRAZING_ROUNDING * self.kernel.grazing_slope() * per_integral);
        // Count kernels and products below the least normal number as lost: vector units may flush them.
        let products = f64::from(f32::MIN_POSITIVE) * scratch.leaves.len() as f64;
        let lit = cells.mean_luminance() > 0.0;
        // What no leaf holds is added once, by the directions.
        let least = if SPREAD { [0.0; 3] } else { cells.least };
        let lost = if SPREAD { 0.0 } else { cells.omitted };
        let fixed: [f64; 3] = std::array::from_fn(|c| {
            let energy = 4.0 * PI * cells.mean[c];
            let underflow = (f64::from(self.kernel.underflow()) * energy + products) * per_integral;
            let omitted = if lit { scale * lost + underflow } else { 0.0 };
            // The least radiance and every E - c w are float32 differences, in error by 2^-22 of the whole;
            // omitted residues add twice that.
            scratch.slack[c] * per_integral + grazing[c] + 7.2e-7 * scale * f64::from(least[c]) + omitted
        });
        let [red_share, _, blue_share] = LUMINANCE.map(|share| f64::from(share) / f64::from(LUMINANCE[1]));
        let mut shares = Shares {
            radiance: [[0.0; 3]; LANES],
            bound: [Bound::default(); LANES],
            leaves: scratch.leaves.len(),
        };
        for k in 0..LANES {
            let [red, blue] = tinted.light.map(|light| f64::from(light[k]));
            let [red_off, blue_off] = tinted.error.map(|error| f64::from(error[k]));
            // The luminance's tint is zero.
            let tints = [red, -(red_share * red + blue_share * blue), blue];
            let tints_off = [red_off, red_share * red_off + blue_share * blue_off, blue_off];
            let lobe: [f64; 3] =
                std::array::from_fn(|c| (f64::from(sums[c][k]) + tints[c]).max(0.0) * per_integral);
            shares.radiance[k] = std::array::from_fn(|c| (scale * f64::from(least[c]) + lobe[c]) as f32);
            // Tints are rounded like centroids.
            let channels = std::array::from_fn(|c| {
                let width = f64::from(off[c][k]) + tints_off[c];
                let rounded = rounding * (lobe[c] + (f64::from(sums[c][k]) + tints[c].abs()) * per_integral);
                (width * per_integral + rounded + fixed[c]) as f32
            });
            let width = f64::from(above[k].max(below[k])) * per_integral;
            let luminance = width + rounding * exact_luminance(lobe) + exact_luminance(fixed);
            shares.bound[k] = Bound { channels, luminance: luminance as f32 };
        }
        shares
    }
}
