//! A bake written from memory, without a target.

use super::files::files;
use crate::bake::Bake;
use crate::error::{Error, Result};
use crate::format::container::Container;
use crate::format::{OutputLayout, Pixel};
use crate::io::output::{self, Existing, Output};
use crate::target::{Diffuse, Plan, UNTARGETED};
use std::path::Path;

/// How [`Bake::write`] writes.
#[derive(Clone, Debug, Default)]
pub struct WriteOptions {
    /// The format; `None` for the one that the path's extension names.
    pub container: Option<Container>,
    /// The pixels; `None` for half floats, in folders of EXR images floats where half floats do not do, and
    /// RGBE in Radiance images.
    pub pixel: Option<Pixel>,
    /// How the levels lie in files.
    pub layout: OutputLayout,
    /// What to do about an output that is there already.
    pub existing: Existing,
    /// Key/value pairs for containers that have a place for them.
    pub metadata: Vec<(String, String)>,
}

impl Bake {
    /// Writes the levels to `path`: a file, or a folder of images where [`WriteOptions`] ask for one.
    /// Irradiance, skybox and bounds go beside a file, under its name, and into a folder. Either all is written or
    /// nothing.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a path whose extension names no format, and for pixels or levels that the
    /// format does not hold; [`Error::Io`] where a file cannot be written.
    pub fn write(&self, path: impl AsRef<Path>, options: &WriteOptions) -> Result<()> {
        let path = path.as_ref();
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        let named = extension.as_deref().and_then(Container::named);
        let container = options.container.or(named).ok_or_else(|| {
            let path = path.display();
            Error::Parameter(format!(
                "{path}: the name ends in none of .ktx2 .ktx .dds .exr; say a `container`"
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
        let plan = Plan {
            container,
            pixel,
            layout,
            diffuse,
            skybox: self.skybox.is_some(),
            ..Plan::new(&UNTARGETED)
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let made = files(&plan, &name, self, &options.metadata)?;
        let outputs = if plan.is_single() {
            let (inside, beside): (Vec<_>, Vec<_>) = made.iter().partition(|file| file.path.contains('/'));
            let file = |path: &str| path.split_once('/').map_or(path, |(_, file)| file).to_owned();
            let bounds: Vec<_> = inside.iter().map(|made| (file(&made.path), &made.bytes[..])).collect();
            let folder = (!bounds.is_empty())
                .then(|| (path.with_file_name(format!("{name}.bounds")), Output::Folder(bounds)));
            let beside = beside.into_iter().map(|made| {
                let place = if made.path == name { path.to_owned() } else { path.with_file_name(&made.path) };
                (place, Output::File(&made.bytes))
            });
            beside.chain(folder).collect()
        } else {
            let files = made.iter().map(|made| (made.path.clone(), &made.bytes[..])).collect();
            vec![(path.to_owned(), Output::Folder(files))]
        };
        output::commit(output::stage_all(&outputs, options.existing)?)
    }
}
