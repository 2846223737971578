//! Reads buffers back to the CPU, asynchronously.

use super::context::Context;
use octagloss_core::common::error::{Error, Result};

/// Reads `buffer` back, after everything submitted before the call.
///
/// # Errors
/// [`Error::Gpu`] if the device fails.
pub async fn read<T: bytemuck::Pod>(context: &Context, buffer: &wgpu::Buffer) -> Result<Vec<T>> {
    let size = buffer.size();
    let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
    let staging = context.buffer("readback", size, usage);
    context.submit(|encoder| encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, size));
    let (sender, mapped) = futures_channel::oneshot::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |outcome| {
        // The receiver is gone if the future was dropped.
        sender.send(outcome).ok();
    });
    let failed = |error: String| Error::Gpu(format!("{}: reading back: {error}", context.describe()));
    let outcome = mapped.await;
    context.check()?;
    outcome.map_err(|error| failed(error.to_string()))?.map_err(|error| failed(error.to_string()))?;
    let view = staging.get_mapped_range(..).map_err(|error| failed(error.to_string()))?;
    Ok(bytemuck::pod_collect_to_vec(&view))
}

/// Waits for everything submitted before the call.
///
/// # Errors
/// [`Error::Gpu`] if the device fails.
pub async fn finished(context: &Context) -> Result<()> {
    let (sender, done) = futures_channel::oneshot::channel();
    // The receiver is gone if the future was dropped.
    context.queue().on_submitted_work_done(move || {
        sender.send(()).ok();
    });
    let outcome = done.await;
    context.check()?;
    outcome.map_err(|error| Error::Gpu(format!("{}: waiting: {error}", context.describe())))
}

/// Reads the first level of a two-dimensional `texture` with texels of type `T`, row-major.
///
/// # Errors
/// [`Error::Gpu`] if the device fails.
///
/// # Panics
/// If the texture's texel size is not that of `T`.
pub async fn read_texture<T: bytemuck::Pod>(context: &Context, texture: &wgpu::Texture) -> Result<Vec<T>> {
    read_layer(context, texture, 0).await
}

/// Reads layer `layer`.
///
/// # Errors
/// [`Error::Gpu`] if the device fails.
///
/// # Panics
/// If the texture's texel size is not that of `T`.
pub async fn read_layer<T: bytemuck::Pod>(
    context: &Context,
    texture: &wgpu::Texture,
    layer: u32,
) -> Result<Vec<T>> {
    let size = wgpu::Extent3d { depth_or_array_layers: 1, ..texture.size() };
    let texel = size_of::<T>() as u32;
    assert_eq!(texture.format().block_copy_size(None), Some(texel), "texels of {:?}", texture.format());
    let row = texel * size.width;
    let pitch = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = context.storage("texture read back", u64::from(pitch) * u64::from(size.height));
    context.submit(|encoder| {
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch), rows_per_image: None };
        encoder.copy_texture_to_buffer(
            wgpu::TexelCopyTextureInfo {
                origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
                ..texture.as_image_copy()
            },
            wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
            size,
        );
    });
    let bytes: Vec<u8> = read(context, &buffer).await?;
    let rows = bytes.chunks_exact(pitch as usize);
    Ok(rows.flat_map(|padded| bytemuck::pod_collect_to_vec::<u8, T>(&padded[..row as usize])).collect())
}
