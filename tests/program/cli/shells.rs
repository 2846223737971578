//! Completions and manual pages.

use super::{done, fails, names, with_slashes};
use std::fs;
use std::io::Write as _;
use std::process::{Command, Stdio};
use tempfile::TempDir;

const COMMANDS: [&str; 13] = [
    "bake",
    "query",
    "info",
    "compare",
    "bench",
    "synth",
    "dfg",
    "convert",
    "view",
    "completions",
    "man",
    "licenses",
    "reader",
];

#[test]
fn completions_are_scripts_that_know_every_subcommand_and_option() {
    let folder = TempDir::new().expect("a temporary folder");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let ran = done(folder.path(), &["completions", shell]);
        assert_eq!(ran.err, "", "{shell}");
        for command in COMMANDS {
            assert!(ran.out.contains(command), "{shell} lacks {command}");
        }
        for option in ["extract-sun", "skip-unchanged", "rotate-y", "recursive"] {
            assert!(ran.out.contains(option), "{shell} lacks --{option}");
        }
    }
    fails(folder.path(), &["completions", "csh"], 2, "bash, elvish, fish, powershell, zsh");
    fails(folder.path(), &["completions"], 2, "<SHELL>");
}

#[test]
fn licenses_that_are_not_in_the_program_are_said_to_be_in_the_release() {
    let folder = TempDir::new().expect("a temporary folder");
    fails(folder.path(), &["licenses"], 1, "THIRD-PARTY-LICENSES.txt of the release");
}

#[test]
fn the_bash_completion_is_parsed_by_bash_and_completes() {
    let folder = TempDir::new().expect("a temporary folder");
    let script = done(folder.path(), &["completions", "bash"]).out;
    let bash = |options: &[&str], text: &str| {
        let mut bash =
            Command::new("bash").args(options).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().ok()?;
        bash.stdin.take().expect("a pipe").write_all(text.as_bytes()).expect("read");
        Some(bash.wait_with_output().expect("it ends"))
    };
    // Systems without bash have nothing to test here.
    let Some(parsed) = bash(&["-n"], &script) else { return };
    assert!(parsed.status.success(), "bash -n: {}", String::from_utf8_lossy(&parsed.stderr));
    assert!(!bash(&["-n"], "if").expect("bash").status.success(), "what is no script fails");
    let ask = format!(
        "{script}\nCOMP_WORDS=(octagloss bake --skip); COMP_CWORD=2\n_octagloss octagloss --skip bake\n\
         echo \"${{COMPREPLY[@]}}\"\n"
    );
    let answer = bash(&["--norc"], &ask).expect("bash");
    assert_eq!(String::from_utf8_lossy(&answer.stdout).trim(), "--skip-unchanged");
}

#[test]
fn manual_pages_tell_of_every_subcommand() {
    let folder = TempDir::new().expect("a temporary folder");
    let main = done(folder.path(), &["man"]).out;
    assert!(main.starts_with(".ie") && main.contains(".TH octagloss 1"), "{main}");
    for command in COMMANDS {
        assert!(
            main.replace(&with_slashes("\\-"), "-").contains(&format!("octagloss-{command}(1)")),
            "no {command}"
        );
    }
    let ran = done(folder.path(), &["man", "-o", "pages/man1"]);
    assert_eq!(ran.out, "");
    assert!(ran.err.contains("14 manual pages"), "{}", ran.err);
    let pages = folder.path().join("pages/man1");
    let mut expected: Vec<String> = COMMANDS.map(|command| format!("octagloss-{command}.1")).to_vec();
    expected.push("octagloss.1".to_owned());
    expected.sort();
    assert_eq!(names(&pages), expected);
    let bake = fs::read_to_string(pages.join("octagloss-bake.1")).expect("a page").replace("\\-", "-");
    for words in [".TH octagloss-bake 1", "octagloss bake", "--skip-unchanged", "adaptive:E"] {
        assert!(bake.contains(words), "no {words} in {bake}");
    }
    assert_eq!(with_slashes(&fs::read_to_string(pages.join("octagloss.1")).expect("a page")), main);

    fails(folder.path(), &["man", "-o", "pages/man1"], 1, "already exists; --force");
    fs::write(pages.join("octagloss.1"), "old").expect("writable");
    done(folder.path(), &["man", "-o", "pages/man1", "--force", "--quiet"]);
    assert_eq!(with_slashes(&fs::read_to_string(pages.join("octagloss.1")).expect("a page")), main);
    fs::write(folder.path().join("file"), "").expect("writable");
    fails(folder.path(), &["man", "-o", "file"], 1, "file");
}
