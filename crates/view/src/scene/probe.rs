//! Probes: maps of the scene around glossy parts, and their tables.

use super::content::Scene;
use super::uniforms::{POSE_GROUP, PoseUniform};
use bytemuck::Zeroable as _;
use glam::DVec3;
use octagloss_core::common::error::Result;
use octagloss_gpu::Context;
use octagloss_gpu::device::resources::{UNIFORM, group, group_layout, pipeline_layout, storage_binding};
use octagloss_gpu::device::timer::Timer;
use octagloss_gpu::direct::{Direct, DirectFrame, DirectMesh, DirectTarget, Method, Overlap};
use octagloss_gpu::live::LiveEnvironment;
use octagloss_gpu::triangles::{DirectMap, check_near};

/// Distance of the near surface of a probe.
const NEAR: f32 = 0.02;

/// Format of the maps.
const FORMAT: wgpu::TextureFormat = LiveEnvironment::COLOUR;

/// Pipelines that fill probes.
#[derive(Debug)]
pub(super) struct ProbePasses {
    direct: Direct,
    layout: wgpu::BindGroupLayout,
    matte: wgpu::ComputePipeline,
    glossy: wgpu::ComputePipeline,
}

/// The scene's buffers on the GPU.
#[derive(Debug)]
pub(super) struct SceneBuffers {
    pub(super) corners: wgpu::Buffer,
    pub(super) indices: wgpu::Buffer,
    pub(super) parts: wgpu::Buffer,
    pub(super) texels: wgpu::Buffer,
    pub(super) light: wgpu::Buffer,
}

/// A map around a glossy part.
#[derive(Debug)]
pub(super) struct Probe {
    /// The part.
    pub(super) part: usize,
    pub(super) mesh: DirectMesh,
    /// The map: a layer per face of a cube.
    pub(super) target: DirectTarget,
    frame: DirectFrame,
    /// Matte corners, then glossy ones.
    poses: Vec<Pose>,
    /// Passes of [`Probe::fill`].
    pub(super) passes: u32,
}

/// A dispatch that places a range of corners.
#[derive(Debug)]
struct Pose {
    uniform: wgpu::Buffer,
    group: wgpu::BindGroup,
    first: u32,
    count: u32,
    pipeline: wgpu::ComputePipeline,
}

impl ProbePasses {
    /// Compiles the passes.
    ///
    /// # Errors
    /// Those of [`Direct::new`].
    pub(super) fn new(context: &Context, live_layout: &wgpu::BindGroupLayout) -> Result<Self> {
        let device = context.device();
        let read = storage_binding(true);
        let kinds = [UNIFORM, UNIFORM, read, read, read, storage_binding(false)];
        let layout = group_layout(context, "scene pose", wgpu::ShaderStages::COMPUTE, &kinds);
        let module = context.module("view/scene_pose.wgsl");
        let pipeline = |entry, groups: &[&wgpu::BindGroupLayout]| {
            let layout = pipeline_layout(context, entry, groups.iter().copied());
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        };
        Ok(Self {
            direct: Direct::new(context, FORMAT, Overlap::Nearest)?,
            matte: pipeline("pose_matte", &[&layout]),
            glossy: pipeline("pose_glossy", &[&layout, live_layout]),
            layout,
        })
    }
}

impl Probe {
    /// A probe at glossy part `part` for the tables of `live`, drawn by `method`.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Limit`] and
    /// [`octagloss_core::common::error::Error::Parameter`] if the scene or the map does not fit the device.
    pub(super) fn new(
        context: &Context,
        passes: &ProbePasses,
        scene: &Scene,
        buffers: &SceneBuffers,
        part: usize,
        method: Method,
        live: &mut LiveEnvironment,
    ) -> Result<Self> {
        check_near(NEAR)?;
        let triangles = scene.triangles(part)?;
        let mesh = DirectMesh::upload(context, &triangles)?;
        let map = if method.is_cube() {
            // As many texels.
            DirectMap::Cube { size: ((f64::from(live.size()).powi(2) / 6.0).sqrt().round() as u32).max(2) }
        } else {
            DirectMap::Octahedral { size: live.size() }
        };
        let target = DirectTarget::new(context, map, FORMAT)?;
        let frame = passes.direct.frame(method, &mesh, &target, NEAR)?;
        let all = scene.corners.len() as u32;
        let matte = scene.parts.get(scene.glossy().start).map_or(all, |part| part.corners.start);
        let ranges = [(0..matte, &passes.matte), (matte..all, &passes.glossy)];
        let poses = ranges
            .into_iter()
            .filter(|(range, _)| !range.is_empty())
            .map(|(range, pipeline)| {
                let (first, count) = (range.start, range.len() as u32);
                let uniform = context.uniform("scene pose", &PoseUniform::zeroed());
                let SceneBuffers { light, parts, corners, texels, .. } = buffers;
                let resources = [&uniform, light, parts, corners, texels, mesh.corners()];
                let resources = resources.map(wgpu::Buffer::as_entire_binding);
                let group = group(context, "scene pose", &passes.layout, resources);
                Pose { uniform, group, first, count, pipeline: pipeline.clone() }
            })
            .collect();
        let passes = frame.passes() + live.stages(&target.colour)?.count() as u32;
        Ok(Self { part, mesh, target, frame, poses, passes })
    }

    /// Records the pass that places the corners around `centre`. Glossy parts reflect `lives`, the group of
    /// all probes.
    pub(super) fn pose(
        &self,
        context: &Context,
        encoder: &mut wgpu::CommandEncoder,
        centre: DVec3,
        lives: &wgpu::BindGroup,
        timestamp_writes: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        for Pose { uniform, first, count, .. } in &self.poses {
            let hidden = self.part as u32;
            let centre = centre.as_vec3().to_array();
            let pose = PoseUniform { centre, hidden, first: *first, count: *count, pad: [0; 2] };
            context.queue().write_buffer(uniform, 0, bytemuck::bytes_of(&pose));
        }
        let descriptor = wgpu::ComputePassDescriptor { label: Some("pose"), timestamp_writes };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        pass.set_bind_group(1, lives, &[]);
        for Pose { group, count, pipeline, .. } in &self.poses {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            let [x, y, z] = octagloss_gpu::device::stage::in_rows(count.div_ceil(POSE_GROUP));
            pass.dispatch_workgroups(x, y, z);
        }
    }

    /// Records the draws into the map and the passes of the tables of `live`. With a timer, passes write
    /// their times from place 0 on; returns their labels.
    ///
    /// # Errors
    /// Those of [`LiveEnvironment::update`].
    pub(super) fn fill(
        &self,
        live: &mut LiveEnvironment,
        encoder: &mut wgpu::CommandEncoder,
        timer: Option<&Timer>,
    ) -> Result<Vec<&'static str>> {
        self.frame.record(encoder, timer);
        let mut labels = vec!["draw"; self.frame.passes() as usize];
        if self.frame.has_list() {
            labels[0] = "lists";
        }
        for stage in live.stages(&self.target.colour)? {
            let writes = timer.map(|timer| timer.compute_writes(labels.len() as u32));
            stage.record_timed(encoder, writes);
            labels.push(stage.label());
        }
        Ok(labels)
    }
}
