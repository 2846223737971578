//! Every file of a bake is read back into its world, for every target, flip, rotation and container.
//!
//! Lobes are radially symmetric, so the first moment of light has the source's direction in every level of a
//! bake. A source with a different moment in each channel reveals every wrong flip and turn.

use crate::cli::targets::{done, fails, tree};
use crate::cli::write_panorama;
use glam::DVec3;
use octagloss::{Environment, Layout, Map};
use octagloss_core::files::format::Pixel;
use octagloss_core::files::io::exr::write::{Samples, exr_bytes};
use octagloss_core::files::io::ktx2::write::ktx2_bytes;
use octagloss_core::files::io::{ReadOptions, load_chain, read};
use octagloss_core::files::target::{Flip, TARGETS, flipped};
use octagloss_core::light::chain::{Chain, Level};
use octagloss_core::sphere::equirect::direction_from_equirect;
use octagloss_fixtures::common::sweep;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Greatest error of a moment, in degrees: texels of small levels are wide.
const MAX: f64 = 5.0;

/// Directions of the source's red, green and blue lamps.
const LAMPS: [DVec3; 3] =
    [DVec3::new(0.6, 0.48, 0.64), DVec3::new(-0.36, -0.48, 0.8), DVec3::new(0.64, -0.6, -0.48)];

fn source() -> Environment {
    let layout = Layout::Panorama { width: 32, height: 16 };
    let texels = (0..16)
        .flat_map(|j| (0..32).map(move |i| layout.direction_from_texel(0, i, j)))
        .map(|d| LAMPS.map(|lamp| (0.05 + 4.0 * (8.0 * (lamp.dot(d) - 1.0)).exp()) as f32))
        .collect();
    Environment::new(layout, texels).expect("sound")
}

/// Returns a folder with the source as `a.exr`.
fn with_source() -> TempDir {
    let folder = TempDir::new().expect("a temporary folder");
    let source = source();
    let bytes = exr_bytes(32, 16, Samples::Rgb(source.texels()), Pixel::F32, &[]).expect("valid");
    fs::write(folder.path().join("a.exr"), bytes).expect("writable");
    folder
}

/// Returns the direction of each channel's first moment.
fn moments(environment: &Environment) -> [DVec3; 3] {
    let mut sums = [DVec3::ZERO; 3];
    environment.for_each_texel(|direction, solid_angle, radiance| {
        for (sum, value) in sums.iter_mut().zip(radiance) {
            *sum += direction * solid_angle * f64::from(value);
        }
    });
    sums.map(DVec3::normalize)
}

fn moments_of(level: &Level) -> [DVec3; 3] {
    moments(&Environment::new(level.layout, level.texels.clone()).expect("sound"))
}

/// Returns the greatest angle between two worlds' moments, in degrees.
fn angle(a: [DVec3; 3], b: [DVec3; 3]) -> f64 {
    let angles = a.iter().zip(b).map(|(a, b)| a.dot(b).clamp(-1.0, 1.0).acos().to_degrees());
    angles.fold(0.0, f64::max)
}

/// Rotation and mirroring of the source.
#[derive(Clone, Copy, Debug)]
struct Turn(&'static [&'static str]);

const TURNS: [Turn; 5] = [
    Turn(&[]),
    Turn(&["--rotate-y", "90"]),
    Turn(&["--rotate-y", "37"]),
    Turn(&["--mirror", "--rotate-y", "37"]),
    Turn(&["--mirror"]),
];

impl Turn {
    /// Returns the moments in the world of the bake.
    fn world(self) -> [DVec3; 3] {
        let mut world = source();
        if self.0.contains(&"--mirror") {
            world = world.mirrored();
        }
        if let Some(at) = self.0.iter().position(|word| *word == "--rotate-y") {
            world = world.rotated_y(self.0[at + 1].parse().expect("a number")).expect("an angle");
        }
        moments(&world)
    }
}

/// Bakes `a.exr` into `out`, with a tiny OEM.
fn bake(folder: &Path, out: &str, args: &[&str]) {
    let common = ["bake", "a.exr", "-o", out, "--force", "--quiet", "--engine", "cpu", "--oem-size", "32"];
    done(folder, &[&common[..], args].concat());
}

