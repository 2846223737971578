//! Inputs that are endless, not files, or too large: refused quickly, by name.

use super::octagloss;
#[cfg(target_os = "linux")]
use octagloss_core::files::io::{ReadOptions, read_from_memory};
use octagloss_fixtures::files::inputs;
use std::fs;
use std::io::{Read as _, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Time limit of a refusal on a busy machine.
const SOON: Duration = Duration::from_secs(30);

/// Returns exit status and standard error of the program; fails if it does not end soon.
fn soon(folder: &Path, args: &[&str], variables: &[(&str, &str)]) -> (i32, String) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_octagloss"))
        .current_dir(folder)
        .args(args)
        .envs(variables.iter().copied())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().expect("it can be waited for") {
            break status;
        }
        if start.elapsed() > SOON {
            child.kill().expect("it can be ended");
            panic!("{args:?} hangs");
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let mut text = String::new();
    child.stderr.take().expect("piped").read_to_string(&mut text).expect("text");
    (status.code().expect("no signal"), text)
}

fn sky(folder: &Path) {
    fs::write(
        folder.join("sky.exr"),
        inputs::exr_rgb(
            (16, 8),
            inputs::Sample::Half,
            exr::prelude::Compression::ZIP16,
            &inputs::numbered(16, 8),
        ),
    )
    .unwrap();
    fs::write(folder.join("d.csv"), "x,y,z\n1,0,0\n").unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn pipes_sockets_and_devices_are_refused_by_every_command() {
    use rustix::fs::{CWD, FileType, Mode, mknodat};
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    sky(here);
    mknodat(CWD, here.join("pipe"), FileType::Fifo, Mode::from_raw_mode(0o600), 0).unwrap();
    let _listener = std::os::unix::net::UnixListener::bind(here.join("socket")).unwrap();
    fs::create_dir(here.join("folder")).unwrap();
    mknodat(CWD, here.join("folder/report.json"), FileType::Fifo, Mode::from_raw_mode(0o600), 0).unwrap();
    for (place, kind) in [("pipe", "a named pipe"), ("socket", "a socket"), ("/dev/zero", "a device")] {
        for args in [
            &["info", place][..],
            &["bake", place, "-o", "out.ktx2"],
            &["bake", place, "-o", "out.ktx2", "--skip-unchanged"],
            &["query", place, "--directions", "d.csv", "--roughness", "0.5"],
            &["query", "sky.exr", "--directions", place, "--roughness", "0.5"],
            &["compare", "sky.exr", place],
            &["compare", place, "sky.exr"],
        ] {
            let (code, text) = soon(here, args, &[]);
            assert_eq!(code, 1, "{args:?}: {text}");
            // A file that is not a bake is not opened as one.
            let refused = format!("{place}: {kind}, not a regular file");
            assert!(text.contains(&refused) || text.contains("not a bake"), "{args:?}: {text}");
        }
    }
    let (code, text) = soon(here, &["query", "sky.exr", "--directions", "folder", "--roughness", "0.5"], &[]);
    assert!(code == 1 && text.contains("folder: a directory where a file is needed"), "{text}");
    assert_eq!(soon(here, &["info", "folder"], &[]).0, 1, "its report is a pipe");
}

#[test]
fn an_endless_standard_input_is_given_up() {
    let folder = tempfile::tempdir().unwrap();
    sky(folder.path());
    let mut child = Command::new(env!("CARGO_BIN_EXE_octagloss"))
        .current_dir(folder.path())
        .args(["query", "sky.exr", "--directions", "-", "--roughness", "0.5", "--engine", "cpu"])
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut endless = child.stdin.take().unwrap();
    // Writing fails once the program has ended.
    while endless.write_all(&[0; 4096]).is_ok() {}
    let output = child.wait_with_output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("standard input: line 1 is longer than 1000 bytes"), "{text}");
}

/// A profile that inflates to 256 MiB, from 300 kB in the file.
#[cfg(target_os = "linux")]
#[test]
fn compressed_profiles_of_png_are_not_inflated() {
    let folder = tempfile::tempdir().unwrap();
    let mut bytes = Vec::new();
    let mut info = png::Info::with_size(16, 8);
    info.color_type = png::ColorType::Rgb;
    info.bit_depth = png::BitDepth::Eight;
    info.icc_profile = Some(vec![0; 256 << 20].into());
    let mut writer = png::Encoder::with_info(&mut bytes, info).unwrap().write_header().unwrap();
    writer.write_image_data(&[7; 16 * 8 * 3]).unwrap();
    writer.finish().unwrap();
    assert!(bytes.windows(4).any(|name| name == b"iCCP") && bytes.len() < 1 << 20, "{} bytes", bytes.len());
    fs::write(folder.path().join("bomb.png"), &bytes).unwrap();
    // Enough address space for an image of this size, but less than the profile.
    let output = Command::new("sh")
        .args(["-c", "ulimit -v 300000; exec \"$0\" info bomb.png", env!("CARGO_BIN_EXE_octagloss")])
        .env("RAYON_NUM_THREADS", "1")
        .current_dir(folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{text}");
    read_from_memory(
        Path::new("bomb.png"),
        &bytes,
        &ReadOptions { memory_limit: 2 << 20, ..ReadOptions::default() },
    )
    .unwrap();
}

#[test]
fn too_much_memory_is_refused_before_work_with_what_fits() {
    let folder = tempfile::tempdir().unwrap();
    sky(folder.path());
    for (args, option) in [
        (&["bake", "sky.exr", "-o", "a.ktx2", "--size", "16384"][..], "--size"),
        (&["bake", "sky.exr", "-o", "a", "--format", "exr", "--size", "16384"], "--size"),
        (&["bake", "sky.exr", "-o", "b", "--target", "three,bevy", "--size", "16384"], "--size"),
        (&["bake", "sky.exr", "-o", "c.ktx2", "--oem-size", "16384"], "--oem-size"),
        (
            &["query", "sky.exr", "--directions", "d.csv", "--roughness", "0.5", "--oem-size", "16384"],
            "--oem-size",
        ),
        (&["bake", "sky.exr", "-o", "a.ktx2", "--size", "16384", "--dry-run"], "--size"),
        (
            &["bake", "sky.exr", "-o", "b", "--target", "three", "--oem-size", "16384", "--dry-run"],
            "--oem-size",
        ),
        (&["bake", "sky.exr", "-o", "a.ktx2", "--border", "9000"], "--border"),
        (&["bake", "sky.exr", "-o", "a.ktx2", "--border", "5500", "--filter", "box"], "--border"),
        (
            &["query", "sky.exr", "--directions", "d.csv", "--roughness", "0.5", "--border", "9000"],
            "--border",
        ),
        (&["bench", "--engine", "cpu", "--size", "8192"], "--size"),
    ] {
        let (code, text) = soon(folder.path(), args, &[]);
        assert_eq!(code, 1, "{args:?}: {text}");
        assert!(text.contains("the limit is 4294967296"), "{text}");
        let named = text.split_once(&format!("; {option} ")).and_then(|(_, rest)| rest.split(' ').next());
        let size: u32 = named.and_then(|word| word.parse().ok()).unwrap_or_else(|| panic!("{text}"));
        assert!((1024..16384).contains(&size), "{text}");
    }
    assert!(
        !["a", "a.ktx2", "b", "c.ktx2"].iter().any(|name| folder.path().join(name).exists()),
        "no output may remain"
    );
}

#[test]
fn errors_below_float32_are_usage_errors() {
    let folder = tempfile::tempdir().unwrap();
    sky(folder.path());
    for filter in ["adaptive:1e-9", "adaptive:9.9e-7"] {
        let (code, text) = soon(folder.path(), &["bake", "sky.exr", "-o", "a.ktx2", "--filter", filter], &[]);
        assert!(code == 2 && text.contains("at least 1e-6, the float32 limit"), "{text}");
    }
    for filter in ["adaptive:1", "adaptive:nan"] {
        let (code, text) = soon(folder.path(), &["bake", "sky.exr", "-o", "a.ktx2", "--filter", filter], &[]);
        assert!(code == 2 && text.contains("and below 1"), "{text}");
    }
    let least =
        ["query", "sky.exr", "--directions", "d.csv", "--roughness", "0.5", "--filter", "adaptive:1e-6"];
    assert_eq!(soon(folder.path(), &least, &[]).0, 0);
}

#[test]
fn threads_are_capped_or_obeyed() {
    let folder = tempfile::tempdir().unwrap();
    sky(folder.path());
    let bake = ["bake", "sky.exr", "-o", "a.ktx2", "--size", "4", "--force", "--engine", "cpu"];
    for count in ["1000", "99999999", "99999999999999999999999"] {
        let (code, text) = soon(folder.path(), &bake, &[("RAYON_NUM_THREADS", count)]);
        assert_eq!(code, 0, "{count}: {text}");
    }
    let query = |count| {
        let args = ["query", "sky.exr", "--directions", "d.csv", "--roughness", "0.5", "--threads", count];
        soon(folder.path(), &args, &[])
    };
    assert_eq!(query("256").0, 0);
    let (code, text) = query("257");
    assert!(code == 2 && text.contains("257"), "{text}");
}

#[test]
fn a_picture_against_a_source_needs_no_more_texels_than_figures_do() {
    let folder = tempfile::tempdir().unwrap();
    sky(folder.path());
    let bake =
        ["bake", "sky.exr", "-o", "a.ktx2", "--size", "16", "--levels", "2", "--engine", "cpu", "--quiet"];
    assert_eq!(octagloss(folder.path(), &bake).code, 0);
    let compare = ["compare", "a.ktx2", "sky.exr", "--texels", "54", "--picture", "p.png", "--json"];
    let ran = octagloss(folder.path(), &compare);
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert!(ran.err.contains("a grid of at most 54 texels per level; --texels all shows all"), "{}", ran.err);
    let printed: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!(printed["levels"][0]["texels"], 54, "{printed}");
    let picture = image::open(folder.path().join("p.png")).unwrap();
    assert!(picture.width() > 300 && picture.height() > 200, "a cross of faces of 96 pixels");
}
