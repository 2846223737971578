//! `octagloss bake` with folders and patterns: expansion, output paths and messages.

use super::{Ran, done, fails, json, names, octagloss, with_sky};
use octagloss_core::files::format::Pixel;
use octagloss_core::files::io::exr::write::{Samples, exr_bytes};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const SMALL: [&str; 4] = ["--size", "2", "--levels", "1"];

/// Creates a folder with `in`, which holds `files`, each a sky.
fn with_skies(files: &[&str]) -> TempDir {
    let folder = with_sky();
    fs::create_dir(folder.path().join("in")).expect("made");
    for file in files {
        let path = folder.path().join("in").join(file);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::copy(folder.path().join("sky.exr"), path).expect("copied");
    }
    folder
}

/// Runs `bake` with `more` and returns the result.
fn bake(folder: &Path, more: &[&str]) -> Ran {
    octagloss(folder, &[&["bake"], more, &SMALL[..]].concat())
}

/// The output lines about files, without those about the engine.
fn lines(ran: &Ran) -> Vec<&str> {
    let lines =
        ran.err.lines().filter(|line| !line.contains("using the CPU") && !line.contains(": warning: "));
    lines.map(|line| line.strip_prefix("octagloss: ").expect("the program's name")).collect()
}

/// All files below `folder` except reports, with `/` separators.
fn tree(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for name in names(folder) {
        let path = folder.join(&name);
        if path.is_dir() {
            found.extend(tree(&path).into_iter().map(|inner| format!("{name}/{inner}")));
        } else if !name.ends_with("report.json") {
            found.push(name);
        }
    }
    found
}

#[test]
fn a_folder_stands_for_its_readable_files_in_order() {
    let folder =
        with_skies(&["b.exr", "a.EXR", "c.exr", ".hidden.exr", "notes.txt", "sub/d.exr", "dir.exr/e.exr"]);
    let ran = bake(folder.path(), &["in", "-o", "out"]);
    assert_eq!((ran.code, &ran.out[..]), (0, ""), "{}", ran.err);
    let said = lines(&ran);
    for (line, words) in said.iter().zip(["[1/3] out/a.ktx2: ", "[2/3] out/b.ktx2: ", "[3/3] out/c.ktx2: "]) {
        assert!(line.starts_with(words), "{line}");
    }
    assert_eq!(said[3..], ["3 baked, 0 skipped, 0 failed"]);
    assert_eq!(tree(&folder.path().join("out")), ["a.ktx2", "b.ktx2", "c.ktx2"]);
    // A folder input with one file also writes a folder.
    let ran = bake(folder.path(), &["in/sub", "-o", "one"]);
    assert_eq!((ran.code, tree(&folder.path().join("one"))), (0, vec!["d.ktx2".to_owned()]), "{}", ran.err);
    fails(folder.path(), &["bake", "in/sub", "-o", "one.ktx2"], 2, "names a file");
    fails(folder.path(), &["bake", "in/sub", "-o", "-"], 2, "one input");
    fails(folder.path(), &["bake", "in/sub", "--target", "three", "--name", "sky"], 2, "several inputs");
    fails(folder.path(), &["bake", "in/sub", "--preview", "p.png"], 2, "one input");
}

#[test]
fn recursive_mirrors_the_tree_and_leaves_the_output_out() {
    let folder = with_skies(&["sky.exr", "x/sky.exr", "x/y/sky.exr", "z.exr/sky.exr", ".git/sky.exr"]);
    let expected = ["sky.ktx2", "x/sky.ktx2", "x/y/sky.ktx2", "z.exr/sky.ktx2"];
    let args = ["in", "--recursive", "-o", "in/out"];
    let ran = bake(folder.path(), &args);
    assert_eq!((ran.code, lines(&ran).last()), (0, Some(&"4 baked, 0 skipped, 0 failed")), "{}", ran.err);
    assert_eq!(tree(&folder.path().join("in/out")), expected);
    // Again, with the first run's outputs in the folder.
    let ran = bake(folder.path(), &[&args[..], &["--force", "--skip-unchanged"]].concat());
    assert_eq!(lines(&ran).last(), Some(&"0 baked, 4 skipped, 0 failed"), "{}", ran.err);
    assert!(lines(&ran)[0].starts_with("[1/4] in/out/sky.ktx2: unchanged"), "{}", ran.err);
    assert_eq!(tree(&folder.path().join("in/out")), expected);
    let ran = bake(folder.path(), &args);
    assert_eq!((ran.code, lines(&ran).last()), (1, Some(&"0 baked, 0 skipped, 4 failed")), "{}", ran.err);
    // Target folders.
    let args = ["bake", "in", "-r", "-o", "targets", "--target", "bevy", "--size", "8", "--quiet"];
    done(folder.path(), &args);
    assert!(tree(&folder.path().join("targets")).contains(&"x/y/sky/sky_specular.ktx2".to_owned()));
    // Without an output folder, the tree goes to the current one.
    let ran = bake(folder.path(), &["in", "-r", "--json"]);
    assert_eq!((ran.code, ran.out.lines().count()), (0, 4), "{}", ran.err);
    assert!(folder.path().join("x/y/sky.ktx2").is_file());
}

