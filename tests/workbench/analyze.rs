//! `octagloss-workbench analyze`.

use glam::DVec3;
use octagloss_core::files::format::Pixel;
use octagloss_core::files::io::environment_write::exact_exr_bytes;
use octagloss_core::files::io::exr::write::{Samples, exr_bytes};
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::sphere::cube::{Face, direction_from_cube};
use octagloss_fixtures::program::{Program, Ran, names, write_panorama};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const PROGRAM: Program = Program(env!("CARGO_BIN_EXE_octagloss-workbench"));

/// Runs a command that must succeed.
pub(crate) fn done(folder: &Path, args: &[&str]) -> Ran {
    PROGRAM.done(folder, args)
}

/// Runs a command that must fail with `code` and one line containing `words`.
pub(crate) fn fails(folder: &Path, args: &[&str], code: i32, words: &str) {
    PROGRAM.fails(folder, args, code, words);
}

/// Writes a cube, which is integrated faster than a panorama.
fn write_cube(path: &Path, radiance: impl Fn(DVec3) -> [f32; 3]) {
    let texels = Face::ALL.iter().flat_map(|face| {
        (0..16)
            .map(|k| [f64::from(k % 4), f64::from(k / 4)].map(|c| (c + 0.5) / 2.0 - 1.0))
            .map(|[s, t]| radiance(direction_from_cube(*face, s, t)))
    });
    let cube = Environment::new(Layout::Cube { size: 4 }, texels.collect()).expect("valid");
    fs::write(path, exact_exr_bytes(&cube, "a cube").expect("valid")).expect("writable");
}

#[test]
fn analyze_prints_one_table_in_three_forms() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    let text = done(folder, &["analyze", "--table"]).out;
    assert!(text.contains("tennis-ball                  14.8  14.80    1.41   1.41     2     2"), "{text}");
    let json: Value = serde_json::from_str(&done(folder, &["analyze", "--json"]).out).expect("JSON");
    let maps = json["maps"].as_array().expect("an array");
    let csv = done(folder, &["analyze", "--csv"]).out;
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let records: Vec<csv::StringRecord> = reader.records().map(|record| record.expect("a record")).collect();
    assert_eq!((maps.len(), records.len()), (16, 16), "fourteen maps and two limits");
    for (map, record) in maps.iter().zip(&records) {
        assert_eq!(map["title"], record[1], "the same order");
        let written: f64 = record[4].parse().expect("a number or inf");
        assert_eq!(map["sampling"].as_f64().unwrap_or(f64::INFINITY), written, "{}", &record[1]);
    }
    fails(folder, &["analyze", "--json", "--csv"], 2, "--csv");
    assert_eq!(names(folder), [""; 0]);
}

