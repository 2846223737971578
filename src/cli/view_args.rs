//! Arguments of `octagloss view`.

use super::console::Console;
use super::engine;
use super::outcome::{Outcome, check_not_input, check_output, check_png};
use super::values::{roughness, turn, within};
use crate::files::Existing;
use crate::recipes::{Exposure, InputOptions};
use crate::{Rgb, Scan};
use clap::Args as ClapArgs;
use octagloss_core::lobe::filter::FITTED;
use octagloss_gpu::direct::Method;
use octagloss_gpu::{Context, block_on};
use octagloss_view::scene::{MAX_BUDGET, MAX_PROBES, Proxy};
use octagloss_view::{Camera, FRONT, Finish, Ground, Look, Object, Paint, Show, Technique, Tone};
use std::path::{Path, PathBuf};

#[derive(Debug, ClapArgs)]
pub(super) struct ViewArgs {
    /// An environment or a bake [default: a sky with a sun]
    #[arg(value_name = "INPUT")]
    pub(super) inputs: Vec<PathBuf>,
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
    /// Edge of the octahedral map, 32 to 2048 [default: source's]
    ///
    /// A power of two. By default as fine as the source, at most 2048.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(32..=2048))]
    pub(super) oem_size: Option<u32>,
    /// Border of the octahedral map in texels, 0 to 4096
    #[arg(long, value_name = "B", default_value_t = 0)]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=4096))]
    pub(super) border: u32,
    /// blocks, hensley:2, :4, :8 or :16 [default: blocks]
    ///
    /// Scan of the summed-area tables, as in bake. All scans give the same picture.
    #[arg(long, value_name = "SCAN")]
    pub(super) scan: Option<Scan>,
    #[command(flatten)]
    pub(super) input: InputOptions,
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
    pub(super) object: Object,
    /// Show a mesh: .gltf, .glb or .obj
    ///
    /// glTF: triangles with base colour, metalness and roughness of materials, textures, vertex colours and
    /// masks, factors of anisotropy and clear coat; no bump maps, lights or transparency. OBJ: triangles
    /// only. The camera faces the mesh's +Z side.
    #[arg(long, value_name = "FILE", conflicts_with = "object")]
    pub(super) mesh: Option<PathBuf>,
    /// Folder above the mesh that may hold its files
    ///
    /// Without it, reads only files below the mesh's own folder.
    #[arg(long, value_name = "DIR", requires = "mesh")]
    pub(super) mesh_root: Option<PathBuf>,
    /// Material of a mesh: file or plain
    ///
    /// file uses the file's materials, multiplied by --roughness and --metal. plain is a metal of --roughness
    /// and --metal, like the other objects; also used for files without materials.
    #[arg(long, value_name = "PAINT", default_value_t = Paint::File, requires = "mesh")]
    pub(super) paint: Paint,
    /// Roughness, 0 to 1 [default: 0.2; 1 for file]
    ///
    /// For a mesh with materials, a factor of their roughness.
    #[arg(long, value_name = "R", value_parser = roughness)]
    pub(super) roughness: Option<f64>,
    /// Vary the roughness over the surface
    ///
    /// Multiplies it by a map. Does not affect materials of a mesh's file.
    #[arg(long)]
    pub(super) textured: bool,
    /// Reflectance at normal incidence, linear
    ///
    /// By default 0.95,0.93,0.88. For a mesh with materials, a factor of their base colours, by default
    /// 1,1,1.
    #[arg(long, value_name = "R,G,B", value_parser = metal)]
    pub(super) metal: Option<Rgb>,
    /// Anisotropy, 0 to 1 [default: 0]
    ///
    /// As in KHR_materials_anisotropy: alpha along the brushing is r^2 + (1 - r^2) A^2. Spheres are brushed
    /// around the vertical axis, meshes along u of their texture coordinates. With --filter reflect, which it
    /// chooses. The first picture takes some seconds more. Materials of a mesh's file have their own.
    #[arg(long, value_name = "A", value_parser = within([0.0, 1.0]))]
    pub(super) anisotropy: Option<f64>,
    /// Turn the brushing, in degrees [default: 0]
    #[arg(long, value_name = "DEG", value_parser = turn, requires = "anisotropy")]
    pub(super) direction: Option<f64>,
    /// Clear coat, 0 to 1 [default: 0]
    ///
    /// As in KHR_materials_clearcoat. With --filter reflect, which it chooses. Materials of a mesh's file
    /// have their own.
    #[arg(long, value_name = "C", value_parser = within([0.0, 1.0]))]
    pub(super) clearcoat: Option<f64>,
    /// Roughness of the clear coat, 0 to 1 [default: 0.05]
    #[arg(long, value_name = "R", value_parser = roughness, requires = "clearcoat")]
    pub(super) coat_roughness: Option<f64>,
    /// Blur of the backdrop, 0 to 1 [default: hides texels]
    ///
    /// As a roughness. By default a lobe just wide enough to hide the texels of a coarse environment; 0 shows
    /// them.
    #[arg(long, value_name = "R", value_parser = roughness)]
    pub(super) backdrop: Option<f64>,
    /// shadow or none: below spheres
    ///
    /// shadow darkens the environment below spheres as if they stood on a plane under an even sky.
    #[arg(long, value_name = "GROUND", default_value = "shadow", hide_possible_values = true)]
    pub(super) ground: Ground,
    /// Rotate the environment about +Y, in degrees
    #[arg(long, value_name = "DEG", default_value_t = 0.0, value_parser = turn)]
    pub(super) turn: f64,
    /// Exposure: auto, or -40 to 40 EV
    ///
    /// auto brings the log-average luminance of the environment to middle grey, as in bake --preview.
    #[arg(long, value_name = "EV", default_value_t = Exposure::Auto)]
    pub(super) exposure: Exposure,
    /// neutral, aces, reinhard or linear
    #[arg(long, value_name = "TONE", default_value = "neutral", hide_possible_values = true)]
    pub(super) tone: Tone,
    /// box, pyramid, reflect, levels, adaptive [default: pyramid]
    ///
    /// pyramid is the real-time tier: lobes around the mirrored view, times the split sum. reflect is the
    /// true reflection, by the same maps and without a split sum. levels is a prefiltered cube as in engines;
    /// for a bake with several levels it shows the bake's own and is the default. The other filters then use
    /// level 0. adaptive is the certified tier, computed on the CPU for visible pixels.
    #[arg(long, value_name = "F", value_parser = technique)]
    pub(super) filter: Option<Technique>,
    /// scene, oem, sat or error
    ///
    /// oem is the octahedral map. sat is its table (means of the boxes from the corner). error is the
    /// filter's relative error against the certified tier in false colour, from 1e-4 (black) through blue and
    /// red to 1 (yellow). Pictures of at least 480x270 pixels have a legend with scale, unit and range.
    #[arg(long, value_name = "WHAT", default_value = "scene", hide_possible_values = true)]
    pub(super) show: Show,
    /// Camera: rotation to the right, in degrees
    ///
    /// 0, the default, looks along +X. -90, the default with --mesh, looks along -Z at the +Z side.
    #[arg(long, value_name = "DEG", value_parser = turn)]
    pub(super) yaw: Option<f64>,
    /// Camera: height, -90 to 90 degrees [default: 4 or 7]
    ///
    /// 4, and 7 for the built-in scene.
    #[arg(long, value_name = "DEG", value_parser = within([-90.0, 90.0]))]
    pub(super) pitch: Option<f64>,
    /// Camera: distance in radii, 1.05 to 1000
    #[arg(long, value_name = "D", default_value_t = 4.2, value_parser = within([1.05, 1000.0]))]
    pub(super) distance: f64,
    /// Camera: vertical angle, in degrees [default: fits]
    ///
    /// By default the objects fill the picture, whatever its shape: a row its width, a single object two
    /// thirds of its height. With an angle, pictures narrower than 3:2 keep the horizontal angle of 3:2.
    #[arg(long, value_name = "DEG", value_parser = within([0.6, 171.0]))]
    pub(super) angle: Option<f64>,
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    sides
        .filter(|(w, h)| (1..=16384).contains(w) && (1..=16384).contains(h))
        .ok_or_else(|| "must be WxH, each side 1 to 16384".to_owned())
}

