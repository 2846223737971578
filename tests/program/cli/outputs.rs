//! Outputs of the program: links and streams, folder names, leftovers of killed runs, signals, and two
//! concurrent processes.

use crate::cli::{done, fails, json_file, names, octagloss, with_sky, with_slashes};
use octagloss_core::files::io::output::{self, Existing};
use std::fs;
use std::path::Path;
use std::process::Command;
#[cfg(unix)]
use std::process::Stdio;

const SMALL: [&str; 8] = ["bake", "sky.exr", "--size", "4", "--engine", "cpu", "--filter", "box"];

fn small(more: &[&str]) -> Vec<&'static str> {
    let args = [&SMALL[..], &["--quiet"], more].concat();
    args.into_iter().map(|arg| &*String::leak(arg.to_owned())).collect()
}

#[cfg(unix)]
#[test]
fn links_are_followed_even_where_they_lead_nowhere_yet() {
    let folder = with_sky();
    let link = folder.path().join("link.ktx2");
    std::os::unix::fs::symlink("real.ktx2", &link).expect("a link");
    std::os::unix::fs::symlink("levels", folder.path().join("link")).expect("a link");
    for force in [&[][..], &["--force"]] {
        done(folder.path(), &small(&[&["-o", "link.ktx2"], force].concat()));
        done(folder.path(), &small(&[&["--format", "exr", "-o", "link"], force].concat()));
        for name in ["link.ktx2", "link"] {
            let found = fs::symlink_metadata(folder.path().join(name)).expect("there");
            assert!(found.is_symlink(), "{name} was replaced");
        }
        assert!(folder.path().join("real.ktx2").is_file() && folder.path().join("levels").is_dir());
    }
    std::os::unix::fs::symlink("circle", folder.path().join("circle")).expect("a link");
    fails(folder.path(), &small(&["-o", "circle", "--force"]), 1, "circle");
}

#[cfg(target_os = "linux")]
#[test]
fn streams_and_devices_are_no_outputs() {
    let folder = with_sky();
    std::os::unix::fs::symlink("/dev/stdout", folder.path().join("link.ktx2")).expect("a link");
    let before = names(folder.path());
    for place in ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1", "link.ktx2", "/dev/null"] {
        for force in [&[][..], &["--force"]] {
            fails(folder.path(), &small(&[&["-o", place], force].concat()), 1, "-o -");
        }
    }
    std::os::unix::fs::symlink("/dev/stdout", folder.path().join("f.exr")).expect("a link");
    fails(folder.path(), &["synth", "furnace", "-o", "f.exr", "--force"], 1, "-o -");
    fs::remove_file(folder.path().join("f.exr")).expect("a link");
    // Standard output is a deleted file: its name must not be used as a path.
    let script = r#"exec >gone; rm gone; exec "$0" "$@""#;
    let args = small(&["-o", "/dev/stdout", "--force"]);
    let mut sh = Command::new("sh");
    sh.args(["-c", script, env!("CARGO_BIN_EXE_octagloss")]).args(args).stderr(Stdio::null());
    assert_eq!(sh.current_dir(folder.path()).status().expect("sh starts").code(), Some(1));
    assert!(fs::symlink_metadata("/dev/stdout").expect("there").is_symlink());
    assert_eq!(names(folder.path()), before);
}

/// Returns the standard output of the program.
fn standard_output(folder: &Path, args: &[&str]) -> Vec<u8> {
    let ran = Command::new(env!("CARGO_BIN_EXE_octagloss")).current_dir(folder).args(args).output();
    let ran = ran.expect("the program starts");
    assert!(ran.status.success(), "{args:?}: {}", String::from_utf8_lossy(&ran.stderr));
    ran.stdout
}

