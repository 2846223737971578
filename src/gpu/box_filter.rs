//! Box queries over the exact SAT in textures: for lists of directions, and as WGSL for the caller's shaders.

use super::device::stage::{Dispatch, in_rows};
use super::device::{readback, shader};
use super::oem::Table;
use super::{Context, SatPlanes, Stage};
use crate::cpu::box_filter::StackedBox;
use crate::error::{Error, Result};
use glam::DVec3;

/// Edge of a workgroup of the packing pass, in invocations.
pub const EDGE: u32 = 16;

/// Invocations of a workgroup of the query passes.
pub const GROUP_SIZE: u32 = 64;

/// An exact table as shaders query it: two textures of words, and a header with exponents and sizes.
///
/// `common/sat.wgsl` reads it.
#[derive(Clone, Debug)]
pub struct SatTextures {
    /// Exponents and sizes: `OctaglossTable`.
    pub header: wgpu::Buffer,
    /// Low words.
    pub low: wgpu::TextureView,
    /// High words.
    pub high: wgpu::TextureView,
}

impl SatTextures {
    /// Creates textures for `sat`; [`BoxFilter::pack`] fills them.
    ///
    /// # Errors
    /// [`Error::Limit`] if the table exceeds the device's texture size.
    pub fn new(context: &Context, sat: &SatPlanes) -> Result<Self> {
        let side = sat.size().bordered();
        let most = context.device().limits().max_texture_dimension_2d;
        if side > most {
            return Err(Error::Limit {
                what: format!("a table of {side} x {side} as textures"),
                needed: 32 * u64::from(side) * u64::from(side),
                available: 32 * u64::from(most) * u64::from(most),
                remedy: format!("choose `oem_size` plus twice `border` of at most {most}"),
            });
        }
        let [low, high] = ["SAT low words", "SAT high words"].map(|label| {
            let texture = context.device().create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba32Uint,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        });
        let header = context.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("SAT header"),
            size: 32,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        Ok(Self { header, low, high })
    }

    /// Layout of a bind group with the resources of `common/sat.wgsl`, for the shader stages `visibility`.
    #[must_use]
    pub fn bind_group_layout(device: &wgpu::Device, visibility: wgpu::ShaderStages) -> wgpu::BindGroupLayout {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Uint,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let header = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("octagloss table"),
            entries: &[entry(0, header), entry(1, texture), entry(2, texture)],
        })
    }

    /// Bind group of the table's resources, with `layout`.
    #[must_use]
    pub fn bind_group(&self, device: &wgpu::Device, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let texture = wgpu::BindingResource::TextureView;
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("octagloss table"),
            layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: self.header.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: texture(&self.low) },
                wgpu::BindGroupEntry { binding: 2, resource: texture(&self.high) },
            ],
        })
    }
}

/// Pipelines that pack tables into textures and query them.
#[derive(Clone, Debug)]
pub struct BoxFilter {
    pack: wgpu::ComputePipeline,
    radiance: wgpu::ComputePipeline,
}

impl BoxFilter {
    /// Compiles the stage.
    #[must_use]
    pub fn new(context: &Context) -> Self {
        let pack = shader::module(context, "pack.wgsl");
        let queries = shader::module(context, "box_filter.wgsl");
        Self {
            pack: shader::pipeline(context, &pack, "pack", &[]),
            radiance: shader::pipeline(context, &queries, "radiance", &[]),
        }
    }

    /// The stage that copies the words of `sat` into `textures`.
    #[must_use]
    pub fn pack(&self, context: &Context, sat: &SatPlanes, textures: &SatTextures) -> Stage {
        let table = Table::new(sat.size());
        let uniform = context.uniform("table", &table);
        let mut resources = vec![(0, uniform.as_entire_binding())];
        resources.extend((1..).zip(sat.planes().iter().map(wgpu::Buffer::as_entire_binding)));
        resources.extend([
            (5, wgpu::BindingResource::TextureView(&textures.low)),
            (6, wgpu::BindingResource::TextureView(&textures.high)),
            (7, sat.exponents().as_entire_binding()),
            (8, textures.header.as_entire_binding()),
        ]);
        let groups = table.side.div_ceil(EDGE);
        Stage::new("pack", vec![Dispatch::new(context, &self.pack, &resources, [groups, groups, 1])])
    }

    /// Radiance of the boxes of `stack` around each of `directions`, read back; see
    /// [`crate::cpu::box_filter::BoxFilter`].
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device fails.
    pub async fn radiance(
        &self,
        context: &Context,
        textures: &SatTextures,
        directions: &[DVec3],
        stack: &[StackedBox],
    ) -> Result<Vec<[f32; 3]>> {
        let queries: Vec<[f32; 4]> =
            directions.iter().map(|direction| direction.as_vec3().extend(0.0).to_array()).collect();
        let stack: Vec<[f32; 2]> =
            stack.iter().map(|one| [one.solid_angle as f32, one.weight as f32]).collect();
        let stack = context.storage_of("stack", &stack);
        let mut answers = Vec::with_capacity(queries.len());
        for batch in queries.chunks(1 << 22) {
            let queries = context.storage_of("directions", batch);
            let lists = [(0, &queries), (4, &stack)];
            let found: Vec<[f32; 4]> = ask(context, &self.radiance, textures, &lists, 1, batch.len()).await?;
            answers.extend(found.iter().map(|[r, g, b, _]| [*r, *g, *b]));
        }
        Ok(answers)
    }
}

/// Runs `pipeline` over `count` queries with `lists` at their bindings of group 1, and reads binding
/// `answers` back.
async fn ask<A: bytemuck::Pod>(
    context: &Context,
    pipeline: &wgpu::ComputePipeline,
    textures: &SatTextures,
    lists: &[(u32, &wgpu::Buffer)],
    answers: u32,
    count: usize,
) -> Result<Vec<A>> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let answered = context.storage("answers", (size_of::<A>() * count) as u64);
    let device = context.device();
    let table = textures.bind_group(device, &pipeline.get_bind_group_layout(0));
    let entries: Vec<_> = lists
        .iter()
        .chain([&(answers, &answered)])
        .map(|(binding, buffer)| wgpu::BindGroupEntry {
            binding: *binding,
            resource: buffer.as_entire_binding(),
        })
        .collect();
    let lists = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("queries"),
        layout: &pipeline.get_bind_group_layout(1),
        entries: &entries,
    });
    let groups = u32::try_from(count).expect("what a buffer holds").div_ceil(GROUP_SIZE);
    context.submit(|encoder| {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &table, &[]);
        pass.set_bind_group(1, &lists, &[]);
        let [x, y, z] = in_rows(groups);
        pass.dispatch_workgroups(x, y, z);
    });
    readback::read(context, &answered).await
}
