//! `--skybox`: the unfiltered environment beside the levels.

use super::{done, fails, json, json_file, names, with_sky, write_panorama};
use octagloss::{Layout, Rgb};
use octagloss_core::files::io::{ReadOptions, load_chain, read};
use octagloss_core::files::target::TARGETS;
use octagloss_core::lobe::Lobe;
use std::fs;
use std::path::Path;

fn texels(path: &Path) -> (Layout, Vec<Rgb>) {
    let environment = read(path, &ReadOptions::default()).expect("readable").environment;
    (environment.layout(), environment.texels().to_vec())
}

#[test]
fn every_target_gets_a_skybox_of_the_size_asked_for() {
    let folder = with_sky();
    let names: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
    let all = names.join(",");
    let coarse = ["--filter", "adaptive:0.5"];
    let args = ["bake", "sky.exr", "--target", &all, "--size", "64", "--skybox", "8", "-o", "out"];
    let args = [&args[..], &coarse].concat();
    let printed = done(folder.path(), &[&args[..], &["--dry-run"]].concat()).out;
    done(folder.path(), &[&args[..], &["--quiet"]].concat());
    for target in &TARGETS {
        let at = folder.path().join("out").join(target.name);
        let report = json_file(&at.join("report.json"));
        let outputs = report["outputs"].as_array().expect("outputs").iter();
        let paths: Vec<&str> = outputs.map(|output| output["path"].as_str().expect("text")).collect();
        let skyboxes: Vec<_> = paths.iter().filter(|path| path.contains("skybox")).collect();
        assert_eq!(skyboxes.len(), 1, "{}: {paths:?}", target.name);
        assert_eq!(report["recipe"]["skybox"], 8, "{}", target.name);
        let path = at.join(skyboxes[0]);
        let line =
            printed.lines().find(|line| line.starts_with(&format!("out/{}/{}\t", target.name, skyboxes[0])));
        let line = line.unwrap_or_else(|| panic!("{} is not in {printed}", path.display()));
        let (layout, _) = texels(&path);
        match layout {
            Layout::Cube { size } => {
                assert_eq!(size, 8, "{}", target.name);
                assert!(line.ends_with("cube 8"), "{line}");
            }
            Layout::Panorama { width, height } => {
                assert_eq!((width, height), (32, 16), "{}", target.name);
                assert!(line.ends_with("panorama 32x16"), "{line}");
            }
            Layout::Octahedral { .. } => panic!("{}", target.name),
        }
    }
}

#[test]
fn a_skybox_is_level_0_of_its_size_whatever_the_lobe() {
    let folder = with_sky();
    let bake = |more: &[&str]| done(folder.path(), &[&["bake", "sky.exr", "--pixel", "f32"], more].concat());
    bake(&["--size", "16", "--levels", "1", "-o", "level.ktx2"]);
    let expected = texels(&folder.path().join("level.ktx2"));
    let cases: [(&[&str], &str); 6] = [
        (&["--size", "8", "-o", "a.ktx2"], "a.skybox.ktx2"),
        (&["--size", "16", "-o", "b.dds"], "b.skybox.dds"),
        (&["--lobe", "charlie", "--filter", "adaptive:0.5", "--size", "8", "-o", "c.ktx"], "c.skybox.ktx"),
        (&["--lobe", "cosine", "--size", "8", "-o", "d.ktx2"], "d.skybox.ktx2"),
        (&["--out-layout", "parts", "--size", "8", "-o", "e.exr"], "e.skybox.exr"),
        (&["--filter", "box", "--size", "8", "-o", "f.ktx2"], "f.skybox.ktx2"),
    ];
    for (more, name) in cases {
        bake(&[more, &["--skybox", "16"]].concat());
        assert_eq!(texels(&folder.path().join(name)), expected, "{name}");
        let chain = load_chain(&folder.path().join(name)).expect("a chain of one level");
        assert_eq!((chain.chain.levels.len(), chain.provenance.lobe), (1, Some(Lobe::Ggx)), "{name}");
    }
    // Folders of images.
    for (layout, count) in [("faces", 6), ("cross", 1)] {
        let more = ["--format", "exr", "--out-layout", layout, "--size", "4", "--skybox", "16", "-o", layout];
        bake(&more);
        let files = names(&folder.path().join(layout));
        assert_eq!(files.iter().filter(|name| name.starts_with("skybox")).count(), count, "{files:?}");
        // Replaced as a whole, and read for its levels.
        bake(&[&more[..], &["--force"]].concat());
        assert_eq!(texels(&folder.path().join(layout)).0, Layout::Cube { size: 4 });
    }
    assert_eq!(texels(&folder.path().join("cross/skybox.exr")), expected);
}

