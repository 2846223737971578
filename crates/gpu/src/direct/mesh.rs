//! Triangles on the GPU.

use crate::Context;
use crate::triangles::{Corner, Triangles};
use octagloss_core::common::error::{Error, Result};

/// Corners and indices of [`Triangles`] in buffers.
#[derive(Clone, Debug)]
pub struct DirectMesh {
    pub(super) corners: wgpu::Buffer,
    pub(super) indices: wgpu::Buffer,
    pub(super) triangles: u32,
}

impl DirectMesh {
    /// Uploads `triangles`.
    ///
    /// # Errors
    /// [`Error::Limit`] if they exceed the buffers of the device.
    pub fn upload(context: &Context, triangles: &Triangles) -> Result<Self> {
        let buffer = |label: &str, usage, bytes: &[u8]| {
            let remedy = |available| {
                let most = available / size_of::<Corner>() as u64 / 3;
                format!("draw the mesh in parts of at most {most} triangles")
            };
            context.fits(&format!("the {label} of a mesh"), bytes.len() as u64, remedy)?;
            Ok::<_, Error>(context.buffer_of(label, bytes, usage | wgpu::BufferUsages::STORAGE))
        };
        let corners = bytemuck::cast_slice(triangles.corners());
        let indices = bytemuck::cast_slice(triangles.indices());
        Ok(Self {
            corners: buffer("corners", wgpu::BufferUsages::VERTEX, corners)?,
            indices: buffer("indices", wgpu::BufferUsages::INDEX, indices)?,
            // At most a third of the buffer's words.
            triangles: triangles.count() as u32,
        })
    }

    /// The corners, [`Corner`] by [`Corner`], for passes that move them.
    pub const fn corners(&self) -> &wgpu::Buffer {
        &self.corners
    }

    /// Number of triangles.
    pub const fn triangles(&self) -> u32 {
        self.triangles
    }
}
