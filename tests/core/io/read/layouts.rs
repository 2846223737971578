//! Layouts: detection by shape, and the place of each texel of a cross or strip.

use super::{assert_texels, error_of, read, read_with};
use exr::prelude::Compression;
use glam::DVec3;
use octagloss_core::files::io::{self, InputLayout, ReadOptions};
use octagloss_core::light::environment::Layout;
use octagloss_core::sphere::cube::{Face, cube_from_direction, direction_from_texel};
use octagloss_fixtures::files::inputs::{Rgb, Sample, exr_rgb, numbered};
use std::fs;
use std::path::PathBuf;

fn exr(size: (u32, u32), pixels: &[Rgb]) -> Vec<u8> {
    exr_rgb(size, Sample::Float, Compression::ZIP16, pixels)
}

fn under(choice: InputLayout) -> ReadOptions {
    ReadOptions { layout: choice, ..ReadOptions::default() }
}

/// Edge of the faces here.
const N: u32 = 4;

/// Returns a face whose texels hold their own direction, shifted to be positive.
fn face_image(face: Face) -> Vec<Rgb> {
    (0..N * N)
        .map(|at| (direction_from_texel(face, N, at % N, at / N) + DVec3::splat(2.0)).as_vec3().to_array())
        .collect()
}

fn cube() -> Vec<Rgb> {
    Face::ALL.iter().flat_map(|face| face_image(*face)).collect()
}

/// Returns an image of `columns` x `rows` cells, with `turned` ones rotated by 180 degrees.
fn cells(columns: u32, rows: u32, places: &[(Face, u32, u32, bool)]) -> ((u32, u32), Vec<Rgb>) {
    let (width, height) = (columns * N, rows * N);
    let mut image = vec![[0.0; 3]; (width * height) as usize];
    for &(face, column, row, turned) in places {
        let mut texels = face_image(face);
        if turned {
            texels.reverse();
        }
        for (at, texel) in (0..).zip(texels) {
            image[((row * N + at / N) * width + column * N + at % N) as usize] = texel;
        }
    }
    ((width, height), image)
}

const UPRIGHT: bool = false;
const TURNED: bool = true;

fn horizontal_cross() -> ((u32, u32), Vec<Rgb>) {
    cells(
        4,
        3,
        &[
            (Face::PosY, 1, 0, UPRIGHT),
            (Face::NegX, 0, 1, UPRIGHT),
            (Face::PosZ, 1, 1, UPRIGHT),
            (Face::PosX, 2, 1, UPRIGHT),
            (Face::NegZ, 3, 1, UPRIGHT),
            (Face::NegY, 1, 2, UPRIGHT),
        ],
    )
}

fn vertical_cross() -> ((u32, u32), Vec<Rgb>) {
    cells(
        3,
        4,
        &[
            (Face::PosY, 1, 0, UPRIGHT),
            (Face::NegX, 0, 1, UPRIGHT),
            (Face::PosZ, 1, 1, UPRIGHT),
            (Face::PosX, 2, 1, UPRIGHT),
            (Face::NegY, 1, 2, UPRIGHT),
            (Face::NegZ, 1, 3, TURNED),
        ],
    )
}

#[test]
fn crosses_and_strips_become_cubes() {
    let in_order = |k: usize| (Face::ALL[k], k as u32);
    let row: Vec<_> = (0..6).map(in_order).map(|(face, k)| (face, k, 0, UPRIGHT)).collect();
    let column: Vec<_> = (0..6).map(in_order).map(|(face, k)| (face, 0, k, UPRIGHT)).collect();
    for ((size, image), name, choice) in [
        (horizontal_cross(), "horizontal cross", InputLayout::Cross),
        (vertical_cross(), "vertical cross", InputLayout::Cross),
        (cells(6, 1, &row), "row strip", InputLayout::Strip),
        (cells(1, 6, &column), "column strip", InputLayout::Strip),
    ] {
        for choice in [InputLayout::Auto, choice] {
            let loaded = read_with("a.exr", &exr(size, &image), &under(choice)).unwrap();
            assert_eq!((loaded.layout, loaded.environment.layout()), (name, Layout::Cube { size: N }));
            assert_texels(loaded.environment.texels(), &cube());
        }
    }
}

