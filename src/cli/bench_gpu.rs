//! `octagloss bench --engine gpu`: times the passes and prints JSON.

use super::args::BenchArgs;
use super::console::Console;
use super::engine::Engine;
use super::outcome::{Outcome, print_pretty};
use super::timing::{TimedLight, Timing, timing};
use crate::{BakeSettings, Environment, Filter, Ladder, Layout, OemSize};
use glam::DVec3;
use octagloss_core::bake::memory;
use octagloss_core::geometry::tent::Reconstruction;
use octagloss_core::sphere::equirect::direction_from_equirect;
use octagloss_gpu::device::timer::Clock;
use octagloss_gpu::stages::pyramid::{self, PyramidMaps};
use octagloss_gpu::stages::reparameterise::{self, upload};
use octagloss_gpu::stages::{
    box_filter, build_pyramid, cells, copy, fixed_point, sat_f32, sat_hensley, sat_scan,
};
use octagloss_gpu::{Context, OemPlanes, SatPlanes, Stage, block_on};
use serde_json::json;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Idle GPUs run at a fifth of their clock, and take so long to raise it.
const WARM_UP: Duration = Duration::from_millis(500);

/// Times of a list of stages.
struct Timings {
    each: Vec<Timing>,
    /// From first start to last end.
    whole: Timing,
    /// From submission to completion.
    wall: Timing,
}

/// Times each of `stages` and the whole in `runs` runs, after others that warm up.
fn time(context: &Context, clock: &Clock, runs: u32, stages: &[&Stage]) -> Outcome<Timings> {
    let mut each = vec![Vec::new(); stages.len()];
    let (mut whole, mut wall) = (Vec::new(), Vec::new());
    let run = || block_on(Some(context), clock.time(context, stages));
    let start = Instant::now();
    while start.elapsed() < WARM_UP {
        run()??;
    }
    for _ in 0..runs {
        let times = run()??;
        each.iter_mut().zip(times.each).for_each(|(each, seconds)| each.push(seconds));
        whole.push(times.whole);
        wall.push(times.wall);
    }
    Ok(Timings { each: each.into_iter().map(timing).collect(), whole: timing(whole), wall: timing(wall) })
}

/// Peak CPU bytes per table texel: the panorama, twice as large, and the cube with faces half as large, once
/// as built and once as uploaded.
const BYTES_A_TEXEL: u64 = 2 * 12 + 3 * (12 + 16) / 2;

