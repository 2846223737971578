//! The program on the command line: exit statuses, messages and written files.

pub(super) mod arrays;
mod chains;
pub(super) mod fit;
pub(super) mod folders;
mod frames;
pub(super) mod full;
mod gates;
mod info;
pub(super) mod layouts;
pub(super) mod limits;
mod map_headers;
pub(super) mod maps;
mod messages;
pub(super) mod outputs;
pub(super) mod pictures;
mod pyramid_files;
pub(super) mod roughness_column;
pub(super) mod scale;
mod scan;
pub(super) mod shells;
pub(super) mod skybox;
mod statuses;
pub(super) mod sun;
pub(super) mod targets;
pub(super) mod unchanged;
#[cfg(feature = "view")]
pub(super) mod view;
#[cfg(not(feature = "view"))]
pub(super) mod view_absent;
#[cfg(feature = "view")]
pub(super) mod view_scene;
pub(super) mod worlds;

use octagloss_core::files::format::Pixel;
use octagloss_core::files::io;
use octagloss_core::files::io::exr::write::{Samples, exr_bytes};
use octagloss_fixtures::program::Program;
pub(crate) use octagloss_fixtures::program::{
    Ran, json, json_file, names, with_sky, with_slashes, write_panorama,
};
use serde_json::Value;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

const PROGRAM: Program = Program(env!("CARGO_BIN_EXE_octagloss"));

fn command(folder: &Path, args: &[&str]) -> Command {
    PROGRAM.command(folder, args)
}

pub(crate) fn octagloss(folder: &Path, args: &[&str]) -> Ran {
    PROGRAM.run(folder, args)
}

/// Runs a command that must succeed.
pub(crate) fn done(folder: &Path, args: &[&str]) -> Ran {
    PROGRAM.done(folder, args)
}

/// Runs a command that must fail with `code` and one line containing `words`.
pub(crate) fn fails(folder: &Path, args: &[&str], code: i32, words: &str) {
    PROGRAM.fails(folder, args, code, words);
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().expect("an object").keys().map(String::as_str).collect()
}

/// Removes the keys of `report` that may differ between equal runs with different file names.
fn without_seconds(mut report: Value) -> Value {
    let keys = report.as_object_mut().expect("an object");
    for key in ["seconds", "outputs"] {
        keys.remove(key);
    }
    // Both hold the names of the outputs.
    for key in ["files", "report"] {
        report["fingerprint"].as_object_mut().expect("an object").remove(key);
    }
    for level in report["levels"].as_array_mut().expect("levels") {
        level.as_object_mut().expect("an object").remove("seconds");
    }
    report
}

#[test]
fn help_is_data_and_a_missing_subcommand_is_a_usage_error() {
    let folder = TempDir::new().expect("a temporary folder");
    for args in [&["--help"][..], &["bake", "-h"], &["--version"], &["query", "--help"]] {
        let ran = done(folder.path(), args);
        assert!(ran.out.contains("octagloss") && ran.err.is_empty(), "{args:?}: {}", ran.err);
    }
    fails(folder.path(), &[], 2, "subcommand");
    let words = "cargo run --release -p octagloss-workbench -- analyze --table -o 'all figures'";
    fails(folder.path(), &["analyze", "--table", "-o", "all figures"], 2, words);
}

