//! Targets: presets of bakes for engines, and their files.
//!
//! A [`Target`] is a row of [`TARGETS`]; a [`TargetPlan`] is a row with overrides.
//! [`crate::files::export::files`] encodes its files from a bake.

mod flip;
pub use flip::{Flip, flipped, flipped_texels};

use crate::common::error::{Result, wrong};
use crate::common::names::named;
use crate::files::export::gltf::EXTENSION;
use crate::files::format::container::Container;
use crate::files::format::{LevelName, OutputLayout, Pixel, Shown};
use crate::files::io::pyramid_write;
use crate::light::chain::ChainKind;
use crate::light::environment::Map;
use crate::light::sh::scale::ShScale;
use crate::lobe::Lobe;
use crate::lobe::ladder::{Ladder, UNITY_LEVELS};
use crate::pyramid::SMALLEST;
use crate::sphere::cube::Face;

/// Content of a target's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// The prefiltered levels.
    Specular,
    /// The unfiltered environment: level 0, or a cube of its own.
    Skybox,
    /// The unfiltered environment as a panorama.
    SkyboxPanorama,
    /// The levels of the Charlie lobe.
    Sheen,
    /// The irradiance cube, over pi: the radiance of a white diffuse surface.
    Irradiance,
    /// Spherical harmonics as JSON.
    ShJson,
    /// Spherical harmonics as text in cmgen's format.
    ShText,
    /// Octahedral levels with their borders.
    Oem,
    /// The maps of a pyramid.
    Pyramid,
    /// The same on one cube.
    PyramidCube,
    /// Its suns, harmonics and scale as JSON.
    PyramidLight,
    /// The tables of pyramids of its size.
    PyramidTables,
    /// Those of pyramids on cubes.
    PyramidCubeTables,
    /// The reader of `octagloss_shaders` named by its path.
    Reader,
    /// Level 0 as one image; the path's extension selects the format.
    Panorama,
    /// Levels and harmonics in Babylon.js's own container.
    Env,
    /// Levels and harmonics as a glTF light.
    Glb,
    /// Levels and irradiance in PlayCanvas's atlas.
    Atlas,
    /// The levels as a lat-long MIP map.
    Mips,
    /// One image of a level.
    Image(LevelName),
}

/// Levels of PlayCanvas's atlas.
pub(crate) const ATLAS_LEVELS: u32 = 6;

/// A file of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileSpec {
    /// Path in the target's folder; `{name}` is the environment's name and `{ext}` the container's extension.
    pub path: &'static str,
    /// Its content.
    pub content: Content,
}

/// Forms of diffuse light to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Diffuse {
    /// None, or included in the specular levels.
    None,
    /// A cube of irradiance over pi.
    Cube,
    /// Spherical harmonics.
    Sh,
    /// Both.
    Both,
}

named!(Diffuse { None = "none", Cube = "cube", Sh = "sh", Both = "both" });

impl Diffuse {
    pub(crate) const fn has_cube(self) -> bool {
        matches!(self, Self::Cube | Self::Both)
    }

    pub(crate) const fn has_sh(self) -> bool {
        matches!(self, Self::Sh | Self::Both)
    }
}

/// The map of a pyramid's levels in its file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum PyramidMap {
    /// An array of bordered squares.
    #[default]
    Octahedral,
    /// One cube with MIP levels.
    Cube,
}

named!(PyramidMap { Octahedral = "octahedral", Cube = "cube" });

