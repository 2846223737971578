//! Atlases of octahedral maps: allocation, look-ups inside a tile, tables of all tiles.

use glam::DVec3;
use octagloss_core::common::error::Error;
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::light::sat::{Sat, Scan};
use octagloss_fixtures::atlas::table::{Atlas, Domain, Tile};
use octagloss_fixtures::common::{Random, landmarks, oem};

const SIDE: u32 = 512;
const BORDER: u32 = 2;

/// Owners of an atlas in cells of eight texels, kept apart from the atlas's own books.
struct Cells(Vec<Option<usize>>);

impl Cells {
    const PITCH: u32 = SIDE / 8;

    fn of(tile: Tile) -> impl Iterator<Item = usize> {
        let ([x, y], count) = (tile.corner().map(|c| c / 8), tile.size().bordered() / 8);
        (0..count * count).map(move |k| ((y + k / count) * Self::PITCH + x + k % count) as usize)
    }
}

/// Radiance that no two tiles share.
fn light(tile: usize) -> [f32; 3] {
    [1.0 + tile as f32, 0.5 + (tile % 7) as f32, 2.0 + (tile % 13) as f32]
}

/// Texels of the square of `tile` with the radiance of `number`.
fn square(tile: Tile, number: usize) -> Vec<[f32; 4]> {
    let count = tile.size().inner.pow(2) as usize;
    let [r, g, b] = light(number);
    vec![[r, g, b, 1.0]; count]
}

#[test]
fn ten_thousand_tiles_neither_overlap_nor_leak() {
    let mut atlas = Atlas::new(SIDE, BORDER).expect("an atlas");
    let mut random = Random::new(57);
    let mut cells = Cells(vec![None; Cells::PITCH.pow(2) as usize]);
    let mut tiles: Vec<(usize, Tile)> = Vec::new();
    let (mut full, mut most) = (0, 0);
    for number in 0..10_000 {
        // Phases that fill and phases that empty.
        let fills = random.unit() < if number / 500 % 2 == 0 { 0.75 } else { 0.3 };
        if fills || tiles.is_empty() {
            let side = 8 << random.below(5);
            let domain = if random.below(2) == 0 { Domain::Sphere } else { Domain::Hemisphere };
            match atlas.allocate(side, domain).expect("a valid size") {
                Some(tile) => {
                    assert_eq!((tile.size().bordered(), tile.domain()), (side, domain));
                    assert!(tile.corner().iter().all(|c| c.is_multiple_of(side) && c + side <= SIDE));
                    for cell in Cells::of(tile) {
                        assert_eq!(cells.0[cell].replace(number), None, "{tile:?}");
                    }
                    atlas.write(tile, &square(tile, number)).expect("texels of the square");
                    tiles.push((number, tile));
                }
                None => {
                    full += 1;
                    // No aligned square of that size is free.
                    let count = side / 8;
                    for k in 0..(Cells::PITCH / count).pow(2) {
                        let (x, y) = (k % (Cells::PITCH / count) * count, k / (Cells::PITCH / count) * count);
                        let mut own = (0..count * count)
                            .map(|c| cells.0[((y + c / count) * Cells::PITCH + x + c % count) as usize]);
                        assert!(own.any(|cell| cell.is_some()), "{side} texels are free at ({x}, {y})");
                    }
                }
            }
        } else {
            let (own, tile) = tiles.swap_remove(random.below(tiles.len() as u32) as usize);
            for cell in Cells::of(tile) {
                assert_eq!(cells.0[cell].take(), Some(own));
            }
            atlas.release(tile).expect("an allocated tile");
            assert!(matches!(atlas.release(tile), Err(Error::Parameter(_))), "released twice");
        }
        let free = cells.0.iter().filter(|cell| cell.is_none()).count() as u64 * 64;
        assert_eq!(atlas.free_texels(), free);
        most = most.max(tiles.len());
        // Every texel of a few tiles is still its own.
        for (own, tile) in tiles.iter().skip(random.below(8) as usize).step_by(97) {
            let direction = random.direction();
            if let Some(found) = atlas.radiance(*tile, direction).expect("an allocated tile") {
                assert_eq!(found, light(*own), "{tile:?} along {direction}");
            }
        }
    }
    assert!(full > 100 && most > 100, "{full} times full, at most {most} tiles");
    for (_, tile) in tiles {
        atlas.release(tile).expect("an allocated tile");
    }
    assert_eq!(atlas.free_texels(), u64::from(SIDE).pow(2));
    assert!(atlas.oem().texels().iter().all(|texel| *texel == [0.0; 4]), "released texels are clear");
    assert!(atlas.allocate(SIDE, Domain::Sphere).expect("a valid size").is_some(), "merged to one square");
}

