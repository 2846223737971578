//! Temporary files and folders in the outputs' folders, each locked while its process lives.
//!
//! A temporary has a random stem, `.octagloss-` with six letters and digits, and up to three entries in
//! the folder of its output:
//!
//! - `STEM.lock` exists as long as the others do. Its process locks it; it contains the name of the output.
//! - `STEM.new` is the new output; after an exchange it holds the previous one.
//! - `STEM.old` is the previous folder, set aside if two folders cannot be exchanged.
//!
//! A killed process leaves them behind with a free lock; [`recover`] then restores `STEM.old` if its output
//! is missing, and removes the rest.

use super::file_name;
use crate::common::error::{Error, Result};
use std::ffi::{OsStr, OsString};
use std::fs::{self, File, TryLockError};
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::{Builder, NamedTempFile};

const PREFIX: &str = ".octagloss-";
const LOCK: &str = ".lock";
const NEW: &str = ".new";
const OLD: &str = ".old";

/// The temporaries of this process. Locked while outputs are committed.
static LIVE: Mutex<Vec<Names>> = Mutex::new(Vec::new());

/// Exclusive access to the temporaries of this process: no other thread creates, commits or removes one.
pub(super) fn live() -> MutexGuard<'static, Vec<Names>> {
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Paths of a temporary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Names {
    /// Path of the temporary without its suffix.
    stem: PathBuf,
    /// The output.
    place: PathBuf,
}

impl Names {
    fn with(&self, suffix: &str) -> PathBuf {
        let mut name = self.stem.as_os_str().to_owned();
        name.push(suffix);
        name.into()
    }

    /// Removes the temporaries. Restores the folder set aside if the output is missing.
    fn clear(&self) -> io::Result<()> {
        let old = self.with(OLD);
        if exists(&old) && (exists(&self.place) || rename_new(&old, &self.place).is_err()) {
            if !exists(&self.place) {
                return Err(io::Error::other("the output cannot be restored"));
            }
            remove(&old)?;
        }
        remove(&self.with(NEW))
    }
}

/// A file or folder under construction, removed when dropped unless it was renamed.
#[derive(Debug)]
pub(super) struct Temporary {
    names: Names,
    /// Locked; removed last.
    lock: Option<NamedTempFile>,
}

impl Temporary {
    /// Creates an empty temporary in the folder of `place`.
    pub(super) fn beside(place: &Path) -> io::Result<Self> {
        let folder = place.parent().ok_or(io::ErrorKind::InvalidInput)?;
        let name = place.file_name().ok_or(io::ErrorKind::InvalidInput)?;
        let mut live = live();
        for _ in 0..100 {
            let mut lock = Builder::new().prefix(PREFIX).suffix(LOCK).tempfile_in(folder)?;
            // Another process may clean up between creation and locking: then it holds the lock or has
            // removed the file.
            match lock.as_file().try_lock() {
                Err(TryLockError::WouldBlock) => continue,
                Ok(()) if !exists(lock.path()) => continue,
                // Without lock support no process cleans up.
                Ok(()) | Err(TryLockError::Error(_)) => {}
            }
            lock.write_all(name.as_encoded_bytes())?;
            let names = Names { stem: lock.path().with_extension(""), place: place.to_owned() };
            live.push(names.clone());
            return Ok(Self { names, lock: Some(lock) });
        }
        Err(io::Error::other("other processes remove every temporary file"))
    }

    /// Path of the new content.
    pub(super) fn new_path(&self) -> PathBuf {
        self.names.with(NEW)
    }

    /// Path of the folder set aside.
    pub(super) fn old_path(&self) -> PathBuf {
        self.names.with(OLD)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let mut live = live();
        let cleared = self.names.clear();
        if let (Err(_), Some(lock)) = (cleared, self.lock.take()) {
            // The next run tries again.
            let _kept = lock.keep();
        }
        drop(self.lock.take());
        live.retain(|names| *names != self.names);
    }
}

/// Removes every temporary of this process before it exits. Waits for commits in progress; afterwards no
/// thread can create or commit a temporary.
pub fn remove_temporaries() {
    let live = live();
    for names in &*live {
        // Retry: another thread may still be writing into a folder.
        let cleared = (0..100).any(|_| {
            let cleared = names.clear().is_ok();
            if !cleared {
                std::thread::sleep(std::time::Duration::from_millis(1));
            }
            cleared
        });
        if cleared {
            // The next run removes the rest.
            drop(fs::remove_file(names.with(LOCK)));
        }
    }
    std::mem::forget(live);
}

