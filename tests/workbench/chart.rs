//! Charts.

use crate::figures::elements;
use octagloss_core::files::io::output::Existing;
use octagloss_plot::chart::{Axis, Chart, Marks, Scale, Series};
use octagloss_plot::figure::Form;
use std::fs;
use tempfile::TempDir;

fn chart() -> Chart {
    let series = |name: &str, factor: f64, marks: Marks| Series {
        name: name.to_owned(),
        points: (1..=8).map(|k| [f64::from(k) / 8.0, factor * 10_f64.powi(-k)]).collect(),
        marks,
        ..Series::default()
    };
    Chart {
        title: "Error over roughness".to_owned(),
        caption: "A < B & C".to_owned(),
        x: Axis { label: "roughness".to_owned(), ..Axis::default() },
        y: Axis { label: "relative error".to_owned(), scale: Scale::Logarithmic, ..Axis::default() },
        series: vec![
            series("boxes", 1.0, Marks::Line),
            series("fitted", 0.5, Marks::LineAndDots),
            series("adaptive", 0.1, Marks::Rings),
        ],
    }
}

#[test]
fn a_chart_names_its_axes_and_series() {
    let figure = chart().figure().expect("a chart");
    let texts: Vec<String> = figure.scene.labels().into_iter().map(|(text, _)| text).collect();
    for text in
        ["Error over roughness", "roughness", "relative error", "boxes", "fitted", "adaptive", "0.01", "0.4"]
    {
        assert!(texts.contains(&text.to_owned()), "{text}: {texts:?}");
    }
    for (k, (text, own)) in figure.scene.labels().iter().enumerate() {
        assert!(figure.scene.frame().holds(own), "{text:?} is cut off");
        for (other, others) in &figure.scene.labels()[..k] {
            assert!(!own.overlaps(others), "{text:?} covers {other:?}");
        }
    }
    let svg = String::from_utf8(figure.bytes(Form::Svg)).expect("text");
    assert!(svg.contains("A &lt; B &amp; C"), "escaped");
    assert!(elements(&svg).contains(&"polyline"));
}

#[test]
fn a_chart_is_written_as_its_extension_says() {
    let folder = TempDir::new().expect("a temporary folder");
    let (png, svg) = (folder.path().join("a.png"), folder.path().join("a.SVG"));
    chart().write(&png, Existing::Keep).expect("written");
    chart().write(&svg, Existing::Keep).expect("written");
    let picture = image::load_from_memory(&fs::read(&png).expect("there")).expect("a PNG");
    let scene = chart().figure().expect("a chart").scene;
    assert_eq!([picture.width(), picture.height()], [scene.width, scene.height]);
    elements(&fs::read_to_string(&svg).expect("there"));
    let error = chart().write(&png, Existing::Keep).expect_err("it exists");
    assert!(error.to_string().contains("already exists"), "{error}");
    let error = chart().write(&folder.path().join("a.pdf"), Existing::Keep).expect_err("no format");
    assert!(error.to_string().contains("must end in .png or .svg"), "{error}");
}

#[test]
fn what_an_axis_cannot_show_is_named() {
    let with = |value: f64| {
        let mut chart = chart();
        chart.series[0].points[2][1] = value;
        chart
    };
    for (value, words) in [(f64::NAN, "cannot show NaN"), (0.0, "cannot show 0"), (-1.0, "cannot show -1")] {
        let error = with(value).figure().expect_err(words).to_string();
        assert!(error.contains(words) && error.contains("relative error"), "{error}");
    }
    let figure = with(f64::INFINITY).figure().expect("a lane for infinity");
    assert!(figure.scene.labels().iter().any(|(text, _)| text == "\u{221e}"));
    let mut reversed = chart();
    reversed.x.range = Some([1.0, 0.0]);
    let error = reversed.figure().expect_err("reversed").to_string();
    assert!(error.contains("invalid range 1 to 0"), "{error}");
    // Powers of ten round to either side of the ends of their axis.
    for low in -6..3_i32 {
        let mut decades = chart();
        decades.series.clear();
        decades.y.range = Some([10_f64.powi(low), 10_f64.powi(low + 3)]);
        let ticks = decades.figure().expect("a chart").scene.labels().len();
        decades.y.range = Some([10_f64.powi(low) * 0.999, 10_f64.powi(low + 3) * 1.001]);
        assert_eq!(ticks, decades.figure().expect("a chart").scene.labels().len(), "both ends from 10^{low}");
    }
    let empty = Chart { series: Vec::new(), ..chart() };
    empty.figure().expect("axes alone");
}
