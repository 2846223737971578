//! Adapters, devices and their errors.

use octagloss_core::common::error::{Error, Result};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A device with its queue, the compute pipelines compiled on it, and the first error that occurred on it.
#[derive(Clone, Debug)]
pub struct Context {
    device: wgpu::Device,
    queue: wgpu::Queue,
    failure: Arc<Mutex<Option<String>>>,
    /// Shaders by file.
    modules: Arc<Mutex<HashMap<String, wgpu::ShaderModule>>>,
    /// Pipelines by file, entry point and constant.
    pipelines: Arc<Mutex<HashMap<String, wgpu::ComputePipeline>>>,
}

fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Every adapter of the system, hardware first, in the system's order.
pub async fn adapters() -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let mut adapters = instance.enumerate_adapters(wgpu::Backends::all()).await;
    adapters.sort_by_key(|adapter| !is_hardware(&adapter.get_info()));
    adapters
}

/// Whether the system may have a hardware GPU. False only on Linux without a device node for one; this avoids
/// loading drivers, and their messages on stderr.
pub fn may_have_hardware() -> bool {
    const DEVICES: [&str; 5] = ["/dev/dri", "/dev/nvidiactl", "/dev/dxg", "/dev/mali0", "/dev/kgsl-3d0"];
    !cfg!(target_os = "linux") || DEVICES.iter().any(|device| std::path::Path::new(device).exists())
}

/// Whether an adapter is hardware and not a software driver.
pub fn is_hardware(info: &wgpu::AdapterInfo) -> bool {
    matches!(
        info.device_type,
        wgpu::DeviceType::DiscreteGpu | wgpu::DeviceType::IntegratedGpu | wgpu::DeviceType::VirtualGpu
    )
}

/// One line that identifies an adapter: name, kind, backend, driver. Unknown parts are omitted; browsers
/// hide name and driver.
pub fn describe(info: &wgpu::AdapterInfo) -> String {
    let driver = [info.driver.as_str(), info.driver_info.as_str()].join(" ");
    let mut further = format!("{:?}, {}", info.device_type, info.backend);
    if !driver.trim().is_empty() {
        further = format!("{further}, {}", driver.trim());
    }
    if info.name.is_empty() { further } else { format!("{} ({further})", info.name) }
}

impl Context {
    /// Opens a device of `adapter` with baseline limits, except for buffers and textures, which get the
    /// adapter's own limits. Enables timestamp queries if supported.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the adapter provides no device.
    pub async fn new(adapter: &wgpu::Adapter) -> Result<Self> {
        let has = adapter.limits();
        let limits = wgpu::Limits {
            max_buffer_size: has.max_buffer_size,
            max_storage_buffer_binding_size: has.max_storage_buffer_binding_size,
            max_texture_dimension_2d: has.max_texture_dimension_2d,
            ..wgpu::Limits::default()
        };
        Self::with_limits(adapter, limits).await
    }

