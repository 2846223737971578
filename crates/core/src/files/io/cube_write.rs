//! Writes cube chains as single files in every container.

use super::exr::parts::{Part, exr_parts_bytes};
use super::exr::write::attributes;
use super::provenance::Provenance;
use super::{dds, ktx1, ktx2};
use crate::common::error::{Result, wrong};
use crate::files::format::container::Container;
use crate::files::format::{LevelName, Pixel};
use crate::light::chain::Level;
use crate::sphere::cube::Face;

/// Encodes `levels` in `container` with `pixel`. `metadata` are text key/value pairs; DDS stores only the
/// flip.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for no levels or sizes that do not halve, a pixel format that
/// the container cannot hold ([`Container::holds`]), and for invalid keys.
pub fn cube_bytes(
    container: Container,
    levels: &[Level],
    pixel: Pixel,
    metadata: &[(String, String)],
) -> Result<Vec<u8>> {
    match container {
        Container::Ktx2 => ktx2::write::ktx2_bytes(levels, pixel, metadata),
        Container::Ktx1 => ktx1::ktx1_bytes(levels, pixel, metadata),
        Container::Dds => {
            let flip = Provenance::of_pairs(metadata).ok().and_then(|provenance| provenance.flip);
            dds::dds_bytes(levels, pixel, flip.unwrap_or_default())
        }
        Container::Exr => exr_bytes(levels, pixel, metadata),
        Container::Hdr => wrong("a cube in .hdr files is a folder of images, not one file"),
    }
}

/// Encodes `levels` as an EXR file with parts `m0_px`, `m0_nx`, ...; attributes hold the roughness and
/// `metadata`.
fn exr_bytes(levels: &[Level], pixel: Pixel, metadata: &[(String, String)]) -> Result<Vec<u8>> {
    check_sizes("EXR", levels)?;
    let parts: Vec<Part<'_>> = (0..)
        .zip(levels)
        .flat_map(|(index, level)| Face::ALL.map(|face| (index, level, face)))
        .map(|(index, level, face)| Part {
            name: LevelName::face(index, face).to_string(),
            width: level.size(),
            height: level.size(),
            texels: level.face(face),
            attributes: attributes(Some(level.roughness), metadata.iter().cloned()),
        })
        .collect();
    exr_parts_bytes(&parts, pixel)
}

/// Checks that a file of `format` can hold `levels`: sizes halve and faces are complete. Returns the edge of
/// level 0.
pub(super) fn check_sizes(format: &str, levels: &[Level]) -> Result<u32> {
    let Some(first) = levels.first() else {
        return wrong(format!("a {format} file needs at least one level"));
    };
    let most = first.size().checked_ilog2().map_or(0, |log2| log2 as usize + 1);
    if levels.len() > most {
        return wrong(format!(
            "{} levels are more than the {most} that {format} allows a cube of {}",
            levels.len(),
            first.size()
        ));
    }
    for (index, level) in levels.iter().enumerate() {
        let size = first.size() >> index;
        if level.size() != size || level.texels.len() != 6 * size as usize * size as usize {
            return wrong(format!(
                "level {index} of a {format} cube of {} must have 6 faces of {size}, not {} texels in faces \
                 of {}",
                first.size(),
                level.texels.len(),
                level.size()
            ));
        }
    }
    Ok(first.size())
}
