//! Command-line options of every subcommand. Their doc comments are the help texts.

use super::engine::{EngineArgs, MAX_THREADS};
use super::values::{Texels, filter, percentage, roughness, texels, threshold, within};
use crate::recipes::{InputOptions, Recipe, TableOptions};
use crate::reflectance::DfgForm;
use crate::{Filter, Lobe};
use clap::{Args as ClapArgs, Parser, Subcommand};
use std::path::PathBuf;
use std::sync::LazyLock;

/// Version and compiled features.
static VERSION: LazyLock<String> = LazyLock::new(|| {
    let features =
        [("gpu", cfg!(feature = "gpu")), ("view", cfg!(feature = "view")), ("plot", cfg!(feature = "plot"))];
    let compiled = features.into_iter().filter(|(_, is_compiled)| *is_compiled);
    let names: String = compiled.map(|(name, _)| format!(" {name}")).collect();
    format!("{} (features: cli{names})", env!("CARGO_PKG_VERSION"))
});

/// Bakes HDR environments into glossy reflections of any roughness
///
/// One summed-area table over the sphere, exact 64-bit sums, no noise, and an error bound for every texel.
#[derive(Debug, Parser)]
#[command(name = "octagloss", version = VERSION.as_str(), max_term_width = 80, help_expected = true)]
#[command(disable_help_subcommand = true, subcommand_required = true, arg_required_else_help = true)]
pub(super) struct Args {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Bake environments into prefiltered cube chains
    Bake(BakeArgs),
    /// Print a lobe's radiance around given directions as CSV
    Query(QueryArgs),
    /// Describe an environment or a bake
    Info(InfoArgs),
    /// Measure a bake against its source or another bake
    Compare(CompareArgs),
    /// Time the stages of a bake, as JSON
    Bench(BenchArgs),
    /// Write one of the examples' environments
    Synth(SynthArgs),
    /// Write the split-sum DFG (BRDF integration) lookup table
    Dfg(DfgArgs),
    /// Measure maps of the sphere, by the workbench
    #[command(hide = true)]
    Analyze(super::elsewhere::ElsewhereArgs),
    /// Convert an environment to another map of the sphere
    Convert(super::convert::ConvertArgs),
    /// Render glossy objects in a window or to a picture
    #[cfg(feature = "view")]
    View(Box<super::view_args::ViewArgs>),
    /// Render glossy objects in a window or to a picture (not part of this build)
    ///
    /// Prints the command that compiles the viewer and runs it.
    #[cfg(not(feature = "view"))]
    View(super::elsewhere::ElsewhereArgs),
    /// Print shader code that reads outputs
    Reader(super::reader::ReaderArgs),
    /// Print a completion script for a shell
    Completions(super::completions::CompletionsArgs),
    /// Print the manual page, or write all pages into a folder
    Man(super::man::ManArgs),
    /// Print the licences of the crates in the program
    Licenses,
}