    /// Opens a device with the given limits.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the adapter provides no device.
    pub async fn with_limits(adapter: &wgpu::Adapter, limits: wgpu::Limits) -> Result<Self> {
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("octagloss"),
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: limits,
            ..Default::default()
        };
        let (device, queue) = adapter.request_device(&descriptor).await.map_err(|error| {
            Error::Gpu(format!("{} provides no device: {error}", describe(&adapter.get_info())))
        })?;
        let context = Self::from_device(device, queue);
        let Self { device, failure, .. } = &context;
        let uncaptured = Arc::clone(failure);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| note(&uncaptured, &error.to_string())));
        let lost = Arc::clone(failure);
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                note(&lost, &format!("the device was lost: {message}"));
            }
        });
        Ok(context)
    }

    /// A context over the caller's device; the caller handles its errors.
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let (modules, pipelines) = (Arc::default(), Arc::default());
        Self { device, queue, failure: Arc::default(), modules, pipelines }
    }

    /// The device.
    pub const fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// Its queue.
    pub const fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Name, kind, backend and driver of the adapter.
    pub fn describe(&self) -> String {
        describe(&self.device.adapter_info())
    }

    /// Checks for an error on the device since it was opened.
    ///
    /// # Errors
    /// [`Error::Gpu`] for a lost device, memory that ran out, or an invalid command.
    pub fn check(&self) -> Result<()> {
        match &*lock(&self.failure) {
            None => Ok(()),
            Some(message) => Err(Error::Gpu(format!("{}: {message}", self.describe()))),
        }
    }

    /// The module of the shader `file`, compiled when it is first asked for.
    pub fn module(&self, file: &str) -> wgpu::ShaderModule {
        let create = || {
            self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(file),
                source: wgpu::ShaderSource::Wgsl(octagloss_shaders::source(file).into()),
            })
        };
        lock(&self.modules).entry(file.to_owned()).or_insert_with(create).clone()
    }

    /// The pipeline of an entry point of the shader `file`, compiled when it is first asked for, with its
    /// layout inferred from the shader; `constant` is the value of one of the shader's `override`
    /// declarations.
    pub(crate) fn pipeline(
        &self,
        file: &str,
        entry_point: &str,
        constant: Option<(&str, u32)>,
    ) -> wgpu::ComputePipeline {
        let constants = constant.map(|(name, value)| (name, f64::from(value)));
        let key = format!("{file} {entry_point} {constants:?}");
        let known = lock(&self.pipelines).get(&key).cloned();
        known.unwrap_or_else(|| {
            // Unlocked, so that threads compile side by side.
            let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: None,
                module: &self.module(file),
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: constants.as_slice(),
                    ..Default::default()
                },
                cache: None,
            });
            lock(&self.pipelines).insert(key, pipeline.clone());
            pipeline
        })
    }

    /// Returns [`Error::Limit`] if `bytes` exceed the limit of one binding; `largest` gives the remedy for
    /// that limit.
    pub(crate) fn fits(&self, what: &str, bytes: u64, largest: impl FnOnce(u64) -> String) -> Result<()> {
        let limits = self.device.limits();
        let available = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
        if bytes <= available {
            return Ok(());
        }
        Err(Error::Limit { what: what.to_owned(), needed: bytes, available, remedy: largest(available) })
    }

    /// Submits the commands that `record` records.
    pub fn submit(&self, record: impl FnOnce(&mut wgpu::CommandEncoder)) {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        record(&mut encoder);
        self.queue.submit([encoder.finish()]);
    }

    /// A buffer of `size` bytes.
    pub(crate) fn buffer(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let label = Some(label);
        let descriptor = wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false };
        self.device.create_buffer(&descriptor)
    }

    /// A buffer that holds `bytes`.
    pub fn buffer_of(&self, label: &str, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let buffer = self.buffer(label, bytes.len() as u64, usage | wgpu::BufferUsages::COPY_DST);
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    /// A texture of `[width, height, layers]` with mip `levels`.
    pub fn texture(
        &self,
        label: &str,
        format: wgpu::TextureFormat,
        [width, height, depth_or_array_layers]: [u32; 3],
        mip_level_count: u32,
        usage: wgpu::TextureUsages,
    ) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width, height, depth_or_array_layers },
            mip_level_count,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    }

    /// A storage buffer of `bytes`, at least four, which can be copied from and to.
    pub(crate) fn storage(&self, label: &str, bytes: u64) -> wgpu::Buffer {
        let copied = wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        self.buffer(label, bytes.max(4), wgpu::BufferUsages::STORAGE | copied)
    }

    /// A storage buffer holding `values`.
    pub(crate) fn storage_of<T: bytemuck::NoUninit>(&self, label: &str, values: &[T]) -> wgpu::Buffer {
        let bytes: &[u8] = bytemuck::cast_slice(values);
        let buffer = self.storage(label, bytes.len() as u64);
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    /// A uniform buffer holding `value`.
    pub fn uniform<T: bytemuck::NoUninit>(&self, label: &str, value: &T) -> wgpu::Buffer {
        self.buffer_of(label, bytemuck::bytes_of(value), wgpu::BufferUsages::UNIFORM)
    }
}

/// Keeps the first failure; later ones are its consequences.
fn note(failure: &Mutex<Option<String>>, message: &str) {
    let one_line = message.split_whitespace().collect::<Vec<_>>().join(" ");
    lock(failure).get_or_insert(one_line);
}

#[cfg(test)]
mod tests {
    use super::describe;
    use wgpu::{AdapterInfo, Backend, DeviceType};

    #[test]
    fn what_an_adapter_keeps_to_itself_is_left_out() {
        let mut info = AdapterInfo::new(DeviceType::Cpu, Backend::BrowserWebGpu);
        assert_eq!(describe(&info), "Cpu, webgpu");
        info.name = "llvmpipe".to_owned();
        assert_eq!(describe(&info), "llvmpipe (Cpu, webgpu)");
        info.driver_info = "Mesa".to_owned();
        assert_eq!(describe(&info), "llvmpipe (Cpu, webgpu, Mesa)");
    }
}
