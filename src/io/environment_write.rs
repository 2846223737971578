//! An environment as one image file: EXR (half, ZIP; float where half cannot hold a value) or Radiance .hdr.

use super::exr_write::{Attribute, Samples, exr_bytes};
use super::hdr_write::hdr_bytes;
use super::output::{self, Existing};
use super::pixels::Pixel;
use crate::environment::{Environment, Layout, Rgb};
use crate::error::{Error, Result};
use crate::sphere::cube::Face;
use std::path::Path;

/// Where each face of [`Face::ALL`] stands in the horizontal cross, in faces from the left and from the top.
pub const CROSS_CELLS: [(u32, u32); 6] = [(2, 1), (0, 1), (1, 0), (1, 2), (1, 1), (3, 1)];

/// Writes the texels of `environment` to `path` by its extension, `exr` or `hdr`: panoramas and octahedral squares as
/// they are, cubes as a horizontal cross. `comment` goes into the EXR header.
///
/// # Errors
/// [`Error::Input`] for another extension, and as [`output::write_file`].
pub fn write_environment(
    path: &Path,
    existing: Existing,
    environment: &Environment,
    comment: &str,
) -> Result<()> {
    let (width, height, texels) = picture(environment);
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let bytes = match extension.as_deref() {
        Some("exr") => {
            let pixel = if Pixel::F16.clamped(&texels) == 0 { Pixel::F16 } else { Pixel::F32 };
            let attributes = [("comments".to_owned(), Attribute::Text(comment.to_owned()))];
            exr_bytes(width, height, Samples::Rgb(&texels), pixel, &attributes)?
        }
        Some("hdr") => hdr_bytes(width, height, &texels)?,
        _ => return Err(Error::input(path, "an environment is written as .exr or .hdr")),
    };
    output::write_file(path, existing, |file| file.write_all(&bytes))
}

/// The texels of `environment` as an EXR file of floats, which loses nothing; laid out as by [`write_environment`].
///
/// # Errors
/// As [`exr_bytes`].
pub fn exact_exr_bytes(environment: &Environment, comment: &str) -> Result<Vec<u8>> {
    let (width, height, texels) = picture(environment);
    let attributes = [("comments".to_owned(), Attribute::Text(comment.to_owned()))];
    exr_bytes(width, height, Samples::Rgb(&texels), Pixel::F32, &attributes)
}

/// The texels as one image: its width, its height and its rows.
fn picture(environment: &Environment) -> (u32, u32, Vec<Rgb>) {
    match environment.layout() {
        Layout::Panorama { width, height } => (width, height, environment.texels().to_vec()),
        Layout::Octahedral { size } => (size, size, environment.texels().to_vec()),
        Layout::Cube { size } => (4 * size, 3 * size, cross_from_faces(size, environment.texels())),
    }
}

/// The horizontal cross, 4 x 3 faces, of six faces of `size` x `size` texels as they are stored; black elsewhere.
#[must_use]
pub fn cross_from_faces(size: u32, texels: &[Rgb]) -> Vec<Rgb> {
    let (n, width) = (size as usize, 4 * size as usize);
    let mut cross = vec![[0.0; 3]; width * 3 * n];
    for face in Face::ALL {
        let (column, row) = CROSS_CELLS[face.index()];
        let from = &texels[face.index() * n * n..][..n * n];
        for (j, line) in from.chunks_exact(n).enumerate() {
            let at = (row as usize * n + j) * width + column as usize * n;
            cross[at..at + n].copy_from_slice(line);
        }
    }
    cross
}
