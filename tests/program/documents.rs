//! Files that documents name, and what rustfmt does not look at.

use std::fs;
use std::path::{Path, PathBuf};

#[test]
fn documents_name_files_that_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut count = 0;
    for document in ["docs/architecture.md", "docs/contributing.md", "docs/extending.md"] {
        let text = fs::read_to_string(root.join(document)).expect("a document");
        // The npm and Python packages are not in the crate's.
        let is_path = |word: &&str| {
            ["crates/", "src/", "shaders/", "tests/"].iter().any(|folder| word.starts_with(folder))
                && !word.contains("NAME")
                && word.chars().all(|c| c.is_ascii_alphanumeric() || "/._-".contains(c))
        };
        for path in text.split('`').skip(1).step_by(2).filter(is_path) {
            assert!(root.join(path).exists(), "{document} names {path}, which there is not");
            count += 1;
        }
    }
    assert!(count > 40, "{count}");
}

/// A file that no `mod` names is never compiled, and its tests never run.
#[test]
fn every_file_of_tests_is_a_module() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let suites = ["core", "drawing", "gpu", "mesh", "program", "view", "workbench"];
    let mut folders = suites.map(|suite| root.join(suite)).to_vec();
    let mut count = 0;
    while let Some(folder) = folders.pop() {
        let text = |path: PathBuf| fs::read_to_string(path).unwrap_or_default();
        let parents = ["main.rs", "mod.rs"].map(|name| text(folder.join(name))).concat()
            + &text(folder.with_extension("rs"));
        for entry in fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.file_stem().expect("a name").to_str().expect("text");
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs")
                && !["main", "mod"].contains(&name)
            {
                assert!(parents.contains(&format!("mod {name};")), "no module is {}", path.display());
                count += 1;
            }
        }
    }
    assert!(count > 100, "{count}");
}

/// rustfmt breaks lines of code, not those of comments, and none of WGSL.
#[test]
fn no_line_is_wider_than_110_columns() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    // The npm and Python packages are not in the crate's.
    let all = ["crates", "src", "shaders", "tests", "examples", "npm/src", "python/src"];
    let mut folders: Vec<_> =
        all.map(|name| root.join(name)).into_iter().filter(|path| path.exists()).collect();
    let mut count = 0;
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.extend((!path.ends_with("target")).then_some(path));
            } else if let Some("rs" | "wgsl") = path.extension().and_then(|extension| extension.to_str()) {
                let is_wgsl = path.extension().is_some_and(|extension| extension == "wgsl");
                let text = fs::read_to_string(&path).expect("a text");
                for (line, number) in text.lines().zip(1..) {
                    let counts = is_wgsl || line.trim_start().starts_with("//");
                    let is_wide = counts && line.chars().count() > 110;
                    assert!(!is_wide, "{}:{number} is wider than 110 columns", path.display());
                }
                count += 1;
            }
        }
    }
    assert!(count > 400, "{count} files");
}
