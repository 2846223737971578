//! `octagloss view --scene`: a moving scene that reflects itself through probes.

use super::console::Console;
use super::outcome::{Outcome, or_usage, write_output};
use super::view_args::ViewArgs;
use crate::recipes::Exposure;
use octagloss_core::files::io::ldr::png_bytes;
use octagloss_gpu::block_on;
use octagloss_gpu::device::context::may_have_hardware;
use octagloss_view::scene::{
    MAX_PROBES, Scene, SceneLook, SceneRenderer, SceneSettings, SceneStart, check_scene_filter, run_scene,
    screenshot_of_scene,
};
use octagloss_view::{Camera, Mesh, Screenshot};
use std::time::Instant;

/// Seconds of all updates from which a hint says how to shorten them.
const SLOW: f64 = 5.0;

pub(super) fn run(args: ViewArgs) -> Outcome {
    or_usage(args.look.filter.map(check_scene_filter).transpose())?;
    let file = args.scene.scene.clone().flatten();
    let console = Console::new(args.quiet);
    let scene = match &file {
        Some(path) => Scene::of_mesh(&Mesh::read(path)?)?,
        None => Scene::gallery()?,
    };
    let look = look(&args, scene.first_look());
    let settings = SceneSettings {
        method: args.scene.direct,
        probes: args.scene.probes.map_or(MAX_PROBES, |probes| probes as usize),
        size: args.oem_size.unwrap_or(SceneSettings::default().size),
    };
    let glossy = scene.glossy_parts();
    if let Some(probes) = args.scene.probes.filter(|probes| *probes as usize > glossy) {
        console.warn(&format!(
            "--probes {probes}: the scene has {glossy} glossy objects, which have a probe each"
        ));
    }
    let Some(path) = &args.screenshot else {
        let name = file.as_deref().and_then(|path| path.file_stem());
        let name = name.map_or_else(|| "scene".to_owned(), |name| name.to_string_lossy().into_owned());
        let budget = args.scene.probe_budget.map(|ms| ms / 1e3);
        let probes = settings.probes.min(glossy);
        if budget.is_none() && probes > 1 && !may_have_hardware() {
            console.note(&format!(
                "no hardware GPU: every frame updates {probes} probes, which takes seconds; --probes N or \
                 --probe-budget MS is faster"
            ));
        }
        let (time, ViewArgs { adapter, size, .. }) = (args.scene.scene_time, args);
        return Ok(run_scene(SceneStart { scene, name, look, settings, time, budget, adapter, size })?);
    };
    let (existing, context) = args.prepared(path, file.iter(), &console)?;
    let (width, height) = args.size;
    let shot = Screenshot { width, height, samples: args.samples };
    let mut renderer = SceneRenderer::new(context.clone(), scene, settings)?;
    let wanted = settings.probes.min(glossy);
    if renderer.probes() < wanted {
        console.warn(&format!(
            "{} probes: one binding of the adapter holds no more tables of --oem-size {}; the other {} \
             glossy objects blend them",
            renderer.probes(),
            settings.size,
            wanted - renderer.probes()
        ));
    }
    let time = args.scene.scene_time;
    let (bar, start, probes) = (console.bar("probes"), Instant::now(), renderer.probes());
    let progress = |done: usize, total: usize| {
        let each = start.elapsed().as_secs_f64() / done as f64;
        if done == 1 && probes > 1 && each * total as f64 > SLOW {
            console.note(&format!(
                "{total} updates of {probes} probes take about {each:.1} s each; --probes N or a smaller \
                 --oem-size is faster"
            ));
        }
        bar.at(done as u64, total as u64);
    };
    let picture = screenshot_of_scene(&mut renderer, &look, time, shot, progress);
    let picture = block_on(Some(&context), picture)??;
    drop(bar);
    write_output(path, existing, &png_bytes(&picture)?)
}

/// The first look of a scene with the options.
fn look(args: &ViewArgs, first: SceneLook) -> SceneLook {
    SceneLook {
        camera: Camera {
            yaw: args.look.yaw.map_or(first.camera.yaw, f64::to_radians),
            pitch: args.look.pitch.map_or(first.camera.pitch, f64::to_radians),
            distance: args.look.distance,
            angle: args.look.angle.map(f64::to_radians),
        },
        roughness: args.look.roughness,
        // The built-in light needs no other.
        exposure: match args.look.exposure {
            Exposure::Auto => 0.0,
            Exposure::Ev(ev) => ev,
        },
        tone: args.look.tone,
        proxy: args.scene.proxy.unwrap_or(first.proxy),
    }
}
