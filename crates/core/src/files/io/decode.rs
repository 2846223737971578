//! Detects the format of a file by its content and decodes it.

use crate::common::error::{Error, Result};
use crate::common::names::named;
use crate::files::io::picture::{Picture, Source};
use crate::files::io::regular::open_regular;
use crate::files::io::target_folder::is_named;
use crate::files::io::{dds, exr, hdr, ktx1, ktx2, ldr};
use crate::files::target::Content;
use std::io::Read as _;
use std::path::Path;

/// File formats, detected by their first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Radiance HDR.
    Radiance,
    /// OpenEXR.
    OpenExr,
    /// PNG.
    Png,
    /// JPEG.
    Jpeg,
    /// KTX.
    Ktx1,
    /// KTX2.
    Ktx2,
    /// DDS.
    Dds,
}

named!(Format {
    OpenExr = "OpenEXR",
    Radiance = "Radiance HDR",
    Png = "PNG",
    Jpeg = "JPEG",
    Ktx1 = "KTX",
    Ktx2 = "KTX2",
    Dds = "DDS",
});

impl Format {
    /// The format of a file that begins with `bytes`.
    pub fn sniff(bytes: &[u8]) -> Option<Self> {
        let magics: [(&[u8], Self); 7] = [
            (b"#?", Self::Radiance),
            (&[0x76, 0x2f, 0x31, 0x01], Self::OpenExr),
            (b"\x89PNG\r\n\x1a\n", Self::Png),
            (&[0xff, 0xd8, 0xff], Self::Jpeg),
            (&ktx1::MAGIC, Self::Ktx1),
            (&::ktx2::MAGIC, Self::Ktx2),
            (b"DDS ", Self::Dds),
        ];
        magics.into_iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, format)| format)
    }

    fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Radiance => &["hdr", "pic", "rgbe", "xyze"],
            Self::OpenExr => &["exr"],
            Self::Png => &["png"],
            Self::Jpeg => &["jpg", "jpeg", "jpe", "jfif"],
            Self::Ktx1 => &["ktx"],
            Self::Ktx2 => &["ktx2"],
            Self::Dds => &["dds"],
        }
    }
}

/// Extensions of the supported formats.
pub fn readable_extensions() -> impl Iterator<Item = &'static str> {
    Format::ALL.into_iter().flat_map(Format::extensions).copied()
}

/// Whether `path` has one of them.
pub fn has_readable_name(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    extension.is_some_and(|own| readable_extensions().any(|extension| extension == own))
}

/// Extensions of unsupported image formats: a readable file with one of them is misnamed.
const FOREIGN_EXTENSIONS: [&str; 7] = ["bmp", "gif", "pfm", "tga", "tif", "tiff", "webp"];

/// Whether the file `path` is of a format that can hold a chain: KTX, KTX2, DDS or multi-part OpenEXR.
pub fn may_hold_chain(path: &Path) -> bool {
    let mut start = Vec::new();
    let read = open_regular(path).is_ok_and(|file| file.take(12).read_to_end(&mut start).is_ok());
    read && match Format::sniff(&start) {
        Some(Format::Ktx1 | Format::Ktx2 | Format::Dds) => true,
        Some(Format::OpenExr) => start.get(5).is_some_and(|flags| flags & 0x10 != 0),
        _ => false,
    }
}

/// Warning for a file whose extension contradicts `format`.
fn misnamed(path: &Path, format: Format) -> Option<String> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    let extension = extension.as_str();
    let known = FOREIGN_EXTENSIONS.contains(&extension) || readable_extensions().any(|own| own == extension);
    (known && !format.extensions().contains(&extension))
        .then(|| format!("named .{extension} but holds {}; read by its content", format.name()))
}

/// Error for bake outputs that cannot be read back.
pub(super) fn unreadable(source: &Source<'_>) -> Option<Error> {
    let text = source.bytes.trim_ascii_start();
    let name = match source.bytes {
        bytes if bytes.starts_with(&crate::files::format::container::ENV_MAGIC) => "a Babylon.js .env",
        bytes if bytes.starts_with(b"glTF") => "a binary glTF",
        // Its panoramas would be read as one picture.
        bytes if Format::sniff(bytes) == Some(Format::Png) && is_named(source.path, Content::Atlas) => {
            "a PlayCanvas atlas"
        }
        _ if text.starts_with(b"{") || text.starts_with(b"[") => {
            "JSON, such as spherical harmonics or a report"
        }
        _ => return None,
    };
    Some(source.error(format!("{name}, which holds no image that can be read; give an image or a cube")))
}

/// Decodes `source` in any format. The caller must contain panics.
pub(super) fn decode(source: &Source<'_>) -> Result<Picture> {
    if source.bytes.is_empty() {
        return Err(source.error("the file is empty (0 bytes)"));
    }
    let readable = Format::sniff(source.bytes).filter(|_| !is_named(source.path, Content::Atlas));
    let Some(format) = readable else {
        return Err(unreadable(source).unwrap_or_else(|| {
            source.error(
                "not an image that can be read; Radiance .hdr, OpenEXR, KTX, KTX2, DDS, PNG and JPEG can, \
                 by their content",
            )
        }));
    };
    let mut picture = match format {
        Format::Radiance => hdr::decode(source),
        Format::OpenExr => exr::read::decode(source),
        Format::Png => ldr::decode_png(source),
        Format::Jpeg => ldr::decode_jpeg(source),
        Format::Ktx1 => ktx1::open(source)?.picture(),
        Format::Ktx2 => ktx2::read::open(source)?.picture(),
        Format::Dds => dds::open(source)?.picture(),
    }?;
    picture.warnings.extend(misnamed(source.path, format));
    picture.without_border(source)
}
