//! NumPy's array files (.npy, format versions 1 to 3): reads tables of floats, writes tables of float32.
//!
//! The format is `numpy.lib.format`: a magic number, a version, the length of a header, the header as a
//! literal of a Python dictionary, and the numbers. The header's grammar is a page long; crates for it bring
//! parser generators.

use crate::common::error::quoted;
use serde::Deserialize;
use serde_json::Value;
use std::io::Read;

/// First bytes of every file.
pub const MAGIC: [u8; 6] = *b"\x93NUMPY";

/// Longest header that is read, in bytes; NumPy's own limit.
const LONGEST_HEADER: usize = 10_000;

/// A table of numbers, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Numbers in a row.
    pub columns: usize,
    /// The numbers, in double precision.
    pub values: Vec<f64>,
    /// Their type in the file.
    pub precision: Precision,
}

/// Type of the numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// `float32`.
    Single,
    /// `float64`.
    Double,
}

impl Precision {
    const fn bytes(self) -> usize {
        match self {
            Self::Single => 4,
            Self::Double => 8,
        }
    }
}

/// Reads a table of at most `most_rows` rows, each of a number of columns in `columns`. Memory grows with the
/// bytes that `from` has, not with the sizes in its header.
///
/// # Errors
/// A message that names the fault and the remedy, without the file's name.
pub fn read_table(mut from: impl Read, columns: &[usize], most_rows: usize) -> Result<Table, String> {
    let header = read_header(&mut from)?;
    let Header { big_endian, precision, fortran_order, shape } = parsed(&header)?;
    let needed = || {
        let counts: Vec<_> = columns.iter().map(|count| format!("(N, {count})")).collect();
        counts.join(" or ")
    };
    let [rows, width] = shape[..] else {
        return Err(format!("its shape is {}; {} is needed", shown(&shape), needed()));
    };
    let Some(&width) = columns.iter().find(|count| **count as u64 == width) else {
        return Err(format!("its shape is {}; {} is needed", shown(&shape), needed()));
    };
    let Some(rows) = usize::try_from(rows).ok().filter(|rows| *rows <= most_rows) else {
        return Err(format!("its shape is {}; more than {most_rows} rows, split the array", shown(&shape)));
    };
    let count = rows * width;
    let length = count * precision.bytes();
    let mut bytes = Vec::new();
    // One byte more shows whether the file ends.
    from.take(length as u64 + 1).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    if bytes.len() < length {
        let held = bytes.len();
        return Err(format!("truncated: {held} of the {length} bytes of an array of {}", shown(&shape)));
    }
    if bytes.len() > length {
        return Err(format!("more than the {length} bytes of an array of {}", shown(&shape)));
    }
    let number = |bytes: &[u8]| match (precision, big_endian) {
        (Precision::Single, false) => f32::from_le_bytes(bytes.try_into().expect("4 bytes")).into(),
        (Precision::Single, true) => f32::from_be_bytes(bytes.try_into().expect("4 bytes")).into(),
        (Precision::Double, false) => f64::from_le_bytes(bytes.try_into().expect("8 bytes")),
        (Precision::Double, true) => f64::from_be_bytes(bytes.try_into().expect("8 bytes")),
    };
    let at = |index: usize| number(&bytes[index * precision.bytes()..][..precision.bytes()]);
    let place = |index: usize| match fortran_order {
        false => index,
        true => index % width * rows + index / width,
    };
    let values = (0..count).map(|index| at(place(index))).collect();
    Ok(Table { columns: width, values, precision })
}

