//! Reads a bake's report for data that a file's container cannot store.
//!
//! A report describes a file if it lists the BLAKE3 hash of the file's bytes. Reports of version 0.1 have no
//! hashes; they match by name.

use super::provenance::{IRRADIANCE, Provenance, TakenSun};
use super::regular::read_regular;
use crate::files::target::{Content, Flip, Target};
use crate::light::chain::ChainKind;
use crate::lobe::Lobe;
use serde::Deserialize;
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::path::Path;

/// Longest report that is read, in bytes.
const LONGEST: u64 = 64 << 20;

/// The parts of a report that describe its files. Only the levels are required.
#[derive(Debug, Deserialize)]
pub(super) struct SideReport {
    pub(super) levels: Vec<ReportLevel>,
    #[serde(default)]
    sheen: Vec<ReportLevel>,
    /// Called `options` in versions 0.1 and 0.2.
    #[serde(default, alias = "options")]
    recipe: Provenance,
    /// In reports of version 0.2 instead of `suns`.
    #[serde(default)]
    sun: Option<TakenSun>,
    #[serde(default)]
    suns: Vec<TakenSun>,
    #[serde(default)]
    pub(super) target: Option<TargetPart>,
    #[serde(default)]
    fingerprint: Fingerprint,
}

#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct ReportLevel {
    pub(super) level: u32,
    pub(super) size: u32,
    pub(super) roughness: f64,
}

#[derive(Debug, Deserialize)]
pub(super) struct TargetPart {
    name: String,
    /// In versions 0.1 and 0.2.
    flip: Option<Flip>,
    #[serde(default)]
    pub(super) files: Vec<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Fingerprint {
    /// Hashes by path.
    files: BTreeMap<String, String>,
}

/// A report's description of one file.
#[derive(Debug)]
pub(super) struct Described {
    pub(super) provenance: Provenance,
    /// The roughness of each of its levels.
    pub(super) roughness: Vec<f64>,
}

/// Finds the report's description of the file `path` with the given BLAKE3 `hash`.
///
/// The report is `FILE.report.json`, for an irradiance file that of its bake, or `report.json` in the file's
/// folder or its parent, for targets with subfolders.
pub(super) fn of_file(path: &Path, hash: impl Fn() -> blake3::Hash) -> Option<Described> {
    let name = path.file_name()?.to_str()?;
    let folders = [path.parent(), path.parent().and_then(Path::parent)];
    let shared = folders.into_iter().flatten().filter_map(|folder| {
        let name = path.strip_prefix(folder).ok()?.to_str()?.replace('\\', "/");
        Some((folder.join(REPORT), name, false))
    });
    let known = OnceCell::new();
    let hash = || known.get_or_init(|| hash().to_hex().to_string()).clone();
    let kinds = [".irradiance.", ".skybox."].into_iter().filter(|kind| name.contains(kind));
    let mains = kinds.map(|kind| name.replacen(kind, ".", 1));
    let own = std::iter::once(name.to_owned()).chain(mains);
    let own = own.map(|main| (path.with_file_name(format!("{main}.{REPORT}")), name.to_owned(), true));
    // Most files have no report.
    let found = own.chain(shared).filter(|(report, ..)| report.is_file());
    found.into_iter().find_map(|(report, name, is_own)| {
        let report: SideReport = serde_json::from_slice(&read_regular(&report, LONGEST).ok()?).ok()?;
        let listed = report.listed(&name, is_own, &hash)?;
        report.describes(&listed)
    })
}

impl SideReport {
    /// The path under which the report lists the file `name` with the given hash. Without hashes, matches by
    /// name: a report that `is_own` by its file name, or a target's file.
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

    /// Describes the file listed as `path`; `None` for files that are not levels of the bake, such as the
    /// source without its sun.
    fn describes(&self, path: &str) -> Option<Described> {
        if path.ends_with("sunless.exr") {
            return None;
        }
        let content = match &self.target {
            Some(target) => Target::named(&target.name)?.content_of(path)?,
            None if path.contains(".irradiance.") || path.starts_with("irradiance") => Content::Irradiance,
            None if path.contains(".skybox.") || path.starts_with("skybox") => Content::Skybox,
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
            Content::Skybox => {
                provenance.lobe = provenance.lobe.filter(|lobe| lobe.has_mirror()).or(Some(Lobe::Ggx));
                vec![0.0]
            }
            Content::Panorama | Content::SkyboxPanorama => {
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

    /// Provenance of all its files.
    pub(super) fn provenance(&self) -> Provenance {
        let target = self.target.as_ref();
        let scale = self.recipe.scale.filter(|scale| *scale > 0.0);
        Provenance {
            target: target.map(|target| target.name.clone()),
            flip: self.recipe.flip.or(target.and_then(|target| target.flip)),
            suns: if self.suns.is_empty() { self.sun.into_iter().collect() } else { self.suns.clone() },
            scale,
            ..self.recipe.clone()
        }
    }
}

/// Name of the report in a folder of outputs.
pub const REPORT: &str = "report.json";

/// Size limit of a report that is read back. The largest bakes need less than a tenth of it.
pub const MAX_REPORT_BYTES: u64 = 16 << 20;
