//! Textures and passes of the viewer's pictures.

use octagloss_core::common::error::{Result, wrong};
use octagloss_gpu::Context;
use octagloss_gpu::device::resources::DEPTH;

/// Passes and their seconds.
pub(crate) type Times = Vec<(&'static str, f64)>;

/// Begins a pass that draws into `view`, cleared to black if `clear`, with depths in a texture that is
/// cleared and discarded likewise.
pub(crate) fn draw_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &str,
    view: &wgpu::TextureView,
    clear: bool,
    depth: Option<(&wgpu::TextureView, wgpu::StoreOp)>,
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'a> {
    let load = if clear { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
    let far = if clear { wgpu::LoadOp::Clear(1.0) } else { wgpu::LoadOp::Load };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: depth.map(|(view, store)| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations { load: far, store }),
            stencil_ops: None,
        }),
        timestamp_writes,
        ..Default::default()
    })
}

/// A render target that can be sampled and read back.
pub(super) fn target(
    context: &Context,
    label: &str,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
) -> wgpu::Texture {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT
        | wgpu::TextureUsages::TEXTURE_BINDING
        | wgpu::TextureUsages::COPY_SRC;
    context.texture(label, format, [width, height, 1], 1, usage)
}

/// Format of linear pictures.
pub(crate) const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// A linear picture and its depths.
#[derive(Debug)]
pub(crate) struct Targets {
    /// Columns and rows.
    pub size: (u32, u32),
    pub picture: wgpu::TextureView,
    pub depth: wgpu::TextureView,
}

impl Targets {
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for a size that the device does not have.
    pub(crate) fn new(context: &Context, size: (u32, u32)) -> Result<Self> {
        let most = context.device().limits().max_texture_dimension_2d;
        let (width, height) = size;
        if !(1..=most).contains(&width) || !(1..=most).contains(&height) {
            return wrong(format!("a picture of {width} x {height} pixels; each side must be 1 to {most}"));
        }
        let view = |label, format| {
            let texture = target(context, label, format, [width, height]);
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        Ok(Self { size, picture: view("picture", PICTURE), depth: view("depth", DEPTH) })
    }
}
