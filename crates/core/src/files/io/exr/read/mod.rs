//! Reads OpenEXR files with every compression that the `exr` crate supports. Only the blocks of one layer's
//! largest level are decoded, directly into texels.

mod blocks;
mod select;
mod window;

use crate::common::error::Result;
use crate::files::format::LevelName;
use crate::files::io::LoadedChain;
use crate::files::io::color::{self, Primaries};
use crate::files::io::key_values::value_of;
use crate::files::io::map_header::{BORDER_KEY, MapHeader};
use crate::files::io::picture::{LevelHeader, Picture, Source, TEXEL_BYTES};
use crate::light::chain::{Chain, Level};
use crate::light::environment::Rgb;
use crate::sphere::cube::Face;
use ::exr::meta::attribute::{AttributeValue, Compression, SampleType, Text};
use ::exr::meta::header::Header;
use ::exr::meta::{BlockDescription, MetaData};
use select::{Channels, Selection};
use std::io::Cursor;
use window::{Window, exr_error};

/// Decodes the display window of an OpenEXR file.
pub(in crate::files::io) fn decode(source: &Source<'_>) -> Result<Picture> {
    // Bytes 4 to 8 are the version and its flags.
    let is_deep = source.bytes.get(5).is_some_and(|flags| flags & 0x08 != 0);
    if is_deep {
        return Err(source.error("deep data; flatten it to one sample a pixel"));
    }
    if let Some((width, height)) = data_window(source.bytes).filter(|(width, height)| width * height == 0) {
        return Err(source.error(format!("{width}x{height} has no pixels")));
    }
    let reader =
        ::exr::block::read(Cursor::new(source.bytes), false).map_err(|error| exr_error(source, &error))?;
    let metadata = reader.meta_data();
    if part_named(metadata, LevelName::face(0, Face::PosX)).is_some() {
        let (size, texels) = cube_of_parts(source, metadata, 0)?;
        return Ok(Picture {
            width: size,
            height: 6 * size,
            texels,
            is_cube: true,
            format: parts_format(metadata),
            provenance: source.provenance(&text_pairs(&metadata.headers[0]))?,
            ..Picture::default()
        });
    }
    let selection = select::select(source, &metadata.headers)?;
    let header = &metadata.headers[selection.header];
    let window = Window::new(source, header, header.shared_attributes.display_window)?;
    let mut texels = blocks::decode(source, metadata, &selection, &window)?;

    let mut warnings = Vec::new();
    // The other parts of a bake's octahedral map are its rougher levels.
    let pairs = text_pairs(header);
    let is_first_level = value_of(&pairs, BORDER_KEY).is_some();
    warnings.extend(selection.warning().filter(|_| !is_first_level));
    warnings.extend(window.warning());
    convert_color(header, selection.channels, &mut texels, &mut warnings);
    Ok(Picture {
        width: window.width,
        height: window.height,
        texels,
        map: MapHeader::of_pairs(source, &pairs)?,
        format: describe(header, &selection),
        warnings,
        provenance: source.provenance(&pairs)?,
        ..Picture::default()
    })
}

/// Decodes a cube chain with a part for each face of each level, as written by `bake --out-layout parts`.
pub(in crate::files::io) fn decode_chain(source: &Source<'_>) -> Result<LoadedChain> {
    let metadata = MetaData::read_from_buffered(Cursor::new(source.bytes), false)
        .map_err(|error| exr_error(source, &error))?;
    let mut levels = Vec::new();
    for level in 0u32..32 {
        let Some(first) = part_named(&metadata, LevelName::face(level, Face::PosX)) else { break };
        let (size, texels) = cube_of_parts(source, &metadata, level)?;
        let Some(roughness) = header_roughness(&metadata.headers[first]).filter(|r| (0.0..=1.0).contains(r))
        else {
            return Err(source.error(format!("its level {level} has no roughness; bake it again")));
        };
        crate::files::io::picture::check_finite(source.path, level, size, &texels)?;
        levels.push(Level::cube(size, roughness, texels));
    }
    if levels.is_empty() {
        return Err(source.error("no part m0_px; a chain in OpenEXR has a part for each face of each level"));
    }
    let halves = |(level, expected): (u32, &Level)| expected.size() == (levels[0].size() >> level).max(1);
    if !(0u32..).zip(&levels).all(halves) {
        return Err(source.error("the sizes of its levels do not halve; bake it again"));
    }
    Ok(LoadedChain {
        path: source.path.to_owned(),
        chain: Chain { levels },
        provenance: source.provenance(&text_pairs(&metadata.headers[0]))?,
        format: parts_format(&metadata),
        warnings: Vec::new(),
    })
}

/// Such as `OpenEXR, half, 54 parts`.
fn parts_format(metadata: &MetaData) -> String {
    let sample =
        metadata.headers[0].channels.list.first().map_or("", |channel| sample_name(channel.sample_type));
    format!("OpenEXR, {sample}, {} parts", metadata.headers.len())
}

fn part_named(metadata: &MetaData, name: LevelName) -> Option<usize> {
    let name = name.to_string();
    let is_called =
        |header: &Header| header.own_attributes.layer_name.as_ref().is_some_and(|own| *own == *name);
    metadata.headers.iter().position(is_called)
}

