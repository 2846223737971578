//! File input and output: environments in any format and layout, chains of a bake, and atomic outputs. One
//! codec per file.
//!
//! A file's content decides its format, not its name. Reading any content returns a [`Loaded`] or a one-line
//! [`Error`]: decoder panics are caught, and sizes in headers are checked against
//! [`ReadOptions::memory_limit`] before allocation.

mod cmgen;
mod color;
pub mod cube_write;
mod dds;
mod decode;
pub mod environment_write;
pub mod exr;
mod face_names;
pub mod file_name;
mod fit;
pub mod hdr;
mod key_values;
pub mod ktx1;
pub mod ktx2;
pub mod layout;
pub mod ldr;
mod level_folder;
pub mod map_header;
pub mod npy;
pub mod oem_write;
pub mod output;
mod pad;
pub mod panics;
mod picture;
pub mod provenance;
mod pyramid_read;
pub mod pyramid_write;
pub mod regular;
mod repair;
pub mod side_report;
mod target_folder;
mod temporary;
mod texture;

pub use decode::{Format, has_readable_name, may_hold_chain, readable_extensions};
use decode::{decode, unreadable};
pub use layout::InputLayout;
pub use pad::Pad;
pub use picture::DEFAULT_MEMORY_LIMIT;
pub use repair::Repairs;

use crate::common::error::{Error, Result, printable, wrong};
use crate::files::target::Content;
use crate::light::chain::{Chain, Level};
use crate::light::environment::{Environment, Layout, Rgb, of_sound};
use crate::sphere::grid::Grid;
use crate::sphere::map::Texel;
use crate::sphere::registry::NamedMap;
use panics::catching_panics;
use picture::{Picture, Source};
use provenance::Provenance;
use regular::read_regular;
use std::cell::OnceCell;
use std::fs;
use std::path::{Path, PathBuf};

/// Options of reading.
#[derive(Clone, Debug)]
pub struct ReadOptions {
    /// Layout of the image.
    pub layout: InputLayout,
    /// Repair NaN (to 0) and Inf (to the largest finite neighbour) instead of rejecting them.
    pub sanitize: bool,
    /// Reject anything that needs repair, including negative radiance.
    pub strict: bool,
    /// Factor for the radiance, finite and above 0.
    pub scale: f64,
    /// Remove the black bars of a panorama that is not 2:1.
    pub crop: bool,
    /// Fill up a panorama that is not 2:1; every image is then read as a panorama.
    pub pad: Option<Pad>,
    /// Peak memory of reading one environment, including the file, in bytes.
    pub memory_limit: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            layout: InputLayout::Auto,
            sanitize: false,
            strict: false,
            scale: 1.0,
            crop: false,
            pad: None,
            memory_limit: DEFAULT_MEMORY_LIMIT,
        }
    }
}

/// An environment read from a file.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The environment, finite and non-negative.
    pub environment: Environment,
    /// Repairs made.
    pub repaired: Repairs,
    /// Warnings, one line each, without the file's name.
    pub warnings: Vec<String>,
    /// The encoding in words, such as `OpenEXR, half, DWAB`.
    pub format: String,
    /// The layout in words, such as `horizontal cross`.
    pub layout: &'static str,
    /// Columns of the image, or of one face for a file of faces.
    pub width: u32,
    /// Rows of the image, or of one face for a file of faces.
    pub height: u32,
    /// Origin recorded in the file. The environment is already in the file's world, see [`provenance`].
    pub provenance: Provenance,
}

/// A prefiltered chain read from a file.
#[derive(Clone, Debug)]
pub struct LoadedChain {
    /// The chain in the file's world, see [`provenance`].
    pub chain: Chain,
    /// Origin recorded in the file.
    pub provenance: Provenance,
    /// The encoding in words, such as `KTX2 cube, RGBA16F, 9 levels`.
    pub format: String,
    /// The file or level folder; for a target's folder, the file with its levels.
    pub path: PathBuf,
    /// Assumptions about what the file does not record, one line each, without its name.
    pub warnings: Vec<String>,
}

