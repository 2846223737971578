//! Radiance .hdr output through the `image` crate: RGBE, run lengths, any radiance up to 2^127.

use crate::chain::{Chain, Level};
use crate::environment::Rgb;
use crate::error::{Error, Result};
use crate::format::RGBE_MAX;
use crate::io::ktx2::write::ROUGHNESS_KEY;
use crate::io::output;
use crate::io::provenance::irradiance_pairs;
use crate::sphere::cube::Face;
use image::codecs::hdr::HdrEncoder;
use rayon::prelude::*;
use std::fs;
use std::path::Path;

/// The bytes of a .hdr file of `width` x `height` row-major texels.
///
/// # Errors
/// [`Error::Parameter`] where the texels do not fill the image.
pub fn hdr_bytes(width: u32, height: u32, texels: &[Rgb]) -> Result<Vec<u8>> {
    hdr_bytes_with(width, height, texels, &[])
}

/// [`hdr_bytes`] with a header line `KEY=value` for each pair of `metadata`.
///
/// # Errors
/// As [`hdr_bytes`]; [`Error::Parameter`] for keys and values that are no part of a line.
pub fn hdr_bytes_with(
    width: u32,
    height: u32,
    texels: &[Rgb],
    metadata: &[(String, String)],
) -> Result<Vec<u8>> {
    let breaks = |text: &str| text.contains(char::is_control);
    if let Some((key, _)) =
        metadata.iter().find(|(key, value)| breaks(key) || breaks(value) || key.contains('='))
    {
        return Err(Error::Parameter(format!("{key:?} and its value cannot be a line of a .hdr header")));
    }
    let mut bytes = plain_bytes(width, height, texels)?;
    // The header's first line is the signature.
    let at = bytes.iter().position(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    let lines: String = metadata.iter().map(|(key, value)| format!("{key}={value}\n")).collect();
    bytes.splice(at..at, lines.into_bytes());
    Ok(bytes)
}

fn plain_bytes(width: u32, height: u32, texels: &[Rgb]) -> Result<Vec<u8>> {
    if texels.is_empty() || texels.len() != width as usize * height as usize {
        return Err(Error::Parameter(format!(
            "a .hdr file of {width}x{height} cannot hold {} texels",
            texels.len()
        )));
    }
    let mut bytes = Vec::with_capacity(texels.len() * 4 + 128);
    let texels: Vec<_> = texels.iter().map(|t| image::Rgb(nearest_rgbe(*t))).collect();
    HdrEncoder::new(&mut bytes)
        .encode(&texels, width as usize, height as usize)
        .map_err(|e| Error::Parameter(format!("a .hdr file of {width}x{height}: {e}")))?;
    Ok(bytes)
}

/// The colour nearest to `rgb` that RGBE holds. The encoder truncates, which darkens by a quarter of a per
/// cent on average, and wraps its exponent outside of 2^-127..2^127.
fn nearest_rgbe(rgb: Rgb) -> Rgb {
    let clamped = rgb.map(|c| c.clamp(0.0, RGBE_MAX));
    let greatest = clamped[0].max(clamped[1]).max(clamped[2]);
    if greatest < f32::MIN_POSITIVE {
        return [0.0; 3];
    }
    let rounded = |exponent: i32| {
        let quantum = f64::from(exponent - 8).exp2();
        clamped.map(|c| ((f64::from(c) / quantum).round() * quantum) as f32)
    };
    let exponent = (greatest.to_bits() >> 23) as i32 - 126;
    let nearest = rounded(exponent);
    // The greatest may round up to the next power of two, where the quantum is twice as large.
    if nearest.iter().any(|c| f64::from(*c) >= f64::from(exponent).exp2()) {
        rounded(exponent + 1)
    } else {
        nearest
    }
}

/// Writes a chain's levels as `m{level}_{face}.hdr`, and `irradiance_{face}.hdr`, into a folder that appears
/// whole or not at all.
///
/// # Errors
/// As [`output::write_folder`].
pub fn write_hdr_folder(
    path: &Path,
    existing: output::Existing,
    chain: &Chain,
    irradiance: Option<&Level>,
) -> Result<()> {
    output::write_folder(path, existing, |folder| write_level_folder(folder, chain, irradiance, &[]))
}

/// [`write_hdr_folder`] into a folder that is there. Each file has its roughness and `metadata` in its
/// header.
///
/// # Errors
/// [`Error::Io`] naming the file that could not be written.
pub fn write_level_folder(
    folder: &Path,
    chain: &Chain,
    irradiance: Option<&Level>,
    metadata: &[(String, String)],
) -> Result<()> {
    let levels = chain.levels.iter().enumerate().map(|(index, level)| (format!("m{index}"), level));
    let files: Vec<_> = levels
        .chain(irradiance.map(|level| ("irradiance".to_owned(), level)))
        .flat_map(|(name, level)| {
            Face::ALL.map(|face| (format!("{name}_{}.hdr", face.short_name()), level, face))
        })
        .collect();
    files.into_par_iter().try_for_each(|(file_name, level, face)| {
        let path = folder.join(&file_name);
        let roughness = (!file_name.starts_with("irradiance")).then_some(level.roughness);
        let lines = level_pairs(roughness, metadata);
        let bytes = hdr_bytes_with(level.size(), level.size(), level.face(face), &lines)?;
        fs::write(&path, bytes).map_err(|e| Error::io(&path, e))
    })
}

/// The header lines of an image of a level; an irradiance has no roughness to say.
pub(in crate::io) fn level_pairs(
    roughness: Option<f64>,
    metadata: &[(String, String)],
) -> Vec<(String, String)> {
    match roughness {
        Some(roughness) => {
            let own = (ROUGHNESS_KEY.to_owned(), roughness.to_string());
            std::iter::once(own).chain(metadata.iter().cloned()).collect()
        }
        None => irradiance_pairs(metadata),
    }
}