/// Preset for an engine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Name on the command line.
    pub name: &'static str,
    /// The engine or format that reads it.
    pub reader: &'static str,
    /// The container of its cubes.
    pub container: Container,
    /// Their pixels.
    pub pixel: Pixel,
    /// Map of its levels' texels.
    pub map: Map,
    /// Edge of level 0; for a panorama its height.
    pub size: u32,
    /// Edge of the last level; `None` for [`Ladder::default_levels`].
    pub last_size: Option<u32>,
    /// Roughness of the levels.
    pub ladder: Ladder,
    /// Content of the levels' texels; `None` for that of a bake without a target.
    pub chain: Option<ChainKind>,
    /// Flip of its cube look-ups.
    pub flip: Flip,
    /// Right shift of its panoramas' columns relative to ours, in quarters of the width.
    pub quarter_turns: u32,
    /// Its diffuse light.
    pub diffuse: Diffuse,
    /// Edge of the irradiance cube, if any.
    pub irradiance_size: u32,
    /// Scaling of its spherical harmonics.
    pub sh_scale: ShScale,
    /// Whether it writes its skybox by default.
    pub has_skybox: bool,
    /// Its files, except report.json.
    pub files: &'static [FileSpec],
    /// The engine and version that loads it in a test; `None` if untested.
    pub verified: Option<&'static str>,
}

use Content::{
    Atlas, Env, Glb, Image, Irradiance, Mips, Oem, Panorama, PyramidCubeTables, PyramidLight, PyramidTables,
    Reader, ShJson, ShText, Sheen, Skybox, SkyboxPanorama, Specular,
};

/// This program's own conventions, the base of the other rows.
const GENERIC: Target = Target {
    name: "generic",
    reader: "this program's own conventions",
    container: Container::Ktx2,
    pixel: Pixel::F16,
    map: Map::Cube,
    size: Ladder::Linear.default_size(Map::Cube, Lobe::Ggx),
    last_size: None,
    ladder: Ladder::Linear,
    chain: None,
    flip: Flip::None,
    quarter_turns: 0,
    diffuse: Diffuse::None,
    irradiance_size: 32,
    sh_scale: ShScale::Radiance,
    has_skybox: false,
    files: &[
        FileSpec { path: "specular.{ext}", content: Specular },
        FileSpec { path: "irradiance.{ext}", content: Irradiance },
        FileSpec { path: "skybox.{ext}", content: Skybox },
        FileSpec { path: "sh.json", content: ShJson },
    ],
    verified: Some("this program"),
};

/// A bake without a target: `{name}` is the output's name with its extension, `{stem}` without it.
pub const UNTARGETED: Target = Target {
    name: "",
    files: &[
        FileSpec { path: "{name}", content: Specular },
        FileSpec { path: "{stem}.irradiance.{ext}", content: Irradiance },
        FileSpec { path: "{stem}.skybox.{ext}", content: Skybox },
    ],
    ..GENERIC
};

/// Base of the engines' rows: the default size of their own bakers, all levels down to one texel, and lobes
/// as texels.
const ENGINE: Target = Target { size: 256, last_size: Some(1), chain: Some(ChainKind::Sampled), ..GENERIC };

/// Base of engines that filter a panorama themselves.
const SKY: Target = Target {
    pixel: Pixel::F32,
    map: Map::Panorama,
    size: 1024,
    last_size: Some(1024),
    files: &[
        FileSpec { path: "{name}_panorama.exr", content: Panorama },
        FileSpec { path: "{name}_skybox.exr", content: SkyboxPanorama },
    ],
    ..ENGINE
};

