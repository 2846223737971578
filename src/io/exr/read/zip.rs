//! Fast path for scan lines in ZIP blocks, the most common case: decodes the file's bytes directly to texels.
//!
//! The general path copies a block five times and inflates it more slowly. It handles all unusual files and
//! reports all errors.

use super::super::deflate::Inflater;
use super::blocks::PARALLEL_BYTES;
use super::select::Selection;
use super::window::Window;
use crate::environment::Rgb;
use crate::io::source::Source;
use ::exr::meta::attribute::{Compression, SampleType};
use ::exr::meta::header::Header;
use ::exr::meta::{BlockDescription, MetaData};
use half::f16;
use half::slice::{HalfBitsSliceExt as _, HalfFloatSliceExt as _};
use rayon::prelude::*;
use std::io::Cursor;
use std::ops::Range;

/// Decodes the selected channels into `texels`; `None` for a file of another kind or a corrupt one.
pub(super) fn decode_into(
    source: &Source<'_>,
    metadata: &MetaData,
    selection: &Selection,
    window: &Window,
    texels: &mut [Rgb],
) -> Option<()> {
    let blocks = Blocks::of(source.bytes, metadata, selection, window)?;
    let texels_per_block = blocks.lines * blocks.width;
    let serial = texels.len() * blocks.bytes_per_pixel < PARALLEL_BYTES;
    let decode = |scratch: &mut Scratch, (k, texels): (usize, &mut [Rgb])| blocks.decode(k, scratch, texels);
    if serial {
        let mut scratch = Scratch::default();
        texels.chunks_mut(texels_per_block).enumerate().try_for_each(|block| decode(&mut scratch, block))
    } else {
        let jobs = texels.par_chunks_mut(texels_per_block).enumerate();
        jobs.with_min_len(8).try_for_each_init(Scratch::default, decode)
    }
}

/// The blocks of a file, top to bottom.
struct Blocks<'a> {
    bytes: &'a [u8],
    /// Offset of each block, in the file's byte order.
    offsets: &'a [[u8; 8]],
    top: i32,
    width: usize,
    /// Lines per block.
    lines: usize,
    bytes_per_pixel: usize,
    /// Red, green and blue, or one for all three.
    channels: Vec<Channel>,
}

/// A channel's samples and their offset in a pixel's bytes.
struct Channel {
    before: usize,
    sample_type: SampleType,
}

/// Buffers of a thread.
struct Scratch {
    inflater: Inflater,
    inflated: Vec<u8>,
    /// A block's samples; every sample is an even number of bytes.
    words: Vec<u16>,
    floats: [Vec<f32>; 3],
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            inflater: Inflater::new(),
            inflated: Vec::new(),
            words: Vec::new(),
            floats: Default::default(),
        }
    }
}

impl<'a> Blocks<'a> {
    fn of(bytes: &'a [u8], metadata: &MetaData, selection: &Selection, window: &Window) -> Option<Self> {
        let [header] = metadata.headers.as_slice() else { return None };
        let lines = match header.compression {
            Compression::ZIP1 => 1,
            Compression::ZIP16 => 16,
            _ => return None,
        };
        let (width, height) = (window.width as usize, window.height as usize);
        let plain = header.blocks == BlockDescription::ScanLines
            && !header.deep
            && !metadata.requirements.has_multiple_layers
            && (window.data_x, window.data_y) == (0, 0)
            && (window.data_width, window.data_height) == (width, height);
        if !plain {
            return None;
        }
        // The table follows the headers.
        let mut cursor = Cursor::new(bytes);
        MetaData::read_from_buffered(&mut cursor, false).ok()?;
        let table = bytes.get(usize::try_from(cursor.position()).ok()?..)?;
        let offsets = table.as_chunks::<8>().0.get(..height.div_ceil(lines))?;
        let channels = selection.channels.indices().iter().map(|&index| Channel::of(header, index));
        Some(Self {
            bytes,
            offsets,
            top: header.own_attributes.layer_position.y(),
            width,
            lines,
            bytes_per_pixel: header.channels.bytes_per_pixel,
            channels: channels.collect::<Option<_>>()?,
        })
    }

