//! Reads directions, with or without a roughness each, from a file or standard input, within limits: as CSV
//! with the header `x,y,z` or `x,y,z,roughness`, or as a NumPy array (.npy) of three or four columns.

use crate::direction::unit;
use crate::error::quoted;
use crate::io::npy::{self, Precision};
use crate::io::regular::open_regular;
use anyhow::{Context as _, anyhow, bail};
use glam::DVec3;
use std::io::{Cursor, Read};
use std::path::Path;

/// A row: its text and its parsed values.
pub struct Asked {
    /// Its values, separated by commas.
    pub typed: String,
    /// Unit vector.
    pub direction: DVec3,
    /// Roughness, if the rows have that column.
    pub roughness: Option<f64>,
}

/// All rows.
pub struct Directions {
    /// The rows, in order.
    pub asked: Vec<Asked>,
    /// Whether each row has its own roughness.
    pub has_roughness: bool,
}

/// Limits for a file or standard input, which may be endless.
#[derive(Clone, Copy)]
pub struct Limits {
    /// Number of directions.
    pub rows: usize,
    /// Total bytes.
    pub bytes: usize,
    /// Bytes per line.
    pub line: usize,
}

/// The limits of `--directions`, as in its help.
pub const LIMITS: Limits = Limits { rows: 4_000_000, bytes: 256 << 20, line: 1000 };

/// Reads the directions in the file `path`, or from standard input for `-`.
pub(super) fn read_directions(path: &Path) -> anyhow::Result<Directions> {
    if path == Path::new("-") {
        return read_either(std::io::stdin().lock(), LIMITS).context("standard input");
    }
    read_either(open_regular(path)?, LIMITS).with_context(|| path.display().to_string())
}

/// Reads an array or CSV, by the first bytes.
///
/// # Errors
/// A message that names the place, the value and the remedy.
pub fn read_either(from: impl Read, limits: Limits) -> anyhow::Result<Directions> {
    let (is_array, from) = sniffed(from)?;
    if is_array { array_directions(from, limits) } else { parse_directions(from, limits) }
}

/// Whether `from` is a NumPy array, by its first bytes, and all of it.
pub(super) fn sniffed(mut from: impl Read) -> anyhow::Result<(bool, impl Read)> {
    let mut start = Vec::new();
    from.by_ref().take(npy::MAGIC.len() as u64).read_to_end(&mut start)?;
    if start.starts_with(b"PK\x03\x04") {
        bail!("a ZIP file such as .npz; save one array with numpy.save");
    }
    Ok((start == npy::MAGIC, Cursor::new(start).chain(from)))
}

/// Parses directions as the rows of an array.
fn array_directions(from: impl Read, limits: Limits) -> anyhow::Result<Directions> {
    let table = npy::read_table(from, &[3, 4], limits.rows).map_err(anyhow::Error::msg)?;
    let has_roughness = table.columns == 4;
    let mut asked = Vec::with_capacity(table.values.len() / table.columns);
    for (row, values) in table.values.chunks_exact(table.columns).enumerate() {
        if let Some(column) = values.iter().position(|value| !value.is_finite()) {
            bail!("element [{row}, {column}] is {}; it must be finite", values[column]);
        }
        let roughness = values.get(3).copied();
        if let Some(roughness) = roughness.filter(|roughness| !(0.0..=1.0).contains(roughness)) {
            bail!("element [{row}, 3] is {roughness}; a roughness must be between 0 and 1");
        }
        let Some(direction) = unit(DVec3::new(values[0], values[1], values[2])) else {
            bail!("row [{row}] is 0, 0, 0, which is not a direction");
        };
        let typed =
            values.iter().map(|value| shortest(*value, table.precision)).collect::<Vec<_>>().join(",");
        asked.push(Asked { typed, direction, roughness });
    }
    Ok(Directions { asked, has_roughness })
}

/// The shortest text that is the same number.
pub(super) fn shortest(value: f64, precision: Precision) -> String {
    match precision {
        Precision::Single => (value as f32).to_string(),
        Precision::Double => value.to_string(),
    }
}

/// Parses directions, one per line.
fn parse_directions(from: impl Read, limits: Limits) -> anyhow::Result<Directions> {
    let text = read_text(from, limits, "x,y,z")?;
    let mut reader = csv_reader(&text);
    let mut records = reader.records();
    let header = records.next().transpose()?.ok_or_else(|| anyhow!("empty; the first line must be x,y,z"))?;
    let names = names_of(&header);
    let has_roughness = match names[..] {
        ["x", "y", "z"] => false,
        ["x", "y", "z", "roughness"] => true,
        _ => bail!("line 1 is {}; the header must be x,y,z or x,y,z,roughness", quoted(&names.join(","))),
    };
    let mut asked = Vec::new();
    for record in records {
        let record = record?;
        let line = record.position().map_or(0, |position| line_of(position, &text));
        match (record.len(), has_roughness) {
            (3, false) | (4, true) => {}
            (count, false) => bail!("line {line} has {count} values; x,y,z needs three"),
            (count, true) => bail!("line {line} has {count} values; x,y,z,roughness needs four"),
        }
        if asked.len() == limits.rows {
            bail!("more than {} directions, at line {line}; split the file", limits.rows);
        }
        let mut values = [0.0_f64; 4];
        for ((value, text), name) in values.iter_mut().zip(&record).zip(names.iter()) {
            *value =
                text.parse().map_err(|_| anyhow!("line {line}: {name} is {}, not a number", quoted(text)))?;
            if !value.is_finite() {
                bail!("line {line}: {name} is {}; it must be finite", quoted(text));
            }
        }
        let [x, y, z, roughness] = values;
        if !(0.0..=1.0).contains(&roughness) {
            bail!("line {line}: roughness is {}; it must be between 0 and 1", quoted(&record[3]));
        }
        let Some(direction) = unit(DVec3::new(x, y, z)) else {
            bail!("line {line}: 0,0,0 is not a direction");
        };
        asked.push(Asked {
            typed: record.iter().collect::<Vec<_>>().join(","),
            direction,
            roughness: has_roughness.then_some(roughness),
        });
    }
    Ok(Directions { asked, has_roughness })
}