fn technique(text: &str) -> Result<Technique, String> {
    if text.starts_with("fitted") { Err(FITTED.to_owned()) } else { text.parse() }
}

fn metal(text: &str) -> Result<Rgb, String> {
    let channels: Vec<f32> = text.split(',').filter_map(|channel| channel.trim().parse().ok()).collect();
    match <Rgb>::try_from(channels) {
        Ok(rgb) if rgb.iter().all(|c| (0.0..=1.0).contains(c)) && text.matches(',').count() == 2 => Ok(rgb),
        _ => Err("must be three numbers between 0 and 1, as 0.95,0.93,0.88".to_owned()),
    }
}

impl ViewArgs {
    /// Checks that the screenshot `path` can be written and is none of `inputs`, and opens the adapter that
    /// draws it.
    pub(super) fn prepared<'a>(
        &self,
        path: &Path,
        inputs: impl Iterator<Item = &'a PathBuf>,
        console: &Console,
    ) -> Outcome<(Existing, Context)> {
        if path.as_os_str() != "-" {
            check_png("--screenshot", path)?;
        }
        check_not_input(path, inputs)?;
        let existing = check_output(path, self.force)?;
        let adapter = engine::any_adapter(self.adapter.as_deref())?;
        let context = block_on(None, Context::new(&adapter))??;
        console.note(&format!("adapter: {}", context.describe()));
        Ok((existing, context))
    }
}

