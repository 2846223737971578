//! Finds the least radiance of each channel of an OEM. Cells hold only the radiance above it.

use super::fixed_point::{GROUPS, groups};
use crate::device::stage::Dispatch;
use crate::{Context, OemPlanes};

/// Dispatches that write the least radiance of `oem` to `least`, four floats.
pub(super) fn dispatches(
    context: &Context,
    oem: &OemPlanes,
    least: wgpu::BindingResource<'_>,
) -> [Dispatch; 2] {
    let partials = context.storage("least radiance of groups", 16 * u64::from(GROUPS));
    let partials = (5, partials.as_entire_binding());
    let all = [oem.bindings(), vec![partials.clone()]].concat();
    [
        Dispatch::new(context, ("least.wgsl", "least_of_groups"), &all, [groups(oem.size().inner), 1, 1]),
        Dispatch::new(
            context,
            ("least.wgsl", "least_of_all"),
            &[all[0].clone(), partials, (6, least)],
            [1, 1, 1],
        ),
    ]
}
