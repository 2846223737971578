//! Arguments of `octagloss-workbench analyze --plot`.

use clap::Args as ClapArgs;
use clap::builder::PossibleValuesParser;
use octagloss::cli::console::Console;
use octagloss::cli::outcome::{Outcome, renamed};
use octagloss_core::files::io::{self, ReadOptions};
use octagloss_core::light::environment::Environment;
use octagloss_core::sphere::registry::MAPS;
use std::path::PathBuf;

#[derive(Debug, ClapArgs)]
pub(super) struct FigureArgs {
    /// Draw figures of the maps into the folder -o, as PNG and SVG
    ///
    /// For every map: relative solid angle and anisotropy on the sphere, the layout, and a panorama in the
    /// layout. Also: three maps compared (figure 5 of the octahedron paper), the unfolding of the octahedron,
    /// the border of its square (figure 4), the seam of the tennis ball, sampling requirement against
    /// anisotropy, look-ups without and with each remedy of that paper's section 4.2, and the errors of
    /// --lobes.
    #[arg(long, requires = "output", conflicts_with_all = ["table", "lobes", "csv", "json"])]
    pub(super) plot: bool,
    /// The folder of the figures
    #[arg(short, long, value_name = "FOLDER")]
    pub(super) output: Option<PathBuf>,
    /// Draw the figures of this map, or measure it with --lobes; repeat for several
    #[arg(
        long,
        value_name = "MAP",
        value_parser = PossibleValuesParser::new(MAPS.iter().map(|map| map.name)),
        hide_possible_values = true
    )]
    pub(super) map: Vec<String>,
    /// Draw this figure only; repeat for several
    ///
    /// A kind (solid-angle, anisotropy, layout, panorama, compared, unfolding, border, seam, sampling,
    /// lookup-level, lookup-border, lookup-greatest, lookup-weights, lookup-rectangular, lobes-box,
    /// lobes-stack, lobes-adaptive, lobes-sphere), or a figure of a map, such as layout-cube.
    #[arg(long, value_name = "NAME")]
    pub(super) figure: Vec<String>,
    /// Environment of the panorama figures [default: sky of synth]
    ///
    /// With --lobes the environment to integrate, 2:1 if a panorama; by default 400 lamps spread evenly.
    /// Integration is exhaustive: use small environments, and cubes, which are faster than panoramas.
    #[arg(long, value_name = "FILE")]
    pub(super) panorama: Option<PathBuf>,
    /// Texels along the square of the figure border, 1 to 12 [default: 8]
    ///
    /// With --lobes texels along the octahedral square, 8 to 1024, by default 128; the other maps have as
    /// many texels in all.
    #[arg(long, value_name = "N")]
    pub(super) size: Option<u32>,
    /// Width of the border in that figure, at most N [default: 2]
    #[arg(long, value_name = "B")]
    pub(super) border: Option<u32>,
    /// Print errors only
    #[arg(long, short)]
    pub(super) quiet: bool,
    /// Replace figures that exist
    #[arg(long)]
    pub(super) force: bool,
}

/// Settings of the reader that analyze lacks: `convert` has them.
const BY_CONVERT: [(&str, &str); 4] = [
    ("`crop`", "--crop of octagloss convert"),
    ("`layout`", "--from of octagloss convert"),
    ("`pad`", "--pad of octagloss convert"),
    ("`sanitize`", "--sanitize of octagloss convert"),
];

impl FigureArgs {
    /// Reads the environment of --panorama; prints its warnings.
    pub(super) fn environment(&self, console: &Console) -> Outcome<Option<Environment>> {
        let Some(path) = &self.panorama else { return Ok(None) };
        let loaded = io::read(path, &ReadOptions::default()).map_err(|error| renamed(&error, &BY_CONVERT))?;
        for warning in &loaded.warnings {
            console.warn(&format!("{}: {warning}", path.display()));
        }
        Ok(Some(loaded.environment))
    }
}
