//! Files: environments in any format and layout, and the chains that a bake writes; outputs that appear whole
//! or not at all. One codec a file.
//!
//! A file is read by its content, not by its name. Whatever it holds, reading it ends in a [`Loaded`] or in a
//! one-line [`Error`]: a panic of a decoder is caught, and no header is believed before its size is checked
//! against [`ReadOptions::memory_limit`].

mod color;
#[cfg(feature = "mesh")]
pub(crate) mod confined;
pub mod cube_file;
pub mod cube_write;
pub mod dds;
mod decode;
pub mod environment_write;
pub mod exr;
mod face_names;
mod fit;
pub mod hdr;
mod key_values;
pub mod ktx1;
pub mod ktx2;
pub mod layout;
pub mod ldr;
mod level_folder;
pub mod level_images;
pub mod oem_write;
pub mod output;
pub(crate) mod panics;
mod picture;
pub mod provenance;
pub mod regular;
mod repair;
pub mod side_report;
mod target_folder;
mod temporary;

use decode::{Format, decode, file_bytes, unreadable};
pub use decode::{has_readable_name, readable_extensions};
pub use fit::Pad;
pub use layout::LayoutChoice;
pub use picture::DEFAULT_MEMORY_LIMIT;
pub use repair::Repairs;

use crate::chain::Chain;
use crate::environment::{Environment, Rgb};
use crate::error::{Error, Result, printable};
use panics::contained;
use picture::Stored;
use picture::{Content, Picture, Source};
use provenance::Provenance;
use std::cell::OnceCell;
use std::fs;
use std::path::{Path, PathBuf};

/// How to read.
#[derive(Clone, Debug)]
pub struct ReadOptions {
    /// How the image covers the sphere.
    pub layout: LayoutChoice,
    /// Repair NaN (to 0) and Inf (to the largest finite neighbour) instead of refusing them.
    pub sanitize: bool,
    /// Refuse any repair, negative radiance included.
    pub strict: bool,
    /// What radiance is multiplied by, finite and above 0.
    pub scale: f64,
    /// Remove the black bars of a panorama that is not 2:1.
    pub crop: bool,
    /// Fill up a panorama that is not 2:1; every image is taken for a panorama then.
    pub pad: Option<Pad>,
    /// Bytes that reading one environment may take at its peak, the file included.
    pub memory_limit: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            layout: LayoutChoice::Auto,
            sanitize: false,
            strict: false,
            scale: 1.0,
            crop: false,
            pad: None,
            memory_limit: DEFAULT_MEMORY_LIMIT,
        }
    }
}

/// An environment as read.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The environment, finite and not negative.
    pub environment: Environment,
    /// What was repaired.
    pub repaired: Repairs,
    /// What the user should know, a line each, without the file's name.
    pub warnings: Vec<String>,
    /// The encoding in words, such as `OpenEXR, half, DWAB`.
    pub format: String,
    /// The layout in words, such as `horizontal cross`.
    pub layout: &'static str,
    /// Columns of the image (of one face where the file holds faces).
    pub width: u32,
    /// Rows of the image (of one face where the file holds faces).
    pub height: u32,
    /// What the file says of its origin. The environment is in the file's world already, see [`provenance`].
    pub provenance: Provenance,
}

/// A prefiltered chain as read.
#[derive(Clone, Debug)]
pub struct LoadedChain {
    /// The chain in the file's world, see [`provenance`].
    pub chain: Chain,
    /// What the file says of its origin.
    pub provenance: Provenance,
    /// The encoding in words, such as `KTX2 cube, RGBA16F, 9 levels`.
    pub format: String,
    /// The file or the folder of levels: in a target's folder, the file that holds its levels.
    pub path: PathBuf,
}

