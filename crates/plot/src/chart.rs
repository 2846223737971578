//! Charts of named series over two axes, as PNG and SVG.

use super::figure::{Figure, Form};
use super::look::SERIES;
use glam::DVec2;
use octagloss_core::common::error::{Result, wrong};
use octagloss_core::files::io::output::{Existing, write_file};
use octagloss_drawing::page::{WIDTH, page};
use octagloss_drawing::scene::{Anchor, Frame, Scene};
use octagloss_drawing::style::{Colour, FAINT, INK, LABEL, MARGIN, PAPER, SMALL, SOFT, TINY, rgb};
use plotters::coord::combinators::{IntoLogRange as _, LogCoord};
use plotters::coord::ranged1d::{BoldPoints, Ranged as _};
use plotters::coord::types::RangedCoordf64;
use std::cmp::Ordering;
use std::path::Path;

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Title, above the chart.
    pub title: String,
    /// Caption, below the chart; may be empty.
    pub caption: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Series in drawing order; the legend lists those with a name.
    pub series: Vec<Series>,
}

/// Scale of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Linear.
    #[default]
    Linear,
    /// Logarithmic; values must be above 0.
    Logarithmic,
}

/// An axis of a [`Chart`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Name and unit.
    pub label: String,
    /// Minimum and maximum; by default those of the series.
    pub range: Option<[f64; 2]>,
    /// Its scale.
    pub scale: Scale,
}

/// Style of a series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Marks {
    /// A line through the points.
    #[default]
    Line,
    /// A line with a dot at every point.
    LineAndDots,
    /// Dots.
    Dots,
    /// Rings.
    Rings,
}

/// A series of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Name in the legend; not listed if empty.
    pub name: String,
    /// x and y. Infinite values are drawn beyond a gap at the end of the axis.
    pub points: Vec<[f64; 2]>,
    /// Labels of the first points; empty ones are skipped.
    pub labels: Vec<String>,
    /// Style.
    pub marks: Marks,
}

/// Height of the axes in pixels.
const HEIGHT: f64 = 480.0;

/// Pixels left of the axes, for labels.
const LEFT: f64 = 70.0;

/// Height of a line of the legend in pixels.
const LEGEND_LINE: f64 = 30.0;

/// Pixels of the lane for infinite values.
const LANE: f64 = 46.0;