#[test]
fn usage_errors_exit_with_2_and_write_nothing() {
    let folder = with_sky();
    let bake = |more: &[&'static str]| [&["bake", "sky.exr"], more].concat();
    let query = |more: &[&'static str]| [&["query", "sky.exr", "--directions", "d.csv"], more].concat();
    let cases: Vec<(Vec<&str>, &str)> = vec![
        (vec!["bake"], "<INPUT>"),
        (bake(&["--filter", "gauss"]), "adaptive:E, pyramid, box, reference"),
        (bake(&["--filter", "fitted:4"]), "fitted:K is no more; use pyramid"),
        (bake(&["--filter", "pyramid", "--lobe", "cone"]), "supports ggx only"),
        (bake(&["--filter", "pyramid", "--oem-size", "96"]), "a power of two"),
        (bake(&["--filter", "pyramid", "--bounds"]), "--bounds needs"),
        (bake(&["--filter", "adaptive:0"]), "at least 1e-6, the float32 limit"),
        (bake(&["--filter", "adaptive:NaN"]), "at least 1e-6, the float32 limit"),
        (bake(&["--filter", "adaptive:1"]), "at least 1e-6, the float32 limit"),
        (bake(&["--size", "0"]), "--size"),
        (bake(&["--size", "8", "--levels", "0"]), "--levels"),
        (bake(&["--size", "8", "--levels", "5"]), "4"),
        (bake(&["--lobe", "cosine", "--levels", "3"]), "one level"),
        (bake(&["--lobe", "charlie", "--filter", "box"]), "adaptive:E"),
        (bake(&["--target", "khronos", "--filter", "box"]), "Charlie"),
        (bake(&["--sh-order", "5"]), "2 to 4"),
        (bake(&["--sh-window", "hanning"]), "hanning:W"),
        (bake(&["--sh-window", "lanczos:0"]), "above 0"),
        (bake(&["--filter", "box", "--bounds"]), "--bounds needs"),
        (bake(&["--format", "exr", "-o", "out.ktx2"]), "contradict"),
        (bake(&["--format", "tga"]), "ktx2, ktx, dds, exr, hdr"),
        (bake(&["-o", "out.ktx", "--pixel", "bc6h"]), "ktx does not support --pixel bc6h"),
        (bake(&["--target", "doom"]), "three, filament, bevy"),
        (bake(&["--target", "three,three"]), "names three twice"),
        (bake(&["--target", "filament", "--pixel", "bc6h"]), "ktx files cannot hold bc6h"),
        (bake(&["--target", "bevy", "--format", "hdr"]), "folder of faces"),
        (bake(&["--target", "bevy", "--format", "exr"]), "exr files cannot hold rgb9e5"),
        (bake(&["--target", "bevy", "--size", "8", "--levels", "5"]), "is too many for --size 8"),
        (bake(&["--target", "bevy", "--diffuse", "sh", "--irradiance", "8"]), "omit one"),
        (bake(&["--target", "bevy", "--name", "a/b"]), "without folders"),
        (bake(&["--flip", "x"]), "--target"),
        (bake(&["--format", "ktx2", "-o", "out.PNG"]), "unsupported extension .png"),
        (bake(&["--zzz", "bevy"]), "found; to pass"),
        (bake(&["--format", "exr", "--pixel", "rgb9e5"]), "rgb9e5 is for ktx2 and dds"),
        (bake(&["--format", "hdr", "--pixel", "f16"]), "RGBE"),
        (bake(&["--engine", "npu"]), "auto, cpu, gpu"),
        (bake(&["--engine", "cpu", "--adapter", "llvmpipe"]), "--adapter names a GPU"),
        (bake(&["--threads", "0"]), "--threads"),
        (bake(&["--rotate-y", "NaN"]), "between"),
        (bake(&["--rotate-y", "north"]), "not a number"),
        (bake(&["--oem-size", "0"]), "--oem-size"),
        (bake(&["--irradiance", "0"]), "--irradiance"),
        (bake(&["--preview", "spheres.jpg"]), ".png"),
        (bake(&["--strict", "--sanitize"]), "cannot be used with"),
        (bake(&["sky.exr"]), "would both be written as sky.ktx2"),
        (bake(&["other.exr", "-o", "out.ktx2"]), "folder"),
        (bake(&["other.exr", "--preview", "p.png"]), "one input"),
        (bake(&["other.exr", "--layout", "faces"]), "six files"),
        (bake(&["--out-layout", "parts", "-o", "sky.exr"]), "is an input"),
        (query(&["--roughness", "1.1"]), "between 0 and 1"),
        (query(&["--roughness", "-0.1"]), "between 0 and 1"),
        (query(&["--roughness", "NaN"]), "between 0 and 1"),
        (query(&["--roughness", "0.5", "--lobe", "cosine"]), "no roughness"),
        (query(&["--roughness", "0.5", "--filter", "box", "--bound"]), "--bound needs"),
        (query(&["--roughness", "0.5", "--filter", "box", "--lobe", "charlie"]), "adaptive:E"),
        (query(&["--roughness", "0.5", "--filter", "fitted"]), "use pyramid"),
        (query(&["--roughness", "0.5", "--filter", "pyramid", "--lobe", "phong"]), "supports ggx only"),
        (query(&["--roughness", "0.5", "--filter", "pyramid", "--oem-size", "8"]), "a power of two"),
        (query(&["more.exr", "--roughness", "0.5"]), "one environment"),
        (vec!["compare", "sky.exr"], "<B>"),
        (vec!["compare", "a", "b", "--texels", "0"], "above 0"),
        (vec!["compare", "a", "b", "--fail-above", "-1"], "negative"),
        (vec!["synth"], "<NAME>"),
        (vec!["synth", "moon"], "choose one of"),
        (vec!["synth", "furnace", "-o", "furnace.png"], ".exr or .hdr"),
        (vec!["bench", "--runs", "0"], "--runs"),
        (vec!["bench", "--direct", "--size", "64"], "--size"),
        (vec!["bench", "--direct", "--engine", "cpu"], "--direct"),
    ];
    for (args, words) in cases {
        let args: Vec<&str> = args;
        fails(folder.path(), &args, 2, words);
    }
    assert_eq!(names(folder.path()), ["sky.exr"]);
}

#[test]
fn failures_exit_with_1_and_write_nothing() {
    // Windows says it in the user's language.
    const NO_FILE: &str = if cfg!(windows) { "(os error 2)" } else { "missing.ktx2: No such file" };
    let folder = with_sky();
    fs::write(folder.path().join("text.exr"), "not an image").expect("writable");
    fs::write(folder.path().join("d.csv"), "x,y,z\n0,1,0\n").expect("writable");
    let before = names(folder.path());
    let cases: [(&[&str], &str); 11] = [
        (&["bake", "missing.exr"], "missing.exr"),
        (&["bake", "text.exr"], "text.exr"),
        (&["bake", "sky.exr", "-o", "no/such/place.ktx2"], "no/such"),
        (&["bake", "sky.exr", "--layout", "octahedral"], "sky.exr"),
        (&["bake", "sky.exr", "missing.exr", "-o", "no/such"], "no/such"),
        (&["bake", "sky.exr", "missing.exr", "-o", "d.csv"], "is a file"),
        (&["info", "missing.exr"], "missing.exr"),
        (&["query", "missing.exr", "--directions", "d.csv", "--roughness", "1"], "missing.exr"),
        (&["query", "sky.exr", "--directions", "e.csv", "--roughness", "1"], "e.csv"),
        (&["compare", "missing.ktx2", "sky.exr"], NO_FILE),
        (&["compare", "sky.exr", "sky.exr"], "not a bake"),
    ];
    for (args, words) in cases {
        fails(folder.path(), args, 1, words);
        // For an input that cannot be read, nothing else is reported.
        assert_eq!(octagloss(folder.path(), args).err.lines().count(), 1, "{args:?}");
    }
    assert_eq!(names(folder.path()), before);
}

#[test]
fn a_bake_is_a_ktx2_file_with_a_report_and_a_line() {
    let folder = with_sky();
    let ran = done(folder.path(), &["bake", "sky.exr", "--size", "8"]);
    assert_eq!(ran.out, "");
    assert_eq!(names(folder.path()), ["sky.exr", "sky.ktx2", "sky.ktx2.report.json"]);
    let last = ran.err.lines().last().expect("a line");
    for word in ["sky.ktx2: cube 8, 3 levels, ", " kB, in ", " s on cpu, typical error ", " %; next: "] {
        assert!(last.contains(word), "{last} lacks {word}");
    }
    let chain = io::read_chain(&folder.path().join("sky.ktx2")).expect("a bake");
    let levels: Vec<_> = chain.levels.iter().map(|level| (level.size(), level.roughness)).collect();
    assert_eq!(levels, [(8, 0.0), (4, 0.5), (2, 1.0)]);

    let report = json_file(&folder.path().join("sky.ktx2.report.json"));
    for key in [
        "input", "engine", "adapter", "oem", "levels", "energy", "sh", "repaired", "clamped", "warnings",
        "seconds",
    ] {
        assert!(keys(&report).contains(&key), "no {key}");
    }
    assert_eq!((&report["input"], &report["engine"]), (&"sky.exr".into(), &"cpu".into()));
    assert!(report["adapter"].is_null());
    assert_eq!(report["oem"], serde_json::json!({"size": 64, "border": 0}));
    assert_eq!(
        keys(&report["levels"][1]),
        [
            "level",
            "size",
            "roughness",
            "pixel",
            "engine",
            "seconds",
            "leaves_per_texel",
            "error_bound_max",
            "error_bound_mean",
            "error_bound_p99",
            "error_bound_max_relative",
            "error_bound_mean_relative",
            "error_bound_p99_relative",
            "error_bound_max_channels"
        ]
    );
    assert_eq!(keys(&report["energy"]), ["source", "oem", "relative_difference", "mean_luminance"]);
    assert!(report["energy"]["relative_difference"].as_f64().expect("a number") < 1e-4);
    assert_eq!(report["sh"]["coefficients"].as_array().map(Vec::len), Some(9));
    assert_eq!(keys(&report["repaired"]), ["negative", "nan", "infinite", "negative_energy_share"]);
}

#[test]
fn folders_hold_levels_irradiance_bounds_and_the_report() {
    let folder = with_sky();
    let options = ["--size", "4", "--levels", "2", "--irradiance", "2", "--bounds", "--quiet"];
    for format in ["exr", "hdr"] {
        let args = [&["bake", "sky.exr", "--format", format, "-o", format], &options[..]].concat();
        let ran = done(folder.path(), &args);
        assert_eq!(ran.err, "");
        let names = names(&folder.path().join(format));
        // A mirror has no bound to write.
        assert_eq!(names.len(), 6 + 12 + 6 + 1, "{names:?}");
        for name in ["irradiance_px", "m0_px", "m1_nz"] {
            assert!(names.contains(&format!("{name}.{format}")), "{name} is not in {names:?}");
        }
        assert!(names.contains(&"m1_py_bound.exr".to_owned()), "{names:?}");
        assert!(names.contains(&"report.json".to_owned()), "{names:?}");
        let report = json_file(&folder.path().join(format).join("report.json"));
        assert_eq!(report["levels"].as_array().map(Vec::len), Some(2));
        assert_eq!(report["levels"][1]["roughness"], 1.0);
    }
    let args = [&["bake", "sky.exr", "--preview", "p.png"], &options[..]].concat();
    done(folder.path(), &args);
    let beside = ["p.png", "sky.exr", "sky.irradiance.ktx2", "sky.ktx2", "sky.ktx2.bounds"];
    assert_eq!(names(folder.path())[2..7], beside);
    assert_eq!(names(&folder.path().join("sky.ktx2.bounds")).len(), 6);
}

#[test]
fn an_existing_output_is_kept_unless_forced_and_reported_before_reading() {
    let folder = with_sky();
    for existing in ["missing.ktx2", "missing.ktx2.report.json", "p.png"] {
        fs::write(folder.path().join(existing), "precious").expect("writable");
        let args = ["bake", "missing.exr", "--preview", "p.png"];
        fails(folder.path(), &args, 1, "already exists; --force");
        assert_eq!(fs::read(folder.path().join(existing)).expect("there"), b"precious");
        fs::remove_file(folder.path().join(existing)).expect("there");
    }
    let bake = ["bake", "sky.exr", "--size", "2", "--format", "exr", "-o", "out", "--quiet"];
    done(folder.path(), &bake);
    fails(folder.path(), &bake, 1, "out");
    done(folder.path(), &[&bake[..], &["--force"]].concat());
}

#[test]
fn equal_runs_give_equal_bytes_whatever_the_thread_count() {
    let folder = with_sky();
    let bake = |out: &str, threads: &str| {
        let args = ["bake", "sky.exr", "--size", "16", "-o", out, "--threads", threads, "--quiet"];
        done(folder.path(), &args);
        let path = folder.path().join(out);
        let report = json_file(&folder.path().join(format!("{out}.report.json")));
        (fs::read(path).expect("written"), without_seconds(report))
    };
    assert_eq!(bake("a.ktx2", "1"), bake("b.ktx2", "3"));
}

#[test]
fn json_goes_to_standard_output_one_line_per_input() {
    let folder = with_sky();
    fs::copy(folder.path().join("sky.exr"), folder.path().join("again.exr")).expect("copied");
    let args = ["bake", "sky.exr", "again.exr", "--size", "2", "--json", "-o", "out", "--quiet"];
    let ran = done(folder.path(), &args);
    let inputs: Vec<Value> = ran.out.lines().map(|line| json(line)["input"].clone()).collect();
    assert_eq!(inputs, ["sky.exr", "again.exr"]);
    assert_eq!(names(&folder.path().join("out")), ["again.ktx2", "sky.ktx2"]);
}

#[test]
fn a_folder_whose_report_was_printed_can_be_read_still() {
    let folder = with_sky();
    let bake = ["bake", "sky.exr", "--size", "8", "--quiet", "--format", "exr"];
    done(folder.path(), &[&bake[..], &["-o", "written"]].concat());
    done(folder.path(), &[&bake[..], &["-o", "printed", "--json"]].concat());
    assert!(!names(&folder.path().join("printed")).contains(&"report.json".to_owned()));
    let info = json(&done(folder.path(), &["info", "printed", "--json"]).out);
    let written = json(&done(folder.path(), &["info", "written", "--json"]).out);
    assert_eq!(info["levels"].as_array().map(Vec::len), Some(3));
    for (level, written) in [0, 1, 2].map(|k| (&info["levels"][k], &written["levels"][k])) {
        let roughness = |level: &Value| level["roughness"].as_f64().expect("a number");
        assert!((roughness(level) - roughness(written)).abs() < 1e-6, "{level} {written}");
        assert_eq!(level["mean"], written["mean"]);
    }
    done(folder.path(), &["compare", "printed", "written", "--fail-above", "0", "--quiet"]);
    done(folder.path(), &["bake", "printed", "--size", "2", "-o", "again.ktx2", "--quiet"]);
    fs::create_dir(folder.path().join("empty")).expect("made");
    fails(folder.path(), &["info", "empty"], 1, "a directory without a report.json");
}

#[test]
fn one_failing_input_does_not_stop_the_others() {
    let folder = with_sky();
    fs::write(folder.path().join("bad.exr"), "not an image").expect("writable");
    fails(
        folder.path(),
        &["bake", "bad.exr", "sky.exr", "--size", "2", "-o", "out", "--quiet"],
        1,
        "bad.exr",
    );
    assert_eq!(names(&folder.path().join("out")), ["sky.ktx2", "sky.ktx2.report.json"]);
}

#[test]
fn the_reference_filter_says_how_long_it_will_take() {
    let folder = with_sky();
    let ran = done(folder.path(), &["bake", "sky.exr", "--size", "4", "--filter", "reference"]);
    assert!(ran.err.contains("the reference filter will take about"), "{}", ran.err);
}

#[test]
fn six_files_are_one_cube_under_layout_faces() {
    let folder = TempDir::new().expect("a temporary folder");
    let files = ["c_nz.exr", "c_pz.exr", "c_ny.exr", "c_py.exr", "c_nx.exr", "c_px.exr"];
    for (value, file) in files.iter().enumerate() {
        let texels = [[value as f32; 3]; 16];
        let bytes = exr_bytes(4, 4, Samples::Rgb(&texels), Pixel::F32, &[]).expect("valid");
        fs::write(folder.path().join(file), bytes).expect("writable");
    }
    let args = [&["bake"], &files[..], &["--layout", "faces", "--size", "4", "--quiet"]].concat();
    done(folder.path(), &args);
    let chain = io::read_chain(&folder.path().join("c.ktx2")).expect("a bake");
    // The middle of +X has the value of c_px.exr.
    assert_eq!(chain.levels[0].texels[5], [5.0; 3]);
}

#[test]
fn queries_answer_in_order_and_echo_what_was_typed() {
    let folder = with_sky();
    let directions = "x, y, z\n0, 1.50, 0\n0,0,1\n-1e-200,0,0\n";
    fs::write(folder.path().join("d.csv"), directions).expect("writable");
    let args = ["query", "sky.exr", "--directions", "d.csv", "--roughness", "0.4", "--bound", "--quiet"];
    let ran = done(folder.path(), &args);
    let rows: Vec<&str> = ran.out.lines().collect();
    assert_eq!(rows[0], "x,y,z,r,g,b,bound,bound_r,bound_g,bound_b");
    let values = |row: &str| -> Vec<f64> { row.split(',').map(|v| v.parse().expect("a number")).collect() };
    assert!(rows[1].starts_with("0,1.50,0,") && rows[3].starts_with("-1e-200,0,0,"), "{rows:?}");
    assert!(values(rows[2])[3] > 10.0 * values(rows[1])[3], "the sun is at +Z: {rows:?}");
    assert_eq!(rows.len(), 4);

    // An answer depends neither on the other queries nor on the number of threads.
    let mut command =
        command(folder.path(), &["query", "sky.exr", "--directions", "-", "--roughness", "0.4"]);
    command.args(["--bound", "--threads", "2"]).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.stderr(Stdio::null()).spawn().expect("the program starts");
    child.stdin.take().expect("piped").write_all(b"x,y,z\n0,0,1\n").expect("written");
    let output = child.wait_with_output().expect("it ends");
    let alone = String::from_utf8(output.stdout).expect("text");
    assert_eq!(alone.lines().nth(1), Some(rows[2]));

    let exact = ["query", "sky.exr", "--directions", "d.csv", "--roughness", "0.4", "--filter", "reference"];
    let exact = done(folder.path(), &exact);
    assert_eq!(exact.out.lines().next(), Some("x,y,z,r,g,b"));
    for (near, exact) in rows[1..].iter().zip(exact.out.lines().skip(1)) {
        let (near, exact) = (values(near)[4], values(exact)[4]);
        assert!((near / exact - 1.0).abs() < 0.05, "{near} for {exact}");
    }
}

#[test]
fn bad_directions_are_named_by_line_and_value() {
    let folder = with_sky();
    for (text, words) in [
        ("", "d.csv: empty"),
        ("1,0,0\n", "the header must be x,y,z"),
        ("x,y,z\n1,0,0\n1,zero,0\n", "d.csv: line 3: y is \"zero\", not a number"),
        ("x,y,z\n1,inf,0\n", "line 2: y is inf; it must be finite"),
        ("x,y,z\n1,0,nan\n", "line 2: z is NaN"),
        ("x,y,z\n1,0\n", "line 2 has 2 values"),
        ("x,y,z\n\n0,0,-0\n", "line 3: 0,0,0 is not a direction"),
    ] {
        fs::write(folder.path().join("d.csv"), text).expect("writable");
        let args = ["query", "sky.exr", "--directions", "d.csv", "--roughness", "0.5"];
        fails(folder.path(), &args, 1, words);
    }
}

#[test]
fn a_closed_pipe_is_no_error() {
    let folder = with_sky();
    let rows = "0,1,0\n".repeat(20_000);
    fs::write(folder.path().join("d.csv"), format!("x,y,z\n{rows}")).expect("writable");
    let args = ["query", "sky.exr", "--directions", "d.csv", "--roughness", "0", "--quiet"];
    let mut child = command(folder.path(), &args)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

#[test]
fn info_finds_the_sun_and_the_levels() {
    let folder = with_sky();
    let ran = done(folder.path(), &["info", "sky.exr", "--json"]);
    let info = json(&ran.out);
    assert_eq!((&info["kind"], &info["width"]), (&"environment".into(), &32.into()));
    assert!(info["sun"]["direction"][2].as_f64().expect("a number") > 0.99, "{info}");
    assert!((info["sun"]["azimuth_degrees"].as_f64().expect("a number") - 90.0).abs() < 3.0, "{info}");
    assert_eq!(info["sun"]["peak"], serde_json::json!([500.0, 400.0, 300.0]));
    assert_eq!(info["half_float"]["clipped_texels"], 0);
    let turned = done(folder.path(), &["info", "sky.exr", "--json", "--rotate-y", "90"]);
    assert!(json(&turned.out)["sun"]["direction"][0].as_f64().expect("a number") > 0.99, "{}", turned.out);
    let ran = done(folder.path(), &["info", "sky.exr"]);
    assert!(ran.out.contains("azimuth") && ran.err.is_empty(), "{} {}", ran.out, ran.err);

    done(folder.path(), &["bake", "sky.exr", "--size", "4", "--quiet"]);
    done(folder.path(), &["bake", "sky.exr", "--size", "4", "--quiet", "--format", "exr", "-o", "levels"]);
    for bake in ["sky.ktx2", "levels"] {
        let info = json(&done(folder.path(), &["info", bake, "--json"]).out);
        assert_eq!((&info["kind"], &info["levels"][2]["roughness"]), (&"bake".into(), &1.0.into()));
    }
    assert!(done(folder.path(), &["info", "sky.ktx2"]).out.contains("3 levels"));
}

#[test]
fn info_counts_what_half_floats_clip_and_what_is_no_radiance() {
    let folder = TempDir::new().expect("a temporary folder");
    write_panorama(&folder.path().join("hot.exr"), 16, |d| match d {
        d if d.x > 0.9 => [1e6; 3],
        d if d.x < -0.9 => [f32::NAN, 1.0, 1.0],
        d if d.y < -0.9 => [-1.0, 1.0, 1.0],
        _ => [1.0; 3],
    });
    let info = json(&done(folder.path(), &["info", "hot.exr", "--json"]).out);
    assert!(info["half_float"]["clipped_texels"].as_u64().expect("a count") > 0, "{info}");
    assert!(info["half_float"]["lost_energy_share"].as_f64().expect("a share") > 0.9, "{info}");
    assert!(info["repaired"]["nan"].as_u64().expect("a count") > 0, "{info}");
    assert!(info["repaired"]["negative"].as_u64().expect("a count") > 0, "{info}");
    fails(folder.path(), &["info", "hot.exr", "--strict"], 1, "hot.exr");
    fails(folder.path(), &["bake", "hot.exr"], 1, "--sanitize");
}

#[test]
fn clamped_texels_are_counted_and_reported() {
    let folder = TempDir::new().expect("a temporary folder");
    write_panorama(&folder.path().join("hot.exr"), 16, |d| if d.x > 0.9 { [1e6; 3] } else { [1.0; 3] });
    let ran = done(folder.path(), &["bake", "hot.exr", "--size", "8"]);
    assert!(ran.err.contains("were clamped"), "{}", ran.err);
    let report = json_file(&folder.path().join("hot.ktx2.report.json"));
    assert!(report["clamped"].as_u64().expect("a count") > 0);
    let ran = done(folder.path(), &["bake", "hot.exr", "--size", "8", "--format", "exr", "-o", "hot_levels"]);
    assert!(ran.err.contains("stored as float"), "{}", ran.err);
    let report = json_file(&folder.path().join("hot_levels/report.json"));
    assert_eq!((&report["clamped"], &report["levels"][0]["pixel"]), (&0.into(), &"f32".into()));
    // Neither levels of half floats nor those that are asked to be floats are worth a word.
    write_panorama(&folder.path().join("dim.exr"), 16, |_| [1.0; 3]);
    for more in [&["--format", "exr", "-o", "dim_levels"][..], &["--pixel", "f32"]] {
        let ran = done(folder.path(), &[&["bake", "dim.exr", "--size", "8"], more].concat());
        assert!(!ran.err.contains("stored as float"), "{}", ran.err);
    }
}

#[test]
fn compare_measures_by_the_source_and_by_another_bake() {
    let folder = with_sky();
    let bake = |out: &str, filter: &str| {
        let args =
            ["bake", "sky.exr", "--size", "16", "--levels", "2", "-o", out, "--filter", filter, "--quiet"];
        done(folder.path(), &args);
    };
    bake("good.ktx2", "adaptive:0.005");
    bake("rough.dds", "box");

    let same = json(&done(folder.path(), &["compare", "good.ktx2", "good.ktx2", "--json"]).out);
    assert_eq!((&same["reference"], &same["levels"][1]["rel_rmse"]), (&"bake".into(), &0.0.into()));

    let source = json(&done(folder.path(), &["compare", "good.ktx2", "sky.exr", "--json", "--quiet"]).out);
    assert_eq!((&source["reference"], &source["lobe"]), (&"source".into(), &"ggx".into()));
    assert_eq!(source["skipped"], serde_json::json!([0]));
    for level in source["levels"].as_array().expect("levels") {
        assert!(level["rel_rmse"].as_f64().expect("a number") < 0.05, "{level}");
        assert_eq!(
            keys(level),
            [
                &["level", "size", "roughness", "texels", "rel_rmse", "channel_rel_rmse", "l1", "channel_l1"]
                    [..],
                &["worst", "seam", "reference_seam"]
            ]
            .concat()
        );
        let worst = ["face", "i", "j", "direction", "value", "reference", "relative", "of"];
        assert_eq!(keys(&level["worst"]), worst);
    }

    let args = ["compare", "rough.dds", "good.ktx2", "--picture", "e.png", "--fail-above", "0.01"];
    let ran = octagloss(folder.path(), &args);
    assert_eq!(ran.code, 1, "{}", ran.err);
    assert!(ran.err.contains("is above 0.01") && ran.out.contains("relRMSE"), "{} {}", ran.out, ran.err);
    assert!(names(folder.path()).contains(&"e.png".to_owned()));
    fails(folder.path(), &args, 1, "e.png");
    let all = ["compare", "good.ktx2", "sky.exr", "--picture", "f.png", "--texels", "all", "--quiet"];
    done(folder.path(), &all);

    let bytes = fs::read(folder.path().join("good.ktx2")).expect("written");
    fs::write(folder.path().join("short.ktx2"), &bytes[..bytes.len() / 2]).expect("writable");
    fails(folder.path(), &["compare", "short.ktx2", "good.ktx2"], 1, "short.ktx2: truncated");

    done(folder.path(), &["bake", "sky.exr", "--size", "4", "-o", "small.ktx2", "--quiet"]);
    fails(folder.path(), &["compare", "small.ktx2", "good.ktx2"], 1, "levels");
}

#[test]
fn compare_turns_the_source_as_the_bake_was_turned() {
    let folder = with_sky();
    let args = ["bake", "sky.exr", "--size", "16", "--levels", "2", "--rotate-y", "70", "--mirror"];
    done(folder.path(), &[&args[..], &["-o", "t.ktx2", "--quiet"]].concat());
    done(folder.path(), &["compare", "t.ktx2", "sky.exr", "--fail-above", "0.05", "--quiet"]);
    let away = ["compare", "t.ktx2", "sky.exr", "--rotate-y", "0", "--fail-above", "0.05", "--quiet"];
    assert_eq!(octagloss(folder.path(), &away).code, 1);
}

#[test]
fn synth_writes_what_it_lists() {
    let folder = TempDir::new().expect("a temporary folder");
    let list = done(folder.path(), &["synth", "--list"]).out;
    assert!(list.lines().count() >= 4 && list.contains("furnace"), "{list}");
    done(folder.path(), &["synth", "furnace", "-o", "one.exr"]);
    fails(folder.path(), &["synth", "furnace", "-o", "one.exr"], 1, "already exists");
    let info = json(&done(folder.path(), &["info", "one.exr", "--json"]).out);
    assert_eq!(
        (&info["min"], &info["max"]),
        (&serde_json::json!([1.0, 1.0, 1.0]), &serde_json::json!([1.0, 1.0, 1.0]))
    );
}

#[cfg(feature = "gpu")]
#[test]
fn bench_of_drawing_prints_json() {
    let folder = TempDir::new().expect("a temporary folder");
    let bench = json(&done(folder.path(), &["bench", "--direct", "--runs", "1"]).out);
    assert!(bench["adapter"].as_str().is_some_and(|name| !name.is_empty()));
    assert_eq!(bench["triangles"], 104_992);
    let rows = bench["methods"].as_array().expect("a list");
    let row = |name: &str| rows.iter().find(|row| row["method"] == name).expect("a method");
    let rectangular: Vec<_> = rows.iter().filter(|row| row["layout"] == "rectangular").collect();
    for row in rows {
        assert!(row["over_cube"].as_f64().expect("a number") > 0.0, "{row}");
    }
    assert_eq!((&row("cube")["over_cube"], &row("octants")["pixels"]), (&1.0.into(), &262_144.into()));
    assert_eq!((&row("octants")["differing"], &row("clip mask")["differing"]), (&0.0.into(), &0.0.into()));
    let strict = row("strict split")["differing"].as_f64().expect("a number");
    let corners = row("per corner")["differing"].as_f64().expect("a number");
    assert!(strict < 0.001 && corners > 10.0 * strict, "{strict} and {corners}");
    assert_eq!(row("strict split")["paper_frames_per_second"], 16.0);
    // Next to the octants of their own layout.
    assert_eq!((&rectangular[0]["method"], &rectangular[0]["pixels"]), (&"octants".into(), &262_088.into()));
    for name in ["XZ-split", "edge strip"] {
        assert_eq!(row(name)["layout"], "rectangular");
        let share = row(name)["differing"].as_f64().expect("a number");
        assert!(share > 0.0 && share < 0.01, "{name}: {share}");
    }
    // Lists hold few triangles more than once; few triangles are cut.
    let drawn = |name: &str| row(name)["drawn"].as_u64().expect("a number");
    for name in ["octants", "cube", "strict split", "XZ-split", "edge strip"] {
        assert!((104_993..115_000).contains(&drawn(name)), "{name}: {}", drawn(name));
    }
    assert_eq!((drawn("clip mask"), drawn("whole cube")), (8 * 104_992, 6 * 104_992));
    // All remedies give one picture, which is torn without them.
    for name in ["unwrapped, dropped", "unwrapped, one side", "unwrapped, alpha"] {
        assert_eq!((row(name)["layout"].as_str(), drawn(name)), (Some("tennis ball"), 2 * 104_992));
        assert_eq!((&row(name)["differing"], &row(name)["pixels"]), (&0.0.into(), &262_086.into()));
    }
    let kept = row("unwrapped, kept")["differing"].as_f64().expect("a number");
    assert!(kept > 0.1, "{kept}");
}

#[test]
fn bench_prints_json() {
    let folder = TempDir::new().expect("a temporary folder");
    let bench = json(&done(folder.path(), &["bench", "--size", "64", "--runs", "1"]).out);
    for key in ["version", "machine", "copy", "sat", "oem", "bake", "ratios"] {
        assert!(keys(&bench).contains(&key), "no {key}");
    }
    assert!(bench["ratios"]["sat_over_copy"].as_f64().expect("a number") > 0.0);
}
