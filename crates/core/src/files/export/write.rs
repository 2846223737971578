//! Writes a bake without a target.

use super::files::files;
use crate::bake::Bake;
use crate::common::error::{Error, Result};
use crate::files::format::container::Container;
use crate::files::format::{OutputLayout, Pixel};
use crate::files::io::output::{self, Existing, Output};
use crate::files::target::{Diffuse, TargetPlan, UNTARGETED};
use std::path::{Path, PathBuf};

/// Options of [`Bake::write`].
#[derive(Clone, Debug, Default)]
pub struct WriteOptions {
    /// The format; `None` to derive it from the path's extension.
    pub container: Option<Container>,
    /// The pixel format; `None` for half floats (in folders of EXR images floats if half floats are
    /// insufficient), and RGBE in Radiance images.
    pub pixel: Option<Pixel>,
    /// Layout of the levels in files.
    pub layout: OutputLayout,
    /// Policy for an output that already exists.
    pub existing: Existing,
    /// Key/value pairs for containers that support them.
    pub metadata: Vec<(String, String)>,
}

impl Bake {
    /// Writes the levels to `path`: a file, or a folder of images if [`WriteOptions`] select one. Irradiance,
    /// skybox and bounds go into the folder, or next to the file under its name. All outputs are written or
    /// none.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a path whose extension names no format, for pixels or levels that the format
    /// cannot hold, and for levels that were changed into no chain; [`Error::Io`] if a file cannot be
    /// written.
    pub fn write(&self, path: impl AsRef<Path>, options: &WriteOptions) -> Result<()> {
        self.check()?;
        let path = path.as_ref();
        let container = options.container.or_else(|| Container::of_path(path)).ok_or_else(|| {
            let path = path.display();
            Error::Parameter(format!("{path}: the name ends in none of .ktx2 .ktx .dds .exr; set `format`"))
        })?;
        let layout = options.layout;
        let pixel = options.pixel.unwrap_or(container.default_pixel(layout));
        let diffuse = if self.irradiance.is_some() { Diffuse::Cube } else { Diffuse::None };
        let plan = TargetPlan {
            container,
            pixel,
            layout,
            diffuse,
            skybox: self.skybox.is_some(),
            ..TargetPlan::new(&UNTARGETED)
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let made = files(&plan, &name, self, &options.metadata, |_| None)?;
        let files = made.iter().map(|made| (made.path.clone(), &made.bytes[..]));
        write_files(path, plan.is_single(), files, options.existing)
    }
}

/// Writes `files` as [`outputs`] places them; all or none.
///
/// # Errors
/// [`Error::Io`] if one of them cannot be written.
pub fn write_files<'a>(
    path: &Path,
    is_file: bool,
    files: impl IntoIterator<Item = (String, &'a [u8])>,
    existing: Existing,
) -> Result<()> {
    output::commit(output::stage_all(&outputs(path, is_file, files), existing)?)
}

/// The files and folders that hold `files`: the folder `path`; or if it `is_file` the file, which has its
/// name among `files`, and what is next to it.
pub fn outputs<'a>(
    path: &Path,
    is_file: bool,
    files: impl IntoIterator<Item = (String, &'a [u8])>,
) -> Vec<(PathBuf, Output<'a>)> {
    if !is_file {
        let mut files: Vec<_> = files.into_iter().collect();
        files.sort();
        return vec![(path.to_owned(), Output::Folder(files))];
    }
    let main = path.file_name().unwrap_or_default().to_string_lossy();
    let mut outputs: Vec<(PathBuf, Output<'a>)> = Vec::new();
    for (name, bytes) in files {
        let Some((folder, name)) = name.split_once('/') else {
            let place = if name == main { path.to_owned() } else { path.with_file_name(name) };
            outputs.push((place, Output::File(bytes)));
            continue;
        };
        let (folder, name) = (path.with_file_name(folder), name.to_owned());
        match outputs.iter_mut().find(|(place, _)| *place == folder) {
            Some((_, Output::Folder(files))) => files.push((name, bytes)),
            _ => outputs.push((folder, Output::Folder(vec![(name, bytes)]))),
        }
    }
    outputs
}
