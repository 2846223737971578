//! `octagloss bake --target` on the command line.

use super::with_slashes;
use octagloss_core::files::format::Pixel;
use octagloss_core::files::io::exr::write::{Samples, exr_bytes};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

pub(crate) fn octagloss(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_octagloss")).current_dir(folder).args(args).output().expect("it starts")
}

pub(crate) fn done(folder: &Path, args: &[&str]) -> String {
    let output = octagloss(folder, args);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    with_slashes(&String::from_utf8(output.stdout).expect("text"))
}

/// Fails with `code` and one line containing `words`, and prints no data.
pub(crate) fn fails(folder: &Path, args: &[&str], code: i32, words: &str) {
    let output = octagloss(folder, args);
    let printed = with_slashes(&String::from_utf8(output.stderr).expect("text"));
    let errors: Vec<&str> = printed.lines().filter(|line| line.starts_with("octagloss: error: ")).collect();
    assert_eq!(output.status.code(), Some(code), "{args:?}: {printed}");
    assert!(errors.len() == 1 && errors[0].contains(words), "{args:?}: {printed} lacks {words:?}");
    assert!(output.stdout.is_empty(), "{args:?}");
}

/// Returns a folder with `a.exr` and `b.exr`, whose brightest texels exceed half floats.
pub(crate) fn with_environments() -> TempDir {
    let folder = TempDir::new().expect("a temporary folder");
    for (name, sun) in [("a.exr", 1e6), ("b.exr", 9e5)] {
        let mut texels = vec![[0.5, 0.4, 0.3]; 32 * 16];
        texels[100] = [sun, sun / 2.0, sun / 4.0];
        let bytes = exr_bytes(32, 16, Samples::Rgb(&texels), Pixel::F32, &[]).expect("valid");
        fs::write(folder.path().join(name), bytes).expect("writable");
    }
    folder
}

/// Lists every file within `folder` by its relative path.
pub(crate) fn tree(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).expect("a folder") {
            let path = entry.expect("readable").path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let within = path.strip_prefix(folder).expect("within").iter();
                found.push(within.map(|name| name.to_str().expect("text")).collect::<Vec<_>>().join("/"));
            }
        }
    }
    found.sort();
    found
}

pub(crate) fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).expect("readable")).expect("JSON")
}

const SMALL: [&str; 4] = ["--size", "32", "--irradiance", "4"];

pub(crate) fn bake<'a>(args: &[&'a str]) -> Vec<&'a str> {
    [&["bake", "a.exr", "--quiet"], args].concat()
}

#[test]
fn a_target_is_a_folder_with_its_files_and_a_report() {
    let folder = with_environments();
    done(folder.path(), &bake(&["--target", "filament", "--size", "32", "-o", "out"]));
    let out = folder.path().join("out");
    assert_eq!(tree(&out), ["a_ibl.ktx", "a_skybox.ktx", "report.json", "sh.txt"]);
    let report = json(&out.join("report.json"));
    let (target, recipe) = (&report["target"], &report["recipe"]);
    assert_eq!((target["name"].as_str(), recipe["flip"].as_str()), (Some("filament"), Some("none")));
    assert_eq!(target["files"], serde_json::json!(["a_ibl.ktx", "a_skybox.ktx", "sh.txt"]));
    assert_eq!(report["recipe"]["format"], "ktx");
    assert!(report["clamped"].as_u64() > Some(0), "the sun is too bright for R11G11B10F");
    // The default is the current folder and the input's name; --name sets the name of the files.
    done(folder.path(), &bake(&["--target", "bevy", "--size", "8", "--name", "dusk"]));
    let files = tree(&folder.path().join("a"));
    assert_eq!(files, ["dusk_diffuse.ktx2", "dusk_specular.ktx2", "report.json"]);
}

#[test]
fn several_targets_and_several_inputs_have_folders_of_their_own() {
    let folder = with_environments();
    let targets = ["--target", "khronos,three", "--filter", "adaptive:0.5"];
    let args = [&["bake", "a.exr", "b.exr", "-o", "out", "--json"], &SMALL[..2], &targets].concat();
    let lines = done(folder.path(), &args);
    let reports: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let names: Vec<&Value> = reports.iter().map(|report| &report["target"]["name"]).collect();
    assert_eq!(names, ["khronos", "three", "khronos", "three"]);
    let files = tree(&folder.path().join("out"));
    assert_eq!(
        files,
        ["a", "b"]
            .map(|stem| {
                [
                    format!("{stem}/khronos/charlie/sheen.ktx2"),
                    format!("{stem}/khronos/ggx/specular.ktx2"),
                    format!("{stem}/khronos/lambertian/diffuse.ktx2"),
                    format!("{stem}/three/{stem}_pmrem.ktx2"),
                    format!("{stem}/three/{stem}_sh.json"),
                ]
            })
            .as_flattened()
    );
}

