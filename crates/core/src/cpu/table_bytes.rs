//! Memory required by an octahedral map and its tables, computed before allocation.
//!
//! Figures follow from the sizes of the types and were checked against the resident size. At 8192 texels the
//! program took, in bytes a texel: OEM 28.4, box filter table 47, cells of one texel 161
//! for one reconstruction and 246 for both.

use crate::geometry::source_texels::{cells_across, most_runs};
use crate::light::environment::Layout;
use crate::light::oem::{OemSize, bilinear_share};
use crate::light::sat::Scan;
use crate::lobe::Lobe;
use crate::lobe::filter::Filter;
use crate::pyramid::{Levels, sharp};

/// Memory limit of a bake, a query or the viewer's tables: 4 GiB; 3 GiB in WebAssembly, whose addresses end
/// at 4 GiB.
pub const LIMIT: u64 = if cfg!(target_arch = "wasm32") { 3 << 30 } else { 4 << 30 };

/// Bytes of a source texel.
pub(crate) const SOURCE: u64 = 12;
/// Bytes of an OEM texel during construction: mean radiance, the texel, and a quarter of a solid angle.
const OEM_MAKING: u64 = 12 + 16 + 1;
/// Bytes of an OEM texel.
const OEM: u64 = 16;
/// Bytes of an exact SAT entry.
const TABLE: u64 = 32;
/// Bytes of a leaf cell: its share of all quads, and its energy.
const CELL: u64 = 75 + 12;
/// Bytes of a leaf cell during construction: the cell and its share of the next level.
const CELL_MAKING: u64 = 70;
/// Bytes of a run of the source's texels, and of the list that it is sorted from.
const RUN: u64 = 12 + 16;
/// Bytes of a pyramid for a texel of its map: three maps of that size, three of half of it, and of a quarter.
const PYRAMID: u64 = 3 * (16 + 4 + 1);
/// A lobe to evaluate.
#[derive(Clone, Copy, Debug)]
pub struct LobeRequest {
    /// Its family.
    pub lobe: Lobe,
    /// Perceptual roughness.
    pub roughness: f64,
    /// How it is evaluated.
    pub filter: Filter,
}

/// Bytes of an OEM and its tables.
pub(crate) struct Tables {
    /// Peak during construction of the OEM.
    pub(crate) making: u64,
    /// After construction of all tables.
    pub(crate) resident: u64,
}

impl Tables {
    /// Bytes of the tables over a source of `layout`.
    pub(crate) fn new(layout: Layout, size: OemSize, block: u32, scan: Scan, served: &[LobeRequest]) -> Self {
        let square = |side: u32| u64::from(side) * u64::from(side);
        let (inner, bordered) = (square(size.inner), square(size.bordered()));
        let border = if size.border > 0 { OEM * bordered } else { 0 };
        let (mut bilinear, mut source, mut boxes, mut pyramid) = (false, false, false, false);
        for &LobeRequest { lobe, roughness, filter } in served {
            match filter {
                Filter::Adaptive(_) if lobe.has_mirror() && roughness == 0.0 => {}
                Filter::Adaptive(_) => {
                    let share = bilinear_share(lobe, roughness * roughness, size.inner);
                    bilinear |= share > 0.0;
                    source |= share < 1.0;
                }
                Filter::Pyramid => pyramid = true,
                Filter::Box => boxes = true,
                Filter::Reference => {}
            }
        }
        let width = size.inner.div_ceil(block.max(1));
        let own_cells = if bilinear { square(width) } else { 0 };
        let width = cells_across(layout, width);
        let source_cells = if source { square(width) } else { 0 };
        let runs = if source { most_runs(layout, width) } else { 0 };
        // Recursive doubling alternates between the table and a copy.
        let copied = matches!(scan, Scan::Hensley { .. }) && boxes;
        let resident = OEM * bordered
            + if copied { TABLE * bordered } else { 0 }
            + CELL * (own_cells + source_cells)
            + CELL_MAKING * own_cells.max(source_cells)
            + runs * RUN
            + if boxes { TABLE * bordered } else { 0 }
            + if pyramid { PYRAMID * inner + sharp::bytes(size.inner) } else { 0 };
        Self { making: OEM_MAKING * inner + border, resident }
    }

    pub(crate) fn peak(&self) -> u64 {
        self.making.max(self.resident)
    }
}

/// Largest number from `least` to `most` that fits, by bisection; rounded down to a multiple of 64 from 64
/// up.
pub(crate) fn largest_that(least: u32, most: u32, fits: impl Fn(u32) -> bool) -> Option<u32> {
    if !fits(least) {
        return None;
    }
    let (mut low, mut high) = (least, most);
    while low < high {
        let middle = low + (high - low).div_ceil(2);
        if fits(middle) { low = middle } else { high = middle - 1 }
    }
    Some(if low >= 64 { low / 64 * 64 } else { low })
}

/// Largest OEM that fits; a power of two for a pyramid.
pub(crate) fn largest_oem(pyramid: bool, fits: impl Fn(u32) -> bool) -> Option<u32> {
    if pyramid {
        return Levels::sizes().rev().find(|size| fits(*size));
    }
    largest_that(1, 16_384, fits)
}

pub(crate) fn at_most(option: &str, size: Option<u32>) -> String {
    size.map_or_else(
        || "scale the source down first".to_owned(),
        |size| format!("{option} {size} is the largest that fits"),
    )
}