#[test]
fn equal_names_are_told_with_both_inputs() {
    let folder = with_skies(&["a.exr", "a.hdr", "x/a.exr"]);
    fails(
        folder.path(),
        &["bake", "in", "-o", "out"],
        2,
        "in/a.exr and in/a.hdr would both be written as a.ktx2",
    );
    fails(folder.path(), &["bake", "in/x", "in/a.exr", "-o", "out"], 2, "in/x/a.exr and in/a.exr would both");
    assert!(!folder.path().join("out").exists());
    // A file both named and found is one input.
    for inputs in [["in/x", "in/x/a.exr"], ["in/x/a.exr", "in/x"], ["in/x", "in/x"]] {
        let ran = bake(folder.path(), &[&inputs[..], &["-o", "out", "--force"]].concat());
        assert_eq!(lines(&ran).last(), Some(&"1 baked, 0 skipped, 0 failed"), "{}", ran.err);
    }
}

#[test]
fn patterns_are_expanded_and_mirror_the_folders_that_they_match() {
    let folder = with_skies(&["a.exr", "b.hdr", "c.exr", "x/a.exr", "x/y/d.exr", ".h/e.exr", "notes.txt"]);
    let expanded = |pattern: &str, out: &str| {
        let ran = bake(folder.path(), &[pattern, "-o", out, "--quiet"]);
        assert_eq!((ran.code, &ran.err[..]), (0, ""), "{pattern}");
        tree(&folder.path().join(out))
    };
    assert_eq!(expanded("in/*.exr", "1"), ["a.ktx2", "c.ktx2"]);
    assert_eq!(expanded("in/**/*.exr", "2"), ["a.ktx2", "c.ktx2", "x/a.ktx2", "x/y/d.ktx2"]);
    assert_eq!(expanded("./in/**", "3").len(), 5);
    assert_eq!(expanded("in/[bc].*", "4"), ["b.ktx2", "c.ktx2"]);
    assert_eq!(expanded("*/?/a.exr", "5"), ["in/x/a.ktx2"]);
    assert_eq!(expanded("in/**/y/*", "6"), ["x/y/d.ktx2"]);
    let absolute = folder.path().join("in/x/*");
    assert_eq!(expanded(absolute.to_str().expect("text"), "7"), ["a.ktx2"]);
    // A file matched twice is baked once.
    let ran = bake(folder.path(), &["in/*.exr", "in/a*", "-o", "8"]);
    assert_eq!(lines(&ran).last(), Some(&"2 baked, 0 skipped, 0 failed"), "{}", ran.err);
    // A file with that exact name takes precedence; Windows has no names with stars.
    let literal = if cfg!(windows) { "in/[a].exr" } else { "in/[a]*.exr" };
    fs::copy(folder.path().join("sky.exr"), folder.path().join(literal)).expect("copied");
    done(folder.path(), &[&["bake", literal, "-o", "literal.ktx2", "--quiet"], &SMALL[..]].concat());
}

#[test]
fn what_stands_for_nothing_fails_and_is_named() {
    let folder = with_skies(&["notes.txt", "sub/a.exr"]);
    fs::create_dir(folder.path().join("empty")).expect("made");
    for (input, words) in [
        ("empty", "empty: holds no readable file: .exr .hdr"),
        ("in", "in: holds no readable file"),
        ("in", "--recursive also searches subfolders"),
        ("in/*.exr", "in/*.exr: matches no readable file"),
        ("in/*.txt", "in/*.txt: matches no "),
        ("none/**/*.exr", "none/**/*.exr: matches no "),
    ] {
        fails(folder.path(), &["bake", input, "-o", "out"], 1, words);
    }
    // Neither a pattern nor a file.
    fails(folder.path(), &["bake", "sky[.exr"], 1, "sky[.exr");
    assert!(!folder.path().join("out").exists());
}

