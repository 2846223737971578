//! The synthetic environments: content, orientation, and that `hdr/` matches the program's output.

use glam::DVec3;
use octagloss_core::files::format::OutputLayout;
use octagloss_core::files::io::environment_write::write_environment;
use octagloss_core::files::io::layout::image_from_faces;
use octagloss_core::files::io::output::Existing;
use octagloss_core::light::environment::{Environment, Layout, Rgb, luminance};
use octagloss_core::light::synth::{RECIPES, SUN_RADIANCE, SUN_RADIUS, labelled_cube, sun_direction, synth};
use octagloss_core::sphere::cube::{self, Face};
use octagloss_core::sphere::equirect::equirect_from_direction;
use octagloss_fixtures::files::written::{names_in, read_exr_rgb, to_half};
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

/// Sines and powers may differ in the last bit between platforms and then round differently: by at most one
/// step of the file's format, relative to the texel's greatest channel.
const HALF_STEP: f32 = 1.0 / 1024.0;
const RGBE_STEP: f32 = 1.0 / 128.0;

fn hdr_folder() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../hdr")
}

/// Returns the first texel of `found` further than `step` from `expected`.
fn first_far(found: &[Rgb], expected: &[Rgb], step: f32) -> Option<usize> {
    assert_eq!(found.len(), expected.len());
    assert!(!found.is_empty());
    (0..found.len()).find(|at| {
        let greatest = expected[*at].iter().copied().fold(0.0, f32::max);
        (0..3).any(|c| (found[*at][c] - expected[*at][c]).abs() > step * greatest)
    })
}

fn image_of(environment: &Environment) -> Vec<Rgb> {
    match environment.layout() {
        Layout::Cube { size } => {
            image_from_faces(OutputLayout::Cross, size, environment.texels()).expect("a cross").1
        }
        _ => environment.texels().to_vec(),
    }
}

#[test]
fn the_committed_files_match_synth() {
    let mut total = 0;
    for recipe in RECIPES {
        let path = hdr_folder().join(recipe.file_name);
        let bytes = fs::read(&path).unwrap();
        total += bytes.len();
        let expected = image_of(&synth(recipe.name).unwrap());
        let (found, step) = if recipe.file_name.ends_with(".exr") {
            (read_exr_rgb(&bytes), HALF_STEP)
        } else {
            let image = image::open(&path).unwrap().to_rgb32f();
            (image.pixels().map(|p| p.0).collect(), RGBE_STEP)
        };
        assert_eq!(first_far(&found, &expected, step), None, "{}", recipe.name);
        // One wrong texel is detected.
        let mut wrong = found.clone();
        wrong[expected.len() / 2][1] *= 1.05;
        assert_eq!(first_far(&wrong, &expected, step), Some(expected.len() / 2), "{}", recipe.name);
    }
    // The README's images.
    for picture in ["cmgen.png", "ladder.png"] {
        total += fs::read(hdr_folder().join(picture)).unwrap().len();
    }
    assert!(total < 2 << 20, "{total} bytes");
    let others = ["README.md", "cmgen.png", "ladder.png"];
    let mut expected: Vec<&str> = RECIPES.iter().map(|r| r.file_name).chain(others).collect();
    expected.sort_unstable();
    assert_eq!(names_in(&hdr_folder()), expected);
}

#[test]
fn equal_calls_write_equal_bytes_whatever_the_thread_count() {
    let folder = tempfile::tempdir().unwrap();
    for recipe in RECIPES {
        let path = folder.path().join(recipe.file_name);
        let bytes = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let environment = pool.install(|| synth(recipe.name)).unwrap();
            write_environment(&path, Existing::Replace, &environment, recipe.name).unwrap();
            fs::read(&path).unwrap()
        });
        assert!(bytes[0] == bytes[1], "{}", recipe.name);
    }
}

#[test]
fn an_unknown_name_is_an_error_that_lists_the_known() {
    let message = synth("skye").unwrap_err().to_string();
    for recipe in RECIPES {
        assert!(message.contains(recipe.name), "{message}");
    }
}

#[test]
fn the_furnace_is_one_everywhere() {
    assert!(synth("furnace").unwrap().texels().iter().all(|t| *t == [1.0; 3]));
}

#[test]
fn the_sky_has_a_sun_of_the_right_size_in_the_right_place() {
    let sky = synth("sky").unwrap();
    let (mut sun_energy, mut weighted, mut others, mut peak) = (0.0, DVec3::ZERO, 0.0_f32, 0.0_f32);
    let mut texels = 0;
    sky.for_each_texel(|direction, solid_angle, radiance| {
        let bright = luminance(radiance);
        if bright > 500.0 {
            sun_energy += solid_angle * f64::from(radiance[0]);
            weighted += direction * solid_angle * f64::from(radiance[0]);
            texels += 1;
            peak = peak.max(bright);
        } else {
            others = others.max(bright);
        }
    });
    // The disc's energy equals the expected one within the accuracy of its supersampling, minus the edge
    // texels excluded above.
    let expected = f64::from(SUN_RADIANCE[0]) * 2.0 * PI * (1.0 - SUN_RADIUS.cos());
    assert!((sun_energy / expected - 1.0).abs() < 0.03, "{sun_energy} of {expected}");
    assert!((2..=9).contains(&texels), "{texels} texels");
    assert!(peak > 10_000.0 && peak < 65_504.0, "{peak}");
    assert!(others < 50.0, "nothing else is nearly as bright: {others}");
    assert!(weighted.normalize().angle_between(sun_direction()) < 0.2 * PI / 256.0);
}

