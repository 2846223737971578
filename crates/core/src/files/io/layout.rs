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

use crate::common::error::{Error, Result};
use crate::common::names::named;
use crate::files::format::OutputLayout;
use crate::light::environment::{Layout, Rgb};
use std::path::Path;

/// Image layout, as selected by the user.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum InputLayout {
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

named!(InputLayout {
    Auto = "auto",
    Equirect = "equirect",
    Cross = "cross",
    Strip = "strip",
    Faces = "faces",
    Octahedral = "octahedral",
});

/// Column and row of each of [`crate::sphere::cube::Face::ALL`] in an image, in units of its size.
type Cells = [(u32, u32); 6];

/// Those in the horizontal cross.
pub const CROSS_CELLS: Cells = [(2, 1), (0, 1), (1, 0), (1, 2), (1, 1), (3, 1)];
const VERTICAL_CROSS: Cells = [(2, 1), (0, 1), (1, 0), (1, 2), (1, 1), TURNED];
const ROW_STRIP: Cells = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (5, 0)];
const COLUMN_STRIP: Cells = [(0, 0), (0, 1), (0, 2), (0, 3), (0, 4), (0, 5)];

/// The cell of -Z in the vertical cross, where its image is turned.
const TURNED: (u32, u32) = (1, 3);

/// Arranges six faces of `size` x `size` texels in a row-major image, black elsewhere; returns its columns
/// and texels. `None` for layouts that do not unfold cubes.
pub fn image_from_faces(layout: OutputLayout, size: u32, texels: &[Rgb]) -> Option<(u32, Vec<Rgb>)> {
    let (cells, columns, rows) = match layout {
        OutputLayout::Cross => (&CROSS_CELLS, 4, 3),
        OutputLayout::CrossVertical => (&VERTICAL_CROSS, 3, 4),
        OutputLayout::Strip => (&ROW_STRIP, 6, 1),
        OutputLayout::StripVertical => (&COLUMN_STRIP, 1, 6),
        _ => return None,
    };
    let (n, width) = (size as usize, (columns * size) as usize);
    let mut image = vec![[0.0; 3]; width * rows * n];
    for (cell, face) in cells.iter().zip(texels.chunks_exact(n * n)) {
        for (j, line) in face.chunks_exact(n).enumerate() {
            let row = if *cell == TURNED { n - 1 - j } else { j };
            let target = &mut image[(cell.1 as usize * n + row) * width + cell.0 as usize * n..][..n];
            target.copy_from_slice(line);
            if *cell == TURNED {
                target.reverse();
            }
        }
    }
    Some((width as u32, image))
}

/// Maps the texels of a layout to the image.
#[derive(Clone, Debug)]
pub(super) struct Arrangement {
    pub(super) layout: Layout,
    pub(super) name: &'static str,
    /// Those of a cube to cut out; `None` if the image is the layout already.
    cells: Option<&'static Cells>,
}

/// The arrangement of a `width` x `height` picture, of six stacked faces if `is_cube`, under `choice`.
pub(super) fn arrangement(
    path: &Path,
    width: u32,
    height: u32,
    is_cube: bool,
    choice: InputLayout,
) -> Result<Arrangement> {
    let shaped = |w: u32, h: u32| {
        let (width, height) = (u64::from(width), u64::from(height));
        width * u64::from(h) == height * u64::from(w) && width % u64::from(w) == 0
    };
    let cube = |size, name, cells| Arrangement { layout: Layout::Cube { size }, name, cells };
    let whole = |layout, name| Arrangement { layout, name, cells: None };

    let equirect = || shaped(2, 1).then(|| whole(Layout::Panorama { width, height }, "panorama"));
    let cross = || {
        let horizontal = shaped(4, 3).then(|| cube(width / 4, "horizontal cross", Some(&CROSS_CELLS)));
        horizontal.or_else(|| shaped(3, 4).then(|| cube(width / 3, "vertical cross", Some(&VERTICAL_CROSS))))
    };
    let strip = || {
        let row = shaped(6, 1).then(|| cube(height, "row strip", Some(&ROW_STRIP)));
        row.or_else(|| shaped(1, 6).then(|| cube(width, "column strip", None)))
    };
    let octahedral = || shaped(1, 1).then(|| whole(Layout::Octahedral { size: width }, "octahedral square"));

    if is_cube {
        return match choice {
            InputLayout::Auto | InputLayout::Faces => Ok(cube(width, "cube", None)),
            _ => Err(Error::input(path, "it holds a cube; omit `layout` or set `layout` to faces")),
        };
    }
    let (found, needed) = match choice {
        InputLayout::Auto => (
            equirect().or_else(cross).or_else(strip).or_else(octahedral),
            "no known layout has that shape: a panorama is 2:1, crosses 4:3 or 3:4, strips 6:1 or 1:6, an \
             octahedral square 1:1; `pad` fills up a partial panorama, `crop` removes black bars; else \
             resize it, then set `layout`",
        ),
        InputLayout::Equirect => (
            equirect(),
            "a panorama must be 2:1; `pad` fills it up, `crop` removes black bars; else resize it or set \
             another `layout`",
        ),
        InputLayout::Cross => (cross(), "a cross must be 4:3 or 3:4; set another `layout`"),
        InputLayout::Strip => (strip(), "a strip must be 6:1 or 1:6; set another `layout`"),
        InputLayout::Faces => {
            (None, "one image is not six faces; give six files, or set `layout` to cross or strip")
        }
        InputLayout::Octahedral => (octahedral(), "an octahedral square must be 1:1; set another `layout`"),
    };
    found.ok_or_else(|| Error::input(path, format!("{width}x{height}: {needed}")))
}

impl Arrangement {
    /// Extracts the layout's texels from an image with rows of `width`.
    pub(super) fn arrange(&self, image: Vec<Rgb>, width: u32) -> Vec<Rgb> {
        let (Layout::Cube { size }, Some(cells)) = (self.layout, self.cells) else { return image };
        let (size, width) = (size as usize, width as usize);
        let mut texels = Vec::with_capacity(6 * size * size);
        for cell in cells {
            let row_at = |j: usize| {
                let start = (cell.1 as usize * size + j) * width + cell.0 as usize * size;
                &image[start..start + size]
            };
            for j in 0..size {
                if *cell == TURNED {
                    texels.extend(row_at(size - 1 - j).iter().rev());
                } else {
                    texels.extend_from_slice(row_at(j));
                }
            }
        }
        texels
    }
}
