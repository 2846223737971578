//! Writes an environment as one image file: EXR (ZIP; half, or float if the light exceeds the range of half)
//! or Radiance .hdr.

use super::exr::write::{Samples, attributes, exr_bytes};
use super::hdr::hdr_bytes;
use super::layout::image_from_faces;
use super::output::{self, Existing};
use crate::common::error::{Error, Result};
use crate::files::format::container::Container;
use crate::files::format::{OutputLayout, Pixel};
use crate::light::environment::{Environment, Layout, Rgb};
use std::path::Path;

/// Writes `environment` to `path`; the extension, `exr` or `hdr`, selects the format. Cubes are written as a
/// horizontal cross. `comment` goes into the EXR header.
///
/// # Errors
/// [`Error::Input`] for another extension; errors of [`output::write_file`].
pub fn write_environment(
    path: &Path,
    existing: Existing,
    environment: &Environment,
    comment: &str,
) -> Result<()> {
    let bytes = environment_bytes(path, environment, comment)?;
    output::write_file(path, existing, |file| file.write_all(&bytes))
}

/// Encodes the file that [`write_environment`] writes; the extension of `path` selects the format.
///
/// # Errors
/// [`Error::Input`] for another extension.
pub fn environment_bytes(path: &Path, environment: &Environment, comment: &str) -> Result<Vec<u8>> {
    let (width, height, texels) = picture(environment);
    let pixel = picture_container(path)?.pixel(None, Pixel::Auto)?;
    picture_bytes(width, height, &texels, pixel, comment, &[])
}

/// The format of an image at `path`, by its extension: [`Container::Exr`] or [`Container::Hdr`].
///
/// # Errors
/// [`Error::Input`] for another extension.
pub fn picture_container(path: &Path) -> Result<Container> {
    Container::of_path(path)
        .filter(|container| matches!(container, Container::Exr | Container::Hdr))
        .ok_or_else(|| Error::input(path, "an environment is written as .exr or .hdr"))
}

/// Encodes an image of `width` x `height` row-major texels, with `metadata` in its header: RGBE as Radiance
/// .hdr, others as EXR.
///
/// # Errors
/// As [`exr_bytes`].
pub fn picture_bytes(
    width: u32,
    height: u32,
    texels: &[Rgb],
    pixel: Pixel,
    comment: &str,
    metadata: &[(String, String)],
) -> Result<Vec<u8>> {
    if pixel == Pixel::Rgbe {
        return hdr_bytes(width, height, texels, metadata);
    }
    let texts = metadata.iter().map(|(key, value)| (key.as_str(), value.as_str()));
    let attributes = attributes(None, std::iter::once(("comments", comment)).chain(texts));
    exr_bytes(width, height, Samples::Rgb(texels), pixel.stored(texels), &attributes)
}

/// Light that `pixel` cannot hold in an image of `texels`, one line each; `remedy` names what can.
pub fn losses(texels: &[Rgb], pixel: Pixel, remedy: &str) -> Vec<String> {
    let name = pixel.name();
    let words = |count: u64, loss: String| (count > 0).then(|| format!("{count} texels {loss}; {remedy}"));
    let clamped = format!("exceed the {name} maximum of {:.2e} and were clamped", pixel.max());
    let vanished =
        format!("have a channel of at most {:.1e} that became 0 in {name}", pixel.rounded_to_zero());
    [words(pixel.clamped(texels), clamped), words(pixel.vanishing(texels), vanished)]
        .into_iter()
        .flatten()
        .collect()
}

/// Encodes `environment` losslessly as an EXR file of floats, laid out as in [`write_environment`].
///
/// # Errors
/// As [`exr_bytes`].
pub fn exact_exr_bytes(environment: &Environment, comment: &str) -> Result<Vec<u8>> {
    let (width, height, texels) = picture(environment);
    picture_bytes(width, height, &texels, Pixel::F32, comment, &[])
}

/// Width, height and row-major texels of the image.
fn picture(environment: &Environment) -> (u32, u32, Vec<Rgb>) {
    match environment.layout() {
        Layout::Panorama { width, height } => (width, height, environment.texels().to_vec()),
        Layout::Octahedral { size } => (size, size, environment.texels().to_vec()),
        Layout::Cube { size } => {
            let cross = image_from_faces(OutputLayout::Cross, size, environment.texels());
            let (width, texels) = cross.expect("crosses unfold cubes");
            (width, 3 * size, texels)
        }
    }
}