    /// Compressed bytes of block `k`.
    fn compressed(&self, k: usize) -> Option<&'a [u8]> {
        let block = self.bytes.get(usize::try_from(u64::from_le_bytes(self.offsets[k])).ok()?..)?;
        let (line, block) = block.split_first_chunk()?;
        let (length, block) = block.split_first_chunk()?;
        let expected = self.top.checked_add(i32::try_from(k * self.lines).ok()?)?;
        (i32::from_le_bytes(*line) == expected).then_some(())?;
        block.get(..usize::try_from(i32::from_le_bytes(*length)).ok()?)
    }

    /// Decodes block `k` into its texels.
    fn decode(&self, k: usize, scratch: &mut Scratch, texels: &mut [Rgb]) -> Option<()> {
        let Scratch { inflater, inflated, words, floats } = scratch;
        words.resize(texels.len() * self.bytes_per_pixel / 2, 0);
        unpack(self.compressed(k)?, inflater, inflated, words)?;
        for (line, texels) in texels.chunks_mut(self.width).enumerate() {
            for (channel, floats) in self.channels.iter().zip(&mut *floats) {
                channel.floats_from(&words[channel.words(line, self.width, self.bytes_per_pixel)], floats);
            }
            let [red, green, blue] = &*floats;
            if self.channels.len() == 1 {
                texels.iter_mut().zip(red).for_each(|(texel, value)| *texel = [*value; 3]);
            } else {
                let colors = red.iter().zip(green).zip(blue);
                texels.iter_mut().zip(colors).for_each(|(texel, ((r, g), b))| *texel = [*r, *g, *b]);
            }
        }
        Some(())
    }
}

impl Channel {
    fn of(header: &Header, index: usize) -> Option<Self> {
        let list = &header.channels.list;
        let bytes = |sample_type: SampleType| sample_type.bytes_per_sample();
        let sample_type = list[index].sample_type;
        let plain = list.iter().all(|channel| (channel.sampling.x(), channel.sampling.y()) == (1, 1));
        (plain && sample_type != SampleType::U32).then(|| Self {
            before: list[..index].iter().map(|channel| bytes(channel.sample_type)).sum(),
            sample_type,
        })
    }

    /// Range of its 16-bit words of one line within the block.
    fn words(&self, line: usize, width: usize, bytes_per_pixel: usize) -> Range<usize> {
        let start = width * (line * bytes_per_pixel + self.before) / 2;
        start..start + width * self.sample_type.bytes_per_sample() / 2
    }

    fn floats_from(&self, words: &[u16], floats: &mut Vec<f32>) {
        if self.sample_type == SampleType::F16 {
            floats.resize(words.len(), 0.0);
            words.reinterpret_cast::<f16>().convert_to_f32_slice(floats);
        } else {
            let float = |[low, high]: &[u16; 2]| f32::from_bits(u32::from(*low) | u32::from(*high) << 16);
            floats.clear();
            floats.extend(words.as_chunks().0.iter().map(float));
        }
    }
}

/// Decompresses a block; the length of `words` is the expected length.
fn unpack(
    compressed: &[u8],
    inflater: &mut Inflater,
    inflated: &mut Vec<u8>,
    words: &mut [u16],
) -> Option<()> {
    if compressed.len() == 2 * words.len() {
        // Incompressible blocks are stored raw.
        let pairs = compressed.as_chunks().0;
        words.iter_mut().zip(pairs).for_each(|(word, pair)| *word = u16::from_le_bytes(*pair));
        return Some(());
    }
    inflated.resize(2 * words.len(), 0);
    let length = inflater.inflate(compressed, inflated)?;
    (length == inflated.len()).then_some(())?;
    // Even bytes come first, then odd ones, each delta-encoded with an offset of 128. Both halves are decoded
    // together to overlap the dependent sums.
    let (even, odd) = inflated.split_at(words.len());
    let add = |sum: u8, byte: &u8| sum.wrapping_add(byte.wrapping_sub(128));
    let (mut low, mut high) = (128, even.iter().fold(128, add));
    for (word, (even, odd)) in words.iter_mut().zip(even.iter().zip(odd)) {
        (low, high) = (add(low, even), add(high, odd));
        *word = u16::from_le_bytes([low, high]);
    }
    Some(())
}