/// The files of a pyramid whose maps are `maps`, with its `tables` and `readers`.
const fn pyramid_files(maps: Content, tables: FileSpec, readers: [&'static str; 4]) -> [FileSpec; 8] {
    let [wgsl, glsl, hlsl, metal] = readers;
    [
        FileSpec { path: "{name}_pyramid.{ext}", content: maps },
        FileSpec { path: "{name}_pyramid.json", content: PyramidLight },
        tables,
        FileSpec { path: wgsl, content: Reader },
        FileSpec { path: glsl, content: Reader },
        FileSpec { path: hlsl, content: Reader },
        FileSpec { path: metal, content: Reader },
        FileSpec { path: "{name}_skybox.{ext}", content: Skybox },
    ]
}

/// See io/pyramid_write.rs. Its levels are those of the octahedral map that it is made of.
const PYRAMID: Target = Target {
    name: "pyramid",
    reader: "the real-time look-ups in any renderer's shaders",
    map: Map::Octahedral,
    size: 512,
    last_size: Some(32),
    files: &pyramid_files(
        Content::Pyramid,
        FileSpec { path: "pyramid_tables.ktx2", content: PyramidTables },
        ["pyramid.wgsl", "pyramid.glsl", "pyramid.hlsl", "pyramid.metal"],
    ),
    verified: Some("its own readers"),
    ..ENGINE
};

/// The same with [`PyramidMap::Cube`].
const PYRAMID_ON_CUBE: Target = Target {
    files: &pyramid_files(
        Content::PyramidCube,
        FileSpec { path: "pyramid_cube_tables.ktx2", content: PyramidCubeTables },
        ["pyramid_cube.wgsl", "pyramid_cube.glsl", "pyramid_cube.hlsl", "pyramid_cube.metal"],
    ),
    ..PYRAMID
};

/// The presets.
pub const TARGETS: [Target; 14] = [
    GENERIC,
    // Cube textures are looked up with x negated unless they are render targets (WebGLMaterials.js); a
    // prefiltered cube runs down to 8 texels and its last level is the irradiance (PMREMGenerator.js,
    // LOD_MIN, and envmap_physical_pars_fragment.glsl.js); LightProbe takes radiance coefficients.
    Target {
        name: "three",
        reader: "three.js from r187, as a PMREM",
        last_size: Some(8),
        ladder: Ladder::Filament,
        flip: Flip::X,
        diffuse: Diffuse::Sh,
        files: &[
            FileSpec { path: "{name}_pmrem.{ext}", content: Specular },
            FileSpec { path: "{name}_irradiance.{ext}", content: Irradiance },
            FileSpec { path: "{name}_skybox.{ext}", content: Skybox },
            FileSpec { path: "{name}_sh.json", content: ShJson },
        ],
        verified: Some("three 0.187"),
        ..ENGINE
    },
    // Names, formats and the key `sh` as in cmgen --deploy --format=ktx (tools/cmgen/src/cmgen.cpp).
    Target {
        name: "filament",
        reader: "Filament's IndirectLight and Skybox",
        container: Container::Ktx1,
        pixel: Pixel::R11g11b10,
        last_size: Some(16),
        ladder: Ladder::Filament,
        diffuse: Diffuse::Sh,
        sh_scale: ShScale::Filament,
        has_skybox: true,
        files: &[
            FileSpec { path: "{name}_ibl.{ext}", content: Specular },
            FileSpec { path: "{name}_skybox.{ext}", content: Skybox },
            FileSpec { path: "{name}_irradiance.{ext}", content: Irradiance },
            FileSpec { path: "sh.txt", content: ShText },
        ],
        verified: Some("filament 1.53 (npm)"),
        ..ENGINE
    },
    // z is negated at every look-up, roughness runs linearly over as many levels as there are, and the
    // diffuse cube is multiplied by the diffuse colour alone
    // (crates/bevy_pbr/src/light_probe/environment_map.wgsl). At roughness 1, errors in its pictures are
    // below 1 % with four texels per side and 5 % with one.
    Target {
        name: "bevy",
        reader: "Bevy's EnvironmentMapLight",
        pixel: Pixel::Rgb9e5,
        last_size: Some(4),
        flip: Flip::Z,
        diffuse: Diffuse::Cube,
        files: &[
            FileSpec { path: "{name}_specular.{ext}", content: Specular },
            FileSpec { path: "{name}_diffuse.{ext}", content: Irradiance },
            FileSpec { path: "{name}_skybox.{ext}", content: Skybox },
            FileSpec { path: "{name}_sh.json", content: ShJson },
        ],
        verified: Some("bevy 0.19"),
        ..ENGINE
    },
    // floor(log2(size)) levels, half floats, unflipped directions (lib/source/lib.cpp and
    // lib/shaders/filter.frag); folders as in glTF-Sample-Environments.
    Target {
        name: "khronos",
        reader: "readers of the glTF IBL Sampler's files",
        last_size: Some(2),
        diffuse: Diffuse::Cube,
        irradiance_size: 64,
        sh_scale: ShScale::Irradiance,
        files: &[
            FileSpec { path: "ggx/specular.{ext}", content: Specular },
            FileSpec { path: "charlie/sheen.{ext}", content: Sheen },
            FileSpec { path: "lambertian/diffuse.{ext}", content: Irradiance },
            FileSpec { path: "skybox.{ext}", content: Skybox },
            FileSpec { path: "sh.json", content: ShJson },
        ],
        verified: Some("glTF Sample Renderer 1.1 (npm)"),
        ..ENGINE
    },
    // The border is this program's convention, recorded in the files' metadata.
    Target {
        name: "oem",
        reader: "readers of bordered octahedral maps",
        map: Map::Octahedral,
        size: 512,
        last_size: Some(16),
        files: &[
            FileSpec { path: "{name}_oem.{ext}", content: Oem },
            FileSpec { path: "oem.wgsl", content: Reader },
            FileSpec { path: "oem.glsl", content: Reader },
            FileSpec { path: "oem.hlsl", content: Reader },
            FileSpec { path: "{name}_irradiance.{ext}", content: Irradiance },
            FileSpec { path: "{name}_skybox.{ext}", content: Skybox },
            FileSpec { path: "{name}_sh.json", content: ShJson },
        ],
        verified: Some("its own readers"),
        ..ENGINE
    },
    PYRAMID,
    // alpha = 2^(level/0.8)/size (Materials/Textures/Filtering/hdrFiltering.ts); scenes are left-handed, and
    // glTF is imported with x negated (loaders/src/glTF/2.0/glTFLoader.ts, __root__).
    Target {
        name: "babylon",
        reader: "Babylon.js's CubeTexture, left-handed scenes",
        pixel: Pixel::Rgbd,
        ladder: Ladder::Babylon,
        flip: Flip::X,
        // The container has all levels or none.
        files: &[
            FileSpec { path: "{name}_ibl.env", content: Env },
            FileSpec { path: "{name}_skybox.dds", content: Skybox },
        ],
        verified: Some("babylonjs 9.34"),
        ..ENGINE
    },
    // See playcanvas.rs. x is negated before look-ups of the atlas (lit/frag/reflectionEnv.js, ambient.js)
    // and of a cube (skybox/frag/skybox.js).
    Target {
        name: "playcanvas",
        reader: "PlayCanvas's environment atlas",
        pixel: Pixel::Rgbp,
        flip: Flip::X,
        diffuse: Diffuse::Cube,
        files: &[
            FileSpec { path: "{name}_envatlas.png", content: Atlas },
            FileSpec { path: "{name}_skybox.dds", content: Skybox },
        ],
        verified: Some("playcanvas 2.23"),
        ..ENGINE
    },
    // See gltf.rs.
    Target {
        name: "gltf-ext",
        reader: "glTF with EXT_lights_image_based",
        pixel: Pixel::Rgbd,
        last_size: Some(16),
        flip: Flip::X,
        sh_scale: ShScale::Irradiance,
        files: &[
            FileSpec { path: "{name}_ibl.glb", content: Glb },
            FileSpec { path: "{name}_skybox.ktx2", content: Skybox },
        ],
        verified: Some("babylonjs 9.34 and a reader of its text"),
        ..ENGINE
    },
    // Six steps of r (1.7 - 0.7 r), whatever the size (ImageBasedLighting.hlsl,
    // PerceptualRoughnessToMipmapLevel, UNITY_SPECCUBE_LOD_STEPS); left-handed, glTF is imported with x
    // negated (glTFast). A cube imported with Convolution Type None keeps its own levels.
    Target {
        name: "unity",
        reader: "Unity's cubemap import, Convolution Type None",
        container: Container::Dds,
        last_size: None,
        ladder: Ladder::Unity,
        flip: Flip::X,
        files: &[
            FileSpec { path: "{name}_specular.{ext}", content: Specular },
            FileSpec { path: "{name}_irradiance.{ext}", content: Irradiance },
            FileSpec { path: "{name}_skybox.{ext}", content: Skybox },
            FileSpec { path: "{name}_sh.json", content: ShJson },
        ],
        verified: None,
        ..ENGINE
    },
    // u = (1 + atan2(X, -Z)/pi)/2 with y and z swapped (TextureCompressorModule.cpp, LookupLongLat and
    // TransformSideToWorldSpace); glTF's (x, y, z) is imported as (x, z, y). The engine filters itself.
    Target {
        name: "unreal",
        reader: "Unreal's sky light, from a long-lat cube",
        quarter_turns: 1,
        files: &[
            FileSpec { path: "{name}_panorama.hdr", content: Panorama },
            FileSpec { path: "{name}_skybox.hdr", content: SkyboxPanorama },
        ],
        verified: None,
        ..SKY
    },
    // u = atan(x, -z)/2 pi (servers/rendering/renderer_rd/shaders/environment/sky.glsl). The engine filters
    // itself.
    Target {
        name: "godot",
        reader: "Godot's PanoramaSkyMaterial",
        quarter_turns: 3,
        verified: Some("Godot 3.2"),
        ..SKY
    },
    // u = 1/2 - atan2(y, x)/2 pi (intern/cycles/kernel/camera/projection.h); glTF's (x, y, z) is imported as
    // (x, -z, y).
    Target {
        name: "blender",
        reader: "Blender's environment texture",
        verified: Some("Blender 5.0 (bpy)"),
        ..SKY
    },
];

impl Target {
    /// The target called `name`.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        TARGETS.iter().find(|target| target.name == name)
    }

    /// Levels from `size` down to the target's last, and at least two if the size has as many: readers look
    /// roughness up between them.
    #[must_use]
    pub fn levels(&self, size: u32) -> u32 {
        if self.has_atlas() {
            return ATLAS_LEVELS;
        }
        match self.last_size {
            None => self.ladder.default_levels(self.map, size).max(1),
            Some(last) => {
                let levels = size.checked_ilog2().unwrap_or(0).saturating_sub(last.ilog2()) + 1;
                if self.map == Map::Panorama { levels } else { levels.max(2).min(self.map.most_levels(size)) }
            }
        }
    }

    /// Checks that the reader's own formula maps every roughness to one of `levels` levels of `ladder`.
    fn check_look_ups(&self, levels: u32, ladder: Ladder) -> Result<()> {
        // This program reads the ladder from the file or the report.
        if self.name == GENERIC.name {
            return Ok(());
        }
        if ladder != self.ladder {
            let (own, other) = (self.ladder.name(), ladder.name());
            return wrong(format!("its reader looks levels up by the ladder {own}; omit `ladder` {other}"));
        }
        if ladder == Ladder::Unity && levels != UNITY_LEVELS {
            return wrong(format!(
                "its reader looks up six steps below level 0 at every size: {UNITY_LEVELS} levels, not \
                 {levels}; choose a `size` of at least 64 and omit `levels`"
            ));
        }
        if self.map != Map::Panorama && levels < 2 {
            return wrong(
                "its reader looks roughness up between levels, and one level is a mirror; choose a greater \
                 `size`, or `levels` of at least 2",
            );
        }
        Ok(())
    }

    /// Content of its file at `path`, relative to its folder; `None` if it has no such file.
    #[must_use]
    pub fn content_of(&self, path: &str) -> Option<Content> {
        let matches = |pattern: &str| {
            let Some((before, after)) = pattern.split_once("{name}") else { return path == pattern };
            path.strip_prefix(before)
                .and_then(|rest| rest.strip_suffix(after))
                .is_some_and(|name| !name.is_empty())
        };
        let is_at = |file: &&FileSpec| {
            Container::ALL.iter().any(|container| matches(&file.path.replace("{ext}", container.name())))
        };
        self.files.iter().find(is_at).map(|file| file.content)
    }

    /// Whether it has a cube of the Charlie lobe.
    #[must_use]
    pub fn has_sheen(&self) -> bool {
        self.files.iter().any(|file| file.content == Sheen)
    }

    /// Whether its levels are a pyramid, which holds every roughness and the irradiance.
    #[must_use]
    pub fn has_pyramid(&self) -> bool {
        self.files.iter().any(|file| file.content == PyramidLight)
    }

    /// This preset with a pyramid on `map`.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] if it has no pyramid.
    pub(crate) fn on(&'static self, map: PyramidMap) -> Result<&'static Self> {
        match map {
            _ if !self.has_pyramid() => {
                wrong(format!("target {} has no pyramid; omit `map` {map}, or bake it apart", self.name))
            }
            PyramidMap::Octahedral => Ok(self),
            PyramidMap::Cube => Ok(&PYRAMID_ON_CUBE),
        }
    }

    /// Whether its levels are in an atlas.
    #[must_use]
    pub fn has_atlas(&self) -> bool {
        self.files.iter().any(|file| file.content == Atlas)
    }

    /// Whether the container and pixel format of its files can be chosen.
    #[must_use]
    pub fn has_container(&self) -> bool {
        self.files.iter().any(|file| file.path.contains("{ext}"))
    }
}

/// A target with all options resolved.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetPlan {
    /// The preset.
    pub target: &'static Target,
    /// The container of its cubes.
    pub container: Container,
    /// Their pixels.
    pub pixel: Pixel,
    /// Flip of its cubes.
    pub flip: Flip,
    /// Its diffuse light.
    pub diffuse: Diffuse,
    /// Layout of its cubes in files. Targets write whole cubes: [`OutputLayout::Parts`].
    pub layout: OutputLayout,
    /// Whether the unfiltered environment is written as well.
    pub skybox: bool,
}

