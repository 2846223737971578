//! Where the reads of an isotropic reflection stand, and how wide they are.
//!
//! Slopes and logarithms of widths, both over alpha, are cubic B-splines over log(1 + 10 r) and ln n.v, so
//! that nothing jumps between lobes. `examples/fit_places.rs` finds the numbers: it lowers the error of the
//! fit of [`super::reads`] at all views together.

use std::sync::LazyLock;

/// Control points over roughness and over n.v.
pub const CONTROLS: [usize; 2] = [37, 17];

/// Reads at places of their own.
pub const READS: usize = 10;

/// n.v below which places stay as they are.
const LEAST: f64 = 0.05;

/// Numbers of a control point: slopes, then logarithms of widths.
pub const NUMBERS: usize = 2 * READS;

/// Numbers of the control points, those of the least n.v first.
static TABLE: LazyLock<Vec<[f64; NUMBERS]>> = LazyLock::new(|| {
    let row = |line: &str| {
        let mut numbers = line.split(',').map(|number| number.parse().expect("a number"));
        std::array::from_fn(|_| numbers.next().expect("a number of each"))
    };
    include_str!("places.csv").lines().skip(1).map(row).collect()
});

/// Control points that count at `roughness` and n.v of `cosine`, and their shares.
pub fn shares(roughness: f64, cosine: f64) -> [(usize, f64); 16] {
    let across = (1.0 + 10.0 * roughness).ln() / 11_f64.ln();
    let up = 1.0 - cosine.max(LEAST).ln() / LEAST.ln();
    let [(x, right), (y, above)] = [(across, CONTROLS[0]), (up, CONTROLS[1])].map(|(place, controls)| {
        let place = place.clamp(0.0, 1.0) * (controls - 3) as f64;
        let first = (place as usize).min(controls - 4);
        (first, spline(place - first as f64))
    });
    std::array::from_fn(|k| ((y + k / 4) * CONTROLS[0] + x + k % 4, right[k % 4] * above[k / 4]))
}

/// The four cubic B-splines at a share `f` of an interval.
fn spline(f: f64) -> [f64; 4] {
    let g = 1.0 - f;
    let inner = |f: f64| ((3.0 * f - 6.0) * f * f + 4.0) / 6.0;
    [g * g * g / 6.0, inner(f), inner(g), f * f * f / 6.0]
}

/// Slope and width of each read, both over alpha, where `numbers` are those of the control points in turn.
pub fn from_controls(
    numbers: impl Fn(usize) -> [f64; NUMBERS],
    roughness: f64,
    cosine: f64,
) -> [[f64; 2]; READS] {
    let mut sum = [0.0; NUMBERS];
    for (control, share) in shares(roughness, cosine) {
        sum.iter_mut().zip(numbers(control)).for_each(|(sum, number)| *sum += share * number);
    }
    std::array::from_fn(|read| [sum[read], sum[READS + read].exp()])
}

/// The numbers of a control point of the table.
pub fn numbers(control: usize) -> [f64; NUMBERS] {
    TABLE[control]
}

/// Slope and width of each read, both over alpha.
pub fn places(roughness: f64, cosine: f64) -> [[f64; 2]; READS] {
    from_controls(numbers, roughness, cosine)
}
