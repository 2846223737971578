#![no_main]

//! The input is the report of a folder with two levels of faces.

use libfuzzer_sys::fuzz_target;
use octagloss_core::files::io::hdr::hdr_bytes;
use octagloss_core::files::io::read_chain;
use octagloss_fuzz::assert_plain;
use std::sync::LazyLock;

static FOLDER: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (level, size) in [(0, 2_u32), (1, 1)] {
        let face = hdr_bytes(size, size, &vec![[0.5; 3]; (size * size) as usize], &[]).expect("a face");
        for name in ["px", "nx", "py", "ny", "pz", "nz"] {
            std::fs::write(folder.path().join(format!("m{level}_{name}.hdr")), &face).expect("a file");
        }
    }
    folder
});

fuzz_target!(|bytes: &[u8]| {
    let folder = FOLDER.path();
    std::fs::write(folder.join("report.json"), bytes).expect("a report");
    if let Err(error) = read_chain(folder) {
        assert_plain(&error.to_string());
    }
});