/// Reads everything in `folder/out`, and the folder itself if `is_whole`, and compares it with `world`.
/// Returns the number of files read.
fn check(folder: &Path, out: &str, is_whole: bool, world: [DVec3; 3], what: &str) -> usize {
    let at = folder.join(out);
    let mut paths: Vec<_> =
        if at.is_dir() { tree(&at).iter().map(|name| at.join(name)).collect() } else { Vec::new() };
    if is_whole {
        paths.push(at);
    }
    let mut count = 0;
    for path in paths {
        let name = path.file_name().and_then(|name| name.to_str()).expect("a name").to_owned();
        // A single face is not an environment.
        if name.contains("_px.") || name.contains("_nx.") || name.contains("_py.") || name.contains("_ny.") {
            continue;
        }
        if name.contains("_pz.") || name.contains("_nz.") {
            continue;
        }
        let unreadable = [".json", ".txt", ".wgsl", ".glsl", ".hlsl", ".env", ".glb"];
        let loaded = read(&path, &ReadOptions::default());
        if unreadable.iter().any(|end| name.ends_with(end)) {
            let error = loaded.expect_err("cannot be read").to_string();
            assert!(error.contains(&name) && error.contains("can be read"), "{what}: {error}");
            continue;
        }
        let loaded = loaded.unwrap_or_else(|error| panic!("{what}: {error}"));
        // A Charlie lobe is a band with a small first moment; a wrong turn is off by 20 degrees and more.
        let most = if name.starts_with("sheen") { 12.0 } else { MAX };
        let off = angle(moments(&loaded.environment), world);
        assert!(off < most, "{what}: {name} is {off} degrees off its world");
        if let Ok(bake) = load_chain(&path) {
            for (index, level) in bake.chain.levels.iter().enumerate() {
                let off = angle(moments_of(level), world);
                assert!(off < most, "{what}: level {index} of {name} is {off} degrees off its world");
            }
        }
        count += 1;
    }
    count
}

fn names(pick: impl Fn(&octagloss_core::files::target::Target) -> bool) -> String {
    let picked = TARGETS.iter().filter(|target| pick(target)).map(|target| target.name);
    picked.collect::<Vec<_>>().join(",")
}

/// Targets of cubes that may be tiny and have any number of levels.
fn small_cubes() -> String {
    names(|target| {
        target.map == Map::Cube && target.has_container() && !target.has_sheen() && target.name != "unity"
    })
}

/// Options of the least bake for Unity.
const SEVEN_LEVELS: [&str; 4] = ["--size", "64", "--filter", "pyramid"];

/// Options of tiny bakes.
const TINY: [&str; 4] = ["--size", "8", "--filter", "adaptive:0.02"];

/// The same with two levels, for outputs that may have fewer than all.
const TWO_LEVELS: [&str; 6] = ["--size", "8", "--filter", "adaptive:0.02", "--levels", "2"];

#[test]
fn a_wrong_flip_is_detected() {
    let world = moments(&source());
    let cube = |flip: Flip| {
        let layout = Layout::Cube { size: 8 };
        let mut texels = Vec::new();
        for (k, j, i) in (0..6).flat_map(|k| (0..8).flat_map(move |j| (0..8).map(move |i| (k, j, i)))) {
            let d = flip.apply(layout.direction_from_texel(k, i, j));
            texels.push(LAMPS.map(|lamp| (0.05 + 4.0 * (8.0 * (lamp.dot(d) - 1.0)).exp()) as f32));
        }
        Chain { levels: vec![Level::cube(8, 0.0, texels)] }
    };
    assert!(angle(moments_of(&cube(Flip::None).levels[0]), world) < MAX);
    for flip in [Flip::X, Flip::Z] {
        assert!(angle(moments_of(&cube(flip).levels[0]), world) > 20.0, "{flip:?}");
    }
    for turn in &TURNS[1..] {
        assert!(angle(turn.world(), world) > 20.0, "{turn:?}");
    }
}

