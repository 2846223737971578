//! Reads level folders written by `bake`: `m{level}_{px,nx,py,ny,pz,nz}.exr` (or `.hdr`), or an image
//! `m{level}.exr` (or `.hdr`) a level, and `report.json`. Without the report (`bake --json` prints it
//! instead) the roughness comes from the files' headers. Faces whose headers have none are taken for those of
//! Filament's cmgen.

use super::decode::Format;
use super::layout::{InputLayout, arrangement};
use super::map_header::settled;
use super::panics::catching_panics;
use super::picture::{LevelHeader, Picture, Source, check_finite};
use super::provenance::Provenance;
use super::regular::{open_regular, read_regular};
use super::side_report::{MAX_REPORT_BYTES, REPORT, ReportLevel, SideReport};
use super::{LoadedChain, cmgen, decoded, exr, hdr};
use crate::common::error::{Error, Result};
use crate::files::format::LevelName;
use crate::light::chain::{Chain, Level};
use crate::light::environment::Layout;
use crate::sphere::cube::Face;
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Header bytes read of a level's file; written headers have a few thousand.
const MAX_HEADER_BYTES: u64 = 64 << 10;

/// Tolerance: files store roughness in single precision or as text.
const SAME_ROUGHNESS: f64 = 1e-5;

/// The levels of a folder.
struct Listing {
    levels: Vec<ReportLevel>,
    provenance: Provenance,
    warnings: Vec<String>,
}

/// Whether the files of level 0 are in `folder`.
pub(super) fn has_levels(folder: &Path) -> bool {
    image_file(folder, 0).is_some() || face_file(folder, 0, Face::PosX).is_ok()
}

/// Level 0 as a picture.
pub(super) fn read_environment(folder: &Path, memory_limit: u64) -> Result<Picture> {
    let listing = Listing::read(folder, memory_limit)?;
    let mut picture = read_level(folder, listing.levels[0], memory_limit)?;
    picture.format = folder_format(&picture, listing.levels.len());
    picture.provenance = picture.provenance.or(listing.provenance);
    Ok(picture)
}

/// Reads every level with its roughness.
pub(super) fn read_chain(folder: &Path, memory_limit: u64) -> Result<LoadedChain> {
    let listing = Listing::read(folder, memory_limit)?;
    let Listing { levels, provenance, warnings } = listing;
    let mut stored = LoadedChain {
        chain: Chain { levels: Vec::new() },
        provenance,
        format: String::new(),
        path: folder.to_owned(),
        warnings,
    };
    for level in &levels {
        let ReportLevel { size, roughness, .. } = *level;
        let picture = read_level(folder, *level, memory_limit)?;
        let layout = match &picture {
            Picture { is_cube: true, .. } => Layout::Cube { size },
            Picture { width, height, .. } if width == height => Layout::Octahedral { size },
            Picture { width, height, .. } => Layout::Panorama { width: *width, height: *height },
        };
        if level.level == 0 {
            stored.format = folder_format(&picture, levels.len());
            stored.provenance = picture.provenance.or(stored.provenance);
        }
        let texels = picture.texels;
        check_finite(folder, level.level, size, &texels)?;
        stored.chain.levels.push(Level { layout, roughness, texels, bounds: None });
    }
    Ok(stored)
}

fn folder_format(first: &Picture, levels: usize) -> String {
    format!("level folder, {}, {levels} levels", first.format)
}

impl Listing {
    /// Reads the levels from `report.json`, or without it from the files' headers.
    fn read(folder: &Path, memory_limit: u64) -> Result<Self> {
        let path = folder.join(REPORT);
        if !path.is_file() {
            let needed = "give an image, or a level folder that octagloss bake wrote";
            return match Self::from_headers(folder)? {
                Some(listing) => Ok(listing),
                None => Self::from_cmgen(folder)?.ok_or_else(|| {
                    Error::input(folder, format!("a directory without a report.json; {needed}"))
                }),
            };
        }
        let bytes = read_regular(&path, memory_limit.min(MAX_REPORT_BYTES))?;
        let report: SideReport = serde_json::from_slice(&bytes)
            .map_err(|error| Error::input(&path, format!("not a bake's report: {error}")))?;
        check_levels(&path, &report.levels)?;
        let files = Self::from_headers(folder)?.map_or_else(Vec::new, |files| files.levels);
        let differ = |(said, found): &(&ReportLevel, &ReportLevel)| {
            (said.roughness - found.roughness).abs() > SAME_ROUGHNESS
        };
        if let Some((said, found)) = report.levels.iter().zip(&files).find(differ) {
            let (ReportLevel { level, roughness, .. }, found) = (said, found.roughness);
            let message = format!(
                "it has roughness {roughness} for level {level}, the files {found}: it belongs to another \
                 bake; remove it"
            );
            return Err(Error::input(&path, message));
        }
        Ok(Self { provenance: report.provenance(), levels: report.levels, warnings: Vec::new() })
    }

    /// Reads the levels from the files' headers; `None` if the first has no roughness.
    fn from_headers(folder: &Path) -> Result<Option<Self>> {
        let mut levels = Vec::new();
        for level in 0u32.. {
            let image = image_file(folder, level);
            let Some(path) = image.clone().or_else(|| face_file(folder, level, Face::PosX).ok()) else {
                break;
            };
            let header = level_header(&path)?;
            let Some(LevelHeader { width, height, roughness: Some(roughness) }) = header else { break };
            let size = match image {
                Some(_) => arrangement(&path, width, height, false, InputLayout::Auto)?.layout.sides().1,
                None => width,
            };
            levels.push(ReportLevel { level, size, roughness });
            check_levels(&path, &levels)?;
        }
        let (provenance, warnings) = (Provenance::default(), Vec::new());
        Ok((!levels.is_empty()).then_some(Self { levels, provenance, warnings }))
    }

