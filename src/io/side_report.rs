//! The report of a bake as readers use it: it says of a file what its container has no place for.
//!
//! A report describes a file where it lists the BLAKE3 hash of the file's bytes. Reports of version 0.1 list
//! no hashes: there the name decides.

use super::provenance::{IRRADIANCE, Provenance, TakenSun};

use crate::chain::ChainKind;
use crate::lobe::Lobe;
use crate::target::{Content, Flip, Target};
use serde::Deserialize;
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Bytes of the longest report that is read.
const LONGEST: u64 = 64 << 20;

/// The parts of a report that say what the files are. Keys that a report lacks are not an error, but for the
/// levels.
#[derive(Debug, Deserialize)]
pub(super) struct SideReport {
    pub(super) levels: Vec<ReportLevel>,
    #[serde(default)]
    sheen: Vec<ReportLevel>,
    #[serde(default)]
    options: Options,
    #[serde(default)]
    sun: Option<TakenSun>,
    #[serde(default)]
    target: Option<TargetPart>,
    chain: Option<String>,
    #[serde(default)]
    fingerprint: Fingerprint,
}

#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct ReportLevel {
    pub(super) level: u32,
    pub(super) size: u32,
    pub(super) roughness: f64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Options {
    lobe: Option<String>,
    filter: Option<String>,
    ladder: Option<String>,
    rotate_y: Option<f64>,
    mirror: Option<bool>,
}

#[derive(Debug, Deserialize)]
struct TargetPart {
    name: String,
    flip: Option<String>,
    #[serde(default)]
    files: Vec<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Fingerprint {
    /// Hashes by path.
    files: BTreeMap<String, String>,
}

/// What a report says of one file.
#[derive(Debug)]
pub(super) struct Described {
    pub(super) provenance: Provenance,
    /// The roughness of each of its levels.
    pub(super) roughness: Vec<f64>,
}

/// What the report of the file `path`, whose content has that BLAKE3 `hash`, says of it.
///
/// The report is `FILE.report.json`, that of the file's bake where it is the irradiance, or `report.json` in
/// the file's folder or the one above, where a target has folders of its own.
pub(super) fn of_file(path: &Path, hash: impl Fn() -> blake3::Hash) -> Option<Described> {
    let name = path.file_name()?.to_str()?.to_owned();
    let folders = [path.parent(), path.parent().and_then(Path::parent)];
    let shared = folders.into_iter().flatten().filter_map(|folder| {
        let name = path.strip_prefix(folder).ok()?.to_str()?.replace('\\', "/");
        Some((folder.join(REPORT), name))
    });
    let known = OnceCell::new();
    let hash = || known.get_or_init(|| hash().to_hex().to_string()).clone();
    let own = beside(path).into_iter().map(|report| (report, name.clone()));
    own.chain(shared).find_map(|(report, name)| {
        let is_own = report.file_name().is_some_and(|name| name != REPORT);
        let report = read(&report)?;
        let listed = report.listed(&name, is_own, &hash)?;
        report.describes(&listed)
    })
}

/// The reports that stand beside the single file `path`.
fn beside(path: &Path) -> Vec<PathBuf> {
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return Vec::new() };
    let of = |name: &str| path.with_file_name(format!("{name}.{REPORT}"));
    let main = name.contains(".irradiance.").then(|| of(&name.replacen(".irradiance.", ".", 1)));
    std::iter::once(of(name)).chain(main).collect()
}

/// The report `path`, where it is one.
fn read(path: &Path) -> Option<SideReport> {
    // Most files have none.
    if !path.is_file() {
        return None;
    }
    serde_json::from_slice(&super::decode::file_bytes(path, LONGEST).ok()?).ok()
}

impl SideReport {
    /// The path under which this lists the file `name` of that hash. Without hashes, that of a report whose
    /// name says that it `is_own`, or that of a target's file.
    fn listed(&self, name: &str, is_own: bool, hash: &dyn Fn() -> String) -> Option<String> {
        let files = &self.fingerprint.files;
        if files.is_empty() {
            let of_target =
                self.target.as_ref().is_some_and(|target| target.files.iter().any(|file| file == name));
            return (is_own || of_target).then(|| name.to_owned());
        }
        let hash = hash();
        if files.get(name).is_some_and(|listed| *listed == hash) {
            return Some(name.to_owned());
        }
        // A file may be renamed together with its report.
        let renamed = files.iter().find(|(_, listed)| is_own && **listed == hash);
        renamed.map(|(path, _)| path.clone())
    }

    /// What this says of the file that it lists as `path`; `None` for files that are no part of the bake
    /// itself, such as the source without its sun.
    fn describes(&self, path: &str) -> Option<Described> {
        if path.ends_with("sunless.exr") {
            return None;
        }
        let content = match &self.target {
            Some(target) => Target::named(&target.name)?.content_of(path)?,
            None if path.contains(".irradiance.") || path.starts_with("irradiance") => Content::Irradiance,
            None => Content::Specular,
        };
        let mut provenance = self.provenance();
        let of = |levels: &[ReportLevel]| levels.iter().map(|level| level.roughness).collect::<Vec<_>>();
        let roughness = match content {
            Content::Irradiance => {
                provenance.content = Some(IRRADIANCE.to_owned());
                provenance.lobe = Some(Lobe::Cosine);
                provenance.ladder = None;
                provenance.chain = None;
                vec![1.0]
            }
            Content::Sheen => {
                provenance.lobe = Some(Lobe::Charlie);
                provenance.chain = provenance.chain.map(|_| ChainKind::Sampled);
                of(&self.sheen)
            }
            Content::Skybox => of(self.levels.get(..1)?),
            Content::Panorama => {
                provenance.quarter_turns = provenance
                    .target
                    .as_deref()
                    .and_then(Target::named)
                    .map(|target| target.quarter_turns)
                    .filter(|turns| *turns != 0);
                of(&self.levels)
            }
            _ => of(&self.levels),
        };
        let sound = roughness.iter().all(|roughness| (0.0..=1.0).contains(roughness));
        sound.then_some(Described { provenance, roughness })
    }

    /// What this says of all files.
    pub(super) fn provenance(&self) -> Provenance {
        let Options { lobe, filter, ladder, rotate_y, mirror } = &self.options;
        Provenance {
            target: self.target.as_ref().map(|target| target.name.clone()),
            content: None,
            flip: self.target.as_ref().and_then(|target| Flip::named(target.flip.as_deref()?)),
            quarter_turns: None,
            rotate_y: rotate_y.filter(|degrees| degrees.is_finite()),
            mirror: *mirror,
            sun: self.sun,
            lobe: lobe.as_deref().and_then(Lobe::named),
            filter: filter.clone(),
            ladder: ladder.clone(),
            chain: self.chain.as_deref().and_then(ChainKind::named),
        }
    }

    /// The files of the target, where this is the report of one.
    pub(super) fn target_files(&self) -> Option<&[String]> {
        self.target.as_ref().map(|target| &target.files[..])
    }
}

/// Name of the report in a folder of outputs.
pub const REPORT: &str = "report.json";

/// Bytes that a report may have when it is read back. Those of the largest bakes have less than a tenth of
/// it.
pub const MOST_REPORT_BYTES: u64 = 16 << 20;
