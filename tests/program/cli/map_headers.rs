//! Files of `convert` name their map, and every command takes it from there.

use crate::cli::{done, fails, names, octagloss, write_panorama};
use octagloss::Layout;
use octagloss_core::files::io::{self, ReadOptions};
use octagloss_core::sphere::registry::MAPS;
use std::fs;
use tempfile::TempDir;

/// Maps that environments can have.
const LAYOUTS: [&str; 3] = ["octahedral", "equirect", "cube"];

/// A folder with `in.exr` and, of every map, `MAP.exr`, and `MAP.hdr` with a border.
fn converted() -> TempDir {
    let folder = TempDir::new().expect("a temporary folder");
    write_panorama(&folder.path().join("in.exr"), 16, |d| {
        [(2.0 + d.x) as f32, (2.0 + d.y) as f32, (2.0 + d.z) as f32]
    });
    for map in &MAPS {
        for (extension, border) in [("exr", "0"), ("hdr", "1")] {
            let file = format!("{}.{extension}", map.name);
            let options = ["--layout", map.name, "--size", "4", "--border", border];
            done(folder.path(), &[&["convert", "in.exr", "-o", &file][..], &options].concat());
        }
    }
    folder
}

#[test]
fn convert_reads_every_map_that_it_wrote() {
    let folder = converted();
    let folder = folder.path();
    let back = ["--layout", "equirect", "--size", "8", "--force"];
    let read = |file: &str, more: &[&str]| {
        done(folder, &[&["convert", file, "-o", "back.exr"], &back[..], more].concat());
        fs::read(folder.join("back.exr")).expect("there")
    };
    let texels = |name: &str| {
        let loaded = io::read(&folder.join(name), &ReadOptions::default()).expect("readable");
        loaded.environment.texels().to_vec()
    };
    let before = texels("in.exr");
    for map in &MAPS {
        let file = format!("{}.exr", map.name);
        let named = read(&file, &["--from", map.name]);
        assert!(read(&file, &[]) == named, "{}: as if it were named", map.name);
        let apart = |after: Vec<[f32; 3]>| {
            let pairs = before.iter().zip(after).flat_map(|(a, b)| (0..3).map(move |c| (a[c] - b[c]).abs()));
            pairs.fold(0.0, f32::max)
        };
        // Means over texels of up to 90 degrees, of slopes up to 1: 45 degrees both ways. A picture of
        // another map would be off by up to 2.
        let worst = apart(texels("back.exr"));
        assert!(worst < 0.8, "{}: {worst} off", map.name);
        read(&format!("{}.hdr", map.name), &[]);
        let bordered = apart(texels("back.exr"));
        // RGBE rounds by 1/256.
        assert!((bordered - worst).abs() < 0.02, "{}: {bordered} with a border, {worst} without", map.name);
        let other = if map.name == "healpix" { "tennis-ball" } else { "healpix" };
        let args = ["convert", &file, "-o", "x.exr", "--layout", "cube", "--from", other];
        let words =
            format!("its header says that its map is {} (octaglossMap), but --from is {other}", map.name);
        fails(folder, &args, 1, &words);
    }
}

#[test]
fn every_command_takes_the_map_from_the_header() {
    let folder = converted();
    let folder = folder.path();
    fs::write(folder.join("d.csv"), "x,y,z\n0,1,0\n").expect("writable");
    done(folder, &["bake", "in.exr", "-o", "b.ktx2", "--size", "4", "--levels", "2", "-q"]);
    let before = names(folder);
    for map in &MAPS {
        for extension in ["exr", "hdr"] {
            let file = format!("{}.{extension}", map.name);
            let commands: [&[&str]; 4] = [
                &["bake", &file, "-o", "out.ktx2", "--size", "2", "--levels", "1", "-q"],
                &["query", &file, "--directions", "d.csv", "--roughness", "0.5"],
                &["info", &file],
                &["compare", "b.ktx2", &file, "--texels", "2"],
            ];
            for args in commands {
                // `info` describes every map.
                if LAYOUTS.contains(&map.name) || args[0] == "info" {
                    done(folder, args);
                } else {
                    let words = format!(
                        "its header says that its map is {} (octaglossMap), which no environment has; run \
                         octagloss convert INPUT -o OUT --layout equirect",
                        map.name
                    );
                    fails(folder, args, 1, &words);
                }
            }
            fs::remove_file(folder.join("out.ktx2")).ok();
            fs::remove_file(folder.join("out.ktx2.report.json")).ok();
        }
    }
    assert_eq!(names(folder), before, "nothing else is written");
}

#[test]
fn layouts_of_environments_are_those_of_the_header() {
    let folder = converted();
    let folder = folder.path();
    for (name, layout, word) in [
        ("octahedral", Layout::Octahedral { size: 4 }, "octahedral"),
        ("equirect", Layout::Panorama { width: 8, height: 4 }, "panorama"),
        ("cube", Layout::Cube { size: 4 }, "cube"),
    ] {
        for file in [format!("{name}.exr"), format!("{name}.hdr")] {
            let loaded = io::read(&folder.join(&file), &ReadOptions::default()).expect("readable");
            assert_eq!(loaded.environment.layout(), layout, "{file}");
            let info = octagloss(folder, &["info", &file]).out;
            assert!(info.contains(word), "{info}");
            let wrong = if name == "equirect" { "octahedral" } else { "equirect" };
            let words =
                format!("its header says that its map is {name} (octaglossMap), but --layout is {wrong}");
            fails(folder, &["info", &file, "--layout", wrong], 1, &words);
        }
    }
}
