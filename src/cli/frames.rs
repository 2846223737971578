//! Frames of `octagloss query --frames`: a normal, a view and a tangent each, from a file or standard input,
//! as CSV or as a NumPy array (.npy) of six or nine columns.

use super::directions::{LIMITS, csv_reader, line_of, names_of, read_text, shortest, sniffed};
use crate::error::quoted;
use crate::frame::Frame;
use crate::io::npy;
use crate::io::regular::open_regular;
use anyhow::{Context as _, anyhow, bail};
use glam::DVec3;
use std::io::Read;
use std::path::Path;

/// Names of the columns. The tangent may be missing.
const COLUMNS: [&str; 9] = ["nx", "ny", "nz", "vx", "vy", "vz", "tx", "ty", "tz"];

/// A row: its text, and the frame.
pub(super) struct AskedFrame {
    /// Its values, separated by commas.
    pub(super) typed: String,
    pub(super) frame: Frame,
}

/// All rows.
pub(super) struct Frames {
    pub(super) asked: Vec<AskedFrame>,
    /// The header of their text.
    pub(super) header: String,
    /// Whether rows have a tangent.
    pub(super) has_tangents: bool,
}

/// Reads the frames in the file `path`, or from standard input for `-`.
pub(super) fn read_frames(path: &Path) -> anyhow::Result<Frames> {
    if path == Path::new("-") {
        return read_either(std::io::stdin().lock()).context("standard input");
    }
    read_either(open_regular(path)?).with_context(|| path.display().to_string())
}

/// Reads an array or CSV, by the first bytes.
fn read_either(from: impl Read) -> anyhow::Result<Frames> {
    let (is_array, from) = sniffed(from)?;
    if !is_array {
        return parsed(from);
    }
    let table = npy::read_table(from, &[6, 9], LIMITS.rows).map_err(anyhow::Error::msg)?;
    let mut asked = Vec::new();
    for (row, values) in table.values.chunks_exact(table.columns).enumerate() {
        let typed: Vec<String> = values.iter().map(|value| shortest(*value, table.precision)).collect();
        let frame = frame(values).with_context(|| format!("row [{row}]"))?;
        asked.push(AskedFrame { typed: typed.join(","), frame });
    }
    Ok(Frames { asked, header: COLUMNS[..table.columns].join(","), has_tangents: table.columns == 9 })
}

/// Parses frames, one per line.
fn parsed(from: impl Read) -> anyhow::Result<Frames> {
    let needed = format!("{}, and tx,ty,tz for a tangent", COLUMNS[..6].join(","));
    let text = read_text(from, LIMITS, &needed)?;
    let mut reader = csv_reader(&text);
    let mut records = reader.records();
    let header =
        records.next().transpose()?.ok_or_else(|| anyhow!("empty; the first line must be {needed}"))?;
    let names = names_of(&header);
    if names != COLUMNS && names != COLUMNS[..6] {
        bail!("line 1 is {}; the header must be {needed}", quoted(&names.join(",")));
    }
    let mut asked = Vec::new();
    for record in records {
        let record = record?;
        let line = record.position().map_or(0, |position| line_of(position, &text));
        if record.len() != names.len() {
            bail!("line {line} has {} values; its header has {}", record.len(), names.len());
        }
        if asked.len() == LIMITS.rows {
            bail!("more than {} frames, at line {line}; split the file", LIMITS.rows);
        }
        let mut values = Vec::with_capacity(9);
        for (text, name) in record.iter().zip(&names) {
            let value = text.parse();
            values.push(value.map_err(|_| anyhow!("line {line}: {name} is {}, not a number", quoted(text)))?);
        }
        let frame = frame(&values).with_context(|| format!("line {line}"))?;
        asked.push(AskedFrame { typed: record.iter().collect::<Vec<_>>().join(","), frame });
    }
    Ok(Frames { asked, header: names.join(","), has_tangents: names.len() == 9 })
}

/// The frame of a row's values.
fn frame(values: &[f64]) -> anyhow::Result<Frame> {
    if let Some(k) = values.iter().position(|value| !value.is_finite()) {
        bail!("{} is {}; it must be finite", COLUMNS[k], values[k]);
    }
    let vector = |k: usize| DVec3::new(values[k], values[k + 1], values[k + 2]);
    let tangent = if values.len() == 9 { vector(6) } else { DVec3::ZERO };
    Frame::new(vector(0), vector(3), tangent)
        .ok_or_else(|| anyhow!("the normal or the view is 0,0,0, which is not a direction"))
}

#[cfg(test)]
mod tests {
    use super::read_either;

    #[test]
    fn rows_are_frames_and_faults_are_named() {
        let read = read_either(&b"nx,ny,nz,vx,vy,vz\n0,1,0, 0,2,2\n"[..]).expect("a frame");
        assert!(!read.has_tangents && read.asked[0].typed == "0,1,0,0,2,2");
        assert!((read.asked[0].frame.view.z - 0.5_f64.sqrt()).abs() < 1e-15, "n.v");
        for (text, words) in [
            ("", "empty; the first line must be nx,ny,nz,vx,vy,vz, and tx,ty,tz for a tangent"),
            (
                "x,y,z\n",
                "line 1 is \"x,y,z\"; the header must be nx,ny,nz,vx,vy,vz, and tx,ty,tz for a tangent",
            ),
            ("nx,ny,nz,vx,vy,vz\n1,2\n", "line 2 has 2 values; its header has 6"),
            ("nx,ny,nz,vx,vy,vz\n1,2,3,4,5,a\n", "line 2: vz is \"a\", not a number"),
            ("nx,ny,nz,vx,vy,vz\n1,2,3,4,5,inf\n", "line 2: vz is inf; it must be finite"),
            (
                "nx,ny,nz,vx,vy,vz\n0,0,0,4,5,6\n",
                "line 2: the normal or the view is 0,0,0, which is not a direction",
            ),
        ] {
            let error = format!("{:#}", read_either(text.as_bytes()).err().expect("a fault"));
            assert_eq!(error, words);
        }
    }
}
