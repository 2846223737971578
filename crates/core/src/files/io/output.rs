//! Atomic outputs: written under a temporary name in the destination's folder, then renamed.
//!
//! Replacements are exchanged in one step if the system supports it. All outputs of a bake are staged first
//! and committed together, the report last.

use super::regular::open_regular;
use super::side_report::REPORT;
use super::temporary::{Temporary, exchange, exists, live, refused, rename, rename_new, resolved, with_path};
use crate::common::error::{Error, Result};
use crate::files::format::LevelName;
use crate::files::target::{self, Target};
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read as _, Write};
use std::path::{Path, PathBuf};

pub use super::temporary::recover;
pub use super::temporary::remove_temporaries;

/// Policy for an output that already exists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// Keep it and fail.
    #[default]
    Keep,
    /// Replace it when the new one is complete (`--force`).
    Replace,
}

impl Existing {
    /// Replaces it by `force`.
    #[must_use]
    pub const fn by_force(force: bool) -> Self {
        if force { Self::Replace } else { Self::Keep }
    }
}

/// A complete output that is not yet committed; removed when dropped.
#[derive(Debug)]
pub struct Staged {
    temporary: Temporary,
    /// Path as given.
    path: PathBuf,
    /// Destination with links resolved.
    place: PathBuf,
    existing: Existing,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    File,
    Folder,
}

/// How an output was committed, for rollback.
enum Put {
    /// The destination did not exist.
    Fresh,
    /// The temporary holds the previous output.
    Exchanged,
    /// The previous folder is set aside.
    SetAside,
    /// The previous file was overwritten.
    Over,
}

