//! Plots the errors of lobes over summed-area tables of several maps.

use super::globe::{FRONT, Globe};
use crate::laboratory::measure::{Method, Region, STACK, Settings, default_environment, measure};
use glam::{DVec2, DVec3};
use octagloss_core::analysis::delivered::even_directions;
use octagloss_core::common::error::Result;
use octagloss_drawing::page::{BAR_WIDTH, WIDTH, colour_bar, page};
use octagloss_drawing::scale::LOBE_ERROR;
use octagloss_drawing::scene::Frame;
use octagloss_drawing::style::{INK, LABEL, SMALL, SOFT};
use octagloss_plot::chart::{Axis, Chart, Marks, Scale, Series};
use octagloss_plot::figure::Figure;

/// Root mean square errors of `method` over roughness.
pub(super) fn over_roughness(method: Method, settings: &Settings) -> Result<Figure> {
    let settings = Settings { methods: vec![method], regions: false, ..settings.clone() };
    let rows = measure(&settings, &default_environment()?, &|_, _| {})?;
    let series: Vec<Series> = rows
        .iter()
        .map(|row| Series {
            name: row.subject.title.to_owned(),
            points: row
                .errors
                .iter()
                .map(|error| [error.roughness, error.rms[Region::Sphere as usize] * 100.0])
                .collect(),
            labels: Vec::new(),
            marks: Marks::LineAndDots,
        })
        .collect();
    // Whole decades, so that the axis has at least two ticks.
    let values = || series.iter().flat_map(|series| &series.points).map(|point| point[1].log10());
    let low = values().fold(f64::INFINITY, f64::min).floor();
    let high = values().fold(f64::NEG_INFINITY, f64::max).ceil().max(low + 1.0);
    let range = Some([10_f64.powf(low), 10_f64.powf(high)]);
    let filter = match method {
        Method::Box => "the paper's single box".to_owned(),
        Method::Stack => format!("a stack of {STACK} boxes"),
        Method::Adaptive => format!("adaptive quadrature to {} %", settings.error * 100.0),
    };
    let chart = Chart {
        title: format!("Errors of GGX lobes by {filter}"),
        caption: format!(
            "As column rms of `octagloss analyze --lobes`: luminance against exhaustive integration, in per \
             cent of its mean, over {} directions under {} rotations of 400 lamps. Every map has about {} \
             texels; two octahedral maps, 45\u{b0} apart about y, have half of them each.",
            settings.directions,
            settings.turns,
            settings.size * settings.size
        ),
        x: Axis { label: "roughness".to_owned(), range: None, scale: Scale::Linear },
        y: Axis { label: "rms error, % of the mean".to_owned(), range, scale: Scale::Logarithmic },
        series,
    };
    chart.figure()
}

/// Roughness of [`over_sphere`].
const ROUGHNESS: f64 = 0.5;

/// Rotations of the environment whose errors a point of the sphere averages.
const TURNS: u32 = 8;

/// Errors of the stack of boxes on the sphere, a globe a map.
pub(super) fn over_sphere(settings: &Settings) -> Result<Figure> {
    let title = format!("Errors of a stack of {STACK} boxes at roughness {ROUGHNESS}");
    let points = 2 * settings.directions;
    let settings = Settings {
        turns: TURNS,
        directions: points,
        roughnesses: vec![ROUGHNESS],
        methods: vec![Method::Stack],
        regions: false,
        ..settings.clone()
    };
    let caption = format!(
        "Root mean square over {TURNS} rotations of 400 lamps of the error of GGX's luminance at {points} \
         directions, in per cent of its mean. Each pixel shows the mean of the directions within about \
         6\u{b0}. Dark lines: edges of the map's components; grey: the planes x\u{a0}=\u{a0}0, \
         y\u{a0}=\u{a0}0 and z\u{a0}=\u{a0}0. +X, +Y and +Z face the reader.",
    );
    let rows = measure(&settings, &default_environment()?, &|_, _| {})?;
    let sites = even_directions(points);
    let (radius, row_height) = (118.0, 320.0);
    let (mut scene, body) = page(WIDTH, row_height * rows.len().div_ceil(3) as f64, &title, &caption);
    let room = body.extent().x - BAR_WIDTH - 10.0;
    let mut extremes = [f64::INFINITY, 0.0_f64];
    for (k, row) in rows.iter().enumerate() {
        let (subject, errors) = (row.subject, &row.errors[0].field);
        let x = body.low.x + room * ((k % 3) as f64 + 0.5) / 3.0;
        let top = body.low.y + row_height * (k / 3) as f64;
        let shown = |direction: DVec3| {
            let (mut sum, mut total) = (0.0, 0.0);
            for (site, error) in sites.iter().zip(errors) {
                let closeness = site.dot(direction);
                if closeness > 0.97 {
                    let weight = ((closeness - 1.0) / 0.005).exp();
                    sum += weight * error * error;
                    total += weight;
                }
            }
            if total > 0.0 { (sum / total).sqrt() * 100.0 } else { f64::NAN }
        };
        let globe = Globe::new(DVec2::new(x, top + 56.0 + radius), radius, FRONT);
        globe.show(&mut scene, subject.charts.named().map(), |direction| LOBE_ERROR.colour(shown(direction)));
        let shares = errors.iter().map(|error| error * 100.0);
        let (low, high) =
            shares.fold((f64::INFINITY, 0.0_f64), |(low, high), error| (low.min(error), high.max(error)));
        extremes = [extremes[0].min(low), extremes[1].max(high)];
        scene.centred(DVec2::new(x, top + 10.0), subject.title, LABEL, INK);
        scene.centred(DVec2::new(x, top + 32.0), &format!("{low:.1} to {high:.1} %"), SMALL, SOFT);
    }
    let bar =
        Frame::new(DVec2::new(body.high.x - BAR_WIDTH, body.low.y + 40.0), body.high - DVec2::new(0.0, 40.0));
    colour_bar(&mut scene, &bar, &LOBE_ERROR, "rms error, % of the mean", extremes);
    Ok(Figure::new(title, caption, scene))
}