impl TargetPlan {
    /// The plan of `target` without overrides.
    #[must_use]
    pub const fn new(target: &'static Target) -> Self {
        let Target { container, pixel, flip, diffuse, .. } = *target;
        let skybox = target.has_skybox;
        Self { target, container, pixel, flip, diffuse, layout: OutputLayout::Parts, skybox }
    }

    /// Checks that the container can hold the pixel format.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] if it cannot.
    pub fn check(&self) -> Result<()> {
        // Images use floats if half floats are insufficient.
        let is_chosen_later = self.pixel == Pixel::Auto && !self.is_single();
        if !self.target.has_container() || is_chosen_later || self.container.holds(self.pixel) {
            return Ok(());
        }
        let target =
            if self.is_targeted() { format!("target {}: ", self.target.name) } else { String::new() };
        wrong(format!(
            "{target}{} files cannot hold {}; use another `pixel` or `format`",
            self.container.name(),
            self.pixel.name()
        ))
    }

    /// Checks that the files can hold `levels` levels of `ladder` from `size` down, and that the reader finds
    /// every roughness among them.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] if not.
    pub fn check_levels(&self, size: u32, levels: u32, ladder: Ladder) -> Result<()> {
        self.target.check_look_ups(levels, ladder)?;
        self.check_sizes(size, levels)
    }

