//! Input of the decoders: a file in memory.

use crate::common::error::{Error, Result};
use crate::light::environment::Rgb;
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
