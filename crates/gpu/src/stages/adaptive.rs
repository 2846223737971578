//! Adaptive quadrature of lobes over the cells: one workgroup for each packet of directions.

use super::cells::CellTree;
use crate::device::readback;
use crate::device::stage::{Dispatch, in_rows};
use crate::{Context, Stage};
use glam::DVec3;
use octagloss_core::common::error::{Error, Result};
use octagloss_core::cpu::leaves::LANES;
use octagloss_core::geometry::source_texels::SourceGrid;
use octagloss_core::lobe::filter::{Answer, Bound};
use octagloss_core::lobe::kernel::{Kernel, shape};

/// Packets in one batch of buffers: 27 MB of directions.
const BATCH: usize = 1 << 17;

/// Greatest number of levels of a tree.
pub const LEVELS: usize = 16;

/// Bytes of a direction's answer.
const RESULT: u64 = 32;

/// Leaf count that the shader stores for a packet whose walk was cut short.
pub(super) const INCOMPLETE: u32 = 1 << 31;

/// The uniform of one part of a lobe.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Lobe {
    shape: u32,
    first: f32,
    second: f32,
    third: f32,
    fourth: f32,
    tolerance_per_mean: f32,
    share: f32,
    per_integral: f32,
    rounding: f32,
    rounding_per_leaf: f32,
    inner: u32,
    to_texels: u32,
    reach: f32,
    root: u32,
    add: u32,
    count: u32,
    omitted: f32,
    underflow: f32,
    source: u32,
    columns: u32,
    rows: u32,
    shift_x: u32,
    shift_y: u32,
    cells: u32,
    levels: [[u32; 4]; LEVELS],
}

/// Nearby directions in the shader's layout.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Packet {
    axis: [f32; 3],
    radius: f32,
    x: [f32; LANES],
    y: [f32; LANES],
    z: [f32; LANES],
}

impl Packet {
    /// A packet of 1 to [`LANES`] unit `directions`; padding lanes repeat the first.
    ///
    /// # Panics
    /// If there are no directions or more than [`LANES`].
    pub fn new(directions: &[DVec3]) -> Self {
        assert!(!directions.is_empty() && directions.len() <= LANES, "1 to {LANES} directions");
        // Use a reference point that float32 represents exactly; offsets from it are then exact.
        let mean = directions.iter().sum::<DVec3>().try_normalize().unwrap_or(directions[0]).as_vec3();
        let axis = mean.as_dvec3();
        let radius = directions.iter().map(|direction| direction.distance(axis)).fold(0.0, f64::max);
        let offset =
            |lane: usize| (directions[if lane < directions.len() { lane } else { 0 }] - axis).as_vec3();
        Self {
            axis: mean.to_array(),
            radius: (radius * (1.0 + 1e-6)) as f32,
            x: std::array::from_fn(|lane| offset(lane).x),
            y: std::array::from_fn(|lane| offset(lane).y),
            z: std::array::from_fn(|lane| offset(lane).z),
        }
    }
}

/// Part of a lobe over one reconstruction of the OEM.
#[derive(Clone, Copy, Debug)]
pub struct LobePart<'a> {
    /// The cells.
    pub cells: &'a CellTree,
    /// The lobe.
    pub kernel: Kernel,
    /// Target relRMSE over the sphere.
    pub error: f64,
    /// Share of the part in the whole lobe.
    pub share: f64,
}

impl LobePart<'_> {
    fn uniform(&self, count: u32, add: bool) -> Lobe {
        let Self { cells, kernel, error, share } = *self;
        let (shape, [first, second, third, fourth]) = kernel.parameters();
        let mut levels = [[0; 4]; LEVELS];
        for (level, [first, width]) in levels.iter_mut().zip(&cells.levels) {
            *level = [*first, *width, 0, 0];
        }
        let unit = f64::from(1_u32 << 24).recip();
        let (per_integral, least) = (share / kernel.integral(), f64::from(f32::MIN_POSITIVE));
        let SourceGrid { source, sides: [columns, rows], shift: [shift_x, shift_y] } = cells.grid;
        Lobe {
            shape,
            first,
            second,
            third,
            fourth,
            tolerance_per_mean: kernel.tolerance_per_mean(error) as f32,
            share: share as f32,
            per_integral: per_integral as f32,
            // As on the CPU, with divisions of 2.5 units, square roots and exponentials of a few dozen, and
            // pieces of texels whose directions are in error by 2^-22.
            rounding: ((8.0 / kernel.width() + 128.0) * unit) as f32,
            rounding_per_leaf: unit as f32,
            inner: cells.inner,
            to_texels: u32::from(cells.block == 1 || source != 0),
            reach: cells.reconstruction.reach() as f32,
            root: cells.levels.len() as u32 - 1,
            add: u32::from(add),
            count,
            // Products of up to 2^20 leaves are flushed, some ten powers of two above the least normal
            // number.
            omitted: (share * cells.omitted + per_integral * 30.0_f64.exp2() * least) as f32,
            underflow: (per_integral * f64::from(kernel.underflow()) * 1024.0) as f32,
            source,
            columns,
            rows,
            shift_x,
            shift_y,
            cells: cells.inner.div_ceil(cells.block),
            levels,
        }
    }
}

