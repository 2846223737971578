//! Locates a broken stage: the CPU runs the pipeline up to a given stage, the GPU from there on.

use crate::boxes::packed;
use crate::transfer::{Upload as _, tree_of_cells};
use glam::DVec3;
use octagloss_core::cpu::adaptive::Adaptive;
use octagloss_core::cpu::box_filter::BoxFilter;
use octagloss_core::cpu::cells::Cells;
use octagloss_core::cpu::leaves::{Packet as CpuPacket, Scratch};
use octagloss_core::cpu::reparameterise::oem_from_environment;
use octagloss_core::geometry::tent::Reconstruction;
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::light::sat::{Sat, Scan};
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::kernel::{Kernel, leaf_share};
use octagloss_fixtures::adapters::{UNIT, in_full, wait};
use octagloss_fixtures::bounds::luminance;
use octagloss_fixtures::common::{Look, Random, environment, landmarks, texels};
use octagloss_gpu::stages::adaptive::{self, LobePart, Packet};
use octagloss_gpu::stages::reparameterise::{self, upload};
use octagloss_gpu::stages::{box_filter, cells, fixed_point, sat_scan};
use octagloss_gpu::{Context, OemPlanes, SatPlanes};

/// The stage from which the GPU runs, the last stage first: each variant adds one stage to the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd)]
pub(super) enum TakeOver {
    /// The CPU's table and cells; packing and queries on the GPU.
    Queries,
    /// The CPU's OEM and table; cells too on the GPU.
    Cells,
    /// The CPU's OEM; exponents and scan too on the GPU.
    Scan,
    /// The environment only: all stages on the GPU.
    Reparameterise,
}

const ALL: [TakeOver; 4] = [TakeOver::Queries, TakeOver::Cells, TakeOver::Scan, TakeOver::Reparameterise];

const SIZE: OemSize = OemSize { inner: 32, border: 2 };
const ROUGHNESS: f64 = 0.5;
const ERROR: f64 = 0.001;
const SPREAD: Reconstruction = Reconstruction::Constant;

/// Results of a run: boxes and lobes.
#[derive(Clone, Debug)]
struct Outcome {
    boxes: Vec<[f32; 3]>,
    lobes: Vec<[f32; 3]>,
}

fn solid_angle() -> f64 {
    super::boxes::solid_angle(Lobe::Ggx, ROUGHNESS * ROUGHNESS)
}

fn kernel() -> Kernel {
    Kernel::new(Lobe::Ggx, ROUGHNESS * ROUGHNESS)
}

fn on_the_cpu(oem: &Oem, directions: &[DVec3]) -> Outcome {
    let (sat, cells) = (Sat::new(oem, Scan::default()), Cells::new(oem, 1, SPREAD));
    let filter = BoxFilter::new(&sat, Lobe::Ggx, ROUGHNESS * ROUGHNESS);
    let adaptive = Adaptive::new(&cells, kernel(), ERROR);
    let lobe = |d: &DVec3| adaptive.evaluate(&CpuPacket::new(&[*d]), &mut Scratch::default()).radiance[0];
    Outcome {
        boxes: directions.iter().map(|d| filter.radiance(*d)).collect(),
        lobes: directions.iter().map(lobe).collect(),
    }
}

