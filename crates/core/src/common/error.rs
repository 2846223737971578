//! Error types, grouped by cause.

use std::path::{Path, PathBuf};

/// Library error. Each message is one line naming the file, place, value and remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An operating system error: missing file, no permission, disk full.
    #[error("{}: {error}", path.display())]
    Io {
        /// Path of the file or folder.
        path: PathBuf,
        /// The system's error. The message includes it, so it is not a `source()`, which would print it
        /// twice.
        error: std::io::Error,
    },
    /// An invalid file: truncated, not an image, wrong shape.
    #[error("{}: {message}", path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// The fault, its place and the remedy.
        message: String,
    },
    /// A NaN or infinite texel while `sanitize` is off.
    #[error(
        "{}: pixel ({x}, {y}) channel {channel} is {value}; `sanitize` repairs NaN and Inf",
        path.display()
    )]
    NonFinite {
        /// The file.
        path: PathBuf,
        /// Column, from the left.
        x: u32,
        /// Row, from the top.
        y: u32,
        /// `R`, `G` or `B`.
        channel: char,
        /// The invalid value.
        value: f32,
    },
    /// A NaN, infinite or negative result: a bug in this library. Nothing is written.
    #[error(
        "{place}: the result is {value}, a fault of octagloss; `filter` reference avoids it, please report it"
    )]
    NonFiniteResult {
        /// Level, face and texel, or direction, or the report's field.
        place: String,
        /// The invalid value.
        value: f64,
    },
    /// An invalid parameter or combination of parameters.
    #[error("{0}")]
    Parameter(String),
    /// A filter or lobe that only the CPU engine supports.
    #[error("{what} runs on the CPU only; use `engine` cpu")]
    Unsupported {
        /// The filter or the lobe.
        what: String,
    },
    /// Cancelled by the caller.
    #[error("cancelled")]
    Cancelled,
    /// A missing or lost GPU, or a failed GPU operation.
    #[error("GPU: {0}")]
    Gpu(String),
    /// A memory or table size limit is exceeded.
    #[error("{what} needs {needed} bytes and the limit is {available}; {remedy}")]
    Limit {
        /// The object that exceeds the limit.
        what: String,
        /// Bytes required.
        needed: u64,
        /// Bytes available.
        available: u64,
        /// A request that fits.
        remedy: String,
    },
}

/// Quotes `text` of a file for a message: escapes control characters and truncates to 60 characters.
pub fn quoted(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{:?}... ({} bytes)", &text[..end], text.len()),
        None => format!("{text:?}"),
    }
}

/// `text` of an error or a warning with each setting in it, such as `` `oem_size` ``, as `named` calls it: an
/// option, a key, a parameter.
#[must_use]
pub fn with_settings(text: &str, named: &dyn Fn(&str) -> String) -> String {
    let is_setting =
        |word: &str| !word.is_empty() && word.bytes().all(|c| c.is_ascii_lowercase() || c == b'_');
    let parts: Vec<&str> = text.split('`').collect();
    let mut whole = String::new();
    let mut quotes = "";
    for (place, part) in parts.iter().enumerate() {
        let is_quoted = place > 0 && place + 1 < parts.len() && is_setting(part);
        if is_quoted && quotes == "`" {
            whole += &named(part);
            quotes = "";
        } else {
            whole += quotes;
            whole += part;
            quotes = "`";
        }
    }
    whole
}

/// Result with this library's [`Error`] by default.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Fails with [`Error::Parameter`].
pub fn wrong<T>(message: impl Into<String>) -> Result<T> {
    Err(Error::Parameter(message.into()))
}

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

/// Longest message that quotes a file, in bytes.
const MAX_MESSAGE: usize = 1000;

/// Escapes control characters and truncates long text.
pub(crate) fn printable(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for character in text.chars() {
        if plain.len() > MAX_MESSAGE {
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
    use super::{Error, printable, with_settings};
    use std::path::Path;

    #[test]
    fn what_messages_quote_of_a_file_is_escaped_and_cut() {
        let error = Error::input(Path::new("a.exr"), "no channels among \u{1b}[2J\u{2}, \u{e9}").to_string();
        assert_eq!(error, r"a.exr: no channels among \u{1b}[2J\u{2}, \u{e9}".replace(r"\u{e9}", "\u{e9}"));
        let long = printable(&"layer ".repeat(1_000_000));
        assert!(long.len() < 1100 && long.ends_with("..."), "{} bytes", long.len());
    }

    #[test]
    fn settings_in_messages_are_named_as_options() {
        let option = |setting: &str| format!("--{}", setting.replace('_', "-"));
        for (text, expected) in [
            ("`oem_size` 3 is odd; `size` keeps `chain`", "--oem-size 3 is odd; --size keeps --chain"),
            ("`", "`"),
            ("a`b.exr: `pad` fills `Up`, ``, `a b`", "a`b.exr: --pad fills `Up`, ``, `a b`"),
            ("set `a`", "set --a"),
        ] {
            assert_eq!(with_settings(text, &option), expected);
        }
    }
}
