//! Directions as CSV with the header `x,y,z`, from a file or standard input, within stated limits.

use crate::error::quoted;
use crate::io::regular::open_regular;
use anyhow::{Context as _, anyhow, bail};
use glam::DVec3;
use std::io::Read;
use std::path::Path;

/// A direction as it was typed and as it is meant.
pub(super) struct Asked {
    pub(super) typed: [String; 3],
    pub(super) direction: DVec3,
}

/// What is accepted of a file or of standard input, which may have no end.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    /// Directions.
    pub(super) rows: usize,
    /// Bytes in all.
    pub(super) bytes: usize,
    /// Bytes between two line ends.
    pub(super) line: usize,
}

/// The limits of `--directions`, as its help states them.
pub(super) const LIMITS: Limits = Limits { rows: 4_000_000, bytes: 256 << 20, line: 1000 };

/// Reads the directions in the CSV file `path`, or on standard input where that is `-`.
pub(super) fn read_directions(path: &Path) -> anyhow::Result<Vec<Asked>> {
    if path == Path::new("-") {
        return parse_directions(std::io::stdin().lock(), LIMITS).context("standard input");
    }
    parse_directions(open_regular(path)?, LIMITS).with_context(|| path.display().to_string())
}

/// Parses directions, one a line.
pub(super) fn parse_directions(from: impl Read, limits: Limits) -> anyhow::Result<Vec<Asked>> {
    let text = read_text(from, limits)?;
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(&text[..]);
    let mut records = reader.records();
    let header = records.next().transpose()?.ok_or_else(|| anyhow!("empty; a line x,y,z must come first"))?;
    // A byte order mark is no part of the name.
    let names: Vec<&str> = header.iter().map(|name| name.trim_start_matches('\u{feff}')).collect();
    if names != ["x", "y", "z"] {
        bail!("line 1 is {}; the header must be x,y,z", quoted(&names.join(",")));
    }
    let mut asked = Vec::new();
    for record in records {
        let record = record?;
        let line = record.position().map_or(0, |position| line_of(position, &text));
        if record.len() != 3 {
            bail!("line {line} has {} values; x,y,z are three", record.len());
        }
        if asked.len() == limits.rows {
            bail!("more than {} directions, at line {line}; ask for them in parts", limits.rows);
        }
        let mut direction = [0.0_f64; 3];
        for ((value, text), name) in direction.iter_mut().zip(&record).zip(names.iter()) {
            *value =
                text.parse().map_err(|_| anyhow!("line {line}: {name} is {}, not a number", quoted(text)))?;
            if !value.is_finite() {
                bail!("line {line}: {name} is {}; it must be finite", quoted(text));
            }
        }
        // Scaled first: squares of tiny and huge lengths leave the range of floats.
        let direction = DVec3::from_array(direction);
        let longest = direction.abs().max_element();
        if longest == 0.0 {
            bail!("line {line}: 0,0,0 points nowhere");
        }
        asked.push(Asked {
            typed: std::array::from_fn(|c| record[c].to_owned()),
            direction: (direction / longest).normalize(),
        });
    }
    Ok(asked)
}

/// Reads all of `from`, and stops at the first limit that it passes.
fn read_text(mut from: impl Read, limits: Limits) -> anyhow::Result<Vec<u8>> {
    let mut text = Vec::new();
    let mut chunk = vec![0; 64 << 10];
    let (mut line, mut length) = (1, 0);
    loop {
        let count = match from.read(&mut chunk) {
            Ok(0) => return Ok(text),
            Ok(count) => count,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error.into()),
        };
        for byte in &chunk[..count] {
            (line, length) = if *byte == b'\n' { (line + 1, 0) } else { (line, length + 1) };
            if length > limits.line {
                bail!("line {line} is longer than {} bytes; a line is x,y,z", limits.line);
            }
        }
        if count > limits.bytes - text.len() {
            bail!("more than {} bytes, at line {line}; ask for the directions in parts", limits.bytes);
        }
        text.extend_from_slice(&chunk[..count]);
    }
}

/// The line a record stands on: its position is that of the empty lines before it.
fn line_of(position: &csv::Position, text: &[u8]) -> u64 {
    let rest = text.get(position.byte() as usize..).unwrap_or_default();
    let empty = rest.iter().take_while(|byte| b"\r\n".contains(byte)).filter(|byte| **byte == b'\n').count();
    position.line() + empty as u64
}

#[cfg(test)]
mod tests {
    use super::{LIMITS, Limits, parse_directions};

    fn error(text: &[u8], limits: Limits) -> String {
        match parse_directions(text, limits) {
            Ok(asked) => panic!("{} directions were read", asked.len()),
            Err(error) => format!("{error:#}"),
        }
    }

    #[test]
    fn limits_stop_what_has_no_end() {
        let few = Limits { rows: 2, bytes: 30, line: 10 };
        assert_eq!(parse_directions(&b"x,y,z\n1,0,0\n0,1,0\n"[..], few).expect("within").len(), 2);
        let rows = error(b"x,y,z\n1,0,0\n0,1,0\n0,0,1\n", few);
        assert_eq!(rows, "more than 2 directions, at line 4; ask for them in parts");
        let endless = parse_directions(std::io::repeat(0), LIMITS).err().expect("no end").to_string();
        assert_eq!(endless, "line 1 is longer than 1000 bytes; a line is x,y,z");
        let lines = parse_directions(std::io::repeat(b'\n'), Limits { bytes: 100_000, ..LIMITS });
        let lines = lines.err().expect("no end").to_string();
        assert!(lines.starts_with("more than 100000 bytes, at line "), "{lines}");
    }

    #[test]
    fn wrong_values_are_quoted_and_cut() {
        let text = format!("x,y,z\n1,\u{1b}[31m{},0\n", "9x".repeat(400));
        let error = error(text.as_bytes(), LIMITS);
        assert!(error.starts_with(r#"line 2: y is "\u{1b}[31m9x9x"#), "{error}");
        assert!(error.ends_with("(805 bytes), not a number") && error.len() < 120, "{error}");
    }
}
