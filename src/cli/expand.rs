//! Expands folders and patterns to input files.
//!
//! Walks folders in name order. Skips hidden files, links to folders, outputs of earlier bakes and this
//! bake's output folder.

use crate::Error;
use glob::{MatchOptions, Pattern};
use octagloss_core::files::io::file_name::verbatim_length;
use octagloss_core::files::io::side_report::REPORT;
use octagloss_core::files::io::{has_readable_name, is_bake_folder, levels_path, readable_extensions};
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// An input.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) path: PathBuf,
    /// Folders between the given folder or pattern and the file; empty for a file given by name.
    pub(super) within: PathBuf,
}

/// All inputs.
#[derive(Debug, Default)]
pub(super) struct Expansion {
    pub(super) found: Vec<Found>,
    /// Whether a folder or a pattern was given, which may expand to any number of files.
    pub(super) is_open: bool,
    /// Folders that could not be read, and folders and patterns without inputs.
    pub(super) failures: Vec<Error>,
}

/// State of a walk.
struct Walk<'a> {
    recursive: bool,
    /// The output folder with links resolved; `None` if it does not exist yet.
    output: Option<&'a Path>,
    found: Vec<Found>,
    failures: Vec<Error>,
}

/// A pattern component between slashes.
#[derive(Debug)]
enum PatternPart {
    /// `**`: any number of folders.
    Folders,
    /// A name without wildcards.
    Literal(String),
    Wild(Pattern),
}

/// Expands `typed`; files go to `output`.
pub(super) fn expand(typed: Vec<PathBuf>, recursive: bool, output: Option<&Path>) -> Expansion {
    let output = output.and_then(|path| path.canonicalize().ok());
    let mut all = Expansion::default();
    // Inputs found twice, or found and given by name, are one. Inputs named twice are reported later.
    let (mut named, mut met) = (BTreeSet::new(), BTreeSet::new());
    for path in typed {
        let mut walk = Walk { recursive, output: output.as_deref(), found: Vec::new(), failures: Vec::new() };
        let what = if path.is_dir() && !is_bake_folder(&path) {
            walk.folder(&path, Path::new(""));
            "holds"
        } else if let Some((base, parts)) = pattern(&path) {
            walk.pattern(base, Path::new(""), &parts);
            "matches"
        } else {
            if !met.contains(&path) {
                named.insert(path.clone());
                all.found.push(Found { path, within: PathBuf::new() });
            }
            continue;
        };
        let Walk { found, failures, .. } = walk;
        if found.is_empty() && failures.is_empty() {
            // A folder of several bakes has its own error.
            let own = if path.is_dir() { levels_path(&path).err() } else { None };
            let shallow = what == "holds" && !recursive;
            let more = if shallow { "; --recursive also searches subfolders" } else { "" };
            let extensions: Vec<_> = readable_extensions().map(|extension| format!(".{extension}")).collect();
            let nothing = format!("{what} no readable file: {}{more}", extensions.join(" "));
            all.failures.push(own.unwrap_or_else(|| Error::input(&path, nothing)));
        }
        all.is_open = true;
        all.failures.extend(failures);
        let mut is_new = |path: &PathBuf| !named.contains(path) && met.insert(path.clone());
        all.found.extend(found.into_iter().filter(|found| is_new(&found.path)));
    }
    all
}

