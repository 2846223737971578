//! The summed-area table (SAT; Crow 1984) of an OEM, exact: 64-bit fixed point, sums modulo 2^64.
//!
//! Float32 tables over HDR environments are broken (a sun of 1e6 leaves single-texel boxes of a 2048^2 table
//! wrong by more than the sky's radiance). Integers are exact: intermediate entries may wrap, a box is right
//! as long as the box itself fits, and since addition modulo 2^64 is associative and commutative every scan
//! gives the same bits.

use crate::common::error::{Result, wrong};
use crate::light::oem::{Oem, OemSize};
use glam::DVec2;
use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

/// How a summed-area table is scanned; every choice gives the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scan {
    /// The engines' own. CPU: a wavefront of blocks, one strip of columns per thread, which reads once and
    /// writes once. GPU: tiles in four dispatches.
    #[default]
    Blocks,
    /// One entry after the other. CPU only.
    Serial,
    /// Recursive doubling, horizontally and then vertically, ping-pong. Hensley et al. 2005, section 3.
    Hensley {
        /// Samples summed per pass: one of [`Scan::RADICES`].
        radix: u32,
    },
}

impl Scan {
    /// Samples per pass of recursive doubling: 2 in the figures of Hensley et al. 2005, more for fewer
    /// passes.
    pub const RADICES: [u32; 4] = [2, 4, 8, 16];

    /// Checks the radix.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for a radix other than [`Scan::RADICES`].
    pub fn check(self) -> Result<()> {
        match self {
            Self::Hensley { radix } if !Self::RADICES.contains(&radix) => {
                wrong(format!("`scan` {self}: the samples of a pass must be 2, 4, 8 or 16"))
            }
            _ => Ok(()),
        }
    }
}

impl Display for Scan {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Blocks => f.write_str("blocks"),
            Self::Serial => f.write_str("serial"),
            Self::Hensley { radix } => write!(f, "hensley:{radix}"),
        }
    }
}

/// Parses the scans that both engines have, as [`Display`] writes them.
impl FromStr for Scan {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':').map_or((text, None), |(name, value)| (name, Some(value))) {
            ("blocks", None) => Ok(Self::Blocks),
            ("hensley", Some(radix)) => match radix.parse() {
                Ok(radix) if Self::RADICES.contains(&radix) => Ok(Self::Hensley { radix }),
                _ => Err("the samples of hensley:R must be 2, 4, 8 or 16".to_owned()),
            },
            _ => Err("choose one of blocks, hensley:2, hensley:4, hensley:8, hensley:16".to_owned()),
        }
    }
}

/// The fixed-point scale of each channel: a value v is stored as floor(v * 2^F).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FixedPoint {
    /// F of red, green, blue energy and of solid angle.
    pub exponents: [i32; 4],
}

impl FixedPoint {
    /// The largest F of each channel with T * 2^F < 2^62 - N, where T is the channel's total over the `inner`
    /// x `inner` square and N its texels: any box of side up to 2 * `inner` on the unfolded plane, which
    /// counts a texel at most four times, fits 64 bits. A channel of zeros gets 0.
    ///
    /// Found without floating-point arithmetic and independently of the order: the greatest bit pattern, then
    /// an integer sum.
    pub fn of_square(oem: &Oem) -> Self {
        let inner = u64::from(oem.size().inner);
        Self::of_texels(inner * inner, || oem.square())
    }

    /// [`FixedPoint::of_square`] for `count` `texels`, whose boxes count each texel at most four times.
    pub fn of_texels<'a, I: Iterator<Item = &'a [f32; 4]>>(count: u64, texels: impl Fn() -> I) -> Self {
        let mut greatest = [0_u32; 4];
        for texel in texels() {
            for (greatest, value) in greatest.iter_mut().zip(texel) {
                *greatest = (*greatest).max(value.to_bits());
            }
        }
        let count_log2 = i32::try_from(64 - (count - 1).leading_zeros()).expect("at most 64");
        // At this scale the greatest value times the count stays below 2^62.
        let provisional = Self {
            exponents: greatest.map(|bits| {
                let exponent = i32::try_from((bits >> 23).max(1)).expect("eight bits") - 126;
                62 - count_log2 - exponent
            }),
        };
        let mut sums = [0_u64; 4];
        for texel in texels() {
            for (sum, value) in sums.iter_mut().zip(provisional.quantise(*texel)) {
                *sum += value;
            }
        }
        let mut exponents = [0; 4];
        for (channel, exponent) in exponents.iter_mut().enumerate() {
            if greatest[channel] == 0 {
                continue;
            }
            // Truncation loses less than one unit per texel; each doubling doubles that loss.
            let limit = (1_u128 << 62) - u128::from(count);
            let total = u128::from(sums[channel]) + u128::from(count);
            let mut up = 0;
            while total << (up + 1) < limit {
                up += 1;
            }
            *exponent = provisional.exponents[channel] + up;
        }
        Self { exponents }
    }

