//! The float32 summed-area table of Hensley et al. 2005, with its mean bias: compact and filterable, for LDR
//! and for comparison. Over HDR environments its boxes are inaccurate, see `sat`.

use crate::oem::{Oem, OemSize};

/// A float32 table over an OEM, border included; inclusive.
///
/// The mean of the bordered table is subtracted before summing and added back by queries (Hensley et al.
/// 2005, section 4). The error of a box's mean is bounded: |err| <= (4 d + 3) * 2^-24 * T / A, d the depth of
/// the sum tree (2 ceil(log2 n) for recursive doubling), T the total of the absolute biased values, A the
/// box's texels.
#[derive(Clone, Debug)]
pub struct SatF32 {
    size: OemSize,
    mean: [f32; 4],
    entries: Vec<[f32; 4]>,
}

impl SatF32 {
    /// Builds the table of `oem` by recursive doubling with radix 2.
    #[must_use]
    pub fn new(oem: &Oem) -> Self {
        let side = oem.size().bordered() as usize;
        let count = (side * side) as f64;
        let mut totals = [0.0_f64; 4];
        for texel in oem.texels() {
            for (total, value) in totals.iter_mut().zip(texel) {
                *total += f64::from(*value);
            }
        }
        let mean = totals.map(|total| (total / count) as f32);
        let mut front: Vec<[f32; 4]> =
            oem.texels().iter().map(|texel| std::array::from_fn(|c| texel[c] - mean[c])).collect();
        let mut back = front.clone();
        for step in [1, side] {
            let mut stride = 1;
            while stride < side {
                for (k, value) in back.iter_mut().enumerate() {
                    let along = if step == 1 { k % side } else { k / side };
                    *value = front[k];
                    if along >= stride {
                        for (value, other) in value.iter_mut().zip(front[k - stride * step]) {
                            *value += other;
                        }
                    }
                }
                std::mem::swap(&mut front, &mut back);
                stride *= 2;
            }
        }
        Self { size: oem.size(), mean, entries: front }
    }

    /// Sum of the texels `x0 <= x < x1`, `y0 <= y < y1`, counted from the bordered table's corner.
    ///
    /// # Panics
    /// If the box is not within the table.
    #[must_use]
    pub fn sum(&self, x0: u32, y0: u32, x1: u32, y1: u32) -> [f32; 4] {
        let side = self.size.bordered();
        assert!(x0 <= x1 && x1 <= side && y0 <= y1 && y1 <= side, "a box within the table");
        let at = |x: u32, y: u32| match (x.checked_sub(1), y.checked_sub(1)) {
            (Some(x), Some(y)) => self.entries[y as usize * side as usize + x as usize],
            _ => [0.0; 4],
        };
        let area = ((x1 - x0) * (y1 - y0)) as f32;
        let (a, b, c, d) = (at(x0, y0), at(x1, y0), at(x0, y1), at(x1, y1));
        std::array::from_fn(|k| d[k] - b[k] - c[k] + a[k] + self.mean[k] * area)
    }
}
