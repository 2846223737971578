//! Stages: pipelines bound to buffers, ready to record.

use super::context::Context;
use super::resources::group_at;

/// Workgroups of a row, as `shaders/common/rows.wgsl` has it: one dimension of a dispatch holds 65,535.
pub(crate) const ROW: u32 = 32_768;

/// The workgroups of a dispatch of `count`, in rows of [`ROW`]; the last may have some to spare.
pub fn in_rows(count: u32) -> [u32; 3] {
    [count.min(ROW), count.div_ceil(ROW), 1]
}

/// One dispatch: a pipeline, what it is bound to, and how many workgroups.
#[derive(Clone, Debug)]
pub(crate) struct Dispatch {
    name: &'static str,
    pipeline: wgpu::ComputePipeline,
    bindings: Vec<wgpu::BindGroup>,
    workgroups: [u32; 3],
}

impl Dispatch {
    /// An entry point of the shader `file` over `workgroups`, with resources at the bindings of its group 0
    /// that they are listed with.
    pub(crate) fn new(
        context: &Context,
        (file, entry_point): (&'static str, &'static str),
        resources: &[(u32, wgpu::BindingResource<'_>)],
        workgroups: [u32; 3],
    ) -> Self {
        let pipeline = context.pipeline(file, entry_point, None);
        Self { name: entry_point, ..Self::of(context, &pipeline, resources, workgroups) }
    }

    /// The same of a `pipeline`.
    pub(crate) fn of(
        context: &Context,
        pipeline: &wgpu::ComputePipeline,
        resources: &[(u32, wgpu::BindingResource<'_>)],
        workgroups: [u32; 3],
    ) -> Self {
        let layout = pipeline.get_bind_group_layout(0);
        let bindings = group_at(context, "dispatch", &layout, resources.iter().cloned());
        Self::with_groups(pipeline, vec![bindings], workgroups)
    }

    /// A stage with existing groups, from 0 on.
    pub(crate) fn with_groups(
        pipeline: &wgpu::ComputePipeline,
        bindings: Vec<wgpu::BindGroup>,
        workgroups: [u32; 3],
    ) -> Self {
        Self { name: "dispatch", pipeline: pipeline.clone(), bindings, workgroups }
    }
}

/// A pass bound to its buffers. Recording allocates nothing, submits nothing and waits for nothing.
#[derive(Clone, Debug)]
pub struct Stage {
    label: &'static str,
    dispatches: Vec<Dispatch>,
}

impl Stage {
    pub(crate) const fn new(label: &'static str, dispatches: Vec<Dispatch>) -> Self {
        Self { label, dispatches }
    }

    /// Its dispatches, each as a stage of its own, to time them.
    pub fn parts(&self) -> impl Iterator<Item = Self> {
        self.dispatches.iter().map(|dispatch| Self::new(dispatch.name, vec![dispatch.clone()]))
    }

    /// Its name, as in `shaders/`.
    pub const fn label(&self) -> &'static str {
        self.label
    }

    /// Records the stage as one compute pass of `encoder`.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.record_timed(encoder, None);
    }

    /// The same, with times written at its beginning and end.
    pub fn record_timed(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        timestamp_writes: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        let descriptor = wgpu::ComputePassDescriptor { label: Some(self.label), timestamp_writes };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        for Dispatch { pipeline, bindings, workgroups: [x, y, z], .. } in &self.dispatches {
            pass.set_pipeline(pipeline);
            for (group, bindings) in (0..).zip(bindings) {
                pass.set_bind_group(group, bindings, &[]);
            }
            pass.dispatch_workgroups(*x, *y, *z);
        }
    }
}
