//! Opens input files. Only regular files are read: a pipe may block, and a device may be endless.

use super::file_name::device_message;
use crate::common::error::{Error, Result};
use std::fs::{File, Metadata, OpenOptions};
use std::io::Read as _;
use std::path::Path;

/// Opens the regular file `path` for reading, without waiting for a writer of a named pipe.
///
/// The file type is checked on the open handle; a check of the path before opening would be a race.
///
/// # Errors
/// [`Error::Io`] for system errors, [`Error::Input`] for a folder, a pipe, a socket or a device.
pub fn open_regular(path: &Path) -> Result<File> {
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt as _;
        options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits() as i32);
    }
    let file = options.open(path).map_err(|error| refused(path, error))?;
    let kind = file.metadata().map_err(|error| refused(path, error))?.file_type();
    if kind.is_file() {
        return Ok(file);
    }
    Err(Error::input(path, not_regular(kind)))
}

/// What is wrong with a file that another program writes to.
pub const CHANGED: &str = "it changed while it was read; run again";

/// Reads the regular file `path`, of at most `limit` bytes.
///
/// # Errors
/// As [`open_regular`]; [`Error::Limit`] for a larger file, including one that grows while it is read;
/// [`Error::Input`] if another program writes to it meanwhile.
pub fn read_regular(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let file = open_regular(path)?;
    let metadata = || file.metadata().map_err(|error| Error::io(path, error));
    let before = metadata()?;
    let length = before.len();
    let too_large = |length| Error::Limit {
        what: format!("{}: the file", path.display()),
        needed: length,
        available: limit,
        remedy: "give a smaller one".to_owned(),
    };
    if length > limit {
        return Err(too_large(length));
    }
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
    (&file).take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(|error| Error::io(path, error))?;
    if bytes.len() as u64 > limit {
        return Err(too_large(bytes.len() as u64));
    }
    let after = metadata()?;
    if (after.len(), after.modified().ok()) != (length, before.modified().ok()) {
        return Err(Error::input(path, CHANGED));
    }
    Ok(bytes)
}

/// Metadata of the input `path`.
///
/// # Errors
/// [`Error::Io`], or [`Error::Input`] for a name that the system takes for a device.
pub fn metadata(path: &Path) -> Result<Metadata> {
    match std::fs::metadata(path) {
        // Some versions of Windows take fewer names for devices.
        Ok(found) if found.is_dir() || found.len() > 0 => Ok(found),
        found => match device_message(path) {
            Some(message) => Err(Error::input(path, message)),
            None => found.map_err(|error| Error::io(path, error)),
        },
    }
}

/// Error for a path that could not be opened. Sockets have their own message; the system's does not mention
/// sockets.
fn refused(path: &Path, error: std::io::Error) -> Error {
    match metadata(path) {
        Err(Error::Input { path, message }) => Error::Input { path, message },
        Ok(metadata) if !metadata.is_file() => Error::input(path, not_regular(metadata.file_type())),
        _ => Error::io(path, error),
    }
}

/// Message for a path that is not a regular file, with the remedy.
fn not_regular(kind: std::fs::FileType) -> String {
    if kind.is_dir() {
        return "a directory where a file is needed".to_owned();
    }
    #[cfg(unix)]
    let name = {
        use std::os::unix::fs::FileTypeExt as _;
        match kind {
            kind if kind.is_fifo() => "a named pipe",
            kind if kind.is_socket() => "a socket",
            kind if kind.is_char_device() || kind.is_block_device() => "a device",
            _ => "a special file",
        }
    };
    #[cfg(not(unix))]
    let name = "a special file";
    format!("{name}, not a regular file; copy its content to a file first")
}

#[cfg(test)]
mod tests {
    use super::{open_regular, read_regular};
    use crate::common::error::Error;

    #[test]
    fn files_are_read_up_to_their_limit() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("file");
        std::fs::write(&path, b"12345").expect("a file");
        assert_eq!(read_regular(&path, 5).expect("as long as the limit"), b"12345");
        assert!(matches!(read_regular(&path, 4), Err(Error::Limit { needed: 5, available: 4, .. })));
        let missing = open_regular(&folder.path().join("none")).expect_err("there is no such file");
        assert!(matches!(missing, Error::Io { .. }), "{missing}");
    }

    #[test]
    fn what_is_no_file_is_named() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let error = open_regular(folder.path()).expect_err("a directory").to_string();
        assert!(error.ends_with("a directory where a file is needed"), "{error}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn pipes_sockets_and_devices_are_refused_at_once() {
        use rustix::fs::{CWD, FileType, Mode, mknodat};
        use std::path::Path;
        let folder = tempfile::tempdir().expect("a temporary folder");
        let pipe = folder.path().join("pipe");
        mknodat(CWD, &pipe, FileType::Fifo, Mode::from_raw_mode(0o600), 0).expect("a pipe");
        let socket = folder.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).expect("a socket");
        for (path, name) in
            [(pipe.as_path(), "a named pipe"), (&socket, "a socket"), (Path::new("/dev/zero"), "a device")]
        {
            let error = open_regular(path).expect_err("not a file").to_string();
            let expected = format!("{}: {name}, not a regular file", path.display());
            assert!(error.starts_with(&expected), "{error}");
        }
        // Files in /proc report no length; the content must still be read.
        if let Ok(bytes) = read_regular(Path::new("/proc/self/status"), 1 << 20) {
            assert!(!bytes.is_empty(), "the content is read");
            assert!(matches!(read_regular(Path::new("/proc/self/status"), 10), Err(Error::Limit { .. })));
        }
    }
}