/// Runs with the GPU from `from` on, and makes the stage `broken` fail if it runs on the GPU.
fn run(
    context: &Context,
    (environment, oem): (&Environment, &Oem),
    directions: &[DVec3],
    from: TakeOver,
    broken: Option<TakeOver>,
) -> Outcome {
    let breaks = |stage: TakeOver| broken == Some(stage) && from >= stage;
    let write = |buffer: &wgpu::Buffer, at: u64, word: u32| {
        context.queue().write_buffer(buffer, at, &word.to_le_bytes());
    };
    let planes = if from == TakeOver::Reparameterise {
        let texture = upload(context, environment).expect("a small texture");
        let planes = OemPlanes::new(context, SIZE).expect("small planes");
        let layout = environment.layout();
        let stage = reparameterise::stage(context, layout, &texture, &planes).expect("a small matrix");
        context.submit(|encoder| stage.record(encoder));
        planes
    } else {
        OemPlanes::upload(context, oem).expect("small planes")
    };
    // A texel in the middle of the square, set to ten times the total.
    let middle = u64::from(SIZE.border + SIZE.inner / 2) * u64::from(planes.table().pitch + 1);
    if breaks(TakeOver::Reparameterise) {
        write(&planes.planes[1], 4 * middle, (10.0 * oem.totals()[1] as f32).to_bits());
    }
    let sat = if from >= TakeOver::Scan {
        let sat = SatPlanes::new(context, SIZE).expect("small planes");
        let stages = [fixed_point::stage(context, &planes, &sat), sat_scan::stage(context, &planes, &sat)];
        context.submit(|encoder| stages.iter().for_each(|stage| stage.record(encoder)));
        sat
    } else {
        SatPlanes::upload(context, &Sat::new(oem, Scan::default())).expect("small planes")
    };
    if breaks(TakeOver::Scan) {
        // The sum of the whole square loses its upper half.
        let last = u64::from(SIZE.border + SIZE.inner - 1) * u64::from(planes.table().pitch + 1);
        write(&sat.planes[1], 8 * last + 4, 0);
    }
    let cells = if from >= TakeOver::Cells {
        let (stage, tree) = cells::stage(context, &planes, 1, SPREAD).expect("a small tree");
        context.submit(|encoder| stage.record(encoder));
        tree
    } else {
        tree_of_cells(context, &Cells::new(oem, 1, SPREAD), SIZE.inner, 1, SPREAD)
    };
    if breaks(TakeOver::Cells) {
        write(&cells.least, 4, (oem.totals()[1] as f32).to_bits());
    }
    let textures = packed(context, &sat);
    let stack = super::boxes::one_box(solid_angle());
    let mut boxes = wait(context, box_filter::radiance(context, &textures, directions, &stack));
    let parts = [LobePart { cells: &cells, kernel: kernel(), error: ERROR, share: 1.0 }];
    let packets: Vec<Packet> = directions.iter().map(|direction| Packet::new(&[*direction])).collect();
    let answers = wait(context, adaptive::evaluate(context, &parts, &packets));
    let mut lobes: Vec<[f32; 3]> =
        answers.lanes.iter().step_by(answers.lanes.len() / directions.len()).map(|a| a.radiance).collect();
    if breaks(TakeOver::Queries) {
        boxes[3][0] *= 1.01;
        lobes[4][2] *= 1.01;
    }
    Outcome { boxes, lobes }
}

/// Returns whether two outcomes agree. Boxes: edges moved by 24 n units exchange texels up to `brightest`
/// over a side of at least 1 (see the boxes' test). Lobes: rounding, and two decisions' share of the
/// tolerance.
fn agree(expected: &Outcome, found: &Outcome, brightest: f64, mean: f64) -> bool {
    let boxes = brightest * 4.0 * 5.2 * 24.0 * f64::from(SIZE.inner) * UNIT;
    let lobes = 2.0 * leaf_share(ERROR) * mean;
    let near = |e: &[[f32; 3]], f: &[[f32; 3]], absolute: f64| {
        e.len() == f.len()
            && e.iter().flatten().zip(f.iter().flatten()).all(|(e, f)| {
                let (e, f) = (f64::from(*e), f64::from(*f));
                (e - f).abs() <= 1e-5 * e + absolute
            })
    };
    near(&expected.boxes, &found.boxes, boxes) && near(&expected.lobes, &found.lobes, lobes)
}

/// Returns the first stage, counted from the last, with which the outcome differs from the CPU's.
fn broken_stage(
    mut run: impl FnMut(TakeOver) -> Outcome,
    agrees: impl Fn(&Outcome) -> bool,
) -> Option<TakeOver> {
    ALL.into_iter().find(|from| !agrees(&run(*from)))
}

/// Compares runs in which the GPU takes over at each stage with the CPU's, and locates each of the `broken`
/// stages.
pub(super) fn take_overs(context: &Context, broken: &[TakeOver]) {
    let mut random = Random::new(81);
    let layout = Layout::Panorama { width: 32, height: 16 };
    let mut directions = landmarks();
    directions.extend((0..10).map(|_| random.direction()));
    let source = environment(layout, texels(&mut random, Look::Smooth, layout));
    let oem = oem_from_environment(&source, SIZE).expect("a small matrix");
    let expected = on_the_cpu(&oem, &directions);
    let brightest = f64::from(source.texels().iter().flatten().copied().fold(0.0, f32::max));
    let totals = oem.totals();
    let mean = luminance([totals[0], totals[1], totals[2]]) / (4.0 * std::f64::consts::PI);
    let found = |broken: Option<TakeOver>| {
        broken_stage(
            |from| run(context, (&source, &oem), &directions, from, broken),
            |outcome| agree(&expected, outcome, brightest, mean),
        )
    };
    assert_eq!(found(None), None, "on {}", context.describe());
    for stage in broken {
        assert_eq!(found(Some(*stage)), Some(*stage), "on {}", context.describe());
    }
}

#[test]
fn the_gpu_takes_over_at_any_stage() {
    in_full("any stage", |context| take_overs(context, &ALL));
}
