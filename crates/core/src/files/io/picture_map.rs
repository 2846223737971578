//! The map of a picture: the one that its header or the caller names.

use super::layout::InputLayout;
use super::map_header::{BORDER_KEY, MAP_KEY, MapHeader};
use super::picture::Picture;
use super::source::Source;
use crate::common::error::{Error, Result, quoted};
use crate::sphere::grid::Grid;
use crate::sphere::registry::NamedMap;
use std::path::Path;

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

impl MapHeader {
    /// Checks that `picture` has the shape of the map.
    pub(super) fn check_shape(&self, path: &Path, picture: &Picture) -> Result<()> {
        grid_of(path, self.map, [picture.width, picture.height], RESHAPED).map(|_| ())
    }
}

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
    if let Some(written) = written.filter(|written| written.name != name) {
        return Err(Error::input(
            path,
            format!(
                "its header says that its map is {} ({MAP_KEY}), but `from` is {name}; omit `from`, or \
                 remove the key if it is wrong",
                written.name
            ),
        ));
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
    let Some(name) = header.map(|header| header.map.name) else { return Ok(choice) };
    match header.and_then(|header| layout_of(header.map)) {
        None => Err(Error::input(
            path,
            format!(
                "its header says that its map is {name} ({MAP_KEY}), which no environment has; convert it to \
                 equirect first"
            ),
        )),
        Some(own) if choice == InputLayout::Auto || choice == own => Ok(own),
        Some(_) => Err(Error::input(
            path,
            format!(
                "its header says that its map is {name} ({MAP_KEY}), but `layout` is {}; omit `layout`, or \
                 remove the key if it is wrong",
                choice.name()
            ),
        )),
    }
}
