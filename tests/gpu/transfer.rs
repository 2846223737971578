//! Moves tables to the GPU and back.

use octagloss_core::bake::{Bake, BakeSettings, unwatched};
use octagloss_core::common::error::Result;
use octagloss_core::cpu::cells::Cells;
use octagloss_core::geometry::tent::Reconstruction;
use octagloss_core::light::environment::Environment;
use octagloss_core::light::oem::Oem;
use octagloss_core::light::sat::{FixedPoint, Sat};
use octagloss_gpu::device::readback;
use octagloss_gpu::engine::Engine;
use octagloss_gpu::stages::cells::{CellTree, levels_over};
use octagloss_gpu::stages::oem::Table;
use octagloss_gpu::{Context, OemPlanes, SatPlanes};

/// Fields of a quad of cells.
const QUAD_FIELDS: usize = 34;

/// Planes that tests fill from the CPU.
pub(super) trait Upload: Sized {
    /// The CPU's table.
    type From;

    /// Planes with the values of `from`.
    fn upload(context: &Context, from: &Self::From) -> Result<Self>;
}

/// Writes `side` x `side` values of each channel to its plane, converted by `word`.
fn write<V: Copy, W: bytemuck::Pod>(
    context: &Context,
    table: Table,
    planes: &[wgpu::Buffer; 4],
    values: &[[V; 4]],
    word: impl Fn(V) -> W,
) {
    for (channel, plane) in planes.iter().enumerate() {
        let mut words = vec![W::zeroed(); table.count() as usize];
        let rows = words.chunks_exact_mut(table.pitch as usize);
        for (row, values) in rows.zip(values.chunks_exact(table.side as usize)) {
            for (place, value) in row.iter_mut().zip(values) {
                *place = word(value[channel]);
            }
        }
        context.queue().write_buffer(plane, 0, bytemuck::cast_slice(&words));
    }
}

impl Upload for OemPlanes {
    type From = Oem;

    fn upload(context: &Context, oem: &Oem) -> Result<Self> {
        let planes = Self::new(context, oem.size())?;
        write(context, planes.table(), &planes.planes, oem.texels(), |energy: f32| energy);
        Ok(planes)
    }
}

impl Upload for SatPlanes {
    type From = Sat;

    fn upload(context: &Context, sat: &Sat) -> Result<Self> {
        let planes = Self::new(context, sat.size())?;
        let exponents = sat.fixed_point().exponents;
        context.queue().write_buffer(&planes.exponents, 0, bytemuck::cast_slice(&exponents));
        let words = |entry: u64| [entry as u32, (entry >> 32) as u32];
        write(context, Table::new(sat.size()), &planes.planes, sat.entries(), words);
        Ok(planes)
    }
}

/// Reads exponents and entries back in the form of [`Sat`].
pub(super) async fn read_sat(context: &Context, sat: &SatPlanes) -> Result<(FixedPoint, Vec<[u64; 4]>)> {
    let exponents: Vec<i32> = readback::read(context, &sat.exponents).await?;
    let fixed = FixedPoint { exponents: std::array::from_fn(|c| exponents[c]) };
    let entry = |[low, high]: [u32; 2]| u64::from(high) << 32 | u64::from(low);
    Ok((fixed, Table::new(sat.size()).read(context, &sat.planes, entry).await?))
}

/// 64-bit sums from their low and high words.
pub(super) fn joined([low, high]: &[[u32; 4]; 2]) -> [u64; 4] {
    std::array::from_fn(|c| u64::from(high[c]) << 32 | u64::from(low[c]))
}

/// Uploads the CPU's `cells` of an OEM of `inner` x `inner` texels with finest blocks of `block` x `block`.
pub(super) fn tree_of_cells(
    context: &Context,
    cells: &Cells,
    inner: u32,
    block: u32,
    reconstruction: Reconstruction,
) -> CellTree {
    let quads = cells.quad_fields();
    let (levels, count) = levels_over(inner.div_ceil(block));
    assert_eq!(quads.len(), count as usize, "quads of {inner} x {inner} texels in blocks of {block}");
    CellTree::holding(context, inner, block, reconstruction, cells.least(), levels, &quads)
}

/// A tree that a tolerance of zero cuts into exactly `leaves`
/// (`Scratch::leaf_fields`) over the `least` radiance. Used to replay cuts.
pub(super) fn tree_of_leaves(context: &Context, leaves: &[[f32; QUAD_FIELDS]], least: [f32; 3]) -> CellTree {
    let cells = (leaves.len().max(1) as f64).sqrt().ceil() as u32;
    let (levels, count) = levels_over(cells);
    let mut quads = vec![[[0.0; 4]; QUAD_FIELDS]; count as usize];
    let place = |level: usize, i: u32, j: u32| {
        let [first, width] = levels[level];
        ((first + j / 2 * width + i / 2) as usize, (i % 2 + 2 * (j % 2)) as usize)
    };
    for (k, leaf) in (0..).zip(leaves) {
        let (i, j) = (k % cells, k / cells);
        let (quad, sibling) = place(0, i, j);
        for (field, value) in quads[quad].iter_mut().zip(leaf) {
            field[sibling] = *value;
        }
        // Inner nodes get a radius of the whole sphere, so they are always split.
        for level in 1..levels.len() {
            let (quad, sibling) = place(level, i >> level, j >> level);
            // Covariance, radius, luminance and energies.
            for variance in &mut quads[quad][3..6] {
                variance[sibling] = 1.0;
            }
            quads[quad][9][sibling] = 2.0;
            for energy in 10..14 {
                quads[quad][energy][sibling] += leaf[energy];
            }
        }
    }
    // Stop above texels, so that leaves are not refined.
    let (inner, block) = (2 * cells, 2);
    CellTree::holding(context, inner, block, Reconstruction::Constant, least, levels, &quads)
}

/// Bakes once.
pub(super) async fn bake_one(
    engine: &Engine,
    environment: &Environment,
    settings: &BakeSettings,
) -> Result<Bake> {
    let mut bakes = engine.bake_all(environment, std::slice::from_ref(settings), &unwatched).await?;
    Ok(bakes.pop().expect("one bake for one settings"))
}
