//! An atlas of octahedral maps on the GPU: its texels, filled tile by tile, and the exact table of all of
//! them.

use super::fixed_point::FixedPoint;
use super::sat_scan::SatScan;
use super::{Context, OemPlanes, SatPlanes, Stage};
use crate::atlas::{Atlas, Tile};
use crate::error::{Error, Result};
use crate::oem::OemSize;

/// Planes of the texels of an [`Atlas`], and of their summed-area table.
#[derive(Clone, Debug)]
pub struct AtlasPlanes {
    texels: OemPlanes,
    sat: SatPlanes,
}

impl AtlasPlanes {
    /// Uploads `atlas`. Its table is zero until the stages of [`AtlasPlanes::sat_stages`] ran.
    ///
    /// # Errors
    /// [`Error::Limit`] if a plane is larger than the device can bind.
    pub fn upload(context: &Context, atlas: &Atlas) -> Result<Self> {
        let texels = OemPlanes::upload(context, atlas.oem())?;
        let sat = SatPlanes::new(context, texels.size())?;
        Ok(Self { texels, sat })
    }

    /// The texels.
    #[must_use]
    pub const fn texels(&self) -> &OemPlanes {
        &self.texels
    }

    /// The table of all tiles; [`crate::sat::Sat`] says how a tile's boxes are read from it.
    #[must_use]
    pub const fn sat(&self) -> &SatPlanes {
        &self.sat
    }

    /// Records copies of `map`, border included, to `tile`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if their sizes differ, or the tile lies outside the atlas.
    pub fn copy(&self, encoder: &mut wgpu::CommandEncoder, map: &OemPlanes, tile: Tile) -> Result<()> {
        let (size, whole) = (tile.size(), self.texels.table());
        let [x, y] = tile.corner();
        if map.size() != size || x.max(y) + size.bordered() > whole.side {
            let OemSize { inner, border } = map.size();
            return Err(Error::Parameter(format!(
                "a map of {inner} texels with a border of {border} for a tile of {} with {} at ({x}, {y}) of \
                 {}; allocate a tile of the map's size",
                size.inner, size.border, whole.side
            )));
        }
        let pitch = map.table().pitch;
        for (from, to) in map.planes().iter().zip(self.texels.planes()) {
            for row in 0..size.bordered() {
                let at = |pitch: u32, x: u32, y: u32| 4 * (u64::from(pitch) * u64::from(y) + u64::from(x));
                let bytes = 4 * u64::from(size.bordered());
                encoder.copy_buffer_to_buffer(
                    from,
                    at(pitch, 0, row),
                    to,
                    at(whole.pitch, x, y + row),
                    bytes,
                );
            }
        }
        Ok(())
    }

    /// The stages that sum the tables of all tiles in one scan.
    #[must_use]
    pub fn sat_stages(&self, context: &Context, fixed_point: &FixedPoint, scan: &SatScan) -> [Stage; 2] {
        [fixed_point.stage(context, &self.texels, &self.sat), scan.stage(context, &self.texels, &self.sat)]
    }
}
