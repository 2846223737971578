//! What examples that descend share: Adam (Kingma and Ba 2015), its rate falling to a fiftieth.

/// A descent of some numbers.
pub(crate) struct Descent {
    rate: f64,
    step: i32,
    steps: i32,
    /// Means of the slopes and of their squares.
    moments: Vec<[f64; 2]>,
}

impl Descent {
    /// One of `count` numbers in `steps` steps, the first of `rate`.
    pub(crate) fn new(count: usize, steps: i32, rate: f64) -> Self {
        Self { rate, step: 0, steps, moments: vec![[0.0; 2]; count] }
    }

    /// Moves `numbers` against their `slopes`.
    pub(crate) fn step(&mut self, numbers: &mut [f64], slopes: &[f64]) {
        self.step += 1;
        let rate = self.rate * (0.02_f64).powf(f64::from(self.step) / f64::from(self.steps));
        for (number, (moments, slope)) in numbers.iter_mut().zip(self.moments.iter_mut().zip(slopes)) {
            let [mean, square] = moments;
            *mean = 0.9 * *mean + 0.1 * slope;
            *square = 0.999 * *square + 0.001 * slope * slope;
            let [mean, square] =
                [*mean / (1.0 - 0.9_f64.powi(self.step)), *square / (1.0 - 0.999_f64.powi(self.step))];
            *number -= rate * mean / (square.sqrt() + 1e-12);
        }
    }
}

/// The number of steps by the command line, else `usual`.
pub(crate) fn steps(usual: i32) -> i32 {
    std::env::args().nth(1).and_then(|steps| steps.parse().ok()).unwrap_or(usual)
}
