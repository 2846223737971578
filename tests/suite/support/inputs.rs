//! Generated image files, for the readers' tests and the fuzzer.

use exr::image::write::layers::WritableLayers;
use exr::prelude::*;
use std::io::Cursor;

/// Linear RGB.
pub(crate) type Rgb = [f32; 3];

/// A picture of distinct texels with small integers, exact in half, RGBE and RGB9E5.
pub(crate) fn numbered(width: u32, height: u32) -> Vec<Rgb> {
    (0..width * height)
        .map(|at| {
            let (x, y) = ((at % width) as f32, (at / width) as f32);
            [x + 1.0, y + 1.0, 200.0]
        })
        .collect()
}

/// A Radiance picture without run lengths: the signature, `lines`, `resolution`, then the pixels as given.
pub(crate) fn radiance(lines: &str, resolution: &str, pixels: &[Rgb]) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\n{lines}\n{resolution}\n").into_bytes();
    for rgb in pixels {
        let greatest = rgb.iter().fold(0.0f32, |a, b| a.max(*b));
        let exponent = if greatest > 0.0 { greatest.log2().floor() as i32 + 1 } else { -128 };
        let scale = 2f32.powi(8 - exponent);
        bytes.extend(rgb.map(|channel| (channel * scale) as u8));
        bytes.push(u8::try_from(exponent + 128).unwrap());
    }
    bytes
}

/// A Radiance picture as the `image` crate writes it, run lengths included.
pub(crate) fn radiance_with_runs(width: u32, height: u32, pixels: &[Rgb]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let pixels: Vec<image::Rgb<f32>> = pixels.iter().map(|rgb| image::Rgb(*rgb)).collect();
    image::codecs::hdr::HdrEncoder::new(&mut bytes).encode(&pixels, width as usize, height as usize).unwrap();
    bytes
}

/// Sample type of an OpenEXR channel.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Sample {
    Half,
    Float,
    Uint,
}

/// `values` as samples of `kind`.
pub(crate) fn samples(kind: Sample, values: impl Iterator<Item = f32>) -> FlatSamples {
    match kind {
        Sample::Half => FlatSamples::F16(values.map(f16::from_f32).collect()),
        Sample::Float => FlatSamples::F32(values.collect()),
        Sample::Uint => FlatSamples::U32(values.map(|value| value as u32).collect()),
    }
}

/// The channels `{prefix}R`, `{prefix}G`, `{prefix}B`.
pub(crate) fn rgb_channels(prefix: &str, kind: Sample, pixels: &[Rgb]) -> Vec<AnyChannel<FlatSamples>> {
    (0..3)
        .map(|c| {
            let name = format!("{prefix}{}", ["R", "G", "B"][c]);
            AnyChannel::new(name.as_str(), samples(kind, pixels.iter().map(|rgb| rgb[c])))
        })
        .collect()
}

/// One part of an OpenEXR file.
pub(crate) fn layer(
    size: (u32, u32),
    compression: Compression,
    blocks: Blocks,
    channels: Vec<AnyChannel<FlatSamples>>,
) -> Layer<AnyChannels<FlatSamples>> {
    let line_order = if blocks == Blocks::ScanLines { LineOrder::Increasing } else { LineOrder::Unspecified };
    Layer::new(
        (size.0 as usize, size.1 as usize),
        LayerAttributes::default(),
        Encoding { compression, blocks, line_order },
        AnyChannels::sort(channels.into_iter().collect()),
    )
}

/// The file of `image`.
pub(crate) fn exr_bytes<L>(image: &Image<L>) -> Vec<u8>
where
    for<'a> L: WritableLayers<'a>,
{
    let mut bytes = Vec::new();
    image.write().non_parallel().to_buffered(Cursor::new(&mut bytes)).unwrap();
    bytes
}

/// A plain OpenEXR file.
pub(crate) fn exr_rgb(size: (u32, u32), kind: Sample, compression: Compression, pixels: &[Rgb]) -> Vec<u8> {
    exr_bytes(&Image::from_layer(layer(size, compression, Blocks::ScanLines, rgb_channels("", kind, pixels))))
}

/// A tiled, mip-mapped OpenEXR file: `pixels` at level 0, zeros below.
pub(crate) fn exr_mip_mapped(size: (u32, u32), tile: usize, pixels: &[Rgb]) -> Vec<u8> {
    let level_count = size.0.max(size.1).ilog2() + 1;
    let channels = (0..3).map(|c| {
        let levels = (0..level_count)
            .map(|level| {
                let (width, height) = ((size.0 >> level).max(1), (size.1 >> level).max(1));
                let values =
                    (0..width * height).map(|at| if level == 0 { pixels[at as usize][c] } else { 0.0 });
                samples(Sample::Half, values)
            })
            .collect();
        let levels = Levels::Mip { rounding_mode: exr::math::RoundingMode::Down, level_data: levels };
        AnyChannel::new(["R", "G", "B"][c], levels)
    });
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::Tiles(Vec2(tile, tile)),
        line_order: LineOrder::Unspecified,
    };
    exr_bytes(&Image::from_layer(Layer::new(
        (size.0 as usize, size.1 as usize),
        LayerAttributes::default(),
        encoding,
        AnyChannels::sort(channels.collect()),
    )))
}

