//! Groups input files into environments and reads them.

use super::console::Console;
use super::expand::Found;
use super::outcome::{Outcome, or_usage, usage};
use crate::read::InputLayout;
use crate::recipes::{InputOptions, Source};
use octagloss_core::files::io::file_name::path_key;
use octagloss_core::files::io::{self, LoadedChain, regular};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Files of one environment: one file, or the six faces of a cube.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct InputFiles(Vec<PathBuf>);

/// Converts `paths` to environments: one each, or six files as one with `--layout faces`.
pub(super) fn sources(paths: Vec<PathBuf>, args: &InputOptions) -> Outcome<Vec<InputFiles>> {
    or_usage(args.check())?;
    match (args.layout, paths.len()) {
        // A single KTX2 cube or level folder already holds its faces.
        (InputLayout::Faces, 6 | 1) => Ok(vec![InputFiles(paths)]),
        (InputLayout::Faces, count) => usage(format!(
            "--layout faces takes the six files of one cube, or one file that holds a cube; {count} were \
             given"
        )),
        _ => Ok(paths.into_iter().map(|path| InputFiles(vec![path])).collect()),
    }
}

/// [`sources`] of `found`, with their names: their stems and `suffix`, in their folders. Refuses two of one
/// name in these words and with this remedy.
pub(super) fn named_sources(
    found: Vec<Found>,
    args: &InputOptions,
    suffix: &str,
    (words, remedy): (&str, &str),
) -> Outcome<Vec<(InputFiles, PathBuf)>> {
    let (paths, withins): (Vec<_>, Vec<_>) =
        found.into_iter().map(|found| (found.path, found.within)).unzip();
    let name = |(source, within): (InputFiles, PathBuf)| {
        let name = within.join(source.stem() + suffix);
        (source, name)
    };
    let named: Vec<_> = sources(paths, args)?.into_iter().zip(withins).map(name).collect();
    let mut by_name = BTreeMap::new();
    for (source, name) in &named {
        if let Some(other) = by_name.insert(path_key(name), source.path()) {
            let (other, path, name) = (other.display(), source.path().display(), name.display());
            return usage(format!("{other} and {path} {words} {name}; {remedy}"));
        }
    }
    Ok(named)
}

/// [`sources`] for subcommands that take one environment.
pub(super) fn single_source(paths: Vec<PathBuf>, args: &InputOptions) -> Outcome<InputFiles> {
    let mut sources = sources(paths, args)?;
    match (sources.pop(), sources.len()) {
        (Some(source), 0) => Ok(source),
        (_, more) => usage(format!(
            "one environment is needed, but {} inputs were given; --layout faces reads six files as one cube",
            more + 1
        )),
    }
}

impl InputFiles {
    /// The file, or the first of the six.
    pub(super) fn path(&self) -> &Path {
        &self.0[0]
    }

    pub(super) fn files(&self) -> &[PathBuf] {
        &self.0
    }

    /// Base name of the outputs: the file's stem or the folder's name. For six faces, the common prefix of
    /// their stems, or else the name of their folder.
    pub(super) fn stem(&self) -> String {
        let stem = |path: &Path| {
            let name = if path.is_dir() { path.file_name() } else { path.file_stem() };
            // Resolve `.` and `..` to get a name.
            let resolved = || Some(path.canonicalize().ok()?.file_name()?.to_owned());
            let name = name.map(ToOwned::to_owned).or_else(resolved);
            name.map_or_else(|| "environment".to_owned(), |name| name.to_string_lossy().into_owned())
        };
        let first = stem(self.path());
        if self.0.len() == 1 {
            return first;
        }
        let shared = self.0.iter().map(|path| stem(path)).fold(first, |shared, other| {
            let same = shared.chars().zip(other.chars()).take_while(|(a, b)| a == b);
            same.map(|(a, _)| a).collect()
        });
        let shared = shared.trim_end_matches(['_', '-', '.', ' ', '+']);
        let folder = self.path().parent().and_then(Path::file_name);
        match (shared, folder) {
            ("", Some(folder)) => folder.to_string_lossy().into_owned(),
            ("", None) => "cube".to_owned(),
            _ => shared.to_owned(),
        }
    }

    /// Reads, rotates, mirrors and removes the sun; prints warnings.
    pub(super) fn open(&self, options: &InputOptions, console: &Console) -> crate::Result<Source> {
        let source = options.open(&self.0)?;
        for note in &source.notes {
            console.note(&format!("{}: {note}", self.path().display()));
        }
        console.warn_of(self.path(), &source.warnings);
        Ok(source)
    }
}

/// The last part of `path`, or all of it.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Reads the bake in `path`: a folder of levels or of a target, a KTX, KTX2 or EXR file that records its
/// levels' roughness, or a DDS file with a report that does. `None` for other files.
pub(super) fn read_bake(path: &Path) -> crate::Result<Option<LoadedChain>> {
    if regular::metadata(path)?.is_dir() {
        // Images and a target's files may be environments.
        let faces = ["m0_px.exr", "m0_px.hdr"].iter().any(|name| path.join(name).is_file());
        let chain = io::load_chain(path);
        return if faces { chain.map(Some) } else { Ok(chain.ok()) };
    }
    // Reading level 0 as an environment reports other errors of such a file.
    Ok(if io::may_hold_chain(path) { io::load_chain(path).ok() } else { None })
}