/// Size and texels of a level whose faces are parts.
fn cube_of_parts(source: &Source<'_>, metadata: &MetaData, level: u32) -> Result<(u32, Vec<Rgb>)> {
    let mut texels = Vec::new();
    let mut size = 0;
    for face in Face::ALL {
        let name = LevelName::face(level, face);
        let selected =
            part_named(metadata, name).and_then(|index| select::of_part(index, &metadata.headers[index]));
        let Some(selection) = selected else {
            return Err(source.error(format!("its part {name} is missing or not RGB; bake it again")));
        };
        let header = &metadata.headers[selection.header];
        let window = Window::new(source, header, header.data_window())?;
        if window.width != window.height || (face != Face::PosX && window.width != size) {
            return Err(source.error(format!(
                "its part {name} is {}x{}; faces are square and all of a size",
                window.width, window.height
            )));
        }
        size = window.width;
        source.check_memory(size, 6 * size, TEXEL_BYTES)?;
        texels.append(&mut blocks::decode(source, metadata, &selection, &window)?);
    }
    Ok((size, texels))
}

/// The names and values of the attributes that are texts.
fn text_pairs(header: &Header) -> Vec<(String, String)> {
    let pair = |(key, value): (&Text, &AttributeValue)| match value {
        AttributeValue::Text(text) => Some((key.to_string(), text.to_string())),
        _ => None,
    };
    attributes(header).filter_map(pair).collect()
}

/// The attribute `roughness`.
fn header_roughness(header: &Header) -> Option<f64> {
    attributes(header).find_map(|(key, value)| match value {
        AttributeValue::F32(roughness) if *key == *"roughness" => Some(f64::from(*roughness)),
        _ => None,
    })
}

fn attributes(header: &Header) -> impl Iterator<Item = (&Text, &AttributeValue)> {
    header.own_attributes.other.iter().chain(&header.shared_attributes.other)
}

/// Columns, rows and roughness of an image of a bake's level; `None` if its header has no roughness.
pub(in crate::files::io) fn level_header(source: &Source<'_>) -> Result<Option<LevelHeader>> {
    let metadata = MetaData::read_from_buffered(Cursor::new(source.bytes), false)
        .map_err(|error| exr_error(source, &error))?;
    Ok(metadata.headers.first().and_then(|header| {
        let (width, height) = (header.layer_size.x(), header.layer_size.y());
        let (width, height) = (u32::try_from(width).ok()?, u32::try_from(height).ok()?);
        Some(LevelHeader { width, height, roughness: header_roughness(header) })
    }))
}

/// Columns and rows of the first data window in the header; the crate has no clear error for an empty one.
fn data_window(bytes: &[u8]) -> Option<(i64, i64)> {
    const NAME: &[u8] = b"dataWindow\0box2i\0\x10\0\0\0";
    // Search only the header; pixels may look like an attribute.
    let head = &bytes[..bytes.len().min(4096)];
    let at = head.windows(NAME.len()).position(|window| window == NAME)? + NAME.len();
    let corner = |k: usize| {
        let value = bytes.get(at + 4 * k..at + 4 * k + 4)?;
        Some(i64::from(i32::from_le_bytes(value.try_into().ok()?)))
    };
    let side = |least: i64, greatest: i64| (greatest - least + 1).max(0);
    Some((side(corner(0)?, corner(2)?), side(corner(1)?, corner(3)?)))
}

/// Converts luminance-chroma to RGB, and the file's primaries to Rec. 709.
fn convert_color(header: &Header, channels: Channels, texels: &mut [Rgb], warnings: &mut Vec<String>) {
    let primaries = header.shared_attributes.chromaticities.map_or(color::REC709, |own| {
        Primaries([own.red, own.green, own.blue, own.white].map(|xy| [xy.x(), xy.y()].map(f64::from)))
    });
    if let Channels::LuminanceChroma(_) = channels {
        // Texels hold Y, (R - Y)/Y, (B - Y)/Y.
        let [wr, wg, wb] = primaries
            .luminance_weights()
            .or_else(|| color::REC709.luminance_weights())
            .expect("Rec. 709 has weights")
            .map(|weight| weight as f32);
        for texel in texels.iter_mut() {
            let [y, ry, by] = *texel;
            let (r, b) = ((ry + 1.0) * y, (by + 1.0) * y);
            *texel = [r, (y - wr * r - wb * b) / wg, b];
        }
    }
    if !matches!(channels, Channels::Luminance(_)) {
        warnings.extend(primaries.converted("chromaticities", texels));
    }
}

const fn sample_name(sample: SampleType) -> &'static str {
    match sample {
        SampleType::F16 => "half",
        SampleType::F32 => "float",
        SampleType::U32 => "uint",
    }
}

/// Such as `OpenEXR, half, DWAB, tiled`.
fn describe(header: &Header, selection: &Selection) -> String {
    let sample = sample_name(header.channels.list[selection.channels.indices()[0]].sample_type);
    let compression = match header.compression {
        Compression::Uncompressed => "uncompressed",
        Compression::RLE => "RLE",
        Compression::ZIP1 => "ZIPS",
        Compression::ZIP16 => "ZIP",
        Compression::PIZ => "PIZ",
        Compression::PXR24 => "PXR24",
        Compression::B44 => "B44",
        Compression::B44A => "B44A",
        Compression::DWAA(_) => "DWAA",
        Compression::DWAB(_) => "DWAB",
        Compression::HTJ2K32 | Compression::HTJ2K256 => "HTJ2K",
    };
    let tiled = if matches!(header.blocks, BlockDescription::Tiles(_)) { ", tiled" } else { "" };
    let luminance = match selection.channels {
        Channels::Rgb(_) => "",
        Channels::Luminance(_) => ", luminance",
        Channels::LuminanceChroma(_) => ", luminance-chroma",
    };
    format!("OpenEXR, {sample}, {compression}{tiled}{luminance}")
}
