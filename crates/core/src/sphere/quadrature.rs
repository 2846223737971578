//! Gauss-Legendre rules.

use std::f64::consts::PI;

/// Nodes in (0, 1) and weights of the rules of two and three points.
pub(crate) const TWO_NODES: [(f64, f64); 2] =
    [(0.211_324_865_405_187_1, 0.5), (0.788_675_134_594_812_9, 0.5)];
pub(crate) const THREE_NODES: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Nodes in (0, 1) and weights of the Gauss-Legendre rule of `order` points.
pub fn gauss_legendre(order: u32) -> Vec<(f64, f64)> {
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
