//! Levels as single images: folders of `m{level}.exr` or `.hdr`, and lat-long MIP maps in one tiled EXR.

use super::exr::parts::exr_mips_bytes;
use super::exr::write::{Attribute, Samples, StoredLevel, attributes_of, exr_bytes, stored_level};
use super::hdr::write::{hdr_bytes_with, level_pairs};
use super::layout::Unfolding;
use crate::chain::Level;
use crate::environment::{Layout, Rgb};
use crate::error::{Error, Result};
use crate::format::Pixel;
use rayon::prelude::*;
use std::borrow::Cow;
use std::fs;
use std::path::Path;

/// A level as one image.
#[derive(Clone, Debug)]
pub struct LevelImage<'a> {
    /// The file's name, without its extension.
    pub name: String,
    /// Columns.
    pub width: u32,
    /// Row-major.
    pub texels: Cow<'a, [Rgb]>,
    /// Perceptual roughness; `None` where it has none.
    pub roughness: Option<f64>,
}

impl<'a> LevelImage<'a> {
    /// A cube's level, unfolded.
    #[must_use]
    pub fn unfolded(name: String, level: &Level, unfolding: Unfolding, roughness: Option<f64>) -> Self {
        let (columns, _) = unfolding.sides();
        let texels = unfolding.image_from_faces(level.size(), &level.texels);
        Self { name, width: columns * level.size(), texels: Cow::Owned(texels), roughness }
    }

    /// A level that is an image already.
    #[must_use]
    pub fn whole(name: String, level: &'a Level) -> Self {
        let texels = Cow::Borrowed(&level.texels[..]);
        Self { name, width: level.layout.sides().0, texels, roughness: Some(level.roughness) }
    }

    fn height(&self) -> u32 {
        (self.texels.len() / self.width.max(1) as usize) as u32
    }
}

/// Writes `images` into `folder` as EXR files that tell their `roughness` and `metadata`; returns how each
/// was stored.
///
/// # Errors
/// [`Error::Io`] naming the file that could not be written.
pub fn write_exr_images(
    folder: &Path,
    images: &[LevelImage<'_>],
    choice: Pixel,
    metadata: &[(String, String)],
) -> Result<Vec<StoredLevel>> {
    let write = |image: &LevelImage<'_>| {
        let stored = stored_level(&image.texels, choice);
        let attributes = attributes_of(image.roughness, metadata);
        let samples = Samples::Rgb(&image.texels);
        let bytes = exr_bytes(image.width, image.height(), samples, stored.pixel, &attributes)?;
        let path = folder.join(format!("{}.exr", image.name));
        fs::write(&path, bytes).map_err(|e| Error::io(&path, e))?;
        Ok(stored)
    };
    images.par_iter().map(write).collect()
}

/// Writes `images` into `folder` as Radiance files with their roughness and `metadata` in their headers.
///
/// # Errors
/// [`Error::Io`] naming the file that could not be written.
pub fn write_hdr_images(
    folder: &Path,
    images: &[LevelImage<'_>],
    metadata: &[(String, String)],
) -> Result<()> {
    images.par_iter().try_for_each(|image| {
        let lines = level_pairs(image.roughness, metadata);
        let bytes = hdr_bytes_with(image.width, image.height(), &image.texels, &lines)?;
        let path = folder.join(format!("{}.hdr", image.name));
        fs::write(&path, bytes).map_err(|e| Error::io(&path, e))
    })
}

/// A tiled EXR of `levels`, panoramas that halve down to one texel, with each level's roughness and
/// `metadata` in attributes.
///
/// # Errors
/// [`Error::Parameter`] for levels that are not so, and for pixels that EXR does not have.
pub fn mips_bytes(levels: &[Level], pixel: Pixel, metadata: &[(String, String)]) -> Result<Vec<u8>> {
    let Some(Layout::Panorama { width, height }) = levels.first().map(|level| level.layout) else {
        return Err(Error::Parameter("a lat-long MIP map is made of panoramas".to_owned()));
    };
    let roughness: Vec<String> = levels.iter().map(|level| level.roughness.to_string()).collect();
    let roughness = ("octaglossRoughness".to_owned(), Attribute::Text(roughness.join(",")));
    let text = metadata.iter().map(|(key, text)| (key.clone(), Attribute::Text(text.clone())));
    let attributes: Vec<_> = std::iter::once(roughness).chain(text).collect();
    let texels: Vec<&[Rgb]> = levels.iter().map(|level| &level.texels[..]).collect();
    exr_mips_bytes((width, height), &texels, pixel, &attributes)
}
