//! Reads rows of numbers from a file or standard input, within limits: as CSV with a header, or as a NumPy
//! array (.npy).

use crate::queries::unit;
use anyhow::{Context as _, anyhow, bail};
use glam::DVec3;
use octagloss_core::common::error::quoted;
use octagloss_core::common::frame::Frame;
use octagloss_core::files::io::npy::{self, Precision};
use octagloss_core::files::io::regular::open_regular;
use std::io::{BufRead as _, BufReader, Cursor, Read};
use std::path::Path;

/// Limits for a file or standard input, which may be endless.
#[derive(Clone, Copy)]
pub struct Limits {
    /// Number of rows.
    pub rows: usize,
    /// Total bytes.
    pub bytes: usize,
    /// Bytes per line.
    pub line: usize,
}

/// The limits of `--directions` and `--frames`, as in their help.
pub const LIMITS: Limits = Limits { rows: 4_000_000, bytes: 256 << 20, line: 1000 };

/// Rows of one kind: their columns, of which the last may be missing, and what a row is.
pub struct Kind<T> {
    columns: &'static [&'static str],
    /// Number of the columns that every row has.
    required: usize,
    /// Name of many rows.
    plural: &'static str,
    /// Makes a row of finite numbers.
    parse: fn(&[f64]) -> anyhow::Result<T>,
}

/// Rows, in order.
pub struct Rows<T> {
    /// The names of their columns, separated by commas.
    pub header: String,
    /// Whether they have all columns of their kind.
    pub is_full: bool,
    /// The numbers of each, separated by commas.
    pub typed: Vec<String>,
    /// What each is.
    pub values: Vec<T>,
}

/// A unit vector, and its roughness if the rows have that column.
pub type Direction = (DVec3, Option<f64>);

/// The rows of `--directions`: directions, with or without a roughness each.
pub const DIRECTIONS: Kind<Direction> = Kind {
    columns: &["x", "y", "z", "roughness"],
    required: 3,
    plural: "directions",
    parse: |values| {
        let roughness = values.get(3).copied();
        if let Some(roughness) = roughness.filter(|roughness| !(0.0..=1.0).contains(roughness)) {
            bail!("roughness is {roughness}; it must be between 0 and 1");
        }
        let direction = unit(DVec3::new(values[0], values[1], values[2]));
        Ok((direction.ok_or_else(|| anyhow!("0,0,0 is not a direction"))?, roughness))
    },
};

/// The rows of `--frames`: a normal, a view and a tangent each, which may be missing.
pub(super) const FRAMES: Kind<Frame> = Kind {
    columns: &["nx", "ny", "nz", "vx", "vy", "vz", "tx", "ty", "tz"],
    required: 6,
    plural: "frames",
    parse: |values| {
        let vector = |k: usize| DVec3::new(values[k], values[k + 1], values[k + 2]);
        let tangent = if values.len() == 9 { vector(6) } else { DVec3::ZERO };
        Frame::new(vector(0), vector(3), tangent)
            .ok_or_else(|| anyhow!("the normal or the view is 0,0,0, which is not a direction"))
    },
};

impl<T> Kind<T> {
    /// Reads the rows in the file `path`, or from standard input for `-`.
    pub(super) fn read(&self, path: &Path) -> anyhow::Result<Rows<T>> {
        if path == Path::new("-") {
            return self.read_from(std::io::stdin().lock(), LIMITS).context("standard input");
        }
        self.read_from(open_regular(path)?, LIMITS).with_context(|| path.display().to_string())
    }

    /// Reads an array or CSV, by the first bytes.
    ///
    /// # Errors
    /// A message that names the place, the value and the remedy.
    pub fn read_from(&self, mut from: impl Read, limits: Limits) -> anyhow::Result<Rows<T>> {
        let mut start = Vec::new();
        from.by_ref().take(npy::MAGIC.len() as u64).read_to_end(&mut start)?;
        if start.starts_with(b"PK\x03\x04") {
            bail!("a ZIP file such as .npz; save one array with numpy.save");
        }
        let is_array = start == npy::MAGIC;
        let from = Cursor::new(start).chain(from);
        if is_array { self.read_array(from, limits) } else { self.read_csv(from, limits) }
    }

