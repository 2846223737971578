//! Every option of a bake, as one value: front ends parse into it, reports embed it, files carry it.

#[cfg(feature = "cli")]
mod help;
pub mod plan;
pub mod source;
pub mod text;

use crate::analysis::extraction::Suns;
use crate::bake::Skybox;
use crate::common::error::{Result, wrong};
use crate::cpu::reflector::ReflectorSettings;
use crate::files::format::container::Container;
use crate::files::format::overflow::Overflow;
use crate::files::format::{OutputLayout, Pixel};
use crate::files::image::exposure::Exposure;
use crate::files::io::{InputLayout, Pad, ReadOptions};
use crate::files::target::{Diffuse, Flip, PyramidMap, Target};
use crate::light::chain::ChainKind;
use crate::light::environment::MAX_DEGREES;
use crate::light::sat::Scan;
use crate::light::sh::MAX_ORDER;
use crate::light::sh::window::ShWindow;
use crate::lobe::Lobe;
use crate::lobe::filter::Filter;
use crate::lobe::ladder::Ladder;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Maximum edge of a cube or an octahedral map, in texels.
const MAX_SIZE: u32 = 16_384;

/// Every option of a bake; `None` for the default, which the target or the source decides. The comments are
/// the help of the command line.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Recipe {
    /// Presets for engines, comma-separated
    ///
    /// Explicit options override the preset. OUT is a folder with the target's files and report.json, one
    /// subfolder per target for several. All targets share one octahedral map.
    #[cfg_attr(feature = "cli", arg(long, value_name = "TARGET", value_delimiter = ','))]
    #[cfg_attr(feature = "cli", arg(value_parser = text::target))]
    #[cfg_attr(feature = "cli", arg(long_help = help::targets()))]
    #[serde(with = "text::targets")]
    pub target: Vec<&'static Target>,
    /// Edge of level 0, 1 to 16384 [default: ladder's]
    ///
    /// By default 640 for the linear ladder of ggx (panoramas 1280 rows, octahedral squares 1920); trilinear
    /// look-ups then have errors of a few percent from roughness 0.6 up. Otherwise 256.
    #[cfg_attr(feature = "cli", arg(long, value_name = "N"))]
    pub size: Option<u32>,
    /// Levels, each half the last [default: ladder's]
    ///
    /// At least 1 (roughness 0), at most down to size 1. By default linear ends at 4 to 9 texels (8 levels
    /// from 640, 7 from 256), filament at 16, unity after 7 levels, and babylon and --out-layout mips at 1.
    #[cfg_attr(feature = "cli", arg(long, value_name = "N"))]
    pub levels: Option<u32>,
    /// Roughness of the levels [default: linear]
    ///
    /// linear: level/(levels-1), as in glTF, Bevy and the Khronos sampler. filament: 1 - sqrt(1 -
    /// level/(levels-1)), as in Filament and three.js. unity: seven levels of r (1.7 - 0.7 r) =
    /// level/(levels-1). babylon: alpha = 2^(level/0.8)/size.
    #[cfg_attr(feature = "cli", arg(long, value_name = "LADDER", hide_possible_values = true))]
    pub ladder: Option<Ladder>,
    /// sampled, solved or mixed
    ///
    /// Content of the texels of ggx cubes. sampled: lobes along the texels' directions. solved: values whose
    /// trilinear look-ups best fit the lobes between texels and levels; takes up to three times as long and
    /// has no bounds. mixed: levels up to roughness 1/3 are sampled, rougher ones solved. By default mixed
    /// for linear ggx cubes of adaptive:E without a target (or --target generic) and without --bounds, else
    /// sampled.
    #[cfg_attr(feature = "cli", arg(long, value_name = "KIND", hide_possible_values = true))]
    pub chain: Option<ChainKind>,
    /// ggx, phong, cone, cosine or charlie
    ///
    /// cosine is irradiance over pi; it has no roughness and bakes one level. charlie is sheen, a band
    /// towards the horizon; it has no mirror and clamps roughness to at least 0.125. Its levels of texels
    /// much finer than the band are interpolated, to twice the tolerance and without bounds, unless --bounds
    /// asks for these.
    #[cfg_attr(feature = "cli", arg(long, value_name = "LOBE", default_value = "ggx"))]
    #[cfg_attr(feature = "cli", arg(hide_possible_values = true))]
    pub lobe: Lobe,
    /// adaptive:E, pyramid, box or reference
    ///
    /// adaptive:E is quadrature with a certified bound; E, from 1e-6 to 1, is the target relative RMS error.
    /// adaptive means adaptive:0.005. pyramid is the real-time tier, for ggx and without bounds: a mip chain
    /// of Gaussians. box is the single box of the octahedron environment maps paper. reference
    /// integrates exhaustively in double precision: slow, for auditing.
    #[cfg_attr(feature = "cli", arg(long, value_name = "F", default_value = "adaptive:0.005"))]
    #[cfg_attr(feature = "cli", arg(value_parser = crate::lobe::filter::parsed))]
    pub filter: Filter,
    /// ktx2, ktx, dds, exr, hdr [default: OUT's or ktx2]
    ///
    /// By default from OUT's extension. ktx is KTX 1.
    #[cfg_attr(feature = "cli", arg(long, value_name = "FORMAT", hide_possible_values = true))]
    pub format: Option<Container>,
    /// Layout of levels in exr and hdr [default: faces]
    ///
    /// faces: m{level}_{face}, six images per level. cross, cross-vertical, strip, strip-vertical: m{level},
    /// the faces in one image. equirect: m{level}, panoramas of 2N x N for --size N. octahedral: m{level},
    /// squares of N x N. parts: one EXR file OUT, one part per face. mips: one EXR file OUT, a panorama with
    /// MIP levels down to one texel. Every texel is filtered directly, not resampled.
    #[cfg_attr(feature = "cli", arg(long, value_name = "LAYOUT", conflicts_with = "target"))]
    #[cfg_attr(feature = "cli", arg(hide_possible_values = true))]
    pub out_layout: Option<OutputLayout>,
    /// f16, f32, rgb9e5, r11g11b10f, bc6h [default: f16]
    ///
    /// f16 clamps at 65504 and counts clamped texels. exr supports f16 and f32; without --pixel it stores
    /// levels too bright or too dim for f16 as floats. bc6h is for ktx2 and dds. hdr has a fixed pixel
    /// format.
    #[cfg_attr(feature = "cli", arg(long, value_name = "PIXEL", hide_possible_values = true))]
    pub pixel: Option<Pixel>,
    /// Overbright texels: clamp, compress or error
    ///
    /// Handles radiance above the pixel format's maximum. clamp clamps each channel; compress scales the
    /// brightest texels of such levels down smoothly and keeps their colour; error fails. The report counts
    /// these texels.
    #[cfg_attr(feature = "cli", arg(long, value_name = "HOW", default_value = "clamp"))]
    #[cfg_attr(feature = "cli", arg(hide_possible_values = true))]
    pub overflow: Overflow,
    /// Add an irradiance cube of edge N, 1 to 1024
    ///
    /// Values are irradiance over pi. exr and hdr: irradiance_{face} next to the levels. Other formats: a
    /// second file, OUT's stem with .irradiance.ktx2 or similar.
    #[cfg_attr(feature = "cli", arg(long, value_name = "N"))]
    pub irradiance: Option<u32>,
    /// Add the unfiltered cube, edge N or source
    ///
    /// N is 1 to 16384; source gives texels about as large as the source's. exr and hdr: skybox_{face} next
    /// to the levels. Other formats: OUT's stem with .skybox.ktx2 or similar. Targets: NAME_skybox or skybox.
    /// unreal, godot and blender get a panorama of 4N x 2N; babylon and playcanvas a .dds and gltf-ext a
    /// .ktx2 file of half floats. For filament it replaces level 0.
    #[cfg_attr(feature = "cli", arg(long, value_name = "N|source", value_parser = Skybox::parsed))]
    pub skybox: Option<Skybox>,
    /// Highest band of spherical harmonics, 2 to 4
    ///
    /// Written to the report and sh.json. Filament and EXT_lights_image_based use bands up to 2 only.
    /// [default: 2]
    #[cfg_attr(feature = "cli", arg(long, value_name = "L"))]
    pub sh_order: Option<u32>,
    /// SH window against ringing [default: none]
    ///
    /// none; hanning:W, lanczos:W and sinc4:W scale band l by (1 + cos x)/2, sin(x)/x and (sin(x)/x)^4, x =
    /// pi l/W, and to 0 from l = W on; nonnegative is sinc4 with the widest W for which irradiance is nowhere
    /// negative, as cmgen's --sh-window=auto.
    #[cfg_attr(feature = "cli", arg(long, value_name = "WINDOW", default_value = "none"))]
    #[cfg_attr(feature = "cli", arg(hide_default_value = true))]
    #[cfg_attr(feature = "cli", arg(value_parser = crate::light::sh::window::parsed))]
    pub sh_window: ShWindow,
    /// Axis that the engine negates: none, x or z
    ///
    /// Pre-flips cubes for engines that negate an axis at look-up. With --target only; overrides the preset.
    #[cfg_attr(feature = "cli", arg(long, value_name = "AXIS", requires = "target"))]
    #[cfg_attr(feature = "cli", arg(hide_possible_values = true))]
    pub flip: Option<Flip>,
    /// Map of a pyramid: octahedral or cube
    ///
    /// octahedral is an array of bordered squares; cube is one cube with MIP levels, of faces of --size at
    /// the mirror, for engines that sample cubes. --target pyramid only. [default: octahedral]
    #[cfg_attr(feature = "cli", arg(long, value_name = "MAP", requires = "target"))]
    #[cfg_attr(feature = "cli", arg(hide_possible_values = true))]
    pub map: Option<PyramidMap>,
    /// Diffuse light: none, cube, sh or both
    ///
    /// An irradiance cube, spherical harmonics, or both. With --target only; overrides the preset.
    #[cfg_attr(feature = "cli", arg(long, value_name = "FORM", requires = "target"))]
    #[cfg_attr(feature = "cli", arg(hide_possible_values = true))]
    pub diffuse: Option<Diffuse>,
    /// Base name of the files [default: INPUT's]
    ///
    /// With --target only.
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME", requires = "target"))]
    pub name: Option<String>,
    /// Whether to draw a picture of spheres along the ladder.
    #[cfg_attr(feature = "cli", arg(skip))]
    pub preview: bool,
    /// Preview exposure: auto, or -40 to 40 EV
    ///
    /// auto makes the spheres' median a dark grey, and darker where much of them is very bright; highlights
    /// are compressed. Does not affect the bake.
    #[cfg_attr(feature = "cli", arg(long, value_name = "EV", default_value_t = Exposure::Auto))]
    #[cfg_attr(feature = "cli", arg(requires = "preview"))]
    pub exposure: Exposure,
    /// Write the environment without its sun
    ///
    /// Writes OUT.sunless.exr, or sunless.exr in OUT if that is a folder: floats, in the input's layout
    /// (cubes as a cross), not rotated. With --extract-sun only.
    #[cfg_attr(feature = "cli", arg(long, requires = "extract_sun"))]
    pub sunless: bool,
    /// Write every texel's certified error bound
    ///
    /// Writes m{level}_{face}_bound.exr, absolute luminance. exr and hdr: next to the levels; otherwise in
    /// the folder OUT.bounds.
    #[cfg_attr(feature = "cli", arg(long))]
    pub bounds: bool,
    /// The summed-area table.
    #[serde(flatten)]
    #[cfg_attr(feature = "cli", command(flatten))]
    pub table: TableOptions,
    /// The input.
    #[serde(flatten)]
    #[cfg_attr(feature = "cli", command(flatten))]
    pub input: InputOptions,
}

