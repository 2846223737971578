//! Lobes in the engines' form: float32 kernels of s = |l - R|^2/4, with intervals for cells of energy.

use crate::lobe::{self, Lobe};
use std::f64::consts::PI;

/// A lobe at one roughness.
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    pub(crate) shape: KernelShape,
    /// Integral over the sphere, in closed form.
    pub(crate) integral: f64,
    /// GGX's alpha or its equivalent: the distance over which the kernel changes.
    width: f64,
    /// A leaf's share of the tolerance, relative to lobes with a peak.
    leaf_share: f64,
}

/// k(s) of each lobe, scaled as in [`lobe::kernel`].
#[derive(Clone, Copy, Debug)]
pub(crate) enum KernelShape {
    Ggx(Ggx),
    Phong(Phong),
    WidePhong(WidePhong),
    Cone(Cone),
    Cosine(Cosine),
    Charlie(Charlie),
}

/// KernelShape numbers in `shaders/common/kernel.wgsl`.
#[cfg(feature = "gpu")]
pub(crate) mod shape {
    pub(crate) const GGX: u32 = 0;
    pub(crate) const PHONG: u32 = 1;
    pub(crate) const WIDE_PHONG: u32 = 2;
    pub(crate) const CONE: u32 = 3;
    pub(crate) const COSINE: u32 = 4;
}

/// Evaluates `$body` with `$radial` bound to the kernel that `$shape` holds.
macro_rules! with_radial {
    ($shape:expr, $radial:ident => $body:expr) => {
        match $shape {
            $crate::lobe::kernel::KernelShape::Ggx($radial) => $body,
            $crate::lobe::kernel::KernelShape::Phong($radial) => $body,
            $crate::lobe::kernel::KernelShape::WidePhong($radial) => $body,
            $crate::lobe::kernel::KernelShape::Cone($radial) => $body,
            $crate::lobe::kernel::KernelShape::Cosine($radial) => $body,
            $crate::lobe::kernel::KernelShape::Charlie($radial) => $body,
        }
    };
}
pub(crate) use with_radial;

impl Kernel {
    /// `lobe` at `alpha` in (0, 1].
    #[must_use]
    pub fn new(lobe: Lobe, alpha: f64) -> Self {
        let shape = match lobe {
            Lobe::Ggx => {
                let squared = alpha * alpha;
                KernelShape::Ggx(Ggx {
                    peak: (1.0 / (PI * squared)) as f32,
                    steep: ((1.0 - squared) / squared) as f32,
                })
            }
            Lobe::Phong => {
                let exponent = lobe::phong_exponent(alpha) as f32;
                if exponent >= 2.0 {
                    KernelShape::Phong(Phong { exponent })
                } else {
                    KernelShape::WidePhong(WidePhong { exponent })
                }
            }
            Lobe::Cone => KernelShape::Cone(Cone { edge: lobe::cone_edge(alpha) as f32 }),
            Lobe::Cosine => KernelShape::Cosine(Cosine),
            Lobe::Charlie => KernelShape::Charlie(Charlie::new(lobe::charlie_power(alpha) as f32)),
        };
        let width = match lobe {
            Lobe::Cosine => 1.0,
            // The power multiplies every relative error of s: those of its terms and of the logarithm.
            Lobe::Charlie => 1.0 / (12.0 * lobe::charlie_power(alpha)),
            _ => alpha,
        };
        let leaf_share = match lobe {
            // The narrower the band, the more leaves it takes, and all their errors have the same sign.
            Lobe::Charlie => 1.0 / (1.0 + lobe::charlie_power(alpha)).sqrt(),
            _ => 1.0,
        };
        Self { shape, integral: lobe::kernel_integral(lobe, alpha), width, leaf_share }
    }

    /// Acceptable error of a leaf for a relRMSE of `error`, in units of the kernel, divided by the mean
    /// radiance.
    pub(crate) fn tolerance_per_mean(&self, error: f64) -> f64 {
        leaf_share(error) * self.leaf_share * self.integral
    }

    /// The kernel's integral over the sphere.
    #[must_use]
    pub const fn integral(&self) -> f64 {
        self.integral
    }

    /// The distance over which the kernel changes: alpha, or 1 for the cosine.
    #[cfg(feature = "gpu")]
    pub(crate) const fn width(&self) -> f64 {
        self.width
    }

