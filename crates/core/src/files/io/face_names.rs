//! Recognises cube faces by file name.

use crate::common::error::{Result, wrong};
use crate::sphere::cube::Face;
use std::path::{Path, PathBuf};

/// Names of each face in the order of [`Face::ALL`], lower case.
const NAMES: [&[&str]; 6] = [
    &["px", "posx", "right", "+x"],
    &["nx", "negx", "left", "-x"],
    &["py", "posy", "top", "up", "+y"],
    &["ny", "negy", "bottom", "down", "-y"],
    &["pz", "posz", "front", "+z"],
    &["nz", "negz", "back", "-z"],
];

/// The face named by the end of `path`'s stem. The name must follow a non-letter, or a lower case letter if
/// it starts in upper case, or be the whole stem: `m0_px`, `Right`, `skyPosX`, but not `happy`.
fn named_face(path: &Path) -> Option<Face> {
    let stem = path.file_stem()?.to_str()?;
    let lower = stem.to_ascii_lowercase();
    Face::ALL.into_iter().find(|face| {
        NAMES[face.index()].iter().any(|name| {
            let Some(before) = lower.strip_suffix(name) else { return false };
            let (before, name) = stem.split_at(before.len());
            !before.ends_with(char::is_alphabetic)
                || name.starts_with(['+', '-'])
                || before.ends_with(char::is_lowercase) && name.starts_with(char::is_uppercase)
        })
    })
}

/// The six paths in the order of [`Face::ALL`]: by name if all six name a face, in the given order if none
/// does.
pub(super) fn in_face_order(paths: &[PathBuf]) -> Result<Vec<&Path>> {
    if paths.len() != 6 {
        return wrong(format!("a cube takes six face files, got {}", paths.len()));
    }
    let named: Vec<Option<Face>> = paths.iter().map(|path| named_face(path)).collect();
    if named.iter().all(Option::is_none) {
        return Ok(paths.iter().map(PathBuf::as_path).collect());
    }
    Face::ALL
        .into_iter()
        .map(|face| {
            let count = named.iter().filter(|name| **name == Some(face)).count();
            let at = named.iter().position(|name| *name == Some(face));
            match (at, count) {
                (Some(at), 1) => Ok(paths[at].as_path()),
                _ => wrong(format!(
                    "{count} of the six face files are named as {}; name each once (px nx py ny pz nz) or \
                     none",
                    face.short_name()
                )),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(names: [&str; 6]) -> Vec<PathBuf> {
        names.iter().map(PathBuf::from).collect()
    }

    #[test]
    fn names_decide_the_order_in_every_spelling() {
        for names in [
            ["a_nz.hdr", "a_pz.hdr", "a_ny.hdr", "a_py.hdr", "a_nx.hdr", "a_px.hdr"],
            ["NEGZ.png", "POSZ.png", "NEGY.png", "POSY.png", "NEGX.png", "POSX.png"],
            ["skyBack.exr", "skyFront.exr", "skyDown.exr", "skyUp.exr", "skyLeft.exr", "skyRight.exr"],
            ["s-z.hdr", "s+z.hdr", "s-y.hdr", "s+y.hdr", "s-x.hdr", "s+x.hdr"],
        ] {
            let given = paths(names);
            let reversed: Vec<&Path> = given.iter().rev().map(PathBuf::as_path).collect();
            assert_eq!(in_face_order(&given).unwrap(), reversed, "{names:?}");
        }
    }

    #[test]
    fn unnamed_files_keep_their_order() {
        let given = paths(["happy.hdr", "company.hdr", "3.hdr", "4.hdr", "5.hdr", "copyright.hdr"]);
        assert_eq!(in_face_order(&given).unwrap()[0], Path::new("happy.hdr"), "no face in these names");
    }

    #[test]
    fn contradicting_names_are_refused() {
        let given = paths(["px.hdr", "right.hdr", "py.hdr", "ny.hdr", "pz.hdr", "nz.hdr"]);
        let text = in_face_order(&given).unwrap_err().to_string();
        assert_eq!(
            text,
            "2 of the six face files are named as px; name each once (px nx py ny pz nz) or none"
        );
        let text = in_face_order(&given[..5]).unwrap_err().to_string();
        assert_eq!(text, "a cube takes six face files, got 5");
    }
}
