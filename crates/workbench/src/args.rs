//! Arguments of `octagloss-workbench analyze`.

use super::figures_args::FigureArgs;
use clap::Args as ClapArgs;
use octagloss::cli::outcome::{Outcome, usage};
use octagloss::cli::values::finite;
use std::path::PathBuf;

#[derive(Debug, ClapArgs)]
pub(super) struct AnalyzeArgs {
    /// Print every map's stretch next to the published values
    ///
    /// Extends table 1 of the tennis-ball paper by further maps. Y: sampling requirement, the area of the
    /// rectangles times the square of the greatest stretch. anisotropy: greatest ratio of both stretches. M:
    /// Y for ideal, anisotropic reconstruction. texels: least and greatest solid angle over the mean of all
    /// texels. used: share of texels inside the domain.
    #[arg(long)]
    pub(super) table: bool,
    /// Print how well lobes are evaluated over summed-area tables of several maps
    ///
    /// Compares octahedral, two octahedral maps 45 degrees apart, tennis-ball, equirect and cube at equal
    /// numbers of texels, with three filters: the paper's single box, a stack of eight boxes, and adaptive
    /// quadrature. Errors are those of luminance over its mean, against exhaustive integration of the
    /// environment: root mean square over the sphere, at the poles, at +-X and +-Z (the octahedral map's cone
    /// points) and at the map's seams; and the worst direction. --map, --size and --panorama select maps,
    /// texels and environment.
    #[arg(long, conflicts_with = "table")]
    pub(super) lobes: bool,
    /// Measure lobes of roughness R, 0.1 to 1; repeat for several [default: 0.2, 0.35, 0.5, 0.75, 1]
    #[arg(long, value_name = "R", value_parser = finite)]
    pub(super) roughness: Vec<f64>,
    /// Print the table as CSV
    ///
    /// Shares and errors are fractions of 1, which the text prints in per cent; so they are with --json.
    #[arg(long, conflicts_with = "json")]
    pub(super) csv: bool,
    /// Print the table as JSON, on one line
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) figures: FigureArgs,
}

impl AnalyzeArgs {
    /// Rejects options of other analyses than the one chosen.
    pub(super) fn check(&self) -> Outcome {
        let FigureArgs { output, map, figure, panorama, size, border, quiet, force, .. } = &self.figures;
        let path = |path: &PathBuf| path.display().to_string();
        let (lobes, plot, both) = (&["--lobes"][..], &["--plot"][..], &["--lobes", "--plot"][..]);
        let options: [(&str, Option<String>, &[&str]); 9] = [
            ("--roughness", self.roughness.first().map(f64::to_string), lobes),
            ("--output", output.as_ref().map(path), plot),
            ("--figure", figure.first().cloned(), plot),
            ("--border", border.map(|border| border.to_string()), plot),
            ("--force", force.then(String::new), plot),
            ("--map", map.first().cloned(), both),
            ("--panorama", panorama.as_ref().map(path), both),
            ("--size", size.map(|size| size.to_string()), both),
            ("--quiet", quiet.then(String::new), both),
        ];
        let chosen = match (self.lobes, self.figures.plot) {
            (true, _) => "--lobes",
            (_, true) => "--plot",
            _ => "--table",
        };
        for (option, value, analyses) in options {
            if let Some(value) = value
                && !analyses.contains(&chosen)
            {
                let given = format!("{option} {value}");
                let analyses = analyses.join(" and ");
                return usage(format!("{} is for {analyses}, not for {chosen}; omit it", given.trim_end()));
            }
        }
        Ok(())
    }
}
