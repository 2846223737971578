//! Error types, grouped by cause.

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
        /// The system's error. The message includes it, so it is not a `source()`, which would print it
        /// twice.
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
    #[error("{}: pixel ({x}, {y}) channel {channel} is {value}; `sanitize` repairs NaN and Inf", path.display())]
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
    /// A result that is NaN, infinite or negative: a fault of this library, reported instead of written.
    #[error(
        "{place}: the result is {value}, a fault of octagloss; `filter` reference avoids it, please report it"
    )]
    NonFiniteResult {
        /// Level, face and texel, or direction, or the report's field.
        place: String,
        /// What came out.
        value: f64,
    },
    /// Something asked of the library that it cannot do.
    #[error("{0}")]
    Parameter(String),
    /// Something that the GPU engine does not compute and the CPU does.
    #[error("{what} runs on the CPU only; use the CPU engine")]
    Unsupported {
        /// The filter or the lobe.
        what: String,
    },
    /// Work that the caller stopped.
    #[error("cancelled")]
    Cancelled,
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

/// `text` out of a file, fit for a message: in quotes, control characters escaped, and shortened to 60
/// characters.
#[must_use]
pub fn quoted(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{:?}... ({} bytes)", &text[..end], text.len()),
        None => format!("{text:?}"),
    }
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
        Self::Input { path: path.to_owned(), message: printable(&message.into()) }
    }
}

/// Bytes of a message that quotes a file: more of it says no more.
const MOST_MESSAGE: usize = 1000;

/// `text` as a terminal may show it: control characters are escaped, and what is long is cut.
pub(crate) fn printable(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for character in text.chars() {
        if plain.len() > MOST_MESSAGE {
            plain += "...";
            break;
        }
        if character.is_control() {
            plain.extend(character.escape_default());
        } else {
            plain.push(character);
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::{Error, printable};
    use std::path::Path;

    #[test]
    fn what_messages_quote_of_a_file_is_escaped_and_cut() {
        let error = Error::input(Path::new("a.exr"), "no channels among \u{1b}[2J\u{2}, \u{e9}").to_string();
        assert_eq!(error, r"a.exr: no channels among \u{1b}[2J\u{2}, \u{e9}".replace(r"\u{e9}", "\u{e9}"));
        let long = printable(&"layer ".repeat(1_000_000));
        assert!(long.len() < 1100 && long.ends_with("..."), "{} bytes", long.len());
    }
}
