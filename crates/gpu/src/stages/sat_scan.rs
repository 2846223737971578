//! The production scan: four dispatches per pair of channels; reads the input twice and writes the output
//! once.

use super::oem::Table;
use crate::device::stage::Dispatch;
use crate::{Context, OemPlanes, SatPlanes, Stage};

/// Texels along an edge of a tile.
pub const TILE: u32 = 64;

/// Invocations of a workgroup that carries sums from tile to tile.
pub const GROUP_SIZE: u32 = 256;

/// Uniform of one pair of channels.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Scan {
    side: u32,
    pitch: u32,
    tiles: u32,
    channel: u32,
}

const FILE: &str = "sat_scan.wgsl";

/// Stage that writes the table of `oem` to `sat`, whose exponents must be filled.
pub fn stage(context: &Context, oem: &OemPlanes, sat: &SatPlanes) -> Stage {
    let Table { side, pitch, .. } = oem.table();
    let tiles = side.div_ceil(TILE);
    // Eight bytes per channel, row of tiles and texel along the edge.
    let carried = 2 * 8 * u64::from(tiles) * u64::from(tiles * TILE);
    let rows_left = context.storage("SAT carries to the right", carried);
    let above = context.storage("SAT carries down", carried);
    let mut dispatches = Vec::new();
    for channel in [0, 2] {
        let scan = context.uniform("SAT scan", &Scan { side, pitch, tiles, channel: channel as u32 });
        let scan = (0, scan.as_entire_binding());
        let input = [
            (1, sat.exponents.as_entire_binding()),
            (2, oem.planes[channel].as_entire_binding()),
            (3, oem.planes[channel + 1].as_entire_binding()),
        ];
        let rows_left = (4, rows_left.as_entire_binding());
        let above = (5, above.as_entire_binding());
        let output =
            [(6, sat.planes[channel].as_entire_binding()), (7, sat.planes[channel + 1].as_entire_binding())];
        let carries = [scan.clone(), rows_left, above.clone()];
        let sums = [&carries[..], &input].concat();
        let tables = [&sums[..], &output].concat();
        let groups = (tiles * TILE).div_ceil(GROUP_SIZE);
        dispatches.extend([
            Dispatch::new(context, (FILE, "tile_sums"), &sums, [tiles, tiles, 2]),
            Dispatch::new(context, (FILE, "carries"), &carries, [groups, 1, 2]),
            Dispatch::new(context, (FILE, "carry_rows"), &[scan, above], [tiles, 1, 2]),
            Dispatch::new(context, (FILE, "tables"), &tables, [tiles, tiles, 2]),
        ]);
    }
    Stage::new("sat_scan", dispatches)
}
