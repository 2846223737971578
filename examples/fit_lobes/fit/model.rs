//! The kernel of the parameters, its distance from the lobe, and the derivatives of that distance.

use glam::DVec2;
use octagloss::internals::lobe::{self, Lobe};
use octagloss::internals::realtime::tables::triangle::Grid;
use octagloss::internals::realtime::tables::{BOX_PARAMETERS, HARMONICS, Shape};
use octagloss::internals::sphere::octahedral::{direction_from_oct, solid_angle_density, wrap_oct};
use std::f64::consts::{LN_2, PI};

/// Cells along an edge of a level.
const CELLS: usize = 24;

/// Cells of the finest level per alpha.
const FINENESS: f64 = 5.0;

/// Weight of a level relative to the next finer one. Around cone points, where boxes are farthest from the
/// lobe's shape, all levels count alike: the error over panoramas is up to a third less.
const fn coarser(shape: &Shape) -> f64 {
    match shape.grid {
        Grid::Triangle => 2.0,
        Grid::Cone => 1.0,
    }
}

/// Weight of the mean square of the relative error over the sphere. The tail of a lobe is small compared with
/// its peak, but most pixels see a sun only through it. One or two boxes lose the peak at the weight used for
/// four.
const fn tail(shape: &Shape) -> f64 {
    if shape.boxes() < 4 { 3.0 } else { 30.0 }
}

/// Weight of the fourth power of an error, in units of the peak, relative to its square.
const SHARPNESS: f64 = 100.0;

/// A lobe around one direction, averaged over cells of several sizes.
pub(super) struct Problem {
    shape: &'static Shape,
    alpha: f64,
    /// Half-width of each box's blur.
    blurs: Vec<f64>,
    centre: DVec2,
    /// Amplitude per unit of mass.
    scale: f64,
    levels: Vec<OctaveLevel>,
}

/// Square cells around the lobe's centre.
struct OctaveLevel {
    low: DVec2,
    cell: f64,
    /// Weight of a squared error.
    weights: Vec<f64>,
    /// Mean of the lobe over each cell, in units of its peak.
    target: Vec<f64>,
    /// The harmonics' kernels, in the same units.
    harmonics: Vec<[f64; HARMONICS]>,
}

/// Sums over cells: a quadratic around the parameters.
pub(super) struct Quadratic {
    pub(super) value: f64,
    pub(super) gradient: Vec<f64>,
    /// Row-major, lower half.
    pub(super) hessian: Vec<f64>,
}

/// One axis of one image of a soft box: mean over each cell, divided by the box's width, and its derivatives.
struct Profile {
    value: [f64; CELLS],
    by_offset: [f64; CELLS],
    by_log: [f64; CELLS],
}

struct Image {
    index: usize,
    u: Profile,
    v: Profile,
}

