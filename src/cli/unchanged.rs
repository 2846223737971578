//! Bakes that need not be done again: what was asked for and what was written, as hashes in the report.

use super::args::BakeArgs;
use super::input::Source;
use blake3::{Hash, Hasher};
use octagloss::io::DEFAULT_MEMORY_LIMIT;
use octagloss::io::exr_write::SOFTWARE;
use octagloss::report::{FingerprintReport, Report};
use octagloss::{Error, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// The report of a folder of outputs, which holds the hash of what is beside it.
pub(super) const REPORT: &str = "report.json";

/// Everything in `args` that outputs depend on, as text: all options but those that say where, how loud or how fast.
/// `resolved` is what follows from names, such as the format from an extension.
pub(super) fn options(args: &BakeArgs, resolved: &str) -> String {
    let mut args = BakeArgs {
        inputs: Vec::new(),
        output: None,
        preview: args.preview.as_ref().map(|_| PathBuf::new()),
        json: false,
        quiet: false,
        force: false,
        dry_run: false,
        skip_unchanged: false,
        ..args.clone()
    };
    args.engine.threads = None;
    format!("{resolved} {args:?}")
}

/// The hash of the content of `source`, of `options` and of the program's version.
pub(super) fn request(source: &Source, options: &str) -> Result<Hash> {
    let mut hasher = Hasher::new();
    let mut add = |part: &[u8]| {
        hasher.update(&(part.len() as u64).to_le_bytes()).update(part);
    };
    add(SOFTWARE.as_bytes());
    add(options.as_bytes());
    for path in source.files() {
        // The names of six faces say which is which.
        add(path.file_name().unwrap_or_default().as_encoded_bytes());
        // A bake is read for its level 0.
        add(hash_where(path, &|name| name.starts_with("m0_"))?.as_bytes());
    }
    Ok(hasher.finalize())
}

/// The hash of an output, file or folder, reports left out.
pub(super) fn hash_of(output: &Path) -> Result<Hash> {
    hash_where(output, &|name| name != REPORT)
}

/// The hash of several outputs, of their hashes.
pub(super) fn joined(hashes: impl IntoIterator<Item = Result<Hash>>) -> Result<Hash> {
    let mut hasher = Hasher::new();
    for hash in hashes {
        hasher.update(hash?.as_bytes());
    }
    Ok(hasher.finalize())
}

/// The hash of a file's content, or of the names and contents in a folder, those whose name `counts`.
fn hash_where(path: &Path, counts: &dyn Fn(&str) -> bool) -> Result<Hash> {
    let fail = |error| Error::io(path, error);
    let metadata = fs::metadata(path).map_err(fail)?;
    let mut hasher = Hasher::new();
    if metadata.is_dir() {
        let entries =
            fs::read_dir(path).and_then(Iterator::collect::<std::io::Result<Vec<_>>>).map_err(fail)?;
        let mut names: Vec<_> = entries.into_iter().map(|entry| entry.file_name()).collect();
        names.sort();
        for name in names.iter().filter(|name| counts(&name.to_string_lossy())) {
            let bytes = name.as_encoded_bytes();
            hasher.update(&(bytes.len() as u64).to_le_bytes()).update(bytes);
            let entry = path.join(name);
            // No bake writes links, and they may lead in a circle.
            if !(entry.is_symlink() && entry.is_dir()) {
                hasher.update(hash_where(&entry, counts)?.as_bytes());
            }
        }
    } else if metadata.is_file() && metadata.len() <= DEFAULT_MEMORY_LIMIT {
        // What is neither, or too large, is refused by whoever reads it.
        let file = fs::File::open(path).map_err(fail)?;
        hasher.update_reader(file).map_err(fail)?;
    }
    Ok(hasher.finalize())
}

/// What the report tells of both.
pub(super) fn fingerprint(request: Hash, outputs: Hash) -> FingerprintReport {
    let text = |hash: Hash| hash.to_hex().to_string();
    FingerprintReport { request: text(request), outputs: text(outputs) }
}

/// Whether `outputs` still hold what `report` says was written to them for `request`.
pub(super) fn holds(report: &Path, request: Hash, outputs: impl IntoIterator<Item = PathBuf>) -> bool {
    let text = fs::read(report).ok();
    let told = text.and_then(|text| serde_json::from_slice::<Report>(&text).ok()?.fingerprint);
    told.is_some_and(|told| {
        joined(outputs.into_iter().map(|output| hash_of(&output)))
            .is_ok_and(|outputs| told == fingerprint(request, outputs))
    })
}
