//! Files: environments in any format and layout, and the chains that a bake writes; outputs that appear whole or not
//! at all. One codec a file.
//!
//! A file is read by its content, not by its name. Whatever it holds, reading it ends in a [`Loaded`] or in a one-line
//! [`Error`]: a panic of a decoder is caught, and no header is believed before its size is
//! checked against [`ReadOptions::memory_limit`].

pub mod bc6h;
mod color;
mod contain;
pub mod cube_write;
mod dds_read;
pub mod dds_write;
mod deflate;
pub mod environment_write;
mod exr;
pub mod exr_parts;
pub mod exr_write;
mod face_names;
mod hdr;
pub mod hdr_write;
mod key_values;
pub mod ktx1_write;
mod ktx2_file;
mod ktx2_read;
pub mod ktx2_write;
pub mod layout;
mod ldr;
mod level_folder;
pub mod level_images;
pub mod oem_write;
pub mod output;
mod picture;
pub mod pixels;
pub mod png_write;
pub mod r11g11b10;
mod repair;
pub mod rgbd;
pub mod table_write;
mod texel_bytes;
mod zstandard;

pub use layout::LayoutChoice;
pub use repair::Repairs;

use crate::chain::CubeChain;
use crate::environment::Environment;
use crate::error::{Error, Result};
use contain::contained;
use picture::{Content, Picture, Source};
use std::fs;
use std::path::{Path, PathBuf};

/// The default of [`ReadOptions::memory_limit`]: 3 GiB, enough for 16384x8192 texels.
pub const DEFAULT_MEMORY_LIMIT: u64 = 3 << 30;

/// How to read.
#[derive(Clone, Debug)]
pub struct ReadOptions {
    /// How the image covers the sphere.
    pub layout: LayoutChoice,
    /// Repair NaN (to 0) and Inf (to the largest finite neighbour) instead of refusing them.
    pub sanitize: bool,
    /// Refuse any repair, negative radiance included.
    pub strict: bool,
    /// Bytes that reading one environment may take at its peak, the file included.
    pub memory_limit: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            layout: LayoutChoice::Auto,
            sanitize: false,
            strict: false,
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
}

/// Reads an environment: an image, a KTX2 cube, or a level folder as `bake` writes it (its level 0).
///
/// # Errors
/// [`Error::Io`] where the system refuses, [`Error::Input`] for a file that is not what it should be,
/// [`Error::NonFinite`] for NaN and Inf unless `options.sanitize`, [`Error::Limit`] for more pixels than
/// `options.memory_limit` allows, [`Error::Parameter`] for a layout that the file cannot have.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Loaded> {
    if is_directory(path)? {
        return finish(path, level_folder::read_environment(path, options.memory_limit)?, options);
    }
    read_from_memory(path, &file_bytes(path, options.memory_limit)?, options)
}

/// [`read`] for a file already in memory; `path` names it in messages, its extension says what it claims to be.
///
/// # Errors
/// As [`read`].
pub fn read_from_memory(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Loaded> {
    let source = Source { path, bytes, memory_limit: options.memory_limit };
    let picture = contained(path, || decode(&source))?;
    finish(path, picture, options)
}

/// Reads six square images of equal size as one cube: by name where the names say (`px`, `posx`, `right`, `+x`, ... at
/// the end of the stem), else in the order +X -X +Y -Y +Z -Z.
///
/// # Errors
/// As [`read`]; [`Error::Parameter`] for any number of files but six and for names that contradict each other.
pub fn read_faces(paths: &[PathBuf], options: &ReadOptions) -> Result<Loaded> {
    if !matches!(options.layout, LayoutChoice::Auto | LayoutChoice::Faces) {
        return Err(Error::Parameter("six files are one cube; use --layout faces".to_owned()));
    }
    let ordered = face_names::in_face_order(paths)?;
    let (picture, repaired) = read_square_faces(&ordered, options)?;
    finish_finite(ordered[0], picture, false, repaired, options)
}

/// Reads a prefiltered cube chain: a KTX2 file, a DDS file with its report beside it, an EXR file with a part a face, or
/// a level folder (`m{level}_{px,..}.exr` or `.hdr`, or `m{level}.exr` unfolded, and `report.json`).
///
/// # Errors
/// As [`read`]; NaN and Inf are always refused.
pub fn read_chain(path: &Path) -> Result<CubeChain> {
    if is_directory(path)? {
        return level_folder::read_chain(path, DEFAULT_MEMORY_LIMIT);
    }
    let bytes = file_bytes(path, DEFAULT_MEMORY_LIMIT)?;
    if Format::sniff(&bytes) == Some(Format::OpenExr) {
        let source = Source { path, bytes: &bytes, memory_limit: DEFAULT_MEMORY_LIMIT };
        return contained(path, || exr::decode_chain(&source));
    }
    if Format::sniff(&bytes) == Some(Format::Dds) {
        let roughness = level_folder::told_roughness(path, DEFAULT_MEMORY_LIMIT)?;
        let source = Source { path, bytes: &bytes, memory_limit: DEFAULT_MEMORY_LIMIT };
        return contained(path, || dds_read::decode_chain(&source, &roughness));
    }
    read_chain_from_memory(path, &bytes, DEFAULT_MEMORY_LIMIT)
}

/// [`read_chain`] for a KTX2 file already in memory; `path` names it in messages.
///
/// # Errors
/// As [`read_chain`].
pub fn read_chain_from_memory(path: &Path, bytes: &[u8], memory_limit: u64) -> Result<CubeChain> {
    let source = Source { path, bytes, memory_limit };
    contained(path, || ktx2_read::decode_chain(&source))
}

/// Whether `path` is a directory; an error where it is neither that nor a file, so that no pipe is waited for.
fn is_directory(path: &Path) -> Result<bool> {
    let metadata = fs::metadata(path).map_err(|source| Error::io(path, source))?;
    if !metadata.is_dir() && !metadata.is_file() {
        return Err(Error::input(path, "not a regular file; copy its content to a file first"));
    }
    Ok(metadata.is_dir())
}

fn file_bytes(path: &Path, memory_limit: u64) -> Result<Vec<u8>> {
    let length = fs::metadata(path).map_err(|source| Error::io(path, source))?.len();
    if length > memory_limit {
        return Err(picture::limit(path, "the file", length, memory_limit));
    }
    fs::read(path).map_err(|source| Error::io(path, source))
}

/// What a file can be, by its first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Radiance,
    OpenExr,
    Png,
    Jpeg,
    Ktx2,
    Dds,
}

