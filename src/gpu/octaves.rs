//! Layout of the blurred tables of all octaves in shared buffers.

use crate::cpu::blur::grids;
use crate::cpu::fitted::finest_octave;

/// Texels along an edge of a tile of the grid to blur.
pub const EDGE: u32 = 16;

/// Greatest number of octaves.
pub const OCTAVES: usize = 7;

/// Texels of border around a blurred square. Over all directions, less than one box in a hundred leaves it:
/// wide boxes with a small share of their lobe. These use the parity form of the unfolded plane.
pub const BORDER: u32 = 40;

/// Position of one octave's table in the shared buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Octave {
    fine: u32,
    box_side: u32,
    /// Texels along an edge of the square.
    pub coarse: u32,
    /// Entries along an edge, with the border and a first row and column of zeros.
    pub side: u32,
    first_texel: u32,
    /// First entry in the buffer.
    pub first_entry: u32,
    first_tile: u32,
    first_row: u32,
}

/// The tables of all octaves over one size of OEM.
#[derive(Clone, Copy, Debug)]
pub struct OctaveLayout {
    /// Octaves up to `finest`.
    pub octaves: [Octave; OCTAVES],
    /// The finest octave.
    pub finest: u32,
    /// Texels of all.
    pub texels: u32,
    /// Entries of all, rounded up so that what follows begins at a multiple of 256 bytes, as bindings do.
    pub entries: u32,
    /// Tiles of all.
    pub tiles: u32,
    /// Rows of all.
    pub rows: u32,
}

impl OctaveLayout {
    /// The layout over an OEM of `inner` texels, a power of two and at least 16.
    #[must_use]
    pub fn new(inner: u32) -> Self {
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
        all.entries = all.entries.next_multiple_of(8);
        all
    }
}
