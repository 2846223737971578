//! `octagloss compare --delivered`: errors of trilinear look-ups of one or several bakes, and their chart.

use super::compare_sources::PreparedSource;
use super::console::Console;
use super::measures::{Measures, is_from};
use super::outcome::{Outcome, failed, usage};
#[cfg(feature = "plot")]
use crate::files::Existing;
use crate::{Ladder, Level, Lobe};
use anyhow::Context as _;
use glam::DVec3;
use octagloss_core::analysis::channels::{Greatest, Relative};
use octagloss_core::analysis::compare::is_measurable;
use octagloss_core::analysis::delivered::{
    DIRECTIONS, DeliveredError, default_roughnesses, delivered_errors,
};
use octagloss_core::files::io::LoadedChain;
use serde::Serialize;
use std::cell::Cell;
use std::path::Path;

/// Errors of a bake's trilinear look-ups.
#[derive(Serialize)]
pub(super) struct Delivered {
    /// The ladder that maps roughness to levels.
    ladder: &'static str,
    /// Directions per roughness.
    directions: usize,
    pub(super) roughnesses: Vec<DeliveredError>,
}

/// A further bake of the chart.
#[derive(Serialize)]
pub(super) struct Overlay {
    pub(super) bake: String,
    pub(super) delivered: Delivered,
}

/// Step between the roughnesses of a chart.
const CHART_STEP: f64 = 0.02;

/// Measures look-ups of `bake`, the file or folder `path`, in the prepared `source`; at the given
/// roughnesses, or at those that the source resolves, for a gate those from the roughness `from` on.
pub(super) fn measure(
    measures: &Measures,
    path: &Path,
    bake: &LoadedChain,
    lobe: Lobe,
    source: &PreparedSource,
    console: &Console,
) -> Outcome<Delivered> {
    let name = path.display();
    if lobe != Lobe::Ggx {
        return usage(format!("--delivered needs lobes of ggx; those of {name} are {}", lobe.name()));
    }
    let ladder = ladder(path, bake)?;
    let bake = &bake.chain;
    let asked = measures.delivered.clone().unwrap_or_default();
    let roughnesses = if asked.is_empty() {
        let mut roughnesses = default_roughnesses(bake);
        if let Some(from) = measures.from {
            let last = bake.levels.last().map(|level| level.roughness);
            roughnesses.extend(last.into_iter().chain([from]).filter(|r| *r > 0.0));
            roughnesses.retain(|r| is_from(from, *r) && last.is_some_and(|last| *r <= last));
            roughnesses.sort_by(f64::total_cmp);
            roughnesses.dedup();
        }
        if measures.is_charted {
            roughnesses = (1..=50).map(|step| f64::from(step) * CHART_STEP).collect();
        }
        roughnesses
            .retain(|r| is_measurable(&Level::cube(1, *r, Vec::new()), lobe, source.environment.layout()));
        if roughnesses.is_empty() {
            return failed(format!(
                "no roughness of {name} has a lobe at least two texels of {} wide; bake rougher levels to \
                 compare",
                source.path.display()
            ));
        }
        roughnesses
    } else {
        asked
    };
    let sharpest = roughnesses.iter().copied().filter(|r| *r > 0.0).fold(1.0, f64::min);
    let bar = console.bar("look-ups");
    let done = Cell::new(0);
    let lobes = source.lobes(sharpest)?;
    let truth = |roughness: f64, directions: &[DVec3]| {
        let radiance = lobes(roughness, directions)?;
        done.set(done.get() + 1);
        bar.at(done.get(), roughnesses.len() as u64);
        Ok(radiance)
    };
    let errors = delivered_errors(bake, ladder, &roughnesses, source.sun, &truth)?;
    Ok(Delivered { ladder: ladder.name(), directions: DIRECTIONS, roughnesses: errors })
}

