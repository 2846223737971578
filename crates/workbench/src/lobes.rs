//! `octagloss-workbench analyze --lobes`: compares maps as carriers of summed-area tables.

use crate::args::AnalyzeArgs;
use octagloss::cli::console::Console;
use octagloss::cli::outcome::{Failure, Outcome, csv_text, print, print_json, usage};
use octagloss_core::common::error::Error;
use octagloss_workbench::laboratory::measure::{
    ErrorAt, Region, Row, STACK, Settings, check_light, default_environment, measure,
};
use octagloss_workbench::laboratory::subject::SUBJECTS;
use serde_json::{Value, json};
use std::path::Path;

pub(super) fn run(args: &AnalyzeArgs) -> Outcome {
    let settings = settings(args)?;
    let console = Console::new(args.figures.quiet);
    let environment = match args.figures.environment(&console)? {
        Some(environment) => {
            let path = args.figures.panorama.as_deref().unwrap_or(Path::new(""));
            check_light(&environment).map_err(|error| Error::input(path, error.to_string()))?;
            environment
        }
        None => default_environment()?,
    };
    let bar = console.bar("lobes");
    let rows = measure(&settings, &environment, &|done, total| bar.at(done, total))?;
    drop(bar);
    if args.json {
        let rows: Vec<Value> = rows.iter().map(json_row).collect();
        let head = json!({ "size": settings.size, "stack": STACK, "adaptive_error": settings.error });
        return print_json(&json!({ "settings": head, "rows": rows }));
    }
    if args.csv {
        return print(&csv_table(&rows)?);
    }
    print(&text_table(&settings, &rows))
}

fn settings(args: &AnalyzeArgs) -> Outcome<Settings> {
    let mut settings = Settings::default();
    settings.size = args.figures.size.unwrap_or(settings.size);
    if !args.roughness.is_empty() {
        settings.roughnesses.clone_from(&args.roughness);
    }
    for name in &args.figures.map {
        if !SUBJECTS.iter().any(|subject| subject.charts.name() == name) {
            return usage(format!(
                "--map {name} has no rule for boxes; use octahedral, tennis-ball, equirect or cube with \
                 --lobes"
            ));
        }
    }
    let maps = &args.figures.map;
    settings
        .subjects
        .retain(|subject| maps.is_empty() || maps.iter().any(|name| subject.charts.name() == name));
    settings.check().map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(settings)
}

/// `value` of the mean, as a percentage.
fn percent(value: f64) -> String {
    format!("{:.*}", if value < 0.0995 { 2 } else { 1 }, value * 100.0)
}

/// The name of the axis next to a direction, or its coordinates.
fn place((direction, region): &(glam::DVec3, Region)) -> String {
    let near = direction.abs().max_position();
    let axis = ["X", "Y", "Z"][near];
    let sign = if direction[near] < 0.0 { "-" } else { "+" };
    match region {
        Region::Poles | Region::Cones => {
            format!("{:.0}\u{b0} from {sign}{axis}", direction.abs()[near].min(1.0).acos().to_degrees())
        }
        Region::Seams | Region::Sphere => {
            let name = if *region == Region::Seams { "seam " } else { "" };
            format!("{name}{:.2} {:.2} {:.2}", direction.x, direction.y, direction.z)
        }
    }
}

fn text_table(settings: &Settings, rows: &[Row]) -> String {
    let mut text = format!(
        "GGX lobes over exact summed-area tables of about {} texels. Errors of luminance in % of its mean.\n\
         stack: {STACK} nested boxes; adaptive: to {} %. cones: 8\u{b0} around +-X and +-Z; seams: on edges \
         of the map's\ncomponents. reads: table entries a query. octahedral-chosen, -blended: two maps \
         45\u{b0} apart about y.\ntennis-ball-small: its border counts among its texels.\n",
        settings.size * settings.size,
        settings.error * 100.0
    );
    for method in &settings.methods {
        text += &format!(
            "\n{:<24} roughness     rms   poles   cones   seams   worst   reads  {:<24}     KiB\n",
            method.name(),
            "worst at"
        );
        for row in rows.iter().filter(|row| row.method == *method) {
            for (k, error) in row.errors.iter().enumerate() {
                let [sphere, poles, cones, seams] = error.rms.map(percent);
                let line = format!(
                    "{:<24}{:>10}{sphere:>8}{poles:>8}{cones:>8}{seams:>8}{:>8}{:>8.0}  {:<24}{:>8}",
                    if k == 0 { row.subject.name } else { "" },
                    error.roughness,
                    percent(error.worst),
                    error.reads[0],
                    place(&error.worst_at),
                    if k == 0 { (row.bytes / 1024).to_string() } else { String::new() }
                );
                text += &format!("{}\n", line.trim_end());
            }
        }
    }
    text += "\nBuild, least of all turns:  milliseconds to resample and to scan\n";
    for of_map in rows.chunk_by(|a, b| a.subject.name == b.subject.name) {
        let row = &of_map[0];
        let [resample, scan] = row.seconds.map(|seconds| seconds * 1e3);
        text += &format!("{:<24}{:>8} texels{resample:>10.1}{scan:>8.2}\n", row.subject.name, row.texels);
    }
    text
}

fn csv_table(rows: &[Row]) -> Outcome<String> {
    let record = |(row, error): (&Row, &ErrorAt)| {
        let ErrorAt { roughness, rms, worst, worst_at: (direction, region), reads, .. } = error;
        let names = [row.subject.name, row.subject.title, row.method.name()].map(str::to_owned);
        let counts = [row.texels, row.bytes].map(|count| count.to_string());
        let mut record: Vec<String> = names.into_iter().chain(counts).collect();
        let numbers = row.seconds.iter().chain([roughness]).chain(rms).chain([worst]);
        record.extend(numbers.map(f64::to_string));
        record.push(region.name().to_owned());
        record.extend(direction.to_array().iter().chain(reads).map(f64::to_string));
        record
    };
    let header = "name,title,filter,texels,bytes,resample_seconds,scan_seconds,roughness,rms,rms_poles,\
                  rms_cones,rms_seams,worst,worst_region,worst_x,worst_y,worst_z,reads,reads_greatest";
    csv_text(header, rows.iter().flat_map(|row| row.errors.iter().map(move |error| (row, error))).map(record))
}

fn json_row(row: &Row) -> Value {
    let error = |error: &ErrorAt| {
        let [sphere, poles, cones, seams] = error.rms;
        let (direction, region) = error.worst_at;
        json!({
            "roughness": error.roughness,
            "rms": { "sphere": sphere, "poles": poles, "cones": cones, "seams": seams },
            "worst": error.worst,
            "worst_region": region.name(),
            "worst_direction": direction.to_array(),
            "reads": error.reads[0],
            "reads_greatest": error.reads[1],
        })
    };
    json!({
        "name": row.subject.name,
        "title": row.subject.title,
        "filter": row.method.name(),
        "texels": row.texels,
        "bytes": row.bytes,
        "resample_seconds": row.seconds[0],
        "scan_seconds": row.seconds[1],
        "errors": row.errors.iter().map(error).collect::<Vec<_>>(),
    })
}