    fn read_array(&self, from: impl Read, limits: Limits) -> anyhow::Result<Rows<T>> {
        let table = npy::read_table(from, &[self.required, self.columns.len()], limits.rows)
            .map_err(anyhow::Error::msg)?;
        let mut rows = self.rows(table.columns);
        for (row, values) in table.values.chunks_exact(table.columns).enumerate() {
            let typed: Vec<String> = values.iter().map(|value| shortest(*value, table.precision)).collect();
            rows.typed.push(typed.join(","));
            rows.values.push(self.value(values).with_context(|| format!("row [{row}]"))?);
        }
        Ok(rows)
    }

    /// Reads rows, one per line.
    fn read_csv(&self, from: impl Read, limits: Limits) -> anyhow::Result<Rows<T>> {
        let required = self.columns[..self.required].join(",");
        let text = read_text(from, limits, &required)?;
        let mut reader = csv_reader(&text);
        let mut records = reader.records();
        let header =
            records.next().transpose()?.ok_or_else(|| anyhow!("empty; the first line must be {required}"))?;
        // Without a byte order mark.
        let names: Vec<&str> = header.iter().map(|name| name.trim_start_matches('\u{feff}')).collect();
        if names != self.columns && names != self.columns[..self.required] {
            let (names, all) = (names.join(","), self.columns.join(","));
            bail!("line 1 is {}; the header must be {required} or {all}", quoted(&names));
        }
        let mut rows = self.rows(names.len());
        for record in records {
            let record = record?;
            let line = record.position().map_or(0, |position| line_of(position, &text));
            if record.len() != names.len() {
                bail!("line {line} has {} values; its header has {}", record.len(), names.len());
            }
            if rows.values.len() == limits.rows {
                bail!("more than {} {}, at line {line}; split the file", limits.rows, self.plural);
            }
            let mut values = Vec::with_capacity(names.len());
            for (text, name) in record.iter().zip(&names) {
                let value = text.parse();
                values.push(
                    value.map_err(|_| anyhow!("line {line}: {name} is {}, not a number", quoted(text)))?,
                );
            }
            rows.typed.push(record.iter().collect::<Vec<_>>().join(","));
            rows.values.push(self.value(&values).with_context(|| format!("line {line}"))?);
        }
        Ok(rows)
    }

    /// No rows yet, of `columns` columns.
    fn rows(&self, columns: usize) -> Rows<T> {
        let header = self.columns[..columns].join(",");
        Rows { header, is_full: columns == self.columns.len(), typed: Vec::new(), values: Vec::new() }
    }

    fn value(&self, values: &[f64]) -> anyhow::Result<T> {
        if let Some(k) = values.iter().position(|value| !value.is_finite()) {
            bail!("{} is {}; it must be finite", self.columns[k], values[k]);
        }
        (self.parse)(values)
    }
}

/// The shortest text that is the same number.
fn shortest(value: f64, precision: Precision) -> String {
    match precision {
        Precision::Single => (value as f32).to_string(),
        Precision::Double => value.to_string(),
    }
}

/// Reads CSV of any number of columns, the header as the first record.
fn csv_reader(text: &[u8]) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new().has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(text)
}

/// Reads all of `from`, lines of `columns`; stops at the first exceeded limit.
fn read_text(from: impl Read, limits: Limits, columns: &str) -> anyhow::Result<Vec<u8>> {
    let mut from = BufReader::with_capacity(64 << 10, from);
    let mut text = Vec::new();
    for line in 1_u64.. {
        let most = limits.line as u64 + 1;
        let count = from.by_ref().take(most).read_until(b'\n', &mut text)?;
        if count > limits.line && !text.ends_with(b"\n") {
            bail!("line {line} is longer than {} bytes; a line is {columns}", limits.line);
        }
        if text.len() > limits.bytes {
            bail!("more than {} bytes, at line {line}; split the file", limits.bytes);
        }
        if count == 0 {
            break;
        }
    }
    Ok(text)
}

