//! `octagloss-workbench analyze`: measures maps of the sphere.

use crate::args::AnalyzeArgs;
use crate::draw;
use crate::lobes;
use octagloss::cli::outcome::{Outcome, csv_text, print, print_json, usage};
use octagloss_workbench::map_table::{Row, rows};
use serde_json::json;

pub(super) fn run(args: &AnalyzeArgs) -> Outcome {
    if !(args.table || args.csv || args.json || args.lobes || args.figures.plot) {
        return usage("analyze has nothing to do; add --table, --lobes, --csv, --json or --plot");
    }
    args.check()?;
    if args.figures.plot {
        return draw::run(&args.figures);
    }
    if args.lobes {
        return lobes::run(args);
    }
    let rows = rows();
    if args.json {
        return print_json(&json!({ "maps": rows }));
    }
    if args.csv {
        return print(&csv_table(&rows)?);
    }
    print(&text_table(&rows))
}

/// `value` with `digits` after the point, or inf.
fn fixed(value: f64, digits: usize) -> String {
    if value.is_finite() { format!("{value:.digits$}") } else { "inf".to_owned() }
}

fn components(row: &Row) -> String {
    row.metrics.components.map_or_else(|| "inf".to_owned(), |count| count.to_string())
}

fn text_table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:39}Y     anisotropy  components       M        texels   used\n\
         {:28}paper   ours   paper   ours paper  ours    ours  least   most      %\n",
        "", ""
    );
    let mut notes = Vec::new();
    for row in rows {
        let metrics = &row.metrics;
        let paper = row.printed.unwrap_or_default();
        let name = row.name.unwrap_or(row.title);
        let name = match row.note {
            Some(note) => {
                notes.push(note);
                format!("{name} [{}]", notes.len())
            }
            None => name.to_owned(),
        };
        let [least, greatest] = metrics.relative_solid_angle;
        text += &format!(
            "{name:<27}{:>6}{:>7}{:>8}{:>7}{:>6}{:>6}{:>8}{:>7}{:>7}{:>7}\n",
            paper.sampling,
            fixed(metrics.sampling, 2),
            paper.anisotropy,
            fixed(metrics.anisotropy, 2),
            paper.components,
            components(row),
            fixed(metrics.lattice, 2),
            fixed(least, 3),
            fixed(greatest, 3),
            fixed(metrics.used * 100.0, 1),
        );
    }
    for (number, note) in (1..).zip(notes) {
        text += &format!("\n[{number}] {note}\n");
    }
    text
}

fn csv_table(rows: &[Row]) -> Outcome<String> {
    let record = |row: &Row| {
        let metrics = &row.metrics;
        let paper = row.printed.unwrap_or_default();
        let [least, greatest] = metrics.relative_solid_angle;
        vec![
            row.name.unwrap_or_default().to_owned(),
            row.title.to_owned(),
            row.source.to_owned(),
            paper.sampling.to_owned(),
            metrics.sampling.to_string(),
            paper.anisotropy.to_owned(),
            metrics.anisotropy.to_string(),
            paper.components.to_owned(),
            components(row),
            metrics.lattice.to_string(),
            least.to_string(),
            greatest.to_string(),
            metrics.used.to_string(),
            row.note.unwrap_or_default().to_owned(),
        ]
    };
    let header = "name,title,source,sampling_printed,sampling,anisotropy_printed,anisotropy,\
                  components_printed,components,lattice,texel_least,texel_greatest,used,note";
    csv_text(header, rows.iter().map(record))
}