    /// Number and parameters of the shape in `shaders/common/kernel.wgsl`.
    #[cfg(feature = "gpu")]
    pub(crate) fn parameters(&self) -> (u32, f32, f32) {
        match self.shape {
            KernelShape::Ggx(Ggx { peak, steep }) => (shape::GGX, peak, steep),
            KernelShape::Phong(Phong { exponent }) => (shape::PHONG, exponent, 0.0),
            KernelShape::WidePhong(WidePhong { exponent }) => (shape::WIDE_PHONG, exponent, 0.0),
            KernelShape::Cone(Cone { edge }) => (shape::CONE, edge, 0.0),
            KernelShape::Cosine(Cosine) => (shape::COSINE, 0.0, 0.0),
            KernelShape::Charlie(_) => unreachable!("the engine refuses it"),
        }
    }

    /// The greatest value that single precision flushes to 0: the tails of Phong lobes underflow.
    pub(crate) const fn underflow(&self) -> f32 {
        match self.shape {
            KernelShape::Phong(_) | KernelShape::WidePhong(_) => f32::MIN_POSITIVE,
            KernelShape::Ggx(_) | KernelShape::Cone(_) | KernelShape::Cosine(_) | KernelShape::Charlie(_) => {
                0.0
            }
        }
    }

    /// Greatest |dk/ds| from s = 1/4 to the horizon, for lobes that are smooth there: the effect of an error
    /// of s where k is near 0. Other lobes take the extremes over a leaf.
    pub(crate) fn grazing_slope(&self) -> f64 {
        match self.shape {
            // Convex, so steepest at 1/4: k = (1 - 2 s) g, and g' = -2 steep w g.
            KernelShape::Ggx(Ggx { peak, steep }) => {
                let (peak, steep) = (f64::from(peak), f64::from(steep));
                let w = 1.0 / (1.0 + 0.25 * steep);
                peak * w * w * (2.0 + steep * w)
            }
            KernelShape::Phong(Phong { exponent }) => {
                let n = f64::from(exponent);
                2.0 * n * 0.5_f64.powf(n - 1.0)
            }
            // Charlie's two terms have opposite signs, and neither is above 2.
            KernelShape::Cosine(_) | KernelShape::Charlie(_) => 2.0,
            KernelShape::WidePhong(_) | KernelShape::Cone(_) => 0.0,
        }
    }

    /// Relative rounding error of a sum over `leaves`, without the term of [`Self::grazing_slope`].
    ///
    /// Float32 centroids have an error of 2^-24, and k changes by at most 1/width of itself per unit of
    /// distance (GGX: |dk/d(distance)|/k <= distance/(s + alpha^2) <= 1/alpha). A share takes fewer than 32
    /// roundings and the sum one per leaf, each 2^-24.
    pub(crate) fn rounding(&self, leaves: usize) -> f64 {
        (2.0 / self.width + 32.0 + leaves as f64) / f64::from(1_u32 << 24)
    }
}

/// The reciprocals of `x` by one division (Montgomery's trick); the last is the most accurate.
#[inline(always)]
fn reciprocals<const N: usize>(x: [f32; N]) -> [f32; N] {
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

    /// k at several places, with one division for all.
    #[inline(always)]
    fn values<const N: usize>(self, s: [f32; N]) -> [f32; N] {
        s.map(|s| self.value(s))
    }

    /// The same, and k'' at the last.
    #[inline(always)]
    fn values_and_curvature<const N: usize>(self, s: [f32; N]) -> ([f32; N], f32) {
        (self.values(s), self.curvature(s[N - 1]))
    }

    /// k'' at `s` in front of the horizon.
    fn curvature(self, s: f32) -> f32 {
        let _ = s;
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
        let (near, far) = ((near - radius).max(0.0), far + radius);
        self.spread(0.25 * near * near, (0.25 * far * far).min(1.0))
    }

    /// The distance between `near` and `far` at which a cell's relative error is greatest.
    fn worst_distance(self, near: f32, far: f32) -> f32 {
        // The nearest, unless only a far horizon matters.
        let _ = far;
        near
    }
}

/// peak (1 - 2 s) w^2, w = 1/(1 + steep s), peak = 1/(pi alpha^2), steep = (1 - alpha^2)/alpha^2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ggx {
    peak: f32,
    steep: f32,
}

impl Radial for Ggx {
    const SMOOTH: bool = true;

    #[inline(always)]
    fn value(self, s: f32) -> f32 {
        let [value] = self.values([s]);
        value
    }

    #[inline(always)]
    fn values<const N: usize>(self, s: [f32; N]) -> [f32; N] {
        self.values_and_curvature(s).0
    }