/// Pixels of a KTX2 file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ktx2Pixel {
    Rgba16F,
    Rgba32F,
    Rgb9E5,
}

/// A KTX2 file: its levels' texels (all faces of each), key/value pairs, zstd or plain. Minimal, and
/// independent of the program's writer.
pub(crate) fn ktx2(
    size: (u32, u32),
    faces: u32,
    pixel: Ktx2Pixel,
    zstd: bool,
    pairs: &[(&str, &[u8])],
    levels: &[Vec<Rgb>],
) -> Vec<u8> {
    let encode = |rgb: &Rgb| -> Vec<u8> {
        let rgba = [rgb[0], rgb[1], rgb[2], 1.0];
        match pixel {
            Ktx2Pixel::Rgba16F => rgba.iter().flat_map(|v| f16::from_f32(*v).to_le_bytes()).collect(),
            Ktx2Pixel::Rgba32F => rgba.iter().flat_map(|v| v.to_le_bytes()).collect(),
            // One exponent for all: mantissas in units of 1/2, so e - 15 - 9 = -1.
            Ktx2Pixel::Rgb9E5 => {
                let m = rgb.map(|v| (v * 2.0) as u32);
                (m[0] | m[1] << 9 | m[2] << 18 | 23 << 27).to_le_bytes().to_vec()
            }
        }
    };
    let raw: Vec<Vec<u8>> = levels.iter().map(|level| level.iter().flat_map(encode).collect()).collect();
    let stored: Vec<Vec<u8>> = if zstd {
        raw.iter().map(|level| zstd::bulk::compress(level, 3).unwrap()).collect()
    } else {
        raw.clone()
    };
    let mut key_values = Vec::new();
    for (key, value) in pairs {
        let length = u32::try_from(key.len() + 1 + value.len()).unwrap();
        key_values.extend(length.to_le_bytes());
        key_values.extend(key.as_bytes());
        key_values.push(0);
        key_values.extend(*value);
        key_values.resize(key_values.len().next_multiple_of(4), 0);
    }
    let (format, type_size) = match pixel {
        Ktx2Pixel::Rgba16F => (::ktx2::Format::R16G16B16A16_SFLOAT, 2),
        Ktx2Pixel::Rgba32F => (::ktx2::Format::R32G32B32A32_SFLOAT, 4),
        Ktx2Pixel::Rgb9E5 => (::ktx2::Format::E5B9G9R9_UFLOAT_PACK32, 4),
    };
    let level_count = u32::try_from(levels.len()).unwrap();
    let index_end = 80 + 24 * level_count;
    // A descriptor without blocks: only its length.
    let descriptor = 4u32.to_le_bytes();
    let header = ::ktx2::Header {
        format: Some(format),
        type_size,
        pixel_width: size.0,
        pixel_height: size.1,
        pixel_depth: 0,
        layer_count: 0,
        face_count: faces,
        level_count,
        supercompression_scheme: zstd.then_some(::ktx2::SupercompressionScheme::Zstandard),
        index: ::ktx2::Index {
            dfd_byte_offset: index_end,
            dfd_byte_length: 4,
            kvd_byte_offset: index_end + 4,
            kvd_byte_length: u32::try_from(key_values.len()).unwrap(),
            sgd_byte_offset: 0,
            sgd_byte_length: 0,
        },
    };
    let mut bytes = header.as_bytes().to_vec();
    let mut offset = u64::from(index_end) + 4 + key_values.len() as u64;
    for (stored, raw) in stored.iter().zip(&raw) {
        let index = ::ktx2::LevelIndex {
            byte_offset: offset,
            byte_length: stored.len() as u64,
            uncompressed_byte_length: raw.len() as u64,
        };
        bytes.extend(index.as_bytes());
        offset += stored.len() as u64;
    }
    bytes.extend(descriptor);
    bytes.extend(key_values);
    stored.iter().for_each(|level| bytes.extend(level));
    bytes
}

/// A PNG or JPEG of 8-bit values.
pub(crate) fn ldr(width: u32, height: u32, format: image::ImageFormat, pixels: &[[u8; 3]]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let image = image::RgbImage::from_raw(width, height, pixels.as_flattened().to_vec()).unwrap();
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// A 16-bit PNG with alpha.
pub(crate) fn deep_png(width: u32, height: u32, pixels: &[[u16; 4]]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let image =
        image::ImageBuffer::<image::Rgba<u16>, _>::from_raw(width, height, pixels.as_flattened().to_vec());
    image.unwrap().write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A NumPy array file of version 1, of the numbers in `data`.
pub(crate) fn npy(descr: &str, fortran_order: bool, (rows, columns): (usize, usize), data: &[u8]) -> Vec<u8> {
    let order = if fortran_order { "True" } else { "False" };
    let header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({rows}, {columns}), }}");
    // NumPy pads the header with spaces and ends it with a line feed.
    let header = format!("{header:117}\n");
    let length = u16::try_from(header.len()).expect("a short header");
    [&b"\x93NUMPY\x01\x00"[..], &length.to_le_bytes(), header.as_bytes(), data].concat()
}