#[test]
fn targets_come_back_to_their_world_whatever_the_flip_and_the_turn() {
    let folder = with_source();
    let cubes = small_cubes();
    let others = names(|target| target.map != Map::Cube && !target.has_pyramid());
    let diffuse = ["--irradiance", "4"];
    let mut count = 0;
    for (k, turn) in TURNS.into_iter().enumerate() {
        // Every flip with two turns or more, one of them mirrored.
        let flips = [&[][..], &["--flip", "none"], &["--flip", "x"], &["--flip", "z"]];
        let (first, step) = sweep((k % 2, 2), (0, 1));
        for flip in flips.into_iter().skip(first).step_by(step) {
            bake(
                folder.path(),
                "out",
                &[&TWO_LEVELS[..], &["--target", &cubes], &diffuse, turn.0, flip].concat(),
            );
            count += check(folder.path(), "out", false, turn.world(), &format!("{turn:?} {flip:?}"));
        }
        bake(folder.path(), "out", &[&SEVEN_LEVELS[..], &["--target", "unity"], &diffuse, turn.0].concat());
        count += check(folder.path(), "out", false, turn.world(), &format!("{turn:?} unity"));
        bake(folder.path(), "out", &[&TINY[..], &["--target", &others], turn.0].concat());
        count += check(folder.path(), "out", false, turn.world(), &format!("{turn:?} {others}"));
    }
    // Two files each of generic, three and bevy, three of filament; two of unity; oem and three panoramas.
    assert_eq!(count, TURNS.len() * (sweep(2, 4) * 9 + 2 + 4));
    // Sheen lobes take seconds at a tighter error.
    let sheen = names(octagloss_core::files::target::Target::has_sheen);
    let args =
        ["--size", "8", "--levels", "2", "--filter", "adaptive:0.1", "--irradiance", "4", "--flip", "x"];
    bake(folder.path(), "out", &[&args[..], &["--target", &sheen], TURNS[3].0].concat());
    assert_eq!(check(folder.path(), "out", true, TURNS[3].world(), &sheen), 4);
}

#[test]
fn targets_come_back_to_their_world_whatever_the_container() {
    let folder = with_source();
    let turn = TURNS[3];
    for format in ["ktx2", "ktx", "dds", "exr"] {
        for flip in ["x", "z"] {
            for (target, diffuse) in [("generic", "both"), ("bevy", "cube")] {
                let args = ["--target", target, "--format", format, "--flip", flip, "--pixel", "f16"];
                let args =
                    [&TWO_LEVELS[..], &args, turn.0, &["--diffuse", diffuse, "--irradiance", "4"]].concat();
                let what = format!("{target} {format} {flip}");
                bake(folder.path(), "out", &args);
                // The specular cube, the irradiance and the folder.
                assert_eq!(check(folder.path(), "out", true, turn.world(), &what), 3, "{what}");
            }
        }
    }
    bake(folder.path(), "out", &[&TINY[..], &["--target", "oem", "--format", "exr"], turn.0].concat());
    assert_eq!(check(folder.path(), "out", true, turn.world(), "oem exr"), 2);
    // A DDS file contains its flip without its report, but not the roughness of its levels.
    bake(folder.path(), "out", &[&SEVEN_LEVELS[..], &["--target", "unity", "--json"], turn.0].concat());
    assert_eq!(check(folder.path(), "out", true, turn.world(), "unity without a report"), 2);
    fails(
        folder.path(),
        &["compare", "out/a_specular.dds", "a.exr"],
        1,
        "the roughness of its levels is unknown",
    );
}

#[test]
fn layouts_come_back_to_their_world() {
    let folder = with_source();
    let turn = TURNS[3];
    let bakes: [&[&str]; 13] = [
        &["--format", "ktx2"],
        &["--format", "ktx"],
        &["--format", "dds"],
        &["--format", "exr"],
        &["--format", "hdr"],
        &["--out-layout", "cross"],
        &["--out-layout", "cross-vertical", "--format", "hdr"],
        &["--out-layout", "strip"],
        &["--out-layout", "strip-vertical", "--format", "hdr"],
        &["--out-layout", "octahedral", "--format", "hdr"],
        &["--out-layout", "equirect"],
        &["--out-layout", "parts"],
        &["--out-layout", "mips"],
    ];
    for args in bakes {
        let out = if args.contains(&"mips") || args.contains(&"parts") { "out.exr" } else { "out" };
        for report in [&[][..], &["--json"]] {
            let what = format!("{args:?} {report:?}");
            let _ = fs::remove_dir_all(folder.path().join("out"));
            let _ = fs::remove_file(folder.path().join("out"));
            let _ = fs::remove_file(folder.path().join("out.report.json"));
            // MIP maps have all levels, and the corners of a tiny octahedral square are wide.
            let size = match args[1] {
                "mips" => &TINY[..],
                "octahedral" => &["--size", "32", "--filter", "adaptive:0.02", "--levels", "2"],
                _ => &TWO_LEVELS,
            };
            bake(folder.path(), out, &[size, args, turn.0, report].concat());
            assert!(check(folder.path(), out, true, turn.world(), &what) >= 1, "{what}");
        }
    }
}

