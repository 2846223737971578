//! The fixed-point exponents of an OEM, computed without float arithmetic and independent of the order of
//! summation.

use crate::device::stage::Dispatch;
use crate::{Context, OemPlanes, SatPlanes, Stage};

/// Workgroups of the reductions, at most.
pub(crate) const GROUPS: u32 = 256;

/// Invocations of a workgroup.
pub const GROUP_SIZE: u32 = 256;

/// Texels that an invocation processes before more workgroups are used.
pub(crate) const TEXELS: u32 = 4;

/// Workgroups that reduce `inner` x `inner` texels.
pub(super) fn groups(inner: u32) -> u32 {
    (inner * inner).div_ceil(TEXELS * GROUP_SIZE).clamp(1, GROUPS)
}

/// Bytes of a workgroup's partial result: four greatest bit patterns, four 64-bit sums.
const PARTIAL: u64 = 48;

/// The stage that writes the exponents of `oem` into `sat`: [`octagloss_core::light::sat::FixedPoint`].
pub fn stage(context: &Context, oem: &OemPlanes, sat: &SatPlanes) -> Stage {
    let file = "fixed_point.wgsl";
    let partials = context.storage("fixed-point partials", PARTIAL * u64::from(GROUPS));
    let shared = (5, partials.as_entire_binding());
    let all = [oem.bindings(), vec![shared.clone()]].concat();
    let exponents = (6, sat.exponents.as_entire_binding());
    Stage::new(
        "fixed_point",
        vec![
            Dispatch::new(context, (file, "greatest"), &all, [groups(oem.size().inner), 1, 1]),
            Dispatch::new(context, (file, "totals"), &all, [groups(oem.size().inner), 1, 1]),
            Dispatch::new(context, (file, "finish"), &[all[0].clone(), shared, exponents], [1, 1, 1]),
        ],
    )
}
