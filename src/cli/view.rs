//! `octagloss view`: renders objects lit by an environment, in a window or to a picture.

use super::console::Console;
use super::outcome::{Outcome, check_not_input, check_output, usage, write_output};
use super::shared_args::InputArgs;
use super::values::{finite, roughness};
use super::view_scene::{self, SceneArgs};
use super::{engine, input};
use crate::gpu::{Context, block_on};
use crate::image::exposure::Exposure;
use crate::io::LoadedChain;
use crate::io::ldr::write::png_bytes;
use crate::io::output::Existing;
use crate::reflector::ReflectorSettings;
use crate::sat::Scan;
use crate::synth::synth;
use crate::view::{
    Camera, FRONT, Ground, Levels, Look, Mesh, Object, Paint, Renderer, Screenshot, Show, Start, Technique,
    Tone, Truth, run as run_window, screenshot,
};
use crate::{Environment, Layout, Rgb};
use clap::Args as ClapArgs;
use std::path::PathBuf;

#[derive(Debug, ClapArgs)]
pub(super) struct ViewArgs {
    /// An environment or a bake [default: a sky with a sun]
    #[arg(value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// Write a picture instead of opening a window
    #[arg(long, value_name = "FILE.png")]
    pub(super) screenshot: Option<PathBuf>,
    /// Size of the window or picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    pub(super) size: (u32, u32),
    /// Samples along a pixel's edge, 1 to 8
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=8))]
    pub(super) samples: u32,
    #[command(flatten)]
    pub(super) look: LookArgs,
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Edge of the octahedral map, 16 to 8192 [default: source's]
    ///
    /// A power of two. By default as fine as the source, at most 2048.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=8192))]
    pub(super) oem_size: Option<u32>,
    /// Border of the octahedral map in texels, 0 to 4096
    #[arg(long, value_name = "B", default_value_t = 0)]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=4096))]
    border: u32,
    /// blocks, hensley:2, :4, :8 or :16 [default: blocks]
    ///
    /// Scan of the summed-area tables, as in bake. All scans give the same picture.
    #[arg(long, value_name = "SCAN")]
    scan: Option<Scan>,
    #[command(flatten)]
    input: InputArgs,
    /// GPU, by a part of its name
    ///
    /// octagloss info --adapters lists them.
    #[arg(long, value_name = "NAME")]
    pub(super) adapter: Option<String>,
    /// Print errors only
    #[arg(long, short)]
    pub(super) quiet: bool,
    /// Replace the picture if it exists
    #[arg(long)]
    pub(super) force: bool,
}