    /// Checks that the files can hold `levels` levels from `size` down.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] if not.
    pub(crate) fn check_sizes(&self, size: u32, levels: u32) -> Result<()> {
        let is_power = size.is_power_of_two();
        self.target.files.iter().try_for_each(|file| match file.content {
            Oem => crate::light::oem::level_sizes(size, levels).map(drop),
            Env if !is_power || levels != size.ilog2() + 1 => wrong(format!(
                "an .env needs a `size` that is a power of two and all its levels down to 1; {size} with \
                 {levels} levels is not"
            )),
            Glb if !is_power => {
                wrong(format!("{EXTENSION} needs a `size` that is a power of two; {size} is not"))
            }
            Atlas if !is_power || size < 1 << (ATLAS_LEVELS - 1) || levels != ATLAS_LEVELS => wrong(format!(
                "an atlas needs a `size` that is a power of two from 32, and {ATLAS_LEVELS} levels; {size} \
                 with {levels} levels is not"
            )),
            PyramidLight => {
                pyramid_write::check_size(size)?;
                // A plan counts the octaves of its map.
                if levels == size.ilog2() + 1 - SMALLEST.ilog2() {
                    return Ok(());
                }
                wrong(format!("a pyramid has levels of its own, not {levels}; omit `levels`"))
            }
            _ => Ok(()),
        })
    }