#[test]
fn a_bad_file_does_not_stop_the_others() {
    let folder = with_skies(&["a.exr", "c.exr"]);
    fs::write(folder.path().join("in/b.exr"), "not an image").expect("writable");
    let ran = bake(folder.path(), &["in", "-o", "out", "--json"]);
    assert_eq!(ran.code, 1);
    let said = lines(&ran);
    assert!(said.iter().any(|line| line.starts_with("error: [2/3] in/b.exr: not an image")), "{said:?}");
    assert_eq!(said.last(), Some(&"2 baked, 0 skipped, 1 failed"));
    let inputs: Vec<_> = ran.out.lines().map(|line| json(line)["input"].clone()).collect();
    assert_eq!(inputs, ["in/a.exr", "in/c.exr"]);
    let ran = bake(folder.path(), &["in", "-o", "dry", "--dry-run", "--json"]);
    assert_eq!(ran.code, 1);
    let inputs: Vec<_> = ran.out.lines().map(|line| json(line)["input"].clone()).collect();
    assert_eq!(inputs, ["in/a.exr", "in/b.exr", "in/c.exr"]);
    let ran = bake(folder.path(), &["in", "-o", "dry", "--dry-run"]);
    assert!(ran.out.starts_with("dry/a.ktx2\t") && ran.out.contains("\ndry/c.ktx2\t"), "{}", ran.out);
    assert!(!folder.path().join("dry").exists());
}

#[test]
fn what_earlier_bakes_wrote_is_no_input() {
    let folder = with_skies(&["a.exr", "b.exr"]);
    let all = ["--irradiance", "2", "--extract-sun", "--sunless", "--skybox", "2", "--bounds"];
    for _ in 0..2 {
        // Next to the sources.
        let args = [&["in", "-o", "in", "--force", "--levels", "2", "--size", "4"], &all[..]].concat();
        let ran = octagloss(folder.path(), &[&["bake"], &args[..]].concat());
        assert_eq!((ran.code, lines(&ran).last()), (0, Some(&"2 baked, 0 skipped, 0 failed")), "{}", ran.err);
    }
    let ran = bake(folder.path(), &["in", "-o", "in/levels", "--format", "exr"]);
    assert_eq!(lines(&ran).last(), Some(&"2 baked, 0 skipped, 0 failed"), "{}", ran.err);
    let ran = bake(folder.path(), &["in", "-r", "-o", "out"]);
    assert_eq!(lines(&ran).last(), Some(&"2 baked, 0 skipped, 0 failed"), "{}", ran.err);
    // A bake is one input.
    let ran = bake(folder.path(), &["in/levels/a", "-o", "again.ktx2"]);
    assert_eq!((ran.code, lines(&ran).len()), (0, 1), "{}", ran.err);
}

#[test]
fn an_output_that_is_an_input_is_refused() {
    let folder = with_skies(&["a.ktx2", "b.exr"]);
    // EXR data with another extension: the output would overwrite it.
    fails(folder.path(), &["bake", "in", "-o", "in", "--force"], 2, "in/a.ktx2 is an input");
    fs::write(folder.path().join("file"), "").expect("writable");
    fails(folder.path(), &["bake", "in", "-o", "file"], 1, "file: is a file");
    // A file in place of a folder of the mirrored tree.
    let folder = with_skies(&["x/a.exr"]);
    fs::create_dir(folder.path().join("out")).expect("made");
    fs::write(folder.path().join("out/x"), "").expect("writable");
    fails(
        folder.path(),
        &["bake", "in", "-r", "-o", "out", "--quiet"],
        1,
        "out/x: is a file, but a folder is needed",
    );
}

#[test]
fn six_faces_in_a_folder_are_a_cube_under_layout_faces() {
    let folder = TempDir::new().expect("a temporary folder");
    fs::create_dir(folder.path().join("in")).expect("made");
    let square = exr_bytes(4, 4, Samples::Rgb(&[[1.0; 3]; 16]), Pixel::F32, &[]).expect("valid");
    for face in ["px", "nx", "py", "ny", "pz", "nz"] {
        fs::write(folder.path().join(format!("in/cube_{face}.exr")), &square).expect("writable");
    }
    let ran = bake(folder.path(), &["in", "--layout", "faces", "-o", "cube.ktx2"]);
    assert_eq!((ran.code, lines(&ran).len()), (0, 1), "{}", ran.err);
}