/// Options of the summed-area table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "cli", derive(clap::Args), command(next_help_heading = "Table"))]
pub struct TableOptions {
    /// Edge of the octahedral map, 1 to 16384 [default: lobes']
    ///
    /// By default as fine as the sharpest lobe requires, at most twice the source (the width of a panorama,
    /// twice the face of a cube) and at least the source up to 512, rounded up to a multiple of 64, at most
    /// 4096 with its border. For pyramid a power of two from 32 to 2048, by default at most the source.
    #[cfg_attr(feature = "cli", arg(long, value_name = "N"))]
    pub oem_size: Option<u32>,
    /// Border in texels, 0 to 16384 [default: filter's]
    ///
    /// By default 0; in bake for box half the side of the widest box.
    #[cfg_attr(feature = "cli", arg(long, value_name = "B"))]
    pub border: Option<u32>,
    /// blocks, hensley:2, :4, :8 or :16 [default: blocks]
    ///
    /// Scan of the summed-area table that box reads. All scans give the same bits. blocks is the
    /// engine's own and the fastest. hensley:R is recursive doubling as in the papers, R samples per pass.
    #[cfg_attr(feature = "cli", arg(long, value_name = "SCAN"))]
    pub scan: Option<Scan>,
}

/// Options of reading an environment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "cli", derive(clap::Args), command(next_help_heading = "Input"))]
pub struct InputOptions {
    /// Layout of the environment [default: auto]
    ///
    /// auto uses the map that the header names, as convert writes it, else the aspect ratio: 2:1 is a
    /// panorama, 4:3 and 3:4 are crosses, 6:1 and 1:6 are strips. faces reads six files as one cube, in the
    /// order +X -X +Y -Y +Z -Z or by name (px, posx, right, +x, ...). Contradicting the header is an error.
    #[cfg_attr(feature = "cli", arg(long, value_name = "LAYOUT", default_value = "auto"))]
    #[cfg_attr(feature = "cli", arg(hide_default_value = true))]
    pub layout: InputLayout,
    /// Rotate about +Y; +90 maps +Z to +X [default: 0]
    #[cfg_attr(feature = "cli", arg(long, value_name = "DEG", value_parser = text::number))]
    pub rotate_y: Option<f64>,
    /// Flip left to right, for photographs from inside
    #[cfg_attr(feature = "cli", arg(long))]
    pub mirror: bool,
    /// Multiply radiance by X, above 0 [default: 1]
    ///
    /// Applies first, when reading the input; the sun, bounds and compare's errors are those of the scaled
    /// light. Values beyond float32 are an error.
    #[cfg_attr(feature = "cli", arg(long, value_name = "X", value_parser = text::number))]
    pub scale: Option<f64>,
    /// Remove black bars of a panorama that is not 2:1
    ///
    /// Removes all-black rows above and below, or columns left and right, down to 2:1; from a 2:1 panorama, a
    /// black frame on all sides. Reports what it removed.
    #[cfg_attr(feature = "cli", arg(long))]
    pub crop: bool,
    /// Pad a panorama to 2:1: black or edge
    ///
    /// For panoramas of a part of the sphere, such as 360 x 120 degrees. Centres the picture. black, the
    /// default, adds black rows above and below (or columns left and right), without light; --pad=edge
    /// repeats the outermost ones. Treats every picture as a panorama and applies after --crop.
    #[cfg_attr(feature = "cli", arg(long, value_name = "FILL", num_args = 0..=1, require_equals = true))]
    #[cfg_attr(feature = "cli", arg(default_missing_value = "black", hide_possible_values = true))]
    pub pad: Option<Pad>,
    /// Repair NaN (to 0) and Inf (to a finite neighbour)
    ///
    /// Inf becomes the largest finite neighbour. Repairs are counted.
    #[cfg_attr(feature = "cli", arg(long))]
    pub sanitize: bool,
    /// Treat any repair of the input as an error
    ///
    /// Without it, negative radiance is set to 0 and counted, and one warning states its share of energy.
    #[cfg_attr(feature = "cli", arg(long, conflicts_with = "sanitize"))]
    pub strict: bool,
    /// Remove the sun, or the lights of WHICH, and use the rest
    ///
    /// A sun is the region connected to a peak and at least a tenth as bright, with its glow. The peak must
    /// be 100 times as bright as the median 10 to 30 degrees around it, and the whole at most 0.01 sr (of
    /// coarse pictures nine texels, up to 0.2 sr). Windows and area lights stay, with a warning, and so does
    /// what a directional light cannot replace: the rest and the suns light every surface as the source does,
    /// within 1 % of the greatest irradiance. The hole is filled from its surroundings.
    ///
    /// Without WHICH, the brightest light. --extract-sun=N: the N lights of the greatest irradiance, 1 to 32,
    /// each at least 0.1 % of the light. --extract-sun=A,E or =X,Y,Z: the light within 10 degrees of azimuth
    /// A and elevation E in degrees, as info prints them, or of the vector X,Y,Z, after --mirror and
    /// --rotate-y; separate several by colons.
    ///
    /// bake writes the suns as directional lights to OUT.sun.json, for glTF to OUT.sun.gltf
    /// (KHR_lights_punctual), or to sun.json and sun.gltf in OUT if that is a folder, and to the report.
    /// sun.json holds one object, or null; with WHICH a list.
    #[cfg_attr(feature = "cli", arg(long, value_name = "WHICH", value_parser = Suns::parsed))]
    #[cfg_attr(feature = "cli", arg(num_args = 0..=1, require_equals = true))]
    #[cfg_attr(feature = "cli", arg(default_missing_value = "brightest"))]
    pub extract_sun: Option<Suns>,
}

