//! Decodes blocks of an OpenEXR file.

use super::select::{Channels, Selection};
use super::window::{Window, exr_error};
use crate::common::error::Result;
use crate::common::parallel;
use crate::files::io::panics::catching_panics;
use crate::files::io::picture::{Source, TEXEL_BYTES, limit};
use crate::light::environment::Rgb;
use ::exr::block::UncompressedBlock;
use ::exr::block::chunk::{Chunk, CompressedBlock};
use ::exr::block::reader::ChunksReader as _;
use ::exr::meta::MetaData;
use ::exr::meta::attribute::{Compression, SampleType};
use ::exr::meta::header::Header;
use half::f16;
use half::slice::HalfFloatSliceExt as _;
use std::collections::HashSet;
use std::io::Cursor;

/// Memory of a block during decoding, as a multiple of its size: compressed, planar and interleaved copies.
const BLOCK_COPIES: u64 = 6;

/// Memory limit of all blocks in flight, in bytes; one block may exceed it.
const IN_FLIGHT_BYTES: u64 = 256 << 20;

/// Smaller layers are decoded on the calling thread; starting others would take longer.
const PARALLEL_BYTES: usize = 1 << 20;

/// Number of blocks to decode in parallel: enough for every thread, few enough to be small relative to the
/// texels.
fn batch_size(header: &Header) -> u64 {
    let block = BLOCK_COPIES.saturating_mul(header.max_block_byte_size() as u64).max(1);
    (IN_FLIGHT_BYTES / block).clamp(1, 4 * rayon::current_num_threads() as u64)
}

/// Rejects a file that is too short for its blocks, before texels are allocated, and one whose blocks and
/// texels exceed the memory limit.
fn check_blocks(source: &Source<'_>, header: &Header, window: &Window) -> Result<()> {
    // Offset table entry; block coordinate and length; one byte of data.
    const MIN_BLOCK: u64 = 8 + 8 + 1;
    let (width, height) = (header.layer_size.x() as u64, header.layer_size.y() as u64);
    let block = header.max_block_pixel_size();
    let across = |side: u64, block: usize| side.div_ceil((block as u64).max(1));
    let count = across(width, block.x()).saturating_mul(across(height, block.y()));
    // Maximum compression ratio; 0 if unlimited.
    let most = match header.compression {
        Compression::Uncompressed => 1,
        // Two bytes for a run of 128.
        Compression::RLE => 64,
        // Two bits for a match of 258 bytes; of a float in PXR24 three bytes are kept.
        Compression::ZIP1 | Compression::ZIP16 => 1032,
        Compression::PXR24 => 1376,
        _ => 0,
    };
    let samples = width.saturating_mul(height).saturating_mul(header.channels.bytes_per_pixel as u64);
    let least = count.saturating_mul(MIN_BLOCK).max(samples.checked_div(most).unwrap_or(0));
    if least > source.bytes.len() as u64 {
        return Err(source.error(format!(
            "truncated: its {count} blocks take at least {least} bytes and the file has {}; copy it again",
            source.bytes.len()
        )));
    }
    let texels = u64::from(window.width) * u64::from(window.height) * TEXEL_BYTES;
    let blocks = (batch_size(header) * BLOCK_COPIES).saturating_mul(header.max_block_byte_size() as u64);
    let needed = texels.saturating_add(blocks).saturating_add(source.bytes.len() as u64);
    if needed > source.memory_limit {
        let what = format!("blocks for {}x{} pixels", window.data_width, window.data_height);
        return Err(limit(source.path, &what, needed, source.memory_limit));
    }
    Ok(())
}

/// Decodes the selected channels of the largest level, in rows of the display window.
pub(super) fn decode(
    source: &Source<'_>,
    metadata: &MetaData,
    selection: &Selection,
    window: &Window,
) -> Result<Vec<Rgb>> {
    let as_ours = |error| exr_error(source, &error);
    let header = &metadata.headers[selection.header];
    source.check_memory(window.width, window.height, TEXEL_BYTES)?;
    check_blocks(source, header, window)?;
    let count = window.width as usize * window.height as usize;
    let mut texels = Vec::new();
    texels
        .try_reserve_exact(count)
        .map_err(|_| source.error("not enough memory for its texels; scale it down first"))?;
    texels.resize(count, Rgb::default());
    let mut chunks = ::exr::block::read(Cursor::new(source.bytes), false)
        .map_err(as_ours)?
        .filter_chunks(false, |_, tile, block| {
            block.layer == selection.header && tile.is_largest_resolution_level()
        })
        .map_err(as_ours)?;
    let expected = chunks.expected_chunk_count();
    let decompress = |chunk: Chunk| {
        catching_panics(source.path, || {
            check_dwa_counters(source, header, &chunk)?;
            UncompressedBlock::decompress_chunk(chunk, metadata, false).map_err(as_ours)
        })
    };
    // Offset tables may reference a block twice: the expected number of distinct positions covers the image.
    let mut positions = HashSet::with_capacity(expected.min(source.bytes.len() / 8));
    let mut row = RowBuffer::default();
    let serial = header.layer_size.area() * header.channels.bytes_per_pixel < PARALLEL_BYTES;
    let batch_size = usize::try_from(batch_size(header)).unwrap_or(1);
    loop {
        let batch: Vec<Chunk> =
            chunks.by_ref().take(batch_size).collect::<::exr::error::Result<_>>().map_err(as_ours)?;
        if batch.is_empty() {
            break;
        }
        let blocks: Vec<Result<UncompressedBlock>> = if serial {
            batch.into_iter().map(decompress).collect()
        } else {
            parallel::map(batch, decompress)
        };
        for block in blocks {
            let block = block?;
            let is_selected =
                block.index.layer == selection.header && block.index.level.x() + block.index.level.y() == 0;
            let position = block.index.pixel_position;
            if !is_selected || !positions.insert((position.x(), position.y())) {
                return Err(
                    source.error("corrupt: its offset table references wrong blocks; re-export the file")
                );
            }
            row.fill(header, selection.channels, window, &block, &mut texels)
                .ok_or_else(|| source.error("corrupt: a block has the wrong size; re-export the file"))?;
        }
    }
    Ok(texels)
}

