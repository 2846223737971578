//! Builds the quadtree of moments over an OEM's planes, level by level.

use super::least;
use super::oem::Table;
use crate::device::resources::layers;
use crate::device::stage::Dispatch;
use crate::{Context, OemPlanes, Stage};
use octagloss_core::common::error::Result;
use octagloss_core::cpu::cells::{Cells, QUAD_FIELDS, SubdivisionTables, omitted_radiance};
use octagloss_core::geometry::source_texels::{SourceGrid, most_runs};
use octagloss_core::geometry::tent::{Reconstruction, tents};
use octagloss_core::light::environment::Layout;

/// Quads along an edge of a workgroup.
pub const EDGE: u32 = 8;

/// Bytes of a quad.
const QUAD: u64 = 16 * QUAD_FIELDS as u64;

/// Bytes of a texel's moments.
const TENT: u64 = 48;

/// Uniform of one level.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct CellLevel {
    first: u32,
    width: u32,
    finer_first: u32,
    finer_width: u32,
    cells: u32,
    block: u32,
}

/// Moments of a texel's spread in the shader's layout.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Tent {
    centroid: [f32; 3],
    radius: f32,
    diagonal: [f32; 3],
    pad_0: f32,
    mixed: [f32; 3],
    pad_1: f32,
}

/// The quadtree of one OEM, filled by its stage.
#[derive(Clone, Debug)]
pub struct CellTree {
    pub(super) inner: u32,
    pub(super) block: u32,
    pub(super) reconstruction: Reconstruction,
    /// The least radiance of each channel, padded to four floats.
    pub least: wgpu::Buffer,
    /// The quads, four times `QUAD_FIELDS` floats each, in the order of
    /// [`octagloss_core::cpu::cells::Cells`].
    pub quads: wgpu::Buffer,
    /// First quad and quads along an edge, from the finest level to the root.
    pub(super) levels: Vec<[u32; 2]>,
    /// Bound of the radiance that energies counted as zero add to an answer.
    pub(super) omitted: f64,
    /// The texels of the source in every cell, for the subdivision of cells; none for a tree over an OEM.
    pub(super) grid: SourceGrid,
    pub(super) members: wgpu::Buffer,
    pub(super) angles: wgpu::Buffer,
    pub(super) light: wgpu::TextureView,
}

/// Remedy for a source with too many texels.
fn smaller_source(_: u64) -> String {
    "bake from a smaller source, or with `engine` cpu".to_owned()
}

/// First quad and quads along an edge of every level, from the finest to the root, over `cells` cells along
/// an edge; and the number of quads in all levels.
pub fn levels_over(cells: u32) -> (Vec<[u32; 2]>, u32) {
    let mut levels: Vec<[u32; 2]> = Vec::new();
    let mut first = 0;
    let mut width = cells;
    while levels.is_empty() || width > 1 {
        width = width.div_ceil(2);
        levels.push([first, width]);
        first += width * width;
    }
    (levels, first)
}

impl CellTree {
    /// Uploads the CPU's `cells` of the texels of a source ([`Cells::of_source`]), and their members.
    /// `texture` holds the source's light.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Limit`] if they are larger than the device can bind.
    ///
    /// # Panics
    /// If `cells` are those of an OEM.
    pub fn of_source(context: &Context, cells: &Cells, texture: &wgpu::Texture) -> Result<Self> {
        let SubdivisionTables { width, grid, members, angles } =
            cells.source_tables().expect("cells of a source");
        let (levels, count) = levels_over(width);
        context.fits("the cells of the source", QUAD * u64::from(count), |_| {
            "choose a smaller `oem_size`, or `engine` cpu".to_owned()
        })?;
        context.fits("the texels of the source by cells", 4 * members.len() as u64, smaller_source)?;
        let tree = Self::holding(
            context,
            width,
            1,
            Reconstruction::Constant,
            cells.least(),
            levels,
            &cells.quad_fields(),
        );
        Ok(Self {
            omitted: cells.omitted(),
            grid,
            members: context.storage_of("texels of the source by cells", &members),
            angles: context.storage_of("angles of the source", &angles),
            light: layers(texture),
            ..tree
        })
    }

    /// A tree with the given levels, as [`levels_over`] has them, and quads.
    pub fn holding(
        context: &Context,
        inner: u32,
        block: u32,
        reconstruction: Reconstruction,
        [red, green, blue]: [f32; 3],
        levels: Vec<[u32; 2]>,
        quads: &[[[f32; 4]; QUAD_FIELDS]],
    ) -> Self {
        let least = context.storage_of("least radiance", &[red, green, blue, 0.0]);
        let quads = context.storage_of("quads", quads);
        Self::in_buffers(context, inner, block, reconstruction, levels, least, quads)
    }