    #[inline(always)]
    fn values_and_curvature<const N: usize>(self, s: [f32; N]) -> ([f32; N], f32) {
        // At most 1/alpha^2 each: the product of three stays within the range of float32.
        let w = reciprocals(s.map(|s| 1.0 + self.steep * s));
        let scaled = w.map(|w| self.peak * w * w);
        let lambert = s.map(|s| 1.0 - 2.0 * s);
        let steep_w = self.steep * w[N - 1];
        (
            std::array::from_fn(|k| scaled[k] * lambert[k].max(0.0)),
            scaled[N - 1] * steep_w * (8.0 + 6.0 * steep_w * lambert[N - 1]),
        )
    }

    #[inline(always)]
    fn scale(self, s: f32) -> f32 {
        // At alpha = 1 the kernel is a straight line.
        s + 1.0 / self.steep.max(1e-6)
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
        (1.2 / (self.steep + 1.0).sqrt()).max(near).min(far)
    }
}

/// (1 - 2 s)^n, n at least 2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Phong {
    exponent: f32,
}

impl Radial for Phong {
    const SMOOTH: bool = true;

    #[inline(always)]
    fn value(self, s: f32) -> f32 {
        // By the logarithm: 1 - 2 s would round away a sharp lobe.
        if s < 0.5 { (self.exponent * (-2.0 * s).ln_1p()).exp() } else { 0.0 }
    }

    #[inline(always)]
    fn curvature(self, s: f32) -> f32 {
        let cosine = (1.0 - 2.0 * s).max(1e-3);
        4.0 * self.exponent * (self.exponent - 1.0) * self.value(s) / (cosine * cosine)
    }

    #[inline(always)]
    fn scale(self, s: f32) -> f32 {
        1.44 * (1.0 - 2.0 * s).max(1e-3) / self.exponent
    }
}

/// (1 - 2 s)^n, n below 2: not smooth, and for n = 0 a step at the horizon.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WidePhong {
    exponent: f32,
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
            let distance = distance.max(near).min(far);
            let (low, high) = ((distance - radius).max(0.0), distance + radius);
            self.spread(0.25 * low * low, (0.25 * high * high).min(1.0))
        };
        at(near).max(at(far)).max(at(horizon)).max(at(steepest))
    }
}

/// 1 up to the edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    edge: f32,
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
        (1.0 - 2.0 * s).max(0.0)
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
    power: f32,
    /// k at its peak.
    crest: f32,
    /// x = 2 s where the slope of the bend vanishes, below 0 if it does nowhere, and the bend there.
    turn: f32,
    turning: f32,
}

/// Value lost where x^p is below the range of [`power`].
const NOTHING: f32 = 1e-30;

impl Charlie {
    /// With exponent `power`.
    fn new(power: f32) -> Self {
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
        p * rise * ((p - 1.0) - (p + 1.0) * x) / (x * x)
    }
}

impl Radial for Charlie {
    const SMOOTH: bool = true;
    const SPLIT: bool = false;