    /// Four non-negative finite values as integers, truncated, by shifts of their bit patterns.
    #[inline(always)]
    pub(crate) fn quantise(self, values: [f32; 4]) -> [u64; 4] {
        let mut out = [0; 4];
        for channel in 0..4 {
            let bits = u64::from(values[channel].to_bits());
            let exponent = bits >> 23;
            let mantissa = if exponent > 0 { bits & 0x007f_ffff | 1 << 23 } else { bits };
            // value = mantissa * 2^(max(exponent, 1) - 150). One of the shifts wraps to 64 or more and yields
            // 0, as the shifts of vector units do; both are 0 if nothing is shifted.
            let bias = i64::from(150 - self.exponents[channel]) as u64;
            let left = exponent.max(1).wrapping_sub(bias);
            let right = bias.wrapping_sub(exponent.max(1));
            let shifted = |shift: u64, value: u64| if shift < 64 { value } else { 0 };
            out[channel] = shifted(left, mantissa << (left & 63)) | shifted(right, mantissa >> (right & 63));
        }
        out
    }

    /// One integer of `channel` as a value.
    #[inline]
    pub fn value(self, channel: usize, integer: u64) -> f64 {
        integer as f64 * (-f64::from(self.exponents[channel])).exp2()
    }

    /// Four integers as values.
    #[inline]
    pub fn values(self, integers: [u64; 4]) -> [f64; 4] {
        std::array::from_fn(|channel| self.value(channel, integers[channel]))
    }
}

/// The exact table of an OEM, border included. Sums are inclusive: entry (x, y) is the sum of the texels up
/// to and including (x, y).
#[derive(Clone, Debug, PartialEq)]
pub struct Sat {
    size: OemSize,
    fixed: FixedPoint,
    entries: Vec<[u64; 4]>,
}

impl Sat {
    /// A table of `entries`, row-major, already summed.
    pub const fn from_entries(size: OemSize, fixed: FixedPoint, entries: Vec<[u64; 4]>) -> Self {
        Self { size, fixed, entries }
    }

    /// Size of the OEM summed.
    pub const fn size(&self) -> OemSize {
        self.size
    }

    /// The scale of the entries.
    pub const fn fixed_point(&self) -> FixedPoint {
        self.fixed
    }

    /// All entries, row-major, border included.
    pub fn entries(&self) -> &[[u64; 4]] {
        &self.entries
    }

    /// Sum of the texels with coordinates below (`x`, `y`), from the corner of the bordered table.
    #[inline]
    fn prefix(&self, x: usize, y: usize) -> [u64; 4] {
        if x == 0 || y == 0 { [0; 4] } else { self.entries[(y - 1) * self.size.bordered() as usize + x - 1] }
    }

    /// Sum of the texels `x0 <= x < x1`, `y0 <= y < y1` by four reads. The square's first texel is (0, 0);
    /// coordinates in the border are negative or at least `inner`.
    ///
    /// # Panics
    /// If the box leaves the border or has a negative side.
    #[inline]
    pub fn bordered_box(&self, x0: i64, y0: i64, x1: i64, y1: i64) -> [u64; 4] {
        let border = i64::from(self.size.border);
        let far = i64::from(self.size.inner) + border;
        assert!(
            -border <= x0 && x0 <= x1 && x1 <= far && -border <= y0 && y0 <= y1 && y1 <= far,
            "box ({x0}, {y0}) .. ({x1}, {y1}) within a border of {border} around {}",
            self.size.inner
        );
        let at = |x: i64, y: i64| self.prefix((x + border) as usize, (y + border) as usize);
        difference(at(x0, y0), at(x1, y0), at(x0, y1), at(x1, y1))
    }