#[test]
fn squares_of_one_size_fill_an_atlas_without_waste() {
    let mut atlas = Atlas::new(SIDE, BORDER).expect("an atlas");
    let tiles: Vec<Tile> =
        std::iter::from_fn(|| atlas.allocate(64, Domain::Hemisphere).expect("valid")).collect();
    assert_eq!((tiles.len(), atlas.free_texels()), (64, 0));
}

/// An atlas with tiles of several sizes, and the maps in them.
fn filled() -> (Atlas, Vec<(Tile, Oem)>) {
    let mut atlas = Atlas::new(SIDE, BORDER).expect("an atlas");
    let mut random = Random::new(91);
    let mut tiles = Vec::new();
    for side in [128, 32, 256, 16, 64, 16, 128, 8] {
        let tile = atlas.allocate(side, Domain::Sphere).expect("a valid size").expect("room");
        let texels: Vec<[f32; 3]> = (0..tile.size().inner.pow(2))
            .map(|_| [random.unit(), 1e3 * random.unit(), random.unit().powi(8)].map(|c| c as f32))
            .collect();
        let map = oem(tile.size(), &texels);
        atlas.write(tile, &map.square().copied().collect::<Vec<_>>()).expect("texels of the square");
        tiles.push((tile, map));
    }
    (atlas, tiles)
}

#[test]
fn look_ups_are_those_of_the_map_alone() {
    let (atlas, tiles) = filled();
    let mut random = Random::new(4);
    for (tile, map) in &tiles {
        let size = tile.size();
        let directions = landmarks().into_iter().chain((0..300).map(|_| random.direction()));
        for direction in directions {
            let at = tile.place(direction).expect("the sphere");
            let [x, y] = tile.corner().map(f64::from);
            let low = (at - 0.5).floor();
            assert!(low.x >= x && low.y >= y, "{direction} reads left of or above {tile:?}");
            let far = f64::from(size.bordered());
            assert!(low.x + 1.0 < x + far && low.y + 1.0 < y + far, "{direction} reads beyond {tile:?}");
            // The four texels around, from the map itself.
            let local = at - glam::DVec2::new(x, y) - 0.5;
            let texel = |i: f64, j: f64| {
                let k = ((local.y.floor() + j) * far + local.x.floor() + i) as usize;
                let [r, g, b, w] = map.texels()[k].map(f64::from);
                DVec3::new(r, g, b) / w
            };
            let share = local - local.floor();
            let upper = texel(0.0, 0.0).lerp(texel(1.0, 0.0), share.x);
            let lower = texel(0.0, 1.0).lerp(texel(1.0, 1.0), share.x);
            let wanted = upper.lerp(lower, share.y);
            let found = atlas.radiance(*tile, direction).expect("allocated").expect("the sphere");
            for c in 0..3 {
                let off = (f64::from(found[c]) / wanted[c] - 1.0).abs();
                assert!(off < 1e-6, "{direction} in {tile:?}: {found:?} for {wanted}");
            }
        }
    }
}

#[test]
fn hemispheres_end_at_the_horizon() {
    let mut atlas = Atlas::new(64, 1).expect("an atlas");
    let tile = atlas.allocate(32, Domain::Hemisphere).expect("a valid size").expect("room");
    // Radiance by the quarter that a texel is in.
    let inner = tile.size().inner;
    let of = |x: u32, y: u32| [1.0 + (2 * x / inner) as f32, 1.0 + (2 * y / inner) as f32, 1.0, 1.0];
    let texels: Vec<_> = (0..inner * inner).map(|k| of(k % inner, k / inner)).collect();
    atlas.write(tile, &texels).expect("texels of the square");
    let read = |x: f64, y: f64, z: f64| atlas.radiance(tile, DVec3::new(x, y, z)).expect("allocated");
    // u = x - z, v = x + z.
    assert_eq!(read(1.0, 0.2, 0.0), Some([2.0, 2.0, 1.0]));
    assert_eq!(read(0.0, 0.2, 1.0), Some([1.0, 2.0, 1.0]));
    assert_eq!(read(-1.0, 0.0, 0.0), Some([1.0, 1.0, 1.0]));
    assert_eq!(read(0.0, 0.2, -1.0), Some([2.0, 1.0, 1.0]));
    assert_eq!(read(0.3, -0.1, 0.3), None);
}