#[test]
fn equal_runs_write_equal_files() {
    let folder = with_environments();
    for (out, threads) in [("one", "1"), ("four", "4")] {
        let options = ["--target", "three,bevy,filament,khronos,generic", "--threads", threads, "-o", out];
        done(folder.path(), &bake(&[&options[..], &SMALL, &["--filter", "adaptive:0.5"]].concat()));
    }
    let files = tree(&folder.path().join("one"));
    assert_eq!(files, tree(&folder.path().join("four")));
    let mut compared = 0;
    for file in files.iter().filter(|file| !file.ends_with("report.json")) {
        let read = |out: &str| fs::read(folder.path().join(out).join(file)).expect("readable");
        assert_eq!(read("one"), read("four"), "{file}");
        compared += 1;
    }
    assert!(compared > 10, "{compared} files");
}

#[test]
fn an_existing_folder_is_replaced_by_force_and_never_when_others_files_are_in_it() {
    let folder = with_environments();
    let again = |more: &[&'static str]| {
        let coarse = ["--filter", "adaptive:0.5"];
        bake(&[&["--target", "three,khronos", "--size", "16", "-o", "out"], &coarse[..], more].concat())
    };
    done(folder.path(), &again(&[]));
    let before = tree(&folder.path().join("out"));
    fails(folder.path(), &again(&[]), 1, "already exists");
    done(folder.path(), &again(&["--force"]));
    assert_eq!(tree(&folder.path().join("out")), before);
    fs::write(folder.path().join("out/khronos/ggx/notes.txt"), "mine").expect("writable");
    fails(folder.path(), &again(&["--force"]), 1, "khronos/ggx/notes.txt, which no bake wrote");
    fails(folder.path(), &bake(&["--target", "three", "-o", "no/where"]), 1, "no/where");
    fails(folder.path(), &bake(&["--target", "three", "-o", "."]), 2, "holds an input");
    let strays: Vec<String> =
        tree(folder.path()).into_iter().filter(|name| name.contains(".octagloss-")).collect();
    assert_eq!(strays, Vec::<String>::new(), "no partial output may remain");
}

#[test]
fn a_dry_run_lists_what_would_be_written_and_writes_nothing() {
    let folder = with_environments();
    let before = tree(folder.path());
    let printed = done(folder.path(), &bake(&["--target", "bevy", "--size", "64", "--dry-run", "-o", "out"]));
    assert_eq!(
        printed.lines().collect::<Vec<_>>(),
        [
            "out/a_specular.ktx2\trgb9e5 cube 64, 5 levels",
            "out/a_diffuse.ktx2\trgb9e5 irradiance cube 32",
            "out/report.json\treport"
        ]
    );
    assert_eq!(tree(folder.path()), before);
    fails(folder.path(), &["bake", "none.exr", "--target", "bevy", "--dry-run"], 1, "none.exr");
}

#[test]
fn help_says_what_each_target_stands_for() {
    let words: Vec<_> =
        done(Path::new("."), &["bake", "--help"]).split_whitespace().map(str::to_owned).collect();
    let text = words.join(" ");
    for options in [
        "--size 640 --levels 8 --ladder linear --flip none --diffuse none Files: specular.ktx2",
        "--size 512 --levels 6 --ladder linear --diffuse none Files: NAME_oem.ktx2",
        "cube (untested in its engine) --size 1024 --diffuse none Files: NAME_panorama.hdr",
    ] {
        assert!(text.contains(options), "{options}");
    }
}

#[test]
fn too_bright_texels_are_clamped_compressed_or_refused() {
    let folder = with_environments();
    let with = |how: &'static str, out: &'static str| {
        bake(&["--size", "16", "--levels", "1", "-o", out, "--overflow", how])
    };
    let counts = |out: &str| {
        let report = json(&folder.path().join(out));
        [&report["clamped"], &report["compressed"]].map(|count| count.as_u64().unwrap_or(0) > 0)
    };
    done(folder.path(), &with("clamp", "clamped.ktx2"));
    assert_eq!(counts("clamped.ktx2.report.json"), [true, false]);
    done(folder.path(), &with("compress", "compressed.dds"));
    assert_eq!(counts("compressed.dds.report.json"), [false, true]);
    fails(folder.path(), &with("error", "refused.ktx2"), 1, "holds up to 65504");
    let target = ["--target", "filament", "--size", "16", "-o", "out", "--overflow"];
    fails(folder.path(), &bake(&[&target[..], &["error"]].concat()), 1, "target filament: level 0 face");
    assert!(!folder.path().join("refused.ktx2").exists() && !folder.path().join("out").exists());
    done(folder.path(), &bake(&[&target[..], &["compress"]].concat()));
    assert_eq!(counts("out/report.json"), [false, true]);
}
