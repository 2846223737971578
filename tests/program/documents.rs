//! Files that documents name.

use std::path::Path;

#[test]
fn documents_name_files_that_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut count = 0;
    for document in ["docs/architecture.md", "docs/contributing.md", "docs/extending.md"] {
        let text = std::fs::read_to_string(root.join(document)).expect("a document");
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
