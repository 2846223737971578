//! Image layouts: panoramas, crosses, strips and octahedral squares.
//!
//! Cells of crosses and strips hold face images as in [`crate::sphere::cube`], upright except -Z of the
//! vertical cross, which is rotated by 180 degrees to continue -Y above it:
//!
//! ```text
//! horizontal cross (4:3)    vertical cross (3:4)    row strip (6:1)        column strip (1:6)
//!
//!     +Y                        +Y                  +X -X +Y -Y +Z -Z      +X
//! -X  +Z  +X  -Z            -X  +Z  +X                                     -X
//!     -Y                        -Y                                         ...
//!                               -Z turned                                  -Z
//! ```

use crate::environment::{Layout, Rgb};
use crate::error::{Error, Result};
use crate::names::named;
use std::path::Path;

/// Content of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// An image of yet unknown layout.
    Image,
    /// Six faces, stacked vertically.
    Cube,
}

/// Image layout, as selected by the user.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum LayoutChoice {
    /// The map that the header names, else by its shape: 2:1 panorama, 4:3 and 3:4 crosses, 6:1 and 1:6
    /// strips, 1:1 octahedral square.
    #[default]
    Auto,
    /// A panorama, 2:1.
    Equirect,
    /// A cube unfolded into a horizontal (4:3) or vertical (3:4) cross.
    Cross,
    /// Six faces in a row (6:1) or column (1:6).
    Strip,
    /// Six files, or a file that holds a cube.
    Faces,
    /// An octahedral square, 1:1.
    Octahedral,
}

named!(LayoutChoice {
    Auto = "auto",
    Equirect = "equirect",
    Cross = "cross",
    Strip = "strip",
    Faces = "faces",
    Octahedral = "octahedral",
});

/// Position of a face in the image, in units of its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cell {
    column: u32,
    row: u32,
    turned: bool,
}

/// Arrangement of a cube's six faces in one image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unfolding {
    /// Horizontal cross, 4:3.
    Cross,
    /// Vertical cross, 3:4.
    CrossVertical,
    /// Row, 6:1.
    Strip,
    /// Column, 1:6.
    StripVertical,
}

impl Unfolding {
    /// Columns and rows of the image, in faces.
    #[must_use]
    pub const fn sides(self) -> (u32, u32) {
        match self {
            Self::Cross => (4, 3),
            Self::CrossVertical => (3, 4),
            Self::Strip => (6, 1),
            Self::StripVertical => (1, 6),
        }
    }

    const fn cells(self) -> &'static [Cell; 6] {
        match self {
            Self::Cross => &HORIZONTAL_CROSS,
            Self::CrossVertical => &VERTICAL_CROSS,
            Self::Strip => &ROW_STRIP,
            Self::StripVertical => &COLUMN_STRIP,
        }
    }

    /// Arranges six faces of `size` x `size` texels in a row-major image, black elsewhere.
    #[must_use]
    pub fn image_from_faces(self, size: u32, texels: &[Rgb]) -> Vec<Rgb> {
        let (columns, rows) = self.sides();
        let (n, width) = (size as usize, (columns * size) as usize);
        let mut image = vec![[0.0; 3]; width * rows as usize * n];
        for (cell, face) in self.cells().iter().zip(texels.chunks_exact(n * n)) {
            for (j, line) in face.chunks_exact(n).enumerate() {
                let row = if cell.turned { n - 1 - j } else { j };
                let at = (cell.row as usize * n + row) * width + cell.column as usize * n;
                let target = &mut image[at..at + n];
                target.copy_from_slice(line);
                if cell.turned {
                    target.reverse();
                }
            }
        }
        image
    }
}

/// Maps the texels of a layout to the image.
#[derive(Clone, Debug)]
pub(super) struct Arrangement {
    pub(super) layout: Layout,
    pub(super) name: &'static str,
    /// Six for a cube to cut out; empty if the image is the layout already.
    cells: Vec<Cell>,
}

const fn cell(column: u32, row: u32) -> Cell {
    Cell { column, row, turned: false }
}

/// Column and row of each face of [`crate::sphere::cube::Face::ALL`] in the horizontal cross.
pub const CROSS_CELLS: [(u32, u32); 6] = [(2, 1), (0, 1), (1, 0), (1, 2), (1, 1), (3, 1)];

