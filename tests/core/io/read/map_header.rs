//! The map that a file's header names.

use super::{assert_texels, error_of, read, read_with};
use octagloss_core::files::format::Pixel;
use octagloss_core::files::io::exr::write::{Attribute, Samples, exr_bytes};
use octagloss_core::files::io::{self, InputLayout, MapLight, Pad, ReadOptions};
use octagloss_core::light::environment::Layout;
use octagloss_core::sphere::grid::Grid;
use octagloss_core::sphere::map::Texel;
use octagloss_core::sphere::registry::{MAPS, NamedMap, named};
use octagloss_fixtures::files::inputs::{Rgb, numbered};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// An EXR file of numbered texels whose header has `keys`.
fn file([width, height]: [u32; 2], keys: &[(&str, &str)]) -> (Vec<u8>, Vec<Rgb>) {
    let texels = numbered(width, height);
    let text = |(key, value): &(&str, &str)| ((*key).to_owned(), Attribute::Text((*value).to_owned()));
    let attributes: Vec<_> = keys.iter().map(text).collect();
    (exr_bytes(width, height, Samples::Rgb(&texels), Pixel::F32, &attributes).expect("valid"), texels)
}

fn map(name: &str) -> &'static NamedMap {
    named(name).expect("a map")
}

fn under(layout: InputLayout) -> ReadOptions {
    ReadOptions { layout, ..ReadOptions::default() }
}

/// A file in a folder, for `read_map`.
fn written(folder: &TempDir, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join("a.exr");
    fs::write(&path, bytes).expect("writable");
    path
}

#[test]
fn the_header_names_the_layout_of_environments() {
    for (name, sides, layout) in [
        ("equirect", [8, 4], Layout::Panorama { width: 8, height: 4 }),
        ("octahedral", [4, 4], Layout::Octahedral { size: 4 }),
        ("cube", [12, 2], Layout::Cube { size: 2 }),
    ] {
        let (bytes, _) = file(sides, &[("octaglossMap", name)]);
        assert_eq!(read("a.exr", &bytes).expect(name).environment.layout(), layout);
        let wrong = if name == "cube" { InputLayout::Equirect } else { InputLayout::Strip };
        let error = error_of(read_with("a.exr", &bytes, &under(wrong)));
        let words = format!("its header says that its map is {name} (octaglossMap), but `layout` is");
        assert!(error.contains(&words), "{error}");
    }
    let (bytes, _) = file([12, 2], &[("octaglossMap", "cube")]);
    read_with("a.exr", &bytes, &under(InputLayout::Strip)).expect("what the header says");
}

#[test]
fn other_maps_are_no_environments_whatever_their_shape() {
    for row in MAPS.iter().filter(|row| !["equirect", "octahedral", "cube"].contains(&row.name)) {
        let grid = Grid::new(row.map(), 2).expect("a size");
        let (bytes, _) = file(grid.picture_sides(0), &[("octaglossMap", row.name)]);
        for choice in InputLayout::ALL {
            let error = error_of(read_with("a.exr", &bytes, &under(choice)));
            let words =
                format!("its map is {} (octaglossMap), which no environment has; convert it", row.name);
            assert!(error.contains(&words), "{error}");
        }
    }
}

#[test]
fn a_border_in_the_header_is_removed() {
    // One texel around each of six faces of 2 x 2 texels in a row.
    let (bytes, texels) = file([24, 4], &[("octaglossMap", "cube"), ("octaglossBorder", "1")]);
    let loaded = read("a.exr", &bytes).expect("a cube");
    assert_eq!(loaded.environment.layout(), Layout::Cube { size: 2 });
    assert!(loaded.format.ends_with(", border 1"), "{}", loaded.format);
    let at = |face: usize, k: usize| texels[(1 + k / 2) * 24 + 4 * face + 1 + k % 2];
    let inner: Vec<Rgb> = (0..6).flat_map(|face| (0..4).map(move |k| at(face, k))).collect();
    assert_texels(loaded.environment.texels(), &inner);

    // The border alone is that of a baked octahedral square, level 0 first.
    let (bytes, texels) = file([8, 8], &[("octaglossBorder", "2,1")]);
    let loaded = read("a.exr", &bytes).expect("a square");
    let inner: Vec<Rgb> = (0..16).map(|k| texels[(2 + k / 4) * 8 + 2 + k % 4]).collect();
    assert_texels(loaded.environment.texels(), &inner);
    for border in ["x", "-1", "4", "99999999999", "4294967295", ""] {
        let (bytes, _) = file([8, 8], &[("octaglossBorder", border)]);
        let error = error_of(read("a.exr", &bytes));
        let words =
            format!("it is octahedral with a border of {border:?} (octaglossBorder), which 8x8 cannot");
        assert!(error.contains(&words), "{error}");
    }
}

#[test]
fn a_header_that_does_not_fit_is_named() {
    let (bytes, _) = file([8, 4], &[("octaglossMap", "globe")]);
    let error = error_of(read("a.exr", &bytes));
    assert!(
        error.contains("its header names the map \"globe\" (octaglossMap), which is not one of"),
        "{error}"
    );
    let (bytes, _) = file([7, 3], &[("octaglossMap", "equirect")]);
    let error = error_of(read("a.exr", &bytes));
    assert!(error.contains("7x3 does not fit equirect, which is 2:1; it was cropped or resized"), "{error}");
    let padded = ReadOptions { pad: Some(Pad::Edge), ..ReadOptions::default() };
    assert_eq!(
        read_with("a.exr", &bytes, &padded).expect("filled up").environment.layout(),
        Layout::Panorama { width: 8, height: 4 }
    );
    let (bytes, _) = file([4, 4], &[("octaglossMap", "octahedral")]);
    let error = error_of(read_with("a.exr", &bytes, &padded));
    assert!(
        error.contains("`pad` and `crop` are for panoramas, and its header says that its map is"),
        "{error}"
    );
    let (bytes, _) = file([4, 4], &[("octaglossMap", "octahedral")]);
    let folder = TempDir::new().expect("a temporary folder");
    let face = written(&folder, &bytes);
    let error = error_of(io::read_faces(&vec![face; 6], &ReadOptions::default()));
    assert!(
        error.contains("its header says that its map is octahedral; use it as the only input"),
        "{error}"
    );
}

