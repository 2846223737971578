//! Outputs that appear whole or not at all: written beside their place under a temporary name, then renamed into it.

use crate::error::{Error, Result};
use crate::target::{self, Target};
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, TempDir};

/// What to do about an output that is already there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// Leave it alone and fail.
    #[default]
    Keep,
    /// Replace it once the new one is complete (`--force`).
    Replace,
}

/// Temporary names start with this, in the folder of the output.
const TEMPORARY_PREFIX: &str = ".octagloss-";

/// Writes the file `path` by `write`; nothing is left behind, and an existing file is untouched, where that fails.
///
/// # Errors
/// [`Error::Io`] naming `path`: no folder to hold it, no permission, no space, already there and
/// [`Existing::Keep`], or not a regular file.
pub fn write_file(
    path: &Path,
    existing: Existing,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<()> {
    check_file(path, existing)?;
    // Through a symbolic link, so that its target is replaced and the link stays.
    let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let mut builder = Builder::new();
    builder.prefix(TEMPORARY_PREFIX);
    // As `File::create` would have it: the umask decides.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let fail = |e| Error::io(path, e);
    let mut file = builder.tempfile_in(folder_of(&place)?).map_err(|e| not_made(path, &e))?;
    let mut buffered = BufWriter::with_capacity(1 << 16, file.as_file_mut());
    write(&mut buffered).and_then(|()| buffered.flush()).map_err(fail)?;
    drop(buffered);
    match existing {
        Existing::Keep => file.persist_noclobber(&place),
        Existing::Replace => file.persist(&place),
    }
    .map_err(|e| fail(e.error))?;
    Ok(())
}

/// Fills the folder `path` by `write`, which is given the folder to write into; nothing is left behind, and an
/// existing folder is untouched, where that fails.
///
/// # Errors
/// [`Error::Io`] naming `path`: as [`write_file`], and with [`Existing::Replace`] a folder that holds anything but
/// the files of a bake. Errors of `write` come back with their paths as they would have been.
pub fn write_folder<T>(path: &Path, existing: Existing, write: impl FnOnce(&Path) -> Result<T>) -> Result<T> {
    check_folder(path, existing)?;
    let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let fail = |e| Error::io(path, e);
    let temporary = Builder::new()
        .prefix(TEMPORARY_PREFIX)
        .tempdir_in(folder_of(&place)?)
        .map_err(|e| not_made(path, &e))?;
    let new = temporary.path().join("new");
    fs::create_dir(&new).map_err(fail)?;
    let value = write(&new).map_err(|e| with_final_path(e, &new, path))?;
    if fs::symlink_metadata(&place).is_ok() {
        // Looked at again: somebody may have put a file there meanwhile.
        check_folder(path, existing)?;
        replace_folder(temporary, &new, &place).map_err(fail)?;
    } else {
        fs::rename(&new, &place).map_err(fail)?;
    }
    Ok(value)
}

/// Fails where [`write_file`] would before writing anything, so that a long bake need not end in that.
///
/// # Errors
/// As [`write_file`].
pub fn check_file(path: &Path, existing: Existing) -> Result<()> {
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(refused(path, "is a folder; name a file")),
        Ok(found) if !found.is_file() => Err(refused(path, "is not a regular file; name another")),
        Ok(_) if existing == Existing::Keep => Err(refused(path, "already exists; --force replaces it")),
        Ok(_) => Ok(()),
        Err(e) if e.kind() == io::ErrorKind::NotFound => folder_of(path).map(drop),
        Err(e) => Err(Error::io(path, e)),
    }
}

/// Fails where [`write_folder`] would before writing anything.
///
/// # Errors
/// As [`write_folder`].
pub fn check_folder(path: &Path, existing: Existing) -> Result<()> {
    match fs::metadata(path) {
        Ok(found) if !found.is_dir() => Err(refused(path, "is a file; name a folder")),
        Ok(_) if existing == Existing::Keep => Err(refused(path, "already exists; --force replaces it")),
        Ok(_) => match stranger_in(path)? {
            Some(name) => Err(refused(
                path,
                &format!(
                    "holds {name}, which no bake wrote; --force replaces bakes only, name another folder"
                ),
            )),
            None => Ok(()),
        },
        Err(e) if e.kind() == io::ErrorKind::NotFound => folder_of(path).map(drop),
        Err(e) => Err(Error::io(path, e)),
    }
}

