//! `octagloss analyze --plot` in a build without the feature `plot`.

use crate::cli::{fails, names, octagloss};
use tempfile::TempDir;

#[test]
fn plot_prints_the_command_that_runs_it() {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path();
    for more in [&["-o", "figures"][..], &["-o", "all figures", "--map", "cube"]] {
        let args = [&["analyze", "--plot"], more].concat();
        let expected = "run: cargo run --release --features plot -- analyze --plot -o ";
        fails(folder, &args, 2, expected);
        let printed = octagloss(folder, &args).err;
        let end = if more.len() > 2 { "-o 'all figures' --map cube" } else { "-o figures" };
        assert!(printed.trim_end().ends_with(end), "{printed}");
    }
    assert_eq!(names(folder), [""; 0]);
}
