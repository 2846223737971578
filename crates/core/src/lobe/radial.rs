//! Radial kernels, and intervals of their means over cells of energy.

use crate::common::vector::{Extremes as _, Fused as _};

/// The reciprocals of `x` by one division (Montgomery's trick); the last is the most accurate.
#[inline(always)]
pub(super) fn reciprocals<const N: usize>(x: [f32; N]) -> [f32; N] {
    let mut before = [1.0; N];
    for k in 1..N {
        before[k] = before[k - 1] * x[k - 1];
    }
    let mut rest = 1.0 / (before[N - 1] * x[N - 1]);
    let mut out = [0.0; N];
    for k in (0..N).rev() {
        out[k] = rest * before[k];
        rest *= x[k];
    }
    out
}

/// A kernel of s; decreasing, except for [`Charlie`], which has its own intervals.
pub(crate) trait Radial: Copy {
    /// Whether it is convex with a decreasing second derivative up to the horizon s = 1/2 and 0 beyond: the
    /// condition of the sharp bounds from mean and variance.
    const SMOOTH: bool;

    /// Whether the error from the kink at the horizon is estimated separately.
    const SPLIT: bool = true;

    /// k at `s`.
    fn value(self, s: f32) -> f32;

    /// k at several values of s, and its derivatives at the last; GGX takes one division for all.
    #[inline(always)]
    fn expansion<const N: usize>(self, s: [f32; N]) -> Expansion<N> {
        let values = s.map(|s| self.value(s));
        let (s, value) = (s[N - 1], values[N - 1]);
        Expansion { values, slope: self.slope(s, value), curvature: self.curvature(s, value) }
    }

    /// k at `s` + `more`/`down` and at `s` - `less`/`up`.
    #[inline(always)]
    fn stepped(self, s: f32, [more, less]: [f32; 2], [down, up]: [f32; 2]) -> [f32; 2] {
        self.expansion([s + more / down, s - less / up]).values
    }

    /// k' at `s` in front of the horizon, where k is `value`; 0 where k is not smooth.
    fn slope(self, s: f32, value: f32) -> f32 {
        let _ = (s, value);
        0.0
    }

    /// k'' there.
    fn curvature(self, s: f32, value: f32) -> f32 {
        let _ = (s, value);
        0.0
    }

    /// Jump of k' at the horizon.
    fn kink(self) -> f32 {
        0.0
    }

    /// Length scale t of k around `s`: |k'''| is about 24 k/t^3, as in a tail of t^-2. Zero where k is not
    /// smooth.
    fn scale(self, s: f32) -> f32 {
        let _ = s;
        0.0
    }

    /// |k'''|/24 around `s`, where k is `value`, times a third `moment`. Either factor alone may exceed the
    /// range of float32.
    #[inline(always)]
    fn third_order(self, s: f32, value: f32, moment: f32) -> f32 {
        let scale = self.scale(s);
        value * moment / (scale * scale * scale)
    }

    /// The mean of k over a cell of unit energy, see [`interval`].
    #[inline(always)]
    fn interval<const ACROSS: bool>(self, squared: f32, trace: f32, along: f32, radius: f32) -> Interval {
        interval::<Self, ACROSS>(self, squared, trace, along, radius)
    }

    /// Variation of k between the squared distances 4 `low` and 4 `high`.
    fn spread(self, low: f32, high: f32) -> f32 {
        self.value(low) - self.value(high)
    }

    /// The greatest variation of k within `radius` of a distance between `near` and `far`. The default is the
    /// variation between the ends, which is exact for one jump.
    fn widest_spread(self, near: f32, far: f32, radius: f32) -> f32 {
        let (near, far) = ((near - radius).at_least(0.0), far + radius);
        self.spread(0.25 * near * near, (0.25 * far * far).at_most(1.0))
    }

    /// The distance between `near` and `far` at which a cell's relative error is greatest.
    fn worst_distance(self, near: f32, far: f32) -> f32 {
        // The nearest, unless only a far horizon matters.
        let _ = far;
        near
    }
}

/// Values of k, and its derivatives at the last place.
pub(crate) struct Expansion<const N: usize> {
    pub(super) values: [f32; N],
    pub(super) slope: f32,
    pub(super) curvature: f32,
}

/// Bounds and estimate of the mean of k over a cell of unit energy.
#[derive(Clone, Copy)]
pub(crate) struct Interval {
    /// Least possible value.
    pub(crate) least: f32,
    /// Greatest possible value.
    pub(crate) greatest: f32,
    /// Most likely value.
    pub(crate) estimate: f32,
    /// Slope and half the second derivative of k around the mean of s, faded out across the horizon.
    pub(crate) slope: f32,
    pub(crate) bend: f32,
    /// What light of zero total can add at most per unit of its variation: to the terms of `slope` and `bend`
    /// (not a number or infinite where the series is of no use), and without them.
    pub(crate) rest: f32,
    pub(crate) spread: f32,
}

