//! Adds a moving lamp to an OEM; the other light stays.

use crate::device::stage::Dispatch;
use crate::{Context, OemPlanes, Stage};
use glam::DVec3;

/// Invocations along an edge of a workgroup.
pub const EDGE: u32 = 16;

/// A uniform white disc with a soft edge, at infinity.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Lamp {
    /// Unit direction in the OEM's space.
    towards: [f32; 3],
    /// Radiance of the disc; 0 by default.
    radiance: f32,
    /// Squared distance on the unit sphere up to which its radiance is constant.
    disc: f32,
    /// Squared distance on the unit sphere beyond which it is dark.
    edge: f32,
    pad: [f32; 2],
}

impl Lamp {
    /// A lamp in direction `towards` (of any length but zero), uniform up to `disc` radians from it and dark
    /// from `edge` > `disc` radians on.
    #[must_use]
    pub fn new(towards: DVec3, radiance: f32, disc: f64, edge: f64) -> Self {
        let squared_chord = |angle: f64| (2.0 * (angle / 2.0).sin()).powi(2) as f32;
        Self {
            towards: towards.normalize().as_vec3().to_array(),
            radiance,
            disc: squared_chord(disc),
            edge: squared_chord(edge),
            pad: [0.0; 2],
        }
    }

    /// Creates the uniform buffer; rewrite it when the lamp moves.
    #[must_use]
    pub fn buffer(&self, context: &Context) -> wgpu::Buffer {
        context.uniform("lamp", self)
    }

    /// Direction of the lamp, a unit vector in the OEM's space.
    pub fn direction(&self) -> DVec3 {
        DVec3::from_array(self.towards.map(f64::from)).normalize_or_zero()
    }

    /// Angle from the centre at which it is dark.
    pub fn edge_angle(&self) -> f64 {
        2.0 * (f64::from(self.edge).sqrt() / 2.0).clamp(0.0, 1.0).asin()
    }

    /// Radiance of the lamp in the unit `direction`.
    #[must_use]
    pub fn radiance_towards(&self, direction: DVec3) -> f64 {
        let towards = DVec3::from_array(self.towards.map(f64::from));
        let [radiance, disc, edge] = [self.radiance, self.disc, self.edge].map(f64::from);
        if radiance == 0.0 {
            return 0.0;
        }
        radiance * ((edge - direction.distance_squared(towards)) / (edge - disc)).clamp(0.0, 1.0)
    }
}

/// Adds to `oem` the [`Lamp`] that the uniform buffer `lamp` holds when the stage runs.
pub fn stage(context: &Context, lamp: &wgpu::Buffer, oem: &OemPlanes) -> Stage {
    let resources = [oem.bindings(), vec![(5, lamp.as_entire_binding())]].concat();
    let groups = oem.table().side.div_ceil(EDGE);
    Stage::new("lamp", vec![Dispatch::new(context, ("lamp.wgsl", "lamp"), &resources, [groups, groups, 1])])
}