    #[inline(always)]
    fn value(self, s: f32) -> f32 {
        self.rise(2.0 * s) * (1.0 - 2.0 * s).max(0.0)
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
        let (least, greatest) = (self.value(low).min(self.value(high)), peak.max(low).min(high));
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
        let near = (distance - radius).max(0.0);
        let far = distance + radius;
        let (low, high) = (0.25 * near * near, (0.25 * far * far).min(1.0));
        let s = (0.25 * (squared + trace)).min(high);
        let [a, b, t] = [2.0 * low, 2.0 * high, 2.0 * s];
        let [rise_a, rise_b, rise_t] = [self.rise(a), self.rise(b), self.rise(t)];
        let [at_a, at_b] = [rise_a * (1.0 - a).max(0.0), rise_b * (1.0 - b).max(0.0)];
        let peak = p / (p + 1.0);
        let crest = if (a < peak) & (peak < b) { self.crest } else { at_a.max(at_b) };
        let trough = at_a.min(at_b);

        let (tangential, radial) = (along.max(0.0).sqrt(), 0.5 * trace.sqrt() * radius);
        let most = 0.25 * (tangential + radial) * (tangential + radial);
        let least = 0.25 * (tangential - radial).max(0.0) * (tangential - radial).max(0.0);
        // The bend is extreme at an end or where its own slope vanishes.
        let [bend_a, bend_b] = [self.bend(a, rise_a), self.bend(b, rise_b)];
        let turning = if (a < self.turn) & (self.turn < b) { self.turning } else { bend_a };
        let steepest = 2.0 * bend_a.max(bend_b).max(turning);
        let flattest = 2.0 * bend_a.min(bend_b).min(turning);
        let at_mean = rise_t * (1.0 - t);
        let upper = at_mean + if steepest > 0.0 { steepest * most } else { steepest * least };
        let lower = at_mean + if flattest > 0.0 { flattest * least } else { flattest * most };
        let beyond = s - 0.5;
        let over = if b > 1.0 { rise_b * ((most + beyond * beyond).sqrt() + beyond) } else { 0.0 };
        let under = (2.0 * beyond).max(0.0);
        // The second derivative is unbounded at s = 0.
        let sharp = a > 0.0;
        let greatest = if sharp { crest.min(upper + over) } else { crest }.max(0.0) + NOTHING;
        let least = (if sharp { trough.max(lower + under) } else { trough } - NOTHING).max(0.0).min(greatest);

        let half_width = 0.866 * tangential;
        let across = (half_width - beyond.abs()).max(0.0);
        let gain = 2.0 * across * across / (4.0 * half_width).max(1e-6);
        let second_order = if s < 0.5 { 0.5 * self.bend(t, rise_t) * along } else { 0.0 };
        let estimate = (at_mean.max(0.0) + second_order + gain).max(least).min(greatest);
        Interval { least, greatest, estimate }
    }