#[test]
fn a_dash_is_standard_output_and_takes_one_file() {
    let folder = with_sky();
    for (name, options) in [
        ("a.ktx2", &[][..]),
        ("a.ktx", &["--format", "ktx"]),
        ("a.dds", &["--format", "dds"]),
        ("a.exr", &["--out-layout", "parts"]),
    ] {
        done(folder.path(), &small(&[options, &["-o", name]].concat()));
        let before = names(folder.path());
        let bytes = standard_output(folder.path(), &small(&[options, &["-o", "-"]].concat()));
        assert!(bytes == fs::read(folder.path().join(name)).expect("written"), "{name}");
        assert_eq!(names(folder.path()), before);
    }
    done(folder.path(), &["synth", "furnace", "-o", "f.exr"]);
    let before = names(folder.path());
    let bytes = standard_output(folder.path(), &["synth", "furnace", "-o", "-"]);
    assert!(bytes == fs::read(folder.path().join("f.exr")).expect("written"));
    assert!(standard_output(folder.path(), &["dfg", "--size", "2", "-o", "-"]).starts_with(&ktx2::MAGIC));
    for (more, words) in [
        (&["--json"][..], "--json"),
        (&["--irradiance", "2"], "--irradiance"),
        (&["--preview", "p.png"], "--preview"),
        (&["--extract-sun"], "--extract-sun"),
        (&["--skip-unchanged"], "--skip-unchanged"),
        (&["--bounds", "--filter", "adaptive:0.1"], "--bounds"),
        (&["--format", "exr"], "--out-layout parts"),
        (&["--target", "three"], "--target"),
        (&["f.exr"], "one input"),
    ] {
        let args: Vec<&str> = if more.contains(&"--filter") {
            [&["bake", "sky.exr", "--size", "4", "-o", "-"], more].concat()
        } else {
            small(&[&["-o", "-"], more].concat())
        };
        fails(folder.path(), &args, 2, words);
    }
    assert_eq!(names(folder.path()), before);
}