/// Initial state of the view, and the state in a picture.
#[derive(Debug, ClapArgs)]
#[command(next_help_heading = "Look")]
pub(super) struct LookArgs {
    /// sphere, row or knot
    ///
    /// A sphere, nine of roughness 0 to 1, or a torus knot.
    #[arg(long, value_name = "OBJECT", default_value = "sphere", hide_possible_values = true)]
    object: Object,
    /// Show a mesh: .gltf, .glb or .obj
    ///
    /// glTF: triangles with base colour, metalness and roughness of materials, textures, vertex colours and
    /// masks; no bump maps, lights or transparency. OBJ: triangles only. The camera faces the mesh's +Z side.
    #[arg(long, value_name = "FILE", conflicts_with = "object")]
    mesh: Option<PathBuf>,
    /// Folder above the mesh that may hold its files
    ///
    /// Without it, reads only files below the mesh's own folder.
    #[arg(long, value_name = "DIR", requires = "mesh")]
    mesh_root: Option<PathBuf>,
    /// Material of a mesh: file or plain
    ///
    /// file uses the file's materials, multiplied by --roughness and --metal. plain is a metal of --roughness
    /// and --metal, like the other objects; also used for files without materials.
    #[arg(long, value_name = "PAINT", default_value_t = Paint::File, requires = "mesh")]
    paint: Paint,
    /// Roughness, 0 to 1 [default: 0.2; 1 for file]
    ///
    /// For a mesh with materials, a factor of their roughness.
    #[arg(long, value_name = "R", value_parser = roughness)]
    pub(super) roughness: Option<f64>,
    /// Vary the roughness over the surface
    ///
    /// Multiplies it by a map. Does not affect materials of a mesh's file.
    #[arg(long)]
    textured: bool,
    /// Reflectance at normal incidence, linear
    ///
    /// By default 0.95,0.93,0.88. For a mesh with materials, a factor of their base colours, by default
    /// 1,1,1.
    #[arg(long, value_name = "R,G,B", value_parser = metal)]
    metal: Option<Rgb>,
    /// Blur of the backdrop, 0 to 1 [default: hides texels]
    ///
    /// As a roughness. By default a lobe just wide enough to hide the texels of a coarse environment; 0 shows
    /// them.
    #[arg(long, value_name = "R", value_parser = roughness)]
    backdrop: Option<f64>,
    /// shadow or none: below spheres
    ///
    /// shadow darkens the environment below spheres as if they stood on a plane under an even sky.
    #[arg(long, value_name = "GROUND", default_value = "shadow", hide_possible_values = true)]
    ground: Ground,
    /// Rotate the environment about +Y, in degrees
    #[arg(long, value_name = "DEG", default_value_t = 0.0, value_parser = finite)]
    turn: f64,
    /// Exposure: auto, or -40 to 40 EV
    ///
    /// auto brings the log-average luminance of the environment to middle grey, as in bake --preview.
    #[arg(long, value_name = "EV", default_value_t = Exposure::Auto)]
    pub(super) exposure: Exposure,
    /// neutral, aces, reinhard or linear
    #[arg(long, value_name = "TONE", default_value = "neutral", hide_possible_values = true)]
    pub(super) tone: Tone,
    /// box, fitted:K, levels, adaptive [default: fitted:4]
    ///
    /// fitted:K is the real-time tier, K 1, 2, 4 or 8. levels is a prefiltered cube as in engines; for a bake
    /// with several levels it shows the bake's own and is the default. The other filters then use level 0.
    /// adaptive is the certified tier, computed on the CPU for visible pixels.
    #[arg(long, value_name = "F")]
    pub(super) filter: Option<Technique>,
    /// scene, oem, sat or error
    ///
    /// oem is the octahedral map. sat is its table (means of the boxes from the corner). error is the
    /// filter's relative error against the certified tier in false colour, from 1e-4 (black) through blue and
    /// red to 1 (yellow). Pictures of at least 320x200 pixels have a legend with scale, unit and range.
    #[arg(long, value_name = "WHAT", default_value = "scene", hide_possible_values = true)]
    show: Show,
    /// Camera: rotation to the right, in degrees
    ///
    /// 0, the default, looks along +X. -90, the default with --mesh, looks along -Z at the +Z side.
    #[arg(long, value_name = "DEG", value_parser = finite)]
    pub(super) yaw: Option<f64>,
    /// Camera: height, in degrees [default: 4; 7 for scenes]
    #[arg(long, value_name = "DEG", value_parser = finite)]
    pub(super) pitch: Option<f64>,
    /// Camera: distance in radii of the object
    #[arg(long, value_name = "D", default_value_t = 4.2, value_parser = finite)]
    pub(super) distance: f64,
    /// Camera: vertical angle, in degrees [default: fits]
    ///
    /// By default the objects fill the picture, whatever its shape: a row its width, a single object two
    /// thirds of its height. With an angle, pictures narrower than 3:2 keep the horizontal angle of 3:2.
    #[arg(long, value_name = "DEG", value_parser = finite)]
    pub(super) angle: Option<f64>,
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    sides
        .filter(|(w, h)| (1..=16384).contains(w) && (1..=16384).contains(h))
        .ok_or_else(|| "must be WxH, each side 1 to 16384".to_owned())
}

fn metal(text: &str) -> Result<Rgb, String> {
    let channels: Vec<f32> = text.split(',').filter_map(|channel| channel.trim().parse().ok()).collect();
    match <Rgb>::try_from(channels) {
        Ok(rgb) if rgb.iter().all(|c| (0.0..=1.0).contains(c)) && text.matches(',').count() == 2 => Ok(rgb),
        _ => Err("must be three numbers between 0 and 1, as 0.95,0.93,0.88".to_owned()),
    }
}

impl LookArgs {
    fn look(&self) -> Look {
        let look = Look::default();
        Look {
            object: if self.mesh.is_some() { Object::Mesh } else { self.object },
            camera: Camera {
                yaw: match self.yaw {
                    Some(degrees) => degrees.to_radians(),
                    None if self.mesh.is_some() => FRONT,
                    None => 0.0,
                },
                pitch: self.pitch.unwrap_or(4.0).to_radians(),
                distance: self.distance,
                angle: self.angle.map(f64::to_radians),
            },
            roughness: self.roughness.unwrap_or(look.roughness),
            textured: self.textured,
            metal: self.metal.unwrap_or(look.metal),
            paint: self.paint,
            tint: self.metal.unwrap_or(look.tint),
            roughness_factor: self.roughness.unwrap_or(look.roughness_factor),
            backdrop: self.backdrop,
            ground: self.ground,
            turn: self.turn,
            exposure: self.exposure,
            tone: self.tone,
            filter: self.filter.unwrap_or(look.filter),
            show: self.show,
        }
    }
}

