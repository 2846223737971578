//! `octagloss convert`: converts environments between maps of the sphere.

use super::console::{self, Console};
use super::engine::MAX_THREADS;
use super::outcome::{
    Outcome, check_not_input, check_output, on_threads, or_usage, renamed, usage, write_output,
};
use super::values::{scale, turn};
use crate::files::Pixel;
use crate::maps::{MAPS, NamedMap, named};
use crate::read::{Pad, ReadOptions};
use clap::Args as ClapArgs;
use clap::builder::PossibleValuesParser;
use octagloss_core::bake::memory;
use octagloss_core::files::io::environment_write::{losses, picture_bytes, picture_container};
use octagloss_core::files::io::map_header::map_pairs;
use octagloss_core::files::io::{self, LoadedMap, MapLight};
use octagloss_core::geometry::bordered::bordered_picture;
use octagloss_core::geometry::conversion::Source;
use octagloss_core::geometry::resample::Continuation;
use octagloss_core::light::environment::rotation_y;
use octagloss_core::sphere::grid::Grid;
use std::path::{Path, PathBuf};

/// Maximum texels along the shorter side.
const MAX_SIZE: i64 = 8192;

fn map_names() -> PossibleValuesParser {
    PossibleValuesParser::new(MAPS.iter().map(|map| map.name))
}

#[derive(Debug, ClapArgs)]
pub(super) struct ConvertArgs {
    /// The environment: any input of bake, or a picture of --from
    #[arg(value_name = "INPUT")]
    pub(super) input: PathBuf,
    /// Output, .exr or .hdr, or - (as EXR)
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,
    /// The map to convert to
    ///
    /// One picture holds all components: a cube's faces in a row, a dual map's hemispheres side by side, a
    /// tennis ball's panels stacked. octagloss analyze --table lists the maps.
    #[arg(long, value_name = "MAP", value_parser = map_names())]
    pub(super) layout: String,
    /// The map of INPUT [default: its header's, or by shape]
    ///
    /// For pictures without the header that convert writes; a map that contradicts the header is an error.
    /// Expects the components as convert arranges them, without a border.
    #[arg(long, value_name = "MAP", value_parser = map_names(), hide_possible_values = true)]
    pub(super) from: Option<String>,
    /// Texels along the shorter side of a component
    ///
    /// 1 to 8192. By default about the total number of texels of INPUT.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_SIZE))]
    pub(super) size: Option<u32>,
    /// Texels around every component [default: 0]
    ///
    /// At most N. The border continues across the edge: copied where the map's edges join texel to texel
    /// (octahedral, low-distortion, equirect), else resampled.
    #[arg(long, value_name = "B", default_value_t = 0, hide_default_value = true)]
    pub(super) border: u32,
    /// f16 or f32, for .exr [default: f32]
    ///
    /// f32 keeps the energy within 1e-6. f16 halves the file; it rounds by up to 0.05 %, clamps at 65504 and
    /// turns 3e-8 and less to 0. .hdr has a pixel format of its own, which rounds by up to 0.4 % of the
    /// brightest channel. Warnings count texels that are clamped or lose a channel.
    #[arg(long, value_name = "PIXEL", hide_possible_values = true)]
    pub(super) pixel: Option<Pixel>,
    /// Rotate about +Y; +90 maps +Z to +X [default: 0]
    #[arg(long, value_name = "DEG", value_parser = turn)]
    pub(super) rotate_y: Option<f64>,
    /// Multiply radiance by X, above 0 [default: 1]
    #[arg(long, value_name = "X", value_parser = scale)]
    pub(super) scale: Option<f64>,
    /// Remove a panorama's black bars, as in bake
    #[arg(long, conflicts_with = "from")]
    pub(super) crop: bool,
    /// Pad a panorama to 2:1: black or edge
    ///
    /// As in bake; black by default.
    #[arg(long, value_name = "FILL", num_args = 0..=1, require_equals = true)]
    #[arg(default_missing_value = "black")]
    #[arg(conflicts_with = "from", hide_possible_values = true)]
    pub(super) pad: Option<Pad>,
    /// Repair NaN (to 0) and Inf (to a finite neighbour)
    #[arg(long)]
    pub(super) sanitize: bool,
    /// Threads, 1 to 256 [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_THREADS))]
    pub(super) threads: Option<u32>,
    /// Print errors only
    #[arg(long, short)]
    pub(super) quiet: bool,
    /// Replace the file if it exists
    #[arg(long)]
    pub(super) force: bool,
}

