//! Ranges of functions over a ball: what bounds the error of a value at the centroid of light.

/// Bounds of a function that is not negative, over a ball: its values, and the greatest lengths of its
/// gradient and of its second derivative in any direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) slope: f64,
    pub(super) bend: f64,
}

impl Range {
    /// A linear function of gradient `slope` and of `value` at the centre of a ball of `radius`.
    pub(super) fn linear(value: f64, slope: f64, radius: f64) -> Self {
        let reach = slope * radius;
        Self { low: (value - reach).max(0.0), high: (value + reach).max(0.0), slope, bend: 0.0 }
    }

    /// A norm of `value` at the centre, at most `slope` times the Euclidean one.
    ///
    /// The second derivative of |x|_A is A / |x|_A without its part along A x: at most `slope`^2 over it.
    pub(super) fn norm(value: f64, slope: f64, radius: f64) -> Self {
        let range = Self::linear(value, slope, radius);
        Self { bend: slope * slope / range.low, ..range }
    }

    pub(super) fn scaled(self, factor: f64) -> Self {
        let Self { low, high, slope, bend } = self;
        Self { low: factor * low, high: factor * high, slope: factor * slope, bend: factor * bend }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            low: self.low + other.low,
            high: self.high + other.high,
            slope: self.slope + other.slope,
            bend: self.bend + other.bend,
        }
    }

    pub(super) fn times(self, other: Self) -> Self {
        Self {
            low: self.low * other.low,
            high: self.high * other.high,
            slope: self.high * other.slope + other.high * self.slope,
            bend: self.high * other.bend + other.high * self.bend + 2.0 * self.slope * other.slope,
        }
    }

    pub(super) fn squared(self) -> Self {
        self.times(self)
    }

    pub(super) fn inverse(self) -> Self {
        let per = 1.0 / self.low;
        Self {
            low: 1.0 / self.high,
            high: per,
            slope: self.slope * per * per,
            bend: (self.bend + 2.0 * self.slope * self.slope * per) * per * per,
        }
    }

    pub(super) fn root(self) -> Self {
        let (low, high) = (self.low.sqrt(), self.high.sqrt());
        Self {
            low,
            high,
            slope: self.slope / (2.0 * low),
            bend: (self.bend + self.slope * self.slope / (2.0 * self.low)) / (2.0 * low),
        }
    }

    /// 1 minus this, of at most 1.
    pub(super) fn complement(self) -> Self {
        Self { low: (1.0 - self.high).max(0.0), high: (1.0 - self.low).max(0.0), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// A function of a point, and its range over a ball.
    type Case = (fn(DVec3) -> f64, fn(DVec3, f64) -> Range);

    #[test]
    fn ranges_hold_values_and_derivatives() {
        let along = DVec3::new(0.6, 0.0, 0.8);
        let axes = DVec3::new(3.0, 1.0, 0.5);
        let cases: [Case; 6] = [
            (
                |p| 1.0 + DVec3::new(0.6, 0.0, 0.8).dot(p),
                |c, r| Range::linear(1.0 + DVec3::new(0.6, 0.0, 0.8).dot(c), 1.0, r),
            ),
            (
                |p| (DVec3::new(3.0, 1.0, 0.5) * p).length(),
                |c, r| Range::norm((DVec3::new(3.0, 1.0, 0.5) * c).length(), 3.0, r),
            ),
            (|p| (1.0 + p.x).powi(2), |c, r| Range::linear(1.0 + c.x, 1.0, r).squared()),
            (|p| 1.0 / (2.0 + p.y), |c, r| Range::linear(2.0 + c.y, 1.0, r).inverse()),
            (|p| (2.0 + p.z).sqrt(), |c, r| Range::linear(2.0 + c.z, 1.0, r).root()),
            (
                |p| (1.0 - 0.2 * (1.0 + p.x)) * 3.0 + p.length(),
                |c, r| {
                    let shared = Range::linear(1.0 + c.x, 1.0, r).scaled(0.2).complement().scaled(3.0);
                    shared.plus(Range::norm(c.length(), 1.0, r))
                },
            ),
        ];
        let (centre, radius) = (DVec3::new(0.3, -0.2, 0.8), 0.15);
        assert!(along.is_normalized() && axes.max_element() == 3.0);
        for (k, (function, range)) in cases.into_iter().enumerate() {
            let range = range(centre, radius);
            for step in 0..2000 {
                let turn =
                    DVec3::new((step as f64 * 0.7).sin(), (step as f64 * 1.3).cos(), (step as f64).sin());
                let point = centre + turn.normalize() * radius * ((step % 97) as f64 / 97.0);
                let value = function(point);
                assert!(range.low - 1e-12 <= value && value <= range.high + 1e-12, "{k}: {value} {range:?}");
                let (h, ahead) = (1e-4, turn.normalize().any_orthonormal_vector());
                let [before, after] = [function(point - h * ahead), function(point + h * ahead)];
                assert!(((after - before) / (2.0 * h)).abs() <= range.slope + 1e-6, "{k}: slope {range:?}");
                let second = ((after - 2.0 * value + before) / (h * h)).abs();
                assert!(second <= range.bend + 1e-5, "{k}: bend {second} {range:?}");
            }
        }
    }
}
