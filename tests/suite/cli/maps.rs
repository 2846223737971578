//! `octagloss analyze` and `octagloss convert`.

use crate::cli::{done, fails, names, write_panorama};
use octagloss::internals::format::Pixel;
use octagloss::internals::io::exr::write::{Samples, exr_bytes};
use octagloss::internals::io::{self, ReadOptions};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

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
    write_panorama(&folder.join("x.exr"), 16, |d| [(1.0 + d.x) as f32; 3]);
    write_panorama(&folder.join("y.exr"), 16, |d| [(1.0 + d.y) as f32; 3]);
    // Cubes, which are integrated faster.
    for (panorama, cube) in [("x.exr", "in.exr"), ("y.exr", "other.exr")] {
        done(folder, &["convert", panorama, "-o", cube, "--layout", "cube", "--size", "4"]);
    }
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
    assert_eq!(names(folder), ["in.exr", "other.exr", "x.exr", "y.exr"]);
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

/// Remedies of reading name options that the command has.
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
    let convert = ["convert", "odd.exr", "-o", "x.exr", "--layout", "cube"];
    fails(folder, &convert, 1, "--crop removes black bars; else resize it, then set --from");
    let lobes = ["analyze", "--lobes", "--panorama"];
    let of = |name: &str, words: &str| fails(folder, &[&lobes[..], &[name]].concat(), 1, words);
    of("odd.exr", "--pad of octagloss convert fills up a partial panorama");
    of("odd.exr", "else resize it, then set --from of octagloss convert");
    of("nan.exr", "--sanitize of octagloss convert repairs NaN and Inf");
    fails(folder, &[&convert[..], &["--size", "-1"]].concat(), 2, "'-1' for '--size <N>'");
    fails(folder, &[&convert[..], &["--border", "-1"]].concat(), 2, "'-1' for '--border <B>'");
    fails(folder, &["bake", "odd.exr", "--levels", "-3"], 2, "'-3' for '--levels <N>'");
}

#[test]
fn convert_goes_to_another_map_and_back() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    write_panorama(&folder.join("in.exr"), 64, |d| {
        [(2.0 + d.x) as f32, (2.0 + d.y) as f32, (2.0 + d.z) as f32]
    });
    for (map, size, sides) in
        [("tennis-ball", "24", (72, 48)), ("healpix", "16", (64, 48)), ("cube", "16", (96, 16))]
    {
        let file = format!("{map}.exr");
        done(folder, &["convert", "in.exr", "-o", &file, "--layout", map, "--size", size]);
        assert_eq!(sides_of(&folder.join(&file)), sides, "{map}");
        let back = format!("{map}-back.exr");
        done(folder, &["convert", &file, "--from", map, "-o", &back, "--layout", "equirect", "--size", "32"]);
        let before = io::read(&folder.join("in.exr"), &ReadOptions::default()).expect("readable");
        let after = io::read(&folder.join(&back), &ReadOptions::default()).expect("readable");
        let texels = before.environment.texels().iter().zip(after.environment.texels());
        let worst = texels.flat_map(|(a, b)| (0..3).map(move |c| (a[c] - b[c]).abs())).fold(0.0, f32::max);
        // Two means over texels of at most 0.11, of slopes up to 1.
        assert!(worst < 0.2, "{map}: {worst} off");
    }
    done(
        folder,
        &[
            "convert",
            "in.exr",
            "-o",
            "bordered.hdr",
            "--layout",
            "dual-paraboloid",
            "--size",
            "8",
            "--border",
            "2",
        ],
    );
    assert_eq!(sides_of(&folder.join("bordered.hdr")), (24, 12), "two discs of 8 texels with borders of 2");
}

/// Columns and rows of the picture in a file.
fn sides_of(path: &Path) -> (u32, u32) {
    if path.extension().is_some_and(|extension| extension == "hdr") {
        return image::image_dimensions(path).expect("readable");
    }
    let headers = exr::meta::MetaData::read_from_file(path, false).expect("readable").headers;
    (headers[0].layer_size.x() as u32, headers[0].layer_size.y() as u32)
}

