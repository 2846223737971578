//! Detects up-to-date outputs by the request and output hashes in the report.

use super::engine::EngineArgs;
use super::input::InputFiles;
use super::outcome::Outcome;
use crate::recipes::{BakePlan, FingerprintReport, InputFileReport, Recipe};
use crate::targets::{LevelName, Shown};
use crate::{Error, Result};
use blake3::{Hash, Hasher};
use octagloss_core::files::io::exr::write::SOFTWARE;
use octagloss_core::files::io::regular::{open_regular, read_regular};
use octagloss_core::files::io::side_report::{MAX_REPORT_BYTES, REPORT};
use octagloss_core::files::io::{DEFAULT_MEMORY_LIMIT, levels_path, reported};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Everything that affects outputs but the inputs: recipes with their defaults filled in, and the engine.
pub(super) fn options(plans: &[BakePlan], engine: &EngineArgs) -> Outcome<String> {
    let recipes: Vec<&Recipe> = plans.iter().map(|plan| &plan.recipe).collect();
    let options = (recipes, format!("{:?} {:?}", engine.engine, engine.adapter));
    Ok(serde_json::to_string(&options)?)
}

/// Hash of the content of `source`, `options` and the program's version, and the hashes of the files of
/// `source`.
pub(super) fn requested(source: &InputFiles, options: &str) -> Result<(Hash, Vec<InputFileReport>)> {
    let mut files = Vec::new();
    let mut hasher = Hasher::new();
    let mut add = |part: &[u8]| {
        hasher.update(&(part.len() as u64).to_le_bytes()).update(part);
    };
    add(SOFTWARE.as_bytes());
    add(options.as_bytes());
    for path in source.files() {
        // Names identify the six faces.
        add(path.file_name().unwrap_or_default().as_encoded_bytes());
        // Only level 0 of a bake is read.
        let levels = levels_path(path)?;
        let counts = |name: &str| {
            let stem = name.split_once('.').map_or(name, |(stem, _)| stem);
            LevelName::parse(stem).is_some_and(|name| name.shown == Shown::Level(0))
        };
        let (hash, bytes) = hash_where(&levels, &counts)?;
        add(hash.as_bytes());
        // A file's orientation may be in its report only.
        let report = if levels.is_file() { reported(&levels, hash) } else { None };
        add(format!("{report:?}").as_bytes());
        files.push(InputFileReport {
            path: path.display().to_string(),
            bytes,
            blake3: hash.to_hex().to_string(),
        });
    }
    Ok((hasher.finalize(), files))
}

/// Hash of a folder of `files`, by relative paths with `/` separators, without reports: that of
/// [`hash_where`].
pub(super) fn hash_of_files(files: &[(String, &[u8])]) -> Hash {
    let mut entries: BTreeMap<&str, Vec<(String, &[u8])>> = BTreeMap::new();
    let mut hashes = BTreeMap::new();
    for (path, bytes) in files {
        match path.split_once('/') {
            Some((folder, rest)) => entries.entry(folder).or_default().push((rest.to_owned(), bytes)),
            None => drop(hashes.insert(&path[..], blake3::hash(bytes))),
        }
    }
    hashes.extend(entries.into_iter().map(|(folder, files)| (folder, hash_of_files(&files))));
    let mut hasher = Hasher::new();
    for (name, hash) in hashes.iter().filter(|(name, _)| **name != REPORT) {
        hasher.update(&(name.len() as u64).to_le_bytes()).update(name.as_bytes()).update(hash.as_bytes());
    }
    hasher.finalize()
}

/// Hash of several outputs: the hash of their hashes.
pub(super) fn joined(hashes: impl IntoIterator<Item = Result<Hash>>) -> Result<Hash> {
    let mut hasher = Hasher::new();
    for hash in hashes {
        hasher.update(hash?.as_bytes());
    }
    Ok(hasher.finalize())
}