#[test]
fn analyze_prints_errors_of_lobes_in_three_forms() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    write_cube(&folder.join("in.exr"), |d| [(1.0 + d.x) as f32; 3]);
    write_cube(&folder.join("other.exr"), |d| [(1.0 + d.y) as f32; 3]);
    let of = |environment: &str, more: &[&str]| {
        let maps = ["--size", "16", "--map", "octahedral", "--map", "tennis-ball", "--roughness", "1"];
        let args = ["analyze", "--lobes", "--panorama", environment];
        done(folder, &[&args, &maps[..], more].concat()).out
    };
    let run = |more: &[&str]| of("in.exr", more);
    let text = run(&[]);
    for words in ["roughness", "octahedral-blended", "tennis-ball", "adaptive", "KiB", "texels"] {
        assert!(text.contains(words), "{text} lacks {words:?}");
    }
    assert!(!text.contains("cube"), "{text}");
    let json: Value = serde_json::from_str(&run(&["--json"])).expect("JSON");
    let rows = json["rows"].as_array().expect("an array");
    assert_eq!(rows.len(), 14, "five rows of maps, three filters, one of them without adaptive queries");
    let csv = run(&["--csv"]);
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let records: Vec<csv::StringRecord> = reader.records().map(|record| record.expect("a record")).collect();
    let errors = rows
        .iter()
        .flat_map(|row| row["errors"].as_array().expect("an array").iter().map(move |error| (row, error)));
    let mut count = 0;
    for ((row, error), record) in errors.zip(&records) {
        assert_eq!([&row["name"], &row["filter"]], [&record[0], &record[2]], "the same order");
        assert_eq!(error["rms"]["sphere"].as_f64(), record[8].parse().ok(), "{record:?}");
        assert_eq!(error["worst"].as_f64(), record[12].parse().ok(), "{record:?}");
        count += 1;
    }
    assert_eq!((count, records.len()), (14, 14), "one roughness");
    let errors = |csv: &str| -> Vec<String> {
        let mut reader = csv::Reader::from_reader(csv.as_bytes());
        reader.records().map(|record| record.expect("a record")[8].to_owned()).collect()
    };
    assert_ne!(errors(&of("other.exr", &["--csv"])), errors(&csv), "another environment");
    let fails = |more: &[&str], words: &str, code: i32| {
        fails(folder, &[&["analyze", "--lobes"], more].concat(), code, words);
    };
    fails(&["--map", "globe"], "globe", 2);
    fails(&["--map", "healpix"], "--map healpix has no rule for boxes", 2);
    fails(&["--size", "0"], "--size 0 must be 8 to 1024 texels", 2);
    fails(&["--size", "8"], "--size 8 leaves no texel to Tennis-ball with border (map tennis-ball)", 2);
    fails(&["--size", "-1"], "'-1' for '--size <N>'", 2);
    write_panorama(&folder.join("black.exr"), 16, |_| [0.0; 3]);
    fails(&["--panorama", "black.exr"], "black.exr: the environment is black", 1);
    fs::remove_file(folder.join("black.exr")).expect("there");
    fails(&["--size", "2000"], "--size 2000 must be 8 to 1024 texels", 2);
    fails(&["--roughness", "0"], "--roughness 0 must be 0.1 to 1", 2);
    fails(&["--table"], "--table", 2);
    fails(&["--plot", "-o", "figures"], "--plot", 2);
    fails(&["--json", "--csv"], "--csv", 2);
    fails(&["--panorama", "none.exr"], "none.exr", 1);
    assert_eq!(names(folder), ["in.exr", "other.exr"]);
}

/// Options of other analyses than the one chosen are named, whatever clap's own rules excuse.
#[test]
fn analyze_names_options_that_it_would_ignore() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    let fails = |more: &[&str], words: &str| fails(folder, &[&["analyze"], more].concat(), 2, words);
    fails(&["--table", "--roughness", "0.5"], "--roughness 0.5 is for --lobes, not for --table; omit it");
    fails(&["--csv", "--roughness", "0.5"], "--roughness 0.5 is for --lobes, not for --table");
    fails(&["--table", "-o", "x"], "--output x is for --plot, not for --table");
    fails(&["--table", "--map", "cube"], "--map cube is for --lobes and --plot, not for --table");
    fails(&["--table", "--size", "8"], "--size 8 is for --lobes and --plot");
    fails(&["--table", "--panorama", "a.exr"], "--panorama a.exr is for --lobes and --plot");
    fails(&["--table", "--quiet"], "--quiet is for --lobes and --plot");
    fails(&["--lobes", "-o", "x"], "--output x is for --plot, not for --lobes");
    fails(&["--lobes", "--figure", "seam"], "--figure seam is for --plot, not for --lobes");
    fails(&["--lobes", "--border", "1"], "--border 1 is for --plot, not for --lobes");
    fails(&["--lobes", "--force"], "--force is for --plot, not for --lobes");
    fails(&["--plot", "-o", "x", "--roughness", "0.5"], "--roughness 0.5 is for --lobes, not for --plot");
    fails(&["--map", "cube"], "analyze has nothing to do; add --table");
    assert_eq!(names(folder), [""; 0]);
}

/// Remedies of reading name options of the program that has them.
#[test]
fn remedies_name_options_that_there_are() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    let exr = |name: &str, width: u32, height: u32, texel: [f32; 3]| {
        let texels = vec![texel; (width * height) as usize];
        let bytes = exr_bytes(width, height, Samples::Rgb(&texels), Pixel::F32, &[]).expect("valid");
        fs::write(folder.join(name), bytes).expect("writable");
    };
    exr("odd.exr", 7, 3, [1.0; 3]);
    exr("nan.exr", 8, 4, [f32::NAN; 3]);
    let lobes = ["analyze", "--lobes", "--panorama"];
    let of = |name: &str, words: &str| fails(folder, &[&lobes[..], &[name]].concat(), 1, words);
    of("odd.exr", "--pad of octagloss convert fills up a partial panorama");
    of("odd.exr", "else resize it, then set --from of octagloss convert");
    of("nan.exr", "--sanitize of octagloss convert repairs NaN and Inf");
}
