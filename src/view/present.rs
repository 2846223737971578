//! Tone-maps a linear picture for the display.

use super::look::{Look, Tone};
use crate::gpu::Context;
use crate::gpu::device::shader;
use std::collections::HashMap;

/// Uniform of the pass.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct Present {
    origin: [f32; 2],
    size: [f32; 2],
    source: [f32; 2],
    tone: u32,
    pad: u32,
}

/// Position of a picture in its target, in pixels from the upper left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewport {
    /// Left edge.
    pub x: u32,
    /// Upper edge.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// Presents pictures to textures of any format.
#[derive(Debug)]
pub(super) struct Presenter {
    context: Context,
    pipelines: HashMap<wgpu::TextureFormat, wgpu::RenderPipeline>,
}

impl Presenter {
    pub(super) fn new(context: &Context) -> Self {
        Self { context: context.clone(), pipelines: HashMap::new() }
    }

    /// Draws the linear `picture` into `viewport` of `view`, tone-mapped, in sRGB.
    pub(super) fn present(
        &mut self,
        picture: &wgpu::TextureView,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        viewport: Viewport,
        look: &Look,
    ) {
        let device = self.context.device();
        let pipeline = self.pipelines.entry(format).or_insert_with(|| {
            let module = shader::module(&self.context, "view/present.wgsl");
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("present"),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("cover"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: None,
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("show"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(format.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        });
        let tone = match look.tone {
            _ if look.show.is_false_colour() => 3,
            Tone::Neutral => 0,
            Tone::Aces => 1,
            Tone::Reinhard => 2,
            Tone::Linear => 3,
        };
        let source = picture.texture().size();
        let uniform = Present {
            origin: [viewport.x as f32, viewport.y as f32],
            size: [viewport.width as f32, viewport.height as f32],
            source: [source.width as f32, source.height as f32],
            tone,
            pad: 0,
        };
        // One for each pass: a write to a shared one would also reach passes recorded before and not yet run.
        let uniform = self.context.uniform("present", &uniform);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("present"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(picture) },
            ],
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("present"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        let Viewport { x, y, width, height } = viewport;
        pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
