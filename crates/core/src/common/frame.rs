//! A point of a surface that is looked at.

use crate::common::direction::unit;
use glam::{DMat3, DVec2, DVec3};

/// The least n.v: views below are turned up to it.
pub const LEAST_COSINE: f64 = 0.01;

/// A point of a surface that is looked at: axes of the surface, and the view in them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Tangent, bitangent and normal, as columns.
    pub axes: DMat3,
    /// Towards the viewer along those axes, a unit vector with z of at least [`LEAST_COSINE`].
    pub view: DVec3,
    /// Whether there was a tangent. Without one, reflections are isotropic.
    pub has_tangent: bool,
}

impl Frame {
    /// The frame of vectors of any length, or `None` if `normal` or `view` is zero or one is not finite.
    ///
    /// A `view` from below the surface, or almost along it, is turned up to [`LEAST_COSINE`]. Of the
    /// `tangent` counts what is at right angles to the normal; if nothing is, it is any.
    pub fn new(normal: DVec3, view: DVec3, tangent: DVec3) -> Option<Self> {
        let (normal, view) = (unit(normal)?, unit(view)?);
        if !tangent.is_finite() {
            return None;
        }
        let along = unit(tangent).map_or(DVec3::ZERO, |tangent| tangent - normal * normal.dot(tangent));
        let has_tangent = along.length_squared() > 1e-12;
        let along = if has_tangent { along.normalize() } else { normal.any_orthonormal_vector() };
        let axes = DMat3::from_cols(along, normal.cross(along), normal);
        let mut view = axes.transpose() * view;
        if view.z < LEAST_COSINE {
            let level = view.truncate().normalize_or(DVec2::X) * (1.0 - LEAST_COSINE * LEAST_COSINE).sqrt();
            view = level.extend(LEAST_COSINE);
        }
        Some(Self { axes, view, has_tangent })
    }
}
