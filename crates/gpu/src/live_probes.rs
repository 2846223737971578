//! Environments of one size in shared textures, which one look-up reads.

use super::Context;
use super::live::LiveEnvironment;
use crate::stages::pyramid::{MAX_PROBES, wgsl};
use crate::stages::reflection::{self, Surfaces};
use octagloss_core::common::error::{Result, wrong};
use std::ops::{Deref, DerefMut};

/// Probes of a scene: environments whose maps are layers of the same textures, so that one draw blends any of
/// them. `examples/probes.rs` does so.
///
/// It is a slice of [`LiveEnvironment`]: each is updated or drawn by itself, in turns if all take too long,
/// has its own rotation, and can also be looked up alone, by its own group. They share what an update only
/// passes through, as siblings do.
#[derive(Debug)]
pub struct LiveProbes {
    probes: Vec<LiveEnvironment>,
    bind_group: wgpu::BindGroup,
    context: Context,
}

impl LiveProbes {
    /// Most environments: WebGPU's least limit of a uniform, 64 KiB, holds the lights of as many.
    pub const MAX: u32 = MAX_PROBES;

    /// Allocates the tables of `count` environments over octahedral maps of `size` texels along an edge,
    /// rounded up as [`LiveEnvironment::new`] does. All are black until their first update.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for a size of 0, and for no or more than
    /// [`Self::MAX`] environments; [`octagloss_core::common::error::Error::Limit`] where their tables exceed
    /// one binding of the device, or its textures: it names the count and size that fit.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, size: u32, count: u32) -> Result<Self> {
        let context = Context::from_device(device.clone(), queue.clone());
        Self::on(&context, size, count)
    }

    /// [`Self::new`] on a device with pipelines compiled before.
    pub fn on(context: &Context, size: u32, count: u32) -> Result<Self> {
        if !(1..=Self::MAX).contains(&count) {
            let most = Self::MAX;
            return wrong(format!("`count` is {count} environments; choose 1 to {most}"));
        }
        let probes = LiveEnvironment::several(context, size, count)?;
        let bind_group = probes[0].maps().bind_group_of_all(context, probes[0].bind_group_layout());
        Ok(Self { probes, bind_group, context: context.clone() })
    }

    /// Most environments whose maps share textures on the device.
    pub fn most(context: &Context) -> u32 {
        (context.device().limits().max_texture_array_layers / 2).min(Self::MAX)
    }

    /// WGSL with `octagloss_radiance_of(probe, direction, roughness)` and `octagloss_irradiance_of(probe,
    /// normal)`, where `probe` is a `u32` below the number of environments; their resources are declared in
    /// bind group `group`.
    #[must_use]
    pub fn wgsl(group: u32) -> String {
        wgsl(MAX_PROBES, group)
    }

    /// The layout of [`Self::bind_group`], for the caller's pipeline layouts: that of a [`LiveEnvironment`].
    #[must_use]
    pub fn bind_group_layout(&self) -> &wgpu::BindGroupLayout {
        self.probes[0].bind_group_layout()
    }

    /// The resources of [`Self::wgsl`]; the same group after every update.
    #[must_use]
    pub const fn bind_group(&self) -> &wgpu::BindGroup {
        &self.bind_group
    }

    /// The resources as a group of `layout`, which wgpu derived for a pipeline from its shader.
    #[must_use]
    pub fn bind_group_of(&self, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        self.probes[0].maps().bind_group_of_all(&self.context, layout)
    }

    /// [`Self::wgsl`], and with it the true reflection of [`LiveEnvironment::reflect_wgsl`]:
    /// `octagloss_reflect_of(probe, normal, view, tangent, roughness, anisotropy, f0, f90)`.
    #[must_use]
    pub fn reflect_wgsl(group: u32) -> String {
        reflection::wgsl(MAX_PROBES, group)
    }

    /// The layout of a group with the resources of [`Self::reflect_wgsl`]: that of a [`LiveEnvironment`].
    #[must_use]
    pub fn reflect_bind_group_layout(&self) -> wgpu::BindGroupLayout {
        self.probes[0].reflect_bind_group_layout()
    }

    /// The resources of [`Self::reflect_wgsl`] as a group of `layout`, as those of
    /// [`LiveEnvironment::reflect_bind_group_of`].
    #[must_use]
    pub fn reflect_bind_group_of(&self, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        reflection::bind_group(&self.context, self.probes[0].maps(), true, Surfaces::Any, layout)
    }
}

impl Deref for LiveProbes {
    type Target = [LiveEnvironment];

    fn deref(&self) -> &[LiveEnvironment] {
        &self.probes
    }
}

impl DerefMut for LiveProbes {
    fn deref_mut(&mut self) -> &mut [LiveEnvironment] {
        &mut self.probes
    }
}