impl Walk<'_> {
    /// Adds the files in `folder`, with `--recursive` also those in subfolders.
    fn folder(&mut self, folder: &Path, within: &Path) {
        for name in self.names(folder) {
            let path = folder.join(&name);
            if !is_real_folder(&path) {
                self.take(path, within);
            } else if self.recursive && self.is_walked(&path) {
                self.folder(&path, &within.join(name));
            }
        }
    }

    /// Adds the files below `folder` that match `parts`.
    fn pattern(&mut self, folder: &Path, within: &Path, parts: &[PatternPart]) {
        let Some((first, rest)) = parts.split_first() else { return };
        match first {
            PatternPart::Folders => {
                self.pattern(folder, within, rest);
                for name in self.names(folder) {
                    let path = folder.join(&name);
                    if is_real_folder(&path) && self.is_walked(&path) {
                        self.pattern(&path, &within.join(name), parts);
                    }
                }
            }
            PatternPart::Literal(name) => {
                let path = folder.join(name);
                if !rest.is_empty() {
                    // Outputs must stay in their folder.
                    let within = match &name[..] {
                        ".." => within.parent().unwrap_or(within).to_owned(),
                        name => within.join(name),
                    };
                    self.pattern(&path, &within, rest);
                } else if path.symlink_metadata().is_ok() && !path.is_dir() {
                    self.take(path, within);
                }
            }
            PatternPart::Wild(pattern) => {
                let options = MatchOptions {
                    case_sensitive: !cfg!(windows),
                    require_literal_leading_dot: true,
                    ..MatchOptions::new()
                };
                let is_match = |name: &OsString| pattern.matches_with(&name.to_string_lossy(), options);
                for name in self.names(folder).into_iter().filter(is_match) {
                    let path = folder.join(&name);
                    if rest.is_empty() {
                        self.take(path, within);
                    } else if path.is_dir() && !self.is_output(&path) {
                        self.pattern(&path, &within.join(name), rest);
                    }
                }
            }
        }
    }

    /// Adds the file `path` if its extension is readable. Other errors are reported when it is read.
    fn take(&mut self, path: PathBuf, within: &Path) {
        if has_readable_name(&path) && !path.is_dir() {
            self.found.push(Found { path, within: within.to_owned() });
        }
    }

    /// Possible inputs in `folder`, in name order.
    fn names(&mut self, folder: &Path) -> Vec<OsString> {
        let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let read = fs::read_dir(here)
            .and_then(|entries| entries.map(|entry| Ok(entry?.file_name())).collect::<io::Result<Vec<_>>>());
        let mut names = match read {
            Ok(names) => names,
            // A pattern may miss in some folders.
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                return Vec::new();
            }
            Err(error) => {
                self.failures.push(Error::io(here, error));
                return Vec::new();
            }
        };
        names.sort();
        // The files that have reports next to them.
        let suffix = format!(".{REPORT}");
        let bakes: Vec<String> =
            names.iter().filter_map(|name| Some(name.to_str()?.strip_suffix(&suffix)?.to_owned())).collect();
        names.retain(|name| {
            let name = name.to_string_lossy();
            !name.starts_with('.') && !bakes.iter().any(|bake| is_of_bake(&name, bake))
        });
        names
    }

    /// Whether to search the folder `path` for inputs.
    fn is_walked(&self, path: &Path) -> bool {
        !self.is_output(path) && !is_bake_folder(path)
    }

    fn is_output(&self, path: &Path) -> bool {
        self.output.is_some_and(|output| path.canonicalize().is_ok_and(|path| path == output))
    }
}

/// Whether `name` is the file `bake` of a bake, or was written with it.
fn is_of_bake(name: &str, bake: &str) -> bool {
    let stem = bake.rsplit_once('.').map_or(bake, |(stem, _)| stem);
    let is_cube = |rest: &str| rest.starts_with(".irradiance.") || rest.starts_with(".skybox.");
    name.strip_prefix(bake).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        || name.strip_prefix(stem).is_some_and(is_cube)
}

/// Whether `path` is a folder and not a link to one, since links may form cycles.
fn is_real_folder(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|metadata| metadata.is_dir())
}

/// Splits `path` at the first wildcard into folder and pattern parts; `None` without wildcards and for an
/// existing path.
fn pattern(path: &Path) -> Option<(&Path, Vec<PatternPart>)> {
    const WILD: [char; 3] = ['*', '?', '['];
    let text = path.to_str()?;
    let verbatim = verbatim_length(text);
    let wild = verbatim + text[verbatim..].find(WILD)?;
    if path.symlink_metadata().is_ok() {
        return None;
    }
    let start = text[..wild].rfind(std::path::is_separator).map_or(0, |slash| slash + 1);
    let mut parts: Vec<PatternPart> = Vec::new();
    for part in text[start..].split(std::path::is_separator).filter(|part| !["", "."].contains(part)) {
        match part {
            "**" if matches!(parts.last(), Some(PatternPart::Folders)) => {}
            "**" => parts.push(PatternPart::Folders),
            _ if part.contains(WILD) => parts.push(PatternPart::Wild(Pattern::new(part).ok()?)),
            _ => parts.push(PatternPart::Literal(part.to_owned())),
        }
    }
    if matches!(parts.last(), Some(PatternPart::Folders)) {
        parts.push(PatternPart::Wild(Pattern::new("*").ok()?));
    }
    Some((Path::new(&text[..start]), parts))
}
