//! Level folders as `bake` writes them: `m{level}_{px,nx,py,ny,pz,nz}.exr` (or `.hdr`), or an image `m{level}.exr` (or
//! `.hdr`) a level, and `report.json`. Without the
//! report (`bake --json` prints it instead) EXR files still tell their roughness.

use super::contain::contained;
use super::layout::{LayoutChoice, arrangement};
use super::picture::{Content, Picture, Source};
use crate::chain::{CubeChain, CubeLevel};
use crate::environment::{Layout, Rgb};
use crate::error::{Error, Result};
use crate::sphere::cube::Face;
use std::path::{Path, PathBuf};

/// The part of `report.json` that says what the files are.
#[derive(serde::Deserialize)]
struct Report {
    levels: Vec<ReportLevel>,
}

#[derive(Clone, Copy, serde::Deserialize)]
struct ReportLevel {
    level: u32,
    size: u32,
    roughness: f64,
}

/// Level 0 as a picture.
pub(super) fn read_environment(folder: &Path, memory_limit: u64) -> Result<Picture> {
    let levels = read_report(folder, memory_limit)?;
    let first = levels[0];
    let mut picture = read_level(folder, first, memory_limit)?;
    picture.format = format!("level folder, {}, {} levels", picture.format, levels.len());
    Ok(picture)
}

/// Every level, with its roughness.
pub(super) fn read_chain(folder: &Path, memory_limit: u64) -> Result<CubeChain> {
    let levels = read_report(folder, memory_limit)?
        .into_iter()
        .map(|level| {
            let ReportLevel { size, roughness, .. } = level;
            let picture = read_level(folder, level, memory_limit)?;
            if picture.content != Content::Cube {
                return Err(Error::input(
                    folder,
                    "its levels are panoramas or octahedral squares; a chain is a cube, give one level as an environment",
                ));
            }
            let texels = picture.texels;
            check_finite(folder, level.level, size, &texels)?;
            Ok(CubeLevel { size, roughness, texels, bounds: None })
        })
        .collect::<Result<_>>()?;
    Ok(CubeChain { levels })
}

/// Refuses NaN and Inf in a level of a chain.
pub(super) fn check_finite(path: &Path, level: u32, size: u32, texels: &[Rgb]) -> Result<()> {
    let Some(at) = texels.iter().position(|texel| texel.iter().any(|value| !value.is_finite())) else {
        return Ok(());
    };
    let (size, face) = (size as usize, at / (size as usize * size as usize));
    let place = at % (size * size);
    Err(Error::input(
        path,
        format!(
            "level {level} face {} pixel ({}, {}) is {:?}; bake it anew",
            Face::ALL[face].short_name(),
            place % size,
            place / size,
            texels[at]
        ),
    ))
}

/// The levels that `report.json` lists, checked: numbered from 0, each half the size of the one before.
fn read_report(folder: &Path, memory_limit: u64) -> Result<Vec<ReportLevel>> {
    let path = folder.join("report.json");
    if !path.is_file() {
        return levels_of_files(folder, memory_limit);
    }
    let bytes = super::file_bytes(&path, memory_limit)?;
    let source = Source { path: &path, bytes: &bytes, memory_limit };
    parsed(&source)
}

/// The levels that the report `source` lists, checked.
fn parsed(source: &Source<'_>) -> Result<Vec<ReportLevel>> {
    let report: Report = serde_json::from_slice(source.bytes)
        .map_err(|error| source.error(format!("not a bake's report: {error}")))?;
    check_levels(source, &report.levels)?;
    Ok(report.levels)
}

/// The roughness of each level of the file `path`, by the report that a bake puts beside it.
pub(super) fn told_roughness(path: &Path, memory_limit: u64) -> Result<Vec<f64>> {
    let mut name = path.as_os_str().to_owned();
    name.push(".report.json");
    let report = PathBuf::from(name);
    if !report.is_file() {
        return Err(Error::input(
            path,
            format!("it does not say its levels' roughness, and {} is not there", report.display()),
        ));
    }
    let bytes = super::file_bytes(&report, memory_limit)?;
    let source = Source { path: &report, bytes: &bytes, memory_limit };
    Ok(parsed(&source)?.into_iter().map(|level| level.roughness).collect())
}

