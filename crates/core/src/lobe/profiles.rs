//! The radial kernel of each lobe.

use super::radial::{Expansion, Interval, Radial, reciprocals, share_in_front};
use crate::common::vector::{Extremes as _, Fused as _};

/// peak (1 - 2 s) w^2, w = 1/(1 + steep s), peak = 1/(pi alpha^2), steep = (1 - alpha^2)/alpha^2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ggx {
    pub(crate) peak: f32,
    pub(crate) steep: f32,
}

impl Radial for Ggx {
    const SMOOTH: bool = true;

    #[inline(always)]
    fn value(self, s: f32) -> f32 {
        let [value] = self.expansion([s]).values;
        value
    }

    #[inline(always)]
    fn expansion<const N: usize>(self, s: [f32; N]) -> Expansion<N> {
        // At most 1/alpha^2 each: the product of three stays within the range of float32.
        let w = reciprocals(s.map(|s| self.steep.times_plus(s, 1.0)));
        let scaled = w.map(|w| self.peak * w * w);
        let lambert = s.map(|s| s.times_plus(-2.0, 1.0));
        let steep_w = self.steep * w[N - 1];
        Expansion {
            values: std::array::from_fn(|k| scaled[k] * lambert[k].at_least(0.0)),
            slope: -2.0 * scaled[N - 1] * steep_w.times_plus(lambert[N - 1], 1.0),
            curvature: scaled[N - 1] * steep_w * (6.0 * steep_w).times_plus(lambert[N - 1], 8.0),
        }
    }

    /// By one division.
    #[inline(always)]
    fn stepped(self, s: f32, [more, less]: [f32; 2], [down, up]: [f32; 2]) -> [f32; 2] {
        let (wide, lambert) = (self.steep.times_plus(s, 1.0), s.times_plus(-2.0, 1.0));
        let reach = |step: f32, length: f32| length.times_plus(wide, self.steep * step).at_least(length);
        let [per_down, per_up] = reciprocals([reach(more, down), reach(-less, up)]);
        let value = |step: f32, length: f32, per_reach: f32| {
            let lambert = length.times_plus(lambert, -2.0 * step) * per_reach;
            self.peak * (length * per_reach) * lambert.at_least(0.0)
        };
        [value(more, down, per_down), value(-less, up, per_up)]
    }

    #[inline(always)]
    fn scale(self, s: f32) -> f32 {
        // At alpha = 1 the kernel is a straight line.
        s + 1.0 / self.steep.at_least(1e-6)
    }

    #[inline(always)]
    fn kink(self) -> f32 {
        let w = 1.0 / (1.0 + 0.5 * self.steep);
        2.0 * self.peak * w * w
    }

    #[inline(always)]
    fn worst_distance(self, near: f32, far: f32) -> f32 {
        // distance/(s + alpha^2) is greatest at distance 2 alpha. Avoids `clamp`, whose check prevents
        // vectorisation.
        (1.2 / (self.steep + 1.0).sqrt()).at_least(near).at_most(far)
    }
}

/// (1 - 2 s)^n, n at least 2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Phong {
    pub(super) exponent: f32,
}

impl Radial for Phong {
    const SMOOTH: bool = true;

    #[inline(always)]
    fn value(self, s: f32) -> f32 {
        // By the logarithm: 1 - 2 s would round away a sharp lobe.
        if s < 0.5 { (self.exponent * (-2.0 * s).ln_1p()).exp() } else { 0.0 }
    }

    #[inline(always)]
    fn slope(self, s: f32, value: f32) -> f32 {
        -2.0 * self.exponent * value / (1.0 - 2.0 * s).at_least(1e-3)
    }

    #[inline(always)]
    fn curvature(self, s: f32, value: f32) -> f32 {
        let cosine = (1.0 - 2.0 * s).at_least(1e-3);
        4.0 * self.exponent * (self.exponent - 1.0) * value / (cosine * cosine)
    }

    #[inline(always)]
    fn scale(self, s: f32) -> f32 {
        1.44 * (1.0 - 2.0 * s).at_least(1e-3) / self.exponent
    }
}

/// (1 - 2 s)^n, n below 2: not smooth, and for n = 0 a step at the horizon.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WidePhong {
    pub(super) exponent: f32,
}