    /// Whether this is the plan of a target.
    #[must_use]
    pub const fn is_targeted(&self) -> bool {
        !self.target.name.is_empty()
    }

    /// Whether each cube is one file, and not a folder of images.
    #[must_use]
    pub const fn is_single(&self) -> bool {
        self.container.is_single() || matches!(self.layout, OutputLayout::Parts | OutputLayout::Mips)
    }

    /// The files to write, with their paths in the output's folder, for `levels` levels of the environment
    /// called `name`, without a target of the output called so; with the bounds of the levels `bounded`.
    #[must_use]
    pub fn files(&self, name: &str, levels: u32, bounded: &[u32]) -> Vec<(String, Content)> {
        let extension = self.container.name();
        let stem = name.rsplit_once('.').map_or(name, |(stem, _)| if stem.is_empty() { name } else { stem });
        let path = |file: &FileSpec| {
            file.path.replace("{name}", name).replace("{stem}", stem).replace("{ext}", extension)
        };
        let image = |name: LevelName| (format!("{name}.{extension}"), Image(name));
        let images = |shown: Shown| -> Vec<(String, Content)> {
            let name = LevelName { shown, face: None, is_bound: false };
            match self.layout {
                OutputLayout::Faces => {
                    Face::ALL.map(|face| image(LevelName { face: Some(face), ..name })).to_vec()
                }
                _ => vec![image(name)],
            }
        };
        let of = |file: &FileSpec| match file.content {
            Irradiance if !self.diffuse.has_cube() => Vec::new(),
            ShJson | ShText if !self.diffuse.has_sh() => Vec::new(),
            Skybox | SkyboxPanorama if !self.skybox => Vec::new(),
            Specular if self.layout == OutputLayout::Mips => vec![(path(file), Mips)],
            Specular if !self.is_single() => (0..levels).flat_map(|k| images(Shown::Level(k))).collect(),
            Irradiance if !self.is_single() => images(Shown::Irradiance),
            Skybox if !self.is_single() => images(Shown::Skybox),
            content => vec![(path(file), content)],
        };
        let folder = if self.is_single() { format!("{name}.bounds/") } else { String::new() };
        let bounds = bounded.iter().flat_map(|level| Face::ALL.map(|face| LevelName::face(*level, face)));
        let bounds = bounds.map(|name| LevelName { is_bound: true, ..name });
        let bounds = bounds.map(|name| (format!("{folder}{name}.exr"), Image(name)));
        self.target.files.iter().flat_map(of).chain(bounds).collect()
    }
}

/// Whether a bake for some target writes a file at `path`, relative to its folder.
pub fn is_target_file(path: &str) -> bool {
    let is_shared = ["report.json", "sun.json"].contains(&path);
    let mut targets = TARGETS.iter().chain([&PYRAMID_ON_CUBE]);
    is_shared || targets.any(|target| target.content_of(path).is_some())
}