/// Cleans up after killed processes in the folder of the output `path`; returns the outputs that were
/// restored. Temporaries of living processes stay, and so do those that cannot be removed.
pub fn recover(path: &Path) -> Vec<PathBuf> {
    let place = resolved(path).unwrap_or_else(|_| path.to_owned());
    let folder = match place.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let locks = entries.filter(|entry| {
        let name = entry.file_name();
        let name = name.as_encoded_bytes();
        name.starts_with(PREFIX.as_bytes()) && name.ends_with(LOCK.as_bytes())
    });
    locks.filter_map(|entry| recover_one(folder, &entry.path())).collect()
}

/// Cleans up the temporary of the lock file `path` if its lock is free.
fn recover_one(folder: &Path, path: &Path) -> Option<PathBuf> {
    if !fs::symlink_metadata(path).ok()?.is_file() {
        return None;
    }
    let file = File::options().read(true).write(true).open(path).ok()?;
    file.try_lock().ok()?;
    // Through this handle: Windows keeps others from reading what is locked.
    let names = Names { stem: path.with_extension(""), place: folder.join(name_in(&file)?) };
    let restores = exists(&names.with(OLD)) && !exists(&names.place);
    names.clear().ok()?;
    fs::remove_file(path).ok()?;
    restores.then(|| file_name::as_written(&names.place))
}

/// Longest output name in a lock file, in bytes; file systems allow at most 255 characters.
const LONGEST_NAME: u64 = 4096;

/// The output's name in the lock file `file`; `None` if it is none. A process that was killed before it wrote
/// it has no output.
fn name_in(file: &File) -> Option<OsString> {
    let mut bytes = Vec::new();
    file.take(LONGEST_NAME + 1).read_to_end(&mut bytes).ok().filter(|count| *count as u64 <= LONGEST_NAME)?;
    let name = if bytes.is_empty() { OsString::from("unnamed") } else { os_string(bytes)? };
    // Accept plain names only, which cannot reference another folder.
    (Path::new(&name).file_name() == Some(OsStr::new(&name))).then_some(name)
}

#[cfg(unix)]
fn os_string(bytes: Vec<u8>) -> Option<OsString> {
    Some(std::os::unix::ffi::OsStringExt::from_vec(bytes))
}

#[cfg(not(unix))]
fn os_string(bytes: Vec<u8>) -> Option<OsString> {
    String::from_utf8(bytes).ok().map(OsString::from)
}

/// Whether `path` exists, including a dangling link.
pub(super) fn exists(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// Removes the file or folder `path` if it exists.
fn remove(path: &Path) -> io::Result<()> {
    let removed = match fs::symlink_metadata(path) {
        Ok(found) if found.is_dir() => fs::remove_dir_all(path),
        Ok(_) => fs::remove_file(path),
        Err(error) => Err(error),
    };
    match removed {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        // Wine removes folders when they are closed, and says nothing of a file that was made in between.
        Ok(()) if exists(path) => Err(io::ErrorKind::DirectoryNotEmpty.into()),
        other => other,
    }
}

/// Exchanges two files or folders in one step; `None` if the system does not support it.
pub(super) fn exchange(a: &Path, b: &Path) -> Option<io::Result<()>> {
    renamed(a, b, true)
}

/// Renames `from` to `to`, which must not exist.
pub(super) fn rename_new(from: &Path, to: &Path) -> io::Result<()> {
    renamed(from, to, false).unwrap_or_else(|| {
        // Windows refuses access to a folder that another process has made there meanwhile.
        persistently(
            || {
                if exists(to) { Err(io::ErrorKind::AlreadyExists.into()) } else { fs::rename(from, to) }
            },
        )
    })
}

/// Renames `from` to `to`.
pub(super) fn rename(from: &Path, to: &Path) -> io::Result<()> {
    persistently(|| fs::rename(from, to))
}

/// Does `step`. On Windows tries for a second while another program has one of its files open, such as a
/// scanner of new files; then the error says so.
fn persistently(step: impl Fn() -> io::Result<()>) -> io::Result<()> {
    let mut tries = if cfg!(windows) { 20 } else { 0 };
    loop {
        match step() {
            Err(error) if tries > 0 && is_in_use(&error) => {
                tries -= 1;
                std::thread::sleep(std::time::Duration::from_millis(50));
            }
            Err(error) if cfg!(windows) && is_in_use(&error) => {
                let message = format!("{error}; another program may have it open, close it there");
                return Err(io::Error::new(error.kind(), message));
            }
            other => return other,
        }
    }
}

/// Whether Windows refuses access (5), or says that another program uses the file (32, 33).
fn is_in_use(error: &io::Error) -> bool {
    matches!(error.raw_os_error(), Some(5 | 32 | 33))
}

/// Renames `a` to `b`, which must not exist, or exchanges them in one step if it `exchanges`; `None` if the
/// system does not support it.
#[cfg(any(target_os = "linux", target_os = "macos"))]
fn renamed(a: &Path, b: &Path, exchanges: bool) -> Option<io::Result<()>> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    use rustix::io::Errno;
    let flags = if exchanges { RenameFlags::EXCHANGE } else { RenameFlags::NOREPLACE };
    match renameat_with(CWD, a, CWD, b, flags) {
        // Old kernels, and file systems without support.
        Err(Errno::INVAL | Errno::XDEV | Errno::NOSYS | Errno::NOTSUP) => None,
        other => Some(other.map_err(io::Error::from)),
    }
}

