//! Footprints of texels: a texel's lobe is the mean of those around several directions R.
//!
//! Such directions are a distribution with a centroid c, a covariance K and a reach, as a cell's light is.
//! With both, s = |l - R|^2/4 = (1 - l.R)/2 has the mean (|m - c|^2 + tr C + tr K)/4, and the variance
//! (c.C.c + m.K.m + tr CK)/4, since light and direction are independent; it stays within the sum of the
//! reaches of |m - c|. The bounds of [`super::adaptive`] hold for it as they stand, with that mean, that
//! reach P and (m - c).(C + K).(m - c) for the variance. What this leaves out has a deviation of at most
//! sqrt(tr C r^2/4 + tr K q^2/4 + tr C tr K), for reaches r and q, and so of less than the
//! sqrt(tr C + tr K) P/2 that is allowed for. A tint's second order gains 2 D.K.m + tr QK, of which
//! 2 D.K.(m - c) is used. The rest is at most X r q^2 P; the allowance for the quadrupole's radial part,
//! X P^3 (P/4 + |m - c|), exceeds its own need, which has r for P, by as much and more:
//! P^4 - r^4 > 4 r q^2 P.
//!
//! So light from afar is evaluated once for each texel, and only what is near for each direction.

use super::leaves::{LANES, Packet};
use crate::common::vector::Fused as _;
use crate::geometry::tent::Moments;
use glam::DVec3;

/// Covariances by lanes: xx, yy, zz, yz, zx, xy.
pub(super) type Covariance = [[f32; LANES]; 6];

/// The footprints of up to [`LANES`] texels side by side.
#[derive(Debug)]
pub(crate) struct Footprints {
    /// Their centroids.
    pub(super) packet: Packet,
    pub(super) covariance: Covariance,
}

impl Footprints {
    /// Footprints of unit directions, each with its weight.
    ///
    /// # Panics
    /// If there are no footprints, or more than [`LANES`].
    pub(crate) fn new<'a>(footprints: impl Iterator<Item = (&'a [DVec3], &'a [f32])>) -> Self {
        let (mut centroids, mut covariance) = (Vec::with_capacity(LANES), [[0.0; LANES]; 6]);
        let (mut reach, mut trace) = (0.0_f64, 0.0_f64);
        for (lane, (directions, weights)) in footprints.enumerate() {
            let per_total = 1.0 / weights.iter().map(|weight| f64::from(*weight)).sum::<f64>();
            let weighted =
                || directions.iter().zip(weights).map(|(d, weight)| (*d, f64::from(*weight) * per_total));
            let moments = Moments::from_weighted(weighted());
            reach = directions.iter().map(|d| d.distance(moments.centroid)).fold(reach, f64::max);
            trace = trace.max(moments.diagonal.element_sum());
            let [xx, yy, zz] = moments.diagonal.to_array();
            let [yz, zx, xy] = moments.mixed.to_array();
            for (field, value) in covariance.iter_mut().zip([xx, yy, zz, yz, zx, xy]) {
                field[lane] = value as f32;
            }
            centroids.push(moments.centroid);
        }
        let enlarged = |x: f64| (x * (1.0 + 1e-6)) as f32;
        let packet = Packet { reach: enlarged(reach), trace: enlarged(trace), ..Packet::new(&centroids) };
        Self { packet, covariance }
    }
}

/// The covariance of lane `k` times a vector.
#[inline(always)]
pub(super) fn applied(covariance: &Covariance, k: usize, [x, y, z]: [f32; 3]) -> [f32; 3] {
    let [xx, yy, zz, yz, zx, xy] = [0, 1, 2, 3, 4, 5].map(|field: usize| covariance[field][k]);
    [
        x.times_plus(xx, y.times_plus(xy, z * zx)),
        x.times_plus(xy, y.times_plus(yy, z * yz)),
        x.times_plus(zx, y.times_plus(yz, z * zz)),
    ]
}