/// Hashes a file's content, or the names and contents of a folder's files whose name `counts`; with their
/// size.
fn hash_where(path: &Path, counts: &dyn Fn(&str) -> bool) -> Result<(Hash, u64)> {
    let fail = |error| Error::io(path, error);
    let metadata = fs::metadata(path).map_err(fail)?;
    let (mut hasher, mut size) = (Hasher::new(), 0);
    if metadata.is_dir() {
        let entries =
            fs::read_dir(path).and_then(Iterator::collect::<std::io::Result<Vec<_>>>).map_err(fail)?;
        let mut names: Vec<_> = entries.into_iter().map(|entry| entry.file_name()).collect();
        names.sort();
        for name in names.iter().filter(|name| counts(&name.to_string_lossy())) {
            let bytes = name.as_encoded_bytes();
            hasher.update(&(bytes.len() as u64).to_le_bytes()).update(bytes);
            let entry = path.join(name);
            // Bakes write no links, and links may form cycles.
            if !(entry.is_symlink() && entry.is_dir()) {
                let (hash, bytes) = hash_where(&entry, counts)?;
                hasher.update(hash.as_bytes());
                size += bytes;
            }
        }
    } else {
        size = metadata.len();
    }
    if metadata.is_file() && metadata.len() <= DEFAULT_MEMORY_LIMIT {
        // The reader rejects other types and oversized files.
        let file = open_regular(path)?;
        hasher.update_reader(file).map_err(fail)?;
    }
    Ok((hasher.finalize(), size))
}

/// The hashes in a report. `files` maps the names of files next to it.
pub(super) fn fingerprint(
    request: Hash,
    outputs: Hash,
    files: impl IntoIterator<Item = (String, Hash)>,
) -> FingerprintReport {
    let text = |hash: Hash| hash.to_hex().to_string();
    let files = files.into_iter().map(|(name, hash)| (name, text(hash))).collect();
    FingerprintReport { request: text(request), outputs: text(outputs), report: Some(unsigned()), files }
}

/// Stands for a report's own hash while that is computed.
fn unsigned() -> String {
    "0".repeat(2 * blake3::OUT_LEN)
}

/// `text`, a report with [`fingerprint`]'s placeholder, with its own hash: of all lines but the times, which
/// alone differ between equal runs.
pub(super) fn signed(text: &str) -> String {
    let mut hasher = Hasher::new();
    for line in text.lines().filter(|line| !line.trim_start().starts_with("\"seconds\":")) {
        hasher.update(line.as_bytes()).update(b"\n");
    }
    text.replacen(&unsigned(), &hasher.finalize().to_hex(), 1)
}

/// Whether `text` is a report as [`signed`] returned it, with the hash `own`.
fn is_signed(text: &[u8], own: Option<&str>) -> bool {
    let (Ok(text), Some(own)) = (std::str::from_utf8(text), own) else { return false };
    own.len() == unsigned().len() && signed(&text.replacen(own, &unsigned(), 1)) == text
}

/// The text of the bake's report `path`, and the hashes in it; `None` if it is no such report.
pub(super) fn recorded(path: &Path) -> Option<(Vec<u8>, Option<FingerprintReport>)> {
    #[derive(Deserialize)]
    struct Recorded {
        #[expect(dead_code, reason = "every report has it")]
        levels: serde::de::IgnoredAny,
        fingerprint: Option<FingerprintReport>,
    }
    let text = read_regular(path, MAX_REPORT_BYTES).ok()?;
    let Recorded { fingerprint, .. } = serde_json::from_slice(&text).ok()?;
    Some((text, fingerprint))
}

/// Whether `outputs` match the hashes in `report` for `request`.
pub(super) fn holds(report: &Path, request: Hash, outputs: &[PathBuf]) -> bool {
    let Some((text, Some(stored))) = recorded(report) else { return false };
    let hash = |output: &PathBuf| Ok(hash_where(output, &|name| name != REPORT)?.0);
    is_signed(&text, stored.report.as_deref())
        && stored.request == request.to_hex().as_str()
        && joined(outputs.iter().map(hash)).is_ok_and(|own| stored.outputs == own.to_hex().as_str())
}
