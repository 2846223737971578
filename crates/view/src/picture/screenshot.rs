//! Renders pictures without a window.

use super::resources::target;
use crate::look::legend::{legend, put, shown};
use crate::{Display, Light, Look, Renderer, Show, Truth, Viewport};
use octagloss_core::common::error::Result;
use octagloss_drawing::bitmap::Bitmap;
use octagloss_gpu::Context;
use octagloss_gpu::device::readback;

/// Size and sampling of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Screenshot {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples along an edge of a pixel.
    pub samples: u32,
}

/// Renders `look` as a window would show it, in sRGB; debug views with their legend, if there is room.
/// `truth` answers if the look needs the certified tier.
///
/// # Errors
/// [`octagloss_core::common::error::Error::Parameter`] for an unsupported look or size,
/// [`octagloss_core::common::error::Error::Gpu`] if the device fails.
///
/// # Panics
/// If the look needs the certified tier and `truth` is `None`.
pub async fn screenshot(
    renderer: &mut Renderer,
    look: &Look,
    light: &Light,
    truth: Option<&Truth>,
    Screenshot { width, height, samples }: Screenshot,
) -> Result<Bitmap> {
    let (columns, rows) = (width.saturating_mul(samples), height.saturating_mul(samples));
    if look.needs_truth() {
        let asked = renderer.samples(look, light, columns, rows)?.await?;
        let truth = truth.expect("the caller gives what the look asks for");
        let source_from_world = light.source_from_world(look.turn);
        let answers = truth.answers(&asked, columns as usize, source_from_world, look.tolerance())?;
        renderer.set_truth(&answers, columns);
    }
    renderer.draw(look, light, columns, rows)?;
    let context = renderer.context().clone();
    let mut picture = presented(&context, [width, height], |display| renderer.present(display, look)).await?;
    if let Some(values) = renderer.values().filter(|_| look.show != Show::Scene) {
        let values = values.await?;
        let shown = shown(look, &values, look.exposure.ev(light.exposure()));
        if let Some(legend) = legend(look, light, [width, height], shown) {
            put(&mut picture, &legend);
        }
    }
    Ok(picture)
}

/// The picture that `present` draws into a target of `width` x `height`.
///
/// # Errors
/// [`octagloss_core::common::error::Error::Gpu`] if the device fails.
pub async fn presented(
    context: &Context,
    [width, height]: [u32; 2],
    present: impl FnOnce(Display<'_>),
) -> Result<Bitmap> {
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let texture = target(context, "screenshot", format, [width, height]);
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let viewport = Viewport { x: 0, y: 0, width, height };
    context.submit(|encoder| present(Display { encoder, view: &view, format, viewport }));
    let pixels: Vec<[u8; 4]> = readback::read_texture(context, &texture).await?;
    Ok(Bitmap::new(width, height, pixels.into_iter().map(|[r, g, b, _]| [r, g, b]).collect()))
}
