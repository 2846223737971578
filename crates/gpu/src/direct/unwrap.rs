//! Draws triangles into tennis-ball maps by unwrapping their corners.
//!
//! Herron, *The Tennis-ball Map*, section 3: each panel is spherical coordinates around its own axis. A
//! corner goes to (phi, theta, distance) by equation 4, and rasterisation interpolates in between: an
//! approximation for finely cut triangles, whose error falls with the square of their size. In C_1 the
//! equation misprints atan2(a, -c), where C_1 is around +Z, and in both its sines are those of unit vectors.

use super::target::{NEAREST, check_format};
use super::{DirectMesh, DirectTarget, cleared};
use crate::Context;
use crate::device::resources::{Draw, group};
use crate::device::timer::Timer;
use crate::triangles::{DirectMap, check_near};
use octagloss_core::common::error::{Result, wrong};

/// What becomes of triangles across the half circle phi = pi, where unwrapping tears them: section 3.2. It
/// lies in the other panel; corners are at least pi / 4 away from a panel's rectangle if triangles span less
/// than pi / 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Remedy {
    /// They are drawn across the whole panel.
    Keep = 0,
    /// They are left out.
    Drop = 1,
    /// All corners go to one side, outside of the panel.
    OneSide = 2,
    /// Pixels are left out where a number vanishes that corners inside of the panel's rectangle have.
    Alpha = 3,
}

/// Uniform of a panel's draw.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Panel {
    panel: u32,
    remedy: u32,
    near: f32,
}

/// Pipelines for one format of output.
#[derive(Clone, Debug)]
pub struct Unwrap {
    context: Context,
    format: wgpu::TextureFormat,
    pipeline: wgpu::RenderPipeline,
}

/// Draws of a mesh into both panels.
#[derive(Clone, Debug)]
pub struct UnwrapFrame {
    pipeline: wgpu::RenderPipeline,
    groups: [wgpu::BindGroup; 2],
    colour: wgpu::TextureView,
    depth: wgpu::TextureView,
    corners: u32,
    size: u32,
}

impl Unwrap {
    /// Compiles the pipeline for targets whose colour has `format`.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for formats other than `Rgba16Float` and
    /// `Rgba32Float`.
    pub fn new(context: &Context, format: wgpu::TextureFormat) -> Result<Self> {
        check_format(format)?;
        let draw = Draw {
            file: "direct/unwrap.wgsl",
            entries: ["unwrap_corner", "unwrapped_pixel"],
            groups: &[],
            corners: None,
            target: format.into(),
            depth: Some(NEAREST),
        };
        Ok(Self { context: context.clone(), format, pipeline: draw.pipeline(context) })
    }

    /// Binds the triangles of `mesh`, which span less than pi / 2 each, to `target`. Points nearer than
    /// `near` are cut away; depth is `near` over the distance.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for a target of another map or format and for an
    /// invalid `near`.
    pub fn frame(
        &self,
        remedy: Remedy,
        mesh: &DirectMesh,
        target: &DirectTarget,
        near: f32,
    ) -> Result<UnwrapFrame> {
        check_near(near)?;
        target.has_format(self.format)?;
        let DirectMap::TennisBall { size } = target.map() else {
            return wrong(format!(
                "corners cannot be unwrapped into {:?}; choose a tennis-ball map",
                target.map()
            ));
        };
        let groups = [0, 1].map(|panel| {
            let uniform = self.context.uniform("panel", &Panel { panel, remedy: remedy as u32, near });
            let resources = [&uniform, &mesh.corners, &mesh.indices].map(wgpu::Buffer::as_entire_binding);
            group(&self.context, "panel", &self.pipeline.get_bind_group_layout(0), resources)
        });
        let [colour, depth] = target.views[0].clone();
        let corners = 3 * mesh.triangles();
        Ok(UnwrapFrame { pipeline: self.pipeline.clone(), groups, colour, depth, corners, size })
    }
}

impl UnwrapFrame {
    /// Triangles of both draws.
    pub const fn triangles(&self) -> u32 {
        2 * (self.corners / 3)
    }

    /// Records the pass into `encoder`, its times to the first slot of `timer`. The target is cleared to 0.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timer: Option<&Timer>) {
        let writes = timer.map(|timer| timer.render_writes(0));
        let mut pass = cleared(encoder, &self.colour, Some(&self.depth), writes);
        pass.set_pipeline(&self.pipeline);
        for (panel, group) in (0..).zip(&self.groups) {
            // Primitives are clipped to the viewport.
            let [width, height] = [3 * self.size, self.size];
            pass.set_viewport(0.0, (panel * height) as f32, width as f32, height as f32, 0.0, 1.0);
            pass.set_bind_group(0, group, &[]);
            pass.draw(0..self.corners, 0..1);
        }
    }
}