pub(super) fn run(args: &BenchArgs) -> Outcome {
    let Engine::Gpu { engine, .. } = args.engine.choose(&Console::new(true))? else {
        return super::outcome::usage(
            "no hardware GPU found; --engine gpu accepts any adapter, --engine cpu times the CPU",
        );
    };
    let context = engine.context();

    let size = args.size;
    memory::check_square("this bench", "--size", size, BYTES_A_TEXEL)?;
    let planes = OemPlanes::new(context, OemSize { inner: size, border: 0 })?;
    let sat = SatPlanes::new(context, planes.size())?;
    let light = TimedLight::new(args)?;
    let source = cube(&light, size / 2)?;
    let texture = upload(context, &source)?;
    let mut names = Vec::new();
    let mut stages = Vec::new();
    let mut add = |name: &str, stage: Stage| {
        names.push(name.to_owned());
        stages.push(stage);
    };
    add("reparameterise", reparameterise::stage(context, source.layout(), &texture, &planes)?);
    add("fixed_point", fixed_point::stage(context, &planes, &sat));
    add("sat_scan", sat_scan::stage(context, &planes, &sat));
    for radix in [2, 4, 8, 16] {
        let stage = sat_hensley::stage(context, radix, &planes, &sat);
        add(&format!("sat_hensley_radix_{radix}"), stage);
    }
    // Skip passes that exceed the adapter's limits.
    if let Ok((stage, ..)) = sat_f32::stage(context, &planes) {
        add("sat_f32", stage);
    }
    if let Ok(textures) = box_filter::SatTextures::new(context, &sat) {
        add("pack", box_filter::pack(context, &sat, &textures));
    }
    if let Ok((stage, _)) = cells::stage(context, &planes, 2, Reconstruction::Constant) {
        add("cells_block_2", stage);
    }
    if let Ok(maps) = PyramidMaps::new(context, size) {
        add("pyramid", build_pyramid::stage(context, &planes, &maps));
        add("pyramid_1920x1080", pyramid::stage(context, &maps, &frame()).0);
    }
    stages.push(copy::stage(context, &sat));

    let source = cube(&light, 512)?;
    let texture = upload(context, &source)?;
    let planes = OemPlanes::new(context, OemSize { inner: 1024, border: 0 })?;
    let sat = SatPlanes::new(context, planes.size())?;
    let pipeline = [
        reparameterise::stage(context, source.layout(), &texture, &planes)?,
        fixed_point::stage(context, &planes, &sat),
        sat_scan::stage(context, &planes, &sat),
    ];

    let environment = light.environment(512)?;
    let settings = BakeSettings {
        size: 256,
        ladder: Ladder::Filament,
        filter: Filter::Adaptive(0.005),
        ..BakeSettings::default()
    };
    let levels = engine.bake_stages(&environment, &settings)?;

    let lists: [Vec<&Stage>; 3] = [&stages[..], &pipeline, &levels].map(|list| list.iter().collect());
    let clock = block_on(Some(context), Clock::of(context, &lists.each_ref().map(Vec::as_slice)))??;
    let timed = |stages: &Vec<&Stage>| time(context, &clock, args.runs, stages);
    let (mut all, pipeline, bake) = (timed(&lists[0])?, timed(&lists[1])?, timed(&lists[2])?);
    let copy = all.each.pop().expect("the copy is the last");
    let stages: BTreeMap<String, Timing> = names.into_iter().zip(all.each).collect();
    let seconds = |name: &str| stages.get(name).map(|timing| timing.median_seconds);
    let mut ratios = BTreeMap::new();
    for (name, timing) in &stages {
        if name.starts_with("sat_") {
            ratios.insert(format!("copy_over_{name}"), copy.median_seconds / timing.median_seconds);
        }
    }
    if let Some((scan, hensley)) = seconds("sat_scan").zip(seconds("sat_hensley_radix_2")) {
        ratios.insert("sat_hensley_radix_2_over_sat_scan".to_owned(), hensley / scan);
    }
    print_pretty(&json!({
        "version": env!("CARGO_PKG_VERSION"),
        "adapter": context.describe(),
        "software": !octagloss_gpu::device::context::is_hardware(&context.device().adapter_info()),
        // Path of the input; `null` for the synthetic sky.
        "input": light.name(),
        "size": size,
        "runs": args.runs,
        // What measures: timestamp queries, or the time from the submission of a stage to its completion, if
        // the device's timestamps are missing or leave out work.
        "clock": clock.name(),
        // Reads and writes 24 bytes per texel, the minimum traffic of a scan.
        "copy": copy,
        // Each pass over an octahedral map of `size` texels, and a frame by the pyramid with per-pixel
        // roughness.
        "stages": stages,
        // From submission to completion of all these and the copy; of `cube_to_sat`; of `bake`.
        "wall": { "stages": all.wall, "cube_to_sat": pipeline.wall, "bake": bake.wall },
        // Cube of 6 x 512^2 to an octahedral map of 1024^2 to its exact table, all dispatches.
        "cube_to_sat": pipeline.whole,
        // The input, or 512x256, into 256^2, five Filament levels, adaptive:0.005: the time of
        // reparameterisation, of cells, if some level needs them, and of every level; and of all.
        "bake": { "levels": bake.each, "total_seconds": bake.whole.median_seconds },
        "ratios": ratios,
    }))
}

/// Every pixel of a 1920x1080 panorama, with roughness increasing from left to right.
fn frame() -> Vec<(DVec3, f64)> {
    let pixels = (0..1080).flat_map(|y| (0..1920).map(move |x| [x, y]));
    pixels
        .map(|[x, y]| {
            let (u, v) = ((f64::from(x) + 0.5) / 1920.0, (f64::from(y) + 0.5) / 1080.0);
            (direction_from_equirect(u, v), u)
        })
        .collect()
}

/// The light on a cube with faces of `size`.
fn cube(light: &TimedLight, size: u32) -> crate::Result<Environment> {
    let environment = light.environment(4 * size)?;
    let texels = octagloss_core::geometry::footprints::footprints_over(&environment, Layout::Cube { size })?;
    Environment::new(Layout::Cube { size }, texels)
}
