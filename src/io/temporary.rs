//! Temporary files and folders beside outputs, each held by a lock while its process lives.
//!
//! A temporary has a random stem `.octagloss-XXXXXX` and up to three entries in the folder of its output:
//!
//! - `STEM.lock` exists as long as the others do. Its process locks it; it holds the name of the output.
//! - `STEM.new` is written, and after an exchange holds what was replaced.
//! - `STEM.old` is a folder that is set aside where two folders cannot be exchanged.
//!
//! A killed process leaves them behind with a free lock; [`recover`] then puts `STEM.old` back where its
//! output is missing and removes the rest.

use super::regular::read_regular;
use crate::error::{Error, Result};
use std::ffi::{OsStr, OsString};
use std::fs::{self, File, TryLockError};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::{Builder, NamedTempFile};

const PREFIX: &str = ".octagloss-";
const LOCK: &str = ".lock";
const NEW: &str = ".new";
const OLD: &str = ".old";

/// The temporaries of this process. Held while outputs are put into their places.
static LIVE: Mutex<Vec<Names>> = Mutex::new(Vec::new());

/// The temporaries of this process while nobody else creates, commits or removes one.
pub(super) struct Live(MutexGuard<'static, Vec<Names>>);

impl Live {
    pub(super) fn hold() -> Self {
        Self(LIVE.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Paths of a temporary.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Names {
    /// The path of the temporary without its suffix.
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

    /// Removes what the process no longer needs. Puts back what was set aside where the output is missing.
    fn clear(&self) -> io::Result<()> {
        let old = self.with(OLD);
        if exists(&old) && (exists(&self.place) || rename_new(&old, &self.place).is_err()) {
            if !exists(&self.place) {
                return Err(io::Error::other("the output cannot be put back"));
            }
            remove(&old)?;
        }
        remove(&self.with(NEW))
    }
}

/// A file or folder in the making, removed when dropped unless it was renamed.
#[derive(Debug)]
pub(super) struct Temporary {
    names: Names,
    /// Locked; removed last.
    lock: Option<NamedTempFile>,
}

impl Temporary {
    /// A temporary in the folder of `place`, without content as yet.
    pub(super) fn beside(place: &Path) -> io::Result<Self> {
        let folder = place.parent().ok_or(io::ErrorKind::InvalidInput)?;
        let name = place.file_name().ok_or(io::ErrorKind::InvalidInput)?;
        let mut live = Live::hold();
        for _ in 0..100 {
            let mut lock = Builder::new().prefix(PREFIX).suffix(LOCK).tempfile_in(folder)?;
            // Another process may clean up between creating and locking: it holds the lock or has removed the
            // file.
            match lock.as_file().try_lock() {
                Err(TryLockError::WouldBlock) => continue,
                Ok(()) if !exists(lock.path()) => continue,
                // Without locks nobody cleans up.
                Ok(()) | Err(TryLockError::Error(_)) => {}
            }
            lock.write_all(name.as_encoded_bytes())?;
            let names = Names { stem: lock.path().with_extension(""), place: place.to_owned() };
            live.0.push(names.clone());
            return Ok(Self { names, lock: Some(lock) });
        }
        Err(io::Error::other("other processes remove every temporary file"))
    }

    /// Path of the new content.
    pub(super) fn new_path(&self) -> PathBuf {
        self.names.with(NEW)
    }

    /// Path of what is set aside.
    pub(super) fn old_path(&self) -> PathBuf {
        self.names.with(OLD)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let mut live = Live::hold();
        let cleared = self.names.clear();
        if let (Err(_), Some(lock)) = (cleared, self.lock.take()) {
            // The next run tries again.
            let _kept = lock.keep();
        }
        drop(self.lock.take());
        live.0.retain(|names| *names != self.names);
    }
}

/// Removes every temporary of this process, and lets no other thread create or commit one from then on: for a
/// process that is about to exit. Outputs that are being put into their places are completed first.
pub fn remove_temporaries() {
    let live = Live::hold();
    for names in &*live.0 {
        // Another thread may still write into a folder, which then is not empty.
        let cleared = (0..100).any(|_| {
            let cleared = names.clear().is_ok();
            if !cleared {
                std::thread::sleep(std::time::Duration::from_millis(1));
            }
            cleared
        });
        if cleared {
            // What cannot be removed is left for the next run.
            drop(fs::remove_file(names.with(LOCK)));
        }
    }
    std::mem::forget(live);
}

/// Cleans up after killed processes in the folder of the output `path`; the outputs that were put back.
/// Temporaries of living processes are left alone. What cannot be cleaned up stays.
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

/// Cleans up the temporary of the lock file `path`, where its lock is free.
fn recover_one(folder: &Path, path: &Path) -> Option<PathBuf> {
    if !fs::symlink_metadata(path).ok()?.is_file() {
        return None;
    }
    let file = File::options().read(true).write(true).open(path).ok()?;
    file.try_lock().ok()?;
    let names = Names { stem: path.with_extension(""), place: folder.join(name_in(path)?) };
    let restores = exists(&names.with(OLD)) && !exists(&names.place);
    names.clear().ok()?;
    fs::remove_file(path).ok()?;
    restores.then_some(names.place)
}

/// Bytes of the longest name that a lock file holds: file systems have at most 255 characters.
const LONGEST_NAME: u64 = 4096;

/// The output's name in the lock file `path`; a process killed at the start has not written it.
fn name_in(path: &Path) -> Option<OsString> {
    let bytes = read_regular(path, LONGEST_NAME).ok()?;
    let name = if bytes.is_empty() { OsString::from("unnamed") } else { os_string(bytes)? };
    // A plain name: no other folder is reached.
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

/// Whether there is anything at `path`, a link that leads nowhere included.
pub(super) fn exists(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// Removes the file or folder `path`, where it exists.
fn remove(path: &Path) -> io::Result<()> {
    let removed = match fs::symlink_metadata(path) {
        Ok(found) if found.is_dir() => fs::remove_dir_all(path),
        Ok(_) => fs::remove_file(path),
        Err(error) => Err(error),
    };
    match removed {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        other => other,
    }
}

/// Exchanges two files or folders in one step; `None` where the system cannot.
pub(super) fn exchange(a: &Path, b: &Path) -> Option<io::Result<()>> {
    renamed(a, b, Flag::Exchange)
}

/// Renames `from` to `to`, which must not exist.
pub(super) fn rename_new(from: &Path, to: &Path) -> io::Result<()> {
    renamed(from, to, Flag::NoReplace).unwrap_or_else(|| {
        if exists(to) { Err(io::ErrorKind::AlreadyExists.into()) } else { fs::rename(from, to) }
    })
}

#[derive(Clone, Copy)]
enum Flag {
    Exchange,
    NoReplace,
}

#[cfg(any(target_os = "linux", target_os = "macos"))]
fn renamed(a: &Path, b: &Path, flag: Flag) -> Option<io::Result<()>> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    use rustix::io::Errno;
    let flags = match flag {
        Flag::Exchange => RenameFlags::EXCHANGE,
        Flag::NoReplace => RenameFlags::NOREPLACE,
    };
    match renameat_with(CWD, a, CWD, b, flags) {
        // Old kernels, and file systems that cannot.
        Err(Errno::INVAL | Errno::XDEV | Errno::NOSYS | Errno::NOTSUP) => None,
        other => Some(other.map_err(io::Error::from)),
    }
}

#[cfg(not(any(target_os = "linux", target_os = "macos")))]
fn renamed(_: &Path, _: &Path, flag: Flag) -> Option<io::Result<()>> {
    match flag {
        Flag::Exchange | Flag::NoReplace => None,
    }
}

/// The place of the output `path` without links; its last part need not exist.
///
/// # Errors
/// [`Error::Io`] naming `path`: no folder to hold it, links in a circle, or a path that leads to a stream of
/// the process, such as `/dev/stdout`.
pub(super) fn resolved(path: &Path) -> Result<PathBuf> {
    let mut at = path.to_owned();
    // As many links as Linux follows.
    for _ in 0..40 {
        let folder = folder_of(&at).map_err(|error| with_path(error, path))?;
        let Some(name) = at.file_name() else {
            return fs::canonicalize(&at).map_err(|e| Error::io(path, e));
        };
        let place = fs::canonicalize(folder).map_err(|e| Error::io(path, e))?.join(name);
        if is_stream(&at) || is_stream(&place) {
            return Err(refused(path, "leads to a stream of the process; -o - writes to standard output"));
        }
        match fs::read_link(&place) {
            Ok(target) => at = place.parent().unwrap_or(Path::new("")).join(target),
            Err(_) => return Ok(place),
        }
    }
    Err(refused(path, "is a link that leads in a circle"))
}

/// Whether `path` names an open file of the process rather than a place for an output.
fn is_stream(path: &Path) -> bool {
    let streams = ["/proc", "/dev/fd", "/dev/stdin", "/dev/stdout", "/dev/stderr"];
    cfg!(unix) && streams.iter().any(|stream| path.starts_with(stream))
}

/// The folder that is to hold `path`, which must be there.
fn folder_of(path: &Path) -> Result<&Path> {
    let folder = match path.parent() {
        Some(parent) if parent.as_os_str().is_empty() => Path::new("."),
        Some(parent) => parent,
        None => return Err(refused(path, "is no place for an output; name a file or folder in one")),
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

/// `error` about `path`.
pub(super) fn with_path(error: Error, path: &Path) -> Error {
    match error {
        Error::Io { error, .. } => Error::io(path, error),
        other => other,
    }
}
