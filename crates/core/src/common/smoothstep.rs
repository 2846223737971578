//! A smooth fade.

/// 0 below 0, 1 above 1, smooth between.
#[inline]
pub fn smoothstep(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
