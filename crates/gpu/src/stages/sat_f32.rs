//! The float32 table with its mean bias, by recursive doubling. For comparison; see
//! [`octagloss_core::analysis::sat_f32`].

use super::oem::{OemPlanes, Table};
use super::sat_hensley::doublings;
use crate::device::stage::Dispatch;
use crate::{Context, Stage};
use octagloss_core::common::error::Result;

/// Workgroups of the reduction.
pub(crate) const GROUPS: u32 = 64;

/// Invocations along an edge of a workgroup.
pub const EDGE: u32 = 16;

/// Uniform of one pass.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Doubling {
    side: u32,
    axis: u32,
    stride: u32,
}

const FILE: &str = "sat_f32.wgsl";

/// The stage that fills the float32 table of `oem`; the table, four floats per entry, row by row,
/// inclusive, border included; and the mean of the bordered OEM that was subtracted before summing.
///
/// # Errors
/// [`octagloss_core::common::error::Error::Limit`] if it is larger than the device can bind.
pub fn stage(context: &Context, oem: &OemPlanes) -> Result<(Stage, wgpu::Buffer, wgpu::Buffer)> {
    let Table { side, .. } = oem.table();
    let bytes = 16 * u64::from(side) * u64::from(side);
    context.fits(&format!("a float32 table of {side} x {side}"), bytes, |available| {
        format!("choose `oem_size` plus twice `border` of at most {}", (available / 16).isqrt())
    })?;
    let buffers = [(); 2].map(|()| context.storage("float32 table", bytes));
    let partials = context.storage("sums of groups", 16 * u64::from(GROUPS));
    let mean = context.storage("mean", 16);
    let strides = doublings(side, 2);
    // The last pass writes the first buffer.
    let back = |pass: usize| &buffers[(strides.len() - pass) % 2];
    let planes = oem.bindings();
    let partials = (5, partials.as_entire_binding());
    let mean_binding = (6, mean.as_entire_binding());
    let groups = [side.div_ceil(EDGE), side.div_ceil(EDGE), 1];
    let mut dispatches = vec![
        Dispatch::new(
            context,
            (FILE, "sums_of_groups"),
            &[&planes[..], std::slice::from_ref(&partials)].concat(),
            [GROUPS, 1, 1],
        ),
        Dispatch::new(
            context,
            (FILE, "mean_of_all"),
            &[planes[0].clone(), partials, mean_binding.clone()],
            [1, 1, 1],
        ),
        Dispatch::new(
            context,
            (FILE, "bias"),
            &[&planes[..], &[mean_binding, (7, back(0).as_entire_binding())]].concat(),
            groups,
        ),
    ];
    for (pass, (axis, stride)) in strides.iter().enumerate() {
        let uniform = Doubling { side, axis: *axis, stride: *stride };
        dispatches.push(Dispatch::new(
            context,
            (FILE, "double_sums"),
            &[
                (8, context.uniform("doubling", &uniform).as_entire_binding()),
                (9, back(pass).as_entire_binding()),
                (7, back(pass + 1).as_entire_binding()),
            ],
            groups,
        ));
    }
    let [entries, _] = buffers;
    Ok((Stage::new("sat_f32", dispatches), entries, mean))
}
