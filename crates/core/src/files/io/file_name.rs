//! Names and paths of files that differ between systems.

use std::path::{Path, PathBuf};

/// Whether names of files that differ only in case name one file here, as a rule.
const FOLDS_CASE: bool = cfg!(any(windows, target_os = "macos"));

/// A key that is equal for paths of one file.
pub fn path_key(path: &Path) -> PathBuf {
    match path.to_str() {
        Some(text) if FOLDS_CASE => text.to_lowercase().into(),
        _ => path.to_owned(),
    }
}

/// Why Windows refuses `name` for a file; `None` on other systems and for other names. Behind `\\?\`, where
/// outputs are written, Windows would make files that few programs can open or delete.
pub(super) fn refusal(name: &str) -> Option<String> {
    if cfg!(windows) { refused_by_windows(name) } else { None }
}

/// Why Windows has no file of this `name`, with the remedy.
fn refused_by_windows(name: &str) -> Option<String> {
    let why = if let Some(wrong) = name.chars().find(|c| *c < ' ' || r#"<>:"/\|?*"#.contains(*c)) {
        format!("has {wrong:?} in its name, which Windows does not allow")
    } else if name.ends_with(['.', ' ']) {
        "has a name that ends in a full stop or a space, which Windows removes".to_owned()
    } else if let Some(device) = device(name) {
        format!("has the name of a device of Windows, {device}")
    } else {
        return None;
    };
    Some(format!("{why}; choose another"))
}

/// The device that Windows understands `name` as, with any extension.
fn device(name: &str) -> Option<String> {
    let stem = name.split('.').next().unwrap_or(name).trim_end_matches(' ').to_uppercase();
    let is_numbered = || {
        let mut characters = stem.strip_prefix("COM").or_else(|| stem.strip_prefix("LPT"))?.chars();
        let number = characters.next()?;
        (characters.next().is_none() && "123456789\u{b9}\u{b2}\u{b3}".contains(number)).then_some(())
    };
    let is_device = ["CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$"].contains(&stem.as_str());
    (is_device || is_numbered().is_some()).then_some(stem)
}

/// Why an input of this `name` cannot be opened on Windows.
pub(super) fn device_message(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    // Behind this prefix names are only names.
    if !cfg!(windows) || path.as_os_str().to_string_lossy().starts_with(VERBATIM) {
        return None;
    }
    let device = device(name)?;
    Some(format!(
        "Windows takes this name for the device {device}; rename the file, or give its whole path \
         behind {VERBATIM}"
    ))
}

/// Prefix of paths that Windows takes as they are, as it gives them for resolved ones.
const VERBATIM: &str = r"\\?\";

/// Bytes of the start of `path` in which `?` is no wildcard: those of [`VERBATIM`], on Windows.
pub fn verbatim_length(path: &str) -> usize {
    if cfg!(windows) && path.starts_with(VERBATIM) { VERBATIM.len() } else { 0 }
}

/// `path` as people write it: without the prefix that Windows gives resolved paths.
pub(super) fn as_written(path: &Path) -> PathBuf {
    let plain = path.to_str().filter(|_| cfg!(windows)).and_then(without_verbatim);
    plain.map_or_else(|| path.to_owned(), PathBuf::from)
}

/// `path` without [`VERBATIM`], if it has it and means the same without.
fn without_verbatim(path: &str) -> Option<String> {
    let rest = path.strip_prefix(VERBATIM)?;
    let is_drive =
        rest.as_bytes().first().is_some_and(u8::is_ascii_alphabetic) && rest[1..].starts_with(r":\");
    if let Some(share) = rest.strip_prefix(r"UNC\") {
        return Some(format!(r"\\{share}"));
    }
    is_drive.then(|| rest.to_owned())
}

#[cfg(test)]
mod tests {
    use super::{device, refused_by_windows, without_verbatim};

    #[test]
    fn names_that_windows_reserves_are_refused() {
        for name in ["aux.exr", "NUL", "Con.tar.gz", "com1.ktx2", "LPT\u{b3}", "prn .hdr", "conin$"] {
            assert!(device(name).is_some(), "{name}");
            assert!(refused_by_windows(name).is_some_and(|why| why.contains("device")), "{name}");
        }
        for name in ["a:b.ktx2", "what?.exr", "a\tb", "sky.", "sky ", "a|b"] {
            assert!(refused_by_windows(name).is_some(), "{name}");
        }
        for name in ["auxiliary.exr", "com10.exr", "com", "con-1", "a.nul", "sky.ktx2", ".hidden", "lpt0x"] {
            assert_eq!(refused_by_windows(name), None, "{name}");
        }
    }

    #[test]
    fn resolved_paths_are_shown_as_people_write_them() {
        assert_eq!(without_verbatim(r"\\?\C:\sky\a.exr").as_deref(), Some(r"C:\sky\a.exr"));
        assert_eq!(without_verbatim(r"\\?\UNC\host\share\a").as_deref(), Some(r"\\host\share\a"));
        for path in [r"C:\a", r"\\host\share", r"\\?\Volume{1}\a", r"\\?\", "/tmp/a"] {
            assert_eq!(without_verbatim(path), None, "{path}");
        }
    }
}