impl Format {
    fn sniff(bytes: &[u8]) -> Option<Self> {
        let magics: [(&[u8], Self); 6] = [
            (b"#?", Self::Radiance),
            (&[0x76, 0x2f, 0x31, 0x01], Self::OpenExr),
            (b"\x89PNG\r\n\x1a\n", Self::Png),
            (&[0xff, 0xd8, 0xff], Self::Jpeg),
            (&ktx2::MAGIC, Self::Ktx2),
            (b"DDS ", Self::Dds),
        ];
        magics.into_iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, format)| format)
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Radiance => "Radiance HDR",
            Self::OpenExr => "OpenEXR",
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::Ktx2 => "KTX2",
            Self::Dds => "DDS",
        }
    }

    const fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Radiance => &["hdr", "pic", "rgbe", "xyze"],
            Self::OpenExr => &["exr"],
            Self::Png => &["png"],
            Self::Jpeg => &["jpg", "jpeg", "jpe", "jfif"],
            Self::Ktx2 => &["ktx2"],
            Self::Dds => &["dds"],
        }
    }
}

/// Extensions of images that cannot be read: a readable file that bears one is misnamed.
const FOREIGN_EXTENSIONS: [&str; 8] = ["bmp", "gif", "ktx", "pfm", "tga", "tif", "tiff", "webp"];

/// What is odd about the name of a file that holds `format`.
fn misnamed(path: &Path, format: Format) -> Option<String> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    let extension = extension.as_str();
    let all = [Format::Radiance, Format::OpenExr, Format::Png, Format::Jpeg, Format::Ktx2, Format::Dds];
    let known = FOREIGN_EXTENSIONS.contains(&extension)
        || all.iter().any(|other| other.extensions().contains(&extension));
    (known && !format.extensions().contains(&extension))
        .then(|| format!("named .{extension} but holds {}; read by its content", format.name()))
}

/// Decodes whatever `source` holds; its caller contains panics.
fn decode(source: &Source<'_>) -> Result<Picture> {
    if source.bytes.is_empty() {
        return Err(source.error("the file is empty (0 bytes)"));
    }
    let Some(format) = Format::sniff(source.bytes) else {
        return Err(source.error(
            "not an image that can be read; Radiance .hdr, OpenEXR, KTX2, DDS, PNG and JPEG can, by their content",
        ));
    };
    let mut picture = match format {
        Format::Radiance => hdr::decode(source),
        Format::OpenExr => exr::decode(source),
        Format::Png => ldr::decode_png(source),
        Format::Jpeg => ldr::decode_jpeg(source),
        Format::Ktx2 => ktx2_read::decode_level0(source),
        Format::Dds => dds_read::decode_level0(source),
    }?;
    picture.warnings.extend(misnamed(source.path, format));
    Ok(picture)
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
    let mut repaired = Repairs::default();
    // Most pictures need no repair: one look tells.
    let sound = repair::is_sound(&picture.texels);
    if !sound {
        finite(path, &mut picture, options, &mut repaired)?;
    }
    finish_finite(path, picture, sound, repaired, options)
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
    sound: bool,
    mut repaired: Repairs,
    options: &ReadOptions,
) -> Result<Loaded> {
    let Picture { width, height, texels, content, format, mut warnings } = picture;
    let arrangement = layout::arrangement(path, width, height, content, options.layout)?;
    let mut texels = arrangement.arrange(texels, width);
    if !sound {
        repair::negative(arrangement.layout, &mut texels, &mut repaired);
    }
    if options.strict && repaired.any() {
        return Err(Error::input(
            path,
            format!("{repaired}; --strict allows no repair, leave it out to set them right"),
        ));
    }
    warnings.extend(repaired.any().then(|| format!("{repaired}, set right")));
    let environment = Environment::of_sound(arrangement.layout, texels)?;
    let height = if content == Content::Cube { width } else { height };
    Ok(Loaded { environment, repaired, warnings, format, layout: arrangement.name, width, height })
}
