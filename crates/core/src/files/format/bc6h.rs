//! BC6H: blocks of 4 x 4 texels in 16 bytes, encoded by the `block_compression` crate, decoded by `bcdec_rs`.

use super::HALF_MAX;
use crate::common::parallel;
use crate::light::environment::Rgb;
use block_compression::{BC6HSettings, CompressionVariant, encode::compress_rgba16};
use half::f16;

/// Texels along an edge of a block.
pub(crate) const BLOCK: usize = 4;

/// Decodes an image of `width` x `height` from `blocks`, `signed` or not, to row-major texels.
pub(crate) fn rgb_from_bc6h(width: u32, height: u32, signed: bool, blocks: &[u8]) -> Vec<Rgb> {
    let (columns, rows) = (width as usize, height as usize);
    let across = columns.div_ceil(BLOCK);
    let mut texels = vec![[0.0; 3]; columns * rows];
    for (index, block) in blocks.chunks_exact(16).enumerate() {
        let mut rgb = [0.0_f32; 3 * BLOCK * BLOCK];
        bcdec_rs::bc6h_float(block, &mut rgb, 3 * BLOCK, signed);
        let (left, top) = (index % across * BLOCK, index / across * BLOCK);
        for (row, line) in rgb.chunks_exact(3 * BLOCK).enumerate().take(rows.saturating_sub(top).min(BLOCK)) {
            let shown = (columns - left).min(BLOCK);
            let at = (top + row) * columns + left;
            for (texel, rgb) in texels[at..at + shown].iter_mut().zip(line.as_chunks::<3>().0) {
                *texel = *rgb;
            }
        }
    }
    texels
}

/// Encodes `texels.len() / size^2` consecutive squares of `size` x `size` texels.
///
/// If `size` is not a multiple of four, the last column and row are repeated. Values are clamped to [0,
/// [`HALF_MAX`]].
pub fn bc6h_blocks(size: u32, texels: &[Rgb]) -> Vec<u8> {
    let n = size as usize;
    let across = n.div_ceil(BLOCK);
    let padded = across * BLOCK;
    // On baked levels the slow settings gain less than 0.1 dB at five times the cost; the fast one loses up
    // to 1.3 dB.
    let variant = CompressionVariant::BC6H(BC6HSettings::basic());
    // Strips of blocks are independent.
    let strips = texels.chunks_exact(n * n).flat_map(|square| (0..across).map(move |strip| (square, strip)));
    let blocks = parallel::map(strips, |(square, strip)| {
        let mut halves = Vec::with_capacity(BLOCK * padded * 4);
        for row in strip * BLOCK..(strip + 1) * BLOCK {
            let row = &square[row.min(n - 1) * n..][..n];
            for column in 0..padded {
                let texel = row[column.min(n - 1)].map(|c| f16::from_f32(c.clamp(0.0, HALF_MAX)));
                halves.extend(texel);
                halves.push(f16::ONE);
            }
        }
        let mut blocks = vec![0; across * 16];
        let width = padded as u32;
        compress_rgba16(variant, &halves, &mut blocks, width, BLOCK as u32, width * 4);
        blocks
    });
    blocks.concat()
}