#[cfg(target_os = "linux")]
#[test]
fn an_unwritable_standard_output_is_an_error() {
    let folder = with_sky();
    let run = |redirect: &str, args: &[&str]| {
        let mut sh = Command::new("sh");
        sh.args(["-c", &format!(r#"exec "$0" "$@" {redirect}"#), env!("CARGO_BIN_EXE_octagloss")]).args(args);
        let ran = sh.current_dir(folder.path()).stdout(Stdio::null()).output().expect("sh starts");
        (ran.status.code().expect("no signal"), String::from_utf8_lossy(&ran.stderr).into_owned())
    };
    let bake = small(&["-o", "-"]);
    for args in [&bake[..], &["synth", "furnace", "-o", "-"], &["dfg", "--size", "2", "-o", "-"]] {
        let (code, text) = run(">&-", args);
        assert!(code == 1 && text.contains("standard output, which is closed"), "{args:?}: {code} {text}");
        // Open for reading only.
        let (code, text) = run("1<sky.exr", args);
        assert!(code == 1 && text.contains("standard output: "), "{args:?}: {code} {text}");
        let (code, text) = run(">/dev/full", args);
        assert!(code == 1 && text.contains("standard output: "), "{args:?}: {code} {text}");
        assert_eq!(run(">/dev/null", args).0, 0, "{args:?}: the data is discarded");
        assert_eq!(run("| true", args).0, 0, "{args:?}: a broken pipe");
    }
    // Messages instead of data.
    assert_eq!(run(">&-", &["info", "sky.exr"]).0, 0);
    assert_eq!(run("1<sky.exr", &["info", "sky.exr"]).0, 1);
}

#[test]
fn folders_are_not_named_as_files_and_a_slash_names_a_folder() {
    let folder = with_sky();
    for (name, more) in [
        ("foo.hdr", &[][..]),
        ("foo.exr", &[]),
        ("foo.exr", &["--format", "exr"]),
        ("foo.exr", &["--out-layout", "cross"]),
        ("foo.ktx2", &["--target", "three"]),
    ] {
        fails(folder.path(), &small(&[&["-o", name], more].concat()), 2, "-o foo");
    }
    fails(folder.path(), &small(&["-o", "foo.hdr"]), 2, "--out-layout");
    assert_eq!(names(folder.path()), ["sky.exr"]);
    for _ in 0..2 {
        done(folder.path(), &small(&["-o", "into/", "--force"]));
        assert_eq!(names(&folder.path().join("into")), ["sky.ktx2", "sky.ktx2.report.json"]);
    }
    done(folder.path(), &small(&["-o", "levels/", "--format", "exr"]));
    assert!(names(&folder.path().join("levels")).contains(&"m0_px.exr".to_owned()));
    // A folder that holds the input is not replaced.
    let inputs: Vec<String> =
        ["px", "nx", "py", "ny", "pz", "nz"].iter().map(|face| format!("levels/m0_{face}.exr")).collect();
    let mut args = vec!["bake"];
    args.extend(inputs.iter().map(String::as_str));
    args.extend(["--layout", "faces", "-o", "levels", "--format", "exr", "--force"]);
    fails(folder.path(), &args, 2, "holds an input");
}

#[test]
fn a_dry_run_prints_json_where_asked() {
    let folder = with_sky();
    for (more, path) in
        [(&["-o", "a.ktx2"][..], "a.ktx2"), (&["--target", "three", "-o", "a"], "a/sky_pmrem.ktx2")]
    {
        let ran = done(folder.path(), &small(&[more, &["--json", "--dry-run"]].concat()));
        let line: serde_json::Value = serde_json::from_str(&ran.out).expect("a line of JSON");
        assert_eq!((&line["input"], &line["files"][0]["path"]), (&"sky.exr".into(), &path.into()));
    }
}

#[test]
fn leftovers_go_when_their_lock_is_free_and_set_aside_folders_come_back() {
    let folder = with_sky();
    let at = |name: &str| folder.path().join(name);
    fs::write(at(".octagloss-dead01.lock"), "a.ktx2").expect("writable");
    fs::write(at(".octagloss-dead01.new"), "half").expect("writable");
    fs::write(at(".octagloss-dead02.lock"), "").expect("writable");
    fs::write(at(".octagloss-live01.lock"), "a.ktx2").expect("writable");
    fs::write(at(".octagloss-live01.new"), "half").expect("writable");
    let live = fs::File::options().read(true).write(true).open(at(".octagloss-live01.lock")).expect("there");
    live.lock().expect("locked");
    // A lock that contains a path instead of a name is left alone.
    fs::write(at(".octagloss-evil01.lock"), "../a").expect("writable");
    fs::write(at(".octagloss-evil01.new"), "half").expect("writable");
    // A run killed between two renames.
    fs::create_dir(at(".octagloss-dead03.old")).expect("a folder");
    fs::write(at(".octagloss-dead03.old/m0_px.exr"), "old").expect("writable");
    fs::create_dir(at(".octagloss-dead03.new")).expect("a folder");
    fs::write(at(".octagloss-dead03.lock"), "levels").expect("writable");
    fails(folder.path(), &small(&["-o", "levels", "--format", "exr"]), 1, "already exists");
    assert_eq!(fs::read(at("levels/m0_px.exr")).expect("back"), b"old");
    let left = [
        ".octagloss-evil01.lock",
        ".octagloss-evil01.new",
        ".octagloss-live01.lock",
        ".octagloss-live01.new",
        "levels",
        "sky.exr",
    ];
    assert_eq!(names(folder.path()), left);
    // Unlock instead of closing: a process that another test forks meanwhile holds a copy until it runs.
    // On Windows none does, and Wine does not unlock.
    if cfg!(unix) {
        live.unlock().expect("unlocked");
    }
    drop(live);
    // A folder that was set aside and replaced is removed.
    fs::create_dir(at(".octagloss-dead04.old")).expect("a folder");
    fs::write(at(".octagloss-dead04.lock"), "levels").expect("writable");
    assert!(output::recover(&at("other")).is_empty());
    assert_eq!(
        names(folder.path()),
        [".octagloss-evil01.lock", ".octagloss-evil01.new", "levels", "sky.exr"]
    );
}

#[test]
fn several_outputs_are_committed_together_or_not_at_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    for name in ["a", "b"] {
        fs::write(at(name), "old").expect("writable");
    }
    let stage = |name: &str, existing| output::stage_file(&at(name), existing, |file| file.write_all(b"new"));
    let staged = |existing| ["a", "c", "b"].map(|name| stage(name, existing));
    let outputs: Vec<_> = staged(Existing::Replace).into_iter().collect::<Result<_, _>>().expect("staged");
    // The last output has become a folder meanwhile.
    fs::remove_file(at("b")).expect("there");
    fs::create_dir(at("b")).expect("a folder");
    let message = output::commit(outputs).expect_err("a folder is in the way").to_string();
    assert!(message.contains("is a folder"), "{message}");
    assert_eq!(names(folder.path()), ["a", "b"]);
    assert_eq!(fs::read(at("a")).expect("there"), b"old");
}

#[test]
fn a_report_is_not_taken_for_that_of_another_file() {
    let folder = with_sky();
    let at = |name: &str| folder.path().join(name);
    for (name, turned) in [("a.dds", "0"), ("b.dds", "90")] {
        done(folder.path(), &small(&["-o", name, "--rotate-y", turned]));
        octagloss_core::files::io::read_chain(&at(name)).expect("its report states its roughness");
    }
    assert_eq!(json_file(&at("a.dds.report.json"))["fingerprint"]["files"]["a.dds"], hash(&at("a.dds")));
    // The state after a kill between writing the file and its report.
    fs::copy(at("b.dds"), at("a.dds")).expect("copied");
    octagloss_core::files::io::read_chain(&at("a.dds")).expect_err("the report is of another file");
    // A report of version 0.1 has no such hash: it is trusted, and removed before its file is replaced.
    let mut old = json_file(&at("b.dds.report.json"));
    old["fingerprint"].as_object_mut().expect("an object").remove("files");
    fs::write(at("b.dds.report.json"), old.to_string()).expect("writable");
    octagloss_core::files::io::read_chain(&at("b.dds")).expect("an old report is trusted");
    done(folder.path(), &small(&["-o", "b.dds", "--force", "--json"]));
    assert!(!at("b.dds.report.json").exists());
}

/// Returns the hash of a file in the reports' form.
fn hash(path: &Path) -> String {
    blake3::hash(&fs::read(path).expect("readable")).to_hex().to_string()
}

#[test]
fn two_processes_on_one_output_leave_files_of_one_each() {
    let folder = with_sky();
    let at = |name: &str| folder.path().join(name);
    let turns = ["0", "90", "180", "270"];
    let known = turns.map(|turn| {
        done(folder.path(), &small(&["-o", "one.ktx2", "--force", "--rotate-y", turn]));
        (hash(&at("one.ktx2")), turn)
    });
    for (out, format) in [("a.ktx2", "ktx2"), ("a", "exr")] {
        let run = |turn: &&str| {
            let args = small(&["-o", out, "--format", format, "--force", "--rotate-y", turn]);
            let mut command = Command::new(env!("CARGO_BIN_EXE_octagloss"));
            command.current_dir(folder.path()).args(args).spawn().expect("the program starts")
        };
        for mut child in turns.iter().map(run).collect::<Vec<_>>() {
            assert!(child.wait().expect("it ends").success());
        }
        if format == "ktx2" {
            let written = hash(&at(out));
            let (_, turn) = known.iter().find(|(known, _)| *known == written).expect("one of the four");
            let report = json_file(&at("a.ktx2.report.json"));
            let is_its = report["fingerprint"]["files"]["a.ktx2"] == written;
            assert!(!is_its || report["recipe"]["rotate_y"] == turn.parse::<f64>().expect("a number"));
        } else {
            assert_eq!(names(&at(out)).len(), 3 * 6 + 1);
        }
        assert!(names(folder.path()).iter().all(|name| !name.starts_with(".octagloss-")), "{out}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn signals_remove_temporary_files() {
    // Bakes a folder and sends `signal` while it is written; returns the exit status if the signal came in
    // time.
    let interrupted = |signal: &str, script: &str| {
        let folder = with_sky();
        let options = ["--size", "512", "--filter", "box", "--engine", "cpu", "--quiet"];
        let mut child = Command::new("sh")
            .args([
                "-c",
                script,
                env!("CARGO_BIN_EXE_octagloss"),
                "bake",
                "sky.exr",
                "-o",
                "a",
                "--format",
                "exr",
            ])
            .args(options)
            .current_dir(folder.path())
            .spawn()
            .expect("sh starts");
        let writes = || names(folder.path()).iter().any(|name| name.ends_with(".new"));
        while !writes() && child.try_wait().expect("a child").is_none() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        let in_time = writes();
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().is_ok());
        let status = child.wait().expect("it ends");
        assert!(names(folder.path()).iter().all(|name| !name.starts_with(".octagloss-")), "{signal}");
        in_time.then_some(status.code())
    };
    // The test runner may have set signals to be ignored.
    let run = r#"exec env --default-signal=INT,HUP,TERM "$0" "$@""#;
    for (signal, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        // A bake that completed before the signal ends with 0.
        let codes = (0..50).filter_map(|_| interrupted(signal, run)).filter(|code| *code != Some(0));
        let codes: Vec<_> = codes.take(1).collect();
        assert!(!codes.is_empty() && codes.iter().all(|found| *found == Some(code)), "{signal}: {codes:?}");
    }
    let nohup = r#"trap "" HUP; exec "$0" "$@""#;
    assert_eq!((0..50).find_map(|_| interrupted("-HUP", nohup)), Some(Some(0)), "nohup");
}

#[test]
fn bad_fields_are_quoted_and_shortened() {
    let folder = with_sky();
    let query = |text: &str| {
        fs::write(folder.path().join("d.csv"), text).expect("writable");
        let ran =
            octagloss(folder.path(), &["query", "sky.exr", "--directions", "d.csv", "--roughness", "1"]);
        assert_eq!(ran.code, 1);
        assert!(ran.err.len() < 400, "{} bytes", ran.err.len());
        assert!(ran.err.chars().all(|c| c == '\n' || !c.is_control()), "{:?}", ran.err);
        ran.err
    };
    let long = "9x".repeat(400);
    let printed = query(&format!("x,y,z\n1,{long},0\n"));
    assert!(printed.contains("800 bytes") && printed.contains("line 2: y"), "{printed}");
    query(&format!("x,y,{long}\n"));
    let long = "9x".repeat(1 << 20);
    assert!(query(&format!("x,y,z\n1,{long},0\n")).contains("line 2 is longer than 1000 bytes"));
    assert!(query("x,y,z\n1,\u{1b}[31m\u{7}2,0\n").contains(&with_slashes(r"\u{1b}[31m")));
    assert!(query("x,y,z\n1,infinity,0\n").contains("y is inf; it must be finite"));
    // Arbitrary content in a report.
    fs::write(folder.path().join("bad.dds.report.json"), format!(r#"{{"levels": "{long}\u001b"}}"#))
        .expect("writable");
    done(folder.path(), &small(&["-o", "a.dds"]));
    fs::copy(folder.path().join("a.dds"), folder.path().join("bad.dds")).expect("copied");
    let ran = octagloss(folder.path(), &["compare", "bad.dds", "a.dds"]);
    assert!(ran.code == 1 && ran.err.len() < 7000, "{} bytes", ran.err.len());
}

#[test]
fn no_input_is_written_over_and_no_output_by_another_input() {
    let folder = with_sky();
    let at = |name: &str| folder.path().join(name);
    done(folder.path(), &small(&["-o", "a.ktx2"]));
    // A picture that would overwrite its source.
    fs::copy(at("sky.exr"), at("sky.png")).expect("copied");
    let picture = ["compare", "a.ktx2", "sky.png", "--picture", "sky.png", "--force"];
    fails(folder.path(), &picture, 2, "sky.png is an input");
    assert_eq!(fs::read(at("sky.png")).expect("there"), fs::read(at("sky.exr")).expect("there"));
    // One input's irradiance is another's main file.
    fs::copy(at("sky.exr"), at("sky.irradiance.exr")).expect("copied");
    let two = ["bake", "sky.exr", "sky.irradiance.exr", "--irradiance", "4", "--size", "16", "-o", "both"];
    fails(folder.path(), &two, 2, "sky.irradiance.ktx2 is named for two outputs");
    assert!(!at("both").exists());
}
