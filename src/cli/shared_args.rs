//! Arguments shared by several subcommands.

use crate::analysis::extraction::Suns;
use crate::cli::values::{EngineArg, scale, turn};
use crate::io::{InputLayout, Pad};
use clap::Args as ClapArgs;

/// Maximum of --threads.
pub(super) const MAX_THREADS: i64 = 256;

/// Options of reading input files.
#[derive(Clone, Debug, PartialEq, ClapArgs)]
#[command(next_help_heading = "Input")]
pub(super) struct InputArgs {
    /// Layout of the environment [default: auto]
    ///
    /// auto uses the map that the header names, as convert writes it, else the aspect ratio: 2:1 is a
    /// panorama, 4:3 and 3:4 are crosses, 6:1 and 1:6 are strips. faces reads six files as one cube, in the
    /// order +X -X +Y -Y +Z -Z or by name (px, posx, right, +x, ...). Contradicting the header is an error.
    #[arg(long, value_name = "LAYOUT", default_value = "auto", hide_default_value = true)]
    pub(super) layout: InputLayout,
    /// Rotate about +Y; +90 maps +Z to +X [default: 0]
    #[arg(long, value_name = "DEG", value_parser = turn)]
    pub(super) rotate_y: Option<f64>,
    /// Flip left to right, for photographs from inside
    #[arg(long)]
    pub(super) mirror: bool,
    /// Multiply radiance by X, above 0 [default: 1]
    ///
    /// Applies first, when reading the input; the sun, bounds and compare's errors are those of the scaled
    /// light. Values beyond float32 are an error.
    #[arg(long, value_name = "X", value_parser = scale)]
    pub(super) scale: Option<f64>,
    /// Remove black bars of a panorama that is not 2:1
    ///
    /// Removes all-black rows above and below, or columns left and right, down to 2:1; from a 2:1 panorama, a
    /// black frame on all sides. Reports what it removed.
    #[arg(long)]
    pub(super) crop: bool,
    /// Pad a panorama to 2:1: black or edge
    ///
    /// For panoramas of a part of the sphere, such as 360 x 120 degrees. Centres the picture. black, the
    /// default, adds black rows above and below (or columns left and right), without light; --pad=edge
    /// repeats the outermost ones. Treats every picture as a panorama and applies after --crop.
    #[arg(long, value_name = "FILL", num_args = 0..=1, require_equals = true)]
    #[arg(default_missing_value = "black")]
    #[arg(hide_possible_values = true)]
    pub(super) pad: Option<Pad>,
    /// Repair NaN (to 0) and Inf (to a finite neighbour)
    ///
    /// Inf becomes the largest finite neighbour. Repairs are counted.
    #[arg(long)]
    pub(super) sanitize: bool,
    /// Treat any repair of the input as an error
    ///
    /// Without it, negative radiance is set to 0 and counted, and one warning states its share of energy.
    #[arg(long, conflicts_with = "sanitize")]
    pub(super) strict: bool,
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
    #[arg(long, value_name = "WHICH", value_parser = Suns::parsed, num_args = 0..=1, require_equals = true)]
    #[arg(default_missing_value = "brightest")]
    pub(super) extract_sun: Option<Suns>,
}

/// Options of the engine.
#[derive(Clone, Debug, ClapArgs)]
#[command(next_help_heading = "Engine")]
pub(super) struct EngineArgs {
    /// Engine: auto, cpu or gpu [default: auto]
    ///
    /// auto uses a hardware GPU if there is one, else the CPU, and prints the choice.
    #[arg(long, value_name = "ENGINE", default_value = "auto")]
    #[arg(hide_default_value = true, hide_possible_values = true)]
    pub(super) engine: EngineArg,
    /// GPU, by a part of its name
    ///
    /// octagloss info --adapters lists them.
    #[arg(long, value_name = "NAME")]
    pub(super) adapter: Option<String>,
    /// Threads, 1 to 256 [default: one per core]
    ///
    /// Does not affect the result.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_THREADS))]
    pub(super) threads: Option<u32>,
}