impl Radial for WidePhong {
    const SMOOTH: bool = false;

    #[inline(always)]
    fn value(self, s: f32) -> f32 {
        if s < 0.5 { (1.0 - 2.0 * s).powf(self.exponent) } else { 0.0 }
    }

    #[inline(always)]
    fn widest_spread(self, near: f32, far: f32, radius: f32) -> f32 {
        // k is steepest at one end, at the horizon (exponents below 1), or where d (1 - d^2/2)^(n-1) is
        // greatest.
        let horizon = std::f32::consts::SQRT_2;
        let steepest = if self.exponent > 1.0 { 1.0 / (self.exponent - 0.5).sqrt() } else { horizon };
        let at = |distance: f32| {
            let distance = distance.at_least(near).at_most(far);
            let (low, high) = ((distance - radius).at_least(0.0), distance + radius);
            self.spread(0.25 * low * low, (0.25 * high * high).at_most(1.0))
        };
        at(near).at_least(at(far)).at_least(at(horizon)).at_least(at(steepest))
    }
}

/// 1 up to the edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    pub(super) edge: f32,
}

impl Radial for Cone {
    const SMOOTH: bool = false;

    #[inline(always)]
    fn value(self, s: f32) -> f32 {
        if s <= self.edge { 1.0 } else { 0.0 }
    }
}

/// 1 - 2 s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cosine;

impl Radial for Cosine {
    const SMOOTH: bool = true;

    #[inline(always)]
    fn value(self, s: f32) -> f32 {
        (1.0 - 2.0 * s).at_least(0.0)
    }

    fn slope(self, _: f32, _: f32) -> f32 {
        -2.0
    }

    fn scale(self, _: f32) -> f32 {
        f32::INFINITY
    }

    fn kink(self) -> f32 {
        2.0
    }
}

/// (2 s)^p (1 - 2 s), p at least 1/2: rises to s = p/(2 p + 2) and falls to the horizon.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Charlie {
    pub(super) power: f32,
    /// k at its peak.
    pub(super) crest: f32,
    /// x = 2 s where the slope of the bend vanishes, below 0 if it does nowhere, and the bend there.
    pub(super) turn: f32,
    pub(super) turning: f32,
}

/// Value lost where x^p is below the range of [`power`].
pub(crate) const NOTHING: f32 = 1e-30;

impl Charlie {
    /// With exponent `power`.
    pub(super) fn new(power: f32) -> Self {
        let turn = (power - 2.0) / (power + 1.0);
        let mut kernel = Self { power, crest: 0.0, turn, turning: 0.0 };
        kernel.crest = kernel.value(0.5 * power / (power + 1.0));
        if turn > 0.0 {
            kernel.turning = kernel.bend(turn, kernel.rise(turn));
        }
        kernel
    }

    /// x^p at x = 2 s.
    #[inline(always)]
    fn rise(self, x: f32) -> f32 {
        power(x, self.power)
    }

    /// k'' / 4 at x = 2 s, with `rise` the power: p x^(p-2) (p - 1 - (p + 1) x).
    #[inline(always)]
    fn bend(self, x: f32, rise: f32) -> f32 {
        let p = self.power;
        p * rise * (p + 1.0).times_plus(-x, p - 1.0) / (x * x)
    }
}

impl Radial for Charlie {
    const SMOOTH: bool = true;
    const SPLIT: bool = false;

    #[inline(always)]
    fn value(self, s: f32) -> f32 {
        self.rise(2.0 * s) * (1.0 - 2.0 * s).at_least(0.0)
    }

    #[inline(always)]
    fn scale(self, s: f32) -> f32 {
        // From the third derivative of a power.
        2.88 * s / (1.0 + self.power)
    }

    #[inline(always)]
    fn third_order(self, s: f32, _: f32, moment: f32) -> f32 {
        // p (p - 1) x^(p-3) (p - 2 - (p + 1) x) of x, with the last factor kept away from zero.
        let (p, x) = (self.power, 2.0 * s);
        let third = p * (p - 1.0) * self.rise(x) * (((p - 2.0) - (p + 1.0) * x).abs() + 1.0);
        (third / (3.0 * x * x * x)).abs() * moment
    }

