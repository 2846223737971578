//! Writes levels as images: single EXR or Radiance images, and lat-long MIP maps in one tiled EXR.

use super::exr::parts::exr_mips_bytes;
use super::exr::write::{Samples, attributes, exr_bytes};
use super::hdr::hdr_bytes;
use super::ktx2::write::{ROUGHNESS_KEY, roughness_text};
use crate::common::error::{Result, wrong};
use crate::files::format::Pixel;
use crate::files::format::container::Container;
use crate::light::chain::Level;
use crate::light::environment::{Layout, Rgb};

/// Storage format and header of an image.
#[derive(Clone, Copy, Debug)]
pub struct ImageFormat<'a> {
    /// OpenEXR or Radiance.
    pub container: Container,
    /// Its pixel format.
    pub pixel: Pixel,
    /// Perceptual roughness of its level; `None` for other maps.
    pub roughness: Option<f64>,
    /// Further key/value pairs.
    pub metadata: &'a [(String, String)],
}

/// Encodes an image `width` texels wide. Roughness and metadata go into EXR attributes or Radiance header
/// lines.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for other containers, for pixel formats that the container does
/// not support, and if the samples do not fill the image.
pub(crate) fn image_bytes(width: u32, samples: Samples<'_>, format: &ImageFormat<'_>) -> Result<Vec<u8>> {
    let ImageFormat { container, pixel, roughness, metadata } = *format;
    let count = match samples {
        Samples::Rgb(texels) => texels.len(),
        Samples::Luminance(values) => values.len(),
    };
    let height = (count / width.max(1) as usize) as u32;
    match (container, samples) {
        (Container::Exr, _) => {
            let attributes = attributes(roughness, metadata.iter().cloned());
            exr_bytes(width, height, samples, pixel, &attributes)
        }
        (Container::Hdr, Samples::Rgb(texels)) => {
            let own = roughness.map(|roughness| (ROUGHNESS_KEY.to_owned(), roughness.to_string()));
            let pairs: Vec<_> = own.into_iter().chain(metadata.iter().cloned()).collect();
            hdr_bytes(width, height, texels, &pairs)
        }
        _ => wrong(format!("an image of a level is exr or hdr, not {}", container.name())),
    }
}

/// Encodes a tiled EXR of `levels`, panoramas that halve down to one texel, with each level's roughness and
/// `metadata` in attributes.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for other levels, and for pixel formats that EXR does not
/// support.
pub(crate) fn mips_bytes(levels: &[Level], pixel: Pixel, metadata: &[(String, String)]) -> Result<Vec<u8>> {
    let Some(Layout::Panorama { width, height }) = levels.first().map(|level| level.layout) else {
        return wrong("a lat-long MIP map is made of panoramas");
    };
    let roughness = roughness_text(levels.iter().map(|level| level.roughness));
    let roughness = (ROUGHNESS_KEY.to_owned(), roughness);
    let attributes = attributes(None, std::iter::once(roughness).chain(metadata.iter().cloned()));
    let texels: Vec<&[Rgb]> = levels.iter().map(|level| &level.texels[..]).collect();
    exr_mips_bytes((width, height), &texels, pixel, &attributes)
}
