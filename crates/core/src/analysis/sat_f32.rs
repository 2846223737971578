//! The float32 summed-area table of Hensley et al. 2005, with its mean bias: compact and filterable, for LDR
//! and for comparison. Over HDR environments its boxes are inaccurate, see `sat`.

use crate::light::oem::Oem;

/// The mean of the bordered `oem`, and its float32 table, border included; inclusive. By recursive doubling
/// with radix 2.
///
/// The mean is subtracted before summing and added back by queries (Hensley et al. 2005, section 4). The
/// error of a box's mean is bounded: |err| <= (4 d + 3) * 2^-24 * T / A, d the depth of the sum tree (2
/// ceil(log2 n) for recursive doubling), T the total of the absolute biased values, A the box's texels.
pub fn sat_f32(oem: &Oem) -> ([f32; 4], Vec<[f32; 4]>) {
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
    (mean, front)
}
