//! `octagloss view`: objects under an environment, in a window or as a picture.

use super::args::InputArgs;
use super::talk::Talk;
use super::values::{finite, roughness};
use super::{Outcome, engine, input, usage};
use clap::{Args as ClapArgs, ValueEnum};
use octagloss::gpu::{Context, block_on};
use octagloss::io::output::{Existing, check_file};
use octagloss::io::png_write::write_png;
use octagloss::synth::synth;
use octagloss::view::{
    Camera, Filter, Look, Mesh, Object, Renderer, Screenshot, Show, Start, Tone, Truth, run as run_window,
    screenshot,
};
use octagloss::{Environment, Rgb};
use std::path::PathBuf;

#[derive(Debug, ClapArgs)]
pub(super) struct ViewArgs {
    /// An environment [default: a sky with a sun]
    #[arg(value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// Write a picture instead of opening a window
    #[arg(long, value_name = "FILE.png")]
    screenshot: Option<PathBuf>,
    /// Size of the window or picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    size: (u32, u32),
    /// Samples along an edge of a pixel, 1 to 8
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=8))]
    samples: u32,
    #[command(flatten)]
    look: LookArgs,
    /// Edge of the octahedral map, 16 to 8192 [default: source's]
    ///
    /// A power of two. By default as fine as the source, at most 2048.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=8192))]
    oem_size: Option<u32>,
    #[command(flatten)]
    input: InputArgs,
    /// The GPU, by a part of its name
    ///
    /// octagloss info --adapters lists them.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Say nothing but errors
    #[arg(long, short)]
    quiet: bool,
    /// Replace the picture if it exists
    #[arg(long)]
    force: bool,
}