/// Reads CSV of any number of columns, the header as the first record.
pub(super) fn csv_reader(text: &[u8]) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new().has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(text)
}

/// The names in a header, without a byte order mark.
pub(super) fn names_of(header: &csv::StringRecord) -> Vec<&str> {
    header.iter().map(|name| name.trim_start_matches('\u{feff}')).collect()
}

/// Reads all of `from`, lines of `columns`; stops at the first exceeded limit.
pub(super) fn read_text(mut from: impl Read, limits: Limits, columns: &str) -> anyhow::Result<Vec<u8>> {
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
                bail!("line {line} is longer than {} bytes; a line is {columns}", limits.line);
            }
        }
        if count > limits.bytes - text.len() {
            bail!("more than {} bytes, at line {line}; split the file", limits.bytes);
        }
        text.extend_from_slice(&chunk[..count]);
    }
}

/// The line of a record; its position is that of the empty lines before it.
pub(super) fn line_of(position: &csv::Position, text: &[u8]) -> u64 {
    let rest = text.get(position.byte() as usize..).unwrap_or_default();
    let empty = rest.iter().take_while(|byte| b"\r\n".contains(byte)).filter(|byte| **byte == b'\n').count();
    position.line() + empty as u64
}

#[cfg(test)]
mod tests {
    use super::{LIMITS, Limits, parse_directions};

    fn error(text: &[u8], limits: Limits) -> String {
        match parse_directions(text, limits) {
            Ok(read) => panic!("{} directions were read", read.asked.len()),
            Err(error) => format!("{error:#}"),
        }
    }

    #[test]
    fn limits_stop_what_has_no_end() {
        let few = Limits { rows: 2, bytes: 30, line: 10 };
        assert_eq!(parse_directions(&b"x,y,z\n1,0,0\n0,1,0\n"[..], few).expect("within").asked.len(), 2);
        let rows = error(b"x,y,z\n1,0,0\n0,1,0\n0,0,1\n", few);
        assert_eq!(rows, "more than 2 directions, at line 4; split the file");
        let endless = parse_directions(std::io::repeat(0), LIMITS).err().expect("no end").to_string();
        assert_eq!(endless, "line 1 is longer than 1000 bytes; a line is x,y,z");
        let lines = parse_directions(std::io::repeat(b'\n'), Limits { bytes: 100_000, ..LIMITS });
        let lines = lines.err().expect("no end").to_string();
        assert!(lines.starts_with("more than 100000 bytes, at line "), "{lines}");
    }

    #[test]
    fn rows_may_have_a_roughness() {
        let read =
            parse_directions(&b"x,y,z,roughness\n1,0,0, .25\n0,2,0,1\n"[..], LIMITS).expect("two rows");
        assert!(read.has_roughness);
        let rows: Vec<_> = read.asked.iter().map(|asked| (&asked.typed[..], asked.roughness)).collect();
        assert_eq!(rows, [("1,0,0,.25", Some(0.25)), ("0,2,0,1", Some(1.0))]);
        assert!(!parse_directions(&b"x,y,z\n"[..], LIMITS).expect("no rows").has_roughness);
        for (text, words) in [
            ("x,y,z,roughness\n1,0,0\n", "line 2 has 3 values; x,y,z,roughness needs four"),
            ("x,y,z\n1,0,0,1\n", "line 2 has 4 values; x,y,z needs three"),
            ("x,y,z,roughness\n1,0,0,1.5\n", "line 2: roughness is \"1.5\"; it must be between 0 and 1"),
            ("x,y,z,roughness\n1,0,0,nan\n", "line 2: roughness is \"nan\"; it must be finite"),
            ("x,y,z,r\n", "line 1 is \"x,y,z,r\"; the header must be x,y,z or x,y,z,roughness"),
        ] {
            assert_eq!(error(text.as_bytes(), LIMITS), words);
        }
    }

    #[test]
    fn wrong_values_are_quoted_and_cut() {
        let text = format!("x,y,z\n1,\u{1b}[31m{},0\n", "9x".repeat(400));
        let error = error(text.as_bytes(), LIMITS);
        assert!(error.starts_with(r#"line 2: y is "\u{1b}[31m9x9x"#), "{error}");
        assert!(error.ends_with("(805 bytes), not a number") && error.len() < 120, "{error}");
    }
}
