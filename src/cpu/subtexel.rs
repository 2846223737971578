//! Below texels: a texel's spread cut into pieces, for lobes sharper than the OEM and tolerances finer than
//! it.

use super::cells::Cells;
use super::leaves::{Leaf, Packet, Scratch};
use crate::environment::LUMINANCE;
use crate::geometry::tent::{Moments, Reconstruction};
use crate::lobe::kernel::{Radial, expected_error, first_order_width};
use crate::sphere::octahedral::{direction_from_oct, texel_centre, wrap_oct};
use glam::{DVec2, DVec3};

/// Pieces are halved at most this often: 2^-40 of a texel is finer than any lobe that is not served as a
/// mirror.
const DEPTH: u8 = 40;

/// A rectangle of one quarter of the spread, in texels from its centre.
#[derive(Clone, Copy)]
struct Piece {
    low: DVec2,
    high: DVec2,
    depth: u8,
}

/// Mass, mean and variance of the spread's density on [a, b], 0 <= a <= b.
fn slice(reconstruction: Reconstruction, a: f64, b: f64) -> (f64, f64, f64) {
    let (width, middle) = (b - a, 0.5 * (a + b));
    match reconstruction {
        Reconstruction::Constant => (width, middle, width * width / 12.0),
        Reconstruction::Bilinear => {
            // 1 - x: centred on the middle, top - t on [-w/2, w/2].
            let top = 1.0 - middle;
            let shift = -width * width / (12.0 * top);
            (width * top, middle + shift, (width * width / 12.0 - shift * shift).max(0.0))
        }
    }
}

/// Adds texel (`x`, `y`) to the leaves in pieces, each with an interval within the tolerance.
pub(super) fn refine<R: Radial>(
    (cells, tolerance): (&Cells, f64),
    kernel: R,
    (x, y): (u32, u32),
    packet: &Packet,
    scratch: &mut Scratch,
) {
    let n = cells.n;
    let centre = texel_centre(n, x, y);
    let h = 2.0 / f64::from(n);
    let energy = cells.energies[y as usize * n as usize + x as usize];
    let luminance: f64 = (0..3).map(|c| f64::from(LUMINANCE[c]) * f64::from(energy[c])).sum();
    let reach = cells.reconstruction.reach();
    let mut stack = Vec::new();
    for signs in [DVec2::new(1.0, 1.0), DVec2::new(-1.0, 1.0), DVec2::new(1.0, -1.0), DVec2::new(-1.0, -1.0)]
    {
        let direction = |p: DVec2| direction_from_oct(wrap_oct(centre + signs * p * h));
        stack.push(Piece { low: DVec2::ZERO, high: DVec2::splat(reach), depth: 0 });
        while let Some(Piece { low, high, depth }) = stack.pop() {
            let (mass_x, mean_x, variance_x) = slice(cells.reconstruction, low.x, high.x);
            let (mass_y, mean_y, variance_y) = slice(cells.reconstruction, low.y, high.y);
            let share = mass_x * mass_y;
            let mean = DVec2::new(mean_x, mean_y);
            let sides = DVec2::new(variance_x.sqrt(), variance_y.sqrt());
            // Two nodes a side with the density's mean and variance: third order in a smooth piece.
            let nodes = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)]
                .map(|(i, j)| (direction(mean + sides * DVec2::new(i, j)), 0.25));
            let mut moments = Moments::of(nodes.into_iter());
            let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
            moments.radius =
                corners.iter().map(|c| direction(*c).distance(moments.centroid)).fold(0.0, f64::max);
            let offset: DVec3 = moments.centroid - packet.axis;
            let distance = offset.length() as f32;
            // A piece across a kink of the map has no exact centroid; halving ends on the kink or makes it
            // negligible.
            let kinked = crosses_kink(centre + signs * low * h, centre + signs * high * h);
            let error = if kinked {
                // No direction moves faster than 3 a unit of (u, v): |dl/d(u, v)| <= sqrt(3) |dp/d(u, v)| <=
                // 3.
                moments.radius = moments.radius.max(3.0 * (high - low).length() * h).min(2.0);
                first_order_width(kernel, distance, moments.radius as f32, packet.radius)
            } else {
                let trace = moments.diagonal.element_sum() as f32;
                expected_error(kernel, distance, moments.radius as f32, packet.radius, trace)
            };
            let error = f64::from(error) * luminance * share;
            if error > tolerance && depth < DEPTH {
                let (middle, depth) = ((low + high) / 2.0, depth + 1);
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
            if kinked {
                scratch.slack += error;
            }
            let (diagonal, mixed) = (moments.diagonal.as_vec3(), moments.mixed.as_vec3());
            scratch.leaves.push(Leaf {
                offset: offset.as_vec3().to_array(),
                covariance: [diagonal.x, diagonal.y, diagonal.z, mixed.x, mixed.y, mixed.z],
                radius: (moments.radius * (1.0 + 1e-6)) as f32,
                energy: energy.map(|e| (f64::from(e) * share) as f32),
            });
        }
    }
}

/// Whether an axis, an edge of the square or a fold diagonal runs through the inside of the box from `a` to
/// `b`.
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