/// A map's picture is split into its components, with the header or the caller naming the map.
#[test]
fn any_map_is_read_as_its_components() {
    let folder = TempDir::new().expect("a temporary folder");
    let options = ReadOptions::default();
    let keys = [("octaglossMap", "dual-paraboloid"), ("octaglossBorder", "1")];
    let (bytes, texels) = file([8, 4], &keys);
    let path = written(&folder, &bytes);
    let at = |disc: usize, k: usize| texels[(1 + k / 2) * 8 + 4 * disc + 1 + k % 2];
    let inner: Vec<Rgb> = (0..2).flat_map(|disc| (0..4).map(move |k| at(disc, k))).collect();
    for from in [None, Some(map("dual-paraboloid"))] {
        let MapLight::Components(grid, found) = io::read_map(&path, from, &options).expect("read").light
        else {
            panic!("no environment has two discs");
        };
        assert_eq!((grid.size(), found.len()), (2, 8));
        assert_texels(&found, &inner);
    }
    let refused = |from: Option<&'static NamedMap>, options: &ReadOptions, words: &str| {
        let error = io::read_map(&path, from, options).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    };
    refused(
        Some(map("healpix")),
        &options,
        "its map is dual-paraboloid (octaglossMap), but `from` is healpix",
    );
    let crop = ReadOptions { crop: true, ..options.clone() };
    refused(None, &crop, "`pad` and `crop` are for panoramas, and its map is dual-paraboloid");
    refused(Some(map("dual-paraboloid")), &ReadOptions { scale: -1.0, ..options.clone() }, "`scale` -1");

    let (bytes, _) = file([8, 4], &[]);
    let path = written(&folder, &bytes);
    let light = |from| io::read_map(&path, from, &options).map(|loaded| loaded.light);
    assert!(matches!(light(None), Ok(MapLight::Environment(panorama))
        if panorama.layout() == Layout::Panorama { width: 8, height: 4 }));
    assert!(matches!(light(Some(map("equirect"))), Ok(MapLight::Environment(_))));
    assert!(
        matches!(light(Some(map("dual-equidistant"))), Ok(MapLight::Components(grid, _)) if grid.size() == 4)
    );
    let error = light(Some(map("healpix"))).expect_err("another shape").to_string();
    assert!(
        error.contains("8x4 does not fit healpix, which is 4:3; omit `from` or name another map"),
        "{error}"
    );
}

/// Borders of any width go from pictures of any size, also where components of different sizes lie side by
/// side.
#[test]
fn every_map_loses_its_border_at_every_size() {
    let folder = TempDir::new().expect("a temporary folder");
    for row in &MAPS {
        for (size, border) in [(1, 1), (2, 2), (3, 1), (16, 2), (9, 9)] {
            let grid = Grid::new(row.map(), size).expect("a size");
            let sides = grid.picture_sides(border);
            let text = border.to_string();
            let (bytes, texels) = file(sides, &[("octaglossMap", row.name), ("octaglossBorder", &text)]);
            let loaded = io::read_map(&written(&folder, &bytes), None, &ReadOptions::default());
            let found = match loaded.expect(row.name).light {
                MapLight::Components(found, texels) => {
                    assert_eq!(found.size(), size, "{} with {border}", row.name);
                    texels
                }
                MapLight::Environment(environment) => environment.texels().to_vec(),
            };
            let at = |texel: Texel| {
                let [left, top] = grid.picture_origin(texel.component, border);
                texels[(top + texel.y) as usize * sides[0] as usize + (left + texel.x) as usize]
            };
            assert_texels(&found, &grid.texels().map(at).collect::<Vec<Rgb>>());
        }
    }
}

/// Negative values are weighed by the map's own solid angles, and NaN is named by the picture's pixel.
#[test]
fn components_are_repaired_as_environments_are() {
    let folder = TempDir::new().expect("a temporary folder");
    let mut texels = vec![[1.0; 3]; 16];
    texels[5] = [-1.0; 3];
    let key = [("octaglossMap".to_owned(), Attribute::Text("sphere-map".to_owned()))];
    let bytes = |texels: &[Rgb]| exr_bytes(4, 4, Samples::Rgb(texels), Pixel::F32, &key).expect("valid");
    let path = written(&folder, &bytes(&texels));
    let loaded = io::read_map(&path, None, &ReadOptions::default()).expect("repaired");
    let MapLight::Components(_, found) = &loaded.light else { panic!("a sphere map") };
    assert_eq!((found[5], found[6]), ([0.0; 3], [1.0; 3]));
    assert!(loaded.warnings[0].starts_with("3 negative values ("), "{:?}", loaded.warnings);
    let strict = ReadOptions { strict: true, ..ReadOptions::default() };
    assert!(io::read_map(&path, None, &strict).is_err());
    texels[9][1] = f32::NAN;
    let path = written(&folder, &bytes(&texels));
    let error = io::read_map(&path, None, &ReadOptions::default()).expect_err("NaN").to_string();
    assert!(error.contains("pixel (1, 2) channel G is NaN"), "{error}");
}