/// Writes the file `path` by `write`. On failure nothing is left behind, and an existing file is untouched.
/// Links are followed.
///
/// # Errors
/// [`Error::Io`] naming `path`: missing folder, no permission, no space, an existing file with
/// [`Existing::Keep`], or not a regular file.
pub fn write_file(
    path: &Path,
    existing: Existing,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<()> {
    commit(vec![stage_file(path, existing, write)?])
}

/// One of several outputs committed together.
#[derive(Clone, Debug)]
pub enum Output<'a> {
    /// A file and its bytes.
    File(&'a [u8]),
    /// A folder: relative paths of its files, separated by `/`, and their bytes.
    Folder(Vec<(String, &'a [u8])>),
}

/// Stages `outputs`; [`commit`] moves them to their paths.
///
/// # Errors
/// As [`write_file`] and [`stage_folder`].
pub fn stage_all(outputs: &[(PathBuf, Output<'_>)], existing: Existing) -> Result<Vec<Staged>> {
    let stage = |(place, output): &(PathBuf, Output<'_>)| match output {
        Output::File(bytes) => stage_file(place, existing, |file| file.write_all(bytes)),
        Output::Folder(files) => stage_folder(place, existing, |folder| {
            files.iter().try_for_each(|(within, bytes)| {
                create_folders(folder, within)?;
                let path = folder.join(within);
                fs::write(&path, bytes).map_err(|e| Error::io(&path, e))
            })
        }),
    };
    outputs.iter().map(stage).collect()
}

/// Stages the file `path`; [`commit`] moves it there.
///
/// # Errors
/// As [`write_file`].
pub fn stage_file(
    path: &Path,
    existing: Existing,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<Staged> {
    check_file(path, existing)?;
    let staged = Staged::new(path, existing, Kind::File)?;
    let fail = |e| Error::io(path, e);
    let create = || File::options().write(true).create_new(true).open(staged.path());
    let file = unless_ending(create).map_err(fail)?;
    let mut buffered = BufWriter::with_capacity(1 << 16, file);
    write(&mut buffered).and_then(|()| buffered.flush()).map_err(fail)?;
    staged.sync()?;
    Ok(staged)
}

/// Stages the folder `path`; [`commit`] moves it there.
///
/// # Errors
/// As [`stage_folder`].
pub fn stage_folder(
    path: &Path,
    existing: Existing,
    write: impl FnOnce(&Path) -> Result<()>,
) -> Result<Staged> {
    check_folder(path, existing)?;
    let staged = Staged::new(path, existing, Kind::Folder)?;
    let new = staged.path();
    unless_ending(|| fs::create_dir(&new)).map_err(|e| Error::io(path, e))?;
    write(&new).map_err(|e| with_final_path(e, &new, path))?;
    staged.sync()?;
    Ok(staged)
}

/// Creates a temporary by `create`; blocks if the process is exiting and has removed its temporaries.
fn unless_ending<T>(create: impl FnOnce() -> T) -> T {
    let _live = live();
    create()
}

/// Creates the folders of the file `within` `folder`, but not `folder` itself: a signal handler may have
/// removed it.
fn create_folders(folder: &Path, within: &str) -> Result<()> {
    for (end, _) in within.match_indices('/') {
        let path = folder.join(&within[..end]);
        match fs::create_dir(&path) {
            Err(e) if e.kind() != ErrorKind::AlreadyExists => return Err(Error::io(&path, e)),
            _ => {}
        }
    }
    Ok(())
}

/// Commits outputs in order. If one fails, the previous ones are rolled back if the system can exchange
/// files.
///
/// # Errors
/// [`Error::Io`] naming the output that could not be committed.
pub fn commit(outputs: Vec<Staged>) -> Result<()> {
    let live = live();
    // First, for not every system can roll back.
    outputs.iter().filter(|output| exists(&output.place)).try_for_each(Staged::check)?;
    let mut done: Vec<(&Staged, Put)> = Vec::with_capacity(outputs.len());
    for output in &outputs {
        match output.put() {
            Ok(put) => done.push((output, put)),
            Err(error) => {
                done.into_iter().rev().for_each(|(output, put)| output.take_back(&put));
                return Err(error);
            }
        }
    }
    drop(live);
    Ok(())
}

impl Staged {
    fn new(path: &Path, existing: Existing, kind: Kind) -> Result<Self> {
        let place = resolved(path)?;
        // Only the kind, because `tempfile` includes the temporary name in its message.
        let temporary = Temporary::beside(&place).map_err(|e| Error::io(path, e.kind().into()))?;
        Ok(Self { temporary, path: path.to_owned(), place, existing, kind })
    }

    /// Temporary path until it is committed.
    pub fn path(&self) -> PathBuf {
        self.temporary.new_path()
    }

    /// Flushes a replacement to disk, because the previous output is deleted immediately.
    fn sync(&self) -> Result<()> {
        if exists(&self.place) { sync(&self.path()).map_err(|e| Error::io(&self.path, e)) } else { Ok(()) }
    }

    /// Checks that its destination may be replaced.
    fn check(&self) -> Result<()> {
        match self.kind {
            Kind::File => check_file(&self.place, self.existing),
            Kind::Folder => check_folder(&self.place, self.existing),
        }
        .map_err(|error| with_path(error, &self.path))
    }

    /// Moves it to its destination.
    fn put(&self) -> Result<Put> {
        let fail = |e| Error::io(&self.path, e);
        let new = self.path();
        // Other processes may create or remove the destination between two steps.
        for _ in 0..100 {
            if !exists(&self.place) {
                match rename_new(&new, &self.place) {
                    Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
                    other => return other.map(|()| Put::Fresh).map_err(fail),
                }
            }
            self.check()?;
            match exchange(&new, &self.place) {
                Some(Ok(())) => return Ok(Put::Exchanged),
                Some(Err(error)) if error.kind() == ErrorKind::NotFound => {}
                Some(Err(error)) => return Err(fail(error)),
                None => match self.replace() {
                    // Another process has removed or made the destination meanwhile.
                    Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::AlreadyExists) => {}
                    other => return other.map_err(fail),
                },
            }
        }
        Err(fail(io::Error::other("other processes keep replacing it")))
    }

    /// Replaces the destination without an exchange: a file in one step, a folder in two.
    fn replace(&self) -> io::Result<Put> {
        let (new, old) = (self.path(), self.temporary.old_path());
        match self.kind {
            Kind::File => rename(&new, &self.place).map(|()| Put::Over),
            Kind::Folder => {
                rename(&self.place, &old)?;
                rename_new(&new, &self.place).or_else(|error| {
                    // If restoring fails too, the temporary keeps it for the next run, unless another process
                    // has put its own folder there.
                    if rename_new(&old, &self.place).is_err() && exists(&self.place) {
                        fs::remove_dir_all(&old)?;
                    }
                    Err(error)
                })?;
                Ok(Put::SetAside)
            }
        }
    }

    /// Undoes [`Self::put`] as far as possible.
    fn take_back(&self, put: &Put) {
        let new = self.path();
        match put {
            Put::Fresh => drop(rename(&self.place, &new)),
            Put::Exchanged => drop(exchange(&new, &self.place)),
            Put::SetAside => {
                let back =
                    rename(&self.place, &new).and_then(|()| rename(&self.temporary.old_path(), &self.place));
                drop(back);
            }
            Put::Over => {}
        }
    }
}

/// Checks the preconditions of [`write_file`] without writing, so that a long bake fails early.
///
/// # Errors
/// As [`write_file`].
pub fn check_file(path: &Path, existing: Existing) -> Result<()> {
    let place = resolved(path)?;
    match fs::metadata(&place) {
        Ok(found) if found.is_dir() => Err(refused(path, "is a folder; name a file")),
        Ok(found) if !found.is_file() => Err(refused(path, "is not a regular file; name one")),
        Ok(_) if existing == Existing::Keep => Err(refused(path, "already exists; `force` replaces it")),
        // Elsewhere the folder decides.
        Ok(found) if cfg!(windows) && found.permissions().readonly() => {
            Err(refused(path, "is read-only; allow writing to it, or name another file"))
        }
        Ok(_) => Ok(()),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(()),
        Err(e) => Err(Error::io(path, e)),
    }
}

/// Checks the preconditions of [`stage_folder`] without writing.
///
/// # Errors
/// As [`stage_folder`].
pub fn check_folder(path: &Path, existing: Existing) -> Result<()> {
    let place = resolved(path)?;
    match fs::metadata(&place) {
        Ok(found) if !found.is_dir() => Err(refused(path, "is a file; name a folder")),
        Ok(_) if existing == Existing::Keep => Err(refused(path, "already exists; `force` replaces it")),
        Ok(_) => match stranger_in(&place)? {
            Some(name) => Err(refused(
                path,
                &format!(
                    "has {name}, which no bake wrote; `force` replaces bakes only, name another \
                     folder"
                ),
            )),
            None => Ok(()),
        },
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(()),
        Err(e) => Err(Error::io(path, e)),
    }
}

/// Flushes the file `path`, or the files in the folder `path`, to disk.
fn sync(path: &Path) -> io::Result<()> {
    if fs::symlink_metadata(path)?.is_dir() {
        return fs::read_dir(path)?.try_for_each(|entry| sync(&entry?.path()));
    }
    // Windows flushes only through writable handles.
    File::options().write(true).open(path)?.sync_all()
}

/// First entry of `folder`, by name, that a bake does not write.
fn stranger_in(folder: &Path) -> Result<Option<String>> {
    let mut strangers = Vec::new();
    let mut folders = vec![(folder.to_owned(), String::new())];
    while let Some((folder, within)) = folders.pop() {
        // The report of the file whose bounds the folder holds: `OUT.report.json` for `OUT.bounds`.
        let name = folder.file_name().and_then(|name| name.to_str()?.strip_suffix(".bounds"));
        let beside = name.map(|name| folder.with_file_name(format!("{name}.{REPORT}")));
        let has_report = folder.join(REPORT).is_file() || beside.is_some_and(|path| path.is_file());
        for entry in fs::read_dir(&folder).map_err(|e| Error::io(&folder, e))? {
            let entry = entry.map_err(|e| Error::io(&folder, e))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let path = format!("{within}{name}");
            match entry.file_type() {
                Ok(kind) if kind.is_dir() && is_bake_folder(&path) => {
                    folders.push((entry.path(), format!("{path}/")));
                }
                // Other programs write images of such names too.
                Ok(kind) if kind.is_file() && is_known(&path) && (has_report || is_ours(&entry.path())?) => {}
                _ => strangers.push(path),
            }
        }
    }
    strangers.sort();
    Ok(strangers.into_iter().next())
}

/// Whether the file `path` is not an image of a level, or names this program near its start, as EXR files of
/// a bake do.
fn is_ours(path: &Path) -> Result<bool> {
    if !path.extension().is_some_and(|extension| extension == "exr" || extension == "hdr") {
        return Ok(true);
    }
    let mut start = Vec::new();
    let file = open_regular(path)?;
    file.take(1 << 16).read_to_end(&mut start).map_err(|e| Error::io(path, e))?;
    Ok(start.windows(OURS.len()).any(|window| window == OURS))
}

/// Marker in the headers of this program's files.
const OURS: &[u8] = b"octagloss";

/// Whether `path` is a folder that a bake for targets creates: one a target, with subfolders for its files.
fn is_bake_folder(path: &str) -> bool {
    let within = path.split_once('/').map_or(path, |(_, rest)| rest);
    Target::named(path).is_some()
        || target::TARGETS.iter().flat_map(|target| target.files).any(|file| {
            file.path.split_once('/').is_some_and(|(folder, _)| folder == path || folder == within)
        })
}

/// Whether a bake writes the file `path`, directly or in a target's folder: `report.json`, `sun.json`,
/// `sun.gltf`, `sunless.exr`, `m{level}.exr`, `m{level}_{face}.exr`, `m{level}_{face}_bound.exr`,
/// `irradiance.exr`, `irradiance_{face}.exr`, the same with .hdr, or the file of a target.
fn is_known(path: &str) -> bool {
    let in_target = path
        .split_once('/')
        .is_some_and(|(folder, rest)| Target::named(folder).is_some() && target::is_target_file(rest));
    let stem = path.strip_suffix(".exr").or_else(|| path.strip_suffix(".hdr"));
    ["sun.gltf", "sunless.exr"].contains(&path)
        || stem.is_some_and(|stem| LevelName::parse(stem).is_some())
        || target::is_target_file(path)
        || in_target
}

/// Replaces the temporary folder in the path of `error` with the final one.
fn with_final_path(error: Error, temporary: &Path, place: &Path) -> Error {
    let moved = |path: PathBuf| path.strip_prefix(temporary).map_or(path.clone(), |rest| place.join(rest));
    match error {
        Error::Io { path, error } => Error::Io { path: moved(path), error },
        Error::Input { path, message } => Error::Input { path: moved(path), message },
        other => other,
    }
}