#[test]
fn the_studio_is_dark_with_bright_sharp_lights() {
    let studio = synth("studio").unwrap();
    let share = |low: f32, high: f32| {
        let mut sum = 0.0;
        studio.for_each_texel(|_, solid_angle, radiance| {
            let bright = luminance(radiance);
            if bright >= low && bright < high {
                sum += solid_angle / (4.0 * PI);
            }
        });
        sum
    };
    assert!(share(0.0, 0.3) > 0.75, "dark share {}", share(0.0, 0.3));
    assert!(share(100.0, 400.0) > 0.0001, "a hot spot");
    assert!(share(1.0, 100.0) > 0.05, "panels");
}

/// Counts ink on `face` of the world `labelled`, in a box seen from inside: to the right and down, in
/// [-1, 1].
fn ink(environment: &Environment, face: Face, right: [f64; 2], down: [f64; 2]) -> usize {
    let Layout::Panorama { width, height } = environment.layout() else { panic!("a panorama") };
    let mut count = 0;
    for j in 0..80 {
        for i in 0..80 {
            let (x, y) = (f64::from(i) / 40.0 - 1.0, f64::from(j) / 40.0 - 1.0);
            if x >= right[0] && x < right[1] && y >= down[0] && y < down[1] {
                // Seen from inside with +Y up, a face's right is forward x up.
                let direction = match face {
                    Face::PosX => DVec3::new(1.0, -y, x),
                    Face::NegX => DVec3::new(-1.0, -y, -x),
                    Face::PosZ => DVec3::new(-x, -y, 1.0),
                    Face::NegZ => DVec3::new(x, -y, -1.0),
                    Face::PosY => DVec3::new(-x, 1.0, y),
                    Face::NegY => DVec3::new(-x, -1.0, -y),
                };
                let (u, v) = equirect_from_direction(direction);
                let column = ((u * f64::from(width)) as usize).min(width as usize - 1);
                let row = ((v * f64::from(height)) as usize).min(height as usize - 1);
                count += usize::from(luminance(environment.texels()[row * width as usize + column]) < 0.15);
            }
        }
    }
    count
}

/// The topmost row of the letters' cells, in the face's down direction.
const TOP_OF_LETTERS: [f64; 2] = [-0.16, -0.08];

#[test]
fn labels_read_from_left_to_right_in_the_panorama_and_arrows_point_up() {
    let panorama = synth("labelled").unwrap();
    for face in Face::ALL {
        // The letter, on the right, reaches higher than the sign, on the left.
        assert_eq!(ink(&panorama, face, [-0.8, 0.0], TOP_OF_LETTERS), 0, "{face:?}");
        assert!(ink(&panorama, face, [0.0, 0.8], TOP_OF_LETTERS) > 5, "{face:?}");
        // An arrow's head is wider than its shaft: more ink above its middle than below.
        let head = ink(&panorama, face, [-0.3, 0.3], [-0.76, -0.54]);
        let shaft = ink(&panorama, face, [-0.3, 0.3], [-0.46, -0.24]);
        assert!(shaft > 5 && head > shaft, "{face:?}: {head} {shaft}");
    }
    // The same check fails on the mirrored world.
    let Layout::Panorama { width, .. } = panorama.layout() else { panic!("a panorama") };
    let mirrored: Vec<Rgb> =
        panorama.texels().chunks(width as usize).flat_map(|row| row.iter().rev().copied()).collect();
    let mirrored = Environment::new(panorama.layout(), mirrored).unwrap();
    assert!(ink(&mirrored, Face::PosX, [-0.8, 0.0], TOP_OF_LETTERS) > 5);
}

#[test]
fn the_labelled_cube_is_the_world_of_the_labelled_panorama() {
    let panorama = synth("labelled").unwrap();
    let Layout::Panorama { width, height } = panorama.layout() else { panic!("a panorama") };
    let (size, mut near) = (64, 0);
    let cube_world = labelled_cube(size).unwrap();
    for face in Face::ALL {
        for j in 0..size {
            for i in 0..size {
                let (u, v) = equirect_from_direction(cube::direction_from_texel(face, size, i, j));
                let row = (v * f64::from(height)) as usize;
                let seen = panorama.texels()
                    [row * width as usize + (u * f64::from(width)) as usize % width as usize];
                let stored = cube_world.texels()[((face.index() as u32 * size + j) * size + i) as usize];
                near += usize::from((0..3).all(|c| (seen[c] - stored[c]).abs() < 0.15));
            }
        }
    }
    // Texels on the edges of letters and squares may differ.
    assert!(near as f64 > 0.85 * 6.0 * f64::from(size * size), "{near}");
    assert!(synth("labelled-cube").unwrap().texels().iter().all(|t| to_half(*t)[0] <= 1.0));
}
