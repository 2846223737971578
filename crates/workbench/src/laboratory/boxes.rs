//! Box filters over the tables of any map: one box, or a stack that steps down with the lobe.

use super::charts::Piece;
use super::tables::Tables;
use glam::{DVec2, DVec3};
use octagloss_core::cpu::box_filter::StackedBox;
use octagloss_core::lobe::{self, Lobe};
use std::f64::consts::PI;

/// A lobe's radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeAnswer {
    /// Red, green, blue.
    pub radiance: [f64; 3],
    /// Table entries read.
    pub reads: usize,
}

/// The weighted energy of the boxes of `stack` over their weighted solid angle around `direction`. A
/// one-texel box is added in quadrature, as in the engines.
pub fn radiance(tables: &Tables, stack: &[StackedBox], direction: DVec3) -> LobeAnswer {
    let (grid, charts) = (&tables.grid, tables.charts);
    let place = grid.map().locate(direction);
    let component = grid.map().component(place.component);
    let step = grid.step(&component);
    let centre = (place.uv - component.low) / step;
    let (mut sum, mut reads) = ([0.0; 4], 0);
    for StackedBox { solid_angle, weight } in stack {
        let sides = charts.sides(place, *solid_angle) / step;
        let half = 0.5 * DVec2::new(sides.x.hypot(1.0), sides.y.hypot(1.0));
        let piece = Piece { component: place.component, low: centre - half, high: centre + half };
        let (part, read) = tables.fractional(piece);
        sum.iter_mut().zip(part).for_each(|(sum, value)| *sum += weight * value);
        reads += read;
    }
    let [r, g, b, solid_angle] = sum;
    LobeAnswer { radiance: [r, g, b].map(|energy| energy / solid_angle), reads }
}

/// Steps in which the stack's kernel is integrated.
const STEPS: u32 = 4096;

/// `count` nested boxes for a decreasing `lobe` at `alpha`: caps that divide the lobe's energy evenly, each
/// with the lobe's mean value in its ring.
///
/// With K_j the mean in ring j and A_j the solid angle up to it, the sum of (K_j - K_(j+1)) over boxes of
/// A_j is K_j in every ring.
pub fn stack(lobe: Lobe, alpha: f64, count: u32) -> Vec<StackedBox> {
    // Equal steps in ln(s + alpha^2 / 4), around which the kernel changes.
    let near = alpha * alpha / 4.0;
    let length = ((0.5 + near) / near).ln();
    let at = |k: u32| near * (length * f64::from(k) / f64::from(STEPS)).exp() - near;
    let slices: Vec<(f64, f64)> = (0..STEPS)
        .map(|k| {
            let (from, to) = (at(k), at(k + 1));
            (to, 4.0 * PI * (to - from) * lobe::kernel(lobe, alpha, f64::midpoint(from, to)))
        })
        .collect();
    let total: f64 = slices.iter().map(|(_, energy)| energy).sum();
    let mut rings: Vec<(f64, f64)> = Vec::new();
    let (mut sum, mut before, mut inner) = (0.0, 0.0, 0.0);
    for (end, energy) in slices {
        sum += energy;
        let due = total * (rings.len() + 1) as f64 / f64::from(count);
        if sum >= due * (1.0 - 1e-12) {
            let solid_angle = 4.0 * PI * end;
            rings.push((solid_angle, (sum - before) / (solid_angle - inner)));
            (before, inner) = (sum, solid_angle);
        }
    }
    let next = rings.iter().skip(1).map(|(_, mean)| *mean).chain([0.0]);
    rings
        .iter()
        .zip(next)
        .map(|((solid_angle, mean), next)| StackedBox { solid_angle: *solid_angle, weight: mean - next })
        .collect()
}
