//! Writes cube chains as single files in every container.

use super::cube_file::{CubeFile, check_sizes};
use super::exr::parts::{Part, exr_parts_bytes};
use super::exr::write::attributes;
use super::provenance::Provenance;
use super::{dds, ktx1, ktx2};
use crate::common::error::{Result, wrong};
use crate::files::format::container::Container;
use crate::files::format::{LevelName, Pixel};
use crate::light::chain::Chain;
use crate::sphere::cube::Face;

/// Encodes `chain` in `container` with `pixel`. `metadata` are text key/value pairs; DDS stores only the
/// flip.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for a chain without levels or whose sizes do not halve, a pixel
/// format that the container cannot hold ([`Container::holds`]), and for invalid keys.
pub fn cube_bytes(
    container: Container,
    chain: &Chain,
    pixel: Pixel,
    metadata: &[(String, String)],
) -> Result<CubeFile> {
    match container {
        Container::Ktx2 => ktx2::write::ktx2_bytes(chain, pixel, metadata),
        Container::Ktx1 => ktx1::write::ktx1_bytes(chain, pixel, metadata),
        Container::Dds => {
            let mut file = dds::write::dds_bytes(chain, pixel)?;
            let flip = Provenance::of_pairs(metadata).ok().and_then(|provenance| provenance.flip);
            dds::write::mark_flip(&mut file.bytes, flip.unwrap_or_default());
            Ok(file)
        }
        Container::Exr => exr_bytes(chain, pixel, metadata),
        Container::Hdr => wrong("a cube in .hdr files is a folder of images, not one file"),
    }
}

/// Encodes `chain` as an EXR file with parts `m0_px`, `m0_nx`, ...; attributes hold the roughness and
/// `metadata`.
fn exr_bytes(chain: &Chain, pixel: Pixel, metadata: &[(String, String)]) -> Result<CubeFile> {
    check_sizes("EXR", chain)?;
    let parts: Vec<Part<'_>> = (0..)
        .zip(&chain.levels)
        .flat_map(|(index, level)| Face::ALL.map(|face| (index, level, face)))
        .map(|(index, level, face)| Part {
            name: LevelName::face(index, face).to_string(),
            width: level.size(),
            height: level.size(),
            texels: level.face(face),
            attributes: attributes(Some(level.roughness), metadata.iter().cloned()),
        })
        .collect();
    Ok(CubeFile::new(exr_parts_bytes(&parts, pixel)?, &chain.levels, pixel))
}
