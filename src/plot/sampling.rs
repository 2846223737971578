//! Every map by what it costs: sampling requirement against anisotropy.

use super::chart::{Axis, Chart, Marks, Scale, Series};
use super::figure::Figure;
use crate::analysis::map_table::rows;
use crate::error::Result;

pub(super) fn sampling(name: &str) -> Result<Figure> {
    let rows = rows();
    let mut points: Vec<([f64; 2], Vec<&str>)> = Vec::new();
    let close = |a: f64, b: f64| a == b || (a / b - 1.0).abs() < 1e-3;
    for row in &rows {
        let at = [row.metrics.sampling, row.metrics.anisotropy];
        match points.iter_mut().find(|(other, _)| close(other[0], at[0]) && close(other[1], at[1])) {
            Some((_, titles)) => titles.push(row.title),
            None => points.push((at, vec![row.title])),
        }
    }
    let label = |titles: &Vec<&str>| match titles[..] {
        [first, .., last] if titles.iter().all(|title| title.starts_with("Octahedral")) => {
            format!("{first}, {}", last.trim_start_matches("Octahedral "))
        }
        _ => titles.join(", "),
    };
    let y = Series {
        name: "Y: the stretch must not exceed a sample's".to_owned(),
        points: points.iter().map(|(point, _)| *point).collect(),
        labels: points.iter().map(|(_, titles)| label(titles)).collect(),
        marks: Marks::Dots,
    };
    let m = Series {
        name: "M: for ideal, anisotropic reconstruction".to_owned(),
        points: rows.iter().map(|row| [row.metrics.lattice, row.metrics.anisotropy]).collect(),
        labels: Vec::new(),
        marks: Marks::Rings,
    };
    let chart = Chart {
        title: "What maps cost: sampling requirement and anisotropy".to_owned(),
        caption: "Columns Y, M and anisotropy of `octagloss analyze --table`; less of each is better. Y is \
                  equation 6 of the tennis-ball paper, M counts texels that resolve as much as isotropic samples \
                  do. Infinite values lie beyond the gap at the end of their axis."
            .to_owned(),
        x: Axis { label: "sampling requirement".to_owned(), range: Some([10.0, 46.0]), scale: Scale::Linear },
        y: Axis {
            label: "greatest anisotropy".to_owned(),
            range: Some([0.9, 3.3]),
            scale: Scale::Linear,
        },
        series: vec![m, y],
    };
    chart.figure(name)
}