    #[inline(always)]
    fn worst_distance(self, near: f32, far: f32) -> f32 {
        // At the horizon, where the bend is sharp and ends; for a wide lobe, where it begins.
        let horizon = std::f32::consts::SQRT_2.max(near).min(far);
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
    let series = t * (2.0 + u * (2.0 / 3.0 + u * (0.4 + u * (2.0 / 7.0 + u * (2.0 / 9.0)))));
    let log2 = whole as f32 + series * std::f32::consts::LOG2_E;
    // 2^y, with the fraction of y by the exponential series.
    let y = (p * log2).max(-120.0);
    // Adding and subtracting 1.5 * 2^23 rounds to a whole number.
    let rounded = (y + 12_582_912.0) - 12_582_912.0;
    let z = (y - rounded) * std::f32::consts::LN_2;
    let fraction = 1.0
        + z * (1.0
            + z * (0.5
                + z * (1.0 / 6.0 + z * (1.0 / 24.0 + z * (1.0 / 120.0 + z * (1.0 / 720.0 + z / 5040.0))))));
    fraction * f32::from_bits(((rounded as i32 + 127) as u32) << 23)
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
    let near = (distance - radius).max(0.0);
    let far = distance + radius;
    let (low, high) = (0.25 * near * near, (0.25 * far * far).min(1.0));
    let s = 0.25 * (squared + trace);
    let ([nearest, farthest, value], curvature) = kernel.values_and_curvature([low, high, s]);
    if !R::SMOOTH {
        return Interval { least: farthest, greatest: nearest, estimate: value };
    }
    // s - low and high - s, computed without cancellation.
    let down = if distance > radius { 0.25 * (radius * (2.0 * distance - radius) + trace) } else { s };
    let up = (0.25 * (radius * (2.0 * distance + radius) - trace)).max(1e-6 * down);
    let (tangential, radial) = (along.max(0.0).sqrt(), 0.5 * trace.sqrt() * radius);
    let most = 0.25 * (tangential + radial) * (tangential + radial);
    let least = 0.25 * (tangential - radial).max(0.0) * (tangential - radial).max(0.0);
    let [per_down, per_up] = reciprocals([down, up]);
    let (step_up, step_down) = ((most * per_down).min(up), (least * per_up).min(down));
    let [inner, outer] = kernel.values([s + step_up, s - step_down]);
    let lengths = [down + step_up, up + step_down];
    let [per_above, per_below] = reciprocals(lengths);
    // Reciprocals of vanishing products overflow; there k is constant to float32.
    let sharp = (down * up).min(lengths[0] * lengths[1]) > 1e-36;
    let (share_above, share_below) = (step_up * per_above, step_down * per_below);
    if !ACROSS {
        let greatest = if sharp { inner + share_above * (nearest - inner) } else { nearest };
        let least = if sharp { outer + share_below * (farthest - outer) } else { farthest }.min(greatest);
        let estimate = (value + 0.125 * curvature * along).max(least).min(greatest);
        return Interval { least, greatest, estimate };
    }
    // Split k into a hinge at the horizon and a smooth rest; a cell in front of the horizon needs no hinge.
    let kink = if high < 0.5 { 0.0 } else { kernel.kink() };
    let hinge = |s: f32| kink * (0.5 - s).max(0.0);
    let (inner, nearest) = (inner - hinge(s + step_up), nearest - hinge(low));
    let (outer, farthest) = (outer - hinge(s - step_down), farthest - hinge(high));
    let before = 0.5 - s;
    let deviation = (most.min(down * up) + before * before).sqrt();
    // Differences of hinges are rounded at the precision of the greater one.
    let rounding = 5e-7 * kink;
    let greatest = if sharp { inner + share_above * (nearest - inner) } else { nearest }
        + 0.5 * kink * (deviation + before)
        + rounding;
    let least = (if sharp { outer + share_below * (farthest - outer) } else { farthest } + hinge(s)
        - rounding)
        .max(0.0)
        .min(greatest);
    // Second-order term in front of the horizon, and gain from the kink for energy spread evenly over s.
    let half_width = 0.866 * tangential;
    let second_order = if s < 0.5 { 0.125 * curvature * along } else { 0.0 };
    let across = (half_width - before.abs()).max(0.0);
    let gain = kink * across * across / (4.0 * half_width).max(1e-6);
    let estimate = (value + second_order + gain).max(least).min(greatest);
    Interval { least, greatest, estimate }
}

/// Expected error of the estimate for a cell of unit energy and the worst direction among those within
/// `packet` of an axis at `distance` from its centroid. It selects the cells to split and is not a bound.
#[inline(always)]
pub(crate) fn expected_error<R: Radial>(
    kernel: R,
    distance: f32,
    radius: f32,
    packet: f32,
    trace: f32,
) -> f32 {
    if !R::SMOOTH {
        // A jump or a steep end may lie anywhere between the packet's nearest and farthest direction.
        return 0.25 * kernel.widest_spread((distance - packet).max(0.0), distance + packet, radius);
    }
    let worst = kernel.worst_distance((distance - packet).max(0.0), distance + packet);
    // About half of the trace lies along the line to R.
    let along = 0.6 * trace * worst * worst;
    let interval = kernel.interval::<true>(worst * worst, trace, along, radius);
    let s = 0.25 * (worst * worst + trace);
    let scale = kernel.scale(s);
    let reach = 0.25 * radius * (2.0 * worst + radius);
    // The third-order term E|s - mean|^3 |k'''|/6, where the series converges; otherwise the certain width.
    let moment = 0.25 * (along + 0.25 * trace * radius * radius) * reach;
    let third = kernel.third_order(s, interval.estimate, moment);
    let certain = 0.25 * (interval.greatest - interval.least);
    // Add the uncertainty from the kink, for the direction nearest to it: the gap between Scarf's bound and
    // Jensen's, as such errors have one sign and accumulate; at most the part that reaches over the horizon.
    let (near, far) = ((distance - packet - radius).max(0.0), distance + packet + radius);
    let over = (0.25 * far * far - 0.5).min(0.5 - 0.25 * near * near).max(0.0);
    let variance = 0.25 * trace * distance * distance;
    let apart = ((0.5 - 0.25 * (distance * distance + trace)).abs() - 0.5 * distance * packet).max(0.0);
    let bent = 0.5 * variance / ((variance + apart * apart).sqrt() + apart).max(1e-12);
    let bent = kernel.kink() * bent.min(over);
    if (reach < 0.5 * scale) & (R::SPLIT | (over == 0.0)) { third + bent } else { certain }
}

/// Width of the interval between the extremes of k, for cells whose centroid is not known exactly.
pub(crate) fn first_order_width<R: Radial>(kernel: R, distance: f32, radius: f32, packet: f32) -> f32 {
    let near = (distance - radius - packet).max(0.0);
    let far = distance + radius + packet;
    kernel.spread(0.25 * near * near, (0.25 * far * far).min(1.0))
}

/// The acceptable error of a leaf, as a share of the mean radiance, for a relRMSE of `error` over the sphere.
///
/// Measured, see the table of errors in docs/benchmarks.md: the leaves' errors have random signs and mostly
/// lie far inside their intervals, farther with more leaves. With this share the error reached stays near
/// half of the request.
#[must_use]
pub fn leaf_share(error: f64) -> f64 {
    0.6 * error * (error / 0.005).powf(0.3).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

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
