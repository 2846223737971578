//! A plain copy kernel, the reference for the bandwidth of the scans.

use crate::device::stage::{Dispatch, in_rows};
use crate::{Context, SatPlanes, Stage};

/// Invocations of a workgroup.
pub const GROUP_SIZE: u32 = 256;

/// Copies three planes of `sat` to the others. This moves the least number of bytes of a scan, 48 per
/// texel: a scan reads 16 and writes 32, the copy reads and writes 24.
pub fn stage(context: &Context, sat: &SatPlanes) -> Stage {
    let dispatches = [(0, 3), (1, 0), (2, 1)].map(|(from, to)| {
        let groups = u32::try_from(sat.planes[from].size() / 16).expect("a bound buffer");
        let groups = groups.div_ceil(GROUP_SIZE);
        Dispatch::new(
            context,
            ("copy.wgsl", "copy"),
            &[(0, sat.planes[from].as_entire_binding()), (1, sat.planes[to].as_entire_binding())],
            in_rows(groups),
        )
    });
    Stage::new("copy", dispatches.into())
}