/// Interval of the mean of k over a cell of unit energy. `squared` is the squared distance of its centroid
/// from R, `trace` its covariance's trace, `along` the covariance applied to R - centroid on both sides,
/// `radius` its reach. ACROSS must be true if it may reach beyond the horizon. See [`crate::cpu::adaptive`]
/// for the derivation.
#[inline(always)]
pub(crate) fn interval<R: Radial, const ACROSS: bool>(
    kernel: R,
    squared: f32,
    trace: f32,
    along: f32,
    radius: f32,
) -> Interval {
    let distance = squared.sqrt();
    let near = (distance - radius).at_least(0.0);
    let far = distance + radius;
    let (low, high) = (0.25 * near * near, (0.25 * far * far).at_most(1.0));
    let s = 0.25 * (squared + trace);
    // Beyond the horizon k is 0, and as steep and bent as at it.
    let front = if ACROSS & R::SMOOTH { s.at_most(0.5) } else { s };
    let Expansion { values: [nearest, farthest, value], slope, curvature } =
        kernel.expansion([low, high, front]);
    let spread = 0.5 * (nearest - farthest);
    if !R::SMOOTH {
        return Interval {
            least: farthest,
            greatest: nearest,
            estimate: value,
            slope: 0.0,
            bend: 0.0,
            rest: spread,
            spread,
        };
    }
    // s - low and high - s, computed without cancellation.
    let down = if distance > radius {
        0.25 * radius.times_plus(distance.times_plus(2.0, -radius), trace)
    } else {
        s
    };
    let up = (0.25 * radius.times_plus(distance.times_plus(2.0, radius), -trace)).at_least(1e-6 * down);
    let (tangential, radial) = (along.at_least(0.0).sqrt(), 0.5 * trace.sqrt() * radius);
    let most = 0.25 * (tangential + radial) * (tangential + radial);
    let least = 0.25 * (tangential - radial).at_least(0.0) * (tangential - radial).at_least(0.0);
    // The variance is at most that of light at both ends.
    let (more, less) = (most.at_most(down * up), least.at_most(down * up));
    let [inner, outer] = kernel.stepped(s, [more, less], [down, up]);
    let (above, below) = (down.times_plus(down, more), up.times_plus(up, less));
    // Reciprocals of vanishing products overflow; there k is constant to float32.
    let sharp = (down * up).at_most(above).at_most(below) > 1e-36;
    let (share_above, share_below) = (more / above, less / below);
    // k minus its series around the mean decreases over the reach, as k'' does: half of what it loses.
    let series_error = |slope: f32, bend: f32| {
        let length = up + down;
        0.5 * length.times_plus((up - down).times_plus(bend, slope), nearest - farthest)
    };
    // What the radial part of the variance, which the quadrupole leaves out, adds to the second order.
    let cubed = 0.25 * radius * radius * radius;
    let radial_error = |bend: f32| cubed * (0.25 * radius + distance) * bend;
    // Differences are rounded.
    let rounding = 5e-7 * nearest;
    if !ACROSS {
        let greatest = if sharp { share_above.times_plus(nearest - inner, inner) } else { nearest };
        let least =
            if sharp { share_below.times_plus(farthest - outer, outer) } else { farthest }.at_most(greatest);
        let estimate = (0.125 * curvature).times_plus(along, value).at_least(least).at_most(greatest);
        let bend = 0.5 * curvature;
        let rest = series_error(slope, bend).at_least(0.0) + radial_error(bend) + rounding;
        return Interval { least, greatest, estimate, slope, bend, rest, spread };
    }
    // Split k into a hinge at the horizon and a smooth rest; a cell in front of the horizon needs no hinge.
    let kink = if high < 0.5 { 0.0 } else { kernel.kink() };
    let hinge = |s: f32| kink * (0.5 - s).at_least(0.0);
    let (inner, highest) = (inner - hinge(s + more / down), nearest - hinge(low));
    let (outer, lowest) = (outer - hinge(s - less / up), farthest - hinge(high));
    let before = 0.5 - s;
    let deviation = (more + before * before).sqrt();
    // Differences of hinges are rounded at the precision of the greater one.
    let rounded = 5e-7 * kink;
    let greatest = if sharp { inner + share_above * (highest - inner) } else { highest }
        + 0.5 * kink * (deviation + before)
        + rounded;
    let least = (if sharp { outer + share_below * (lowest - outer) } else { lowest } + hinge(s) - rounded)
        .at_least(0.0)
        .at_most(greatest);
    // For energy spread evenly over s: its share in front of the horizon, and the gain from the kink.
    let half_width = 0.866 * tangential;
    let share = if high < 0.5 { 1.0 } else { share_in_front(before, half_width) };
    let across = (half_width - before.abs()).at_least(0.0);
    let gain = kink * across * across / (4.0 * half_width).at_least(1e-6);
    let bend = 0.5 * curvature * share;
    let estimate = (value + 0.25 * bend * along + gain).at_least(least).at_most(greatest);
    // The series of k in front of the horizon has this error; near it and beyond, that of k itself serves.
    // The terms that are used differ.
    let [front_slope, front_bend] = if s < 0.4995 { [slope, 0.5 * curvature] } else { [0.0, 0.0] };
    let slope = slope + kink * (1.0 - share);
    let bent = series_error(front_slope, front_bend).at_least(0.0) + kink * (high - 0.5).at_least(0.0);
    let farther = down.at_least(up);
    let differing =
        0.5 * ((slope - front_slope).abs() * (down + up) + (bend - front_bend).abs() * farther * farther);
    let rest = bent + differing + radial_error(bend) + rounding;
    Interval { least, greatest, estimate, slope, bend, rest, spread }
}

