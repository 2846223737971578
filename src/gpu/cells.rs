//! The quadtree of moments over an OEM's planes, level by level.

use super::fixed_point::{GROUPS, groups};
use super::oem::Table;
use super::stage::Dispatch;
use super::{Context, OemPlanes, Stage, shader};
use crate::cpu::tent::{Reconstruction, Tents};
use crate::error::Result;

/// Quads along an edge of a workgroup.
pub const EDGE: u32 = 8;

/// Bytes of a quad: fifteen vectors of four.
const QUAD: u64 = 240;

/// Bytes of a texel's moments.
const TENT: u64 = 48;

/// The uniform of one level.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Level {
    first: u32,
    width: u32,
    finer_first: u32,
    finer_width: u32,
    cells: u32,
    block: u32,
}

/// Moments of a texel's spread, as the shader reads them.
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

/// Pipelines of the stage.
#[derive(Clone, Debug)]
pub struct BuildCells {
    least_of_groups: wgpu::ComputePipeline,
    least_of_all: wgpu::ComputePipeline,
    finest: wgpu::ComputePipeline,
    coarser: wgpu::ComputePipeline,
}

/// The quadtree of one OEM, filled by its stage.
#[derive(Clone, Debug)]
pub struct CellTree {
    pub(super) inner: u32,
    pub(super) block: u32,
    pub(super) reconstruction: Reconstruction,
    /// The least radiance of each channel.
    pub(super) least: wgpu::Buffer,
    pub(super) quads: wgpu::Buffer,
    /// First quad and quads along an edge, from the finest level to the root.
    pub(super) levels: Vec<[u32; 2]>,
}

impl CellTree {
    /// The quads, sixty floats each, in the order of [`crate::cpu::cells::Cells`].
    #[must_use]
    pub const fn quads(&self) -> &wgpu::Buffer {
        &self.quads
    }

    /// Whether the tree over `inner` x `inner` texels in blocks of `block`, and their moments, fit.
    pub(super) fn check_fits(context: &Context, inner: u32, block: u32) -> Result<()> {
        let tents = |inner: u64| TENT * inner.div_ceil(2).pow(2);
        let quads = |inner: u64| QUAD * quad_count(&levels(inner.div_ceil(u64::from(block)) as u32));
        let bytes = |inner: u64| tents(inner).max(quads(inner));
        context.fits(
            &format!("a tree of cells over {inner} x {inner} texels"),
            bytes(inner.into()),
            |available| {
                let fitting =
                    (64..=u64::from(inner)).step_by(64).take_while(|inner| bytes(*inner) <= available);
                format!("choose --oem-size at most {}, or --engine cpu", fitting.last().unwrap_or(1))
            },
        )
    }

    /// The least radiance of each channel, and one float more.
    #[must_use]
    pub const fn least(&self) -> &wgpu::Buffer {
        &self.least
    }
}

/// First quad and quads along an edge of every level over `cells` x `cells` finest cells, up to the root.
fn levels(cells: u32) -> Vec<[u32; 2]> {
    let mut levels = Vec::new();
    let (mut first, mut width) = (0, cells);
    while levels.is_empty() || width > 1 {
        width = width.div_ceil(2);
        levels.push([first, width]);
        first += width * width;
    }
    levels
}

/// Quads of all levels; the root's is the last.
fn quad_count(levels: &[[u32; 2]]) -> u64 {
    levels.last().map_or(0, |[first, width]| u64::from(*first) + u64::from(*width))
}

impl BuildCells {
    /// Compiles the stage.
    #[must_use]
    pub fn new(context: &Context) -> Self {
        let module = shader::module(context, "cells.wgsl");
        let pipeline = |entry| shader::pipeline(context, &module, entry, &[]);
        Self {
            least_of_groups: pipeline("least_of_groups"),
            least_of_all: pipeline("least_of_all"),
            finest: pipeline("finest"),
            coarser: pipeline("coarser"),
        }
    }

    /// The cells of `oem` down to blocks of `block` x `block` texels, and the stage that fills them.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] where they are more than the device can bind.
    ///
    /// # Panics
    /// Where `block` is zero.
    pub fn stage(
        &self,
        context: &Context,
        oem: &OemPlanes,
        block: u32,
        reconstruction: Reconstruction,
    ) -> Result<(Stage, CellTree)> {
        assert!(block > 0, "blocks of at least one texel");
        let Table { inner, .. } = oem.table();
        CellTree::check_fits(context, inner, block)?;
        let cells = inner.div_ceil(block);
        let levels = levels(cells);
        let bytes = QUAD * quad_count(&levels);
        let tents: Vec<Tent> = Tents::new(inner, reconstruction)
            .quadrant()
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
        let partials = context.storage("least radiance of groups", 16 * u64::from(GROUPS));
        let least = context.storage("least radiance", 16);
        let quads = context.storage("quads", bytes);

        let table = (0, oem.table_buffer().as_entire_binding());
        let planes = (1..).zip(oem.planes()).map(|(binding, plane)| (binding, plane.as_entire_binding()));
        let planes: Vec<_> = std::iter::once(table).chain(planes).collect();
        let partials = (5, partials.as_entire_binding());
        let least_binding = (6, least.as_entire_binding());
        let quads_binding = (8, quads.as_entire_binding());
        let over = |width: u32| [width.div_ceil(EDGE), width.div_ceil(EDGE), 1];
        let mut dispatches = vec![
            Dispatch::new(
                context,
                &self.least_of_groups,
                &[&planes[..], std::slice::from_ref(&partials)].concat(),
                [groups(inner), 1, 1],
            ),
            Dispatch::new(
                context,
                &self.least_of_all,
                &[planes[0].clone(), partials, least_binding.clone()],
                [1, 1, 1],
            ),
        ];
        for (index, &[first, width]) in levels.iter().enumerate() {
            let [finer_first, finer_width] = if index > 0 { levels[index - 1] } else { [0, 0] };
            let uniform = Level { first, width, finer_first, finer_width, cells, block };
            let uniform = context.uniform("level of cells", &uniform);
            let level = (9, uniform.as_entire_binding());
            dispatches.push(if index == 0 {
                let tents = (7, tents.as_entire_binding());
                let own = [least_binding.clone(), tents, quads_binding.clone(), level];
                Dispatch::new(context, &self.finest, &[&planes[..], &own].concat(), over(width))
            } else {
                Dispatch::new(context, &self.coarser, &[quads_binding.clone(), level], over(width))
            });
        }
        let tree = CellTree { inner, block, reconstruction, least, quads, levels };
        Ok((Stage::new("cells", dispatches), tree))
    }
}
