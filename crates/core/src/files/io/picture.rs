//! Input and output of the decoders: a file in memory, and its pixels.

use super::map_header::MapHeader;
use super::provenance::Provenance;
use crate::common::error::{Error, Result};
use crate::light::environment::{Layout, Rgb};
use crate::sphere::cube::Face;
use std::path::Path;

/// Bytes of one texel.
pub(super) const TEXEL_BYTES: u64 = size_of::<Rgb>() as u64;

/// The default of [`super::ReadOptions::memory_limit`]: 3 GiB, enough for 16384x8192 texels.
pub const DEFAULT_MEMORY_LIMIT: u64 = 3 << 30;

/// A file in memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<'a> {
    /// Its path, for messages.
    pub(super) path: &'a Path,
    /// Its content.
    pub(super) bytes: &'a [u8],
    /// Peak memory of reading, including `bytes`, in bytes.
    pub(super) memory_limit: u64,
}

impl Source<'_> {
    /// An [`Error::Input`] about this file; `message` is joined to one line.
    pub(super) fn error(&self, message: impl Into<String>) -> Error {
        let message: String = message.into();
        Error::input(self.path, message.split_whitespace().collect::<Vec<_>>().join(" "))
    }

    /// Origin recorded in the key/value pairs of this file.
    pub(super) fn provenance(&self, pairs: &[(String, String)]) -> Result<Provenance> {
        Provenance::of_pairs(pairs).map_err(|message| self.error(message))
    }

    /// Converts a decoder's error; recognises truncated files.
    pub(super) fn decoder_error(&self, format: &str, error: &dyn std::error::Error) -> Error {
        let words = error.to_string();
        let ends_early =
            ["missing bytes", "fill whole buffer", "EOF", "end of file", "nexpected end", "truncated"];
        if ends_early.iter().any(|phrase| words.contains(phrase)) {
            self.truncated(format)
        } else {
            self.error(format!("not a readable {format} file: {words}"))
        }
    }

    /// The error of data in `format` that ends too early.
    pub(super) fn truncated(&self, format: &str) -> Error {
        let length = self.bytes.len();
        self.error(format!("truncated: the {format} data ends after {length} bytes; copy it again"))
    }

    /// Rejects an image without pixels, and one that exceeds the memory limit at `bytes_per_pixel` (the
    /// texels and the decoder's buffers).
    pub(super) fn check_memory(&self, width: u32, height: u32, bytes_per_pixel: u64) -> Result<()> {
        if width == 0 || height == 0 {
            return Err(self.error(format!("{width}x{height} has no pixels")));
        }
        let pixels = u64::from(width) * u64::from(height);
        let needed = pixels.saturating_mul(bytes_per_pixel).saturating_add(self.bytes.len() as u64);
        if needed > self.memory_limit {
            let what = format!("an image of {width}x{height} pixels");
            return Err(limit(self.path, &what, needed, self.memory_limit));
        }
        Ok(())
    }
}

/// An [`Error::Limit`] about `path`.
pub(super) fn limit(path: &Path, what: &str, needed: u64, available: u64) -> Error {
    Error::Limit {
        what: format!("{}: {what}", path.display()),
        needed,
        available,
        remedy: "scale it down first".to_owned(),
    }
}

/// Decoded pixels: linear RGB, Rec. 709 primaries, unchecked.
#[derive(Clone, Debug, Default)]
pub(super) struct Picture {
    pub(super) width: u32,
    pub(super) height: u32,
    /// Row-major, from the top left.
    pub(super) texels: Vec<Rgb>,
    /// Whether it is six faces, stacked vertically; else an image whose layout is not known yet.
    pub(super) is_cube: bool,
    /// The map that the header names.
    pub(super) map: Option<MapHeader>,
    /// The encoding in words.
    pub(super) format: String,
    pub(super) warnings: Vec<String>,
    /// Origin and orientation recorded in the file; not yet applied to the texels.
    pub(super) provenance: Provenance,
}

/// Size and roughness in the header of a level's image.
pub(super) struct LevelHeader {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) roughness: Option<f64>,
}

/// Rejects NaN and Inf in a level of a chain.
pub(super) fn check_finite(path: &Path, level: u32, size: u32, texels: &[Rgb]) -> Result<()> {
    let Some(at) = texels.iter().position(|texel| texel.iter().any(|value| !value.is_finite())) else {
        return Ok(());
    };
    let (face, i, j) = Layout::Cube { size }.place(at);
    let (face, value) = (Face::ALL[face as usize].short_name(), texels[at]);
    let message = format!("level {level} face {face} pixel ({i}, {j}) is {value:?}; bake it again");
    Err(Error::input(path, message))
}
