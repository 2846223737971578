//! What is compiled once per device, however many passes use it.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Modules and pipelines of one device.
#[derive(Debug, Default)]
pub(super) struct Compiled {
    /// By file.
    modules: Mutex<HashMap<String, wgpu::ShaderModule>>,
    /// By file, entry point and constants.
    pipelines: Mutex<HashMap<String, wgpu::ComputePipeline>>,
}

fn lock<T>(map: &Mutex<T>) -> MutexGuard<'_, T> {
    map.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Compiled {
    /// The module of `file`.
    pub(super) fn module(&self, device: &wgpu::Device, file: &str) -> wgpu::ShaderModule {
        let create = || {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(file),
                source: wgpu::ShaderSource::Wgsl(octagloss_shaders::source(file).into()),
            })
        };
        lock(&self.modules).entry(file.to_owned()).or_insert_with(create).clone()
    }

    /// The pipeline of an entry point of `file`, with its layout inferred from the shader.
    pub(super) fn pipeline(
        &self,
        device: &wgpu::Device,
        file: &str,
        entry_point: &str,
        constants: &[(&str, f64)],
    ) -> wgpu::ComputePipeline {
        let key = format!("{file} {entry_point} {constants:?}");
        let known = lock(&self.pipelines).get(&key).cloned();
        known.unwrap_or_else(|| {
            // Unlocked, so that threads compile side by side.
            let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: None,
                module: &self.module(device, file),
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
                cache: None,
            });
            lock(&self.pipelines).insert(key, pipeline.clone());
            pipeline
        })
    }
}
