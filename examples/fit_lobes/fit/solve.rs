//! The Levenberg-Marquardt method over parameters with ties.

use super::model::{Problem, Quadratic};

/// For each parameter the free parameter that it equals, and the sign; `None` for parameters fixed at 0.
pub(super) struct Ties {
    free: usize,
    follows: Vec<Option<(usize, f64)>>,
}

impl Ties {
    /// Ties that make the parameters invariant under `mirrors`; a mirror maps every parameter to another one,
    /// with a sign.
    pub(super) fn new(count: usize, mirrors: &[Vec<(usize, f64)>]) -> Self {
        // Classes of parameters, each represented by its least member.
        let mut class: Vec<(usize, f64)> = (0..count).map(|k| (k, 1.0)).collect();
        let mut zero = vec![false; count];
        for mirror in mirrors {
            for k in 0..count {
                let (to, sign) = mirror[k];
                let ((a, sign_a), (b, sign_b)) = (class[k], class[to]);
                let sign = sign_a * sign * sign_b;
                if a == b {
                    zero[a] |= sign < 0.0;
                    continue;
                }
                let (kept, gone) = (a.min(b), a.max(b));
                zero[kept] |= zero[gone];
                for member in &mut class {
                    if member.0 == gone {
                        *member = (kept, member.1 * sign);
                    }
                }
            }
        }
        let mut free = 0;
        let mut numbers = vec![None; count];
        for k in 0..count {
            if class[k].0 == k && !zero[k] {
                numbers[k] = Some(free);
                free += 1;
            }
        }
        let follows = class.iter().map(|(kept, sign)| numbers[*kept].map(|number| (number, *sign))).collect();
        Self { free, follows }
    }

    /// The parameters closest to `x` that satisfy the ties.
    pub(super) fn project(&self, x: &[f64]) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.free];
        for (value, follows) in x.iter().zip(&self.follows) {
            if let Some((number, sign)) = follows {
                sums[*number].0 += sign * value;
                sums[*number].1 += 1.0;
            }
        }
        self.follows
            .iter()
            .map(|follows| follows.map_or(0.0, |(k, sign)| sign * sums[k].0 / sums[k].1))
            .collect()
    }
}

/// Weight of the distance from `start`: small enough to decide only what the lobe leaves open.
const ANCHOR: f64 = 1e-5;

/// A lobe that depends on the parameters: its own are `share` times these plus `rest`.
pub(super) struct Sample {
    pub(super) problem: Problem,
    pub(super) share: f64,
    pub(super) rest: Vec<f64>,
}

/// The sum over `samples`, around the parameters that they share.
pub(super) fn total(samples: &[Sample], x: &[f64], derivatives: bool) -> Quadratic {
    let count = x.len();
    let mut sum = Quadratic { value: 0.0, gradient: vec![0.0; count], hessian: vec![0.0; count * count] };
    for Sample { problem, share, rest } in samples {
        let own: Vec<f64> = x.iter().zip(rest).map(|(x, rest)| share * x + rest).collect();
        let part = problem.quadratic(&own, derivatives);
        sum.value += part.value;
        for (sum, part) in sum.gradient.iter_mut().zip(part.gradient) {
            *sum += share * part;
        }
        for (sum, part) in sum.hessian.iter_mut().zip(part.hessian) {
            *sum += share * share * part;
        }
    }
    sum
}

/// The parameters near `start` with the least distance from the lobes of `samples`, and that distance, after
/// at most `iterations`.
pub(super) fn minimise(
    samples: &[Sample],
    ties: &Ties,
    clamp: &dyn Fn(&mut [f64]),
    start: &[f64],
    iterations: u32,
) -> (Vec<f64>, f64) {
    let anchor = ties.project(start);
    let mut x = anchor.clone();
    clamp(&mut x);
    let pull = |x: &[f64]| x.iter().zip(&anchor).map(|(a, b)| ANCHOR * (a - b) * (a - b)).sum::<f64>();
    let count = x.len();
    let mut damping = 1e-3;
    let mut at = total(samples, &x, true);
    for _ in 0..iterations {
        let before = at.value + pull(&x);
        // The quadratic of the free parameters.
        let mut gradient = vec![0.0; ties.free];
        let mut hessian = vec![0.0; ties.free * ties.free];
        for a in 0..count {
            let Some((row, sign_a)) = ties.follows[a] else { continue };
            gradient[row] += sign_a * (at.gradient[a] + ANCHOR * (x[a] - anchor[a]));
            hessian[row * ties.free + row] += ANCHOR;
            for b in 0..count {
                let Some((column, sign_b)) = ties.follows[b] else { continue };
                let value = at.hessian[a.max(b) * count + a.min(b)];
                hessian[row * ties.free + column] += sign_a * sign_b * value;
            }
        }
        let mut improved = false;
        while damping < 1e8 {
            let step = damped_step(&hessian, &gradient, damping);
            let mut next: Vec<f64> = (0..count)
                .map(|k| x[k] - ties.follows[k].map_or(0.0, |(number, sign)| sign * step[number]))
                .collect();
            clamp(&mut next);
            let value = total(samples, &next, false).value + pull(&next);
            if value < before {
                x = next;
                damping = (damping / 4.0).max(1e-9);
                improved = true;
                break;
            }
            damping *= 4.0;
        }
        if !improved {
            break;
        }
        at = total(samples, &x, true);
        if before - (at.value + pull(&x)) < 1e-5 * before {
            break;
        }
    }
    (x, at.value)
}

/// Solves (H + damping diag H) step = gradient by Cholesky factorisation.
fn damped_step(hessian: &[f64], gradient: &[f64], damping: f64) -> Vec<f64> {
    let n = gradient.len();
    let mut lower = hessian.to_vec();
    for k in 0..n {
        lower[k * n + k] *= 1.0 + damping;
    }
    for i in 0..n {
        for j in 0..=i {
            let mut sum = lower[i * n + j];
            for k in 0..j {
                sum -= lower[i * n + k] * lower[j * n + k];
            }
            // The anchor keeps the matrix positive definite, except for rounding.
            lower[i * n + j] = if i == j { sum.max(1e-30).sqrt() } else { sum / lower[j * n + j] };
        }
    }
    let mut step = gradient.to_vec();
    for i in 0..n {
        for k in 0..i {
            step[i] -= lower[i * n + k] * step[k];
        }
        step[i] /= lower[i * n + i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            step[i] -= lower[k * n + i] * step[k];
        }
        step[i] /= lower[i * n + i];
    }
    step
}