#[test]
fn one_scan_sums_the_tables_of_all_tiles() {
    let (atlas, tiles) = filled();
    let sat = atlas.sat(Scan::Blocks);
    assert_eq!(sat, atlas.sat(Scan::Hensley { radix: 4 }));
    for (tile, map) in &tiles {
        let table = sat.tile(*tile);
        let OemSize { inner, border } = tile.size();
        // A scan of the tile's texels alone, in the same units.
        let mut alone = vec![[0; 4]; map.texels().len()];
        let fixed = table.fixed_point();
        octagloss_core::cpu::sat_scan::scan(
            Scan::Serial,
            fixed,
            map.texels(),
            (inner + 2 * border) as usize,
            &mut alone,
        );
        assert!(table.entries() == alone, "{tile:?}");
        // Boxes beyond the border, by the map's own gluing.
        let n = i64::from(inner);
        assert_eq!(table.plane_box(-n, 0, n, n), Sat::plane_box(&table, 0, 0, 2 * n, n));
    }
    // A texel that leaks into a tile's table is seen.
    let (tile, _) = tiles[1];
    let mut other = atlas.clone();
    let next = other.allocate(8, Domain::Sphere).expect("a valid size").expect("room");
    other.write(next, &square(next, 5)).expect("texels of the square");
    assert_ne!(other.sat(Scan::Blocks).whole().entries(), sat.whole().entries());
    let shift = |sat: &Sat| sat.fixed_point().exponents;
    if shift(other.sat(Scan::Blocks).whole()) == shift(sat.whole()) {
        assert_eq!(other.sat(Scan::Blocks).tile(tile), sat.tile(tile));
    }
}

#[test]
fn what_an_atlas_cannot_hold_is_refused() {
    for (side, border) in [(0, 1), (1, 1), (2, 1), (100, 1), (32_768, 1), (64, 0), (64, 32), (4, u32::MAX)] {
        let message = match Atlas::new(side, border) {
            Err(Error::Parameter(message)) => message,
            other => panic!("{side}, {border}: {other:?}"),
        };
        assert!(!message.contains("1 to 0"), "no remedy: {message}");
    }
    let mut atlas = Atlas::new(64, 4).expect("an atlas");
    for side in [0, 4, 8, 48, 128] {
        assert!(matches!(atlas.allocate(side, Domain::Sphere), Err(Error::Parameter(_))), "{side}");
    }
    let tile = atlas.allocate(64, Domain::Sphere).expect("a valid size").expect("room");
    assert_eq!(atlas.allocate(16, Domain::Sphere).expect("a valid size"), None);
    assert!(matches!(atlas.write(tile, &[[1.0; 4]; 5]), Err(Error::Parameter(_))));
    let mut other = Atlas::new(64, 4).expect("an atlas");
    assert!(matches!(other.radiance(tile, DVec3::X), Err(Error::Parameter(_))), "of another atlas");
    assert!(matches!(other.write(tile, &square(tile, 1)), Err(Error::Parameter(_))), "of another atlas");
    // Also if both have a tile at that place.
    let small = other.allocate(16, Domain::Sphere).expect("a valid size").expect("room");
    assert_eq!(small.corner(), tile.corner());
    assert!(matches!(other.release(tile), Err(Error::Parameter(_))), "of another atlas");
    assert!(matches!(atlas.release(small), Err(Error::Parameter(_))), "of another atlas");
    assert_eq!([atlas.free_texels(), other.free_texels()], [0, 64 * 64 - 16 * 16]);
    // A tile released and allocated anew at the same place is another one.
    atlas.release(tile).expect("an allocated tile");
    let again = atlas.allocate(64, Domain::Sphere).expect("a valid size").expect("room");
    assert!(matches!(atlas.radiance(tile, DVec3::X), Err(Error::Parameter(_))));
    assert!(atlas.radiance(again, DVec3::X).is_ok());
}
