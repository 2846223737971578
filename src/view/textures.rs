//! Textures of the viewer: render targets and look-up tables.

use super::roughness_map::RoughnessMap;
use crate::error::{Error, Result};
use crate::gpu::Context;

/// Uploads `map`.
///
/// # Errors
/// [`Error::Limit`] if it exceeds the device's texture size.
pub(super) fn roughness_texture(context: &Context, map: &RoughnessMap) -> Result<wgpu::TextureView> {
    let size = [map.width, map.height];
    let most = context.device().limits().max_texture_dimension_2d;
    if size.iter().any(|side| *side > most) {
        return Err(Error::Limit {
            what: format!("a roughness map of {} x {}", map.width, map.height),
            needed: u64::from(map.width) * u64::from(map.height),
            available: u64::from(most) * u64::from(most),
            remedy: format!("use one of at most {most} texels per side"),
        });
    }
    Ok(texture_of(context, "roughness map", wgpu::TextureFormat::R8Unorm, size, &map.texels))
}

/// A render target that can be sampled and read back.
pub(super) fn target(
    context: &Context,
    label: &str,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
) -> wgpu::Texture {
    context.device().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

/// A texture of `bytes`, row-major.
pub(super) fn texture_of(
    context: &Context,
    label: &str,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
    bytes: &[u8],
) -> wgpu::TextureView {
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = context.device().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(bytes.len() as u32 / height),
        rows_per_image: None,
    };
    context.queue().write_texture(texture.as_image_copy(), bytes, layout, size);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
