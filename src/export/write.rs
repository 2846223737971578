//! Writes a bake without a target.

use super::files::files;
use crate::bake::Bake;
use crate::error::{Error, Result};
use crate::format::container::Container;
use crate::format::{OutputLayout, Pixel};
use crate::io::output::{self, Existing, Output};
use crate::target::{Diffuse, TargetPlan, UNTARGETED};
use std::path::Path;

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
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        let named = extension.as_deref().and_then(Container::named);
        let container = options.container.or(named).ok_or_else(|| {
            let path = path.display();
            Error::Parameter(format!(
                "{path}: the name ends in none of .ktx2 .ktx .dds .exr; set `container`"
            ))
        })?;
        let layout = options.layout;
        let is_images = !container.is_single() && !matches!(layout, OutputLayout::Parts | OutputLayout::Mips);
        let pixel = options.pixel.unwrap_or(match container {
            Container::Hdr => Pixel::Rgbe,
            Container::Exr if is_images => Pixel::Auto,
            _ => Pixel::F16,
        });
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
        let made = files(&plan, &name, self, &options.metadata)?;
        let outputs = if plan.is_single() {
            let (inside, outside): (Vec<_>, Vec<_>) = made.iter().partition(|file| file.path.contains('/'));
            let file = |path: &str| path.split_once('/').map_or(path, |(_, file)| file).to_owned();
            let bounds: Vec<_> = inside.iter().map(|made| (file(&made.path), &made.bytes[..])).collect();
            let folder = (!bounds.is_empty())
                .then(|| (path.with_file_name(format!("{name}.bounds")), Output::Folder(bounds)));
            let outside = outside.into_iter().map(|made| {
                let place = if made.path == name { path.to_owned() } else { path.with_file_name(&made.path) };
                (place, Output::File(&made.bytes))
            });
            outside.chain(folder).collect()
        } else {
            let files = made.iter().map(|made| (made.path.clone(), &made.bytes[..])).collect();
            vec![(path.to_owned(), Output::Folder(files))]
        };
        output::commit(output::stage_all(&outputs, options.existing)?)
    }
}