/// A file of `values`, row by row, `columns` in a row, as float32.
///
/// # Panics
/// If `values` does not divide into such rows.
pub fn table_bytes(columns: usize, values: &[f32]) -> Vec<u8> {
    assert!(columns > 0 && values.len().is_multiple_of(columns), "rows of {columns} numbers");
    let shape = format!("({}, {columns})", values.len() / columns);
    let mut header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    // The numbers start at a multiple of 64 bytes; the header ends with a line feed.
    let start = (MAGIC.len() + 4 + header.len() + 1).next_multiple_of(64);
    let padding = start - MAGIC.len() - 4 - header.len() - 1;
    header.extend(std::iter::repeat_n(' ', padding));
    header.push('\n');
    let length = u16::try_from(header.len()).expect("a header of two numbers is short");
    let mut bytes = Vec::with_capacity(start + 4 * values.len());
    bytes.extend(MAGIC);
    bytes.extend([1, 0]);
    bytes.extend(length.to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

/// Content of a header.
struct Header {
    big_endian: bool,
    precision: Precision,
    fortran_order: bool,
    shape: Vec<u64>,
}

/// Reads magic number, version and header.
fn read_header(from: &mut impl Read) -> Result<Vec<u8>, String> {
    let mut exact = |bytes: &mut [u8]| {
        from.read_exact(bytes).map_err(|error| match error.kind() {
            std::io::ErrorKind::UnexpectedEof => "truncated within its header".to_owned(),
            _ => error.to_string(),
        })
    };
    let mut start = [0; MAGIC.len() + 2];
    exact(&mut start)?;
    let (magic, version) = start.split_at(MAGIC.len());
    if magic != MAGIC {
        return Err("not a .npy file; save one array with numpy.save".to_owned());
    }
    let bytes = match version[0] {
        1 => 2,
        2 | 3 => 4,
        major => return Err(format!("its format version is {major}.{}; 1 to 3 are known", version[1])),
    };
    let mut length = [0; 4];
    exact(&mut length[..bytes])?;
    let length = u32::from_le_bytes(length) as usize;
    if length > LONGEST_HEADER {
        return Err(format!("its header has {length} bytes; at most {LONGEST_HEADER} are read"));
    }
    let mut header = vec![0; length];
    exact(&mut header)?;
    Ok(header)
}

/// The dictionary of a header: its fields, each of which may be missing.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    descr: Option<Value>,
    fortran_order: Option<bool>,
    shape: Option<Vec<u64>>,
}

/// Parses a header, a literal of Python.
fn parsed(header: &[u8]) -> Result<Header, String> {
    let text = std::str::from_utf8(header).map_err(|_| "its header is not text".to_owned())?;
    let fields: Fields = serde_json::from_str(&json_of(text)).map_err(|error| {
        let rest = text.get(error.column().saturating_sub(1)..).unwrap_or_default();
        format!("its header is not that of an array, at {}", quoted(rest.trim()))
    })?;
    if fields.descr.as_ref().is_some_and(Value::is_array) {
        return Err("it holds records; save an array of float32 or float64".to_owned());
    }
    let Fields { descr: Some(descr), fortran_order: Some(fortran_order), shape: Some(shape) } = fields else {
        return Err("its header lacks one of descr, fortran_order and shape".to_owned());
    };
    let (big_endian, precision) = match descr.as_str().unwrap_or_default() {
        "<f4" => (false, Precision::Single),
        "<f8" => (false, Precision::Double),
        ">f4" => (true, Precision::Single),
        ">f8" => (true, Precision::Double),
        other => {
            return Err(format!(
                "its type is {}; float32 or float64 is needed, as of array.astype(\"float32\")",
                quoted(other)
            ));
        }
    };
    Ok(Header { big_endian, precision, fortran_order, shape })
}

/// JSON that is as long as the literal `text`, with each character at its place.
fn json_of(text: &str) -> String {
    let pairs = [("'", "\""), ("True", "true"), ("False", "false"), ("(", "["), (")", "]"), ("\n", " ")];
    let mut json = pairs.iter().fold(text.to_owned(), |json, (own, other)| json.replace(own, other));
    for at in text.match_indices(',').map(|(at, _)| at) {
        if json[at + 1..].trim_start().starts_with([']', '}']) {
            json.replace_range(at..=at, " ");
        }
    }
    json
}

/// A shape as Python writes it.
fn shown(shape: &[u64]) -> String {
    match shape {
        [one] => format!("({one},)"),
        // A header of 10,000 bytes has room for thousands of dimensions.
        many if many.len() > 8 => format!("of {} dimensions", many.len()),
        many => format!("({})", many.iter().map(u64::to_string).collect::<Vec<_>>().join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file with the header text `header` and `data`.
    fn file(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([version, 0]);
        match version {
            1 => bytes.extend(u16::try_from(header.len()).expect("short").to_le_bytes()),
            _ => bytes.extend(u32::try_from(header.len()).expect("short").to_le_bytes()),
        }
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn error(bytes: &[u8]) -> String {
        read_table(bytes, &[3, 4], 1000).expect_err("an error")
    }

    fn header(descr: &str, order: &str, shape: &str) -> String {
        format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n")
    }

    #[test]
    fn tables_of_every_order_are_read() {
        let numbers = [[1.0, 2.5, -3.0], [4.0, 5.0, 6.25]];
        let rows: Vec<f64> = numbers.as_flattened().to_vec();
        let columns: Vec<f64> = (0..6).map(|k| numbers[k % 2][k / 2]).collect();
        let little = |values: &[f64]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
        let single =
            |values: &[f64]| values.iter().flat_map(|v| (*v as f32).to_be_bytes()).collect::<Vec<u8>>();
        for (version, descr, order, data) in [
            (1, "<f8", "False", little(&rows)),
            (2, "<f8", "True", little(&columns)),
            (3, ">f4", "False", single(&rows)),
            (1, ">f4", "True", single(&columns)),
        ] {
            let bytes = file(version, &header(descr, order, "(2, 3)"), &data);
            let table = read_table(&bytes[..], &[3, 4], 2).expect("readable");
            assert_eq!((table.columns, &table.values), (3, &rows), "{descr} {order}");
            assert_eq!(table.precision == Precision::Single, descr == ">f4");
        }
        // Other writers use other quotes and no last comma.
        let plain = r#"{"shape":(0,4),"fortran_order":False,"descr":"<f4"}"#;
        assert!(read_table(&file(1, plain, &[])[..], &[3, 4], 0).expect("no rows").values.is_empty());
    }

    #[test]
    fn what_is_written_is_read() {
        let values = [0.5, 1e-40, f32::MAX, 3.0, 4.0, 5.0, f32::INFINITY, 0.0];
        let bytes = table_bytes(4, &values);
        assert_eq!(bytes.len() % 64, 4 * values.len() % 64, "the numbers are aligned");
        let table = read_table(&bytes[..], &[4], 2).expect("readable");
        assert_eq!(table.values, values.map(f64::from));
        assert!(read_table(&table_bytes(3, &[])[..], &[3], 0).expect("readable").values.is_empty());
    }

    #[test]
    fn wrong_files_are_named() {
        for (bytes, words) in [
            (b"PK\x03\x04....".to_vec(), "not a .npy file; save one array with numpy.save"),
            (MAGIC.to_vec(), "truncated within its header"),
            (file(9, "", b""), "its format version is 9.0; 1 to 3 are known"),
            (file(2, &" ".repeat(10_001), b""), "its header has 10001 bytes; at most 10000 are read"),
            (
                file(1, &header("<f8", "False", "(2,)"), &[0; 16]),
                "its shape is (2,); (N, 3) or (N, 4) is needed",
            ),
            (file(1, &header("<f8", "False", "(3, 2)"), &[0; 48]), "its shape is (3, 2); (N, 3) or (N, 4)"),
            (file(1, &header("<f8", "False", "()"), &[0; 8]), "its shape is (); (N, 3) or (N, 4) is needed"),
            (file(1, &header("<f8", "False", "(1001, 3)"), b""), "more than 1000 rows, split the array"),
            (
                file(1, &header("<f8", "False", "(18446744073709551615, 3)"), b""),
                "its shape is (18446744073709551615, 3); more than 1000 rows",
            ),
            (file(1, &header("<f8", "False", "(18446744073709551616, 3)"), b""), "not that of an array, at"),
            (file(1, &header("<f8", "False", "(-1, 3)"), b""), "not that of an array, at"),
            (file(1, &header("<f8", "False", "(2 3)"), b""), "not that of an array, at"),
            (file(1, &header("<f8", "False", "(3)"), b""), "its shape is (3,); (N, 3) or (N, 4) is needed"),
            (file(1, &header("<f8", "maybe", "(2, 3)"), b""), "not that of an array, at \"maybe"),
            (file(1, &header("<f8", "False", "(9, 3)"), &[0; 10]), "truncated: 10 of the 216 bytes"),
            (file(1, &header("<f4", "False", "(1, 3)"), &[0; 13]), "more than the 12 bytes"),
            (file(1, &header("<i8", "False", "(1, 3)"), b""), "its type is \"<i8\"; float32 or float64"),
            (file(1, &header("|O", "False", "(1, 3)"), b""), "its type is \"|O\""),
            (file(1, "{'descr': [('x', '<f8')], }", b""), "it holds records"),
            (file(1, "{'descr': '<f8', }", b""), "lacks one of descr, fortran_order and shape"),
            (file(1, "{'descr': '<f8', 'descr': '<f8', }", b""), "not that of an array"),
            (file(1, "{'descr': '<f8'", b""), "not that of an array"),
            (file(1, "{'\u{1b}[2J': 1}", b""), "not that of an array, at"),
            (file(1, "", b""), "not that of an array, at \"\""),
            (file(1, &(header("<f4", "False", "(1, 3)") + "x"), &[0; 12]), "not that of an array, at \"x\""),
        ] {
            let error = error(&bytes);
            assert!(error.contains(words), "{error} lacks {words}");
        }
        let many = format!("({})", "1, ".repeat(3000));
        assert!(
            error(&file(2, &header("<f8", "False", &many), b"")).contains("its shape is of 3000 dimensions")
        );
    }

    #[test]
    fn memory_follows_the_bytes_and_not_the_header() {
        let huge = file(1, &header("<f8", "False", "(4000000000, 3)"), b"none");
        let error = read_table(&huge[..], &[3], usize::MAX >> 8).expect_err("truncated");
        assert_eq!(error, "truncated: 4 of the 96000000000 bytes of an array of (4000000000, 3)");
    }
}
