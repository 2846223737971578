//! Structs that the shaders of scenes read: `shaders/common/view_parts.wgsl`, `shaders/view/scene.wgsl` and
//! `shaders/view/scene_pose.wgsl`.

use glam::DVec3;

/// Most probes, and most glossy parts.
pub const MAX_PROBES: usize = 8;

/// Invocations of a workgroup that places corners.
pub(crate) const POSE_GROUP: u32 = 64;

/// A corner of a triangle, in the space of its part.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct SceneCorner {
    /// Position.
    pub position: [f32; 3],
    pub(super) part: u32,
    /// Unit normal.
    pub normal: [f32; 3],
    /// Coordinate along the rows of textures.
    pub u: f32,
    /// Albedo of matte parts, linear.
    pub albedo: [f32; 3],
    /// Coordinate down the columns of textures.
    pub v: f32,
    /// Radiance that the surface emits.
    pub emission: [f32; 3],
    /// Distance to the farthest neighbouring corner along u or v, for the colour at the corner.
    pub(super) spread: f32,
}

impl SceneCorner {
    /// A corner at `position`.
    pub fn new(position: [f32; 3], normal: [f32; 3], albedo: [f32; 3], emission: [f32; 3]) -> Self {
        Self { position, normal, albedo, emission, ..Self::default() }
    }

    pub(super) fn place(&self) -> DVec3 {
        DVec3::from_array(self.position.map(f64::from))
    }

    /// The corner at (`u`, `v`) of textures.
    #[must_use]
    pub const fn at(self, [u, v]: [f32; 2]) -> Self {
        Self { u, v, ..self }
    }
}

/// A texture in [`super::texture::Texels`]; all 0 for none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct TextureUniform {
    pub(super) first: u32,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) modes: u32,
}

#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct PartUniform {
    pub(super) world_from_part: [[f32; 4]; 4],
    pub(super) reflectance: [f32; 3],
    pub(super) roughness: f32,
    pub(super) base: TextureUniform,
    pub(super) glow: TextureUniform,
    pub(super) probe: u32,
    pub(super) own: u32,
    pub(super) pad: [u32; 2],
}

#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct LightUniform {
    pub(super) towards: [f32; 3],
    pub(super) pad_0: f32,
    pub(super) lamp: [f32; 3],
    pub(super) pad_1: f32,
    pub(super) above: [f32; 3],
    pub(super) pad_2: f32,
    pub(super) below: [f32; 3],
    pub(super) pad_3: f32,
}

#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct PoseUniform {
    pub(super) centre: [f32; 3],
    pub(super) hidden: u32,
    pub(super) first: u32,
    pub(super) count: u32,
    pub(super) pad: [u32; 2],
}

#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct FrameUniform {
    pub(super) clip_from_world: [[f32; 4]; 4],
    pub(super) eye: [f32; 3],
    pub(super) exposure: f32,
    pub(super) low: [f32; 3],
    pub(super) proxy: u32,
    pub(super) high: [f32; 3],
    pub(super) probes: u32,
    pub(super) sphere: [f32; 4],
    pub(super) centres: [[f32; 4]; MAX_PROBES],
}
