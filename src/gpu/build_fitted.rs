//! Builds the tables for fitted lobes from an OEM.
//!
//! ```text
//! OEM --emitters--> emitters
//!  |      +-> rest --fixed_point, sat_scan--> exact table --blur--> blurred tables
//!  |           +--least radiance                   +------harmonics--> orders 0 to 4
//!  +--mirror--> texture
//! ```

use super::fitted::FittedTables;
use super::{
    Context, OemPlanes, SatPlanes, Stage, blur, emitters, fixed_point, harmonics, mirror, table_scan,
};
use crate::error::Result;
use crate::sat::Scan;

/// Buffers between the passes. Tables of one size can share them: each build overwrites them.
#[derive(Clone, Debug)]
pub(super) struct Scratch {
    /// The OEM without its emitters.
    rest: OemPlanes,
    sat: SatPlanes,
    /// [`blur::texels`].
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
        Ok(Self { rest, sat, blurred: blur::texels(context, oem.size().inner) })
    }
}

/// The stages that fill `tables` from `oem`, in order, with its table scanned by `scan`. Record them whenever
/// `oem` has changed.
///
/// # Errors
/// [`crate::Error::Limit`] if the planes are larger than the device can bind; those of [`table_scan::stage`].
///
/// # Panics
/// If `tables` was made for another size.
pub fn stages(context: &Context, scan: Scan, oem: &OemPlanes, tables: &FittedTables) -> Result<Vec<Stage>> {
    stages_through(context, scan, oem, &Scratch::new(context, oem)?, tables)
}

/// The stages through `scratch`.
///
/// # Errors
/// Those of [`table_scan::stage`].
///
/// # Panics
/// If `scratch` or `tables` was made for another size.
pub(super) fn stages_through(
    context: &Context,
    scan: Scan,
    oem: &OemPlanes,
    scratch: &Scratch,
    tables: &FittedTables,
) -> Result<Vec<Stage>> {
    let Scratch { rest, sat, blurred } = scratch;
    assert_eq!(oem.size(), sat.size(), "buffers for this size");
    let of_the_rest = if scan == Scan::Blocks { "sat_scan of the rest" } else { "sat_hensley of the rest" };
    Ok(vec![
        emitters::stage(context, oem, rest, tables),
        fixed_point::stage(context, rest, sat).labelled("fixed_point of the rest"),
        table_scan::stage(context, scan, rest, sat)?.labelled(of_the_rest),
        blur::stage(context, sat, blurred, tables),
        harmonics::stage(context, sat, tables),
        mirror::stage(context, oem, rest, tables),
    ])
}
