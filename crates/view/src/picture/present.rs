//! Tone-maps a linear picture for the display.

use super::resources::draw_pass;
use crate::look::Tone;
use octagloss_gpu::Context;
use octagloss_gpu::device::resources::{Draw, group};
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

/// Where a picture is shown: in `viewport` of `view`, by a pass of `encoder`.
#[derive(Debug)]
pub struct Display<'a> {
    /// Records the pass.
    pub encoder: &'a mut wgpu::CommandEncoder,
    /// The target.
    pub view: &'a wgpu::TextureView,
    /// Its format.
    pub format: wgpu::TextureFormat,
    /// The picture's position.
    pub viewport: Viewport,
}

/// Presents pictures to textures of any format.
#[derive(Debug)]
pub(crate) struct Presenter {
    context: Context,
    pipelines: HashMap<wgpu::TextureFormat, wgpu::RenderPipeline>,
}

impl Presenter {
    pub(crate) fn new(context: &Context) -> Self {
        Self { context: context.clone(), pipelines: HashMap::new() }
    }

    /// Draws the linear `picture` to `display`, tone-mapped, in sRGB.
    pub(crate) fn present(&mut self, picture: &wgpu::TextureView, display: Display<'_>, tone: Tone) {
        let Display { encoder, view, format, viewport } = display;
        let pipeline = self.pipelines.entry(format).or_insert_with(|| {
            let draw = Draw {
                file: "view/present.wgsl",
                entries: ["cover", "show"],
                groups: &[],
                corners: None,
                target: format.into(),
                depth: None,
            };
            draw.pipeline(&self.context)
        });
        let source = picture.texture().size();
        let uniform = Present {
            origin: [viewport.x as f32, viewport.y as f32],
            size: [viewport.width as f32, viewport.height as f32],
            source: [source.width as f32, source.height as f32],
            tone: tone as u32,
            pad: 0,
        };
        // One for each pass: a write to a shared one would also reach passes recorded before and not yet run.
        let uniform = self.context.uniform("present", &uniform);
        let resources = [uniform.as_entire_binding(), wgpu::BindingResource::TextureView(picture)];
        let group = group(&self.context, "present", &pipeline.get_bind_group_layout(0), resources);
        let mut pass = draw_pass(encoder, "present", view, true, None, None);
        let Viewport { x, y, width, height } = viewport;
        pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
