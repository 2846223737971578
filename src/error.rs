//! What can go wrong, told by whose fault it is.

use std::path::{Path, PathBuf};

/// Every failure of the library. Messages name the file, the place, the value and the remedy, on one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused: missing file, no permission, disk full.
    #[error("{}: {error}", path.display())]
    Io {
        /// The file or folder asked for.
        path: PathBuf,
        /// What the system said. The message says it too, so it is not a `source()`, which would tell it twice.
        error: std::io::Error,
    },
    /// A file that is not what it should be: truncated, not an image, wrong shape.
    #[error("{}: {message}", path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, where, and what helps.
        message: String,
    },
    /// A texel that is NaN or infinite where repair was not asked for.
    #[error("{}: pixel ({x}, {y}) channel {channel} is {value}; --sanitize repairs NaN and Inf", path.display())]
    NonFinite {
        /// The file.
        path: PathBuf,
        /// Column, from the left.
        x: u32,
        /// Row, from the top.
        y: u32,
        /// `R`, `G` or `B`.
        channel: char,
        /// What stands there.
        value: f32,
    },
    /// Something asked of the library that it cannot do.
    #[error("{0}")]
    Parameter(String),
    /// A GPU that is not there, that was lost, or that refused.
    #[error("GPU: {0}")]
    Gpu(String),
    /// More memory, or a larger table, than there is.
    #[error("{what} needs {needed} bytes and the limit is {available}; {remedy}")]
    Limit {
        /// The thing that does not fit.
        what: String,
        /// Bytes it would take.
        needed: u64,
        /// Bytes there are.
        available: u64,
        /// What to ask for instead.
        remedy: String,
    },
}

/// The library's results.
pub type Result<T, E = Error> = std::result::Result<T, E>;

impl Error {
    /// An [`Error::Io`] at `path`.
    pub fn io(path: &Path, error: std::io::Error) -> Self {
        Self::Io { path: path.to_owned(), error }
    }

    /// An [`Error::Input`] about `path`.
    pub fn input(path: &Path, message: impl Into<String>) -> Self {
        Self::Input { path: path.to_owned(), message: message.into() }
    }
}