#[test]
fn compare_gives_the_source_the_turns_and_the_sun_of_the_bake() {
    let folder = with_source();
    // A bright sun, so that the comparison fails unless it is extracted.
    let sun = direction_from_equirect(85.5 / 128.0, 20.5 / 64.0);
    write_panorama(&folder.path().join("a.exr"), 128, |d| {
        let is_lit = d.dot(sun) > 0.999_99;
        if is_lit { [9000.0, 8000.0, 7000.0] } else { [1.0 + d.x as f32, 1.5 + d.y as f32, 1.2 - d.z as f32] }
    });
    let cubes = small_cubes();
    let args = ["--levels", "3", "--target", &cubes, "--extract-sun", "--rotate-y", "37", "--mirror"];
    bake(folder.path(), "out", &[&["--size", "16", "--irradiance", "4"], &args[..]].concat());
    let compare = |bake: &str| {
        let args = ["compare", bake, "a.exr", "--texels", "12", "--fail-above", "0.3", "--quiet"];
        done(folder.path(), &args);
    };
    for name in tree(&folder.path().join("out")) {
        if [".ktx2", ".ktx", ".dds"].iter().any(|end| name.ends_with(end)) && !name.contains("skybox") {
            compare(&format!("out/{name}"));
        }
    }
    compare("out/bevy");
    for (format, out) in [("hdr", "faces"), ("dds", "one.dds"), ("ktx", "one.ktx")] {
        let sampled = ["--size", "16", "--chain", "sampled", "--format", format];
        bake(folder.path(), out, &[&sampled, &args[4..]].concat());
        compare(out);
    }
    // A report of another file is ignored, which leaves the DDS file's orientation unknown.
    let report = folder.path().join("one.dds.report.json");
    let text = fs::read_to_string(&report).expect("readable");
    bake(folder.path(), "one.dds", &["--size", "16", "--format", "dds"]);
    fs::write(&report, text).expect("writable");
    fails(
        folder.path(),
        &["compare", "one.dds", "a.exr"],
        1,
        "one.dds: the roughness of its levels is unknown",
    );
}

#[test]
fn what_cannot_be_read_is_named_by_every_command() {
    let folder = with_source();
    bake(folder.path(), "out", &[&TINY[..], &["--target", "babylon,gltf-ext,oem"]].concat());
    bake(folder.path(), "atlas", &["--size", "32", "--filter", "adaptive:0.5", "--target", "playcanvas"]);
    fs::write(folder.path().join("directions.csv"), "x,y,z\n1,0,0\n").expect("writable");
    let query = ["--directions", "directions.csv", "--roughness", "0.5"];
    for (path, words) in [
        ("out/babylon/a_ibl.env", "out/babylon/a_ibl.env: a Babylon.js .env"),
        ("out/babylon", "out/babylon/a_ibl.env: a Babylon.js .env"),
        ("atlas/a_envatlas.png", "atlas/a_envatlas.png: a PlayCanvas atlas"),
        ("atlas", "atlas/a_envatlas.png: a PlayCanvas atlas"),
        ("out/gltf-ext/a_ibl.glb", "a_ibl.glb: a binary glTF"),
        ("out/oem/a_sh.json", "a_sh.json: JSON"),
        ("out/oem/oem.wgsl", "oem.wgsl: not an image"),
        ("out", "out: it holds the folders of targets (babylon, gltf-ext, oem); name one of them"),
    ] {
        if path.ends_with("sh.json") {
            fs::write(folder.path().join(path), "{\"order\": 2}").expect("writable");
        }
        fails(folder.path(), &[&["query", path], &query[..]].concat(), 1, words);
        // `info` says what it is.
        if path == "out" {
            fails(folder.path(), &["info", path], 1, words);
        } else {
            done(folder.path(), &["info", path]);
        }
        fails(folder.path(), &["bake", path, "-o", "again.ktx2"], 1, words);
        // The path is named; a file without levels is not a bake.
        // A folder of several bakes is compared bake by bake.
        if path != "out" {
            fails(folder.path(), &["compare", path, "a.exr"], 1, words.split(": ").next().expect("a path"));
        }
        #[cfg(feature = "view")]
        fails(folder.path(), &["view", path, "--screenshot", "a.png"], 1, words);
    }
}