pub(super) fn run(args: &ConvertArgs) -> Outcome {
    let path = &args.output;
    // Standard output uses EXR.
    let as_named = if path.as_os_str() == "-" { Path::new("-.exr") } else { path };
    let Ok(container) = picture_container(as_named) else {
        return usage(format!("-o {} must end in .exr or .hdr", path.display()));
    };
    let pixel = or_usage(container.pixel(args.pixel, Pixel::F32))?;
    check_not_input(path, [&args.input])?;
    let existing = check_output(path, args.force)?;
    let map = known(&args.layout);
    let console = Console::new(args.quiet);
    on_threads(args.threads, || {
        let options = ReadOptions {
            sanitize: args.sanitize,
            scale: args.scale.unwrap_or(1.0),
            crop: args.crop,
            pad: args.pad,
            ..ReadOptions::default()
        };
        // The reader's setting `layout` is --from here; --layout is the map to convert to.
        let from = args.from.as_deref().map(known);
        let LoadedMap { light, warnings, .. } = io::read_map(&args.input, from, &options)
            .map_err(|error| renamed(&error, &[("`layout`", "--from")]))?;
        console.warn_of(&args.input, &warnings);
        let source = turned(light, args.rotate_y.unwrap_or(0.0))?;
        let size = args.size.unwrap_or_else(|| equal_size(source.grid(), map));
        if args.border > size {
            return usage(format!("--border {} exceeds the map's side of {size} texels", args.border));
        }
        memory::check_conversion(&source, map, size, args.border)?;
        let picture = {
            let (target, light) = (Grid::new(map.map(), size)?, source.light());
            let texels = source.converted(map, size)?;
            bordered_picture(&target, &texels, args.border, &Continuation::new(&light, &target))
        };
        drop(source);
        let [width, height] = Grid::new(map.map(), size)?.picture_sides(args.border);
        let remedy = if pixel == Pixel::Rgbe { ".exr keeps them" } else { "`pixel` f32 keeps them" };
        console.warn_of(path, &losses(&picture, pixel, remedy));
        let comment = format!("{} of {size} texels a side, border {}", map.title, args.border);
        let bytes = picture_bytes(width, height, &picture, pixel, &comment, &map_pairs(map, args.border))?;
        write_output(path, existing, &bytes)?;
        console.note(&format!(
            "{}: {}, {width} x {height}, {}, {}",
            path.display(),
            map.title,
            pixel.name(),
            console::bytes(bytes.len() as u64)
        ));
        Ok(())
    })
}

/// `light`, turned by `degrees` about +Y.
fn turned(light: MapLight, degrees: f64) -> crate::Result<Source> {
    match light {
        MapLight::Environment(environment) => Source::from_environment(environment.rotated_y(degrees)?),
        MapLight::Components(grid, texels) => Ok(Source::from_texels(grid, texels, rotation_y(degrees))),
    }
}

/// The size at which `map` has about as many texels as `source`, even if it has several components.
fn equal_size(source: &Grid, map: &NamedMap) -> u32 {
    let cells = Grid::new(map.map(), 1).map_or(1, |grid| grid.texel_count());
    let side = (source.texel_count() as f64 / cells as f64).sqrt().ceil() as u32;
    side.next_multiple_of(2).clamp(1, MAX_SIZE as u32)
}

/// Looks up a map named in this file, or checked by clap.
fn known(name: &str) -> &'static NamedMap {
    named(name).expect("one of the maps")
}