const HORIZONTAL_CROSS: [Cell; 6] = {
    let mut cells = [cell(0, 0); 6];
    let mut face = 0;
    while face < 6 {
        cells[face] = cell(CROSS_CELLS[face].0, CROSS_CELLS[face].1);
        face += 1;
    }
    cells
};
const VERTICAL_CROSS: [Cell; 6] =
    [cell(2, 1), cell(0, 1), cell(1, 0), cell(1, 2), cell(1, 1), Cell { column: 1, row: 3, turned: true }];
const ROW_STRIP: [Cell; 6] = [cell(0, 0), cell(1, 0), cell(2, 0), cell(3, 0), cell(4, 0), cell(5, 0)];
const COLUMN_STRIP: [Cell; 6] = [cell(0, 0), cell(0, 1), cell(0, 2), cell(0, 3), cell(0, 4), cell(0, 5)];

/// The arrangement of a `width` x `height` picture under `choice`.
pub(super) fn arrangement(
    path: &Path,
    width: u32,
    height: u32,
    content: Content,
    choice: LayoutChoice,
) -> Result<Arrangement> {
    let shaped = |w: u32, h: u32| {
        let (width, height) = (u64::from(width), u64::from(height));
        width * u64::from(h) == height * u64::from(w) && width % u64::from(w) == 0
    };
    let cube = |size: u32, name, cells: &[Cell]| Arrangement {
        layout: Layout::Cube { size },
        name,
        cells: cells.to_vec(),
    };
    let whole = |layout, name| Arrangement { layout, name, cells: Vec::new() };

    let equirect = || shaped(2, 1).then(|| whole(Layout::Panorama { width, height }, "panorama"));
    let cross = || {
        let horizontal = shaped(4, 3).then(|| cube(width / 4, "horizontal cross", &HORIZONTAL_CROSS));
        horizontal.or_else(|| shaped(3, 4).then(|| cube(width / 3, "vertical cross", &VERTICAL_CROSS)))
    };
    let strip = || {
        let row = shaped(6, 1).then(|| cube(height, "row strip", &ROW_STRIP));
        row.or_else(|| shaped(1, 6).then(|| cube(width, "column strip", &[])))
    };
    let octahedral = || shaped(1, 1).then(|| whole(Layout::Octahedral { size: width }, "octahedral square"));

    if content == Content::Cube {
        return match choice {
            LayoutChoice::Auto | LayoutChoice::Faces => Ok(cube(width, "cube", &[])),
            _ => Err(Error::input(path, "it holds a cube; omit `layout` or set `layout` to faces")),
        };
    }
    let (found, needed) = match choice {
        LayoutChoice::Auto => (
            equirect().or_else(cross).or_else(strip).or_else(octahedral),
            "no known layout has that shape: a panorama is 2:1, crosses 4:3 or 3:4, strips 6:1 or 1:6, an \
             octahedral square 1:1; `pad` fills up a partial panorama, `crop` removes black bars; else \
             resize it, then set `layout`",
        ),
        LayoutChoice::Equirect => (
            equirect(),
            "a panorama must be 2:1; `pad` fills it up, `crop` removes black bars; else resize it or set \
             another `layout`",
        ),
        LayoutChoice::Cross => (cross(), "a cross must be 4:3 or 3:4; set another `layout`"),
        LayoutChoice::Strip => (strip(), "a strip must be 6:1 or 1:6; set another `layout`"),
        LayoutChoice::Faces => {
            (None, "one image is not six faces; give six files, or set `layout` to cross or strip")
        }
        LayoutChoice::Octahedral => (octahedral(), "an octahedral square must be 1:1; set another `layout`"),
    };
    found.ok_or_else(|| Error::input(path, format!("{width}x{height}: {needed}")))
}

impl Arrangement {
    /// Extracts the layout's texels from an image with rows of `width`.
    pub(super) fn arrange(&self, image: Vec<Rgb>, width: u32) -> Vec<Rgb> {
        let (Layout::Cube { size }, false) = (self.layout, self.cells.is_empty()) else { return image };
        let (size, width) = (size as usize, width as usize);
        let mut texels = Vec::with_capacity(6 * size * size);
        for cell in &self.cells {
            let row_at = |j: usize| {
                let start = (cell.row as usize * size + j) * width + cell.column as usize * size;
                &image[start..start + size]
            };
            for j in 0..size {
                if cell.turned {
                    texels.extend(row_at(size - 1 - j).iter().rev());
                } else {
                    texels.extend_from_slice(row_at(j));
                }
            }
        }
        texels
    }
}