    /// Takes face files without roughness for cmgen's, if there are several levels; six faces alone are a
    /// source.
    fn from_cmgen(folder: &Path) -> Result<Option<Self>> {
        let mut levels = Vec::new();
        for level in 0u32.. {
            let Ok(path) = face_file(folder, level, Face::PosX) else { break };
            let Some(LevelHeader { width: size, .. }) = level_header(&path)? else { break };
            levels.push(ReportLevel { level, size, roughness: 0.0 });
            if check_levels(&path, &levels).is_err() {
                return Ok(None);
            }
        }
        let count = levels.len();
        if count < 2 {
            return Ok(None);
        }
        let roughness = cmgen::roughness(count as u32, levels[0].size);
        levels.iter_mut().zip(roughness).for_each(|(level, roughness)| level.roughness = roughness);
        Ok(Some(Self { levels, provenance: cmgen::provenance(), warnings: vec![cmgen::warning(count)] }))
    }
}

/// Header of a level's image at `path`; `None` for other formats.
fn level_header(path: &Path) -> Result<Option<LevelHeader>> {
    let mut bytes = Vec::new();
    let start = open_regular(path)?.take(MAX_HEADER_BYTES).read_to_end(&mut bytes);
    start.map_err(|error| Error::io(path, error))?;
    let source = Source { path, bytes: &bytes, memory_limit: MAX_HEADER_BYTES };
    catching_panics(path, || match Format::sniff(&bytes) {
        Some(Format::OpenExr) => exr::read::level_header(&source),
        Some(Format::Radiance) => hdr::level_header(&source).map(Some),
        _ => Ok(None),
    })
}

/// Checks that levels are numbered from 0 and halve in size.
fn check_levels(path: &Path, levels: &[ReportLevel]) -> Result<()> {
    let Some(first) = levels.first() else { return Err(Error::input(path, "it lists no levels")) };
    for (expected, level) in (0u32..).zip(levels) {
        let size = first.size.checked_shr(expected).unwrap_or(0).max(1);
        if level.level != expected || level.size != size || !(0.0..=1.0).contains(&level.roughness) {
            let ReportLevel { level, size: own, roughness } = level;
            let message = format!(
                "its entry {expected} is level {level} of size {own} and roughness {roughness}; level \
                 {expected} of size {size} and a roughness in [0, 1] is needed"
            );
            return Err(Error::input(path, message));
        }
        if expected > 31 {
            let message = format!("{} levels; 32 are the most there can be", levels.len());
            return Err(Error::input(path, message));
        }
    }
    Ok(())
}

/// Reads the six faces of a level, stacked vertically, or its single image.
fn read_level(folder: &Path, level: ReportLevel, memory_limit: u64) -> Result<Picture> {
    if let Some(path) = image_file(folder, level.level) {
        return read_image(&path, level, memory_limit);
    }
    let mut cube: Option<Picture> = None;
    for face in Face::ALL {
        let path = face_file(folder, level.level, face)?;
        let picture = decoded(&path, &read_regular(&path, memory_limit)?, memory_limit)?;
        let (Picture { width, height, .. }, ReportLevel { level, size, .. }) = (&picture, level);
        if (*width, *height) != (size, size) {
            let message =
                format!("{width}x{height}, but report.json says that level {level} is {size}x{size}");
            return Err(Error::input(&path, message));
        }
        match &mut cube {
            None => cube = Some(picture),
            Some(cube) => cube.texels.extend(picture.texels),
        }
    }
    let cube = cube.expect("there are six faces");
    Ok(Picture { height: 6 * cube.width, is_cube: true, ..cube })
}

/// File of a level stored as one image.
fn image_file(folder: &Path, level: u32) -> Option<PathBuf> {
    stored(folder, LevelName::whole(level))
}

fn stored(folder: &Path, name: LevelName) -> Option<PathBuf> {
    let files = ["exr", "hdr"].map(|extension| folder.join(format!("{name}.{extension}")));
    files.into_iter().find(|path| path.is_file())
}

/// Reads a level stored as one image; cuts faces out of crosses and strips.
fn read_image(path: &Path, level: ReportLevel, memory_limit: u64) -> Result<Picture> {
    let mut picture = decoded(path, &read_regular(path, memory_limit)?, memory_limit)?;
    let (width, height) = (picture.width, picture.height);
    let layout = settled(path, InputLayout::Auto, picture.map.as_ref())?;
    let arrangement = arrangement(path, width, height, picture.is_cube, layout)?;
    let (_, rows) = arrangement.layout.sides();
    if rows != level.size {
        let ReportLevel { level, size, .. } = level;
        let message = format!(
            "{width}x{height}, but report.json says that level {level} has {size} rows a face or image"
        );
        return Err(Error::input(path, message));
    }
    if matches!(arrangement.layout, Layout::Cube { .. }) {
        picture.texels = arrangement.arrange(picture.texels, width);
        (picture.width, picture.height) = (level.size, 6 * level.size);
        picture.is_cube = true;
    }
    Ok(picture)
}

fn face_file(folder: &Path, level: u32, face: Face) -> Result<PathBuf> {
    let name = LevelName::face(level, face);
    let missing =
        || format!("{name}.exr (or .hdr) is missing, though report.json lists its level; bake it again");
    stored(folder, name).ok_or_else(|| Error::input(folder, missing()))
}
