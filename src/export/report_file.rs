//! Reports beside the files of a bake: where they lie. Readers use them by [`crate::io::provenance`].

use crate::io::side_report::REPORT;
use std::path::{Path, PathBuf};

/// Where the report of the single file `path` lies.
#[must_use]
pub fn report_path(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".");
    name.push(REPORT);
    name.into()
}
