//! `--target pyramid`: its files come back as what their look-ups answer, and are judged so.

use super::{done, fails, json, json_file, with_sky, write_panorama};
use octagloss_shaders::reader;
use serde_json::Value;
use std::fs;

#[test]
fn compare_judges_pyramids_by_their_look_ups() {
    let folder = with_sky();
    let at = folder.path();
    // A wide lamp that is ten times as bright as the sky; harmonics are worse under brighter ones.
    write_panorama(&at.join("sky.exr"), 32, |d| {
        if d.z > 0.98 { [10.0, 8.0, 6.0] } else { [0.3, 0.5, 1.0 + d.y as f32] }
    });
    let turned = ["--rotate-y", "33.5", "--mirror", "--scale", "3"];
    let on_cube = ["--map", "cube", "--rotate-y", "33.5", "--mirror"];
    for (pixel, turned, most) in [
        ("f16", &on_cube[..], 0.03),
        ("bc6h", &on_cube, 0.05),
        ("f16", &[], 0.03),
        ("f16", &turned, 0.03),
        ("rgb9e5", &[], 0.03),
        ("bc6h", &[], 0.05),
    ] {
        let args = ["bake", "sky.exr", "--target", "pyramid", "--size", "128", "--pixel", pixel, "-o", "out"];
        done(at, &[&args[..], turned, &["--force", "--quiet"]].concat());
        for bake in ["out", "out/sky_pyramid.ktx2"] {
            let args = ["compare", bake, "sky.exr", "--json", "--quiet", "--texels", "200"];
            let found = json(&done(at, &args).out);
            let levels = found["levels"].as_array().expect("levels");
            assert!(levels.len() >= 4, "{found}");
            for level in levels {
                let error = level["rel_rmse"].as_f64().expect("a number");
                assert!(error < most, "{pixel} {turned:?} {bake}: {level}");
            }
            let parts = found["parts"].as_array().expect("parts");
            let irradiance = parts.iter().find(|part| part["part"] == "irradiance").expect("irradiance");
            assert!(irradiance["rel_rmse"].as_f64().is_some_and(|error| error < 0.02), "{irradiance}");
        }
    }
    // A pyramid of other light fails its gate.
    let judged = |bake: &str| {
        let args = ["compare", bake, "sky.exr", "--fail-above", "5%", "--from", "0.3", "--texels", "50"];
        super::octagloss(at, &[&args[..], &["--quiet"]].concat()).code
    };
    assert_eq!(judged("out"), 0);
    let path = at.join("out/sky_pyramid.ktx2");
    let file = fs::read(&path).expect("a file");
    let at_uniform = file.windows(11).position(|text| text == b"\"uniform\":[").expect("the key") + 11;
    let mut other = file.clone();
    assert_eq!(&other[at_uniform..at_uniform + 3], b"1.0");
    other[at_uniform..at_uniform + 3].copy_from_slice(b"0.9");
    fs::write(&path, &other).expect("writable");
    fails(at, &["compare", "out/sky_pyramid.ktx2", "sky.exr"], 1, "its rotation is none; bake it again");
    // No environment.
    fs::write(&path, &file).expect("writable");
    fails(at, &["bake", "out/sky_pyramid.ktx2", "-o", "again.ktx2"], 1, "a pyramid is for look-ups");
}