    /// The same with the buffers of the least radiance and the quads.
    fn in_buffers(
        context: &Context,
        inner: u32,
        block: u32,
        reconstruction: Reconstruction,
        levels: Vec<[u32; 2]>,
        least: wgpu::Buffer,
        quads: wgpu::Buffer,
    ) -> Self {
        let (format, usage) = (wgpu::TextureFormat::Rgba32Float, wgpu::TextureUsages::TEXTURE_BINDING);
        let no_source = context.texture("no source", format, [1; 3], 1, usage);
        Self {
            inner,
            block,
            reconstruction,
            least,
            quads,
            levels,
            omitted: omitted_radiance(inner),
            grid: SourceGrid::default(),
            members: context.storage("no members", 4),
            angles: context.storage("no angles", 8),
            light: layers(&no_source),
        }
    }

    /// Checks that the tree over `inner` x `inner` texels, in blocks of `block(inner)`, and the moments of
    /// its texels fit the device.
    pub fn check_fits(context: &Context, inner: u32, block: impl Fn(u32) -> u32) -> Result<()> {
        let tents = |inner: u32| TENT * u64::from(inner.div_ceil(2)).pow(2);
        let quads = |inner: u32| QUAD * u64::from(levels_over(inner.div_ceil(block(inner))).1);
        let bytes = |inner: u32| tents(inner).max(quads(inner));
        let what = format!("a tree of cells over {inner} x {inner} texels");
        context.fits(&what, bytes(inner), |available| {
            let fitting = (1..inner).rev().find(|inner| bytes(*inner) <= available);
            format!("choose `oem_size` of at most {}, or `engine` cpu", fitting.unwrap_or(0))
        })
    }

    /// Checks that the lists of the texels of a source of `layout` by `width` x `width` cells fit the device.
    pub fn check_members_fit(context: &Context, layout: Layout, width: u32) -> Result<()> {
        let words = u64::from(width) * u64::from(width) + 1 + 3 * most_runs(layout, width);
        context.fits("the texels of the source by cells", 4 * words, smaller_source)
    }
}

/// The cells of `oem` down to blocks of `block` x `block` texels, and the stage that fills them.
///
/// # Errors
/// [`octagloss_core::common::error::Error::Limit`] if they are larger than the device can bind.
///
/// # Panics
/// If `block` is zero.
pub fn stage(
    context: &Context,
    oem: &OemPlanes,
    block: u32,
    reconstruction: Reconstruction,
) -> Result<(Stage, CellTree)> {
    assert!(block > 0, "blocks of at least one texel");
    let Table { inner, .. } = oem.table();
    CellTree::check_fits(context, inner, |_| block)?;
    let cells = inner.div_ceil(block);
    let (levels, count) = levels_over(cells);
    let bytes = QUAD * u64::from(count);
    let tents: Vec<Tent> = tents(inner, reconstruction)
        .values()
        .iter()
        .map(|patch| Tent {
            centroid: patch.centroid.to_array(),
            radius: patch.radius,
            diagonal: patch.diagonal.to_array(),
            pad_0: 0.0,
            mixed: patch.mixed.to_array(),
            pad_1: 0.0,
        })
        .collect();
    let tents = context.storage_of("moments of texels", &tents);
    let of_all = context.storage("least radiance", 16);
    let quads = context.storage("quads", bytes);

    let planes = oem.bindings();
    let least_binding = (6, of_all.as_entire_binding());
    let quads_binding = (8, quads.as_entire_binding());
    let over = |width: u32| [width.div_ceil(EDGE), width.div_ceil(EDGE), 1];
    let mut dispatches = Vec::from(least::dispatches(context, oem, of_all.as_entire_binding()));
    for (index, &[first, width]) in levels.iter().enumerate() {
        let [finer_first, finer_width] = if index > 0 { levels[index - 1] } else { [0, 0] };
        let uniform = CellLevel { first, width, finer_first, finer_width, cells, block };
        let uniform = context.uniform("level of cells", &uniform);
        let level = (9, uniform.as_entire_binding());
        dispatches.push(if index == 0 {
            let tents = (7, tents.as_entire_binding());
            let own = [least_binding.clone(), tents, quads_binding.clone(), level];
            Dispatch::new(context, ("cells.wgsl", "finest"), &[&planes[..], &own].concat(), over(width))
        } else {
            Dispatch::new(context, ("cells.wgsl", "coarser"), &[quads_binding.clone(), level], over(width))
        });
    }
    let tree = CellTree::in_buffers(context, inner, block, reconstruction, levels, of_all, quads);
    Ok((Stage::new("cells", dispatches), tree))
}