/// Reads an environment: an image, a cube in KTX, KTX2 or DDS, level 0 of a level folder written by `bake`,
/// or level 0 of the file with the levels in a target's folder.
///
/// The result is in the file's world, see [`provenance`]: flips are undone.
///
/// # Errors
/// [`Error::Io`] for system errors, [`Error::Input`] for an invalid file, [`Error::NonFinite`] for NaN and
/// Inf unless `options.sanitize`, [`Error::Limit`] for more pixels than `options.memory_limit` allows,
/// [`Error::Parameter`] for a layout that the file cannot have.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Loaded> {
    let (file, picture) = read_picture(path, options.memory_limit)?;
    finish(&file, picture, Repairs::default(), options)
}

/// Light on any map of the sphere, read from a file.
#[derive(Clone, Debug)]
pub struct LoadedMap {
    /// The light, finite and non-negative.
    pub light: MapLight,
    /// The map that was given or named by the header.
    pub map: Option<&'static NamedMap>,
    /// Warnings, one line each, without the file's name.
    pub warnings: Vec<String>,
}

/// A picture of any shape, as stored.
#[derive(Clone, Debug)]
pub struct PlainPicture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row-major, unchecked.
    pub texels: Vec<Rgb>,
    /// The encoding in words.
    pub format: String,
}

/// Reads the first level of `path` as a picture, whatever its shape and map.
///
/// # Errors
/// As [`read`].
pub fn read_plain(path: &Path, memory_limit: u64) -> Result<PlainPicture> {
    let (_, Picture { width, height, texels, format, .. }) = read_picture(path, memory_limit)?;
    Ok(PlainPicture { width, height, texels, format })
}

/// Light on any map of the sphere.
#[derive(Clone, Debug)]
pub enum MapLight {
    /// A map that environments can have.
    Environment(Environment),
    /// Another map: its texels, numbered as in [`Grid`].
    Components(Grid, Vec<Rgb>),
}

/// Reads light on any map of the sphere: on `from` if given, else on the map that the header names, else an
/// environment as [`read`]. A map's picture is as `convert` writes it; borders that the header names are
/// removed. `options.layout` is ignored.
///
/// # Errors
/// As [`read`]; [`Error::Input`] for a `from` that contradicts the header or the picture's shape.
pub fn read_map(path: &Path, from: Option<&'static NamedMap>, options: &ReadOptions) -> Result<LoadedMap> {
    let (file, picture) = read_picture(path, options.memory_limit)?;
    let map = map_header::chosen(&file, &picture, from)?;
    if let Some(map) = map.filter(|map| map_header::layout_of(map).is_none()) {
        return components(&file, picture, map, options);
    }
    let layout = map.and_then(map_header::layout_of).unwrap_or_default();
    let options = ReadOptions { layout, ..options.clone() };
    let loaded = finish(&file, picture, Repairs::default(), &options)?;
    Ok(LoadedMap { light: MapLight::Environment(loaded.environment), map, warnings: loaded.warnings })
}

/// Reads level 0 of `path` as a picture, with the file or folder that holds it.
fn read_picture(path: &Path, memory_limit: u64) -> Result<(PathBuf, Picture)> {
    let Some(file) = file_of(path)? else {
        return Ok((path.to_owned(), level_folder::read_environment(path, memory_limit)?));
    };
    let bytes = read_regular(&file, memory_limit)?;
    let mut picture = decoded(&file, &bytes, memory_limit)?;
    if picture.provenance.is_partial()
        && let Some(described) = side_report::of_file(&file, || blake3::hash(&bytes))
    {
        picture.provenance = picture.provenance.or(described.provenance);
    }
    Ok((file, picture))
}

/// Decodes the `bytes` of the file `path` to a picture.
fn decoded(path: &Path, bytes: &[u8], memory_limit: u64) -> Result<Picture> {
    let source = Source { path, bytes, memory_limit };
    catching_panics(path, || decode(&source))
}

