//! `octagloss bench`: times the stages and prints JSON. Compare ratios within one run.

use super::args::BenchArgs;
use super::engine::EngineArg;
use super::outcome::{Outcome, on_threads, print_pretty};
use super::timing::{TimedLight, Timing, timing};
use crate::{BakeSettings, Filter, Ladder, OemSize, Scan, bake};
use octagloss_core::analysis::sat_f32::sat_f32;
use octagloss_core::bake::memory;
use octagloss_core::common::parallel;
use octagloss_core::cpu::reparameterise::oem_from_environment;
use octagloss_core::cpu::sat_scan;
use octagloss_core::light::sat::FixedPoint;
use serde::Serialize;
use serde_json::{Value, json};
use std::time::Instant;

#[derive(Serialize)]
struct ByThreads {
    one: Timing,
    two: Timing,
}

/// Peak bytes per table texel: half a texel of the panorama, the map, and two tables.
const BYTES_A_TEXEL: u64 = 6 + 16 + 2 * 32;

pub(super) fn run(args: BenchArgs) -> Outcome {
    args.engine.check()?;
    if args.direct {
        if args.engine.engine == EngineArg::Cpu {
            return super::outcome::usage("--direct draws on a GPU; omit --engine cpu");
        }
        #[cfg(feature = "gpu")]
        return super::bench_direct::run(&args);
        #[cfg(not(feature = "gpu"))]
        return super::outcome::usage("built without the feature gpu; omit --direct");
    }
    if args.engine.engine == EngineArg::Gpu || args.engine.adapter.is_some() {
        #[cfg(feature = "gpu")]
        return super::bench_gpu::run(&args);
        #[cfg(not(feature = "gpu"))]
        return super::outcome::usage("built without the feature gpu");
    }
    let (size, runs) = (args.size, args.runs);
    memory::check_square("this bench", "--size", size, BYTES_A_TEXEL)?;
    let light = TimedLight::new(&args)?;
    let environment = &*light.environment(size)?;
    let make_oem = || oem_from_environment(environment, OemSize { inner: size, border: 0 });
    let oem = make_oem()?;

    let count = size as usize * size as usize;
    let from: Vec<[u64; 4]> = (0..count as u64).map(|k| [k; 4]).collect();
    let mut to = vec![[1; 4]; count];
    let copy = by_threads(|| time(runs, || copy(&from, &mut to)))?;
    drop(from);
    let fixed = FixedPoint::of_square(&oem);
    let mut scan = |scan| time(runs, || sat_scan::scan(scan, fixed, oem.texels(), size as usize, &mut to));
    let sat = by_threads(|| scan(Scan::Blocks))?;
    let sat_serial = on_threads(Some(1), || Ok(scan(Scan::Serial)))?;
    let sat_hensley_radix_4 = on_threads(Some(1), || Ok(scan(Scan::Hensley { radix: 4 })))?;
    let sat_f32 = on_threads(Some(1), || Ok(time(runs, || sat_f32(&oem))))?;
    let oem = by_threads(|| time(runs, make_oem))?;
    let bake = on_threads(args.engine.threads, || time_bake(&light, size.min(512), runs))?;

    let ratio = |a: Timing, b: Timing| a.median_seconds / b.median_seconds;
    print_pretty(&json!({
        "version": env!("CARGO_PKG_VERSION"),
        "machine": {
            "cpu": cpu_name(),
            "cores": std::thread::available_parallelism().map_or(1, usize::from),
            "os": std::env::consts::OS,
        },
        // Path of the input; `null` for the synthetic sky.
        "input": light.name(),
        "size": size,
        // Runs of every section.
        "runs": runs,
        // Copies as many bytes as the table holds.
        "copy": copy,
        // Builds the exact table: four channels of 64 bits, into already mapped memory.
        "sat": sat,
        "sat_serial": sat_serial,
        "sat_hensley_radix_4": sat_hensley_radix_4,
        "sat_f32": sat_f32,
        // The input, or a panorama of `size` columns, into an octahedral map of `size` texels.
        "oem": oem,
        // The input, or a panorama of 512x256, into a cube of 256^2 (all halved while `size` is smaller),
        // Filament levels, adaptive:0.005, on `--threads`.
        "bake": bake,
        "ratios": {
            "sat_over_copy": ratio(sat.one, copy.one),
            "sat_over_copy_two_threads": ratio(sat.two, copy.two),
            "sat_two_threads_speedup": ratio(sat.one, sat.two),
            "sat_f32_over_copy": ratio(sat_f32, copy.one),
            "oem_two_threads_speedup": ratio(oem.one, oem.two),
        },
    }))
}

/// Times `work` on one thread and on two.
fn by_threads(mut work: impl FnMut() -> Timing + Send) -> Outcome<ByThreads> {
    let one = on_threads(Some(1), || Ok(work()))?;
    let two = on_threads(Some(2), || Ok(work()))?;
    Ok(ByThreads { one, two })
}

/// Median of `runs` after one warm-up run.
fn time<T>(runs: u32, mut work: impl FnMut() -> T) -> Timing {
    std::hint::black_box(work());
    let seconds = (0..runs)
        .map(|_| {
            let start = Instant::now();
            std::hint::black_box(work());
            start.elapsed().as_secs_f64()
        })
        .collect();
    timing(seconds)
}

/// Copies memory, split between the threads.
fn copy(from: &[[u64; 4]], to: &mut [[u64; 4]]) {
    let share = from.len().div_ceil(rayon::current_num_threads());
    parallel::for_each(to.chunks_mut(share).zip(from.chunks(share)), |(to, from)| to.copy_from_slice(from));
}

fn time_bake(light: &TimedLight, width: u32, runs: u32) -> Outcome<Value> {
    let environment = light.environment(width)?;
    let settings = BakeSettings {
        size: width / 2,
        ladder: Ladder::Filament,
        filter: Filter::Adaptive(0.005),
        ..BakeSettings::default()
    };
    let (mut whole, mut levels) = (Vec::new(), Vec::new());
    for _ in 0..runs {
        let start = Instant::now();
        let baked = bake(&environment, &settings)?;
        whole.push(start.elapsed().as_secs_f64());
        levels.resize(baked.stats.len(), Vec::new());
        for (level, stats) in levels.iter_mut().zip(&baked.stats) {
            level.push(stats.seconds);
        }
    }
    Ok(json!({
        "source_width": environment.layout().sides().0,
        "cube_size": settings.size,
        "whole": timing(whole),
        "levels": levels.into_iter().map(timing).collect::<Vec<_>>(),
    }))
}

/// The processor's name, if the system reports it.
fn cpu_name() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}