/// Options of type `T` from JSON, by their names in it: numbers, `true` and `false`, lists, and texts as on
/// the command line; null for the default.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for an option that there is not, and for a value that it cannot
/// have.
pub fn from_json<T: Default + Serialize + DeserializeOwned>(options: Map<String, Value>) -> Result<T> {
    let mut all = fields(&T::default());
    let mut parsed = T::default();
    for (name, value) in options {
        let Some(old) = all.get_mut(&name) else {
            let names: Vec<String> = all.keys().map(|name| format!("`{name}`")).collect();
            return wrong(format!("there is no option `{name}`; there are {}", names.join(", ")));
        };
        if value.is_null() {
            continue;
        }
        old.clone_from(&value);
        parsed = match serde_json::from_value(Value::Object(all.clone())) {
            Ok(parsed) => parsed,
            Err(error) => return wrong(format!("`{name}` is {value}; {}", remedy(&error.to_string()))),
        };
    }
    Ok(parsed)
}

/// The remedy in serde's message.
fn remedy(message: &str) -> String {
    match message.rsplit_once("expected ") {
        Some((_, "u32")) => "a whole number is needed".to_owned(),
        Some((_, "f64")) => "a finite number is needed".to_owned(),
        Some((_, what)) => format!("{what} is needed"),
        None => message.to_owned(),
    }
}

