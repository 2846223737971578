//! Below texels: a texel's tent cut into pieces, for lobes sharper than the OEM.

use super::adaptive::Leaves;
use super::cells::Cells;
use super::kernel::Kernel;
use crate::environment::LUMINANCE;
use crate::sphere::octahedral::{direction_from_oct, texel_centre, wrap_oct};
use glam::{DVec2, DVec3};

/// Pieces are halved at most this often: 2^-40 of a texel is finer than any lobe that is not served as a mirror.
const DEPTH: u8 = 40;

/// A rectangle of one quarter of the tent, in texels from its centre, both coordinates in [0, 1].
#[derive(Clone, Copy)]
struct Piece {
    low: DVec2,
    high: DVec2,
    depth: u8,
}

/// Mass, mean and variance of the density 1 - x on [a, b].
fn ramp(a: f64, b: f64) -> (f64, f64, f64) {
    let width = b - a;
    let middle = 0.5 * (a + b);
    let top = 1.0 - middle;
    // Centred: density top - t on [-w/2, w/2].
    let shift = -width * width / (12.0 * top);
    (width * top, middle + shift, (width * width / 12.0 - shift * shift).max(0.0))
}

/// Adds texel (`x`, `y`) to `leaves` in pieces, each with an interval within `tolerance`.
pub(super) fn refine(
    cells: &Cells,
    (x, y): (u32, u32),
    kernel: &Kernel,
    axis: DVec3,
    packet: f32,
    tolerance: f64,
    leaves: &mut Leaves,
) {
    let n = cells.n;
    let centre = texel_centre(n, x, y);
    let h = 2.0 / f64::from(n);
    let energy = cells.energies[y as usize * n as usize + x as usize];
    let luminance: f64 = (0..3).map(|c| f64::from(LUMINANCE[c]) * f64::from(energy[c])).sum();
    for signs in [DVec2::new(1.0, 1.0), DVec2::new(-1.0, 1.0), DVec2::new(1.0, -1.0), DVec2::new(-1.0, -1.0)]
    {
        let direction = |p: DVec2| direction_from_oct(wrap_oct(centre + signs * p * h));
        let mut stack = vec![Piece { low: DVec2::ZERO, high: DVec2::ONE, depth: 0 }];
        while let Some(Piece { low, high, depth }) = stack.pop() {
            let (mass_x, mean_x, variance_x) = ramp(low.x, high.x);
            let (mass_y, mean_y, variance_y) = ramp(low.y, high.y);
            let share = mass_x * mass_y;
            let mean = DVec2::new(mean_x, mean_y);
            let sides = DVec2::new(variance_x.sqrt(), variance_y.sqrt());
            // Two nodes a side with the density's mean and variance: third order in a smooth piece.
            let nodes = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)]
                .map(|(i, j)| direction(mean + sides * DVec2::new(i, j)));
            let centroid = nodes.iter().sum::<DVec3>() / 4.0;
            let spread = nodes.iter().map(|node| node.distance_squared(centroid)).sum::<f64>() / 4.0;
            let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
            let mut radius = corners.iter().map(|c| direction(*c).distance(centroid)).fold(0.0, f64::max);
            let offset = centroid - axis;
            let distance = offset.length() as f32;
            // A piece across a kink of the map has no exact centroid; halving ends on the kink or makes it negligible.
            let gap = if crosses_kink(centre + signs * low * h, centre + signs * high * h) {
                // No direction moves faster than 3 a unit of (u, v): |dl/d(u, v)| <= sqrt(3) |dp/d(u, v)| <= 3.
                radius = radius.max(3.0 * (high - low).length() * h).min(2.0);
                kernel.first_order_gap(distance, radius as f32, packet)
            } else {
                kernel.gap(distance, radius as f32, packet, spread as f32)
            };
            let gap = f64::from(gap) * luminance * share;
            if gap > tolerance && depth < DEPTH {
                let middle = (low + high) / 2.0;
                let depth = depth + 1;
                stack.push(Piece { low, high: middle, depth });
                stack.push(Piece {
                    low: DVec2::new(middle.x, low.y),
                    high: DVec2::new(high.x, middle.y),
                    depth,
                });
                stack.push(Piece {
                    low: DVec2::new(low.x, middle.y),
                    high: DVec2::new(middle.x, high.y),
                    depth,
                });
                stack.push(Piece { low: middle, high, depth });
                continue;
            }
            leaves.gap += gap;
            leaves.push(
                offset.as_vec3().to_array(),
                spread as f32,
                energy.map(|e| (f64::from(e) * share) as f32),
            );
        }
    }
}

/// Whether an axis, an edge of the square or a fold diagonal runs through the inside of the box from `a` to `b`.
fn crosses_kink(a: DVec2, b: DVec2) -> bool {
    let tiny = 1e-12;
    let between = |low: f64, high: f64, at: f64| low < at - tiny && high > at + tiny;
    let (low, high) = (a.min(b), a.max(b));
    let lines = [-1.0, 0.0, 1.0];
    if lines.iter().any(|at| between(low.x, high.x, *at) || between(low.y, high.y, *at)) {
        return true;
    }
    // Beyond the square the diagonals go on by the square's own reflection in its edges.
    let inside = |p: DVec2| wrap_oct(p).abs();
    let (low, high) = (inside(a), inside(b));
    let (low, high) = (low.min(high), low.max(high));
    between(low.x + low.y, high.x + high.y, 1.0)
}
