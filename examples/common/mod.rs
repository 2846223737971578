//! What a renderer has of its own: a device, and pixels on the CPU.

use octagloss::wgpu;
use std::error::Error;
use std::future::Future;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// Waits for `future`; those of wgpu need no event loop in native programs.
fn wait<T>(future: impl Future<Output = T>) -> T {
    let mut future = pin!(future);
    loop {
        if let Poll::Ready(output) = future.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            return output;
        }
        std::thread::yield_now();
    }
}

/// Device and queue of the system's preferred adapter.
pub(crate) fn device() -> Result<(wgpu::Device, wgpu::Queue), Box<dyn Error>> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = wait(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    Ok(wait(adapter.request_device(&wgpu::DeviceDescriptor::default()))?)
}

/// Saves `pixels`, `width` columns of RGBA in 8 bits, to `path` when the submitted commands are done.
pub(crate) fn save(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    pixels: &wgpu::Buffer,
    width: u32,
    path: &str,
) -> Result<(), Box<dyn Error>> {
    let staging = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: pixels.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(pixels, 0, &staging, 0, pixels.size());
    queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    device.poll(wgpu::PollType::wait_indefinitely())?;
    let bytes = staging.get_mapped_range(..)?.to_vec();
    let height = bytes.len() as u32 / (4 * width);
    Ok(image::save_buffer(path, &bytes, width, height, image::ColorType::Rgba8)?)
}