impl Chart {
    /// Draws the chart.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] if a value or a range cannot be drawn on its axis.
    pub fn figure(&self) -> Result<Figure> {
        let x = Placed::new(&self.x, &self.values(0), "x")?;
        let y = Placed::new(&self.y, &self.values(1), "y")?;
        // Entries of the legend and their places; one that is longer than a line has its own.
        let mut legend = Vec::new();
        let (mut x_of_next, mut lines) = (f64::INFINITY, 0.0);
        for (k, series) in self.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty()) {
            if x_of_next + legend_width(series) > WIDTH - MARGIN {
                (x_of_next, lines) = (MARGIN + LEFT, lines + 1.0);
            }
            legend.push((k, DVec2::new(x_of_next, LEGEND_LINE * (lines - 1.0))));
            x_of_next += legend_width(series);
        }
        let legend_height = LEGEND_LINE * lines;
        let (mut scene, body) = page(WIDTH, HEIGHT + legend_height + 62.0, &self.title, &self.caption);
        let low = body.low + DVec2::new(LEFT, legend_height);
        let frame = Frame::new(low, DVec2::new(body.high.x - 6.0, low.y + HEIGHT));
        for (k, place) in legend {
            let at = place + DVec2::new(0.0, body.low.y + 8.0);
            draw_legend(&mut scene, &self.series[k], colour_of(k), at);
        }
        let place = |point: [f64; 2]| {
            let across = x.at(point[0], frame.low.x, frame.high.x);
            DVec2::new(across, y.at(point[1], frame.high.y, frame.low.y))
        };
        self.draw_axes(&mut scene, &frame, &x, &y);
        // Draw marks twice: labels avoid marks, and their plates must not cover any.
        let draw = |scene: &mut Scene| {
            for (k, series) in self.series.iter().enumerate() {
                draw_series(scene, series, colour_of(k), place);
            }
        };
        draw(&mut scene);
        for series in &self.series {
            for (point, label) in series.points.iter().zip(&series.labels) {
                if !label.is_empty() {
                    scene.label(place(*point), label, TINY, 12.0, &frame);
                }
            }
        }
        if self.series.iter().any(|series| !series.labels.is_empty()) {
            draw(&mut scene);
        }
        Ok(Figure::new(self.title.clone(), self.caption.clone(), scene))
    }

    /// Writes the chart to the file `path`; its extension selects `.png` or `.svg`.
    ///
    /// # Errors
    /// As [`Chart::figure`] and [`write_file`]; [`octagloss_core::common::error::Error::Parameter`] for
    /// another extension.
    pub fn write(&self, path: &Path, existing: Existing) -> Result<()> {
        let form = Form::from_path(path)?;
        let bytes = self.figure()?.bytes(form);
        write_file(path, existing, |file| file.write_all(&bytes))
    }

    fn values(&self, axis: usize) -> Vec<f64> {
        self.series.iter().flat_map(|series| &series.points).map(|point| point[axis]).collect()
    }

    fn draw_axes(&self, scene: &mut Scene, frame: &Frame, x: &Placed, y: &Placed) {
        for (value, text) in x.ticks() {
            let at = x.at(value, frame.low.x, frame.high.x);
            scene.line(vec![DVec2::new(at, frame.low.y), DVec2::new(at, frame.high.y)], 1.0, FAINT);
            scene.text(DVec2::new(at, frame.high.y + 20.0), &text, SMALL, Anchor::Middle, SOFT);
        }
        for (value, text) in y.ticks() {
            let at = y.at(value, frame.high.y, frame.low.y);
            scene.line(vec![DVec2::new(frame.low.x, at), DVec2::new(frame.high.x, at)], 1.0, FAINT);
            let baseline = at + 0.35 * SMALL;
            scene.text(DVec2::new(frame.low.x - 9.0, baseline), &text, SMALL, Anchor::End, SOFT);
        }
        let corner = DVec2::new(frame.low.x, frame.high.y);
        scene.line(vec![frame.low, corner, frame.high], 1.4, INK);
        let middle = (frame.low + frame.high) / 2.0;
        scene.text(DVec2::new(middle.x, frame.high.y + 46.0), &self.x.label, LABEL, Anchor::Middle, INK);
        scene.upwards(DVec2::new(MARGIN + 8.0, middle.y), &self.y.label, LABEL, INK);
    }
}

fn draw_series(scene: &mut Scene, series: &Series, colour: Colour, place: impl Fn([f64; 2]) -> DVec2) {
    let points: Vec<DVec2> = series.points.iter().map(|point| place(*point)).collect();
    if matches!(series.marks, Marks::Line | Marks::LineAndDots) {
        scene.line(points.clone(), 2.2, colour);
    }
    for point in points {
        mark(scene, series.marks, point, colour);
    }
}

fn mark(scene: &mut Scene, marks: Marks, at: DVec2, colour: Colour) {
    match marks {
        Marks::Line => {}
        Marks::LineAndDots => scene.disc(at, 4.2, colour),
        Marks::Dots => scene.disc(at, 5.0, colour),
        Marks::Rings => {
            scene.disc(at, 7.0, PAPER);
            scene.circle(at, 7.0, 1.8, colour);
        }
    }
}

/// Draws the entry of `series` in the legend, from the middle of its left edge on.
fn draw_legend(scene: &mut Scene, series: &Series, colour: Colour, at: DVec2) {
    if matches!(series.marks, Marks::Line | Marks::LineAndDots) {
        scene.line(vec![at, at + DVec2::new(28.0, 0.0)], 2.2, colour);
    }
    mark(scene, series.marks, at + DVec2::new(14.0, 0.0), colour);
    scene.text(at + DVec2::new(36.0, 0.35 * SMALL), &series.name, SMALL, Anchor::Start, INK);
}

