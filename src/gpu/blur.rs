//! The tables that soft boxes are read from: an OEM's, blurred by a tent, one an octave of alpha.

use super::fitted::FittedTables;
use super::stage::Dispatch;
use super::{Context, SatPlanes, Stage, oem, readback, shader};
use crate::cpu::blur::grids;
use crate::cpu::fitted::finest_octave;
use crate::error::Result;

/// Texels along an edge of a tile of a grid that is blurred.
pub const EDGE: u32 = 16;

/// Invocations of a workgroup that blurs.
pub const GROUP_SIZE: u32 = 256;

/// Invocations that a row or a column of a table is summed by.
pub const LINE_SIZE: u32 = 64;

/// Corners along an edge that a tile reaches.
pub const REACH: u32 = 31;

/// Octaves that there can be.
pub const OCTAVES: usize = 6;

/// Texels of border around a blurred square. Of the boxes around directions all over the sphere less than one in a hundred
/// leave it, a few wide ones that hold little of their lobes; those are read by the parity of the unfolded plane.
pub const BORDER: u32 = 40;

/// Where the table of one octave lies among all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Octave {
    fine: u32,
    box_side: u32,
    coarse: u32,
    side: u32,
    first_texel: u32,
    first_entry: u32,
    first_tile: u32,
    first_row: u32,
}

shader::members!(Octave { fine, box_side, coarse, side, first_texel, first_entry, first_tile, first_row });

/// The tables of all octaves over one size of OEM.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub(super) octaves: [Octave; OCTAVES],
    pub(super) finest: u32,
    pub(super) texels: u32,
    pub(super) entries: u32,
    tiles: u32,
    rows: u32,
}

impl Layout {
    /// Over an OEM of `inner` texels, a power of two and at least 16.
    pub(super) fn new(inner: u32) -> Self {
        let finest = finest_octave(inner);
        let mut all =
            Self { octaves: [Octave::default(); OCTAVES], finest, texels: 0, entries: 0, tiles: 0, rows: 0 };
        for (place, octave) in all.octaves.iter_mut().zip(1..=finest) {
            let [fine, coarse] = grids(inner, octave);
            let side = coarse + 2 * BORDER + 1;
            *place = Octave {
                fine,
                box_side: fine >> (octave + 1),
                coarse,
                side,
                first_texel: all.texels,
                first_entry: all.entries,
                first_tile: all.tiles,
                first_row: all.rows,
            };
            all.texels += coarse * coarse;
            all.entries += side * side;
            all.tiles += (fine / EDGE).pow(2);
            all.rows += side;
        }
        all
    }
}

/// Pipelines of the stage.
#[derive(Clone, Debug)]
pub struct Blur {
    blur: wgpu::ComputePipeline,
    rows: wgpu::ComputePipeline,
    columns: wgpu::ComputePipeline,
}

impl Blur {
    /// Compiles the stage.
    #[must_use]
    pub fn new(context: &Context) -> Self {
        let module = shader::module(context, "blur.wgsl");
        let pipeline = |entry| shader::pipeline(context, &module, entry, &[]);
        Self { blur: pipeline("blur"), rows: pipeline("rows"), columns: pipeline("columns") }
    }

    /// The blurred tables of `sat` into those of `tables`.
    ///
    /// # Panics
    /// Where they were made for another size.
    #[must_use]
    pub fn stage(&self, context: &Context, sat: &SatPlanes, tables: &FittedTables) -> Stage {
        assert_eq!(sat.size().inner, tables.inner(), "tables for this size");
        let layout = Layout::new(tables.inner());
        let texels = context.storage("blurred texels", 32 * u64::from(layout.texels));
        let table = context.uniform("table", &oem::Table::new(sat.size()));
        let octaves = (5, tables.octaves().as_entire_binding());
        let entries = (8, tables.entries().as_entire_binding());
        let mut blur = vec![(0, table.as_entire_binding()), octaves.clone(), (6, texels.as_entire_binding())];
        blur.extend((1..).zip(sat.planes().iter().map(wgpu::Buffer::as_entire_binding)));
        let rows = [octaves.clone(), (7, texels.as_entire_binding()), entries.clone()];
        Stage::new(
            "blur",
            vec![
                Dispatch::new(context, &self.blur, &blur, [layout.tiles, oem::CHANNELS as u32, 1]),
                Dispatch::new(context, &self.rows, &rows, [layout.rows, 1, 1]),
                Dispatch::new(context, &self.columns, &[octaves, entries], [layout.rows, 1, 1]),
            ],
        )
    }
}

impl FittedTables {
    /// Reads the blurred table of `octave` back: entries of the bordered square with a first row and column of zeros, and
    /// texels along an edge of the square and its border.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] where the device fails.
    ///
    /// # Panics
    /// Where there is no such octave.
    pub async fn read_blurred(&self, context: &Context, octave: u32) -> Result<(Vec<[u64; 4]>, [u32; 2])> {
        let layout = Layout::new(self.inner());
        assert!((1..=layout.finest).contains(&octave), "octaves 1 to {}", layout.finest);
        let Octave { coarse, side, first_entry, .. } = layout.octaves[octave as usize - 1];
        let words: Vec<[[u32; 4]; 2]> = readback::read(context, self.entries()).await?;
        let own = &words[first_entry as usize..][..(side * side) as usize];
        let join = |[low, high]: &[[u32; 4]; 2]| {
            std::array::from_fn(|c| u64::from(high[c]) << 32 | u64::from(low[c]))
        };
        Ok((own.iter().map(join).collect(), [coarse, BORDER]))
    }
}
