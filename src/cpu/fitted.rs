//! The real-time tier: GGX lobes as a few soft boxes and a zonal harmonic term, see
//! [`crate::realtime::tables`].

use super::mirror;
use crate::environment::Rgb;
use crate::lobe::{self, Lobe};
use crate::oem::Oem;
use crate::realtime::emitters::Emitter;
use crate::realtime::tables::triangle::triangle_from_oct;
use crate::realtime::tables::{HARMONICS, KNOTS, OCTAVES, Table};
use crate::sat::Sat;
use crate::sh::basis;
use crate::smoothstep::smoothstep;
use crate::sphere::octahedral::{oct_from_direction, solid_angle_density};
use glam::{DVec2, DVec3};

/// Roughness above which harmonics blend in with the boxes.
pub(crate) const HARMONICS_FROM: f64 = 0.65;
/// Roughness above which harmonics replace the boxes.
pub(crate) const HARMONICS_ALONE: f64 = 0.75;

/// The finest octave in use, whose tables have 1024 x 1024 texels: lobes from roughness 0.1 up.
const FINEST: u32 = 7;

/// The finest octave over an OEM of `inner` texels: blurs are at least four texels wide.
#[must_use]
pub(crate) fn finest_octave(inner: u32) -> u32 {
    (inner / 4).ilog2().min(FINEST)
}

/// The octaves around one alpha and their weights: the octave of alpha and, in its first quarter, the next
/// finer one, which fades out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Octaves {
    pub(crate) own: u32,
    /// The share of the next finer octave.
    pub(crate) finer: f64,
}

impl Octaves {
    /// The octaves around `alpha`, up to `finest`.
    pub(crate) fn around(alpha: f64, finest: u32) -> Self {
        let [first, .., last] = KNOTS;
        let own = (first - alpha.log2()).ceil().clamp(f64::from(*OCTAVES.start()), f64::from(finest)) as u32;
        let position = alpha.log2() + f64::from(own);
        let finer =
            if own < finest { 1.0 - smoothstep((position - first) / (last - first - 1.0)) } else { 0.0 };
        Self { own, finer }
    }
}

/// Squared sines of the angle from a cone point between which the table around cone points fades out: those
/// of 0.2 and 0.3 radians.
pub(crate) const CONE: [f64; 2] = [0.039, 0.087];

/// Alphas between which that table fades in: the other one fits sharper lobes better.
pub(crate) const CONE_ALPHA: [f64; 2] = [0.01, 0.0125];

/// The share of the parameters around cone points in a lobe of `alpha` around the unit vector `direction`.
fn cone_share(direction: DVec3, alpha: f64) -> f64 {
    let square = direction * direction;
    let far = smoothstep((square.y + square.x.min(square.z) - CONE[0]) / (CONE[1] - CONE[0]));
    (1.0 - far) * smoothstep((alpha - CONE_ALPHA[0]) / (CONE_ALPHA[1] - CONE_ALPHA[0]))
}

/// GGX lobes of one alpha by one table of parameters.
#[derive(Debug)]
pub(crate) struct Fitted<'a> {
    oem: &'a Oem,
    emitters: &'a [Emitter],
    least: Rgb,
    /// The share of the mirror.
    mirror: f64,
    table: &'static Table,
    /// The table for directions around cone points.
    cone: Option<&'static Table>,
    /// The sharpest alpha that the tables resolve, or the lobe's own.
    alpha: f64,
    /// The lobe's integral over the sphere.
    integral: f64,
    /// Octaves and their shares; empty if harmonics replace the boxes.
    parts: Vec<(u32, f64)>,
    /// Blurred tables by octave; only those in use.
    blurred: Vec<Option<&'a Sat>>,
    harmonics: &'a [[f64; 4]; 25],
    /// Weights of the orders where harmonics replace the boxes, times their share.
    alone: [f64; HARMONICS],
}

