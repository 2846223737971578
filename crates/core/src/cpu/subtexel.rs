//! Subdivides the finest cells, for sharp lobes and fine tolerances: the spread of a texel of the OEM, or
//! texels of the source.

use super::cells::{Members, SourceLight};
use super::leaves::{Leaf, LitPiece, Packet, Scratch};
use crate::common::vector::Fused as _;
use crate::cpu::leaves::weighted;
use crate::geometry::source_texels::Piece;
use crate::geometry::tent::{Moments, Patch, Reconstruction, Texel};
use crate::light::environment::Rgb;
use crate::lobe::radial::{Radial, expected_error, first_order_width};
use crate::sphere::octahedral::{direction_from_oct, texel_centre, wrap_oct};
use glam::{DVec2, DVec3, Vec3};

/// Texels of an OEM of `n` x `n`, with their energies above the least radiance.
pub(super) struct Spread<'a> {
    pub(super) n: u32,
    pub(super) reconstruction: Reconstruction,
    pub(super) energies: &'a [Rgb],
}

/// Texels of the source, with the least radiance of each channel.
pub(super) struct LitTexels<'a> {
    pub(super) members: &'a Members,
    pub(super) light: &'a SourceLight<'a>,
    pub(super) least: Vec3,
}

/// Most halvings of a piece: 2^-40 of a texel is finer than any lobe that is not served as a mirror.
const DEPTH: u8 = 40;

/// Pieces with longer sides in (u, v) have no exact centroid. The error of two nodes per axis, |d^4 l/du^4|
/// <= 216 over 4320 times the fourth power of the side, is below 5e-8 up to this length. Texels of maps of 64
/// and more along an edge are never so large.
pub(crate) const SMOOTH_SIDE: f64 = 1.0 / 32.0;

/// The spread's density on [a, b], 0 <= a <= b, along one axis: its mass, and two nodes with their shares of
/// it, which match its first three moments.
fn slice(reconstruction: Reconstruction, a: f64, b: f64) -> (f64, [(f64, f64); 2]) {
    let (width, middle) = (b - a, 0.5 * (a + b));
    let squared = width * width / 12.0;
    match reconstruction {
        Reconstruction::Constant => {
            let deviation = squared.sqrt();
            (width, [(middle - deviation, 0.5), (middle + deviation, 0.5)])
        }
        Reconstruction::Bilinear => {
            // Density 1 - x, in coordinates t around the middle: top - t on [-w/2, w/2].
            let top = 1.0 - middle;
            let shift = -squared / top;
            let deviation = (squared - shift * shift).sqrt();
            // Half of the third central moment over the third power of the deviation.
            let skew = shift * (shift * shift - 0.6 * squared) / (deviation * deviation * deviation);
            let root = (1.0 + skew * skew).sqrt();
            let node = |sign: f64| {
                (middle + shift + deviation * (skew + sign * root), 0.5 * (1.0 - sign * skew / root))
            };
            (width * top, [node(-1.0), node(1.0)])
        }
    }
}

/// Adds texel (`x`, `y`) to the leaves in pieces, each with an interval within the tolerance.
#[inline(always)]
pub(super) fn refine<R: Radial>(
    (spread, weights, tolerance): (&Spread<'_>, [f32; 3], f64),
    kernel: R,
    (x, y): (u32, u32),
    packet: &Packet,
    scratch: &mut Scratch,
) {
    let n = spread.n;
    let centre = texel_centre(n, x, y);
    let h = 2.0 / f64::from(n);
    let energy = spread.energies[y as usize * n as usize + x as usize];
    let weight = f64::from(weighted(energy, weights));
    let reach = spread.reconstruction.reach();
    let mut stack = Vec::new();
    for signs in [DVec2::new(1.0, 1.0), DVec2::new(-1.0, 1.0), DVec2::new(1.0, -1.0), DVec2::new(-1.0, -1.0)]
    {
        let direction = |p: DVec2| direction_from_oct(wrap_oct(centre + signs * p * h));
        stack.push(Piece::WHOLE);
        while let Some(piece) = stack.pop() {
            // Of the quarter of the spread, in texels from its centre.
            let [low, high] = piece.corners().map(|corner| corner * reach);
            let (mass_x, nodes_x) = slice(spread.reconstruction, low.x, high.x);
            let (mass_y, nodes_y) = slice(spread.reconstruction, low.y, high.y);
            let share = mass_x * mass_y;
            let nodes = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| {
                let ((x, weight_x), (y, weight_y)) = (nodes_x[i], nodes_y[j]);
                (direction(DVec2::new(x, y)), weight_x * weight_y)
            });
            let mut moments = Moments::from_weighted(nodes.into_iter());
            let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
            moments.radius =
                corners.iter().map(|c| direction(*c).distance(moments.centroid)).fold(0.0, f64::max);
            let offset: DVec3 = moments.centroid - packet.axis;
            let distance = offset.length() as f32;
            // A piece across a kink of the map, or a large one, has no exact centroid. Halving ends on the
            // kink or makes the piece negligible.
            let inexact = (high - low).max_element() * h > SMOOTH_SIDE
                || crosses_kink(centre + signs * low * h, centre + signs * high * h);
            let error = if inexact {
                // Directions move by at most 3 per unit of (u, v): |dl/d(u, v)| <= sqrt(3) |dp/d(u, v)| <= 3.
                moments.radius = moments.radius.max(3.0 * (high - low).length() * h).min(2.0);
                first_order_width(kernel, distance, moments.radius as f32, packet.radius)
            } else {
                let trace = moments.diagonal.element_sum() as f32;
                expected_error::<R, true>(kernel, distance, moments.radius as f32, packet.judged, trace)
            };
            let error = f64::from(error);
            if error * weight * share > tolerance && piece.depth < DEPTH {
                stack.extend(piece.quarters());
                continue;
            }
            let energy = energy.map(|e| f64::from(e) * share);
            if inexact {
                scratch.slack.iter_mut().zip(energy).for_each(|(slack, energy)| *slack += error * energy);
            }
            let energy = energy.map(|e| e as f32);
            scratch.leaves.push(Leaf::of_patch(&moments.into(), offset.as_vec3(), energy));
        }
    }
}