/// The line of a record; its position is that of the empty lines before it.
fn line_of(position: &csv::Position, text: &[u8]) -> u64 {
    let rest = text.get(position.byte() as usize..).unwrap_or_default();
    let empty = rest.iter().take_while(|byte| b"\r\n".contains(byte)).filter(|byte| **byte == b'\n').count();
    position.line() + empty as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &[u8], limits: Limits) -> String {
        match DIRECTIONS.read_from(text, limits) {
            Ok(read) => panic!("{} directions were read", read.values.len()),
            Err(error) => format!("{error:#}"),
        }
    }

    #[test]
    fn limits_stop_what_has_no_end() {
        let few = Limits { rows: 2, bytes: 30, line: 10 };
        assert_eq!(DIRECTIONS.read_from(&b"x,y,z\n1,0,0\n0,1,0\n"[..], few).expect("within").values.len(), 2);
        let rows = error(b"x,y,z\n1,0,0\n0,1,0\n0,0,1\n", few);
        assert_eq!(rows, "more than 2 directions, at line 4; split the file");
        let endless = DIRECTIONS.read_from(std::io::repeat(0), LIMITS).err().expect("no end").to_string();
        assert_eq!(endless, "line 1 is longer than 1000 bytes; a line is x,y,z");
        let lines = DIRECTIONS.read_from(std::io::repeat(b'\n'), Limits { bytes: 100_000, ..LIMITS });
        let lines = lines.err().expect("no end").to_string();
        assert!(lines.starts_with("more than 100000 bytes, at line "), "{lines}");
    }

    #[test]
    fn rows_may_have_a_roughness() {
        let read =
            DIRECTIONS.read_from(&b"x,y,z,roughness\n1,0,0, .25\n0,2,0,1\n"[..], LIMITS).expect("two rows");
        assert!(read.is_full);
        assert_eq!(read.typed, ["1,0,0,.25", "0,2,0,1"]);
        let roughness: Vec<_> = read.values.iter().map(|(_, roughness)| *roughness).collect();
        assert_eq!(roughness, [Some(0.25), Some(1.0)]);
        assert!(!DIRECTIONS.read_from(&b"x,y,z\n"[..], LIMITS).expect("no rows").is_full);
        for (text, words) in [
            ("x,y,z,roughness\n1,0,0\n", "line 2 has 3 values; its header has 4"),
            ("x,y,z\n1,0,0,1\n", "line 2 has 4 values; its header has 3"),
            ("x,y,z,roughness\n1,0,0,1.5\n", "line 2: roughness is 1.5; it must be between 0 and 1"),
            ("x,y,z,roughness\n1,0,0,nan\n", "line 2: roughness is NaN; it must be finite"),
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

    #[test]
    fn rows_are_frames_and_faults_are_named() {
        let read = FRAMES.read_from(&b"nx,ny,nz,vx,vy,vz\n0,1,0, 0,2,2\n"[..], LIMITS).expect("a frame");
        assert!(!read.is_full && read.typed[0] == "0,1,0,0,2,2");
        assert!((read.values[0].view.z - 0.5_f64.sqrt()).abs() < 1e-15, "n.v");
        for (text, words) in [
            ("", "empty; the first line must be nx,ny,nz,vx,vy,vz"),
            (
                "x,y,z\n",
                "line 1 is \"x,y,z\"; the header must be nx,ny,nz,vx,vy,vz or nx,ny,nz,vx,vy,vz,tx,ty,tz",
            ),
            ("nx,ny,nz,vx,vy,vz\n1,2\n", "line 2 has 2 values; its header has 6"),
            ("nx,ny,nz,vx,vy,vz\n1,2,3,4,5,a\n", "line 2: vz is \"a\", not a number"),
            ("nx,ny,nz,vx,vy,vz\n1,2,3,4,5,inf\n", "line 2: vz is inf; it must be finite"),
            (
                "nx,ny,nz,vx,vy,vz\n0,0,0,4,5,6\n",
                "line 2: the normal or the view is 0,0,0, which is not a direction",
            ),
        ] {
            let error = format!("{:#}", FRAMES.read_from(text.as_bytes(), LIMITS).err().expect("a fault"));
            assert_eq!(error, words);
        }
    }
}