#[cfg(unix)]
#[test]
fn odd_names_pipes_and_circles_of_links_do_no_harm() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;
    use std::os::unix::fs::symlink;
    let folder = with_skies(&["with space.exr", "new\nline.exr", "quote'\".exr", "x/a.exr"]);
    let inside = folder.path().join("in");
    fs::copy(folder.path().join("sky.exr"), inside.join(OsStr::from_bytes(b"latin\xe9.exr")))
        .expect("copied");
    symlink("..", inside.join("x/up")).expect("a link");
    symlink("x", inside.join("y")).expect("a link");
    symlink("circle.exr", inside.join("circle.exr")).expect("a link");
    symlink("x/a.exr", inside.join("linked.exr")).expect("a link");
    let pipe = inside.join("pipe.exr");
    rustix::fs::mknodat(
        rustix::fs::CWD,
        &pipe,
        rustix::fs::FileType::Fifo,
        rustix::fs::Mode::from_raw_mode(0o600),
        0,
    )
    .expect("a pipe");
    for (input, recursive) in [("in", true), ("in/**/*", false)] {
        let out = if recursive { "1" } else { "2" };
        let more: &[&str] = if recursive { &["--recursive"] } else { &[] };
        let ran = bake(folder.path(), &[&[input, "-o", out], more].concat());
        assert_eq!(ran.code, 1);
        let said = lines(&ran);
        assert_eq!(said.last(), Some(&"6 baked, 0 skipped, 2 failed"), "{}", ran.err);
        assert!(said.iter().any(|line| line.contains("circle.exr: Too many levels")), "{}", ran.err);
        assert!(said.iter().any(|line| line.contains("pipe.exr: a named pipe")), "{}", ran.err);
        assert!(said.iter().any(|line| line.contains("new line.ktx2")), "{}", ran.err);
        let expected = [
            "latin\u{fffd}.ktx2",
            "linked.ktx2",
            "new\nline.ktx2",
            "quote'\".ktx2",
            "with space.ktx2",
            "x/a.ktx2",
        ];
        assert_eq!(tree(&folder.path().join(out)), expected);
    }
    // The named folder may itself be a link.
    let ran = bake(folder.path(), &["in/y", "-o", "3"]);
    assert_eq!((ran.code, lines(&ran).last()), (0, Some(&"1 baked, 0 skipped, 0 failed")), "{}", ran.err);
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_read_is_told_and_the_rest_is_baked() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = with_skies(&["a.exr", "closed/b.exr"]);
    let closed = folder.path().join("in/closed");
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o000)).expect("closed");
    // Root can read everything.
    if fs::read_dir(&closed).is_err() {
        let ran = bake(folder.path(), &["in", "-r", "-o", "out"]);
        assert_eq!((ran.code, lines(&ran).last()), (1, Some(&"1 baked, 0 skipped, 1 failed")), "{}", ran.err);
        assert!(ran.err.contains("in/closed: Permission denied"), "{}", ran.err);
        fails(folder.path(), &["bake", "in/closed", "-o", "out"], 1, "in/closed: Permission denied");
    }
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o700)).expect("opened");
}

#[test]
fn many_files_cost_no_more_than_their_bakes() {
    let folder = with_skies(&[]);
    // Every other file is not an image.
    for number in 0..200 {
        let path = folder.path().join(format!("in/{number:03}.exr"));
        if number % 2 == 0 {
            fs::copy(folder.path().join("sky.exr"), path).expect("copied");
        } else {
            fs::write(path, "no image").expect("written");
        }
    }
    let ran = bake(folder.path(), &["in", "-o", "out", "--oem-size", "16"]);
    assert_eq!((ran.code, lines(&ran).last()), (1, Some(&"100 baked, 0 skipped, 100 failed")));
    assert!(lines(&ran).iter().any(|line| line.starts_with("[199/200] out/198.ktx2")), "{}", ran.err);
    let again = ["in", "-o", "out", "--oem-size", "16", "--force", "--skip-unchanged", "--quiet"];
    let ran = bake(folder.path(), &again);
    assert_eq!((ran.code, ran.err.lines().count()), (1, 100));
}
