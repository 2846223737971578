//! Detects up-to-date outputs by the request and output hashes in the report.

use super::args::BakeArgs;
use super::input::InputFiles;
use super::outcome::Outcome;
use super::shared_args::InputArgs;
use crate::analysis::extraction::Suns;
use crate::bake::BakeSettings;
use crate::bake::report::{FingerprintReport, InputFileReport, Report, filter_name};
use crate::export::plan::BakePlan;
use crate::format::{LevelName, Shown};
use crate::io::exr::write::SOFTWARE;
use crate::io::regular::{open_regular, read_regular};
use crate::io::side_report::MAX_REPORT_BYTES;
use crate::io::side_report::REPORT;
use crate::io::{DEFAULT_MEMORY_LIMIT, levels_path, reported_pairs};
use crate::target::TargetPlan;
use crate::{Error, Result};
use blake3::{Hash, Hasher};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// All options that affect outputs, as `key=value` lines with defaults filled in. Excludes output paths,
/// verbosity and threads.
pub(super) fn options(plans: &[BakePlan], args: &BakeArgs) -> Outcome<String> {
    let InputArgs { layout, rotate_y, mirror, scale, crop, pad, sanitize, strict, extract_sun } = &args.input;
    let mut lines = vec![
        format!("layout={layout:?}"),
        format!("rotate_y={}", rotate_y.unwrap_or(0.0)),
        format!("mirror={mirror}"),
        format!("scale={}", scale.unwrap_or(1.0)),
        format!("crop={crop}"),
        format!("pad={pad:?}"),
        format!("sanitize={sanitize}"),
        format!("strict={strict}"),
        format!("extract_sun={}", extract_sun.as_ref().map(Suns::to_string).unwrap_or_default()),
        format!("sunless={}", args.sunless),
        format!("overflow={}", args.overflow.name()),
        format!("name={:?}", args.name),
        format!("preview={:?}", args.preview.as_ref().map(|_| args.exposure.to_string())),
        format!("engine={:?}", args.engine.engine),
        format!("adapter={:?}", args.engine.adapter),
    ];
    for BakePlan { plan, settings, skybox, .. } in plans {
        // The skybox size also records its presence.
        let TargetPlan { target, container, pixel, flip, diffuse, layout, skybox: _ } = plan;
        let BakeSettings { map, size, levels: _, ladder, lobe, filter, oem_size, border, scan, .. } =
            settings;
        let BakeSettings { bounds, irradiance, sh_order, sh_window, chain: _, sheen, skybox: _, .. } =
            settings;
        lines.extend([
            format!("target={}", target.name),
            format!("container={}", container.name()),
            format!("pixel={}", pixel.name()),
            format!("flip={}", flip.name()),
            format!("diffuse={}", diffuse.name()),
            format!("out_layout={}", layout.name()),
            format!("map={map:?}"),
            format!("size={size}"),
            format!("levels={}", settings.level_specs()?.len()),
            format!("ladder={}", ladder.name()),
            format!("lobe={}", lobe.name()),
            format!("filter={}", filter_name(*filter)),
            format!("oem_size={oem_size:?}"),
            format!("border={border:?}"),
            format!("scan={scan}"),
            format!("bounds={bounds}"),
            format!("irradiance={irradiance:?}"),
            format!("sh_order={sh_order}"),
            format!("sh_window={sh_window}"),
            format!("chain={}", settings.chain().name()),
            format!("sheen={sheen}"),
            format!("skybox={skybox:?}"),
        ]);
    }
    Ok(lines.join("\n"))
}

/// Hashes the content of `source`, `options` and the program's version.
pub(super) fn request(source: &InputFiles, options: &str) -> Result<Hash> {
    requested(source, options).map(|(hash, _)| hash)
}

/// [`request`], with the hashes of the files of `source`.
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
        let hash = hash_where(&levels, &counts)?;
        add(hash.as_bytes());
        // A file's orientation may be in its report only.
        let pairs = if levels.is_file() { reported_pairs(&levels, hash) } else { Vec::new() };
        pairs.iter().flat_map(|(key, value)| [key, value]).for_each(|text| add(text.as_bytes()));
        files.push(InputFileReport {
            path: path.display().to_string(),
            bytes: bytes_where(&levels, &counts)?,
            blake3: hash.to_hex().to_string(),
        });
    }
    Ok((hasher.finalize(), files))
}

/// Size of a file, or of a folder's files whose name `counts`.
fn bytes_where(path: &Path, counts: &dyn Fn(&str) -> bool) -> Result<u64> {
    let fail = |error| Error::io(path, error);
    let metadata = fs::metadata(path).map_err(fail)?;
    if !metadata.is_dir() {
        return Ok(metadata.len());
    }
    let mut bytes = 0;
    for entry in fs::read_dir(path).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        if counts(&entry.file_name().to_string_lossy()) {
            bytes += entry.metadata().map_err(fail)?.len();
        }
    }
    Ok(bytes)
}

/// Hashes an output file or folder without reports.
pub(super) fn hash_of(output: &Path) -> Result<Hash> {
    hash_where(output, &|name| name != REPORT)
}

/// [`hash_of`] for a folder of `files`, by relative paths with `/` separators.
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

/// Hashes a file's content, or the names and contents of a folder's files whose name `counts`.
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
            // Bakes write no links, and links may form cycles.
            if !(entry.is_symlink() && entry.is_dir()) {
                hasher.update(hash_where(&entry, counts)?.as_bytes());
            }
        }
    } else if metadata.is_file() && metadata.len() <= DEFAULT_MEMORY_LIMIT {
        // The reader rejects other types and oversized files.
        let file = open_regular(path)?;
        hasher.update_reader(file).map_err(fail)?;
    }
    Ok(hasher.finalize())
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

/// Whether `outputs` match the hashes in `report` for `request`.
pub(super) fn holds(report: &Path, request: Hash, outputs: impl IntoIterator<Item = PathBuf>) -> bool {
    let Ok(text) = read_regular(report, MAX_REPORT_BYTES) else { return false };
    let stored = serde_json::from_slice::<Report>(&text).ok().and_then(|report| report.fingerprint);
    stored.is_some_and(|stored| {
        is_signed(&text, stored.report.as_deref())
            && joined(outputs.into_iter().map(|output| hash_of(&output))).is_ok_and(|outputs| {
                let FingerprintReport { report, files, .. } = stored.clone();
                stored == FingerprintReport { report, files, ..fingerprint(request, outputs, []) }
            })
    })
}