/// The share in front of the horizon of energy spread evenly over `half_width` of s around a mean `before`
/// it.
#[inline(always)]
pub(super) fn share_in_front(before: f32, half_width: f32) -> f32 {
    (0.5 + 0.5 * before / half_width.at_least(1e-9)).at_least(0.0).at_most(1.0)
}

/// Expected error of the estimate for a cell of unit energy and the worst direction among those within
/// `packet` of an axis at `distance` from its centroid. It selects the cells to split and is not a bound.
/// ACROSS must be true if one may reach beyond the horizon.
#[inline(always)]
pub(crate) fn expected_error<R: Radial, const ACROSS: bool>(
    kernel: R,
    distance: f32,
    radius: f32,
    packet: f32,
    trace: f32,
) -> f32 {
    if !R::SMOOTH {
        // A jump or a steep end may lie anywhere between the packet's nearest and farthest direction.
        return 0.25 * kernel.widest_spread((distance - packet).at_least(0.0), distance + packet, radius);
    }
    let worst = kernel.worst_distance((distance - packet).at_least(0.0), distance + packet);
    // About half of the trace lies along the line to R.
    let along = 0.6 * trace * worst * worst;
    let interval = kernel.interval::<ACROSS>(worst * worst, trace, along, radius);
    let s = 0.25 * (worst * worst + trace);
    let scale = kernel.scale(s);
    let reach = 0.25 * radius * (2.0 * worst + radius);
    // The third-order term E|s - mean|^3 |k'''|/6, where the series converges; otherwise the certain width.
    let moment = 0.25 * (along + 0.25 * trace * radius * radius) * reach;
    let third = kernel.third_order(s, interval.estimate, moment);
    let certain = 0.25 * (interval.greatest - interval.least);
    if !ACROSS {
        return if reach < 0.5 * scale { third } else { certain };
    }
    // Add the uncertainty from the kink, for the direction nearest to it: the gap between Scarf's bound and
    // Jensen's, as such errors have one sign and accumulate; at most the part that reaches over the horizon.
    let (near, far) = ((distance - packet - radius).at_least(0.0), distance + packet + radius);
    let over = (0.25 * far * far - 0.5).at_most(0.5 - 0.25 * near * near).at_least(0.0);
    let variance = 0.25 * trace * distance * distance;
    let apart = ((0.5 - 0.25 * (distance * distance + trace)).abs() - 0.5 * distance * packet).at_least(0.0);
    let bent = 0.5 * variance / ((variance + apart * apart).sqrt() + apart).at_least(1e-12);
    let bent = kernel.kink() * bent.at_most(over);
    if (reach < 0.5 * scale) & (R::SPLIT | (over == 0.0)) { third + bent } else { certain }
}

/// Width of the interval between the extremes of k, for cells whose centroid is not known exactly.
pub(crate) fn first_order_width<R: Radial>(kernel: R, distance: f32, radius: f32, packet: f32) -> f32 {
    let near = (distance - radius - packet).at_least(0.0);
    let far = distance + radius + packet;
    kernel.spread(0.25 * near * near, (0.25 * far * far).at_most(1.0))
}

#[cfg(test)]
mod tests {
    use super::super::profiles::{Charlie, Cosine, Ggx, Phong};
    use super::*;

    const GGX: Ggx = Ggx { peak: 3.536_777, steep: 10.111_111 };

