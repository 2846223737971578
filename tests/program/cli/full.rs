//! Outputs that cannot be written (full disks, folders that refuse), and the predictions of `--dry-run`.

use crate::cli::{done, fails, names, with_sky};
use std::collections::BTreeSet;
#[cfg(unix)]
use std::fs;
use std::path::Path;
#[cfg(unix)]
use std::process::Command;

/// Every kind of output, into `a` or next to it.
const KINDS: [&[&str]; 8] = [
    &["-o", "a.ktx2", "--irradiance", "2", "--bounds", "--preview", "a.png"],
    &["-o", "a.ktx"],
    &["-o", "a.dds"],
    &["-o", "a", "--format", "exr", "--bounds", "--irradiance", "2"],
    &["-o", "a", "--format", "hdr"],
    &["-o", "a.ktx2", "--extract-sun", "--sunless"],
    &["-o", "a", "--format", "exr", "--extract-sun", "--sunless"],
    &["-o", "a", "--target", "bevy,three", "--extract-sun"],
];

fn tree(folder: &Path, within: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for name in names(folder) {
        let path = folder.join(&name);
        if path.is_dir() {
            found.extend(tree(&path, &format!("{within}{name}/")));
        } else {
            found.insert(format!("{within}{name}"));
        }
    }
    found
}

#[test]
fn a_dry_run_lists_exactly_what_is_written() {
    for kind in KINDS {
        let folder = with_sky();
        let args = [&["bake", "sky.exr", "--size", "4", "--levels", "2"], kind].concat();
        let printed = done(folder.path(), &[&args[..], &["--dry-run"]].concat());
        assert_eq!(
            (names(folder.path()), printed.err.as_str()),
            (vec!["sky.exr".to_owned()], ""),
            "{kind:?}"
        );
        let foretold: BTreeSet<String> =
            printed.out.lines().map(|line| line.split('\t').next().expect("a path").to_owned()).collect();
        done(folder.path(), &args);
        let mut written = tree(folder.path(), "");
        assert!(written.remove("sky.exr"));
        assert_eq!(foretold, written, "{kind:?}");
        // A dry run reports existing outputs, and omits those that are up to date.
        fails(folder.path(), &[&args[..], &["--dry-run"]].concat(), 1, "already exists");
        let again = done(folder.path(), &[&args[..], &["--dry-run", "--skip-unchanged"]].concat());
        assert_eq!(again.out, "", "{kind:?}");
    }
    let folder = with_sky();
    fails(folder.path(), &["bake", "none.exr", "--dry-run"], 1, "none.exr");
}

/// Runs with files limited to a few kB, like a full disk.
#[cfg(unix)]
fn limited(folder: &Path, args: &[&str]) -> (Option<i32>, String) {
    // The program ignores the kernel's signal itself.
    let script = r#"ulimit -f 4; exec "$0" "$@""#;
    let output = Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_octagloss")])
        .args(args)
        .current_dir(folder)
        .output()
        .expect("sh starts");
    (output.status.code(), String::from_utf8(output.stderr).expect("text"))
}

