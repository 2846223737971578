//! Arguments that several subcommands share.

use crate::cli::values::{EngineArg, finite, scale};
use crate::io::{LayoutChoice, Pad};
use clap::Args as ClapArgs;

/// The most threads that --threads takes.
pub(super) const MAX_THREADS: i64 = 256;

/// How input files are read.
#[derive(Clone, Debug, ClapArgs)]
#[command(next_help_heading = "Input")]
pub(super) struct InputArgs {
    /// How the texels cover the sphere [default: auto]
    ///
    /// auto goes by the shape: 2:1 is a panorama, 4:3 and 3:4 are crosses, 6:1 and 1:6 are strips. faces
    /// takes six files as one cube, in the order +X -X +Y -Y +Z -Z or by name (px, posx, right, +x, ...).
    #[arg(long, value_name = "LAYOUT", default_value = "auto", hide_default_value = true)]
    pub(super) layout: LayoutChoice,
    /// Turn about +Y; +90 carries +Z to +X [default: 0]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = finite)]
    pub(super) rotate_y: Option<f64>,
    /// Flip left to right, for photographs from inside
    #[arg(long)]
    pub(super) mirror: bool,
    /// Multiply radiance by X, above 0 [default: 1]
    ///
    /// When the input is read, before all else: the sun, bounds and compare's errors are those of the scaled
    /// light. What goes beyond float32 is an error.
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = scale)]
    pub(super) scale: Option<f64>,
    /// Remove a panorama's black bars, where it is not 2:1
    ///
    /// Rows above and below, or columns left and right, that are black throughout, as many as stand over 2:1;
    /// of a panorama of 2:1 a black frame around all of it. What was removed is said.
    #[arg(long)]
    pub(super) crop: bool,
    /// Fill up a panorama that is not 2:1: black or edge
    ///
    /// For panoramas of a part of the sphere, such as 360 x 120 degrees. The picture comes into the middle;
    /// black, the default, adds black rows above and below (or columns left and right), from where no light
    /// comes; --pad=edge repeats the outermost ones. Takes every picture for a panorama, after --crop.
    #[arg(long, value_name = "FILL", num_args = 0..=1, require_equals = true, default_missing_value = "black")]
    #[arg(hide_possible_values = true)]
    pub(super) pad: Option<Pad>,
    /// Repair NaN (to 0) and Inf (to a finite neighbour)
    ///
    /// Inf becomes the largest finite value around it. What was repaired is counted.
    #[arg(long)]
    pub(super) sanitize: bool,
    /// Make any repair of the input an error
    ///
    /// Without it negative radiance becomes 0, is counted, and one warning says how much energy it was.
    #[arg(long, conflicts_with = "sanitize")]
    pub(super) strict: bool,
    /// Take the sun out: go on with the rest
    ///
    /// The sun is what is connected to the brightest texel and at least a tenth as bright, with its glow. The
    /// texel must be 100 times as bright as the median 10 to 30 degrees around it, and the region at most
    /// 0.01 sr (or nine texels) large: windows and area lights stay, with a warning. What surrounds the sun
    /// closes over it. bake writes what was taken out into the report and into OUT.sun.json, or sun.json in
    /// OUT where that is a folder: a directional light.
    #[arg(long)]
    pub(super) extract_sun: bool,
}

/// What computes.
#[derive(Clone, Debug, ClapArgs)]
#[command(next_help_heading = "Engine")]
pub(super) struct EngineArgs {
    /// What computes: auto, cpu or gpu [default: auto]
    ///
    /// auto takes a hardware GPU where there is one and the CPU otherwise, and says which.
    #[arg(long, value_name = "ENGINE", default_value = "auto")]
    #[arg(hide_default_value = true, hide_possible_values = true)]
    pub(super) engine: EngineArg,
    /// The GPU, by a part of its name
    ///
    /// octagloss info --adapters lists them.
    #[arg(long, value_name = "NAME")]
    pub(super) adapter: Option<String>,
    /// Threads, 1 to 256 [default: one a core]
    ///
    /// The result does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_THREADS))]
    pub(super) threads: Option<u32>,
}