    /// The kernel of [`GGX`], in double precision.
    fn ggx(s: f64) -> f64 {
        let w = 1.0 / (1.0 + f64::from(GGX.steep) * s);
        f64::from(GGX.peak) * w * w * (1.0 - 2.0 * s)
    }

    /// The interval of two equal points at `distance` -+ `radius` from R, on a line through it.
    fn of_two_points<R: Radial, const ACROSS: bool>(kernel: R, distance: f32, radius: f32) -> Interval {
        let (squared, trace) = (distance * distance, radius * radius);
        kernel.interval::<ACROSS>(squared, trace, trace * squared, radius)
    }

    /// Checks intervals of `kernel` against means of `value`, the kernel at a distance, up to rounding of s
    /// and by `precision` of the value.
    fn encloses<R: Radial + std::fmt::Debug>(kernel: R, precision: f64, value: impl Fn(f64) -> f64) {
        for (step, radius) in (20..160_i16).flat_map(|step| [0.004, 0.015, 0.05].map(|r| (step, r))) {
            let distance = f32::from(step) / 100.0;
            let Interval { least, greatest, .. } = of_two_points::<_, true>(kernel, distance, radius);
            let [near, far] = [-radius, radius].map(|off| value(f64::from(distance) + f64::from(off)));
            let (mean, rounding) = (f64::midpoint(near, far), precision * near.max(far) + 5e-8);
            assert!(
                f64::from(least) <= mean + rounding && mean - rounding <= f64::from(greatest),
                "{kernel:?} at {distance}, radius {radius}: {mean} outside {least} to {greatest}"
            );
        }
    }

    #[test]
    fn light_around_the_horizon_is_expected_to_err_by_its_deviation() {
        // Squared distance and trace come to 2: half of the deviation, sqrt(trace) d/2, times the kink.
        let error = expected_error::<Cosine, true>(Cosine, 1.4, 0.2, 0.0, 0.04);
        assert!((error / 0.14 - 1.0).abs() < 0.01, "{error}");
    }

    #[test]
    fn intervals_enclose_the_means_of_two_points() {
        let s = |distance: f64| distance * distance / 4.0;
        encloses(GGX, 1e-6, |distance| ggx(s(distance)).max(0.0));
        encloses(Cosine, 1e-6, |distance| (1.0 - 2.0 * s(distance)).max(0.0));
        for exponent in [2.0_f32, 3.0, 8.0, 50.0] {
            let value = |distance| (1.0 - 2.0 * s(distance)).max(0.0).powf(f64::from(exponent));
            encloses(Phong { exponent }, 1e-5, value);
        }
        for power in [0.6_f32, 1.5, 5.0, 20.0, 50.0] {
            let p = f64::from(power);
            let value = |distance| (2.0 * s(distance)).powf(p) * (1.0 - 2.0 * s(distance)).max(0.0);
            encloses(Charlie::new(power), 1e-6 * (1.0 + p), value);
        }
    }

    #[test]
    fn light_beyond_a_smooth_horizon_adds_nothing() {
        let Interval { slope, bend, .. } = of_two_points::<_, true>(Phong { exponent: 8.0 }, 1.6, 0.05);
        assert_eq!((slope.abs() < 1e-6, bend.abs() < 1e-6), (true, true), "{slope} {bend}");
    }

    #[test]
    fn greatest_means_are_those_of_light_at_the_near_end_and_one_other_place() {
        for step in 2..12_i16 {
            let (distance, radius) = (f32::from(step) / 10.0, 0.1);
            let greatest = f64::from(of_two_points::<_, false>(GGX, distance, radius).greatest);
            let (d, r) = (f64::from(distance), f64::from(radius));
            let (low, s) = ((d - r) * (d - r) / 4.0, (d * d + r * r) / 4.0);
            let deviation = (d * r + r * r / 2.0) / 2.0;
            let farther = (deviation * deviation / (s - low)).min((d + r) * (d + r) / 4.0 - s);
            let share = farther / (farther + s - low);
            let attained = share * ggx(low) + (1.0 - share) * ggx(s + farther);
            assert!((greatest / attained - 1.0).abs() < 1e-4, "at {distance}: {greatest}, not {attained}");
        }
    }

    #[test]
    fn the_rest_of_the_series_is_of_third_order() {
        for step in 5..11_i16 {
            let distance = f32::from(step) / 10.0;
            let [rest, of_half] =
                [0.2, 0.1].map(|radius| of_two_points::<_, false>(GGX, distance, radius).rest);
            assert!(rest > 5.0 * of_half, "at {distance}: {rest} and {of_half}");
        }
    }
}
