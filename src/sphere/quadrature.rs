//! Gauss-Legendre rules.

use std::f64::consts::PI;

/// Nodes in (0, 1) and weights of the Gauss-Legendre rule of `order` points.
pub(crate) fn gauss_legendre(order: u32) -> Vec<(f64, f64)> {
    let n = f64::from(order);
    (0..order)
        .map(|k| {
            // Newton's iteration on the Legendre polynomial from Chebyshev's guess.
            let mut x = (PI * (f64::from(k) + 0.75) / (n + 0.5)).cos();
            let mut derivative = 1.0;
            for _ in 0..20 {
                let (mut previous, mut value) = (1.0, x);
                for degree in 2..=order {
                    let d = f64::from(degree);
                    (previous, value) = (value, ((2.0 * d - 1.0) * x * value - (d - 1.0) * previous) / d);
                }
                derivative = n * (x * value - previous) / (x * x - 1.0);
                x -= value / derivative;
            }
            ((1.0 - x) / 2.0, 1.0 / ((1.0 - x * x) * derivative * derivative))
        })
        .collect()
}
