//! Builds the tables for fitted lobes from an OEM.
//!
//! ```text
//! OEM --emitters--> emitters
//!  |      +-> rest --fixed_point, sat_scan--> exact table --blur--> blurred tables
//!  |           +--least radiance                   +------harmonics--> orders 0 to 4
//!  +--mirror--> texture
//! ```

use super::blur::Blur;
use super::emitters::Emitters;
use super::fitted::FittedTables;
use super::fixed_point::FixedPoint;
use super::harmonics::Harmonics;
use super::mirror::Mirror;
use super::sat_scan::SatScan;
use super::table_scan::TableScan;
use super::{Context, OemPlanes, SatPlanes, Stage};
use crate::error::Result;
use crate::sat::Scan;

/// Buffers between the passes. Tables of one size can share them: each build overwrites them.
#[derive(Clone, Debug)]
pub(super) struct Scratch {
    /// The OEM without its emitters.
    rest: OemPlanes,
    sat: SatPlanes,
    /// [`Blur::texels`].
    blurred: wgpu::Buffer,
}

impl Scratch {
    /// Buffers for OEMs of the size of `oem`, which share its solid angles.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] if the planes are larger than the device can bind.
    pub(super) fn new(context: &Context, oem: &OemPlanes) -> Result<Self> {
        let sat = SatPlanes::new(context, oem.size())?;
        let rest = oem.of_the_same_solid_angles(context);
        Ok(Self { rest, sat, blurred: Blur::texels(context, oem.size().inner) })
    }
}

/// The passes that fill [`FittedTables`].
#[derive(Clone, Debug)]
pub struct BuildFitted {
    /// OEM to emitters and the residual map.
    pub emitters: Emitters,
    /// Residual map to fixed-point exponents.
    pub fixed_point: FixedPoint,
    /// Residual map to its exact SAT.
    pub sat_scan: TableScan,
    /// Table to blurred tables.
    pub blur: Blur,
    /// Table to harmonics.
    pub harmonics: Harmonics,
    /// OEM to the texture for mirrors.
    pub mirror: Mirror,
}

impl BuildFitted {
    /// Compiles the passes.
    #[must_use]
    pub fn new(context: &Context) -> Self {
        Self {
            emitters: Emitters::new(context),
            fixed_point: FixedPoint::new(context),
            sat_scan: TableScan::Blocks(SatScan::new(context)),
            blur: Blur::new(context),
            harmonics: Harmonics::new(context),
            mirror: Mirror::new(context),
        }
    }

    /// The same passes, with the table scanned by `scan`.
    ///
    /// # Errors
    /// Those of [`TableScan::new`].
    pub fn scanned_by(&self, context: &Context, scan: Scan) -> Result<Self> {
        Ok(Self { sat_scan: self.sat_scan.or_of(context, scan)?, ..self.clone() })
    }

    /// The stages that fill `tables` from `oem`, in order. Record them whenever `oem` has changed.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] if the planes are larger than the device can bind.
    ///
    /// # Panics
    /// If `tables` was made for another size.
    pub fn stages(&self, context: &Context, oem: &OemPlanes, tables: &FittedTables) -> Result<Vec<Stage>> {
        Ok(self.stages_through(context, oem, &Scratch::new(context, oem)?, tables))
    }

    /// The stages through `scratch`.
    ///
    /// # Panics
    /// If `scratch` or `tables` was made for another size.
    pub(super) fn stages_through(
        &self,
        context: &Context,
        oem: &OemPlanes,
        scratch: &Scratch,
        tables: &FittedTables,
    ) -> Vec<Stage> {
        let Scratch { rest, sat, blurred } = scratch;
        assert_eq!(oem.size(), sat.size(), "buffers for this size");
        vec![
            self.emitters.stage(context, oem, rest, tables),
            self.fixed_point.stage(context, rest, sat).labelled("fixed_point of the rest"),
            self.sat_scan.stage_of_the_rest(context, rest, sat),
            self.blur.stage(context, sat, blurred, tables),
            self.harmonics.stage(context, sat, tables),
            self.mirror.stage(context, oem, rest, tables),
        ]
    }
}