    /// Sum of the texels 0 <= x < `x`, 0 <= y < `y` of the unfolded plane, for any integers (negative ones
    /// count backwards), from the square's own table: wallpaper group p2 by parity.
    pub(crate) fn plane_prefix(&self, x: i64, y: i64) -> [u64; 4] {
        let n = i64::from(self.size.inner);
        if (0..=n).contains(&x) && (0..=n).contains(&y) {
            return self.bordered_box(0, 0, x, y);
        }
        let (i, x) = (x.div_euclid(n), x.rem_euclid(n));
        let (j, y) = (y.div_euclid(n), y.rem_euclid(n));
        let inside = |x: i64, y: i64| self.bordered_box(0, 0, x, y);
        let (total, a, b) = (inside(n, n), inside(x, n), inside(n, y));
        let (a_turned, b_turned) = (inside(n - x, n), inside(n, n - y));
        // Count the upright (ev) and rotated (od) tiles below.
        let (ev, od) = (|k: i64| (k + 1).div_euclid(2), |k: i64| k.div_euclid(2));
        let even = |k: i64| k.rem_euclid(2) == 0;
        let (upright_a, turned_a) = if even(i) { (ev(j), od(j)) } else { (od(j), ev(j)) };
        let (upright_b, turned_b) = if even(j) { (ev(i), od(i)) } else { (od(i), ev(i)) };
        let corner = if even(i + j) { inside(x, y) } else { inside(n - x, n - y) };
        std::array::from_fn(|c| {
            let times = |count: i64, value: u64| (count as u64).wrapping_mul(value);
            let last = if even(i + j) {
                corner[c]
            } else {
                total[c].wrapping_sub(a_turned[c]).wrapping_sub(b_turned[c]).wrapping_add(corner[c])
            };
            times(i.wrapping_mul(j), total[c])
                .wrapping_add(times(upright_a, a[c]))
                .wrapping_add(times(turned_a, total[c].wrapping_sub(a_turned[c])))
                .wrapping_add(times(upright_b, b[c]))
                .wrapping_add(times(turned_b, total[c].wrapping_sub(b_turned[c])))
                .wrapping_add(last)
        })
    }

    /// Sum of the texels `x0 <= x < x1`, `y0 <= y < y1` of the unfolded plane; exact for sides up to 2 *
    /// `inner`.
    pub fn plane_box(&self, x0: i64, y0: i64, x1: i64, y1: i64) -> [u64; 4] {
        let at = |x: i64, y: i64| self.plane_prefix(x, y);
        difference(at(x0, y0), at(x1, y0), at(x0, y1), at(x1, y1))
    }

    /// Energy (red, green, blue) and solid angle of a box with fractional edges on the unfolded plane, in
    /// texels of the square: nine integer boxes, each non-negative and exact, weighted by the share of their
    /// texels inside.
    ///
    /// Sides must be at most 2 * `inner`.
    pub fn fractional_box(&self, low: DVec2, high: DVec2) -> [f64; 4] {
        let columns = Spans::new(low.x, high.x);
        let rows = Spans::new(low.y, high.y);
        // The sixteen table entries around the four corners: one read each inside the border, by parity
        // beyond it. Differences are the same modulo 2^64.
        let border = i64::from(self.size.border);
        let far = i64::from(self.size.inner) + border;
        let is_inside = |edges: &[i64; 4]| -border <= edges[0] && edges[3] <= far;
        if is_inside(&columns.edges) && is_inside(&rows.edges) {
            let at = |edge: i64| (edge + border) as usize;
            fractional_sum(self.fixed, &columns, &rows, |x, y| self.prefix(at(x), at(y)))
        } else {
            fractional_sum(self.fixed, &columns, &rows, |x, y| self.plane_prefix(x, y))
        }
    }
}

/// The sum over the box between `columns` and `rows` from sixteen prefixes: nine integer boxes, weighted by
/// their shares.
#[inline]
pub fn fractional_sum(
    fixed: FixedPoint,
    columns: &Spans,
    rows: &Spans,
    prefix: impl Fn(i64, i64) -> [u64; 4],
) -> [f64; 4] {
    let prefixes = rows.edges.map(|y| columns.edges.map(|x| prefix(x, y)));
    let mut sum = [0.0; 4];
    for j in 0..3 {
        for i in 0..3 {
            let share = columns.shares[i] * rows.shares[j];
            if share > 0.0 {
                let (upper, lower) = (&prefixes[j], &prefixes[j + 1]);
                let part = difference(upper[i], upper[i + 1], lower[i], lower[i + 1]);
                for (sum, value) in sum.iter_mut().zip(fixed.values(part)) {
                    *sum += share * value;
                }
            }
        }
    }
    sum
}

/// A box from the four corners' prefixes, modulo 2^64.
#[inline]
pub fn difference(a: [u64; 4], b: [u64; 4], c: [u64; 4], d: [u64; 4]) -> [u64; 4] {
    std::array::from_fn(|k| d[k].wrapping_sub(b[k]).wrapping_sub(c[k]).wrapping_add(a[k]))
}

/// An interval with fractional ends, as a partial texel, whole texels and a partial texel.
pub struct Spans {
    edges: [i64; 4],
    shares: [f64; 3],
}

impl Spans {
    /// The interval from `low` to `high`, in texels.
    pub fn new(low: f64, high: f64) -> Self {
        let (first, last) = (low.floor(), high.ceil());
        if last - first <= 1.0 {
            // Both ends lie in one texel.
            let edge = first as i64;
            return Self { edges: [edge, edge + 1, edge + 1, edge + 1], shares: [high - low, 0.0, 0.0] };
        }
        let edges = [first as i64, first as i64 + 1, last as i64 - 1, last as i64];
        Self { edges, shares: [first + 1.0 - low, 1.0, high - (last - 1.0)] }
    }
}
