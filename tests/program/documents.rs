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

/// All files in `folder` and below it, but for what builds leave.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true if path.ends_with("target") => {}
            true => files.extend(files_below(&path)),
            false => files.push(path),
        }
    }
    files
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|own| own == extension)
}

/// A file that no `mod` names is never compiled, and its tests never run.
#[test]
fn every_file_of_tests_is_a_module() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let suites = ["core", "drawing", "gpu", "mesh", "program", "view", "workbench"];
    let mut count = 0;
    for path in suites.iter().flat_map(|suite| files_below(&root.join(suite))) {
        let name = path.file_stem().expect("a name").to_str().expect("text");
        if has_extension(&path, "rs") && !["main", "mod"].contains(&name) {
            let folder = path.parent().expect("a folder");
            let text = |path: PathBuf| fs::read_to_string(path).unwrap_or_default();
            let parents = ["main.rs", "mod.rs"].map(|name| text(folder.join(name))).concat()
                + &text(folder.with_extension("rs"));
            assert!(parents.contains(&format!("mod {name};")), "no module is {}", path.display());
            count += 1;
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
    let folders = all.map(|name| root.join(name)).into_iter().filter(|folder| folder.exists());
    let mut count = 0;
    for path in folders.flat_map(|folder| files_below(&folder)) {
        let is_wgsl = has_extension(&path, "wgsl");
        if is_wgsl || has_extension(&path, "rs") {
            let text = fs::read_to_string(&path).expect("a text");
            for (line, number) in text.lines().zip(1..) {
                let counts = is_wgsl || line.trim_start().starts_with("//");
                let is_wide = counts && line.chars().count() > 110;
                assert!(!is_wide, "{}:{number} is wider than 110 columns", path.display());
            }
            count += 1;
        }
    }
    assert!(count > 400, "{count} files");
}