/// Reads an environment: an image, a cube in KTX, KTX2 or DDS, a level folder as `bake` writes it (its level
/// 0), or the folder of a target (level 0 of the file that holds its levels).
///
/// It comes back in its world, see [`provenance`]: flips are undone.
///
/// # Errors
/// [`Error::Io`] where the system refuses, [`Error::Input`] for a file that is not what it should be,
/// [`Error::NonFinite`] for NaN and Inf unless `options.sanitize`, [`Error::Limit`] for more pixels than
/// `options.memory_limit` allows, [`Error::Parameter`] for a layout that the file cannot have.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Loaded> {
    let place = Place::of(path)?;
    let Place::File(file) = &place else {
        return finish(path, level_folder::read_environment(path, options.memory_limit)?, options);
    };
    let bytes = file_bytes(file, options.memory_limit)?;
    let source = Source { path: file, bytes: &bytes, memory_limit: options.memory_limit };
    let mut picture = contained(file, || decode(&source))?;
    if picture.provenance.rotate_y.is_none()
        && let Some(described) = side_report::of_file(file, || blake3::hash(&bytes))
    {
        picture.provenance = picture.provenance.or(described.provenance);
    }
    drop(bytes);
    finish(file, picture, options)
}

/// [`read`] for a file already in memory; `path` names it in messages, its extension says what it claims to
/// be. No report is looked for.
///
/// # Errors
/// As [`read`].
pub fn read_from_memory(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Loaded> {
    let source = Source { path, bytes, memory_limit: options.memory_limit };
    let picture = contained(path, || decode(&source))?;
    finish(path, picture, options)
}

/// Reads six square images of equal size as one cube: by name where the names say (`px`, `posx`, `right`,
/// `+x`, ... at the end of the stem), else in the order +X -X +Y -Y +Z -Z.
///
/// # Errors
/// As [`read`]; [`Error::Parameter`] for any number of files but six and for names that contradict each
/// other.
pub fn read_faces(paths: &[PathBuf], options: &ReadOptions) -> Result<Loaded> {
    if !matches!(options.layout, LayoutChoice::Auto | LayoutChoice::Faces) {
        return Err(Error::Parameter("six files are one cube; use `layout` faces".to_owned()));
    }
    let ordered = face_names::in_face_order(paths)?;
    let (picture, repaired) = read_square_faces(&ordered, options)?;
    finish_finite(ordered[0], picture, options.layout, false, repaired, options)
}

/// Reads a prefiltered cube chain: a KTX or KTX2 file, a DDS file with its report beside it, an EXR file with
/// a part a face, a level folder (`m{level}_{px,..}.exr` or `.hdr`, or `m{level}.exr` unfolded, and
/// `report.json`), or the folder of a target. It comes back in its world, see [`provenance`].
///
/// # Errors
/// As [`read`]; NaN and Inf are always refused.
pub fn read_chain(path: &Path) -> Result<Chain> {
    Ok(load_chain(path)?.chain)
}

/// [`read_chain`] with what the file says of itself.
///
/// # Errors
/// As [`read_chain`].
pub fn load_chain(path: &Path) -> Result<LoadedChain> {
    let memory_limit = DEFAULT_MEMORY_LIMIT;
    let file = match Place::of(path)? {
        Place::Levels => return in_world(path, level_folder::read_chain(path, memory_limit)?),
        Place::File(file) => file,
    };
    let bytes = file_bytes(&file, memory_limit)?;
    let source = Source { path: &file, bytes: &bytes, memory_limit };
    let described = OnceCell::new();
    let report = || described.get_or_init(|| side_report::of_file(&file, || blake3::hash(&bytes))).as_ref();
    let mut stored = if Format::sniff(&bytes) == Some(Format::Dds) {
        let Some(report) = report() else {
            return Err(source.error(format!(
                "it does not say its levels' roughness, and {}.report.json is not there, nor another report that \
                 lists this file's hash; bake it anew",
                file.display()
            )));
        };
        contained(&file, || dds::read::decode_chain(&source, &report.roughness))?
    } else {
        contained(&file, || decode_chain(&source))?
    };
    if stored.provenance.rotate_y.is_none()
        && let Some(report) = report()
    {
        stored.provenance = stored.provenance.or(report.provenance.clone());
    }
    in_world(&file, stored)
}

/// Reads a chain in a KTX, KTX2 or EXR file already in memory; `path` names it in messages. No report is
/// looked for.
///
/// # Errors
/// As [`read_chain`].
pub fn read_chain_from_memory(path: &Path, bytes: &[u8], memory_limit: u64) -> Result<Chain> {
    let source = Source { path, bytes, memory_limit };
    Ok(in_world(path, contained(path, || decode_chain(&source))?)?.chain)
}

/// A chain of any container that says its levels' roughness.
fn decode_chain(source: &Source<'_>) -> Result<Stored> {
    match Format::sniff(source.bytes) {
        Some(Format::OpenExr) => exr::read::decode_chain(source),
        Some(Format::Ktx1) => ktx1::read::decode_chain(source),
        Some(Format::Ktx2) => ktx2::read::decode_chain(source),
        _ => Err(unreadable(source).unwrap_or_else(|| {
            source.error(
                "it holds no chain; a chain is a cube in KTX2, KTX, DDS or EXR parts, or a folder of levels",
            )
        })),
    }
}

/// The chain with its flip undone.
fn in_world(path: &Path, stored: Stored) -> Result<LoadedChain> {
    let Stored { chain, provenance, format } = stored;
    let chain = provenance.world_chain(chain).map_err(|message| Error::input(path, message))?;
    Ok(LoadedChain { chain, provenance, format, path: path.to_owned() })
}

/// The file or the folder of levels that [`read`] reads for `path`: in the folder of a target, the file that
/// holds its levels.
///
/// # Errors
/// As [`read`] where there is no such file.
pub fn levels_path(path: &Path) -> Result<PathBuf> {
    Ok(match Place::of(path)? {
        Place::File(file) => file,
        Place::Levels => path.to_owned(),
    })
}

/// Whether the folder `path` holds a bake, and no sources: levels, a report, or the levels of a target that are
/// no panorama, whose names sources have as well.
#[must_use]
pub fn is_bake_folder(path: &Path) -> bool {
    let levels = || target_folder::levels_file(path).ok().flatten();
    path.join(side_report::REPORT).is_file()
        || level_folder::has_levels(path)
        || levels().is_some_and(|file| !target_folder::is_panorama(&file))
}

/// What the report of the file `path`, whose content has that BLAKE3 `hash`, says of its origin, as key/value
/// pairs.
#[must_use]
pub fn reported_pairs(path: &Path, hash: blake3::Hash) -> Vec<(String, String)> {
    side_report::of_file(path, || hash).map_or_else(Vec::new, |described| described.provenance.pairs())
}

/// Where a path leads to.
enum Place {
    /// A file, also the one that holds the levels in the folder of a target.
    File(PathBuf),
    /// A folder of levels.
    Levels,
}

impl Place {
    fn of(path: &Path) -> Result<Self> {
        if !is_directory(path)? {
            return Ok(Self::File(path.to_owned()));
        }
        if level_folder::has_levels(path) {
            return Ok(Self::Levels);
        }
        Ok(target_folder::levels_file(path)?.map_or(Self::Levels, Self::File))
    }
}

/// Whether `path` is a directory.
fn is_directory(path: &Path) -> Result<bool> {
    Ok(fs::metadata(path).map_err(|source| Error::io(path, source))?.is_dir())
}

/// Reads six images into one cube, NaN and Inf repaired or refused.
fn read_square_faces(ordered: &[&Path], options: &ReadOptions) -> Result<(Picture, Repairs)> {
    let mut repaired = Repairs::default();
    let mut cube: Option<Picture> = None;
    for &path in ordered {
        if is_directory(path)? {
            return Err(Error::input(path, "a directory where a face image is needed"));
        }
        let bytes = file_bytes(path, options.memory_limit)?;
        let source = Source { path, bytes: &bytes, memory_limit: options.memory_limit };
        let mut face = contained(path, || decode(&source))?;
        if face.content == Content::Cube {
            return Err(source.error("already a whole cube; give it alone"));
        }
        if face.width != face.height {
            return Err(
                source.error(format!("{}x{} is not square, as a face must be", face.width, face.height))
            );
        }
        repair::non_finite(path, &mut face.texels, face.width, options.sanitize, &mut repaired)?;
        match &mut cube {
            None => {
                source.check_memory(face.width, face.height, 6 * 12)?;
                face.texels.reserve_exact(5 * face.texels.len());
                cube = Some(face);
            }
            Some(cube) if cube.width != face.width => {
                return Err(source.error(format!(
                    "{0}x{0} but the first face is {1}x{1}; six faces of equal size are needed",
                    face.width, cube.width
                )));
            }
            Some(cube) => {
                cube.texels.append(&mut face.texels);
                for warning in face.warnings {
                    if !cube.warnings.contains(&warning) {
                        cube.warnings.push(warning);
                    }
                }
            }
        }
    }
    let mut cube = cube.ok_or_else(|| Error::Parameter("six faces are needed, got none".to_owned()))?;
    cube.height = 6 * cube.width;
    cube.content = Content::Cube;
    Ok((cube, repaired))
}

/// Picture to environment: layout, repairs, checks.
fn finish(path: &Path, mut picture: Picture, options: &ReadOptions) -> Result<Loaded> {
    let layout = fit::fit(path, &mut picture, options)?;
    let mut repaired = Repairs::default();
    // Most pictures need no repair: one look tells.
    let sound = repair::is_sound(&picture.texels);
    if !sound {
        finite(path, &mut picture, options, &mut repaired)?;
    }
    finish_finite(path, picture, layout, sound, repaired, options)
}

/// Multiplies radiance by `scale`; returns what the user should know of that.
fn scaled(path: &Path, texels: &mut [Rgb], scale: f64) -> Result<Option<String>> {
    if !(scale.is_finite() && scale > 0.0) {
        return Err(Error::Parameter(format!("`scale` {scale} must be finite and above 0")));
    }
    if scale == 1.0 {
        return Ok(None);
    }
    let values = texels.as_flattened_mut();
    let greatest = values.iter().copied().fold(0.0, f32::max);
    let times = |value: f32| (f64::from(value) * scale) as f32;
    if times(greatest).is_infinite() {
        let most = f64::from(f32::MAX) / f64::from(greatest);
        return Err(Error::input(
            path,
            format!(
                "`scale` {scale:?} takes its greatest value, {greatest:.3e}, beyond float32; at most {most:.3e} does not"
            ),
        ));
    }
    for value in values {
        *value = times(*value);
    }
    Ok((greatest > 0.0 && times(greatest) == 0.0)
        .then(|| format!("`scale` {scale:?} rounds all its light to 0")))
}

/// Refuses or repairs NaN and Inf.
fn finite(path: &Path, picture: &mut Picture, options: &ReadOptions, repaired: &mut Repairs) -> Result<()> {
    if picture.content != Content::Cube {
        return repair::non_finite(path, &mut picture.texels, picture.width, options.sanitize, repaired);
    }
    let rows = picture.width;
    for (face, texels) in
        crate::sphere::cube::Face::ALL.iter().zip(picture.texels.chunks_mut(rows as usize * rows as usize))
    {
        let place = PathBuf::from(format!("{} face {}", path.display(), face.short_name()));
        repair::non_finite(&place, texels, rows, options.sanitize, repaired)?;
    }
    Ok(())
}

/// [`finish`] for a picture that is finite, and not negative either where it is `sound`.
fn finish_finite(
    path: &Path,
    picture: Picture,
    layout: LayoutChoice,
    sound: bool,
    mut repaired: Repairs,
    options: &ReadOptions,
) -> Result<Loaded> {
    let Picture { width, height, texels, content, format, mut warnings, provenance } = picture;
    let arrangement = layout::arrangement(path, width, height, content, layout)?;
    let texels = arrangement.arrange(texels, width);
    let mut texels =
        provenance.world_texels(arrangement.layout, texels).map_err(|message| Error::input(path, message))?;
    if !sound {
        repair::negative(arrangement.layout, &mut texels, &mut repaired);
    }
    if options.strict && repaired.any() {
        return Err(Error::input(
            path,
            format!("{repaired}; `strict` allows no repair, leave it out to set them right"),
        ));
    }
    warnings.extend(repaired.matters().then(|| format!("{repaired}, set right")));
    warnings.extend(scaled(path, &mut texels, options.scale)?);
    // Some quote names of layers and channels.
    let warnings = warnings.iter().map(|warning| printable(warning)).collect();
    let environment = Environment::of_sound(arrangement.layout, texels)?;
    let height = if content == Content::Cube { width } else { height };
    Ok(Loaded {
        environment,
        repaired,
        warnings,
        format,
        layout: arrangement.name,
        width,
        height,
        provenance,
    })
}
