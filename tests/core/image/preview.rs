//! The contact sheet is oriented correctly, seamless and labelled without collisions.

use glam::DVec3;
use octagloss_core::files::image::exposure::Exposure;
use octagloss_core::files::image::preview::{Origin, contact_sheet, stacked};
use octagloss_core::light::chain::{Chain, Level};
use octagloss_core::light::chain_lookup::SeamlessLevel;
use octagloss_core::light::environment::Layout;
use octagloss_core::light::environment::Rgb;
use octagloss_core::sphere::cube::{self, Face};
use octagloss_drawing::bitmap::Bitmap;
use octagloss_drawing::scene::Scene;
use octagloss_fixtures::common::Random;
use octagloss_fixtures::files::written::chain;

fn level_of(size: u32, roughness: f64, radiance: impl Fn(Face, DVec3) -> Rgb) -> Level {
    let mut texels = Vec::new();
    for face in Face::ALL {
        for j in 0..size {
            for i in 0..size {
                texels.push(radiance(face, cube::direction_from_texel(face, size, i, j)));
            }
        }
    }
    Level::cube(size, roughness, texels)
}

// Seamless look-up

#[test]
fn a_texel_centre_gives_its_texel() {
    for size in [1, 2, 5, 16] {
        let level = &chain(size, 1, false).levels[0];
        let seamless = SeamlessLevel::new(level);
        for face in Face::ALL {
            for j in 0..size {
                for i in 0..size {
                    let found = seamless.radiance(cube::direction_from_texel(face, size, i, j) * 3.0);
                    let expected = level.face(face)[(j * size + i) as usize].map(f64::from);
                    for c in 0..3 {
                        assert!((found[c] - expected[c]).abs() < 1e-5 * 32.0, "{found:?} {expected:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn texel_centres_of_other_maps_give_their_texels_and_folds_are_continuous() {
    let mut random = Random::new(3);
    for layout in [Layout::Panorama { width: 12, height: 6 }, Layout::Octahedral { size: 7 }] {
        let texels: Vec<Rgb> = (0..layout.texel_count()).map(|k| [k as f32, 1.0, (k * k) as f32]).collect();
        let level = Level { layout, roughness: 0.5, texels, bounds: None };
        let seamless = SeamlessLevel::new(&level);
        let (width, height) = layout.sides();
        for (i, j) in (0..height).flat_map(|j| (0..width).map(move |i| (i, j))) {
            let found = seamless.radiance(layout.direction_from_texel(0, i, j) * 0.5);
            let expected = level.texels[(j * width + i) as usize].map(f64::from);
            assert!(
                (0..3).all(|c| (found[c] - expected[c]).abs() < 1e-6),
                "{layout:?} ({i}, {j}): {found:?}"
            );
        }
        // Steps of 1e-7 across the folds y = 0 and -y, and across the seam of a panorama at -x.
        for _ in 0..2000 {
            // Away from the poles, where a small step turns far.
            let a = random.between(0.2, 1.0);
            let b = random.between(0.2, 1.0) * if random.unit() < 0.5 { -1.0 } else { 1.0 };
            for (inside, outside) in [
                (DVec3::new(b, -a, 1e-7), DVec3::new(b, -a, -1e-7)),
                (DVec3::new(1e-7, -a, b), DVec3::new(-1e-7, -a, b)),
                (DVec3::new(-a, b, 1e-7), DVec3::new(-a, b, -1e-7)),
                (DVec3::new(b, 1e-7, a), DVec3::new(b, -1e-7, a)),
            ] {
                let jump = |c: usize| (seamless.radiance(inside)[c] - seamless.radiance(outside)[c]).abs();
                let far = (0..3).map(jump).fold(0.0, f64::max);
                assert!(far < 0.05, "{layout:?} {inside}: {far}");
            }
        }
    }
}

#[test]
fn look_up_is_continuous_across_every_edge_and_corner() {
    // Random texels: any wrong neighbour causes a jump.
    for size in [1, 2, 3, 8] {
        let chain = chain(size, 1, false);
        let seamless = SeamlessLevel::new(&chain.levels[0]);
        let mut compared = 0;
        for face in Face::ALL {
            for k in 0..=200 {
                let along = f64::from(k) / 100.0 - 1.0;
                for (s, t) in [(1.0, along), (-1.0, along), (along, 1.0), (along, -1.0)] {
                    let edge = cube::cube_point(face, s, t);
                    let inside = cube::cube_point(face, s * (1.0 - 1e-7), t * (1.0 - 1e-7));
                    let outside = edge + (edge - inside);
                    let (a, b) = (seamless.radiance(inside), seamless.radiance(outside));
                    for c in 0..3 {
                        assert!((a[c] - b[c]).abs() < 1e-3, "{face:?} {s} {t}: {a:?} {b:?}");
                    }
                    compared += 1;
                }
            }
        }
        assert_eq!(compared, 6 * 4 * 201);
    }
}

// Contact sheet

/// Position and edge of the first sphere's tile, in pixels: the margin and the panorama's two tiles; and the
/// margin, the title's line of 24 pixels, a space of 18, and the labels' line of 24.
const TILE_AT: (u32, u32) = (26 + 2 * 256, 26 + 24 + 18 + 24);
/// Position of the first cross: below the tile and a space.
const CROSS_AT: (u32, u32) = (TILE_AT.0, TILE_AT.1 + 240 + 10);
const TILE: u32 = 240;

/// Draws a sheet seen along +X: by a removed light over the left shoulder, 35 degrees from -X.
fn sheet(chain: &Chain, exposure: Exposure) -> Bitmap {
    let shoulder = 145.0_f64.to_radians();
    let removed = [DVec3::new(shoulder.cos(), 0.0, -shoulder.sin())];
    contact_sheet(chain, Origin { removed: &removed, ..Origin::default() }, exposure)
        .expect("a sheet")
        .picture()
}

/// Returns a world with one colour per face.
fn coloured() -> Chain {
    let colour = |face: Face| {
        [
            [1.0, 0.05, 0.05],
            [0.05, 1.0, 1.0],
            [0.05, 1.0, 0.05],
            [1.0, 0.05, 1.0],
            [0.05, 0.05, 1.0],
            [1.0, 1.0, 0.05],
        ][face.index()]
    };
    Chain { levels: (0..3).map(|l| level_of(8 >> l, f64::from(l) / 2.0, |face, _| colour(face))).collect() }
}

/// Returns which channels of the pixel at `x`, `y` in [-1, 1] of the first tile are bright.
/// The part of `picture` from (`left`, `top`) on.
fn cropped(picture: &Bitmap, left: u32, top: u32, width: u32, height: u32) -> Bitmap {
    Bitmap::from_fn(width, height, |x, y| picture.pixel(left + x, top + y))
}

fn channels(sheet: &Bitmap, x: f64, y: f64) -> [bool; 3] {
    let at = |origin: u32, v: f64| origin + ((v + 1.0) / 2.0 * f64::from(TILE)) as u32;
    sheet.pixel(at(TILE_AT.0, x), at(TILE_AT.1, y)).map(|c| c > 128)
}

#[test]
fn the_sphere_reflects_what_is_behind_the_camera_and_to_its_sides() {
    let sheet = sheet(&coloured(), Exposure::Auto);
    // The camera looks along +X with +Z to its right: the backdrop is +X, the middle of the ball -X.
    assert_eq!(channels(&sheet, -0.95, -0.95), [true, false, false], "+X behind the sphere");
    assert_eq!(channels(&sheet, 0.0, 0.0), [false, true, true], "-X in its middle");
    assert_eq!(channels(&sheet, 0.55, 0.0), [false, false, true], "+Z to the right");
    assert_eq!(channels(&sheet, -0.55, 0.0), [true, true, false], "-Z to the left");
    assert_eq!(channels(&sheet, 0.0, -0.55), [false, true, false], "+Y above");
    assert_eq!(channels(&sheet, 0.0, 0.55), [true, false, true], "-Y below");
}

#[test]
fn swapped_faces_are_visible_in_the_sheet() {
    let mut chain = coloured();
    let area = 64;
    let (before, after) = chain.levels[0].texels.split_at_mut(5 * area);
    before[4 * area..].swap_with_slice(&mut after[..area]);
    let sheet = sheet(&chain, Exposure::Auto);
    assert_eq!(channels(&sheet, 0.55, 0.0), [true, true, false], "-Z where +Z was");
}

#[test]
fn a_smooth_world_has_no_seams_in_the_sphere() {
    let smooth = |_, d: DVec3| {
        let value = |axis: DVec3| (1.0 + 0.8 * d.dot(axis)) as f32;
        [value(DVec3::X), value(DVec3::Y), value(DVec3::Z)]
    };
    let chain = Chain { levels: vec![level_of(32, 0.0, smooth)] };
    let sheet = sheet(&chain, Exposure::Auto);
    // Within 0.8 of the ball's radius, neighbours differ by no more than the reflection's slope.
    let mut compared = 0;
    for y in 0..TILE - 1 {
        for x in 0..TILE - 1 {
            let (dx, dy) = (f64::from(x) - 119.5, f64::from(y) - 119.5);
            if dx.hypot(dy) < 0.8 * 95.0 {
                let at = |x: u32, y: u32| sheet.pixel(TILE_AT.0 + x, TILE_AT.1 + y);
                for next in [at(x + 1, y), at(x, y + 1)] {
                    for c in 0..3 {
                        let step = i32::from(next[c]) - i32::from(at(x, y)[c]);
                        assert!(step.abs() <= 6, "a step of {step} at {x}, {y}");
                    }
                }
                compared += 1;
            }
        }
    }
    assert!(compared > 10_000);
}

#[test]
fn the_sheet_is_the_same_whatever_the_thread_count_and_has_room_for_every_level() {
    let chain = chain(64, 7, false);
    let drawn = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sheet(&chain, Exposure::Auto))
    };
    let one = drawn(1);
    // Two rows of five tiles, of which the panorama takes two, and two margins; above two rows of labels,
    // tile and cross the title, below a line of the caption.
    let row = 24 + 240 + 10 + 180;
    assert_eq!(one.width(), 5 * 240 + 4 * 16 + 2 * 26);
    assert_eq!(one.height(), 26 + 24 + 18 + 2 * row + 16 + 16 + 22 + 20);
    assert!(drawn(3) == one);
    assert!(contact_sheet(&Chain { levels: vec![] }, Origin::default(), Exposure::Auto).is_err());
}

#[test]
fn black_worlds_are_black_and_extreme_ones_exposed() {
    let middle = |radiance| {
        let chain = Chain { levels: vec![level_of(4, 0.0, |_, _| [radiance; 3])] };
        sheet(&chain, Exposure::Auto).pixel(TILE_AT.0 + TILE / 2, TILE_AT.1 + TILE / 2)
    };
    assert_eq!(middle(0.0), [0; 3]);
    assert_eq!(middle(1e-30), middle(1.0));
    assert_eq!(middle(f32::MAX), middle(1.0));
}

#[test]
fn exposure_is_automatic_or_a_number() {
    let chain = chain(4, 1, false);
    let tile = |exposure| cropped(&sheet(&chain, exposure), TILE_AT.0, TILE_AT.1, TILE, TILE);
    // The caption tells it, to a hundredth.
    let labels = contact_sheet(&chain, Origin::default(), Exposure::Auto).expect("a sheet").labels();
    let caption = labels.iter().find_map(|(text, _)| text.strip_prefix("Exposure ")).expect("a caption");
    let said = caption.split('\u{a0}').next().expect("a number").replace('\u{2212}', "-");
    let off = |a: &Bitmap, b: &Bitmap| a.bytes().iter().zip(b.bytes()).map(|(a, b)| a.abs_diff(*b)).max();
    let automatic = tile(Exposure::Auto);
    let ev: f64 = said.parse().expect("a number");
    assert!(off(&automatic, &tile(Exposure::Ev(ev))) <= Some(2), "{said}");
    assert!(off(&automatic, &tile(Exposure::Ev(ev - 2.0))) > Some(20));
}

/// Returns a chain of a dim sky with a sun of 5 degrees along `sun`, as a panorama or cube.
fn sunny(layout: Layout, sun: DVec3) -> Chain {
    let level = |roughness: f64| {
        let (width, height) = layout.sides();
        let images = (layout.texel_count() / (width * height) as usize) as u32;
        let places =
            (0..images).flat_map(|k| (0..height).flat_map(move |j| (0..width).map(move |i| (k, i, j))));
        let radiance = |(k, i, j)| {
            let cosine = layout.direction_from_texel(k, i, j).normalize().dot(sun);
            // A lobe: sharp, or half of the sphere.
            let light =
                if roughness == 0.0 { 500.0 * f64::from(cosine > 0.999) } else { 3.0 * cosine.max(0.0) };
            [(0.2 + light) as f32; 3]
        };
        Level { layout, roughness, texels: places.map(radiance).collect(), bounds: None }
    };
    Chain { levels: vec![level(0.0), level(1.0)] }
}

/// Centre of brightness of a tile, from -1 to 1 to the right and down.
fn brightest_place(sheet: &Bitmap, tile: u32) -> (f64, f64) {
    let (mut sum, mut at) = (0.0, (0.0, 0.0));
    for (x, y) in (0..TILE).flat_map(|y| (0..TILE).map(move |x| (x, y))) {
        let (dx, dy) = (f64::from(x) / 119.5 - 1.0, f64::from(y) / 119.5 - 1.0);
        let pixel = sheet.pixel(TILE_AT.0 + tile * 256 + x, TILE_AT.1 + y)[0];
        // Within the ball, whose radius is about four fifths.
        let weight = if dx.hypot(dy) < 0.75 { f64::from(pixel).powi(40) } else { 0.0 };
        (sum, at) = (sum + weight, (at.0 + weight * dx, at.1 + weight * dy));
    }
    (at.0 / sum, at.1 / sum)
}

#[test]
fn the_lit_side_faces_the_camera_wherever_the_sun_is_and_the_panorama_marks_it() {
    for (azimuth, layout) in [
        (0.3_f64, Layout::Cube { size: 64 }),
        (2.0, Layout::Panorama { width: 128, height: 64 }),
        (-1.5, Layout::Octahedral { size: 128 }),
        (3.1, Layout::Cube { size: 64 }),
    ] {
        let sun = DVec3::new(azimuth.cos(), 0.4, azimuth.sin()).normalize();
        let chain = sunny(layout, sun);
        let scene = contact_sheet(&chain, Origin::default(), Exposure::Auto).expect("a sheet");
        let picture = scene.picture();
        // The mirror shows it where the normal halves the way to the camera: left of the middle and above.
        for tile in [0, 1] {
            let (x, y) = brightest_place(&picture, tile);
            assert!((-0.5..-0.1).contains(&x) && (-0.4..-0.02).contains(&y), "{layout:?} {tile}: {x} {y}");
        }
        // Not burnt to white: lit, but below white outside the sun itself.
        let tile = cropped(&picture, TILE_AT.0 + 256, TILE_AT.1, TILE, TILE);
        let most = tile.bytes().chunks(3).map(|pixel| pixel[0]).max();
        assert!((180..250).contains(&most.expect("pixels")), "{layout:?}: {most:?}");
        check_labels(&scene);
        let labels = scene.labels();
        let mark = &labels.iter().find(|(text, _)| text == "sun").expect("a mark").1;
        let place = (mark.low + mark.high) / 2.0;
        // The label is beside the ring, whose centre is the sun's place in the panorama of 496 x 248 pixels.
        let u = 0.5 + azimuth / std::f64::consts::TAU;
        let v = sun.y.acos() / std::f64::consts::PI;
        let ring = glam::DVec2::new(26.0 + u * 496.0, f64::from(TILE_AT.1) + v * 248.0);
        assert!(place.distance(ring) < 45.0, "{layout:?}: {place} {ring}");
        assert!(labels.iter().any(|(text, _)| text.starts_with("sun: azimuth ")), "{labels:?}");
    }
}

#[test]
fn removed_lights_are_marked_and_place_the_camera() {
    // Nothing stands out in what is left.
    let chain = Chain { levels: vec![level_of(16, 0.0, |_, d| [(1.0 + 0.9 * d.z) as f32; 3])] };
    let origin = |removed| Origin { removed, ..Origin::default() };
    let many: Vec<DVec3> = (0..7).map(|k| DVec3::new(f64::from(k) - 3.0, 0.5, 1.0).normalize()).collect();
    for removed in [&[DVec3::Z][..], &many] {
        let scene = contact_sheet(&chain, origin(removed), Exposure::Auto).expect("a sheet");
        check_labels(&scene);
        let labels = scene.labels();
        let marks = labels.iter().filter(|(text, _)| text == "removed light").count();
        assert_eq!(marks, removed.len(), "{labels:?}");
        let listed = labels.iter().filter(|(text, _)| text.starts_with("removed light: ")).count();
        assert_eq!(listed, removed.len().min(4));
        assert_eq!(labels.iter().any(|(text, _)| text == "and 3 more"), removed.len() == 7, "{labels:?}");
    }
    // By default the brighter side, +Z, is over the left shoulder; a removed light 70 degrees on
    // takes its place, and +Z is over the right one.
    for (removed, range) in [(&[][..], -0.6..-0.1), (&[DVec3::new(-0.94, 0.2, 0.34)], 0.1..0.6)] {
        let scene = contact_sheet(&chain, origin(removed), Exposure::Auto).expect("a sheet");
        let (x, _) = brightest_place(&scene.picture(), 0);
        assert!(range.contains(&x), "{removed:?}: {x}");
    }
}

#[test]
fn levels_have_an_outline_whether_black_or_white() {
    for (ev, shown) in [(40.0, 255), (-40.0, 0)] {
        let chain = Chain { levels: vec![level_of(4, 0.0, |_, _| [1.0; 3])] };
        let sheet = sheet(&chain, Exposure::Ev(ev));
        // The top of the face +Y, the second of four: paper, line, texels.
        let x = CROSS_AT.0 + 90;
        let column: Vec<u8> = (CROSS_AT.1 - 4..CROSS_AT.1 + 6).map(|y| sheet.pixel(x, y)[0]).collect();
        let (first, last) = (column[0], column[9]);
        assert!(first == 255 && last.abs_diff(shown) < 3, "{column:?}");
        assert!(column.iter().any(|c| c.abs_diff(shown) > 50 && *c < 220), "no line: {column:?}");
    }
}

// Labels

/// Fails if a text leaves the picture or covers another.
fn check_labels(scene: &Scene) {
    let texts = scene.labels();
    for (k, (text, own)) in texts.iter().enumerate() {
        assert!(scene.frame().holds(own), "{text:?} is cut off");
        for (other, others) in &texts[..k] {
            assert!(!own.overlaps(others), "{text:?} covers {other:?}");
        }
    }
}

#[test]
fn labels_tell_file_target_exposure_roughness_and_size_without_collisions() {
    let names =
        ["sky.exr", "\u{5929}\u{7a7a} \u{dc}ber \u{3b1}\u{3c9}.hdr", &"very_long_name_".repeat(20), ""];
    let layouts = [
        Layout::Cube { size: 1 },
        Layout::Cube { size: 16 },
        Layout::Panorama { width: 32, height: 16 },
        Layout::Octahedral { size: 16 },
    ];
    // One level, a full row, one more, and three rows.
    for ((name, layout), count) in names.into_iter().zip(layouts).zip([1_u32, 5, 6, 11]) {
        let level = |k: u32| Level {
            layout,
            roughness: f64::from(k) / 16.0,
            texels: vec![[1.0; 3]; layout.texel_count()],
            bounds: None,
        };
        let chain = Chain { levels: (0..count).map(level).collect() };
        let scene =
            contact_sheet(&chain, Origin { name, target: "three", ..Origin::default() }, Exposure::Ev(-1.5))
                .expect("a sheet");
        check_labels(&scene);
        let texts: Vec<String> = scene.labels().into_iter().map(|(text, _)| text).collect();
        let all = texts.join(" ");
        // The last dozen letters of a name survive its shortening.
        let end = name.char_indices().rev().nth(11).map_or(name, |(at, _)| &name[at..]);
        assert!(texts[0].ends_with(end), "{texts:?}");
        assert!(all.contains("Target three.") && all.contains("\u{2212}1.50\u{a0}EV"), "{all}");
        assert_eq!(texts.iter().filter(|text| text.starts_with("roughness 0.")).count() as u32, count);
        let size = match layout {
            Layout::Cube { size } => format!("6 \u{d7} {size}\u{b2}"),
            _ => layout.sides().0.to_string(),
        };
        let sized = texts.iter().filter(|text| text.contains('\u{d7}') && text.contains(&size)).count();
        // The levels and the environment, here level 0.
        assert_eq!(sized as u32, count + 1, "{texts:?}");
    }
    // The greatest sizes fit, too: the widest texts stand on one line of a tile.
    let widest = octagloss_drawing::font::text_width("16384 \u{d7} 8192", 14.5)
        + octagloss_drawing::font::text_width("roughness 0.000", 16.0);
    assert!(widest < 230.0, "{widest}");
}

#[test]
fn stacked_sheets_are_as_high_as_all() {
    let chain = chain(8, 2, false);
    let scene = |target| {
        contact_sheet(&chain, Origin { name: "a", target, ..Origin::default() }, Exposure::Auto)
            .expect("a sheet")
    };
    let (one, two) = (scene("three"), scene("godot"));
    let all = stacked(&[one.clone(), two.clone()]);
    let below = cropped(&all, 0, one.picture().height(), all.width(), two.picture().height());
    assert_eq!(below, two.picture());
    assert_ne!(one.picture(), two.picture(), "the target is named");
}