/// The colour of series `k`.
const fn colour_of(k: usize) -> Colour {
    rgb(SERIES[k % SERIES.len()])
}

/// Pixels of an entry of the legend, with the gap to the next one.
fn legend_width(series: &Series) -> f64 {
    36.0 + octagloss_drawing::font::text_width(&series.name, SMALL) + 28.0
}

/// An axis with its range.
struct Placed {
    low: f64,
    high: f64,
    scale: Scale,
    /// Whether there is a lane for infinite values.
    lane: bool,
}

impl Placed {
    fn new(axis: &Axis, values: &[f64], name: &str) -> Result<Self> {
        let bad = |value: f64| {
            let below = axis.scale == Scale::Logarithmic && value <= 0.0;
            value.is_nan() || value == f64::NEG_INFINITY || below
        };
        if let Some(value) = values.iter().find(|value| bad(**value)) {
            return wrong(format!("the {name} axis {:?} cannot show {value}", axis.label));
        }
        let lane = values.iter().any(|value| value.is_infinite());
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let low = finite().fold(f64::INFINITY, f64::min);
        let high = finite().fold(f64::NEG_INFINITY, f64::max);
        let [low, high] = match (axis.range, axis.scale) {
            (Some(range), _) => range,
            (None, _) if low > high => [1.0, 2.0],
            (None, Scale::Linear) => {
                let margin = if low < high { 0.05 * (high - low) } else { 1.0 };
                [low - margin, high + margin]
            }
            (None, Scale::Logarithmic) => {
                let margin = if low < high { (high / low).powf(0.05) } else { 10.0 };
                [low / margin, high * margin]
            }
        };
        if low.partial_cmp(&high) != Some(Ordering::Less) || bad(low) || !high.is_finite() {
            return wrong(format!("invalid range {low} to {high} of the {name} axis {:?}", axis.label));
        }
        Ok(Self { low, high, scale: axis.scale, lane })
    }

    /// Position of `value` between the pixels `from` and `to`.
    fn at(&self, value: f64, from: f64, to: f64) -> f64 {
        let whole = (to - from).abs();
        let way = (to - from).signum();
        let room = if self.lane { whole - LANE } else { whole };
        if value.is_infinite() {
            return to - way * LANE * 0.4;
        }
        let share = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Logarithmic => (value / self.low).ln() / (self.high / self.low).ln(),
        };
        from + way * room * share
    }

    /// Values and labels of ticks.
    fn ticks(&self) -> Vec<(f64, String)> {
        // Ends such as 10^-1 may be rounded to either side of their tick.
        let hair = 1e-9;
        let values = match self.scale {
            Scale::Linear => {
                let hair = hair * (self.high - self.low);
                RangedCoordf64::from(self.low - hair..self.high + hair).key_points(BoldPoints(9))
            }
            Scale::Logarithmic => {
                let range = self.low * (1.0 - hair)..self.high * (1.0 + hair);
                let coordinate: LogCoord<f64> = range.log_scale().into();
                coordinate.key_points(BoldPoints(9))
            }
        };
        let room = 1.0 + if self.lane { LANE } else { 0.0 };
        let inside =
            values.into_iter().filter(|value| (-hair..=1.0 + hair).contains(&self.at(*value, 0.0, room)));
        let mut ticks: Vec<(f64, String)> = inside.map(|value| (value, tick_text(value))).collect();
        if self.lane {
            ticks.push((f64::INFINITY, "\u{221e}".to_owned()));
        }
        ticks
    }
}

/// Formats a tick's value: plain if short, else with a power of ten.
fn tick_text(value: f64) -> String {
    let text = if value == 0.0 || (1e-4..1e5).contains(&value.abs()) {
        let digits = format!("{value:.5}");
        digits.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{value:.0e}")
    };
    text.replace('-', "\u{2212}")
}
