//! Plots every map's sampling requirement against its anisotropy.

use crate::map_table::rows;
use octagloss_core::common::error::Result;
use octagloss_plot::chart::{Axis, Chart, Marks, Scale, Series};
use octagloss_plot::figure::Figure;

pub(super) fn sampling() -> Result<Figure> {
    let rows = rows();
    let all = rows.iter().map(|row| ([row.metrics.sampling, row.metrics.anisotropy], row.title));
    let (y_points, y_labels) = grouped(all);
    let all = rows.iter().map(|row| ([row.metrics.lattice, row.metrics.anisotropy], row.title));
    let (m_points, mut m_labels) = grouped(all);
    // Label a ring and its dot only once.
    for (point, label) in m_points.iter().zip(&mut m_labels) {
        if y_points.iter().any(|other| is_close(*other, *point)) {
            label.clear();
        }
    }
    let y = Series {
        name: "Y: by the greatest stretch".to_owned(),
        points: y_points,
        labels: y_labels,
        marks: Marks::Dots,
    };
    let m = Series {
        name: "M: by the texels' lattice".to_owned(),
        points: m_points,
        labels: m_labels,
        marks: Marks::Rings,
    };
    let chart = Chart {
        title: "What maps cost: sampling requirement and anisotropy".to_owned(),
        caption: "Columns Y, M and anisotropy of `octagloss analyze --table`; less of each is better. Y is \
                  equation 6 of the tennis-ball paper, M is what texels need where \
                  reconstruction is ideal and may be anisotropic. Rings around dots: M equals Y. Infinite \
                  values lie beyond the gap at the end of their axis."
            .to_owned(),
        x: Axis { label: "sampling requirement".to_owned(), range: Some([10.0, 46.0]), scale: Scale::Linear },
        y: Axis { label: "greatest anisotropy".to_owned(), range: Some([0.9, 3.3]), scale: Scale::Linear },
        series: vec![m, y],
    };
    chart.figure()
}

/// Whether both are drawn at the same position.
fn is_close(a: [f64; 2], b: [f64; 2]) -> bool {
    let close = |a: f64, b: f64| a == b || (a / b - 1.0).abs() < 1e-3;
    close(a[0], b[0]) && close(a[1], b[1])
}

/// Points, with joined titles for coincident ones.
fn grouped<'a>(all: impl Iterator<Item = ([f64; 2], &'a str)>) -> (Vec<[f64; 2]>, Vec<String>) {
    let (mut points, mut labels): (Vec<[f64; 2]>, Vec<String>) = (Vec::new(), Vec::new());
    for (point, title) in all {
        match points.iter().position(|other| is_close(*other, point)) {
            Some(k) => {
                // "Octahedral (rectangular)" after "Octahedral": "Octahedral, rectangular".
                let first = labels[k].split(", ").next().unwrap_or_default().to_owned();
                let more = title.strip_prefix(&first).map(|rest| rest.trim_matches([' ', '(', ')']));
                labels[k] += &format!(", {}", more.unwrap_or(title));
            }
            None => {
                points.push(point);
                labels.push(title.to_owned());
            }
        }
    }
    (points, labels)
}