/// DWA blocks start with eleven 64-bit counters of their inflated sizes; the decoder allocates these
/// unchecked.
fn check_dwa_counters(source: &Source<'_>, header: &Header, chunk: &Chunk) -> Result<()> {
    if !matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_)) {
        return Ok(());
    }
    let bytes = match &chunk.compressed_block {
        CompressedBlock::ScanLine(block) => &block.compressed_pixels_le,
        CompressedBlock::Tile(block) => &block.compressed_pixels_le,
        _ => return Ok(()),
    };
    // Sides are padded to 8; 32-bit samples and an incompressible run-length pass at most double a half's
    // bytes each.
    let block = header.max_block_pixel_size();
    let padded = |side: usize| (side as u64).div_ceil(8) * 8;
    let greatest = 8 * padded(block.x()) * padded(block.y()) * header.channels.list.len() as u64;
    let inflated_counters = [1, 6, 7, 8, 9];
    let counters = bytes.as_chunks::<8>().0;
    let promises_too_much = inflated_counters
        .iter()
        .any(|&at| counters.get(at).is_some_and(|c| u64::from_le_bytes(*c) > greatest));
    // Incompressible blocks are stored raw and have no counters.
    if promises_too_much && !is_whole_block(header, chunk, bytes.len()) {
        return Err(source.error("corrupt: the counters of a DWA block exceed its size; re-export the file"));
    }
    Ok(())
}

/// Whether the samples of `chunk`'s block take exactly `length` bytes.
fn is_whole_block(header: &Header, chunk: &Chunk, length: usize) -> bool {
    header
        .get_block_data_indices(&chunk.compressed_block)
        .and_then(|tile| header.get_absolute_block_pixel_coordinates(tile))
        .is_ok_and(|bounds| bounds.size.area() * header.channels.bytes_per_pixel == length)
}

/// Row buffers between a block and texels.
#[derive(Default)]
struct RowBuffer {
    halves: Vec<f16>,
    channels: [Vec<f32>; 3],
}

impl RowBuffer {
    /// Copies the visible part of `block` into `texels`; `None` if its size does not match its rows.
    fn fill(
        &mut self,
        header: &Header,
        channels: Channels,
        window: &Window,
        block: &UncompressedBlock,
        texels: &mut [Rgb],
    ) -> Option<()> {
        let list = &header.channels.list;
        let (width, height) = (block.index.pixel_size.x(), block.index.pixel_size.y());
        let row_bytes = width * header.channels.bytes_per_pixel;
        if block.data.len() != row_bytes * height {
            return None;
        }
        let Some(rows) = window.visible_rows() else { return Some(()) };
        let left = window.data_x + i64::try_from(block.index.pixel_position.x()).ok()?;
        let top = window.data_y + i64::try_from(block.index.pixel_position.y()).ok()?;
        let Some(columns) = super::window::overlap(left, width, window.width) else { return Some(()) };
        // The first visible column, in the block.
        let skipped = usize::try_from(columns.start as i64 - left).ok()?;
        for (line, bytes) in (top..).zip(block.data.chunks_exact(row_bytes)) {
            let Some(y) = usize::try_from(line).ok().filter(|y| rows.contains(y)) else { continue };
            for (channel, &index) in self.channels.iter_mut().zip(channels.indices()) {
                let before: usize = list[..index].iter().map(|c| c.sample_type.bytes_per_sample()).sum();
                let sample_type = list[index].sample_type;
                let samples = &bytes[before * width..][..sample_type.bytes_per_sample() * width];
                floats_from(sample_type, samples, &mut self.halves, channel);
            }
            let target = &mut texels[y * window.width as usize..][columns.clone()];
            let [red, green, blue] = &self.channels;
            if let Channels::Luminance(_) = channels {
                target.iter_mut().zip(&red[skipped..]).for_each(|(texel, value)| *texel = [*value; 3]);
            } else {
                let colors = red[skipped..].iter().zip(&green[skipped..]).zip(&blue[skipped..]);
                target.iter_mut().zip(colors).for_each(|(texel, ((r, g), b))| *texel = [*r, *g, *b]);
            }
        }
        Some(())
    }
}

/// Native-endian samples to floats.
fn floats_from(sample_type: SampleType, bytes: &[u8], halves: &mut Vec<f16>, floats: &mut Vec<f32>) {
    floats.clear();
    match sample_type {
        SampleType::F16 => {
            halves.clear();
            halves.extend(bytes.as_chunks::<2>().0.iter().map(|pair| f16::from_ne_bytes(*pair)));
            floats.resize(halves.len(), 0.0);
            halves.convert_to_f32_slice(floats);
        }
        SampleType::F32 => {
            floats.extend(bytes.as_chunks::<4>().0.iter().map(|four| f32::from_ne_bytes(*four)))
        }
        SampleType::U32 => {
            floats.extend(bytes.as_chunks::<4>().0.iter().map(|four| u32::from_ne_bytes(*four) as f32));
        }
    }
}
