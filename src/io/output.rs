//! Outputs that appear whole or not at all: written beside their place under a temporary name, then put into
//! it.
//!
//! Outputs that replace others are exchanged with them in one step where the system can. Several outputs of
//! one bake are staged first and committed together, the report last.

use super::regular::open_regular;
use super::side_report::REPORT;
use super::temporary::{Live, Temporary, exchange, exists, refused, rename_new, resolved, with_path};
use crate::error::{Error, Result};
use crate::format::LevelName;
use crate::target::{self, Target};
use std::fs::{self, File};
use std::io::{self, BufWriter, Read as _, Write};
use std::path::{Path, PathBuf};

pub use super::temporary::{recover, remove_temporaries};

/// What to do about an output that is already there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// Leave it alone and fail.
    #[default]
    Keep,
    /// Replace it once the new one is complete (`--force`).
    Replace,
}

/// A complete output that is not yet in its place; removed when dropped.
#[derive(Debug)]
pub struct Staged {
    temporary: Temporary,
    /// As it was named.
    path: PathBuf,
    /// Where it goes, without links.
    place: PathBuf,
    existing: Existing,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    File,
    Folder,
}

/// How an output was put into its place, which tells how to undo it.
enum Put {
    /// Nothing was there.
    Fresh,
    /// What was there is in the temporary.
    Exchanged,
    /// The folder that was there is set aside.
    SetAside,
    /// The file that was there is lost.
    Over,
}