/// Packets on the GPU and the buffers for their answers.
#[derive(Clone, Debug)]
pub struct Packets {
    count: u32,
    packets: wgpu::Buffer,
    /// Of each lane of each packet: radiance (three floats), the certified bound of its luminance, those of
    /// the channels (three floats), and 0.
    results: wgpu::Buffer,
    /// Leaves of each packet, one buffer per part.
    leaves: [wgpu::Buffer; 2],
}

impl Packets {
    /// Uploads `packets`.
    ///
    /// # Errors
    /// [`Error::Limit`] if there are more packets than the device can bind.
    pub fn new(context: &Context, packets: &[Packet]) -> Result<Self> {
        let count = packets.len() as u64;
        let result_bytes = RESULT * LANES as u64 * count;
        context.fits("directions", result_bytes.max(208 * count), |_| "query fewer at a time".to_owned())?;
        Ok(Self {
            count: count as u32,
            packets: context.storage_of("packets", packets),
            results: context.storage("answers", result_bytes),
            leaves: [(); 2].map(|()| context.storage("leaf counts", 4 * count)),
        })
    }
}

/// Answers to packets.
#[derive(Clone, Debug, Default)]
pub struct Answers {
    /// Lanes of all packets in order, padding lanes included.
    pub lanes: Vec<Answer>,
    /// Leaves of all packets, each counted once.
    pub leaves: u64,
}

/// Stage that evaluates the lobe made of `parts` (one or two) around the directions of `packets`.
///
/// # Panics
/// If there are no parts or more than two.
pub fn stage(context: &Context, parts: &[LobePart<'_>], packets: &Packets) -> Stage {
    assert!((1..=2).contains(&parts.len()), "one or two parts");
    let Packets { count, packets, results, leaves } = packets;
    let dispatches = parts.iter().zip(leaves).enumerate().map(|(index, (part, leaves))| {
        let lobe = part.uniform(*count, index > 0);
        let uniform = context.uniform("lobe", &lobe);
        let sheen = u32::from(lobe.shape == shape::CHARLIE);
        Dispatch::of(
            context,
            &context.pipeline("adaptive.wgsl", "adaptive", Some(("SHEEN", sheen))),
            &[
                (0, uniform.as_entire_binding()),
                (1, part.cells.least.as_entire_binding()),
                (2, part.cells.quads.as_entire_binding()),
                (3, packets.as_entire_binding()),
                (4, results.as_entire_binding()),
                (5, leaves.as_entire_binding()),
                (6, part.cells.members.as_entire_binding()),
                (7, part.cells.angles.as_entire_binding()),
                (8, wgpu::BindingResource::TextureView(&part.cells.light)),
            ],
            in_rows(*count),
        )
    });
    Stage::new("adaptive", dispatches.collect())
}

/// Uploads `packets`, evaluates `parts` around their directions and reads the answers back, in batches.
///
/// # Errors
/// [`Error::Gpu`] if the device fails, or ends the traversal loop early.
pub async fn evaluate(context: &Context, parts: &[LobePart<'_>], packets: &[Packet]) -> Result<Answers> {
    let mut answers = Answers::default();
    for batch in packets.chunks(BATCH) {
        let packets = Packets::new(context, batch)?;
        let stage = stage(context, parts, &packets);
        context.submit(|encoder| stage.record(encoder));
        let results: Vec<[f32; 8]> = readback::read(context, &packets.results).await?;
        answers.lanes.extend(results.iter().map(|[r, g, b, luminance, of_r, of_g, of_b, _]| {
            let bound = Bound { channels: [*of_r, *of_g, *of_b], luminance: *luminance };
            Answer { radiance: [*r, *g, *b], bound: Some(bound) }
        }));
        for leaves in &packets.leaves[..parts.len()] {
            for count in readback::read::<u32>(context, leaves).await? {
                if count == INCOMPLETE {
                    return Err(Error::Gpu(format!(
                        "{}: the driver ended a shader loop early; use `engine` cpu or a larger error",
                        context.describe()
                    )));
                }
                answers.leaves += u64::from(count);
            }
        }
    }
    Ok(answers)
}