#[derive(Clone, Debug, ClapArgs)]
pub(super) struct BakeArgs {
    /// Environments: .hdr, .exr, .png, .jpg; .ktx2 or bakes
    ///
    /// A folder that is not a bake expands to the files in it with readable extensions. A quoted pattern such
    /// as 'in/*.exr' or 'in/**/*.hdr' expands to its matches (*, ? and [a-z] in names, ** for any folders),
    /// unless a file has that exact name. Skips hidden files and outputs of earlier bakes. Mirrors folders
    /// that a pattern matches in OUT.
    #[arg(required = true, value_name = "INPUT")]
    pub(super) inputs: Vec<PathBuf>,
    /// Descend into subfolders of INPUT folders
    ///
    /// Mirrors subfolders in OUT, so names must differ only within a folder. Does not follow links to
    /// folders; skips OUT.
    #[arg(long, short)]
    pub(super) recursive: bool,
    /// File or folder to write [default: INPUT's name]
    ///
    /// By default in the current folder. ktx2, ktx and dds write a file; exr, hdr and --target write a
    /// folder. With several inputs, a folder or a pattern, OUT is a folder with one output per input, named
    /// after it; a name that ends in / does the same for one input. - is standard output, for outputs of
    /// exactly one file.
    #[arg(short, long, value_name = "OUT")]
    pub(super) output: Option<PathBuf>,
    #[command(flatten)]
    pub(super) recipe: Recipe,
    /// List the outputs without writing them
    ///
    /// Prints one line per file, with --json one line per input, to standard output. Reads inputs and checks
    /// memory; fails on any error that would stop the bake before it begins.
    #[arg(long)]
    pub(super) dry_run: bool,
    /// Write a picture of spheres along the ladder
    ///
    /// Shows the panorama with its sun marked, and for each level a mirror sphere with the sun behind the
    /// camera's shoulder. Several targets stand one below the other.
    #[arg(long, value_name = "FILE.png")]
    pub(super) preview: Option<PathBuf>,
    /// Judge each output: fail above N% of error
    ///
    /// Measures every output against its input as compare --fail-above does, from --from on, after it is
    /// written. An output that fails stays; the exit status is 1.
    #[arg(long, value_name = "N%", value_parser = percentage)]
    pub(super) verify: Option<f64>,
    /// Roughness from which --verify judges [default: 0.6]
    #[arg(long, value_name = "R", requires = "verify", value_parser = roughness)]
    pub(super) from: Option<f64>,
    /// Print the report instead of writing it
    ///
    /// Prints one line per input to standard output instead of writing report.json (exr, hdr, --target) or
    /// OUT.report.json.
    #[arg(long)]
    pub(super) json: bool,
    /// Print errors only
    #[arg(long, short)]
    pub(super) quiet: bool,
    /// Replace outputs that exist
    #[arg(long)]
    pub(super) force: bool,
    /// Skip outputs that are up to date
    ///
    /// Skips outputs whose recorded hashes match: input content, options, version and output. With --force,
    /// all others are baked again; without it, existing ones are errors.
    #[arg(long, conflicts_with = "json")]
    pub(super) skip_unchanged: bool,
    #[command(flatten)]
    pub(super) engine: EngineArgs,
}

#[derive(Debug, ClapArgs)]
pub(super) struct QueryArgs {
    /// An environment; six of them with --layout faces
    #[arg(required = true, value_name = "INPUT")]
    pub(super) inputs: Vec<PathBuf>,
    /// CSV or .npy; - is standard input
    ///
    /// CSV with the header x,y,z, or a NumPy array of float32 or float64 with three columns. With the header
    /// x,y,z,roughness, or a fourth column, each row has its own roughness; all rows share one octahedral
    /// map, as fine as the sharpest requires. At most 4,000,000 directions; CSV of at most 256 MiB, and 1000
    /// bytes per line.
    #[arg(long, value_name = "FILE", required_unless_present = "frames")]
    pub(super) directions: Option<PathBuf>,
    /// Views of surfaces instead, CSV or .npy; - is standard input
    ///
    /// CSV with the header nx,ny,nz,vx,vy,vz, or an array with six columns: normals, and directions to the
    /// viewer; with tx,ty,tz, or nine columns, tangents, too. Answers are the radiance that the surfaces
    /// reflect: GGX with height-correlated Smith masking and Schlick's Fresnel term, not normalised. A view
    /// with n.v below 0.01 is turned up to that. By --filter adaptive:E, pyramid or reference, on the CPU.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["directions", "lobe"])]
    pub(super) frames: Option<PathBuf>,
    /// Anisotropy of --frames, in [0, 1] [default: 0]
    ///
    /// As in KHR_materials_anisotropy: alpha along the tangent is r^2 + (1 - r^2) A^2, across it r^2.
    #[arg(long, value_name = "A", value_parser = within([0.0, 1.0]), requires = "frames")]
    pub(super) anisotropy: Option<f64>,
    /// Reflectance of --frames at normal incidence, in [0, 1] [default: 1]
    ///
    /// At grazing incidence it is 1.
    #[arg(long, value_name = "F0", value_parser = within([0.0, 1.0]), requires = "frames")]
    pub(super) f0: Option<f64>,
    /// File to write, .csv or .npy [default: standard output]
    ///
    /// .npy is a NumPy array of float32: red, green and blue of each direction, in the order asked, and with
    /// --bound four more columns. Mirrors have no bounds: they are infinite in arrays, and empty in CSV.
    #[arg(long, short, value_name = "OUT")]
    pub(super) output: Option<PathBuf>,
    /// Replace OUT if it exists
    #[arg(long)]
    pub(super) force: bool,
    /// Roughness in [0, 1]; 0 is a mirror
    ///
    /// Required, except for the cosine lobe and for --directions with a column of roughness.
    #[arg(long, value_name = "R", value_parser = roughness)]
    pub(super) roughness: Option<f64>,
    /// ggx, phong, cone, cosine or charlie
    #[arg(long, value_name = "LOBE", default_value = "ggx", hide_possible_values = true)]
    pub(super) lobe: Lobe,
    /// adaptive:E, pyramid, box or reference
    ///
    /// As in bake.
    #[arg(long, value_name = "F", default_value = "adaptive:0.005", value_parser = filter)]
    pub(super) filter: Filter,
    /// Add certified errors: bound, bound_r, bound_g, bound_b
    ///
    /// Of the luminance and of each channel, in units of radiance.
    #[arg(long)]
    pub(super) bound: bool,
    /// Print errors only
    #[arg(long, short)]
    pub(super) quiet: bool,
    #[command(flatten)]
    pub(super) table: TableOptions,
    #[command(flatten)]
    pub(super) input: InputOptions,
    #[command(flatten)]
    pub(super) engine: EngineArgs,
}

