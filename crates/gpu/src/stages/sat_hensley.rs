//! Hensley's recursive doubling as in the 2005 paper: passes of 2, 4, 8 or 16 samples, ping-pong.

use super::oem::{CHANNELS, Table};
use crate::device::stage::Dispatch;
use crate::{Context, OemPlanes, SatPlanes, Stage};

/// Invocations along an edge of a workgroup.
pub const EDGE: u32 = 16;

/// Uniform of one pass over a pair of channels.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Doubling {
    side: u32,
    pitch: u32,
    channel: u32,
    axis: u32,
    stride: u32,
}

/// Stage that writes the table of `oem` to `sat`, whose exponents must be filled, in passes of `radix`
/// samples.
///
/// # Panics
/// If `radix` is below 2.
pub fn stage(context: &Context, radix: u32, oem: &OemPlanes, sat: &SatPlanes) -> Stage {
    assert!(radix >= 2, "a radix of at least 2");
    let double_sums = context.pipeline("sat_hensley.wgsl", "double_sums", Some(("RADIX", radix)));
    let Table { side, pitch, .. } = oem.table();
    let passes = doublings(side, radix);
    let bytes = 8 * oem.table().count();
    let other: [_; CHANNELS / 2] = std::array::from_fn(|_| context.storage("SAT ping-pong", bytes));
    let groups = [side.div_ceil(EDGE), side.div_ceil(EDGE), 1];
    let mut dispatches = Vec::new();
    for channel in [0, 2] {
        let table = &sat.planes[channel..channel + 2];
        // The last pass writes the table itself.
        let back = |pass: usize| if (passes.len() - pass).is_multiple_of(2) { table } else { &other[..] };
        let uniform = |axis, stride| {
            context.uniform("doubling", &Doubling { side, pitch, channel: channel as u32, axis, stride })
        };
        let start = uniform(0, 1);
        dispatches.push(Dispatch::new(
            context,
            ("sat_hensley.wgsl", "quantise_texels"),
            &[
                (0, start.as_entire_binding()),
                (1, sat.exponents.as_entire_binding()),
                (2, oem.planes[channel].as_entire_binding()),
                (3, oem.planes[channel + 1].as_entire_binding()),
                (6, back(0)[0].as_entire_binding()),
                (7, back(0)[1].as_entire_binding()),
            ],
            groups,
        ));
        for (pass, (axis, stride)) in passes.iter().enumerate() {
            let (from, to) = (back(pass), back(pass + 1));
            dispatches.push(Dispatch::of(
                context,
                &double_sums,
                &[
                    (0, uniform(*axis, *stride).as_entire_binding()),
                    (4, from[0].as_entire_binding()),
                    (5, from[1].as_entire_binding()),
                    (6, to[0].as_entire_binding()),
                    (7, to[1].as_entire_binding()),
                ],
                groups,
            ));
        }
    }
    Stage::new("sat_hensley", dispatches)
}

/// Axes and strides of recursive doubling over `side` entries, `radix` samples a pass: along rows, then
/// columns.
pub(super) fn doublings(side: u32, radix: u32) -> Vec<(u32, u32)> {
    let strides = || {
        std::iter::successors(Some(1_u32), move |stride| stride.checked_mul(radix))
            .take_while(move |stride| *stride < side)
    };
    [0, 1].into_iter().flat_map(|axis| strides().map(move |stride| (axis, stride))).collect()
}
