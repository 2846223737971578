//! Assumptions about the output of Filament's cmgen, which records neither roughness nor rotation.

use super::provenance::Provenance;
use crate::lobe::Lobe;
use crate::lobe::ladder::Ladder;

/// Rotation of its cubes about +Y, in degrees: the centre of a panorama lies along -Z.
const ROTATION: f64 = -90.0;

/// Roughness of each of its `count` levels, from `size` texels down.
pub(super) fn roughness(count: u32, size: u32) -> impl Iterator<Item = f64> {
    (0..count).map(move |level| Ladder::Filament.roughness(level, count, size))
}

/// The origin of its levels.
pub(super) fn provenance() -> Provenance {
    Provenance {
        rotate_y: Some(ROTATION),
        lobe: Some(Lobe::Ggx),
        ladder: Some(Ladder::Filament.name().to_owned()),
        ..Provenance::default()
    }
}

/// The warning about these assumptions.
pub(super) fn warning(count: usize) -> String {
    format!(
        "neither a report nor roughness in its files; assuming cmgen's {count} levels of a panorama: \
         Filament's ladder of ggx, rotated by {ROTATION} degrees"
    )
}