#[derive(Debug, ClapArgs)]
pub(super) struct InfoArgs {
    /// Any file of this program: environment, bake, folder
    ///
    /// Also the pictures of convert's maps, tables, previews, reports, and the files of every target.
    #[arg(required_unless_present = "adapters", value_name = "INPUT")]
    pub(super) inputs: Vec<PathBuf>,
    /// List the GPUs that --adapter can name
    #[arg(long, conflicts_with = "inputs")]
    pub(super) adapters: bool,
    /// Print JSON, on one line
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) input: InputOptions,
}

#[derive(Debug, ClapArgs)]
pub(super) struct CompareArgs {
    /// A bake, or a folder of the bakes of several inputs
    ///
    /// A .ktx2, .ktx, .dds or .exr file, a folder of levels, of a target or of cmgen. A folder of bakes holds
    /// one for each B, named as bake names its outputs for several inputs.
    #[arg(value_name = "A")]
    pub(super) bake: PathBuf,
    /// The reference: a bake or the source environment
    ///
    /// For a folder of bakes: any number of sources, folders of sources and quoted patterns, as in bake. Two
    /// files, a bake and its source, compare two bakes side by side: compare A B SOURCE.
    #[arg(required = true, value_name = "B")]
    pub(super) against: Vec<PathBuf>,
    /// Descend into subfolders of folders of sources
    #[arg(long, short)]
    pub(super) recursive: bool,
    /// Texels to integrate per level [default: 400]
    ///
    /// A number or all. Against a source, each texel needs an exhaustive integration, which is slow for
    /// cones; their default is 40. Against a bake, all texels are compared.
    #[arg(long, value_name = "N|all", value_parser = texels)]
    pub(super) texels: Option<Texels>,
    /// Lobe of the bake [default: the recorded one, or ggx]
    #[arg(long, value_name = "LOBE", hide_possible_values = true)]
    pub(super) lobe: Option<Lobe>,
    /// Write a picture of the errors
    ///
    /// In false colour, from 0.01 % to 100 %; no exposure applies. Against a source, shows a grid of at most
    /// as many texels as are integrated. For compare A B SOURCE: spheres of both bakes and of the source, and
    /// the errors of both in one scale, at the roughnesses of --delivered or at four.
    #[arg(long, value_name = "FILE.png")]
    pub(super) picture: Option<PathBuf>,
    /// Measure the errors of trilinear look-ups
    ///
    /// Against a source, for lobes of ggx. Looks up between texels and levels by the bake's ladder, along
    /// 20,000 directions, at the roughnesses R, or at three between each two levels. The only measurement for
    /// solved chains.
    #[arg(long, value_name = "R", value_delimiter = ',', num_args = 0.., require_equals = true)]
    #[arg(value_parser = roughness)]
    pub(super) delivered: Option<Vec<f64>>,
    /// Draw the errors of look-ups over roughness
    ///
    /// By default at 50 roughnesses up to 1, as far as the source resolves their lobes. Needs a build with
    /// the feature plot.
    #[arg(long, value_name = "FILE.png|svg", requires = "delivered")]
    pub(super) chart: Option<PathBuf>,
    /// Another bake to measure with --delivered; repeatable
    ///
    /// Its errors are printed too, and drawn into the chart.
    #[arg(long, value_name = "BAKE", requires = "delivered")]
    pub(super) overlay: Vec<PathBuf>,
    /// Exit with 1 if a relRMSE is above X
    ///
    /// X is a share or a percentage: 0.05 or 5%. Judges luminance and every channel of whatever a renderer
    /// reads from A: level 0, sampled levels by their texels, solved levels by look-ups between texels and
    /// levels (near the sun, too), the irradiance cube, the skybox, sheen and spherical harmonics. One line
    /// says what was not judged, also with --quiet.
    #[arg(long, value_name = "X", value_parser = threshold)]
    pub(super) fail_above: Option<f64>,
    /// Judge from roughness R on [default: 0]
    ///
    /// Sharper levels and look-ups are not judged. Level 0, which is also a background, always is.
    #[arg(long, value_name = "R", value_parser = roughness)]
    pub(super) from: Option<f64>,
    /// Print JSON, on one line
    #[arg(long)]
    pub(super) json: bool,
    /// Print only errors on standard error
    #[arg(long, short)]
    pub(super) quiet: bool,
    /// Replace picture and chart if they exist
    #[arg(long)]
    pub(super) force: bool,
    /// Threads, 1 to 256 [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_THREADS))]
    pub(super) threads: Option<u32>,
    #[command(flatten)]
    pub(super) input: InputOptions,
}