/// The ladder of `bake` in `path`: the one that it records, or else the one that matches its roughnesses.
pub(super) fn ladder(path: &Path, bake: &LoadedChain) -> Outcome<Ladder> {
    let levels = &bake.chain.levels;
    let (count, size) = (levels.len() as u32, levels[0].size());
    let fits = |ladder: &Ladder| {
        let mut pairs = (0..count).zip(levels);
        pairs.all(|(k, level)| (ladder.roughness(k, count, size) - level.roughness).abs() < 1e-3)
    };
    let recorded = bake.provenance.ladder.as_deref().and_then(Ladder::named);
    let ladder = recorded.or_else(|| Ladder::ALL.into_iter().find(fits));
    let none = || format!("{} records no ladder, and its roughnesses match none", path.display());
    Ok(ladder.with_context(none)?)
}

/// An error and its channel, as a column of text.
pub(super) fn channel(worst: Greatest) -> String {
    format!("{:.6} {:<5}", worst.error, if worst.of == "luminance" { "lum." } else { worst.of })
}

impl Delivered {
    /// The figures as lines of text, headed by `name`.
    pub(super) fn text(&self, name: &str) -> String {
        let mut text = format!(
            "{name}: look-ups by the ladder {} along {} directions\nroughness     lod   relRMSE   worst \
             channel  greatest error    near the sun\n",
            self.ladder, self.directions
        );
        for error in &self.roughnesses {
            let DeliveredError { roughness, lod, rmse, .. } = error;
            let most = Relative { luminance: error.max_error, channels: error.channel_max_error };
            let near = error.near_sun.map_or_else(|| "-".to_owned(), |near| channel(near.greatest()));
            text += &format!(
                "{roughness:>9.4}  {lod:>6.3}  {:>8.6}  {:>14}  {:>14.4}  {near:>14}\n",
                rmse.luminance,
                channel(rmse.worst_channel()),
                most.greatest().error,
            );
        }
        text
    }
}

/// Checks that the chart `path` can be drawn and written.
#[cfg(feature = "plot")]
pub(super) fn check_chart(path: &Path, force: bool) -> Outcome {
    if let Err(error) = octagloss_plot::figure::Form::from_path(path) {
        return usage(format!("--chart {error}"));
    }
    super::outcome::check_output(path, force).map(drop)
}

#[cfg(not(feature = "plot"))]
pub(super) fn check_chart(_: &Path, _: bool) -> Outcome {
    usage(format!(
        "charts are not part of this build; run: cargo run --release --features plot --{}",
        super::shell::own_arguments()
    ))
}

/// Least error that the chart can show.
#[cfg(feature = "plot")]
const MIN_ERROR: f64 = 1e-6;

/// Draws error over roughness for each of `curves`, named bakes, into the file `path`.
#[cfg(feature = "plot")]
pub(super) fn draw_chart(
    path: &Path,
    existing: Existing,
    curves: &[(&str, &Delivered)],
    against: &Path,
) -> Outcome {
    use super::input::file_name;
    use octagloss_plot::chart::{Axis, Chart, Marks, Scale, Series};

    // File names, or paths where two are alike.
    let short = |name: &str| file_name(Path::new(name));
    let is_alone = |name: &str| curves.iter().filter(|(other, _)| short(other) == short(name)).count() == 1;
    let series = curves.iter().map(|(name, delivered)| Series {
        name: format!(
            "{} ({})",
            if is_alone(name) { short(name) } else { (*name).to_owned() },
            delivered.ladder
        ),
        points: (delivered.roughnesses.iter())
            .map(|error| [error.roughness, error.rmse.greatest().error.max(MIN_ERROR)])
            .collect(),
        marks: if delivered.roughnesses.len() > 20 { Marks::Line } else { Marks::LineAndDots },
        ..Series::default()
    });
    let chart = Chart {
        title: "Error of look-ups over roughness".to_owned(),
        caption: format!(
            "Trilinear look-ups along {DIRECTIONS} directions against GGX lobes of {}: root mean square \
             error over the mean, of luminance or the channel where it is greatest. The ladder that maps \
             roughness to levels stands in brackets.",
            file_name(against)
        ),
        x: Axis { label: "perceptual roughness".to_owned(), range: Some([0.0, 1.0]), scale: Scale::Linear },
        y: Axis { label: "relative RMS error".to_owned(), range: None, scale: Scale::Logarithmic },
        series: series.collect(),
    };
    Ok(chart.write(path, existing)?)
}
