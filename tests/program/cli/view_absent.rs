//! `octagloss view` in a build without the feature `view`.

use crate::cli::{done, fails, names};
use tempfile::TempDir;

#[test]
fn view_prints_the_command_that_runs_it() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    let command = "run: cargo run --release --features view -- view";
    let cases: [(&[&str], &str); 4] = [
        (&[], ""),
        (&["hdr/sky.exr", "--screenshot", "knot.png"], " hdr/sky.exr --screenshot knot.png"),
        (&["--screenshot", "a knot.png"], " --screenshot 'a knot.png'"),
        (&["it's", "-q", "--", ""], r" 'it'\''s' -q -- ''"),
    ];
    for (args, printed) in cases {
        let expected = crate::cli::with_slashes(&format!("{command}{printed}"));
        fails(folder, &[&["view"], args].concat(), 2, &expected);
        let ran = crate::cli::octagloss(folder, &[&["view"], args].concat());
        assert!(ran.err.trim_end().ends_with(&expected), "{args:?}: {}", ran.err);
    }
    assert!(done(folder, &["--help"]).out.contains("view"));
    assert_eq!(names(folder), [""; 0]);
}