#[test]
fn the_sources_own_resolution_is_found_and_told() {
    let folder = with_sky();
    write_panorama(&folder.path().join("wide.exr"), 128, |_| [1.0; 3]);
    fs::create_dir(folder.path().join("in")).expect("made");
    for name in ["sky.exr", "wide.exr"] {
        fs::rename(folder.path().join(name), folder.path().join("in").join(name)).expect("moved");
    }
    let args = ["bake", "in", "--skybox", "source", "--size", "4", "-o", "out"];
    let printed = done(folder.path(), &[&args[..], &["--dry-run"]].concat()).out;
    assert!(printed.contains("out/sky.skybox.ktx2\tf16 cube 8\n"), "{printed}");
    assert!(printed.contains("out/wide.skybox.ktx2\tf16 cube 32\n"), "{printed}");
    done(folder.path(), &[&args[..], &["--quiet"]].concat());
    for (name, size) in [("sky", 8), ("wide", 32)] {
        let (layout, _) = texels(&folder.path().join(format!("out/{name}.skybox.ktx2")));
        assert_eq!(layout, Layout::Cube { size }, "{name}");
        let report = json_file(&folder.path().join(format!("out/{name}.ktx2.report.json")));
        assert_eq!(report["recipe"]["skybox"], size, "{name}");
        let outputs = report["outputs"].as_array().expect("outputs");
        assert!(outputs.iter().any(|output| output["path"] == format!("{name}.skybox.ktx2")), "{outputs:?}");
    }
    // Another size is another bake.
    let again = done(folder.path(), &[&args[..], &["--force", "--skip-unchanged"]].concat());
    assert!(again.err.contains("0 baked, 2 skipped, 0 failed"), "{}", again.err);
    let other = ["bake", "in", "--skybox", "8", "--size", "4", "-o", "out", "--force", "--skip-unchanged"];
    assert!(done(folder.path(), &other).err.contains("2 baked, 0 skipped"), "another size");
}

#[test]
fn filaments_skybox_is_level_0_unless_another_is_asked_for() {
    let folder = with_sky();
    let bake = |out: &str, more: &[&str]| {
        let args = ["bake", "sky.exr", "--target", "filament", "--size", "32", "--quiet", "-o", out];
        done(folder.path(), &[&args[..], more].concat());
        texels(&folder.path().join(out).join("sky_skybox.ktx")).0
    };
    assert_eq!(bake("a", &[]), Layout::Cube { size: 32 });
    assert_eq!(bake("b", &["--skybox", "source"]), Layout::Cube { size: 8 });
    let info = json(&done(folder.path(), &["info", "b/sky_skybox.ktx", "--json"]).out);
    assert_eq!((&info["target"], &info["lobe"]), (&"filament".into(), &"ggx".into()));
}

#[test]
fn sizes_that_make_no_sense_are_refused() {
    let folder = with_sky();
    for size in ["0", "16385", "-1", "huge", "1.5"] {
        fails(folder.path(), &["bake", "sky.exr", &format!("--skybox={size}")], 2, "1 to 16384, or source");
    }
    fails(folder.path(), &["bake", "sky.exr", "--skybox", "16384"], 1, "--skybox ");
    fails(
        folder.path(),
        &["bake", "sky.exr", "--out-layout", "equirect", "--skybox", "4"],
        2,
        "--skybox is a cube",
    );
    fails(folder.path(), &["bake", "sky.exr", "--skybox", "4", "-o", "-"], 2, "omit --skybox");
    assert_eq!(names(folder.path()), ["sky.exr"]);
}
