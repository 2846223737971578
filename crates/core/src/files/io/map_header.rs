//! The map of the sphere that a file's header names, and the border around its components.
//!
//! `convert` writes both keys. `bake --target oem` writes the border of every level, of an octahedral square.
//! EXR has them as attributes, Radiance .hdr as header lines, KTX2 as key/value pairs. All readers take the
//! map from here; only without these keys is it guessed by the picture's shape.

use super::key_values::value_of;
use super::layout::InputLayout;
use super::picture::{Picture, Source};
use crate::common::error::{Error, Result, quoted};
use crate::sphere::grid::{Grid, MAX_SIZE};
use crate::sphere::registry::{MAPS, NamedMap, named};
use std::path::Path;

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
    /// Parses the key/value pairs of `source`.
    pub(super) fn of_pairs(source: &Source<'_>, pairs: &[(String, String)]) -> Result<Option<Self>> {
        let border = value_of(pairs, BORDER_KEY);
        let name = match value_of(pairs, MAP_KEY) {
            None if border.is_none() => return Ok(None),
            None => "octahedral",
            Some(name) => name,
        };
        let Some(map) = named(name.trim()) else {
            return Err(source.error(format!(
                "its header names the map {} ({MAP_KEY}), which is not one of {}; remove the key if it is \
                 wrong",
                quoted(name),
                MAPS.map(|map| map.name).join(", ")
            )));
        };
        Ok(Some(Self { map, border: border.unwrap_or("0").to_owned() }))
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

impl Picture {
    /// Removes the border that the header names.
    pub(super) fn without_border(mut self, source: &Source<'_>) -> Result<Self> {
        let Some(header) = self.map.as_ref().filter(|header| header.border.trim() != "0") else {
            return Ok(self);
        };
        let Some((grid, border)) = header.bordered_grid(self.width, self.height) else {
            return Err(source.error(format!(
                "its header says that it is {} with a border of {} ({BORDER_KEY}), which {}x{} cannot be; \
                 bake or convert it again",
                header.map.name,
                quoted(&header.border),
                self.width,
                self.height
            )));
        };
        let [width, height] = grid.picture_sides(0);
        let mut texels = vec![[0.0; 3]; width as usize * height as usize];
        for component in 0..grid.map().components() {
            let [columns, rows] = grid.sides(component).map(|side| side as usize);
            let at =
                |[x, y]: [u32; 2], row: usize, width: u32| (y as usize + row) * width as usize + x as usize;
            for row in 0..rows {
                let from = at(grid.picture_origin(component, border), row, self.width);
                let to = at(grid.picture_origin(component, 0), row, width);
                texels[to..to + columns].copy_from_slice(&self.texels[from..from + columns]);
            }
        }
        self.texels = texels;
        (self.width, self.height) = (width, height);
        self.format += &format!(", border {border}");
        Ok(self)
    }
}

/// The remedy for a picture that has another shape than the map in its header.
pub(super) const RESHAPED: &str =
    "it was cropped or resized; convert it again, or remove octaglossMap and octaglossBorder from its header";

/// The map of `picture`: `from`, which must not contradict the header, or that of the header; `None` if
/// neither is given.
pub(super) fn chosen(
    path: &Path,
    picture: &Picture,
    from: Option<&'static NamedMap>,
) -> Result<Option<&'static NamedMap>> {
    let written = picture.map.as_ref().map(|header| header.map);
    let Some(from) = from else { return Ok(written) };
    let name = from.name;
    if picture.is_cube {
        return Err(Error::input(path, format!("it holds a cube; omit `from` {name}")));
    }
    if let Some(NamedMap { name: written, .. }) = written.filter(|written| written.name != name) {
        let message = format!(
            "its header says that its map is {written} ({MAP_KEY}), but `from` is {name}; omit `from`, or \
             remove the key if it is wrong"
        );
        return Err(Error::input(path, message));
    }
    grid_of(path, from, [picture.width, picture.height], "omit `from` or name another map")?;
    Ok(Some(from))
}

/// The grid of a picture of `map` without a border; `remedy` ends the error for another shape.
pub(super) fn grid_of(path: &Path, map: &NamedMap, [width, height]: [u32; 2], remedy: &str) -> Result<Grid> {
    let [columns, rows] = Grid::new(map.map, 1)?.picture_sides(0);
    let size = width / columns;
    if size == 0 || width != size * columns || u64::from(height) != u64::from(size) * u64::from(rows) {
        return Err(Error::input(
            path,
            format!("{width}x{height} does not fit {}, which is {columns}:{rows}; {remedy}", map.name),
        ));
    }
    Grid::new(map.map, size)
}

/// The layout of environments whose pictures are those of `map`; `None` if environments cannot have the map.
pub(super) fn layout_of(map: &NamedMap) -> Option<InputLayout> {
    match map.name {
        "equirect" => Some(InputLayout::Equirect),
        "cube" => Some(InputLayout::Strip),
        "octahedral" => Some(InputLayout::Octahedral),
        _ => None,
    }
}

/// The layout of the picture as an environment: that of the map in its header, which `choice` must not
/// contradict, else `choice`.
pub(super) fn settled(path: &Path, choice: InputLayout, header: Option<&MapHeader>) -> Result<InputLayout> {
    let Some(MapHeader { map, .. }) = header else { return Ok(choice) };
    let why = match layout_of(map) {
        Some(own) if choice == InputLayout::Auto || choice == own => return Ok(own),
        Some(_) => format!("but `layout` is {choice}; omit `layout`, or remove the key if it is wrong"),
        None => "which no environment has; convert it to equirect first".to_owned(),
    };
    Err(Error::input(path, format!("its header says that its map is {} ({MAP_KEY}), {why}", map.name)))
}
