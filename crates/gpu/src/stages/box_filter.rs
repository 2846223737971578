//! Box queries over the exact SAT in textures: for lists of directions, and as WGSL for the caller's shaders.

use super::oem::Table;
use super::{fixed_point, sat_hensley, sat_scan};
use crate::device::readback;
use crate::device::resources::{UNIFORM, group, group_layout, texture_binding};
use crate::device::stage::{Dispatch, in_rows};
use crate::{Context, OemPlanes, SatPlanes, Stage};
use glam::DVec3;
use octagloss_core::common::error::{Error, Result};
use octagloss_core::cpu::box_filter::StackedBox;
use octagloss_core::light::sat::Scan;

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
    /// Creates textures for `sat`; [`pack`] fills them.
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
            let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING;
            let format = wgpu::TextureFormat::Rgba32Uint;
            let texture = context.texture(label, format, [side, side, 1], 1, usage);
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        });
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE;
        let header = context.buffer("SAT header", 32, usage);
        Ok(Self { header, low, high })
    }

    /// Layout of a bind group with the resources of `common/sat.wgsl`, for the shader stages `visibility`.
    pub fn bind_group_layout(context: &Context, visibility: wgpu::ShaderStages) -> wgpu::BindGroupLayout {
        let texture = texture_binding(wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D2);
        group_layout(context, "octagloss table", visibility, &[UNIFORM, texture, texture])
    }

    /// Bind group of the table's resources, with `layout`.
    pub fn bind_group(&self, context: &Context, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let [low, high] = [&self.low, &self.high].map(wgpu::BindingResource::TextureView);
        group(context, "octagloss table", layout, [self.header.as_entire_binding(), low, high])
    }
}

/// The exact table of `planes` in textures, and the stages that fill them; all scans give the same words.
///
/// # Errors
/// [`Error::Limit`] if the table exceeds the device, [`Error::Unsupported`] for the serial scan,
/// [`Error::Parameter`] for an invalid radix.
pub fn tables(context: &Context, scan: Scan, planes: &OemPlanes) -> Result<(SatTextures, [Stage; 3])> {
    scan.check()?;
    let sat = SatPlanes::new(context, planes.size())?;
    let textures = SatTextures::new(context, &sat)?;
    let scanned = match scan {
        Scan::Blocks => sat_scan::stage(context, planes, &sat),
        Scan::Hensley { radix } => sat_hensley::stage(context, radix, planes, &sat),
        Scan::Serial => return Err(Error::Unsupported { what: "the serial scan".to_owned() }),
    };
    let stages = [fixed_point::stage(context, planes, &sat), scanned, pack(context, &sat, &textures)];
    Ok((textures, stages))
}

/// The stage that copies the words of `sat` into `textures`.
pub fn pack(context: &Context, sat: &SatPlanes, textures: &SatTextures) -> Stage {
    let table = Table::new(sat.size());
    let uniform = context.uniform("table", &table);
    let mut resources = vec![(0, uniform.as_entire_binding())];
    resources.extend((1..).zip(sat.planes.iter().map(wgpu::Buffer::as_entire_binding)));
    resources.extend([
        (5, wgpu::BindingResource::TextureView(&textures.low)),
        (6, wgpu::BindingResource::TextureView(&textures.high)),
        (7, sat.exponents.as_entire_binding()),
        (8, textures.header.as_entire_binding()),
    ]);
    let groups = table.side.div_ceil(EDGE);
    Stage::new("pack", vec![Dispatch::new(context, ("pack.wgsl", "pack"), &resources, [groups, groups, 1])])
}

/// Radiance of the boxes of `stack` around each of `directions`, read back; see
/// [`octagloss_core::cpu::box_filter::BoxFilter`].
///
/// # Errors
/// [`Error::Gpu`] if the device fails.
pub async fn radiance(
    context: &Context,
    textures: &SatTextures,
    directions: &[DVec3],
    stack: &[StackedBox],
) -> Result<Vec<[f32; 3]>> {
    let queries: Vec<[f32; 4]> =
        directions.iter().map(|direction| direction.as_vec3().extend(0.0).to_array()).collect();
    let stack: Vec<[f32; 2]> = stack.iter().map(|one| [one.solid_angle as f32, one.weight as f32]).collect();
    let stack = context.storage_of("stack", &stack);
    let pipeline = context.pipeline("box_filter.wgsl", "radiance", None);
    let table = textures.bind_group(context, &pipeline.get_bind_group_layout(0));
    let mut answers = Vec::with_capacity(queries.len());
    for batch in queries.chunks(1 << 22) {
        let queries = context.storage_of("directions", batch);
        let answered = context.storage("answers", 16 * batch.len() as u64);
        let lists = [&queries, &answered, &stack].map(wgpu::Buffer::as_entire_binding);
        let lists = group(context, "queries", &pipeline.get_bind_group_layout(1), lists);
        let groups = in_rows((batch.len() as u32).div_ceil(GROUP_SIZE));
        let dispatch = Dispatch::with_groups(&pipeline, vec![table.clone(), lists], groups);
        let stage = Stage::new("box_filter", vec![dispatch]);
        context.submit(|encoder| stage.record(encoder));
        let found: Vec<[f32; 4]> = readback::read(context, &answered).await?;
        answers.extend(found.iter().map(|[r, g, b, _]| [*r, *g, *b]));
    }
    Ok(answers)
}