/// The fields of `value` by their names.
pub(crate) fn fields(value: &impl Serialize) -> Map<String, Value> {
    match serde_json::to_value(value) {
        Ok(Value::Object(fields)) => fields,
        other => unreachable!("options have finite numbers and names: {other:?}"),
    }
}

impl Recipe {
    /// Checks each option on its own, and those that no target or source decides.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for a number out of range, and for options that contradict
    /// each other.
    pub fn check(&self) -> Result<()> {
        let ranges = [
            ("size", self.size, 1, MAX_SIZE),
            ("levels", self.levels, 1, 15),
            ("irradiance", self.irradiance, 1, 1024),
            ("sh_order", self.sh_order, 2, MAX_ORDER),
        ];
        in_ranges(&ranges)?;
        self.table.check(self.filter)?;
        self.input.check()?;
        for (place, target) in self.target.iter().enumerate() {
            if self.target[..place].contains(target) {
                return wrong(format!("`target` names {} twice", target.name));
            }
        }
        let is_file_name =
            |name: &String| !(name.is_empty() || name.starts_with('.') || name.contains(['/', '\\', '\0']));
        if let Some(name) = self.name.as_ref().filter(|name| !is_file_name(name)) {
            return wrong(format!(
                "`name` is {name:?}; it must be a file name without folders or a leading dot"
            ));
        }
        if self.sunless && self.input.extract_sun.is_none() {
            return wrong("`sunless` writes the environment without its sun; set `extract_sun` too");
        }
        Ok(())
    }
}