    fn spread(self, low: f32, high: f32) -> f32 {
        let peak = 0.5 * self.power / (self.power + 1.0);
        let (least, greatest) = (self.value(low).at_most(self.value(high)), peak.at_least(low).at_most(high));
        self.value(greatest) - least
    }

    /// With h the kernel's own formula, negative beyond the horizon, k = h + max(0, -h). The mean of h is
    /// h(t) + k''/2 V with k'' between its extremes over the cell's reach (Taylor). The mean of max(0, -h)
    /// lies between its tangent at the horizon and x_b^p times the mean of max(0, x - 1), which is at most
    /// sqrt(V + (t - 1/2)^2) + t - 1/2 (Scarf 1958). The extremes of k itself also bound its mean.
    #[inline(always)]
    fn interval<const ACROSS: bool>(self, squared: f32, trace: f32, along: f32, radius: f32) -> Interval {
        let p = self.power;
        let distance = squared.sqrt();
        let near = (distance - radius).at_least(0.0);
        let far = distance + radius;
        let (low, high) = (0.25 * near * near, (0.25 * far * far).at_most(1.0));
        let s = (0.25 * (squared + trace)).at_most(high);
        let [a, b, t] = [2.0 * low, 2.0 * high, 2.0 * s];
        let [rise_a, rise_b, rise_t] = [self.rise(a), self.rise(b), self.rise(t)];
        let [at_a, at_b] = [rise_a * (1.0 - a).at_least(0.0), rise_b * (1.0 - b).at_least(0.0)];
        let peak = p / (p + 1.0);
        let crest = if (a < peak) & (peak < b) { self.crest } else { at_a.at_least(at_b) };
        let trough = at_a.at_most(at_b);

        let (tangential, radial) = (along.at_least(0.0).sqrt(), 0.5 * trace.sqrt() * radius);
        let most = 0.25 * (tangential + radial) * (tangential + radial);
        let least = 0.25 * (tangential - radial).at_least(0.0) * (tangential - radial).at_least(0.0);
        // The bend is extreme at an end or where its own slope vanishes.
        let [bend_a, bend_b] = [self.bend(a, rise_a), self.bend(b, rise_b)];
        let turning = if (a < self.turn) & (self.turn < b) { self.turning } else { bend_a };
        let steepest = 2.0 * bend_a.at_least(bend_b).at_least(turning);
        let flattest = 2.0 * bend_a.at_most(bend_b).at_most(turning);
        let at_mean = rise_t * (1.0 - t);
        let upper = at_mean + if steepest > 0.0 { steepest * most } else { steepest * least };
        let lower = at_mean + if flattest > 0.0 { flattest * least } else { flattest * most };
        let beyond = s - 0.5;
        let over = if b > 1.0 { rise_b * ((most + beyond * beyond).sqrt() + beyond) } else { 0.0 };
        let under = (2.0 * beyond).at_least(0.0);
        // The second derivative is unbounded at s = 0.
        let sharp = a > 0.0;
        let greatest = if sharp { crest.at_most(upper + over) } else { crest }.at_least(0.0) + NOTHING;
        let least = (if sharp { trough.at_least(lower + under) } else { trough } - NOTHING)
            .at_least(0.0)
            .at_most(greatest);

        let half_width = 0.866 * tangential;
        let share = if b <= 1.0 { 1.0 } else { share_in_front(-beyond, half_width) };
        let across = (half_width - beyond.abs()).at_least(0.0);
        let gain = 2.0 * across * across / (4.0 * half_width).at_least(1e-6);
        // Beyond the horizon k is 0, and as steep and bent as at it.
        let front = t.at_most(1.0).at_least(1e-6);
        let rise = rise_t.at_most(1.0);
        let bend = 2.0 * self.bend(front, rise) * share;
        let slope = 2.0 * rise * (p - (p + 1.0) * front) / front + 2.0 * (1.0 - share);
        let estimate = (at_mean.at_least(0.0) + 0.25 * bend * along + gain).at_least(least).at_most(greatest);
        let spread = 0.5 * (crest - trough);
        // In front of the horizon, the series' error is that of its bend.
        let farther = (s - low).at_least(high - s);
        let third = 0.5 * (steepest - flattest) * farther * farther
            + 0.25
                * steepest.abs().at_least(flattest.abs())
                * radius
                * radius
                * radius
                * (distance + 0.25 * radius);
        let rest = if sharp & (b <= 1.0) { third } else { f32::INFINITY };
        Interval { least, greatest, estimate, slope, bend, rest, spread }
    }