#[derive(Debug, ClapArgs)]
pub(super) struct BenchArgs {
    /// An environment to time [default: a synthetic sky]
    ///
    /// Every section takes its light: the table is of its octahedral map, and the bake is from it as it is.
    #[arg(value_name = "INPUT")]
    pub(super) inputs: Vec<PathBuf>,
    /// Edge of the table, 64 to 8192
    #[arg(long, value_name = "N", default_value_t = 2048)]
    #[arg(value_parser = clap::value_parser!(u32).range(64..=8192))]
    pub(super) size: u32,
    /// Runs of every section, 1 to 1000; prints medians
    #[arg(long, value_name = "N", default_value_t = 20)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(super) runs: u32,
    /// Time drawing triangles into octahedral maps and cubes
    ///
    /// On the GPU, of 104992 triangles, at the sizes of Table 1 of Engelhardt and Dachsbacher 2008:
    /// octahedral maps of 512 x 512 pixels and cubes of 6 x 209 x 209.
    #[arg(long, conflicts_with_all = ["size", "inputs"])]
    pub(super) direct: bool,
    #[command(flatten)]
    pub(super) input: InputOptions,
    #[command(flatten)]
    pub(super) engine: EngineArgs,
}

#[derive(Debug, ClapArgs)]
pub(super) struct SynthArgs {
    /// Name of the environment; see --list
    #[arg(required_unless_present = "list")]
    pub(super) name: Option<String>,
    /// Output, .exr or .hdr, or - [default: its own name]
    ///
    /// - is standard output.
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// List the names and their purposes
    #[arg(long, conflicts_with_all = ["name", "output"])]
    pub(super) list: bool,
    /// Print errors only
    #[arg(long, short)]
    pub(super) quiet: bool,
    /// Replace the file if it exists
    #[arg(long)]
    pub(super) force: bool,
}

#[derive(Debug, ClapArgs)]
pub(super) struct DfgArgs {
    /// Output, .ktx2 or .exr
    ///
    /// `-` is standard output, as KTX2. Writes half floats. KTX2: RG, or RGBA with --charlie (alpha 1). EXR:
    /// R, G and B.
    #[arg(short, long, value_name = "FILE", required = true)]
    pub(super) output: PathBuf,
    /// Texels along an edge, 1 to 1024
    ///
    /// Columns: cosine of the view angle, 0 to 1. Rows: perceptual roughness, 0 to 1, downwards.
    #[arg(long, value_name = "N", default_value_t = 128)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(super) size: u32,
    /// Red and green: split-sum or multiple-scattering
    ///
    /// split-sum: specular = f0 red + f90 green (Khronos, Bevy, three.js). multiple-scattering: specular =
    /// mix(red, green, f0), times 1 + f0 (1/green - 1) (Filament). GGX with height-correlated Smith
    /// visibility.
    #[arg(long, value_name = "FORM", default_value = "split-sum", hide_possible_values = true)]
    pub(super) form: DfgForm,
    /// Blue: directional albedo of Charlie (sheen)
    #[arg(long)]
    pub(super) charlie: bool,
    /// Print errors only
    #[arg(long, short)]
    pub(super) quiet: bool,
    /// Replace the file if it exists
    #[arg(long)]
    pub(super) force: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    #[test]
    fn every_option_is_told_on_a_line_of_at_most_80_columns() {
        let mut command = Args::command();
        command.build();
        command.clone().debug_assert();
        for sub in std::iter::once(&mut command.clone()).chain(command.get_subcommands_mut()) {
            for line in sub.render_help().to_string().lines() {
                assert!(line.chars().count() <= 80, "{}: {line:?}", sub.get_name());
            }
        }
    }
}