impl TableOptions {
    /// Checks them for `filter`.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for a number out of range, and for a scan that the filter
    /// does not make.
    pub fn check(&self, filter: Filter) -> Result<()> {
        in_ranges(&[("oem_size", self.oem_size, 1, MAX_SIZE), ("border", self.border, 0, MAX_SIZE)])?;
        match self.scan {
            Some(scan) if !filter.reads_sat() => wrong(format!(
                "`scan` {scan} is for the filter over a summed-area table; use `filter` box, or omit `scan`"
            )),
            _ => Ok(()),
        }
    }

    /// What answers queries of lobes by `filter`, of which `sharpest` is the least roughness above 0.
    #[must_use]
    pub fn reflector(&self, filter: Filter, sharpest: f64) -> ReflectorSettings {
        ReflectorSettings {
            oem_size: self.oem_size,
            border: self.border,
            scan: self.scan.unwrap_or_default(),
            sharpest,
            pyramid: filter == Filter::Pyramid,
        }
    }
}

impl InputOptions {
    /// Checks them.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for a number out of range, and for options that contradict
    /// each other.
    pub fn check(&self) -> Result<()> {
        if let Some(degrees) = self.rotate_y.filter(|degrees| degrees.is_nan() || degrees.abs() > MAX_DEGREES)
        {
            return wrong(format!(
                "`rotate_y` is {degrees}; it must be between -{MAX_DEGREES} and {MAX_DEGREES}"
            ));
        }
        if let Some(scale) = self.scale.filter(|scale| !(scale.is_finite() && *scale > 0.0)) {
            return wrong(format!("`scale` is {scale}; it must be finite and above 0"));
        }
        if self.strict && self.sanitize {
            return wrong("`strict` and `sanitize` contradict each other; omit one");
        }
        let is_panorama = matches!(self.layout, InputLayout::Auto | InputLayout::Equirect);
        if (self.crop || self.pad.is_some()) && !is_panorama {
            return wrong("`pad` and `crop` are for panoramas; omit `layout`");
        }
        Ok(())
    }

    /// How the file is read, before it is turned.
    #[must_use]
    pub fn read_options(&self) -> ReadOptions {
        ReadOptions {
            layout: self.layout,
            sanitize: self.sanitize,
            strict: self.strict,
            scale: self.scale.unwrap_or(1.0),
            crop: self.crop,
            pad: self.pad,
            ..ReadOptions::default()
        }
    }
}

/// Checks options by their names, values, and least and greatest values.
fn in_ranges(ranges: &[(&str, Option<u32>, u32, u32)]) -> Result<()> {
    for (name, value, least, most) in ranges {
        if let Some(value) = value.filter(|value| !(least..=most).contains(&value)) {
            return wrong(format!("`{name}` is {value}; it must be {least} to {most}"));
        }
    }
    Ok(())
}