#[test]
fn info_describes_a_bake() {
    let folder = with_source();
    let args = ["--target", "three", "--rotate-y", "37", "--mirror", "--extract-sun", "--levels", "2"];
    bake(folder.path(), "out", &[&TINY[..], &args].concat());
    let text = done(folder.path(), &["info", "out/a_pmrem.ktx2"]);
    for words in [
        "out/a_pmrem.ktx2: bake, 2 levels",
        "format      KTX2 cube, RGBA16F, 2 levels",
        "target      three",
        "flip        x",
        "rotation    37 degrees about +Y",
        "mirrored    yes",
        "lobe        ggx",
        "filter      adaptive:0.02",
        "ladder      filament",
        "size        ",
    ] {
        assert!(text.contains(words), "{words:?} is missing in {text}");
    }
    let length = fs::metadata(folder.path().join("out/a_pmrem.ktx2")).expect("a file").len();
    for path in ["out/a_pmrem.ktx2", "out"] {
        let info: serde_json::Value =
            serde_json::from_str(&done(folder.path(), &["info", path, "--json"])).expect("JSON");
        assert_eq!((&info["target"], &info["flip"]), (&"three".into(), &"x".into()), "{path}");
        assert_eq!((&info["rotate_y"], &info["mirror"]), (&37.0.into(), &true.into()), "{path}");
        assert_eq!((&info["lobe"], &info["filter"]), (&"ggx".into(), &"adaptive:0.02".into()), "{path}");
        assert_eq!(info["levels"].as_array().map(Vec::len), Some(2), "{path}");
        let bytes = info["bytes"].as_u64().expect("a number");
        assert!(if path == "out" { bytes > length } else { bytes == length }, "{path}: {bytes}");
    }
    // A panorama of a target is an environment with a stated origin.
    bake(folder.path(), "sky", &[&TINY[..], &["--target", "godot", "--rotate-y", "90"]].concat());
    let info: serde_json::Value =
        serde_json::from_str(&done(folder.path(), &["info", "sky", "--json"])).expect("JSON");
    assert_eq!((&info["kind"], &info["origin"]["target"]), (&"environment".into(), &"godot".into()));
    assert_eq!((&info["origin"]["quarter_turns"], &info["origin"]["rotate_y"]), (&3.into(), &90.0.into()));
}

#[test]
fn a_report_of_another_folder_is_an_error() {
    let folder = with_source();
    let levels = ["--format", "exr", "--size", "16", "--levels", "3", "--filter", "box"];
    for ladder in ["linear", "filament"] {
        bake(folder.path(), ladder, &[&levels[..], &["--ladder", ladder]].concat());
        done(folder.path(), &["info", ladder]);
    }
    fs::copy(folder.path().join("filament/report.json"), folder.path().join("linear/report.json"))
        .expect("copied");
    for command in ["info", "query"] {
        let query = ["query", "linear", "--directions", "d.csv", "--roughness", "1"];
        let args = if command == "info" { &["info", "linear"][..] } else { &query[..] };
        fs::write(folder.path().join("d.csv"), "x,y,z\n1,0,0\n").expect("writable");
        fails(folder.path(), args, 1, "belongs to another bake");
    }
}

/// Keeps only the keys of `value` in `kept`.
fn keep(value: &mut serde_json::Value, kept: &[&str]) {
    value.as_object_mut().expect("an object").retain(|key, _| kept.contains(&key.as_str()));
}

/// Converts the report `path` to version 0.1: without a schema version, file hashes, sizes and later options.
fn make_report_old(path: &Path) {
    let mut report = crate::cli::json_file(path);
    let mut options = report["recipe"].take();
    options["extract_sun"] = (!options["extract_sun"].is_null()).into();
    options["layout"] = "panorama".into();
    if report["target"].is_object() {
        report["target"]["flip"] = options["flip"].take();
        report["target"]["diffuse"] = options["diffuse"].take();
    }
    report["options"] = options;
    let kept = [
        "generator",
        "input",
        "engine",
        "adapter",
        "oem",
        "levels",
        "energy",
        "sh",
        "sun",
        "repaired",
        "clamped",
        "warnings",
        "options",
        "conventions",
        "target",
        "fingerprint",
        "seconds",
    ];
    keep(&mut report, &kept);
    report["generator"] = "octagloss 0.1.0".into();
    let kept = [
        "size",
        "ladder",
        "lobe",
        "filter",
        "format",
        "pixel",
        "layout",
        "rotate_y",
        "mirror",
        "sanitize",
        "extract_sun",
        "irradiance",
    ];
    keep(&mut report["options"], &kept);
    keep(&mut report["fingerprint"], &["request", "outputs"]);
    if report["target"].is_object() {
        keep(&mut report["target"], &["name", "flip", "diffuse", "verified", "files"]);
    }
    fs::write(path, report.to_string()).expect("writable");
}