#[test]
fn pyramids_have_their_options() {
    let folder = with_sky();
    let at = folder.path();
    let bake = ["bake", "sky.exr", "--target", "pyramid", "-o", "x"];
    for (more, said) in [
        (&["--size", "32"][..], "from 64 to 2048"),
        (&["--size", "100"], "from 64 to 2048"),
        (&["--size", "4096"], "from 64 to 2048"),
        (&["--levels", "3"], "omit --levels"),
        (&["--lobe", "charlie"], "pyramid supports ggx only"),
        (&["--format", "exr"], "holds no pyramids"),
        (&["--map", "cube", "--format", "dds"], "holds no pyramids"),
        (&["--map", "cube", "--flip", "x"], "read by shaders of its own; omit --flip"),
        (&["--map", "cube", "--size", "100"], "from 64 to 2048"),
        (&["--map", "panorama"], "--map"),
        (&["--irradiance", "8"], "holds its irradiance"),
        (&["--flip", "x"], "read by shaders of its own"),
        (&["--ladder", "unity"], "ladder"),
    ] {
        fails(at, &[&bake[..], more].concat(), 2, said);
    }
    for (args, said) in [
        (&["--target", "three", "--map", "cube"][..], "target three has no pyramid; omit --map cube"),
        (&["--target", "pyramid,three", "--map", "cube"], "target three has no pyramid; omit --map cube"),
        (&["--map", "cube"], "--target"),
    ] {
        fails(at, &[&["bake", "sky.exr", "-o", "x"], args].concat(), 2, said);
    }
    done(at, &["bake", "sky.exr", "--target", "pyramid,three", "--size", "64", "-o", "both", "--quiet"]);
    let report = json_file(&at.join("both/pyramid/report.json"));
    assert_eq!(report["recipe"]["filter"], "pyramid");
    assert_eq!(json_file(&at.join("both/three/report.json"))["recipe"]["filter"], "adaptive:0.005");
    let light: Value = json_file(&at.join("both/pyramid/sky_pyramid.json"));
    assert_eq!((&light["size"], &light["border"]), (&64.into(), &2.into()));
    assert!(light["suns"].as_array().is_some_and(|suns| !suns.is_empty()), "{light}");
    for (language, file) in [("wgsl", "wgsl"), ("glsl", "glsl"), ("hlsl", "hlsl"), ("msl", "metal")] {
        let name = format!("pyramid.{file}");
        let code = reader(&name).expect("a reader");
        assert_eq!(done(at, &["reader", "--language", language]).out, code);
        let written = fs::read_to_string(at.join(format!("both/pyramid/pyramid.{file}"))).expect("text");
        assert_eq!(written, code);
    }
    // The same of cubes.
    let bake = ["bake", "sky.exr", "--target", "pyramid", "--map", "cube", "--size", "64", "-o", "cube"];
    done(at, &[&bake[..], &["--quiet"]].concat());
    assert_eq!(json_file(&at.join("cube/report.json"))["recipe"]["map"], "cube");
    assert_eq!(json_file(&at.join("cube/sky_pyramid.json")), light);
    for (language, file) in [("wgsl", "wgsl"), ("glsl", "glsl"), ("hlsl", "hlsl"), ("msl", "metal")] {
        let code = reader(&format!("pyramid_cube.{file}")).expect("a reader");
        assert_eq!(done(at, &["reader", "--map", "cube", "--language", language]).out, code);
        let written = fs::read_to_string(at.join(format!("cube/pyramid_cube.{file}"))).expect("text");
        assert_eq!(written, code);
        assert!(code.contains("--map cube") && !code.contains("OCTAGLOSS_CUBE"), "{file}");
    }
    assert!(done(at, &["info", "cube"]).out.contains("KTX2 pyramid on a cube, RGBA16F, 4 levels"));
    fails(at, &["bake", "cube/sky_pyramid.ktx2", "-o", "again.ktx2"], 1, "a pyramid is for look-ups");
    fails(at, &["reader", "oem", "--language", "hlsl", "--map", "cube"], 2, "--map is for pyramids");
    assert!(done(at, &["reader", "oem", "--language", "hlsl"]).out.contains("oem_radiance"));
    fails(at, &["reader", "oem", "--language", "msl"], 2, "no reader in msl");
    // The table of anisotropic reflections.
    let rows = ["reader", "--rows", "rows.ktx2", "--size", "64", "--quiet"];
    done(at, &rows);
    let header = fs::read(at.join("rows.ktx2")).expect("a file");
    let number = |place: usize| u32::from_le_bytes(header[place..place + 4].try_into().expect("four bytes"));
    assert_eq!([20, 24, 28].map(number), [336, 91, 8], "width, height and depth");
    fails(at, &rows, 1, "rows.ktx2");
    done(at, &[&rows[..], &["--force"]].concat());
    done(at, &["reader", "--rows", "on_cubes.ktx2", "--size", "64", "--map", "cube", "--quiet"]);
    let of_cubes = fs::read(at.join("on_cubes.ktx2")).expect("a file");
    assert!(fs::read(at.join("rows.ktx2")).expect("a file") != of_cubes, "cubes have rows of their own");
    fails(at, &["reader", "--rows", "rows.ktx2", "--size", "100"], 2, "a power of two from 64 to 2048");
    fails(at, &["reader", "--rows", "rows.png"], 2, "name it *.ktx2");
    fails(at, &["reader", "oem", "--rows", "rows.ktx2"], 2, "--rows is for pyramids");
    fails(at, &["reader"], 2, "--language");
}
