//! `octagloss view --scene`: a moving scene that reflects itself through probes.

use super::console::Console;
use super::engine;
use super::outcome::{Outcome, check_not_input, check_output, usage, write_output};
use super::values::finite;
use super::view::ViewArgs;
use crate::gpu::direct::Method;
use crate::gpu::{Context, block_on};
use crate::image::exposure::Exposure;
use crate::io::ldr::write::png_bytes;
use crate::io::output::Existing;
use crate::view::scene::{
    MOST_BUDGET, MOST_PROBES, Proxy, Scene, SceneLook, SceneRenderer, SceneSettings, SceneStart, run_scene,
    scene_boxes, screenshot_of_scene,
};
use crate::view::{Camera, Mesh, Screenshot};
use clap::Args as ClapArgs;
use std::path::PathBuf;

/// Options that a scene does not have: by their names in [`ViewArgs`] and what it contains.
const WITHOUT: [&str; 22] = [
    "inputs",
    "border",
    "scan",
    "object",
    "mesh",
    "mesh_root",
    "paint",
    "textured",
    "metal",
    "backdrop",
    "ground",
    "turn",
    "show",
    "layout",
    "rotate_y",
    "mirror",
    "scale",
    "crop",
    "pad",
    "sanitize",
    "strict",
    "extract_sun",
];

/// Greatest --probes.
const PROBES: i64 = MOST_PROBES as i64;

#[derive(Debug, ClapArgs)]
#[command(next_help_heading = "Scene")]
pub(super) struct SceneArgs {
    /// Show a moving scene: built in, or of a mesh file
    ///
    /// Without FILE, glossy balls in a room. A .glb, .gltf or .obj file shows its base colours and emission;
    /// metal surfaces reflect the scene and each other.
    #[arg(long, value_name = "FILE", num_args = 0..=1, conflicts_with_all = WITHOUT)]
    pub(super) scene: Option<Option<PathBuf>>,
    /// Time of the scene at the beginning, in seconds
    #[arg(long, value_name = "S", default_value_t = 0.0, value_parser = finite)]
    #[arg(requires = "scene")]
    scene_time: f64,
    /// Probes, 1 to 8 [default: one per glossy object]
    ///
    /// Each is at the centre of a glossy object. Objects without a probe blend all probes by distance.
    #[arg(long, value_name = "N", requires = "scene")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=PROBES))]
    probes: Option<u32>,
    /// Milliseconds of a frame for the probes
    ///
    /// Updates as many as fit, in turns, and at least one. By default all are updated in every frame.
    /// Pictures by --screenshot have all up to date.
    #[arg(long, value_name = "MS", value_parser = budget, requires = "scene", conflicts_with = "screenshot")]
    probe_budget: Option<f64>,
    /// Correction of parallax: none, box or sphere
    ///
    /// The shape around the still objects that reflections come from. box by default for the built-in scene,
    /// which is a room, and none for files.
    #[arg(long, value_name = "SHAPE", hide_possible_values = true, requires = "scene")]
    proxy: Option<Proxy>,
    /// How the probes are drawn [default: octants]
    ///
    /// octants, clip-mask and strict-split draw into the octahedral map, exactly; xz-split, edge-strip and
    /// per-corner do so wrongly; cube and whole-cube draw six faces of as many texels and resample them.
    /// docs/direct.md explains them.
    #[arg(long, value_name = "METHOD", default_value = "octants", requires = "scene")]
    #[arg(hide_default_value = true, hide_possible_values = true)]
    direct: Method,
}

fn budget(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|ms: &f64| (0.0..=MOST_BUDGET).contains(ms));
    number.ok_or_else(|| format!("must be 0 to {MOST_BUDGET} milliseconds"))
}

pub(super) fn run(args: ViewArgs) -> Outcome {
    let boxes = match args.look.filter.map(scene_boxes).transpose() {
        Ok(boxes) => boxes.unwrap_or(SceneSettings::default().boxes),
        Err(error) => return usage(error.to_string()),
    };
    let file = args.scene.scene.clone().flatten();
    let console = Console::new(args.quiet);
    let scene = match &file {
        Some(path) => Scene::of_mesh(&Mesh::read(path)?)?,
        None => Scene::gallery()?,
    };
    let look = look(&args, scene.first_look());
    let settings = SceneSettings {
        method: args.scene.direct,
        probes: args.scene.probes.map_or(MOST_PROBES, |probes| probes as usize),
        size: args.oem_size.unwrap_or(SceneSettings::default().size),
        boxes,
    };
    if let Some(probes) = args.scene.probes.filter(|probes| *probes as usize > scene.glossy_parts()) {
        console.warn(&format!(
            "--probes {probes}: the scene has {} glossy objects, which have a probe each",
            scene.glossy_parts()
        ));
    }
    let Some(path) = &args.screenshot else {
        let name = file.as_deref().and_then(|path| path.file_stem());
        let name = name.map_or_else(|| "scene".to_owned(), |name| name.to_string_lossy().into_owned());
        let budget = args.scene.probe_budget.map(|ms| ms / 1e3);
        let (time, ViewArgs { adapter, size, .. }) = (args.scene.scene_time, args);
        return Ok(run_scene(SceneStart { scene, name, look, settings, time, budget, adapter, size })?);
    };
    let existing = if args.force { Existing::Replace } else { Existing::Keep };
    if !path.as_os_str().eq("-") && !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        return usage(format!("--screenshot {} must end in .png", path.display()));
    }
    check_not_input(path, file.iter())?;
    check_output(path, existing)?;
    let adapter = engine::any_adapter(args.adapter.as_deref())?;
    let context = block_on(None, Context::new(&adapter))??;
    console.note(&format!("adapter: {}", context.describe()));
    let (width, height) = args.size;
    let shot = Screenshot { width, height, samples: args.samples };
    let mut renderer = SceneRenderer::new(context.clone(), scene, settings)?;
    let time = args.scene.scene_time;
    let picture = block_on(Some(&context), screenshot_of_scene(&mut renderer, &look, time, shot))??;
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