/// Pieces whose errors are estimated together.
const JUDGED_TOGETHER: usize = 16;

/// Adds the texels of the source in the refined cells to the leaves, in pieces where their intervals exceed
/// the tolerance. Light is constant over a texel's solid angle, and so are the pieces' moments exact.
#[inline(always)]
pub(super) fn refine_members<R: Radial>(
    (source, weights, tolerance): (&LitTexels<'_>, [f32; 3], f64),
    kernel: R,
    packet: &Packet,
    scratch: &mut Scratch,
) {
    let texels = &source.members.texels;
    let Scratch { refined, pieces, leaves, .. } = scratch;
    for (i, j) in refined.drain(..) {
        for run in source.members.in_cell(i, j) {
            let row = run.row;
            for column in run.column..run.column + run.count {
                let texel = texels.source_row(row) + texels.source_column(column);
                let above = source.light.radiance(texel) - source.least;
                let weight = weighted(above.to_array(), weights);
                if weight > 0.0 {
                    pieces.push(LitPiece { column, row, piece: Piece::WHOLE, above, weight });
                }
            }
        }
    }
    while !pieces.is_empty() {
        let rest = pieces.len().saturating_sub(JUDGED_TOGETHER);
        let count = pieces.len() - rest;
        let mut batch = [pieces[rest]; JUDGED_TOGETHER];
        batch[..count].copy_from_slice(&pieces[rest..]);
        pieces.truncate(rest);
        let mut found = [(Patch::default(), Vec3::ZERO, 0.0); JUDGED_TOGETHER];
        let [mut x, mut y, mut z] = [[0.0_f32; JUDGED_TOGETHER]; 3];
        let [mut reaches, mut traces, mut errors] = [[0.0_f32; JUDGED_TOGETHER]; 3];
        for (k, LitPiece { column, row, piece, .. }) in batch.iter().enumerate().take(count) {
            let (Texel { patch, solid_angle }, centroid) = if piece.depth == 0 {
                let texel = texels.at(*column, *row);
                (texel, texel.patch.centroid.as_dvec3())
            } else {
                texels.piece(*column, *row, *piece)
            };
            let offset = (centroid - packet.axis).as_vec3();
            (x[k], y[k], z[k], reaches[k]) = (offset.x, offset.y, offset.z, patch.radius);
            traces[k] = patch.diagonal.element_sum();
            found[k] = (patch, offset, solid_angle);
        }
        for k in 0..JUDGED_TOGETHER {
            let distance = x[k].times_plus(x[k], y[k].times_plus(y[k], z[k] * z[k])).sqrt();
            errors[k] = expected_error::<R, true>(kernel, distance, reaches[k], packet.judged, traces[k]);
        }
        for (k, lit) in batch.iter().enumerate().take(count) {
            let (patch, offset, solid_angle) = found[k];
            let error = f64::from(errors[k] * solid_angle) * f64::from(lit.weight);
            if error > tolerance && lit.piece.depth < DEPTH {
                pieces.extend(lit.piece.quarters().map(|piece| LitPiece { piece, ..*lit }));
            } else {
                leaves.push(Leaf::of_patch(&patch, offset, (lit.above * solid_angle).to_array()));
            }
        }
    }
}

/// Whether an axis, an edge of the square or a fold diagonal crosses the interior of the box from `a` to `b`.
fn crosses_kink(a: DVec2, b: DVec2) -> bool {
    let tiny = 1e-12;
    let between = |low: f64, high: f64, at: f64| low < at - tiny && high > at + tiny;
    let (low, high) = (a.min(b), a.max(b));
    let lines = [-1.0, 0.0, 1.0];
    if lines.iter().any(|at| between(low.x, high.x, *at) || between(low.y, high.y, *at)) {
        return true;
    }
    // Beyond the square, the diagonals continue by reflection in its edges.
    let inside = |p: DVec2| wrap_oct(p).abs();
    let (low, high) = (inside(a), inside(b));
    let (low, high) = (low.min(high), low.max(high));
    between(low.x + low.y, high.x + high.y, 1.0)
}
