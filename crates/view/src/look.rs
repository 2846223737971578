//! Everything that the viewer's controls change.

pub mod camera;
pub mod legend;

use crate::look::camera::{Camera, FRONT, field_around};
use glam::{DVec2, DVec3};
use octagloss_core::common::error::{Result, wrong};
use octagloss_core::common::names::named;
use octagloss_core::files::image::exposure::{self, Exposure};
use octagloss_core::light::environment::Rgb;

/// The object under the environment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Object {
    /// One sphere.
    #[default]
    Sphere,
    /// Nine spheres of roughness 0 to 1.
    Row,
    /// A torus knot.
    Knot,
    /// A mesh from a file, which the command line names by itself.
    #[cfg_attr(feature = "cli", value(skip))]
    Mesh,
}

named!(Object { Sphere = "sphere", Row = "row", Knot = "knot", Mesh = "mesh" });

/// Technique of the reflections.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Technique {
    /// The single box of the octahedron environment maps paper.
    Box,
    /// The real-time tier.
    Pyramid,
    /// The real-time tier's true reflection, without a split sum.
    Reflect,
    /// A prefiltered cube chain, trilinear, as in engines.
    Levels,
    /// The certified tier, evaluated by the CPU for the visible pixels.
    Adaptive,
}

named!(Technique {
    Box = "box",
    Pyramid = "pyramid",
    Reflect = "reflect",
    Levels = "levels",
    Adaptive = "adaptive",
});

impl Technique {
    /// Shader file of the radiance of pixels.
    pub(super) const fn file(self) -> &'static str {
        match self {
            Self::Box => "view/box.wgsl",
            Self::Pyramid => "view/pyramid.wgsl",
            Self::Reflect => "view/reflect.wgsl",
            Self::Levels => "view/levels.wgsl",
            Self::Adaptive => "view/truth.wgsl",
        }
    }
}

/// Content of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Show {
    /// The scene.
    #[default]
    Scene,
    /// The octahedral map.
    Oem,
    /// Its SAT: the mean radiance of the box from the table's upper left corner to each texel.
    Sat,
    /// The filter's relative error against the certified tier, in false colour: that of lobes around the
    /// mirrored view, or of true reflections.
    Error,
}

impl Show {
    /// All contents with their names in the panel.
    pub(super) const ALL: [(Self, &'static str); 4] = [
        (Self::Scene, "scene"),
        (Self::Oem, "octahedral map"),
        (Self::Sat, "summed-area table"),
        (Self::Error, "error"),
    ];
}

/// Tone mapping from radiance to display, in the order of the shader's numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Tone {
    /// The PBR Neutral tone mapper of the Khronos Group (2024), which preserves colours.
    #[default]
    Neutral,
    /// Narkowicz's fit of the ACES reference transform (2015).
    Aces,
    /// Reinhard et al. 2002, equation 3, per channel.
    Reinhard,
    /// Clamp to 1.
    Linear,
}

named!(Tone { Neutral = "neutral", Aces = "aces", Reinhard = "reinhard", Linear = "linear" });

/// Material of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Paint {
    /// The file's materials, times [`Look::tint`] and [`Look::roughness_factor`]; plain if the file has none.
    #[default]
    File,
    /// A metal of [`Look::metal`] and [`Look::roughness`], like the other objects.
    Plain,
}

named!(Paint { File = "file", Plain = "plain" });

/// What is below spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Ground {
    /// A plane that shows the environment, in the spheres' shadow: they hide a part of an even sky.
    #[default]
    Shadow,
    /// Nothing.
    None,
}

/// Pixels across a picture's height up to which an automatic backdrop shows the environment's texels.
const BACKDROP_PIXELS: f64 = 720.0;

/// Width of the automatic backdrop's lobe, as the square of its roughness, per texel.
const BACKDROP_TEXELS: f64 = 1.2;