impl Problem {
    /// The lobe of `alpha` around `centre` in the plane, for boxes of `shape` in the octave of blurs
    /// 2^-`octave` wide.
    pub(super) fn new(shape: &'static Shape, octave: u32, alpha: f64, centre: DVec2) -> Self {
        let blurs: Vec<f64> =
            shape.wider.iter().map(|wider| (f64::from(*wider) - f64::from(octave)).exp2()).collect();
        let around = direction_from_oct(wrap_oct(centre));
        let integral = lobe::kernel_integral(Lobe::Ggx, alpha);
        let peak = lobe::kernel(Lobe::Ggx, alpha, 0.0) / integral;
        // A constant kernel, in units of the peak.
        let even = 1.0 / (4.0 * PI * peak);
        let lobe_at = |point: DVec2| {
            let s = direction_from_oct(wrap_oct(point)).distance_squared(around) / 4.0;
            lobe::kernel(Lobe::Ggx, alpha, s) / integral / peak
        };
        let mut levels: Vec<OctaveLevel> = Vec::new();
        let mut cell = alpha / FINENESS;
        while levels.last().is_none_or(|level| level.cell * (CELLS as f64) < 3.0) {
            let low = centre - cell * (CELLS / 2) as f64;
            let mut level =
                OctaveLevel { low, cell, weights: Vec::new(), target: Vec::new(), harmonics: Vec::new() };
            let count = coarser(shape).powi(levels.len() as i32) * cell * cell / (alpha * alpha);
            for (i, j) in (0..CELLS).flat_map(|j| (0..CELLS).map(move |i| (i, j))) {
                let at = |x: f64, y: f64| low + DVec2::new(i as f64 + x, j as f64 + y) * cell;
                let middle = at(0.5, 0.5);
                let density = solid_angle_density(wrap_oct(middle));
                let inner = (CELLS / 4..CELLS - CELLS / 4).contains(&i)
                    && (CELLS / 4..CELLS - CELLS / 4).contains(&j);
                let target = match levels.last() {
                    Some(finer) if inner => {
                        let (i, j) = (2 * (i - CELLS / 4), 2 * (j - CELLS / 4));
                        let finer = |i: usize, j: usize| finer.target[j * CELLS + i];
                        (finer(i, j) + finer(i + 1, j) + finer(i, j + 1) + finer(i + 1, j + 1)) / 4.0
                    }
                    _ => {
                        let thirds = [1.0 / 6.0, 0.5, 5.0 / 6.0];
                        let points = thirds.iter().flat_map(|y| thirds.map(|x| lobe_at(at(x, *y))));
                        points.sum::<f64>() / 9.0
                    }
                };
                level.target.push(target);
                // Count each place once, in the finest cells around it, relative to the lobe or to a constant
                // lobe where that is larger.
                let tail = if inner && !levels.is_empty() {
                    0.0
                } else {
                    tail(shape) * cell * cell / (4.0 * PI) / (target + even).powi(2)
                };
                level.weights.push((count + tail) * density);
                let cosine = direction_from_oct(wrap_oct(middle)).dot(around);
                level.harmonics.push(zonal_kernels(cosine).map(|value| value / peak));
            }
            levels.push(level);
            cell *= 2.0;
        }
        let scale = 1.0 / (solid_angle_density(wrap_oct(centre)) * peak);
        Self { shape, alpha, blurs, centre, scale, levels }
    }

    /// The distance of the kernel of `x` (with square roots of masses) from the lobe. With `derivatives`,
    /// also its gradient and the Gauss-Newton approximation of its Hessian.
    pub(super) fn quadratic(&self, x: &[f64], derivatives: bool) -> Quadratic {
        let count = x.len();
        let boxes = self.shape.boxes();
        let mut sums =
            Quadratic { value: 0.0, gradient: vec![0.0; count], hessian: vec![0.0; count * count] };
        let mut row = vec![0.0; count];
        for level in &self.levels {
            let images = self.images(x, level);
            for j in 0..CELLS {
                let active: Vec<&Image> = images.iter().filter(|image| image.v.value[j] != 0.0).collect();
                for i in 0..CELLS {
                    let k = j * CELLS + i;
                    row.fill(0.0);
                    let mut model = 0.0;
                    for image in &active {
                        let (u, v) = (&image.u, &image.v);
                        if u.value[i] == 0.0 {
                            continue;
                        }
                        let at = image.index * BOX_PARAMETERS;
                        let root = x[at];
                        let amplitude = root * root * self.scale;
                        let profile = u.value[i] * v.value[j];
                        model += amplitude * profile;
                        row[at] += 2.0 * root * self.scale * profile;
                        row[at + 1] += amplitude * u.by_offset[i] * v.value[j];
                        row[at + 2] += amplitude * u.value[i] * v.by_offset[j];
                        row[at + 3] += amplitude * u.by_log[i] * v.value[j];
                        row[at + 4] += amplitude * u.value[i] * v.by_log[j];
                    }
                    for (l, kernel) in level.harmonics[k].iter().enumerate() {
                        let at = boxes * BOX_PARAMETERS + l;
                        model += x[at] * kernel;
                        row[at] = *kernel;
                    }
                    let (error, weight) = (model - level.target[k], level.weights[k]);
                    let square = error * error;
                    sums.value += weight * square * (1.0 + SHARPNESS * square);
                    if !derivatives {
                        continue;
                    }
                    let slope = weight * error * (1.0 + 2.0 * SHARPNESS * square);
                    let curvature = weight * (1.0 + 4.0 * SHARPNESS * square);
                    for a in 0..count {
                        if row[a] == 0.0 {
                            continue;
                        }
                        sums.gradient[a] += slope * row[a];
                        let scaled = curvature * row[a];
                        for (sum, other) in sums.hessian[a * count..=a * count + a].iter_mut().zip(&row[..=a])
                        {
                            *sum += scaled * other;
                        }
                    }
                }
            }
        }
        sums
    }