/// Swaps `new` into `place`; what was there goes last, and comes back where the swap fails.
fn replace_folder(temporary: TempDir, new: &Path, place: &Path) -> io::Result<()> {
    let old = temporary.path().join("old");
    fs::rename(place, &old)?;
    fs::rename(new, place).inspect_err(|_| {
        if fs::rename(&old, place).is_err() {
            // Better a stray folder than a lost bake.
            let _kept: PathBuf = temporary.keep();
        }
    })
}

/// The first entry of `folder` (by name) that a bake does not write.
fn stranger_in(folder: &Path) -> Result<Option<String>> {
    let mut strangers = Vec::new();
    let mut folders = vec![(folder.to_owned(), String::new())];
    while let Some((folder, within)) = folders.pop() {
        for entry in fs::read_dir(&folder).map_err(|e| Error::io(&folder, e))? {
            let entry = entry.map_err(|e| Error::io(&folder, e))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let path = format!("{within}{name}");
            match entry.file_type() {
                Ok(kind) if kind.is_dir() && is_bake_folder(&path) => {
                    folders.push((entry.path(), format!("{path}/")));
                }
                Ok(kind) if kind.is_file() && is_known(&path) => {}
                _ => strangers.push(path),
            }
        }
    }
    strangers.sort();
    Ok(strangers.into_iter().next())
}

/// A folder that a bake for targets makes: one a target, with the folders of that target's files in it.
fn is_bake_folder(path: &str) -> bool {
    let within = path.split_once('/').map_or(path, |(_, rest)| rest);
    Target::named(path).is_some()
        || target::TARGETS.iter().flat_map(|target| target.files).any(|file| {
            file.path.split_once('/').is_some_and(|(folder, _)| folder == path || folder == within)
        })
}

/// A file that a bake writes, itself or in the folder of a target.
fn is_known(path: &str) -> bool {
    let in_target = path
        .split_once('/')
        .is_some_and(|(folder, rest)| Target::named(folder).is_some() && target::is_target_file(rest));
    is_bake_file(path) || target::is_target_file(path) || in_target
}

/// `report.json`, `sun.json`, `sunless.exr`, `m{level}.exr`, `m{level}_{face}.exr`, `m{level}_{face}_bound.exr`,
/// `irradiance.exr`, `irradiance_{face}.exr`, and .hdr alike.
fn is_bake_file(name: &str) -> bool {
    if ["report.json", "sun.json", "sunless.exr"].contains(&name) {
        return true;
    }
    let Some(stem) = name.strip_suffix(".exr").or_else(|| name.strip_suffix(".hdr")) else { return false };
    let known_level = |level: &str| {
        level == "irradiance"
            || level
                .strip_prefix('m')
                .is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()))
    };
    let known_face = |face: &str| crate::sphere::cube::Face::ALL.iter().any(|f| f.short_name() == face);
    match stem.strip_suffix("_bound").unwrap_or(stem).rsplit_once('_') {
        Some((level, face)) => known_level(level) && known_face(face),
        None => known_level(stem),
    }
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

fn refused(path: &Path, message: &str) -> Error {
    Error::io(path, io::Error::new(io::ErrorKind::AlreadyExists, message))
}

/// A temporary that could not be made: the kind alone, because `tempfile` puts the temporary name into its message.
fn not_made(path: &Path, error: &io::Error) -> Error {
    Error::io(path, error.kind().into())
}

/// `error` with its path moved from the temporary folder to the final one.
fn with_final_path(error: Error, temporary: &Path, place: &Path) -> Error {
    let moved = |path: PathBuf| path.strip_prefix(temporary).map_or(path.clone(), |rest| place.join(rest));
    match error {
        Error::Io { path, error } => Error::Io { path: moved(path), error },
        Error::Input { path, message } => Error::Input { path: moved(path), message },
        other => other,
    }
}