/// Reads a file already in memory, as [`read`]; `path` names it in messages, and its extension is checked
/// against the content. Reports are not searched.
///
/// # Errors
/// As [`read`].
pub fn read_from_memory(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Loaded> {
    finish(path, decoded(path, bytes, options.memory_limit)?, Repairs::default(), options)
}

/// Reads six square images of equal size as one cube: by name if the stems end in face names (`px`, `posx`,
/// `right`, `+x`, ...), else in the order +X -X +Y -Y +Z -Z.
///
/// # Errors
/// As [`read`]; [`Error::Parameter`] unless there are six files, and for contradicting names.
pub fn read_faces(paths: &[PathBuf], options: &ReadOptions) -> Result<Loaded> {
    if !matches!(options.layout, InputLayout::Auto | InputLayout::Faces) {
        return wrong("six files are one cube; use `layout` faces");
    }
    let ordered = face_names::in_face_order(paths)?;
    let (picture, repaired) = read_square_faces(&ordered, options)?;
    finish(ordered[0], picture, repaired, options)
}

/// Reads a prefiltered chain: a KTX or KTX2 file, a DDS file with its report in the same folder, an EXR file
/// with one part per face, a level folder (`m{level}_{px,..}.exr` or `.hdr`, or an image `m{level}.exr`, and
/// `report.json`), the folder of a target, or a folder of faces that Filament's cmgen wrote. The result is in
/// the file's world, see [`provenance`].
///
/// # Errors
/// As [`read`]; NaN and Inf are always rejected.
pub fn read_chain(path: &Path) -> Result<Chain> {
    Ok(load_chain(path)?.chain)
}

/// [`read_chain`] with the file's provenance and format.
///
/// # Errors
/// As [`read_chain`].
pub fn load_chain(path: &Path) -> Result<LoadedChain> {
    let memory_limit = DEFAULT_MEMORY_LIMIT;
    let Some(file) = file_of(path)? else {
        return in_world(level_folder::read_chain(path, memory_limit)?);
    };
    let bytes = read_regular(&file, memory_limit)?;
    let source = Source { path: &file, bytes: &bytes, memory_limit };
    let described = OnceCell::new();
    let report = || described.get_or_init(|| side_report::of_file(&file, || blake3::hash(&bytes))).as_ref();
    let mut stored = if Format::sniff(&bytes) == Some(Format::Dds) {
        let Some(report) = report() else {
            return Err(source.error(format!(
                "the roughness of its levels is unknown: there is no {}.report.json and no other report that \
                 lists this file's hash; bake it again",
                file.display()
            )));
        };
        catching_panics(&file, || dds::decode_chain(&source, &report.roughness))?
    } else {
        catching_panics(&file, || decode_chain(&source))?
    };
    if stored.provenance.is_partial()
        && let Some(report) = report()
    {
        stored.provenance = stored.provenance.or(report.provenance.clone());
    }
    in_world(stored)
}

/// Reads a chain in a KTX, KTX2 or EXR file already in memory; `path` names it in messages. Reports are not
/// searched.
///
/// # Errors
/// As [`read_chain`].
pub fn read_chain_from_memory(path: &Path, bytes: &[u8], memory_limit: u64) -> Result<Chain> {
    let source = Source { path, bytes, memory_limit };
    Ok(in_world(catching_panics(path, || decode_chain(&source))?)?.chain)
}

/// Decodes a chain, as it is stored, of any container that stores its levels' roughness.
fn decode_chain(source: &Source<'_>) -> Result<LoadedChain> {
    match Format::sniff(source.bytes) {
        Some(Format::OpenExr) => exr::read::decode_chain(source),
        Some(Format::Ktx1) => ktx1::decode_chain(source),
        Some(Format::Ktx2) => {
            let texture = ktx2::read::open(source)?;
            if texture.is_pyramid() {
                return pyramid_read::decode_chain(&texture);
            }
            texture.chain(texture.roughness()?)
        }
        _ => Err(unreadable(source).unwrap_or_else(|| {
            source.error(
                "it holds no chain; a chain is a cube in KTX2, KTX, DDS or EXR parts, or a folder of levels",
            )
        })),
    }
}

/// The irradiance over pi of the pyramid in the file `path`; `None` if it is none.
///
/// # Errors
/// As [`read_chain`].
pub fn pyramid_irradiance(path: &Path) -> Result<Option<Level>> {
    if !path.is_file() {
        return Ok(None);
    }
    decoded_if(path, Format::Ktx2, |source| {
        let texture = ktx2::read::open(source)?;
        texture.is_pyramid().then(|| pyramid_read::decode_irradiance(&texture)).transpose()
    })
}

/// What `decode` makes of the file `path`; `None` if it is no `format`.
fn decoded_if<T>(
    path: &Path,
    format: Format,
    decode: impl FnOnce(&Source<'_>) -> Result<Option<T>>,
) -> Result<Option<T>> {
    let bytes = read_regular(path, DEFAULT_MEMORY_LIMIT)?;
    if Format::sniff(&bytes) != Some(format) {
        return Ok(None);
    }
    let source = Source { path, bytes: &bytes, memory_limit: DEFAULT_MEMORY_LIMIT };
    catching_panics(path, || decode(&source))
}

/// Undoes the flip of a chain as it is stored.
fn in_world(stored: LoadedChain) -> Result<LoadedChain> {
    let chain = stored.provenance.world_chain(stored.chain);
    let chain = chain.map_err(|message| Error::input(&stored.path, message))?;
    Ok(LoadedChain { chain, ..stored })
}

/// The panorama of a target, a file or in its folder, as a chain of one mirror level; `None` for other paths.
///
/// # Errors
/// [`Error::Io`] if there is no such path.
pub fn target_panorama(path: &Path) -> Result<Option<LoadedChain>> {
    regular::metadata(path)?;
    // Other readers report what is wrong with a file.
    let Ok(Loaded { environment, provenance, format, warnings, .. }) = read(path, &ReadOptions::default())
    else {
        return Ok(None);
    };
    let layout = environment.layout();
    if provenance.target.is_none() || !matches!(layout, Layout::Panorama { .. }) {
        return Ok(None);
    }
    let level = Level { layout, roughness: 0.0, texels: environment.texels().to_vec(), bounds: None };
    let chain = Chain { levels: vec![level] };
    Ok(Some(LoadedChain { chain, provenance, format, path: levels_path(path)?, warnings }))
}

/// Spherical harmonics in the KTX 1 file `path` as text, nine lines of red, green and blue, in Filament's
/// scale; `None` for other files and without them.
///
/// # Errors
/// As [`read_chain`].
pub fn filament_harmonics(path: &Path) -> Result<Option<String>> {
    decoded_if(path, Format::Ktx1, ktx1::harmonics)
}

/// The file or level folder that [`read`] reads for `path`: for a target's folder, the file with its levels.
///
/// # Errors
/// As [`read`] if there is no such file.
pub fn levels_path(path: &Path) -> Result<PathBuf> {
    Ok(file_of(path)?.unwrap_or_else(|| path.to_owned()))
}

/// Whether the folder `path` holds a bake rather than sources: levels, a report, or the levels of a target.
/// Panoramas do not count, since sources have such names too.
pub fn is_bake_folder(path: &Path) -> bool {
    let levels = || target_folder::levels_file(path).ok().flatten();
    path.join(side_report::REPORT).is_file()
        || level_folder::has_levels(path)
        || levels().is_some_and(|file| !target_folder::is_named(&file, Content::Panorama))
}

/// Origin of the file `path` with the given BLAKE3 `hash`, from its report.
pub fn reported(path: &Path, hash: blake3::Hash) -> Option<Provenance> {
    side_report::of_file(path, || hash).map(|described| described.provenance)
}

/// The file to read for `path`: for a target's folder, the one with its levels; `None` for a folder of
/// levels.
fn file_of(path: &Path) -> Result<Option<PathBuf>> {
    if !regular::metadata(path)?.is_dir() {
        return Ok(Some(path.to_owned()));
    }
    if level_folder::has_levels(path) { Ok(None) } else { target_folder::levels_file(path) }
}

/// Names in `folder`, sorted.
///
/// # Errors
/// [`Error::Io`] if it cannot be read.
pub fn names_in(folder: &Path) -> Result<Vec<String>> {
    let fail = |error| Error::io(folder, error);
    let name = |entry: std::io::Result<fs::DirEntry>| {
        Ok(entry.map_err(fail)?.file_name().to_string_lossy().into_owned())
    };
    let mut names = fs::read_dir(folder).map_err(fail)?.map(name).collect::<Result<Vec<_>>>()?;
    names.sort();
    Ok(names)
}

/// Reads six images into one cube; repairs or rejects NaN and Inf.
fn read_square_faces(ordered: &[&Path], options: &ReadOptions) -> Result<(Picture, Repairs)> {
    let mut repaired = Repairs::default();
    let mut cube: Option<Picture> = None;
    for &path in ordered {
        if regular::metadata(path)?.is_dir() {
            return Err(Error::input(path, "a directory where a face image is needed"));
        }
        let bytes = read_regular(path, options.memory_limit)?;
        let source = Source { path, bytes: &bytes, memory_limit: options.memory_limit };
        let mut face = catching_panics(path, || decode(&source))?;
        if face.is_cube {
            return Err(source.error("already a whole cube; use it as the only input"));
        }
        if let Some(header) = &face.map {
            return Err(source.error(format!(
                "its header says that its map is {}; use it as the only input",
                header.map.name
            )));
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
    cube.is_cube = true;
    Ok((cube, repaired))
}

/// Converts a picture, in which `repaired` was repaired, to an environment: layout, repairs, checks.
fn finish(path: &Path, mut picture: Picture, mut repaired: Repairs, options: &ReadOptions) -> Result<Loaded> {
    let layout = map_header::settled(path, options.layout, picture.map.as_ref())?;
    let layout = fit::fit(path, &mut picture, layout, options)?;
    if let Some(header) = &picture.map {
        map_header::grid_of(path, header.map, [picture.width, picture.height], map_header::RESHAPED)?;
    }
    // Most pictures need no repair; one pass detects them.
    let sound = repair::is_sound(&picture.texels);
    if !sound {
        finite(path, &mut picture, options, &mut repaired)?;
    }
    let Picture { width, height, texels, is_cube, map: _, format, warnings, provenance } = picture;
    let arrangement = layout::arrangement(path, width, height, is_cube, layout)?;
    let texels = arrangement.arrange(texels, width);
    let mut texels =
        provenance.world_texels(arrangement.layout, texels).map_err(|message| Error::input(path, message))?;
    if !sound {
        // All texels of a panorama's row have the same.
        let (layout, mut last) = (arrangement.layout, (usize::MAX, 0.0));
        let density = |index| {
            let row = index / layout.sides().0 as usize;
            if row != last.0 || !matches!(layout, Layout::Panorama { .. }) {
                last = (row, repair::density(layout, index));
            }
            last.1
        };
        repair::negative(&mut texels, density, &mut repaired);
    }
    let warnings = finish_texels(path, &mut texels, &repaired, warnings, options)?;
    let environment = of_sound(arrangement.layout, texels)?;
    let height = if is_cube { width } else { height };
    let layout = arrangement.name;
    Ok(Loaded { environment, repaired, warnings, format, layout, width, height, provenance })
}

/// Multiplies radiance by `scale`; returns warnings.
fn scaled(path: &Path, texels: &mut [Rgb], scale: f64) -> Result<Option<String>> {
    if !(scale.is_finite() && scale > 0.0) {
        return wrong(format!("`scale` {scale} must be finite and above 0"));
    }
    if scale == 1.0 {
        return Ok(None);
    }
    let values = texels.as_flattened_mut();
    let greatest = values.iter().copied().fold(0.0, f32::max);
    let times = |value: f32| (f64::from(value) * scale) as f32;
    if times(greatest).is_infinite() {
        let most = f64::from(f32::MAX) / f64::from(greatest);
        let message = format!(
            "`scale` {scale:?} moves the greatest value, {greatest:.3e}, beyond float32; use at most \
             {most:.3e}"
        );
        return Err(Error::input(path, message));
    }
    for value in values {
        *value = times(*value);
    }
    Ok((greatest > 0.0 && times(greatest) == 0.0)
        .then(|| format!("`scale` {scale:?} rounds all its light to 0")))
}

/// Rejects or repairs NaN and Inf.
fn finite(path: &Path, picture: &mut Picture, options: &ReadOptions, repaired: &mut Repairs) -> Result<()> {
    if !picture.is_cube {
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

/// Refuses repairs if `options` says so, and scales; returns all warnings.
fn finish_texels(
    path: &Path,
    texels: &mut [Rgb],
    repaired: &Repairs,
    mut warnings: Vec<String>,
    options: &ReadOptions,
) -> Result<Vec<String>> {
    if options.strict && repaired.any() {
        let message = format!("{repaired}; `strict` forbids repairs, omit it to repair them");
        return Err(Error::input(path, message));
    }
    let remedy = if repaired.nan + repaired.infinite == 0 { "set to 0" } else { "repaired" };
    warnings.extend(repaired.matters().then(|| format!("{repaired}, {remedy}")));
    warnings.extend(scaled(path, texels, options.scale)?);
    // Some warnings quote layer and channel names.
    Ok(warnings.iter().map(|warning| printable(warning)).collect())
}

/// Splits the picture of `map`, which no environment has, into the texels of its components; repairs and
/// checks them.
fn components(
    path: &Path,
    mut picture: Picture,
    map: &'static NamedMap,
    options: &ReadOptions,
) -> Result<LoadedMap> {
    if options.crop || options.pad.is_some() {
        let message = format!("`pad` and `crop` are for panoramas, and its map is {}; omit them", map.name);
        return Err(Error::input(path, message));
    }
    let Picture { width, height, provenance, .. } = &picture;
    let grid = map_header::grid_of(path, map, [*width, *height], map_header::RESHAPED)?;
    provenance.check_unturned().map_err(|message| Error::input(path, message))?;
    let mut repaired = Repairs::default();
    finite(path, &mut picture, options, &mut repaired)?;
    let at = |texel: Texel| {
        let [left, top] = grid.picture_origin(texel.component, 0);
        picture.texels[(top + texel.y) as usize * picture.width as usize + (left + texel.x) as usize]
    };
    let mut texels: Vec<Rgb> = grid.texels().map(at).collect();
    let density = |index| {
        let place = grid.centre(grid.texel(index));
        let inside = map.map.contains(place.component, place.uv);
        if inside { map.map.density(place.component, place.uv) } else { 0.0 }
    };
    repair::negative(&mut texels, density, &mut repaired);
    let warnings = finish_texels(path, &mut texels, &repaired, picture.warnings, options)?;
    Ok(LoadedMap { light: MapLight::Components(grid, texels), map: Some(map), warnings })
}

impl Environment {
    /// Reads an environment from an image, a cube file or a bake, as [`read`] does by default.
    ///
    /// # Errors
    /// Those of [`read`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Ok(read(path.as_ref(), &ReadOptions::default())?.environment)
    }

    /// Writes the texels as they are to an `.exr` or `.hdr` file that does not exist yet; cubes as a
    /// horizontal cross.
    ///
    /// # Errors
    /// Those of [`environment_write::write_environment`].
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        environment_write::write_environment(path.as_ref(), output::Existing::Keep, self, "octagloss")
    }
}
