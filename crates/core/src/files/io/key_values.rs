//! Key/value pairs of headers, and their encoding in KTX 1 and KTX 2: a length, the key and a text value,
//! both NUL-terminated.

use crate::common::error::{Result, wrong};

/// The value of `key`.
pub(super) fn value_of<'a>(pairs: &'a [(String, String)], key: &str) -> Option<&'a str> {
    pairs.iter().find(|(own, _)| own == key).map(|(_, value)| value.as_str())
}

/// Encodes `pairs` in the given order, each padded to four bytes; `format` names the file format in messages.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for keys that are empty, contain a NUL or are duplicated.
pub(super) fn key_value_bytes(format: &str, pairs: &[(&str, &str)]) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    for (index, (key, value)) in pairs.iter().enumerate() {
        if key.is_empty() || key.contains('\0') {
            return wrong(format!("{key:?} cannot be a key of {format} metadata"));
        }
        if pairs[..index].iter().any(|(other, _)| other == key) {
            return wrong(format!("the {format} metadata has {key:?} twice"));
        }
        bytes.extend((key.len() as u32 + 1 + value.len() as u32 + 1).to_le_bytes());
        for text in [key, value] {
            bytes.extend(text.as_bytes());
            bytes.push(0);
        }
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    Ok(bytes)
}