/// The levels that the files of a folder without a report tell of.
fn levels_of_files(folder: &Path, memory_limit: u64) -> Result<Vec<ReportLevel>> {
    let mut levels = Vec::new();
    for level in 0u32.. {
        let path = folder.join(format!("m{level}_px.exr"));
        if !path.is_file() {
            break;
        }
        let bytes = super::file_bytes(&path, memory_limit)?;
        let source = Source { path: &path, bytes: &bytes, memory_limit };
        let Some((size, roughness)) = contained(&path, || super::exr::level_told(&source))? else { break };
        levels.push(ReportLevel { level, size, roughness });
        check_levels(&source, &levels)?;
    }
    if levels.is_empty() {
        return Err(Error::input(
            folder,
            "a directory without a report.json; give an image, or a level folder that octagloss bake wrote",
        ));
    }
    Ok(levels)
}

/// Levels are numbered from 0, each half the size of the one before.
fn check_levels(source: &Source<'_>, levels: &[ReportLevel]) -> Result<()> {
    let Some(first) = levels.first() else { return Err(source.error("it lists no levels")) };
    for (expected, level) in (0u32..).zip(levels) {
        let size = first.size.checked_shr(expected).unwrap_or(0).max(1);
        if level.level != expected || level.size != size || !(0.0..=1.0).contains(&level.roughness) {
            return Err(source.error(format!(
                "its entry {expected} is level {} of size {} and roughness {}; level {expected} of size {size} and a \
                 roughness in [0, 1] is needed",
                level.level, level.size, level.roughness
            )));
        }
        if expected > 31 {
            return Err(source.error(format!("{} levels; 32 are the most there can be", levels.len())));
        }
    }
    Ok(())
}

/// Six faces of one level, one below the other; or its one image where that is no cube.
fn read_level(folder: &Path, level: ReportLevel, memory_limit: u64) -> Result<Picture> {
    if let Some(path) = image_file(folder, level.level) {
        return read_image(&path, level, memory_limit);
    }
    let mut cube: Option<Picture> = None;
    for face in Face::ALL {
        let path = face_file(folder, level.level, face)?;
        let bytes = super::file_bytes(&path, memory_limit)?;
        let source = Source { path: &path, bytes: &bytes, memory_limit };
        let mut picture = contained(&path, || super::decode(&source))?;
        if (picture.width, picture.height) != (level.size, level.size) {
            return Err(source.error(format!(
                "{}x{}, but report.json says that level {} is {size}x{size}",
                picture.width,
                picture.height,
                level.level,
                size = level.size
            )));
        }
        match &mut cube {
            None => cube = Some(picture),
            Some(cube) => cube.texels.append(&mut picture.texels),
        }
    }
    let mut cube = cube.expect("there are six faces");
    cube.height = 6 * cube.width;
    cube.content = Content::Cube;
    Ok(cube)
}

/// The file of a level that is one image.
fn image_file(folder: &Path, level: u32) -> Option<PathBuf> {
    let files = ["exr", "hdr"].into_iter().map(|extension| folder.join(format!("m{level}.{extension}")));
    files.into_iter().find(|path| path.is_file())
}

/// A level that is one image: faces cut out of crosses and strips, other maps as they are.
fn read_image(path: &Path, level: ReportLevel, memory_limit: u64) -> Result<Picture> {
    let bytes = super::file_bytes(path, memory_limit)?;
    let source = Source { path, bytes: &bytes, memory_limit };
    let mut picture = contained(path, || super::decode(&source))?;
    let (width, height) = (picture.width, picture.height);
    let arrangement = arrangement(path, width, height, picture.content, LayoutChoice::Auto)?;
    let (_, rows) = arrangement.layout.sides();
    if rows != level.size {
        return Err(source.error(format!(
            "{width}x{height}, but report.json says that level {} has {} rows a face or image",
            level.level, level.size
        )));
    }
    if matches!(arrangement.layout, Layout::Cube { .. }) {
        picture.texels = arrangement.arrange(picture.texels, width);
        (picture.width, picture.height) = (level.size, 6 * level.size);
        picture.content = Content::Cube;
    }
    Ok(picture)
}

fn face_file(folder: &Path, level: u32, face: Face) -> Result<PathBuf> {
    let stem = format!("m{level}_{}", face.short_name());
    ["exr", "hdr"]
        .into_iter()
        .map(|extension| folder.join(format!("{stem}.{extension}")))
        .find(|path| path.is_file())
        .ok_or_else(|| {
            Error::input(
                folder,
                format!("{stem}.exr (or .hdr) is missing, though report.json lists its level; bake it anew"),
            )
        })
}