#[cfg(not(any(target_os = "linux", target_os = "macos")))]
fn renamed(_: &Path, _: &Path, _: bool) -> Option<io::Result<()>> {
    None
}

/// Resolves the links of the output `path`; its last component need not exist.
///
/// # Errors
/// [`Error::Io`] naming `path`: missing folder, a link loop, or a path to a stream of the program, such as
/// `/dev/stdout`.
pub(super) fn resolved(path: &Path) -> Result<PathBuf> {
    let mut at = path.to_owned();
    if let Some(reason) = path.file_name().and_then(|name| file_name::refusal(&name.to_string_lossy())) {
        return Err(refused(path, &reason));
    }
    // The limit of Linux.
    for _ in 0..40 {
        let folder = folder_of(&at).map_err(|error| with_path(error, path))?;
        let Some(name) = at.file_name() else {
            return fs::canonicalize(&at).map_err(|e| Error::io(path, e));
        };
        let place = fs::canonicalize(folder).map_err(|e| Error::io(path, e))?.join(name);
        if let Some(reason) = unwritable(&at).or_else(|| unwritable(&place)) {
            return Err(refused(path, reason));
        }
        match fs::read_link(&place) {
            Ok(target) => at = place.parent().unwrap_or(Path::new("")).join(target),
            Err(_) => return may_write_beside(&place).map(|()| place).map_err(|e| Error::io(path, e)),
        }
    }
    Err(refused(path, "is a link loop"))
}

/// Checks that files can be made in the folder of `place`: outputs are written beside it and moved.
#[cfg(unix)]
fn may_write_beside(place: &Path) -> io::Result<()> {
    if let Some(folder) = place.parent() {
        use rustix::fs::{Access, access};
        access(folder, Access::WRITE_OK | Access::EXEC_OK).map_err(|error| {
            let error = io::Error::from(error);
            io::Error::new(error.kind(), format!("its folder {}: {error}", folder.display()))
        })?;
    }
    Ok(())
}

/// Other systems say so when the file is made.
#[cfg(not(unix))]
fn may_write_beside(_: &Path) -> io::Result<()> {
    Ok(())
}

/// Why nothing can be written to `path`: it names an open stream, or where the system describes processes.
fn unwritable(path: &Path) -> Option<&'static str> {
    let streams = ["/dev/fd", "/dev/stdin", "/dev/stdout", "/dev/stderr"];
    let describes = cfg!(unix) && path.starts_with("/proc");
    let streams = cfg!(unix) && streams.iter().any(|stream| path.starts_with(stream));
    if streams || (describes && path.iter().any(|name| name == "fd")) {
        return Some("is one of the program's own streams, not a file; name a file");
    }
    describes.then_some("is in /proc, where the system describes processes; name another folder")
}

/// The folder of `path`, which must exist.
fn folder_of(path: &Path) -> Result<&Path> {
    let folder = match path.parent() {
        Some(parent) if parent.as_os_str().is_empty() => Path::new("."),
        Some(parent) => parent,
        None => return Err(refused(path, "cannot be an output; name a file or folder")),
    };
    match fs::metadata(folder) {
        Ok(found) if found.is_dir() => Ok(folder),
        Ok(_) => Err(refused(path, &format!("{} is not a folder", folder.display()))),
        Err(e) => {
            let message = format!("its folder {}: {e}", folder.display());
            Err(Error::io(path, io::Error::new(e.kind(), message)))
        }
    }
}

pub(super) fn refused(path: &Path, message: &str) -> Error {
    Error::io(path, io::Error::new(io::ErrorKind::AlreadyExists, message))
}

/// Replaces the path of `error`.
pub(super) fn with_path(error: Error, path: &Path) -> Error {
    match error {
        Error::Io { error, .. } => Error::io(path, error),
        other => other,
    }
}