/// In both crosses, adjacent cells hold adjacent faces: a texel and its neighbour across the edge are as
/// close in direction as neighbours within a face at its edge.
#[test]
fn crosses_are_continuous_across_their_inner_edges() {
    for ((size, image), columns, rows, seams) in [(horizontal_cross(), 4, 3, 5), (vertical_cross(), 3, 4, 5)]
    {
        let at =
            |x: u32, y: u32| DVec3::from(image[(y * size.0 + x) as usize].map(f64::from)) - DVec3::splat(2.0);
        let filled = |column: u32, row: u32| {
            column < columns && row < rows && image[(row * N * size.0 + column * N) as usize] != [0.0; 3]
        };
        let mut seen = 0;
        for row in 0..rows {
            for column in 0..columns {
                for (right, down) in [(1, 0), (0, 1)] {
                    if !(filled(column, row) && filled(column + right, row + down)) {
                        continue;
                    }
                    seen += 1;
                    for k in 0..N {
                        let (x, y) = if right == 1 {
                            (column * N + N - 1, row * N + k)
                        } else {
                            (column * N + k, row * N + N - 1)
                        };
                        let angle = at(x, y).angle_between(at(x + right, y + down));
                        assert!(angle < 0.45, "cell ({column}, {row}) to ({right}, {down}): {angle}");
                    }
                }
            }
        }
        assert_eq!(seen, seams, "inner edges of the cross");
    }
    // The bound detects a -Z that is not turned.
    let wrong = direction_from_texel(Face::NegY, N, 0, N - 1).angle_between(direction_from_texel(
        Face::NegZ,
        N,
        0,
        0,
    ));
    assert!(wrong > 0.45, "{wrong}");
    assert_eq!(cube_from_direction(direction_from_texel(Face::NegZ, N, 0, 0)).0, Face::NegZ, "inverse");
}

#[test]
fn squares_are_octahedral() {
    let pixels = numbered(8, 8);
    for choice in [InputLayout::Auto, InputLayout::Octahedral] {
        let loaded = read_with("a.exr", &exr((8, 8), &pixels), &under(choice)).unwrap();
        assert_eq!(loaded.environment.layout(), Layout::Octahedral { size: 8 });
        assert_texels(loaded.environment.texels(), &pixels);
    }
}

#[test]
fn shapes_that_fit_nothing_name_size_and_remedy() {
    let file = exr((9, 4), &numbered(9, 4));
    assert_eq!(
        error_of(read("a.exr", &file)),
        "a.exr: 9x4: no known layout has that shape: a panorama is 2:1, crosses 4:3 or 3:4, strips 6:1 or \
         1:6, an octahedral square 1:1; `pad` fills up a partial panorama, `crop` removes black bars; else \
         resize it, then set `layout`"
    );
    for (choice, wanted) in [
        (
            InputLayout::Equirect,
            "a panorama must be 2:1; `pad` fills it up, `crop` removes black bars; else resize it or set \
             another `layout`",
        ),
        (InputLayout::Cross, "a cross must be 4:3 or 3:4; set another `layout`"),
        (InputLayout::Strip, "a strip must be 6:1 or 1:6; set another `layout`"),
        (InputLayout::Faces, "one image is not six faces; give six files, or set `layout` to cross or strip"),
        (InputLayout::Octahedral, "an octahedral square must be 1:1; set another `layout`"),
    ] {
        assert_eq!(error_of(read_with("a.exr", &file, &under(choice))), format!("a.exr: 9x4: {wanted}"));
    }
}

/// Writes six files to `folder`; the names identify the faces.
fn write_faces(folder: &std::path::Path, names: [&str; 6]) -> Vec<PathBuf> {
    Face::ALL
        .iter()
        .zip(names)
        .map(|(face, name)| {
            let path = folder.join(format!("{name}.exr"));
            fs::write(&path, exr((N, N), &face_image(*face))).unwrap();
            path
        })
        .collect()
}

#[test]
fn six_files_are_a_cube_in_order_or_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let options = under(InputLayout::Faces);
    let numbered = write_faces(folder.path(), ["1", "2", "3", "4", "5", "6"]);
    assert_texels(io::read_faces(&numbered, &options).unwrap().environment.texels(), &cube());
    let mut named = write_faces(folder.path(), ["sky_px", "sky_nx", "sky_py", "sky_ny", "sky_pz", "sky_nz"]);
    named.reverse();
    let loaded = io::read_faces(&named, &options).unwrap();
    assert_texels(loaded.environment.texels(), &cube());
    assert_eq!((loaded.layout, loaded.width, loaded.height), ("cube", N, N), "described");
}

#[test]
fn unequal_and_oblong_faces_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let files = write_faces(folder.path(), ["1", "2", "3", "4", "5", "6"]);
    let place = files[2].display().to_string();
    fs::write(&files[2], exr((8, 8), &numbered(8, 8))).unwrap();
    assert_eq!(
        error_of(io::read_faces(&files, &ReadOptions::default())),
        format!("{place}: 8x8 but the first face is 4x4; six faces of equal size are needed")
    );
    fs::write(&files[2], exr((8, 4), &numbered(8, 4))).unwrap();
    assert_eq!(
        error_of(io::read_faces(&files, &ReadOptions::default())),
        format!("{place}: 8x4 is not square, as a face must be")
    );
    assert_eq!(
        error_of(io::read_faces(&files[..4], &ReadOptions::default())),
        "a cube takes six face files, got 4"
    );
    assert_eq!(
        error_of(io::read_faces(&files, &under(InputLayout::Cross))),
        "six files are one cube; use `layout` faces"
    );
}