/// Converts the KTX2 file `path` to version 0.1, without rotation, mirror and ladder.
fn make_ktx2_old(path: &Path, flip: Flip, target: Option<&str>) {
    let bake = load_chain(path).expect("a bake");
    let mut pairs = vec![
        ("octaglossConventions", "right-handed, y up"),
        ("octaglossFilter", "adaptive:0.02"),
        ("octaglossLobe", "ggx"),
    ];
    if let Some(target) = target {
        pairs.extend([("octaglossTarget", target), ("octaglossFlip", flip.name())]);
    }
    let pairs: Vec<_> = pairs.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let bytes = ktx2_bytes(&flipped(&bake.chain.levels, flip), Pixel::F16, &pairs).expect("valid");
    assert!(fs::read(path).expect("readable").len() > bytes.len(), "the old file must be shorter");
    fs::write(path, bytes).expect("writable");
}

#[test]
fn files_of_version_0_1_come_back_to_their_world() {
    let folder = with_source();
    let at = |name: &str| folder.path().join(name);
    let turn = TURNS[3];
    let compare = |bake: &str| {
        let args = ["compare", bake, "a.exr", "--texels", "12", "--fail-above", "0.3"];
        let ran = crate::cli::done(folder.path(), &args);
        assert!(!ran.err.contains("does not record its source"), "{bake}: {}", ran.err);
    };
    for (flip, name) in [(Flip::None, "none"), (Flip::X, "x"), (Flip::Z, "z")] {
        let args =
            [&TWO_LEVELS[..], &["--target", "generic", "--pixel", "f16", "--flip", name], turn.0].concat();
        bake(folder.path(), "cube", &args);
        make_ktx2_old(&at("cube/specular.ktx2"), flip, Some("generic"));
        make_report_old(&at("cube/report.json"));
        assert_eq!(check(folder.path(), "cube", true, turn.world(), name), 2);
        compare("cube/specular.ktx2");
        // Old DDS files do not mark their flip: only the report has it.
        let args = [&args[..], &["--format", "dds"]].concat();
        bake(folder.path(), "dds", &args);
        let mut bytes = fs::read(at("dds/specular.dds")).expect("readable");
        bytes[32..76].fill(0);
        fs::write(at("dds/specular.dds"), bytes).expect("writable");
        make_report_old(&at("dds/report.json"));
        assert_eq!(check(folder.path(), "dds", true, turn.world(), name), 2);
        compare("dds");
    }
    // A single file with its report, and a folder whose files have no metadata.
    bake(folder.path(), "one.ktx2", &[&TWO_LEVELS[..], turn.0].concat());
    make_ktx2_old(&at("one.ktx2"), Flip::None, None);
    make_report_old(&at("one.ktx2.report.json"));
    compare("one.ktx2");
    bake(folder.path(), "levels", &[&TWO_LEVELS[..], turn.0, &["--format", "hdr"]].concat());
    let strip = |folder: &str| {
        for name in tree(&at(folder)).iter().filter(|name| name.ends_with(".hdr")) {
            let bytes = fs::read(at(folder).join(name)).expect("readable");
            let lines = bytes.split_inclusive(|byte| *byte == b'\n');
            let old: Vec<u8> =
                lines.filter(|line| !line.starts_with(b"octagloss")).flatten().copied().collect();
            assert!(old.len() < bytes.len(), "{name}");
            fs::write(at(folder).join(name), old).expect("writable");
        }
    };
    strip("levels");
    make_report_old(&at("levels/report.json"));
    assert_eq!(check(folder.path(), "levels", true, turn.world(), "levels"), 1);
    compare("levels");
    // Panoramas of engines, whose axes are not ours, by the report alone.
    for (target, quarters) in [("unreal", 1), ("godot", 3)] {
        bake(folder.path(), target, &["--size", "8", "--target", target]);
        strip(target);
        make_report_old(&at(target).join("report.json"));
        let panorama = tree(&at(target)).into_iter().find(|name| name.contains("panorama")).expect("one");
        let panorama = format!("{target}/{panorama}");
        let found: serde_json::Value =
            serde_json::from_str(&done(folder.path(), &["info", &panorama, "--json"])).expect("JSON");
        assert_eq!(found["origin"]["quarter_turns"], quarters, "{panorama}: {found}");
    }
}
