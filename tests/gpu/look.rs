//! Runs compute shaders that look texels up in a texture.

use bytemuck::Pod;
use octagloss_fixtures::adapters::wait;
use octagloss_gpu::Context;
use octagloss_gpu::device::readback;
use wgpu::util::DeviceExt as _;

/// Invocations of a workgroup.
pub(super) const GROUP: usize = 64;

/// Runs the entry point `look` of `source`, in workgroups of 64, for each of `queries`. Group 0 binds `map`,
/// the texture with what it needs, then the queries, then the answers.
pub(super) fn answers<Q: Pod, A: Pod>(
    context: &Context,
    source: &str,
    map: &[wgpu::BindingResource<'_>],
    queries: &[Q],
) -> Vec<A> {
    let device = context.device();
    run(context, source, queries, |pipeline, lists| {
        vec![group(device, pipeline, 0, map.iter().cloned().chain(lists))]
    })
}

/// The same with the resources that `bind` puts into group 0, and queries and answers in group 1.
pub(super) fn answers_in_groups<Q: Pod, A: Pod>(
    context: &Context,
    source: &str,
    bind: impl FnOnce(&wgpu::BindGroupLayout) -> wgpu::BindGroup,
    queries: &[Q],
) -> Vec<A> {
    run(context, source, queries, |pipeline, lists| {
        vec![bind(&pipeline.get_bind_group_layout(0)), group(context.device(), pipeline, 1, lists)]
    })
}

fn group<'a>(
    device: &wgpu::Device,
    pipeline: &wgpu::ComputePipeline,
    index: u32,
    resources: impl IntoIterator<Item = wgpu::BindingResource<'a>>,
) -> wgpu::BindGroup {
    let entries: Vec<wgpu::BindGroupEntry<'_>> =
        (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    let layout = &pipeline.get_bind_group_layout(index);
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("look"), layout, entries: &entries })
}

/// Runs `source` with the groups that `bind` makes of the queries and the answers.
fn run<Q: Pod, A: Pod>(
    context: &Context,
    source: &str,
    queries: &[Q],
    bind: impl FnOnce(&wgpu::ComputePipeline, [wgpu::BindingResource<'_>; 2]) -> Vec<wgpu::BindGroup>,
) -> Vec<A> {
    let device = context.device();
    let asked = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("queries"),
        contents: bytemuck::cast_slice(queries),
        usage: wgpu::BufferUsages::STORAGE,
    });
    let found = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("answers"),
        size: (size_of::<A>() * queries.len()) as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("look"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("look"),
        layout: None,
        module: &module,
        entry_point: Some("look"),
        compilation_options: Default::default(),
        cache: None,
    });
    let groups = bind(&pipeline, [asked.as_entire_binding(), found.as_entire_binding()]);
    context.submit(|encoder| {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        for (index, group) in (0..).zip(&groups) {
            pass.set_bind_group(index, group, &[]);
        }
        pass.dispatch_workgroups(queries.len().div_ceil(GROUP) as u32, 1, 1);
    });
    wait(context, readback::read(context, &found))
}