    /// The boxes of `x` and their images in the unfolded plane that reach into `level`.
    fn images(&self, x: &[f64], level: &OctaveLevel) -> Vec<Image> {
        let mut images = Vec::new();
        let half_window = level.cell * (CELLS / 2) as f64;
        for (index, blur) in self.blurs.iter().enumerate() {
            let [_, cu, cv, lu, lv] = x[index * BOX_PARAMETERS..][..BOX_PARAMETERS] else { unreachable!() };
            let half = DVec2::new(lu, lv).exp2() * self.alpha;
            let offset = DVec2::new(cu, cv);
            let centre = self.centre + offset * half;
            for (i, j) in (-2..=2).flat_map(|j| (-2..=2).map(move |i| (i, j))) {
                // Odd tiles are rotated by 180 degrees.
                let sign = if (i + j) % 2 == 0 { 1.0 } else { -1.0 };
                let image = sign * centre + 2.0 * DVec2::new(f64::from(i), f64::from(j));
                let apart = (image - self.centre).abs() - half - blur - half_window;
                if apart.max_element() < 0.0 {
                    let u = profile(level.low.x, level.cell, image.x, half.x, *blur, sign, offset.x);
                    let v = profile(level.low.y, level.cell, image.y, half.y, *blur, sign, offset.y);
                    images.push(Image { index, u, v });
                }
            }
        }
        images
    }
}

fn profile(low: f64, cell: f64, centre: f64, half: f64, blur: f64, sign: f64, offset: f64) -> Profile {
    let mut profile = Profile { value: [0.0; CELLS], by_offset: [0.0; CELLS], by_log: [0.0; CELLS] };
    for i in 0..CELLS {
        let left = low + i as f64 * cell - centre;
        if left > half + blur || left + cell < -half - blur {
            continue;
        }
        // The mean over the cell is a difference of second integrals of the tent.
        let arguments = [left + cell + half, left + half, left + cell - half, left - half];
        let [a, b, c, d] = arguments.map(|argument| blur * tent_second_integral(argument / blur));
        let [da, db, dc, dd] = arguments.map(|argument| tent_integral(argument / blur));
        let value = (a - b - c + d) / cell;
        let by_half = (da - db + dc - dd) / cell;
        let by_centre = (db - da + dc - dd) / cell;
        profile.value[i] = value / (2.0 * half);
        profile.by_offset[i] = sign * by_centre / 2.0;
        profile.by_log[i] = LN_2 * ((by_half + sign * offset * by_centre) / 2.0 - value / (2.0 * half));
    }
    profile
}

/// Integral up to `t` of the tent of half-width and area 1.
fn tent_integral(t: f64) -> f64 {
    if t <= -1.0 {
        0.0
    } else if t <= 0.0 {
        (1.0 + t) * (1.0 + t) / 2.0
    } else if t < 1.0 {
        1.0 - (1.0 - t) * (1.0 - t) / 2.0
    } else {
        1.0
    }
}

/// Integral up to `t` of [`tent_integral`].
fn tent_second_integral(t: f64) -> f64 {
    let rest = (1.0 - t.abs()).max(0.0);
    rest * rest * rest / 6.0 + t.max(0.0)
}

/// (2l + 1)/4pi P_l for l = 0 to 4: the kernels that select each order of harmonics.
fn zonal_kernels(cosine: f64) -> [f64; HARMONICS] {
    let legendre = lobe::legendre(cosine);
    std::array::from_fn(|l| legendre[l] * (2 * l + 1) as f64 / (4.0 * PI))
}

#[cfg(test)]
mod tests {
    use super::*;
    use octagloss::internals::realtime::tables::Table;

    #[test]
    fn derivatives_are_those_of_differences() {
        let shape = Table::of(2).expect("there are two").shape();
        let problem = Problem::new(shape, 3, 0.15, DVec2::new(0.8, 0.1));
        let x = [0.7, 0.3, -0.2, 0.1, 0.4, 0.6, -0.5, 0.4, 1.1, 0.9, 0.1, -0.03, 0.05, 0.02, -0.01];
        let found = problem.quadratic(&x, true);
        for k in 0..x.len() {
            let at = |step: f64| {
                let mut x = x;
                x[k] += step;
                problem.quadratic(&x, false).value
            };
            // Half the gradient, as usual for least squares.
            let expected = (at(1e-5) - at(-1e-5)) / 4e-5;
            let apart = (found.gradient[k] - expected).abs();
            assert!(apart < 1e-6 * expected.abs().max(1e-3), "{k}: {} for {expected}", found.gradient[k]);
        }
    }
}