/// What a surface is besides rough; `reflect` alone shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finish {
    /// Anisotropy in \[0, 1\], of KHR_materials_anisotropy.
    pub anisotropy: f64,
    /// Direction of the brushing in degrees, counterclockwise: on spheres from the parallels, on meshes from
    /// u.
    pub direction: f64,
    /// Share of a clear coat in \[0, 1\], of KHR_materials_clearcoat.
    pub clearcoat: f64,
    /// Roughness of the coat in \[0, 1\].
    pub coat_roughness: f64,
}

impl Finish {
    /// Neither brushed nor coated. A coat is nearly smooth.
    pub const NONE: Self = Self { anisotropy: 0.0, direction: 0.0, clearcoat: 0.0, coat_roughness: 0.05 };
}

/// Description of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// The object.
    pub object: Object,
    /// The camera.
    pub camera: Camera,
    /// Perceptual roughness in \[0, 1\]; a row of spheres has its own.
    pub roughness: f64,
    /// Whether a map modulates the roughness of plain surfaces.
    pub textured: bool,
    /// Reflectance of plain metals at normal incidence, linear.
    pub metal: Rgb,
    /// Finish of plain surfaces.
    pub finish: Finish,
    /// Material of the mesh.
    pub paint: Paint,
    /// Factor of the base colours of a mesh's own materials, linear.
    pub tint: Rgb,
    /// Factor of the roughness of a mesh's own materials.
    pub roughness_factor: f64,
    /// Roughness of the lobe for the backdrop, in \[0, 1\]. `None` blurs a coarse environment just enough to
    /// hide its texels.
    pub backdrop: Option<f64>,
    /// What is below spheres.
    pub ground: Ground,
    /// Rotation of the environment about +Y in degrees.
    pub turn: f64,
    /// Exposure of the picture.
    pub exposure: Exposure,
    /// Tone mapping.
    pub tone: Tone,
    /// Technique of the reflections.
    pub filter: Technique,
    /// Content of the picture.
    pub show: Show,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            object: Object::default(),
            camera: Camera::default(),
            roughness: 0.2,
            textured: false,
            metal: [0.95, 0.93, 0.88],
            finish: Finish::NONE,
            paint: Paint::default(),
            tint: [1.0; 3],
            roughness_factor: 1.0,
            backdrop: None,
            ground: Ground::default(),
            turn: 0.0,
            exposure: Exposure::default(),
            tone: Tone::default(),
            filter: Technique::Pyramid,
            show: Show::default(),
        }
    }
}

/// Spheres in a row.
pub(super) const ROW: u32 = 9;

/// A sphere of the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub(super) centre: DVec3,
    pub(super) radius: f64,
    pub(super) roughness: f64,
}

impl Look {
    /// Checks that every value is in its range.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] naming the value and its range.
    pub fn check(&self) -> Result<()> {
        let Self { camera, metal: [red, green, blue], tint, finish, .. } = self;
        let within = [
            ("roughness", self.roughness, 0.0, 1.0),
            ("backdrop roughness", self.backdrop.unwrap_or(0.0), 0.0, 1.0),
            ("roughness factor", self.roughness_factor, 0.0, 1.0),
            ("exposure", self.exposure.ev(0.0), *exposure::RANGE.start(), *exposure::RANGE.end()),
            ("turn", self.turn, -1e6, 1e6),
            ("yaw", camera.yaw, -1e6, 1e6),
            ("pitch", camera.pitch, -std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2),
            ("distance", camera.distance, 1.05, 1e3),
            ("angle of view", camera.angle.unwrap_or(1.0), 0.01, 3.0),
            ("anisotropy", finish.anisotropy, 0.0, 1.0),
            ("direction of anisotropy", finish.direction, -1e6, 1e6),
            ("clear coat", finish.clearcoat, 0.0, 1.0),
            ("roughness of the clear coat", finish.coat_roughness, 0.0, 1.0),
            ("red reflectance", f64::from(*red), 0.0, 1.0),
            ("green reflectance", f64::from(*green), 0.0, 1.0),
            ("blue reflectance", f64::from(*blue), 0.0, 1.0),
            ("red tint", f64::from(tint[0]), 0.0, 1.0),
            ("green tint", f64::from(tint[1]), 0.0, 1.0),
            ("blue tint", f64::from(tint[2]), 0.0, 1.0),
        ];
        for (name, value, least, most) in within {
            if !(least..=most).contains(&value) {
                return wrong(format!("{name} {value} is outside [{least}, {most}]"));
            }
        }
        Ok(())
    }

