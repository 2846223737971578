//! Textures that triangles are drawn into.

use crate::Context;
use crate::device::resources::{DEPTH, single};
use crate::triangles::DirectMap;
use octagloss_core::common::error::{Result, wrong};

/// The depth test of draws that keep the nearest surface. Depth is `near` over the distance: 0 where nothing
/// is drawn, 1 at the near surface.
pub(super) const NEAREST: (bool, wgpu::CompareFunction) = (true, wgpu::CompareFunction::Greater);

/// A colour texture and its depth.
#[derive(Clone, Debug)]
pub struct DirectTarget {
    pub(super) map: DirectMap,
    /// The colour: a layer per face of a cube.
    pub colour: wgpu::Texture,
    /// The depth, in as many layers as the colour.
    pub depth: wgpu::Texture,
    /// Colour and depth of each layer.
    pub(crate) views: Vec<[wgpu::TextureView; 2]>,
}

impl DirectTarget {
    /// Textures for `map`. The colour has `format`; both have the usages of an attachment and of a texture,
    /// and can be copied from.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for an octahedral map of odd size, a size of 0 or
    /// beyond the device's textures, and formats other than `Rgba16Float` and `Rgba32Float`.
    pub fn new(context: &Context, map: DirectMap, format: wgpu::TextureFormat) -> Result<Self> {
        check_format(format)?;
        let colour = texture(context, map, "direct colour", format)?;
        let depth = depth_texture(context, map)?;
        let views = (0..map.layers()).map(|layer| [&colour, &depth].map(|image| single(image, layer, 0)));
        let views = views.collect();
        Ok(Self { map, colour, depth, views })
    }

    /// The map and its size.
    pub const fn map(&self) -> DirectMap {
        self.map
    }

    /// Checks that the colour has the `format` of pipelines.
    pub(super) fn has_format(&self, format: wgpu::TextureFormat) -> Result<()> {
        let own = self.colour.format();
        if own == format {
            return Ok(());
        }
        wrong(format!("a target of {own:?} for pipelines of {format:?}; create both with one format"))
    }
}

/// A texture of the pixels of `map`, see [`DirectTarget::new`].
fn texture(
    context: &Context,
    map: DirectMap,
    label: &str,
    format: wgpu::TextureFormat,
) -> Result<wgpu::Texture> {
    let size = map.size();
    let [columns, rows] = map.cells();
    let most = context.device().limits().max_texture_dimension_2d / columns.max(rows);
    if map.is_octahedral() && (size % 2 == 1 || !(2..=most).contains(&size)) {
        let most = most / 2 * 2;
        return wrong(format!(
            "an octahedral map of `size` {size}; choose an even number from 2 to {most}, so that no pixel is \
             in two octants"
        ));
    }
    if !(1..=most).contains(&size) {
        return wrong(format!("a target of `size` {size}; choose 1 to {most}"));
    }
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT
        | wgpu::TextureUsages::TEXTURE_BINDING
        | wgpu::TextureUsages::COPY_SRC;
    Ok(context.texture(label, format, [columns * size, rows * size, map.layers()], 1, usage))
}

/// A texture of the depth of `map`.
///
/// # Errors
/// [`octagloss_core::common::error::Error::Parameter`] for an octahedral map of odd size, and a size of 0 or
/// beyond the device's textures.
pub fn depth_texture(context: &Context, map: DirectMap) -> Result<wgpu::Texture> {
    texture(context, map, "direct depth", DEPTH)
}

/// The attachment of a depth that a pass clears.
pub const fn cleared_depth(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    }
}

/// Rejects formats that triangles are not drawn in.
pub(super) fn check_format(format: wgpu::TextureFormat) -> Result<()> {
    if matches!(format, wgpu::TextureFormat::Rgba16Float | wgpu::TextureFormat::Rgba32Float) {
        return Ok(());
    }
    wrong(format!("colour format {format:?}; choose Rgba16Float or Rgba32Float"))
}