/// Writes the file `path` by `write`; nothing is left behind, and an existing file is untouched, where that
/// fails. Links are followed: the file that they lead to is written.
///
/// # Errors
/// [`Error::Io`] naming `path`: no folder to hold it, no permission, no space, already there and
/// [`Existing::Keep`], or not a regular file.
pub fn write_file(
    path: &Path,
    existing: Existing,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<()> {
    commit(vec![stage_file(path, existing, write)?])
}

/// Fills the folder `path` by `write`, which is given the folder to write into; nothing is left behind, and
/// an existing folder is untouched, where that fails.
///
/// # Errors
/// [`Error::Io`] naming `path`: as [`write_file`], and with [`Existing::Replace`] a folder that holds
/// anything but the files of a bake. Errors of `write` come back with their paths as they would have been.
pub fn write_folder<T>(path: &Path, existing: Existing, write: impl FnOnce(&Path) -> Result<T>) -> Result<T> {
    let (staged, value) = stage_folder(path, existing, write)?;
    commit(vec![staged])?;
    Ok(value)
}

/// One output of several that are put in place together.
#[derive(Clone, Debug)]
pub enum Output<'a> {
    /// A file and its bytes.
    File(&'a [u8]),
    /// A folder and its files: their paths within it, with `/` between folders, and their bytes.
    Folder(Vec<(String, &'a [u8])>),
}

/// Writes `outputs`, each to become what its path names; [`commit`] puts them there.
///
/// # Errors
/// As [`write_file`] and [`write_folder`].
pub fn stage_all(outputs: &[(PathBuf, Output<'_>)], existing: Existing) -> Result<Vec<Staged>> {
    let stage = |(place, output): &(PathBuf, Output<'_>)| match output {
        Output::File(bytes) => stage_file(place, existing, |file| file.write_all(bytes)),
        Output::Folder(files) => {
            let write = |folder: &Path| {
                files.iter().try_for_each(|(within, bytes)| {
                    create_folders(folder, within)?;
                    let path = folder.join(within);
                    fs::write(&path, bytes).map_err(|e| Error::io(&path, e))
                })
            };
            stage_folder(place, existing, write).map(|(staged, ())| staged)
        }
    };
    outputs.iter().map(stage).collect()
}

/// Writes the file that is to become `path`; [`commit`] puts it there.
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

/// Fills the folder that is to become `path`; [`commit`] puts it there.
///
/// # Errors
/// As [`write_folder`].
pub fn stage_folder<T>(
    path: &Path,
    existing: Existing,
    write: impl FnOnce(&Path) -> Result<T>,
) -> Result<(Staged, T)> {
    check_folder(path, existing)?;
    let staged = Staged::new(path, existing, Kind::Folder)?;
    let new = staged.path();
    unless_ending(|| fs::create_dir(&new)).map_err(|e| Error::io(path, e))?;
    let value = write(&new).map_err(|e| with_final_path(e, &new, path))?;
    staged.sync()?;
    Ok((staged, value))
}

/// Creates a temporary by `create`, unless the process is about to exit and has removed its temporaries.
fn unless_ending<T>(create: impl FnOnce() -> T) -> T {
    let _live = Live::hold();
    create()
}

/// Makes the folders of the file `within` the folder `folder`; that folder itself is not made again, since it
/// is missing where a signal has removed it.
fn create_folders(folder: &Path, within: &str) -> Result<()> {
    for (end, _) in within.match_indices('/') {
        let path = folder.join(&within[..end]);
        match fs::create_dir(&path) {
            Err(e) if e.kind() != io::ErrorKind::AlreadyExists => return Err(Error::io(&path, e)),
            _ => {}
        }
    }
    Ok(())
}

/// Puts outputs into their places, one after the other. Where one fails, those before it are taken back as
/// far as the system can exchange files.
///
/// # Errors
/// [`Error::Io`] naming the output that could not be put into its place.
pub fn commit(outputs: Vec<Staged>) -> Result<()> {
    let live = Live::hold();
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
        let temporary = Temporary::beside(&place).map_err(|e| not_made(path, &e))?;
        Ok(Self { temporary, path: path.to_owned(), place, existing, kind })
    }

    /// Where it lies until it is committed.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        self.temporary.new_path()
    }

    /// Its place as it was named.
    #[must_use]
    pub fn named(&self) -> &Path {
        &self.path
    }

    /// Forces what is to replace something onto the disk, since what it replaces is deleted at once.
    fn sync(&self) -> Result<()> {
        if exists(&self.place) { sync(&self.path()).map_err(|e| Error::io(&self.path, e)) } else { Ok(()) }
    }

    /// Puts it into its place.
    fn put(&self) -> Result<Put> {
        let fail = |e| Error::io(&self.path, e);
        let new = self.path();
        // Other processes may create or remove the place between two steps.
        for _ in 0..100 {
            if !exists(&self.place) {
                match rename_new(&new, &self.place) {
                    Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                    other => return other.map(|()| Put::Fresh).map_err(fail),
                }
            }
            match self.kind {
                Kind::File => check_file(&self.place, self.existing),
                Kind::Folder => check_folder(&self.place, self.existing),
            }
            .map_err(|error| with_path(error, &self.path))?;
            match exchange(&new, &self.place) {
                Some(Ok(())) => return Ok(Put::Exchanged),
                Some(Err(error)) if error.kind() == io::ErrorKind::NotFound => {}
                Some(Err(error)) => return Err(fail(error)),
                None => return self.replace().map_err(fail),
            }
        }
        Err(fail(io::Error::other("other processes keep replacing it")))
    }

    /// Replaces what is in its place without an exchange: a file in one step, a folder in two.
    fn replace(&self) -> io::Result<Put> {
        let (new, old) = (self.path(), self.temporary.old_path());
        match self.kind {
            Kind::File => fs::rename(new, &self.place).map(|()| Put::Over),
            Kind::Folder => {
                fs::rename(&self.place, &old)?;
                // Should putting it back fail as well, the temporary keeps it for the next run.
                fs::rename(new, &self.place).inspect_err(|_| drop(fs::rename(&old, &self.place)))?;
                Ok(Put::SetAside)
            }
        }
    }

    /// Undoes [`Self::put`] as far as possible.
    fn take_back(&self, put: &Put) {
        let new = self.path();
        match put {
            Put::Fresh => drop(fs::rename(&self.place, new)),
            Put::Exchanged => drop(exchange(&new, &self.place)),
            Put::SetAside => {
                let back = fs::rename(&self.place, new)
                    .and_then(|()| fs::rename(self.temporary.old_path(), &self.place));
                drop(back);
            }
            Put::Over => {}
        }
    }
}

/// Fails where [`write_file`] would before writing anything, so that a long bake need not end in that.
///
/// # Errors
/// As [`write_file`].
pub fn check_file(path: &Path, existing: Existing) -> Result<()> {
    let place = resolved(path)?;
    match fs::metadata(&place) {
        Ok(found) if found.is_dir() => Err(refused(path, "is a folder; name a file")),
        Ok(found) if !found.is_file() => Err(refused(path, "is not a regular file; name one")),
        Ok(_) if existing == Existing::Keep => {
            Err(refused(path, "already exists; `Existing::Replace` replaces it"))
        }
        Ok(_) => Ok(()),
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(e) => Err(Error::io(path, e)),
    }
}

/// Fails where [`write_folder`] would before writing anything.
///
/// # Errors
/// As [`write_folder`].
pub fn check_folder(path: &Path, existing: Existing) -> Result<()> {
    let place = resolved(path)?;
    match fs::metadata(&place) {
        Ok(found) if !found.is_dir() => Err(refused(path, "is a file; name a folder")),
        Ok(_) if existing == Existing::Keep => {
            Err(refused(path, "already exists; `Existing::Replace` replaces it"))
        }
        Ok(_) => match stranger_in(&place)? {
            Some(name) => Err(refused(
                path,
                &format!(
                    "holds {name}, which no bake wrote; `Existing::Replace` replaces bakes only, name another folder"
                ),
            )),
            None => Ok(()),
        },
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(e) => Err(Error::io(path, e)),
    }
}

/// Forces the file `path`, or the files in the folder `path`, onto the disk.
fn sync(path: &Path) -> io::Result<()> {
    if fs::symlink_metadata(path)?.is_dir() {
        return fs::read_dir(path)?.try_for_each(|entry| sync(&entry?.path()));
    }
    // Windows flushes through handles that may write.
    File::options().write(true).open(path)?.sync_all()
}

/// The first entry of `folder` (by name) that a bake does not write.
fn stranger_in(folder: &Path) -> Result<Option<String>> {
    let mut strangers = Vec::new();
    let mut folders = vec![(folder.to_owned(), String::new())];
    while let Some((folder, within)) = folders.pop() {
        let has_report =
            folder.join(REPORT).is_file() || report_beside(&folder).is_some_and(|path| path.is_file());
        for entry in fs::read_dir(&folder).map_err(|e| Error::io(&folder, e))? {
            let entry = entry.map_err(|e| Error::io(&folder, e))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let path = format!("{within}{name}");
            match entry.file_type() {
                Ok(kind) if kind.is_dir() && is_bake_folder(&path) => {
                    folders.push((entry.path(), format!("{path}/")));
                }
                // Others have images of such names too.
                Ok(kind) if kind.is_file() && is_known(&path) && (has_report || is_ours(&entry.path())?) => {}
                _ => strangers.push(path),
            }
        }
    }
    strangers.sort();
    Ok(strangers.into_iter().next())
}

/// The report of the file whose bounds `folder` holds: `OUT.report.json` for `OUT.bounds`.
fn report_beside(folder: &Path) -> Option<PathBuf> {
    let name = folder.file_name()?.to_str()?.strip_suffix(".bounds")?;
    Some(folder.with_file_name(format!("{name}.report.json")))
}

/// Whether the file at `path` names this program near its start, as EXR files of a bake do, or is no image of
/// a level.
fn is_ours(path: &Path) -> Result<bool> {
    if !path.extension().is_some_and(|extension| extension == "exr" || extension == "hdr") {
        return Ok(true);
    }
    let mut start = Vec::new();
    let file = open_regular(path)?;
    file.take(1 << 16).read_to_end(&mut start).map_err(|e| Error::io(path, e))?;
    Ok(start.windows(OURS.len()).any(|window| window == OURS))
}

/// What the files of this program have in their headers.
const OURS: &[u8] = b"octagloss";

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

/// `report.json`, `sun.json`, `sunless.exr`, `m{level}.exr`, `m{level}_{face}.exr`,
/// `m{level}_{face}_bound.exr`, `irradiance.exr`, `irradiance_{face}.exr`, and .hdr alike.
fn is_bake_file(name: &str) -> bool {
    if ["report.json", "sun.json", "sunless.exr"].contains(&name) {
        return true;
    }
    let stem = name.strip_suffix(".exr").or_else(|| name.strip_suffix(".hdr"));
    stem.is_some_and(|stem| LevelName::parse(stem).is_some())
}

/// A temporary that could not be made: the kind alone, because `tempfile` puts the temporary name into its
/// message.
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