impl LookArgs {
    /// Whether what only true reflections show is asked for.
    pub(super) fn has_finish(&self) -> bool {
        self.anisotropy.is_some() || self.clearcoat.is_some()
    }

    pub(super) fn look(&self) -> Look {
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
            finish: Finish {
                anisotropy: self.anisotropy.unwrap_or(look.finish.anisotropy),
                direction: self.direction.unwrap_or(look.finish.direction),
                clearcoat: self.clearcoat.unwrap_or(look.finish.clearcoat),
                coat_roughness: self.coat_roughness.unwrap_or(look.finish.coat_roughness),
            },
            paint: self.paint,
            tint: self.metal.unwrap_or(look.tint),
            roughness_factor: self.roughness.unwrap_or(look.roughness_factor),
            backdrop: self.backdrop,
            ground: self.ground,
            turn: self.turn,
            exposure: self.exposure,
            tone: self.tone,
            filter: self.filter.unwrap_or(if self.has_finish() { Technique::Reflect } else { look.filter }),
            show: self.show,
        }
    }
}

/// Options that a scene does not have: by their names in [`ViewArgs`] and what it contains.
const WITHOUT: [&str; 18] = [
    "inputs",
    "border",
    "scan",
    "object",
    "mesh",
    "mesh_root",
    "paint",
    "textured",
    "metal",
    "anisotropy",
    "direction",
    "clearcoat",
    "coat_roughness",
    "backdrop",
    "ground",
    "turn",
    "show",
    // The name that clap gives to the group of its options.
    "InputOptions",
];

/// Greatest --probes.
const PROBES: i64 = MAX_PROBES as i64;

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
    #[arg(long, value_name = "S", default_value_t = 0.0, requires = "scene")]
    #[arg(value_parser = within([0.0, 1e6]))]
    pub(super) scene_time: f64,
    /// Probes, 1 to 8 [default: one per glossy object]
    ///
    /// Each is at the centre of a glossy object. Objects without a probe blend all probes by distance.
    #[arg(long, value_name = "N", requires = "scene")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=PROBES))]
    pub(super) probes: Option<u32>,
    /// Milliseconds of a frame for the probes
    ///
    /// Updates as many as fit, in turns, and at least one. By default all are updated in every frame.
    /// Pictures by --screenshot have all up to date.
    #[arg(long, value_name = "MS", requires = "scene", conflicts_with = "screenshot")]
    #[arg(value_parser = within([0.0, MAX_BUDGET]))]
    pub(super) probe_budget: Option<f64>,
    /// Correction of parallax: none, box or sphere
    ///
    /// The shape around the still objects that reflections come from. box by default for the built-in scene,
    /// which is a room, and none for files.
    #[arg(long, value_name = "SHAPE", hide_possible_values = true, requires = "scene")]
    pub(super) proxy: Option<Proxy>,
    /// How the probes are drawn [default: octants]
    ///
    /// octants, clip-mask and strict-split draw into the octahedral map, exactly; xz-split, edge-strip and
    /// per-corner do so wrongly; cube and whole-cube draw six faces of as many texels and resample them.
    /// docs/direct.md explains them.
    #[arg(long, value_name = "METHOD", default_value = "octants", requires = "scene")]
    #[arg(hide_default_value = true, hide_possible_values = true)]
    pub(super) direct: Method,
}