#[test]
fn convert_keeps_light_or_says_how_much_it_loses() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    // Dim light, and a lamp too bright for half floats.
    write_panorama(&folder.join("in.exr"), 32, |d| [3e-9, 1.0, if d.x > 0.95 { 1e5 } else { 0.3 }]);
    let convert = |file: &str, more: &[&str]| {
        let args = ["convert", "in.exr", "-o", file, "--layout", "cube", "--size", "8"];
        done(folder, &[&args[..], more].concat()).err
    };
    let read = |file: &str| {
        let read = io::read(&folder.join(file), &ReadOptions::default()).expect("readable");
        read.environment.texels().to_vec()
    };
    let words = convert("float.exr", &[]);
    assert!(words.contains("f32") && !words.contains("warning"), "{words}");
    let kept = read("float.exr");
    assert!(kept.iter().all(|texel| (texel[0] / 3e-9 - 1.0).abs() < 1e-6), "{:?}", kept[0]);
    let words = convert("half.exr", &["--pixel", "f16"]);
    let lamps = kept.iter().filter(|texel| texel[2] > 65504.0).count();
    assert!(lamps > 0, "a lamp");
    for warning in [
        format!("warning: half.exr: {lamps} texels exceed the f16 maximum of 6.55e4 and were clamped"),
        "warning: half.exr: 384 texels have a channel of at most 3.0e-8 that became 0".to_owned(),
        "--pixel f32 keeps them".to_owned(),
    ] {
        assert!(words.contains(&warning), "{words} lacks {warning}");
    }
    let halves = read("half.exr");
    assert!(halves.iter().all(|texel| texel[0] == 0.0 && texel[2] <= 65504.0));
    // RGBE holds both, but no subnormal numbers, and not twice 1e38.
    assert!(!convert("both.hdr", &[]).contains("warning"));
    let words = convert("bright.hdr", &["--scale", "3e33"]);
    assert!(words.contains("texels exceed the rgbe maximum of 1.69e38"), "{words}");
    let words = convert("dim.hdr", &["--scale", "1e-31"]);
    assert!(words.contains("384 texels have a channel of at most 1.2e-38 that became 0 in rgbe"), "{words}");
}

#[test]
fn convert_names_what_it_cannot_do() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    write_panorama(&folder.join("in.exr"), 16, |_| [1.0; 3]);
    let convert = |more: &[&str], words: &str, code: i32| {
        fails(folder, &[&["convert", "in.exr", "-o", "out.exr"], more].concat(), code, words);
    };
    convert(&["--layout", "globe"], "globe", 2);
    convert(&["--layout", "cube", "--size", "0"], "--size", 2);
    convert(&["--layout", "cube", "--size", "4", "--border", "5"], "--border 5", 2);
    convert(&["--layout", "cube", "--from", "healpix"], "16x8 does not fit healpix, which is 4:3", 1);
    convert(&["--layout", "cube", "--pixel", "bc6h"], "--pixel bc6h is for ktx2 and dds", 2);
    let hdr = ["convert", "in.exr", "-o", "out.hdr", "--layout", "cube", "--pixel", "f16"];
    fails(folder, &hdr, 2, "--pixel cannot be combined with hdr");
    // Refused before it is allocated; the size named fits.
    convert(
        &["--layout", "rhombic-dodecahedron", "--size", "8192"],
        "--size 2432 is the largest that fits",
        1,
    );
    convert(&["--layout", "cube", "--size", "8192", "--border", "8192"], "is the largest that fits", 1);
    fails(folder, &["convert", "in.exr", "-o", "out.png", "--layout", "cube"], 2, ".exr or .hdr");
    fails(folder, &["convert", "in.exr", "-o", "in.exr", "--layout", "cube", "--force"], 2, "is an input");
    assert_eq!(names(folder), ["in.exr"]);
}
