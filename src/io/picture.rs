//! What the codecs take and give: a file in memory, and its pixels.

use super::provenance::Provenance;
use crate::chain::Chain;
use crate::environment::Rgb;
use crate::error::{Error, Result};
use crate::sphere::cube::Face;
use std::path::Path;

/// Bytes of one texel.
pub(super) const TEXEL_BYTES: u64 = size_of::<Rgb>() as u64;

/// A file in memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<'a> {
    /// Its name, for messages.
    pub(super) path: &'a Path,
    /// Its content.
    pub(super) bytes: &'a [u8],
    /// Bytes that reading may take at its peak, `bytes` included.
    pub(super) memory_limit: u64,
}

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// An image whose layout is to be found.
    Image,
    /// Six faces, one below the other.
    Cube,
}

/// Decoded pixels: linear RGB, Rec. 709 primaries, not yet checked.
#[derive(Clone, Debug)]
pub(super) struct Picture {
    pub(super) width: u32,
    pub(super) height: u32,
    /// Row-major, from the top left.
    pub(super) texels: Vec<Rgb>,
    pub(super) content: Content,
    /// The encoding in words.
    pub(super) format: String,
    pub(super) warnings: Vec<String>,
    /// What the file says of its origin and turning; the texels are as the file has them.
    pub(super) provenance: Provenance,
}

impl Picture {
    /// The picture without the `border` that an octahedral map of `octagloss bake --target oem` says it has:
    /// a list, the first level's first.
    pub(super) fn without_border(mut self, source: &Source<'_>, border: &str) -> Result<Self> {
        let first = border.split(',').next().unwrap_or_default().trim();
        let fits =
            |b: &u32| self.width == self.height && b.checked_mul(2).is_some_and(|both| both < self.width);
        let Some(border) = first.parse::<u32>().ok().filter(fits) else {
            return Err(source.error(format!(
                "it says its border is {border:?}, which a map of {}x{} cannot have; bake it anew",
                self.width, self.height
            )));
        };
        let (side, cut) = (self.width as usize, border as usize);
        let rows = self.texels.chunks_exact(side).skip(cut).take(side - 2 * cut);
        self.texels = rows.flat_map(|row| &row[cut..side - cut]).copied().collect();
        self.width -= 2 * border;
        self.height = self.width;
        self.format += &format!(", border {border}");
        Ok(self)
    }
}

impl Source<'_> {
    /// An [`Error::Input`] about this file, on one line whatever `message` quotes.
    pub(super) fn error(&self, message: impl Into<String>) -> Error {
        let message: String = message.into();
        Error::input(self.path, message.split_whitespace().collect::<Vec<_>>().join(" "))
    }

    /// A decoder's error about this file, in its own words unless it ran out of bytes.
    pub(super) fn decoder_error(&self, format: &str, error: &dyn std::error::Error) -> Error {
        let words = error.to_string();
        let ends_early =
            ["missing bytes", "fill whole buffer", "EOF", "end of file", "nexpected end", "truncated"];
        if ends_early.iter().any(|phrase| words.contains(phrase)) {
            self.error(format!(
                "truncated: the {format} data ends after {} bytes; copy it anew",
                self.bytes.len()
            ))
        } else {
            self.error(format!("not a readable {format} file: {words}"))
        }
    }

    /// Refuses an image without pixels, and one whose reading would pass the memory limit at
    /// `bytes_per_pixel` (the texels and whatever the decoder holds beside them).
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

/// A chain as the files have it: flips are not undone.
pub(super) struct Stored {
    pub(super) chain: Chain,
    pub(super) provenance: Provenance,
    /// The encoding in words.
    pub(super) format: String,
}

/// The default of [`super::ReadOptions::memory_limit`]: 3 GiB, enough for 16384x8192 texels.
pub const DEFAULT_MEMORY_LIMIT: u64 = 3 << 30;

/// Refuses NaN and Inf in a level of a chain.
pub(super) fn check_finite(path: &Path, level: u32, size: u32, texels: &[Rgb]) -> Result<()> {
    let Some(at) = texels.iter().position(|texel| texel.iter().any(|value| !value.is_finite())) else {
        return Ok(());
    };
    let (size, face) = (size as usize, at / (size as usize * size as usize));
    let place = at % (size * size);
    Err(Error::input(
        path,
        format!(
            "level {level} face {} pixel ({}, {}) is {:?}; bake it anew",
            Face::ALL[face].short_name(),
            place % size,
            place / size,
            texels[at]
        ),
    ))
}