/// What is shown at first, and in a picture.
#[derive(Debug, ClapArgs)]
#[command(next_help_heading = "Look")]
struct LookArgs {
    /// sphere, row or knot
    ///
    /// A sphere, nine of roughness 0 to 1, or a torus knot.
    #[arg(long, value_name = "OBJECT", default_value = "sphere", hide_possible_values = true)]
    object: ObjectArg,
    /// A mesh instead: .gltf, .glb or .obj
    #[arg(long, value_name = "FILE", conflicts_with = "object")]
    mesh: Option<PathBuf>,
    /// Roughness of the object, 0 to 1
    #[arg(long, value_name = "R", default_value_t = 0.3, value_parser = roughness, allow_negative_numbers = true)]
    roughness: f64,
    /// Let the roughness vary over the surface
    ///
    /// It is multiplied by a map: the mesh's own where it has one.
    #[arg(long)]
    textured: bool,
    /// Reflectance at normal incidence, linear
    #[arg(long, value_name = "R,G,B", default_value = "0.95,0.93,0.88", value_parser = metal)]
    metal: Rgb,
    /// Roughness that blurs the backdrop, 0 to 1
    #[arg(long, value_name = "R", default_value_t = 0.0, value_parser = roughness, allow_negative_numbers = true)]
    backdrop: f64,
    /// Turn the environment about +Y, in degrees
    #[arg(long, value_name = "DEG", default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    turn: f64,
    /// Exposure in powers of two
    #[arg(long, value_name = "EV", default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    exposure: f64,
    /// neutral, aces, reinhard or linear
    #[arg(long, value_name = "TONE", default_value = "neutral", hide_possible_values = true)]
    tone: ToneArg,
    /// box, fitted:K, levels or adaptive
    ///
    /// fitted:K is the real-time tier, K 1, 2, 4 or 8. levels is a prefiltered cube as engines have it. adaptive is the
    /// certified tier, by the CPU for the pixels that are seen.
    #[arg(long, value_name = "F", default_value_t = Filter::Fitted(4))]
    filter: Filter,
    /// scene, oem, sat or error
    ///
    /// oem is the octahedral map, sat its table (means of the boxes from the corner), error the filter's relative error
    /// against the certified tier in false colour, from 1e-4 (black) over blue and red to 1 (yellow).
    #[arg(long, value_name = "WHAT", default_value = "scene", hide_possible_values = true)]
    show: ShowArg,
    /// Camera: turn to the right, in degrees
    #[arg(long, value_name = "DEG", default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    yaw: f64,
    /// Camera: height above the horizon, in degrees
    #[arg(long, value_name = "DEG", default_value_t = 7.0, value_parser = finite, allow_negative_numbers = true)]
    pitch: f64,
    /// Camera: distance in radii of the object
    #[arg(long, value_name = "D", default_value_t = 4.2, value_parser = finite, allow_negative_numbers = true)]
    distance: f64,
    /// Camera: vertical angle of view, in degrees
    #[arg(long, value_name = "DEG", default_value_t = 35.0, value_parser = finite, allow_negative_numbers = true)]
    angle: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ObjectArg {
    Sphere,
    Row,
    Knot,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ToneArg {
    Neutral,
    Aces,
    Reinhard,
    Linear,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ShowArg {
    Scene,
    Oem,
    Sat,
    Error,
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
        Look {
            object: match (&self.mesh, self.object) {
                (Some(_), _) => Object::Mesh,
                (None, ObjectArg::Sphere) => Object::Sphere,
                (None, ObjectArg::Row) => Object::Row,
                (None, ObjectArg::Knot) => Object::Knot,
            },
            camera: Camera {
                yaw: self.yaw.to_radians(),
                pitch: self.pitch.to_radians(),
                distance: self.distance,
                angle: self.angle.to_radians(),
            },
            roughness: self.roughness,
            textured: self.textured,
            metal: self.metal,
            backdrop: self.backdrop,
            turn: self.turn,
            exposure: self.exposure,
            tone: match self.tone {
                ToneArg::Neutral => Tone::Neutral,
                ToneArg::Aces => Tone::Aces,
                ToneArg::Reinhard => Tone::Reinhard,
                ToneArg::Linear => Tone::Linear,
            },
            filter: self.filter,
            show: match self.show {
                ShowArg::Scene => Show::Scene,
                ShowArg::Oem => Show::Oem,
                ShowArg::Sat => Show::Sat,
                ShowArg::Error => Show::Error,
            },
        }
    }
}

pub(super) fn run(args: ViewArgs) -> Outcome {
    let look = args.look.look();
    if let Err(error) = look.check() {
        return usage(error.to_string());
    }
    if let Some(size) = args.oem_size.filter(|size| !size.is_power_of_two()) {
        return usage(format!("--oem-size {size} is no power of two, which fitted lobes need"));
    }
    let talk = Talk::new(args.quiet);
    let (environment, name) = environment(&args, &talk)?;
    let mesh = args.look.mesh.as_deref().map(Mesh::read).transpose()?;
    let Some(path) = &args.screenshot else {
        let ViewArgs { oem_size, adapter, size, .. } = args;
        return Ok(run_window(Start { environment, name, mesh, look, oem_size, adapter, size })?);
    };
    let existing = if args.force { Existing::Replace } else { Existing::Keep };
    check_file(path, existing)?;
    let adapter = engine::any_adapter(args.adapter.as_deref())?;
    let context = block_on(None, Context::new(&adapter))??;
    talk.note(&format!("adapter: {}", context.describe()));
    let mut renderer = Renderer::new(context.clone())?;
    if let Some(mesh) = &mesh {
        renderer.set_mesh(mesh)?;
    }
    let light = renderer.light(&environment, args.oem_size)?;
    let truth = look.needs_truth().then(|| Truth::new(light.environment())).transpose()?;
    let (width, height) = args.size;
    let shot = Screenshot { width, height, samples: args.samples };
    let picture = block_on(Some(&context), screenshot(&mut renderer, &look, &light, truth.as_ref(), shot))??;
    Ok(write_png(path, existing, &picture)?)
}

/// The environment asked for, or the built-in sky, and its name.
fn environment(args: &ViewArgs, talk: &Talk) -> Outcome<(Environment, String)> {
    if args.inputs.is_empty() {
        return Ok((synth("sky")?, "sky".to_owned()));
    }
    let source = input::single_source(args.inputs.clone(), &args.input)?;
    Ok((source.open(&args.input, talk)?.environment, source.stem()))
}
