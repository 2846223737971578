//! Finds the file with the levels in a folder written by `bake --target`.

use super::names_in;
use super::side_report::{REPORT, SideReport};
use crate::common::error::{Error, Result};
use crate::files::target::{Content, TARGETS, Target};
use std::path::{Path, PathBuf};

/// The file in `folder` with a target's levels: the one that `report.json` names, or without a report the one
/// whose name a target uses. `None` if `folder` is not a target's folder.
///
/// # Errors
/// [`Error::Input`] for a folder of several targets, and for files of several bakes.
pub(super) fn levels_file(folder: &Path) -> Result<Option<PathBuf>> {
    let report = folder.join(REPORT);
    if report.is_file() {
        // Reading the folder's levels reports errors in the report.
        let bytes = super::regular::read_regular(&report, super::side_report::MAX_REPORT_BYTES)?;
        let Ok(report) = serde_json::from_slice::<SideReport>(&bytes) else { return Ok(None) };
        let Some(first) = report.target.as_ref().and_then(|target| target.files.first()) else {
            return Ok(None);
        };
        // A report must not reference files outside its folder.
        let within =
            Path::new(first).components().all(|part| matches!(part, std::path::Component::Normal(_)));
        return Ok(within.then(|| folder.join(first)));
    }
    let own = names_in(folder)?;
    let targets: Vec<&str> =
        own.iter().map(String::as_str).filter(|name| Target::named(name).is_some()).collect();
    if !targets.is_empty() {
        let message = format!("it holds the folders of targets ({}); name one of them", targets.join(", "));
        return Err(Error::input(folder, message));
    }
    // Without a report (`bake --json` prints it instead) file names decide.
    let mut paths = own.clone();
    for name in own.iter().filter(|name| folder.join(name).is_dir()) {
        let inner = names_in(&folder.join(name)).unwrap_or_default();
        paths.extend(inner.into_iter().map(|inner| format!("{name}/{inner}")));
    }
    let holds_levels = |path: &&String| {
        let mut contents = TARGETS.iter().filter_map(|target| target.content_of(path));
        contents.any(|content| {
            use Content::{Atlas, Env, Glb, Oem, Panorama, Pyramid, Specular};
            matches!(content, Specular | Oem | Panorama | Env | Glb | Atlas | Pyramid)
        })
    };
    let found: Vec<&String> = paths.iter().filter(holds_levels).collect();
    match found[..] {
        [] => Ok(None),
        [one] => Ok(Some(folder.join(one))),
        [..] => {
            let names: Vec<&str> = found.iter().take(4).map(|name| name.as_str()).collect();
            let names = names.join(", ");
            let message = format!("it holds the levels of several bakes ({names}); name one of them");
            Err(Error::input(folder, message))
        }
    }
}

/// Whether the file `path` is named as a target's file with `content`.
pub(super) fn is_named(path: &Path, content: Content) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    TARGETS.iter().any(|target| target.content_of(&name) == Some(content))
}