    /// The initial camera: faces the front of a mesh, otherwise the centre of a panorama.
    pub fn first_camera(&self) -> Camera {
        let yaw = if self.object == Object::Mesh { FRONT } else { 0.0 };
        Camera { yaw, ..Camera::default() }
    }

    /// Whether the materials of a mesh's file are shown, if it has any.
    pub(crate) fn shows_materials(&self) -> bool {
        self.object == Object::Mesh && self.paint == Paint::File
    }

    /// Whether the picture needs the certified tier.
    pub fn needs_truth(&self) -> bool {
        self.show == Show::Error || (self.show == Show::Scene && self.filter == Technique::Adaptive)
    }

    /// Whether errors are those of true reflections.
    pub(super) fn judges_reflections(&self) -> bool {
        self.show == Show::Error && self.filter == Technique::Reflect
    }

    /// The relRMSE of the certified tier in the picture: for pictures a fifth of the bake default, well below
    /// the visible threshold; for errors of lobes the least value with a distinct colour; for those of true
    /// reflections, which cost more, ten times that. Their errors are hundredths of it.
    pub(super) fn tolerance(&self) -> f64 {
        if self.show == Show::Error && !self.judges_reflections() { 1e-4 } else { 1e-3 }
    }

    /// Whether the picture reads a summed-area table.
    pub const fn reads_sat(&self) -> bool {
        matches!(self.show, Show::Oem | Show::Sat) || matches!(self.filter, Technique::Box)
    }

    /// Whether the picture follows a moving lamp, through tables rebuilt every frame.
    pub(super) const fn follows_lamp(&self) -> bool {
        match self.show {
            Show::Scene => matches!(self.filter, Technique::Box | Technique::Pyramid | Technique::Reflect),
            Show::Oem | Show::Sat => true,
            Show::Error => false,
        }
    }

    /// Half the width and the height at distance 1 that a picture shows, at least, if the camera has no
    /// angle.
    pub fn field(&self) -> DVec2 {
        let mut spheres: Vec<_> = self.balls().iter().map(|ball| (ball.centre, ball.radius)).collect();
        if spheres.is_empty() {
            // Meshes are scaled to the unit sphere.
            spheres.push((DVec3::ZERO, 1.0));
        }
        field_around(spheres)
    }

    /// Roughness of the backdrop's lobe for texels of the angle `texel` in a picture of half the height
    /// `half_height` at distance 1. An automatic one adds to a pixel what it lacks to a texel's width, so
    /// that fine environments stay sharp; it is the same for every size of the picture.
    pub fn backdrop_roughness(&self, texel: f64, half_height: f64) -> f64 {
        let pixel = 2.0 * half_height / BACKDROP_PIXELS;
        let automatic =
            || (BACKDROP_TEXELS * (texel.powi(2) - pixel.powi(2)).max(0.0).sqrt()).sqrt().min(1.0);
        self.backdrop.unwrap_or_else(automatic)
    }

    /// Height of the ground below the spheres, if there is one.
    pub(super) fn floor(&self) -> Option<f64> {
        let lowest = self.balls().iter().map(|ball| ball.centre.y - ball.radius).reduce(f64::min);
        lowest.filter(|_| self.ground == Ground::Shadow)
    }

    /// The visible spheres.
    pub(super) fn balls(&self) -> Vec<Ball> {
        match self.object {
            Object::Sphere => vec![Ball { centre: DVec3::ZERO, radius: 1.0, roughness: self.roughness }],
            Object::Row => (0..ROW)
                .map(|k| {
                    let along = f64::from(k) / f64::from(ROW - 1);
                    // To the right of the default camera.
                    Ball {
                        centre: DVec3::new(0.0, 0.0, (2.0 * along - 1.0) * 1.7),
                        radius: 0.2,
                        roughness: along,
                    }
                })
                .collect(),
            Object::Knot | Object::Mesh => Vec::new(),
        }
    }
}