#[cfg(unix)]
#[test]
fn a_full_disk_is_one_line_and_nothing_half_written() {
    let mut refused = 0;
    for kind in KINDS {
        let folder = with_sky();
        let size = ["bake", "sky.exr", "--size", "64", "--levels", "3", "--quiet"];
        let args = [&size[..], kind].concat();
        let (code, printed) = limited(folder.path(), &args);
        assert_eq!((code, printed.lines().count()), (Some(1), 1), "{kind:?}: {printed}");
        assert!(
            printed.starts_with("octagloss: error: a") && printed.contains("File too large"),
            "{kind:?}: {printed}"
        );
        assert_eq!(names(folder.path()), ["sky.exr"], "{kind:?}");

        // Existing files stay as they were.
        done(folder.path(), &args);
        let before: Vec<(String, Vec<u8>)> = tree(folder.path(), "")
            .into_iter()
            .map(|path| (path.clone(), fs::read(folder.path().join(path)).expect("readable")))
            .collect();
        let (code, _) = limited(folder.path(), &[&args[..], &["--force", "--mirror"]].concat());
        assert_eq!(code, Some(1), "{kind:?}");
        assert_eq!(tree(folder.path(), "").len(), before.len(), "{kind:?}");
        for (path, bytes) in &before {
            assert!(fs::read(folder.path().join(path)).expect("readable") == *bytes, "{kind:?}: {path}");
        }
        refused += 1;
    }
    assert_eq!(refused, KINDS.len());
    // Only the limit causes the errors: small outputs succeed.
    let folder = with_sky();
    let small = ["bake", "sky.exr", "--size", "2", "-o", "a.ktx2", "--json", "--quiet"];
    assert_eq!(limited(folder.path(), &small).0, Some(0));
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_that_is_full_is_one_line() {
    let folder = with_sky();
    fs::write(folder.path().join("d.csv"), "x,y,z\n0,1,0\n").expect("writable");
    let cases: [&[&str]; 4] = [
        &["query", "sky.exr", "--directions", "d.csv", "--roughness", "0.5", "--quiet"],
        &["bake", "sky.exr", "--size", "2", "--json", "--quiet", "--force"],
        &["bake", "sky.exr", "--size", "2", "--dry-run", "--force"],
        &["info", "sky.exr"],
    ];
    for args in cases {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has /dev/full");
        let output = Command::new(env!("CARGO_BIN_EXE_octagloss"))
            .args(args)
            .current_dir(folder.path())
            .stdout(full)
            .output()
            .expect("it starts");
        let printed = String::from_utf8(output.stderr).expect("text");
        assert_eq!((output.status.code(), printed.lines().count()), (Some(1), 1), "{args:?}: {printed}");
        assert!(printed.contains("standard output: No space left on device"), "{args:?}: {printed}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_refuses_is_one_line() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = with_sky();
    let refusing = folder.path().join("refusing");
    fs::create_dir(&refusing).expect("writable");
    fs::set_permissions(&refusing, fs::Permissions::from_mode(0o555)).expect("ours");
    // A user who may write anywhere is still refused by /proc.
    let anywhere = fs::write(refusing.join("probe"), "").is_ok();
    let place = if anywhere { "/proc" } else { "refusing" };
    let cases: [&[&str]; 4] = [
        &["--format", "ktx2"],
        &["--format", "exr"],
        &["--target", "three"],
        &["--target", "bevy", "--json"],
    ];
    for more in cases {
        let out = format!("{place}/octagloss-test");
        let args = [&["bake", "sky.exr", "--size", "4", "-o", &out, "--quiet"], more].concat();
        fails(folder.path(), &args, 1, &out);
        assert!(!Path::new(&out).exists());
    }
    fails(folder.path(), &["synth", "furnace", "-o", &format!("{place}/furnace.exr")], 1, "furnace.exr: ");
}

/// A folder that cannot be written is found before a bake begins. For a user who may write anywhere, a folder
/// that is immutable is tried, if the file system has such.
#[cfg(target_os = "linux")]
#[test]
fn dry_runs_find_folders_that_refuse() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = with_sky();
    let refusing = folder.path().join("refusing");
    fs::create_dir(&refusing).expect("writable");
    fs::set_permissions(&refusing, fs::Permissions::from_mode(0o555)).expect("ours");
    let attribute = |flag: &str| Command::new("chattr").arg(flag).arg(&refusing).output();
    let immutable = fs::write(refusing.join("probe"), "").is_ok() && attribute("+i").is_ok();
    if fs::write(refusing.join("probe"), "").is_err() {
        for more in [
            &["-o", "refusing/a.ktx2"][..],
            &["-o", "refusing/b", "--target", "three"],
            &["-o", "refusing/c/"],
        ] {
            for dry in [&["--dry-run"][..], &[]] {
                let args = [&["bake", "sky.exr", "--size", "16", "--quiet"], more, dry].concat();
                fails(folder.path(), &args, 1, "refusing");
            }
        }
        let convert = ["convert", "sky.exr", "-o", "refusing/a.exr", "--layout", "cube"];
        fails(folder.path(), &convert, 1, "refusing/a.exr: its folder ");
    }
    if immutable {
        attribute("-i").expect("it ran before");
    }
}
