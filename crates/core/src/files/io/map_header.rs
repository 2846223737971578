//! The map of the sphere that a file's header names, and the border around its components.
//!
//! `convert` writes both keys. `bake --target oem` writes the border of every level, of an octahedral square.
//! EXR has them as attributes, Radiance .hdr as header lines, KTX2 as key/value pairs. All readers take the
//! map from here; only without these keys is it guessed by the picture's shape.

use super::source::Source;
use crate::common::error::{Result, quoted};
use crate::sphere::grid::{Grid, MAX_SIZE};
use crate::sphere::registry::{MAPS, NamedMap, named};

/// The key of the map's name, as in [`MAPS`].
pub(crate) const MAP_KEY: &str = "octaglossMap";

/// The key of the border in texels; for several levels of each, comma-separated.
pub(crate) const BORDER_KEY: &str = "octaglossBorder";

/// What a header says about the map of its picture.
#[derive(Clone, Debug)]
pub(super) struct MapHeader {
    pub(super) map: &'static NamedMap,
    /// As written.
    pub(super) border: String,
}

/// The keys of a picture of `map` with `border` texels around every component.
pub fn map_pairs(map: &NamedMap, border: u32) -> Vec<(String, String)> {
    vec![(MAP_KEY.to_owned(), map.name.to_owned()), (BORDER_KEY.to_owned(), border.to_string())]
}

impl MapHeader {
    /// Parses the keys of `source`; `text` returns the value of a key.
    pub(super) fn of_texts(
        source: &Source<'_>,
        text: &dyn Fn(&str) -> Option<String>,
    ) -> Result<Option<Self>> {
        let border = text(BORDER_KEY);
        let name = match text(MAP_KEY) {
            None if border.is_none() => return Ok(None),
            None => "octahedral".to_owned(),
            Some(name) => name,
        };
        let Some(map) = named(name.trim()) else {
            return Err(source.error(format!(
                "its header names the map {} ({MAP_KEY}), which is not one of {}; remove the key if it is \
                 wrong",
                quoted(&name),
                MAPS.map(|map| map.name).join(", ")
            )));
        };
        Ok(Some(Self { map, border: border.unwrap_or_else(|| "0".to_owned()) }))
    }

    /// The grid of a picture of `width` x `height` texels, and its border.
    pub(super) fn bordered_grid(&self, width: u32, height: u32) -> Option<(Grid, u32)> {
        let border = self.border.split(',').next()?.trim().parse::<u32>().ok().filter(|b| *b <= MAX_SIZE)?;
        let of_size = |size: u32| Grid::new(self.map.map, size).expect("a size");
        // Sides grow with the size, not evenly: components of different sizes share them.
        let (mut low, mut high) = (1, MAX_SIZE);
        while low < high {
            let middle = low.midpoint(high);
            if of_size(middle).picture_sides(border)[0] < width {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        let grid = of_size(low);
        (grid.picture_sides(border) == [width, height]).then_some((grid, border))
    }
}