impl<'a> Fitted<'a> {
    /// Lobes of `alpha` in [0, 1] over `oem`, whose size is a power of two and at least 16. `least` (least
    /// radiance), `blurred` (SAT blurred by a tent of half-width 2^-octave) and `harmonics` belong to the
    /// residual map without `emitters`.
    pub(crate) fn new(
        table: &'static Table,
        alpha: f64,
        oem: &'a Oem,
        emitters: &'a [Emitter],
        least: Rgb,
        blurred: &dyn Fn(u32) -> &'a Sat,
        harmonics: &'a [[f64; 4]; 25],
    ) -> Self {
        let finest = finest_octave(oem.size().inner);
        // A lobe sharper than the finest blur blends the lobe of that blur with the mirror, smoothly at both
        // ends. The tail of a lobe is proportional to alpha^2.
        let sharpest = (KNOTS[0] - f64::from(finest)).exp2();
        let square = (alpha / sharpest).min(1.0).powi(2);
        let share = square * (2.0 - square);
        let alpha = alpha.max(sharpest);
        let alone = smoothstep((alpha.sqrt() - HARMONICS_FROM) / (HARMONICS_ALONE - HARMONICS_FROM));
        let mut parts = Vec::new();
        let mut read = vec![None; finest as usize + 1];
        if alone < 1.0 && share > 0.0 {
            let Octaves { own, finer } = Octaves::around(alpha, finest);
            let shares = [(own, (1.0 - alone) * (1.0 - finer)), (own + 1, (1.0 - alone) * finer)];
            parts.extend(shares.into_iter().filter(|(_, share)| *share > 0.0));
            for (octave, _) in &parts {
                for wider in table.shape().wider {
                    let octave = octave - wider;
                    read[octave as usize] = Some(blurred(octave));
                }
            }
        }
        let weights = lobe::zonal_weights(Lobe::Ggx, alpha).map(|weight| alone * weight);
        Self {
            oem,
            emitters,
            least,
            mirror: 1.0 - share,
            table,
            cone: table.beside_cone_points(),
            alpha,
            integral: lobe::kernel_integral(Lobe::Ggx, alpha),
            parts,
            blurred: read,
            harmonics,
            alone: weights,
        }
    }

    /// Radiance of the lobe around the unit vector `direction` in the OEM's space.
    pub(crate) fn radiance(&self, direction: DVec3) -> Rgb {
        let mut sum = [0.0; 3];
        let mut add = |share: f64, [r, g, b, w]: [f64; 4]| {
            for (sum, (value, least)) in sum.iter_mut().zip([r, g, b].into_iter().zip(self.least)) {
                // Clamp to the least radiance: no lobe is darker than the darkest texel, but harmonics ring
                // and turn negative opposite a sun.
                *sum += share * (value / w).max(f64::from(least));
            }
        };
        if self.mirror < 1.0 {
            // Contribution of each order of the harmonics in this direction.
            let mut orders = [[0.0; 4]; HARMONICS];
            for (k, (basis, coefficients)) in basis(direction).iter().zip(self.harmonics).enumerate() {
                for (order, coefficient) in orders[k.isqrt()].iter_mut().zip(coefficients) {
                    *order += basis * coefficient;
                }
            }
            let uv = oct_from_direction(direction);
            let cone = self.cone.map(|table| (table, cone_share(direction, self.alpha)));
            let rest = 1.0 - cone.map_or(0.0, |(_, share)| share);
            let tables = std::iter::once((self.table, rest)).chain(cone);
            for (table, share_of_table) in tables.filter(|(_, share)| *share > 0.0) {
                for (octave, share) in &self.parts {
                    let energy = self.boxes(table, *octave, uv, &orders);
                    add((1.0 - self.mirror) * share * share_of_table, energy);
                }
            }
            // The first weight is the share.
            if self.alone[0] > 0.0 {
                add((1.0 - self.mirror) * self.alone[0], weighted(&self.alone, &orders));
            }
            for emitter in self.emitters {
                for (sum, value) in sum.iter_mut().zip(emitter.radiance(self.alpha, self.integral, direction))
                {
                    *sum += (1.0 - self.mirror) * value;
                }
            }
        }
        if self.mirror > 0.0 {
            for (sum, value) in sum.iter_mut().zip(mirror::radiance(self.oem, self.least, direction)) {
                *sum += self.mirror * f64::from(value);
            }
        }
        sum.map(|value| value as f32)
    }

    /// Energies and solid angle of the kernel of `table` and `octave` around `uv`.
    fn boxes(&self, table: &Table, octave: u32, uv: DVec2, orders: &[[f64; 4]; HARMONICS]) -> [f64; 4] {
        let (point, fold) = triangle_from_oct(uv);
        let density = solid_angle_density(uv);
        let mut sum = [0.0; 4];
        let weights = table.kernel(octave, self.alpha, point, |soft| {
            let table = self.blurred[soft.octave as usize].expect("made with the lobe");
            let scale = f64::from(table.size().inner) / 2.0;
            let centre = uv + fold.oct_from_triangle(soft.offset);
            let half = fold.oct_from_triangle(soft.half).abs();
            let energy = table.fractional_box((centre - half + 1.0) * scale, (centre + half + 1.0) * scale);
            let height = soft.mass / (4.0 * half.x * half.y * density);
            for (sum, energy) in sum.iter_mut().zip(energy) {
                *sum += height * energy;
            }
        });
        for (sum, value) in sum.iter_mut().zip(weighted(&weights, orders)) {
            *sum += value;
        }
        sum
    }
}

fn weighted(weights: &[f64; HARMONICS], orders: &[[f64; 4]; HARMONICS]) -> [f64; 4] {
    std::array::from_fn(|channel| {
        weights.iter().zip(orders).map(|(weight, order)| weight * order[channel]).sum()
    })
}