pub(super) fn run(args: ViewArgs) -> Outcome {
    let mut look = args.look.look();
    if let Err(error) = look.check() {
        return usage(error.to_string());
    }
    if let Some(size) = args.oem_size.filter(|size| !size.is_power_of_two()) {
        return usage(format!("--oem-size {size} must be a power of two for fitted lobes"));
    }
    if args.scene.scene.is_some() {
        return view_scene::run(args);
    }
    let console = Console::new(args.quiet);
    let root = args.look.mesh_root.as_deref();
    let mesh = args.look.mesh.as_deref().map(|path| Mesh::read_within(path, root)).transpose()?;
    let (environment, name) = environment(&args, &console)?;
    let levels = levels(&args, &environment, &console)?;
    if levels.is_some() && args.look.filter.is_none() {
        look.filter = Technique::Levels;
    }
    let table = ReflectorSettings {
        oem_size: args.oem_size,
        border: Some(args.border),
        scan: args.scan.unwrap_or_default(),
        ..ReflectorSettings::default()
    };
    let Some(path) = &args.screenshot else {
        let ViewArgs { adapter, size, .. } = args;
        return Ok(run_window(Start { environment, name, levels, mesh, look, table, adapter, size })?);
    };
    if let Some(scan) = args.scan.filter(|_| !look.reads_sat()) {
        return usage(format!(
            "--scan {scan} is for pictures from a summed-area table, but --filter {} reads none; use box or \
             fitted:K, or omit --scan",
            look.filter
        ));
    }
    let existing = if args.force { Existing::Replace } else { Existing::Keep };
    if !path.as_os_str().eq("-") && !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        return usage(format!("--screenshot {} must end in .png", path.display()));
    }
    check_not_input(path, args.inputs.iter().chain(&args.look.mesh))?;
    check_output(path, existing)?;
    let adapter = engine::any_adapter(args.adapter.as_deref())?;
    let context = block_on(None, Context::new(&adapter))??;
    console.note(&format!("adapter: {}", context.describe()));
    let mut renderer = Renderer::new(context.clone())?;
    if let Some(mesh) = &mesh {
        renderer.set_mesh(mesh)?;
    }
    let mut light = renderer.light_with(&environment, &table)?;
    if let Some(levels) = &levels {
        light.set_levels(&context, levels)?;
    }
    let truth = look.needs_truth().then(|| Truth::new(light.environment())).transpose()?;
    let (width, height) = args.size;
    let shot = Screenshot { width, height, samples: args.samples };
    let picture = block_on(Some(&context), screenshot(&mut renderer, &look, &light, truth.as_ref(), shot))??;
    write_output(path, existing, &png_bytes(&picture)?)
}

/// The given environment, or the built-in sky, and its name.
fn environment(args: &ViewArgs, console: &Console) -> Outcome<(Environment, String)> {
    if args.inputs.is_empty() {
        return Ok((synth("sky")?, "sky".to_owned()));
    }
    let source = input::single_source(args.inputs.clone(), &args.input)?;
    Ok((source.open(&args.input, console)?.environment, source.stem()))
}

/// The levels of the input, if it is a bake with several. `None` with `--extract-sun`: the levels still
/// contain the sun.
fn levels(args: &ViewArgs, environment: &Environment, console: &Console) -> Outcome<Option<Levels>> {
    let ([path], false) = (&args.inputs[..], args.input.extract_sun) else { return Ok(None) };
    let Some(LoadedChain { mut chain, .. }) = input::read_bake(path)? else { return Ok(None) };
    if let Some(scale) = args.input.scale {
        let values = chain.levels.iter_mut().flat_map(|level| level.texels.as_flattened_mut());
        values.for_each(|value| *value = ((f64::from(*value) * scale) as f32).min(f32::MAX));
    }
    if environment.layout() != (Layout::Cube { size: chain.levels[0].size() }) {
        return Ok(None);
    }
    let mut turned = Environment::new(Layout::Cube { size: 1 }, vec![[0.0; 3]; 6])?;
    if args.input.mirror {
        turned = turned.mirrored();
    }
    if let Some(degrees) = args.input.rotate_y {
        turned = turned.rotated_y(degrees);
    }
    Ok(Levels::new(chain, turned.source_from_world()).unwrap_or_else(|error| {
        console.warn(&format!("{}: {error}; filtering its level 0 instead", path.display()));
        None
    }))
}
