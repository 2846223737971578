//! Buffers back to the CPU, without waiting.

use super::Context;
use crate::error::{Error, Result};

/// The whole of `buffer`, copied after everything that was submitted before the call.
///
/// # Errors
/// [`Error::Gpu`] where the device fails.
pub async fn read<T: bytemuck::Pod>(context: &Context, buffer: &wgpu::Buffer) -> Result<Vec<T>> {
    let size = buffer.size();
    let staging = context.device().create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    context.submit(|encoder| encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, size));
    let (sender, mapped) = futures_channel::oneshot::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |outcome| {
        // Nobody listens once the future is dropped.
        sender.send(outcome).ok();
    });
    let failed = |error: String| Error::Gpu(format!("{}: reading back: {error}", context.describe()));
    let outcome = mapped.await;
    context.check()?;
    outcome.map_err(|error| failed(error.to_string()))?.map_err(|error| failed(error.to_string()))?;
    let view = staging.get_mapped_range(..).map_err(|error| failed(error.to_string()))?;
    Ok(bytemuck::pod_collect_to_vec(&view))
}