    #[inline(always)]
    fn worst_distance(self, near: f32, far: f32) -> f32 {
        // At the horizon, where the bend is sharp and ends; for a wide lobe, where it begins.
        let horizon = std::f32::consts::SQRT_2.at_least(near).at_most(far);
        if (self.power < 2.0) & (far < 1.0) { near } else { horizon }
    }
}

/// x^p to a relative (2 p (2 + |log2(x)|) + 4) 2^-24 where it is above 2^-100, and below 1.1e-30 elsewhere,
/// for x in [0, 2]. Branch-free, so that it vectorises, unlike the standard library's.
#[inline(always)]
fn power(x: f32, p: f32) -> f32 {
    // x = 2^whole m, with m within a factor of sqrt(2) of 1; log(m) by its series in (m - 1)/(m + 1).
    let bits = x.to_bits();
    let whole = (bits.wrapping_sub(0x3f35_04f3) as i32) >> 23;
    let m = f32::from_bits(bits.wrapping_sub((whole as u32) << 23));
    let t = (m - 1.0) / (m + 1.0);
    let u = t * t;
    let series = u.times_plus(2.0 / 9.0, 2.0 / 7.0);
    let series = u.times_plus(u.times_plus(series, 0.4), 2.0 / 3.0);
    let series = u.times_plus(series, 2.0);
    let log2 = (t * series).times_plus(std::f32::consts::LOG2_E, whole as f32);
    // 2^y, with the fraction of y by the exponential series.
    let y = (p * log2).at_least(-120.0);
    // Adding and subtracting 1.5 * 2^23 rounds to a whole number.
    let rounded = (y + 12_582_912.0) - 12_582_912.0;
    let z = (y - rounded) * std::f32::consts::LN_2;
    let fraction = z.times_plus(1.0 / 5040.0, 1.0 / 720.0);
    let fraction = z.times_plus(fraction, 1.0 / 120.0);
    let fraction = z.times_plus(fraction, 1.0 / 24.0);
    let fraction = z.times_plus(fraction, 1.0 / 6.0);
    let fraction = z.times_plus(fraction, 0.5);
    let fraction = z.times_plus(z.times_plus(fraction, 1.0), 1.0);
    fraction * f32::from_bits(((rounded as i32 + 127) as u32) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_and_curvatures_are_those_of_phongs_values() {
        for exponent in [2.0_f32, 3.0, 8.0] {
            let kernel = Phong { exponent };
            for s in [0.1_f32, 0.2, 0.3, 0.4] {
                let (n, rest) = (f64::from(exponent), 1.0 - 2.0 * f64::from(s));
                let value = kernel.value(s);
                let near = |own: f32, exact: f64| (f64::from(own) / exact - 1.0).abs() < 1e-4;
                assert!(near(kernel.slope(s, value), -2.0 * n * rest.powf(n - 1.0)), "{n} at {s}");
                let curvature = 4.0 * n * (n - 1.0) * rest.powf(n - 2.0);
                assert!(near(kernel.curvature(s, value), curvature), "{n} at {s}");
            }
        }
    }

    #[test]
    fn powers_are_those_of_the_standard_library() {
        let mut compared = 0;
        for p in [0.5_f32, 0.77, 1.0, 2.0, 7.3, 50.0] {
            for k in 1..4000_i16 {
                let x = f32::from(k) / 2000.0;
                let exact = f64::from(x).powf(f64::from(p));
                if exact < 1e-30 {
                    assert!(power(x, p) < 1.1e-30, "{x}^{p}");
                    continue;
                }
                let off = (f64::from(power(x, p)) / exact - 1.0).abs();
                let log = f64::from(x).log2().abs();
                let bound = (2.0 * f64::from(p) * (2.0 + log) + 4.0) / f64::from(1_u32 << 24);
                assert!(off <= bound, "{x}^{p}: off by {off:e}, {bound:e} promised");
                compared += 1;
            }
            assert!(power(0.0, p) < 1e-18, "0^{p} is {}", power(0.0, p));
        }
        assert!(compared > 15_000, "{compared} powers");
    }
}
