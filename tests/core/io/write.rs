//! The image writers: output is deterministic, and other readers read it back.

use exr::prelude::{AttributeValue, Text};
use half::f16;
use octagloss_core::bake::Bake;
use octagloss_core::files::export::files::{Made, files};
use octagloss_core::files::format::container::Container;
use octagloss_core::files::format::{
    HALF_MAX, OutputLayout, Pixel, RGB9E5_MAX, push_halves, rgb_from_rgb9e5, rgb9e5_from_rgb,
};
use octagloss_core::files::io::environment_write::write_environment;
use octagloss_core::files::io::exr::write::{Attribute, Samples, exr_bytes};
use octagloss_core::files::io::hdr::hdr_bytes;
use octagloss_core::files::io::ktx2::write::ktx2_bytes;
use octagloss_core::files::io::layout::CROSS_CELLS;
use octagloss_core::files::io::ldr::write_png;
use octagloss_core::files::io::output::Existing;
use octagloss_core::files::target::{Diffuse, TargetPlan, UNTARGETED};
use octagloss_core::light::chain::{Chain, Level};
use octagloss_core::light::environment::{Environment, Layout, Rgb};
use octagloss_core::light::oem::OemSize;
use octagloss_core::light::sh::window::ShWindow;
use octagloss_core::sphere::cube::Face;
use octagloss_drawing::bitmap::Bitmap;
use octagloss_fixtures::files::written::{
    chain, first_difference, metadata, names_in, noise, read_exr, read_exr_rgb, texels, to_half,
};
use octagloss_shaders::reader;
use std::collections::BTreeMap;
use std::fs;

#[test]
fn every_half_float_survives_and_midpoints_round_to_even() {
    let finite: Vec<f16> = (0..0x7c00_u16).map(f16::from_bits).collect();
    let values: Vec<f32> = finite.iter().map(|h| h.to_f32()).collect();
    let mut bytes = Vec::new();
    push_halves(&values, &mut bytes);
    let expected: Vec<u8> = finite.iter().flat_map(|h| h.to_le_bytes()).collect();
    assert!(bytes == expected);

    // Halfway between two neighbours, the one with an even mantissa wins.
    let midpoints: Vec<f32> = values.windows(2).map(|pair| f32::midpoint(pair[0], pair[1])).collect();
    bytes.clear();
    push_halves(&midpoints, &mut bytes);
    for (lower, half) in bytes.chunks_exact(2).enumerate() {
        let rounded = u16::from_le_bytes([half[0], half[1]]);
        assert_eq!(usize::from(rounded), lower + lower % 2, "above half {lower:#06x}");
    }
}

#[test]
fn half_floats_clamp_at_their_greatest_and_count_it() {
    let mut bytes = Vec::new();
    push_halves(&[HALF_MAX, 65519.0, 65520.0, 1e30, f32::INFINITY, f32::MAX], &mut bytes);
    assert!(bytes.chunks_exact(2).all(|h| h == f16::MAX.to_le_bytes()));
    let texels = [[1.0, HALF_MAX, 0.0], [65504.004, 1.0, 1.0], [0.0, 1e6, 1e6]];
    assert_eq!(Pixel::F16.clamped(&texels), 2);
    assert_eq!(Pixel::Rgb9e5.clamped(&texels), 3);
    assert_eq!(Pixel::F32.clamped(&texels), 0);
}

#[test]
fn every_rgb9e5_colour_of_one_channel_survives() {
    for exponent in 0..32_u32 {
        for mantissa in 0..512_u32 {
            for shift in [0, 9, 18] {
                let colour = rgb_from_rgb9e5(exponent << 27 | mantissa << shift);
                assert_eq!(rgb_from_rgb9e5(rgb9e5_from_rgb(colour)), colour, "{exponent} {mantissa} {shift}");
            }
        }
    }
}

#[test]
fn rgb9e5_rounds_to_nearest_clamps_and_carries() {
    // The specification's limits: 2^-24 is the least step, (511/512)*2^16 the greatest value.
    assert_eq!(rgb_from_rgb9e5(1), [2_f32.powi(-24), 0.0, 0.0]);
    assert_eq!(rgb_from_rgb9e5(0xf800_0000 | 511), [RGB9E5_MAX, 0.0, 0.0]);
    assert_eq!(rgb9e5_from_rgb([1e9, f32::INFINITY, 0.0]), 0xf800_0000 | 511 << 9 | 511);
    assert_eq!(rgb9e5_from_rgb([-1.0, 0.0, -0.0]), 0);
    assert_eq!(rgb9e5_from_rgb([1e-30, f32::MIN_POSITIVE, 0.0]), 0);
    // 511.5/512 rounds up to 512/512: the exponent carries.
    assert_eq!(rgb_from_rgb9e5(rgb9e5_from_rgb([511.5 / 512.0, 0.0, 0.0])), [1.0, 0.0, 0.0]);
    for at in 0..100_000_u64 {
        let colour = [0, 1, 2].map(|c| (noise(at * 3 + c) * 44.0 - 28.0).exp2().min(RGB9E5_MAX));
        let packed = rgb9e5_from_rgb(colour);
        let back = rgb_from_rgb9e5(packed);
        let step = ((packed >> 27) as f32 - 24.0).exp2();
        for c in 0..3 {
            assert!((back[c] - colour[c]).abs() <= step / 2.0, "{colour:?} {back:?}");
        }
        let greatest = colour.into_iter().fold(0.0, f32::max);
        // 255.75 rounds up to a step of twice the size.
        assert!(step <= (greatest / 255.75).max(2_f32.powi(-24)), "the exponent is too great: {colour:?}");
    }
}

#[test]
fn exr_files_come_back_as_written() {
    for (width, height) in [(1, 1), (2, 1), (1, 3), (5, 17), (16, 16), (33, 40), (64, 32)] {
        let count = (width * height) as usize;
        let original = texels(count, 7);
        let attributes = [
            ("roughness".to_owned(), Attribute::Float(0.25)),
            ("lobe".to_owned(), Attribute::Text("ggx".to_owned())),
        ];
        for (pixel, expected) in [
            (Pixel::F32, original.clone()),
            (Pixel::F16, original.iter().map(|t| to_half(*t)).collect::<Vec<_>>()),
        ] {
            let bytes = exr_bytes(width, height, Samples::Rgb(&original), pixel, &attributes).unwrap();
            let (w, h, _, found) = read_exr(&bytes, &["R", "G", "B"]);
            assert_eq!((w, h), (width as usize, height as usize));
            assert_eq!(first_difference(&read_exr_rgb(&bytes), &expected), None);
            assert_eq!(found.other[&Text::from("roughness")], AttributeValue::F32(0.25));
            assert_eq!(found.other[&Text::from("lobe")], AttributeValue::Text(Text::from("ggx")));
            let software = found.software_name.map(|t| t.to_string());
            assert_eq!(software, Some(format!("octagloss {}", env!("CARGO_PKG_VERSION"))));
        }
        let luminances: Vec<f32> = original.iter().map(|t| t[0]).collect();
        let bytes = exr_bytes(width, height, Samples::Luminance(&luminances), Pixel::F32, &[]).unwrap();
        assert_eq!(read_exr(&bytes, &["Y"]).2, [luminances]);
    }
}

#[test]
fn exr_stores_incompressible_and_compressible_blocks() {
    // Random bits stay uncompressed; a constant shrinks to almost nothing.
    let random: Vec<f32> = (0..64 * 64).map(|at| noise(at) * 3e38 * noise(at + 9999)).collect();
    let bytes = exr_bytes(64, 64, Samples::Luminance(&random), Pixel::F32, &[]).unwrap();
    assert_eq!(read_exr(&bytes, &["Y"]).2, [random]);
    let constant = vec![[0.5; 3]; 64 * 64];
    let bytes = exr_bytes(64, 64, Samples::Rgb(&constant), Pixel::F16, &[]).unwrap();
    assert!(bytes.len() < 1200, "{} bytes", bytes.len());
    assert_eq!(first_difference(&read_exr_rgb(&bytes), &constant), None);
}

#[test]
fn the_exr_comparison_detects_one_wrong_texel() {
    let original = texels(16 * 16, 1);
    let mut wrong = original.clone();
    wrong[37][1] *= 1.01;
    let bytes = exr_bytes(16, 16, Samples::Rgb(&wrong), Pixel::F32, &[]).unwrap();
    assert_eq!(first_difference(&read_exr_rgb(&bytes), &original), Some(37));
}

#[test]
fn exr_refuses_what_it_cannot_hold() {
    for (width, height, count) in [(0, 4, 0), (4, 4, 15), (4, 4, 17)] {
        let image = vec![[1.0; 3]; count];
        assert!(exr_bytes(width, height, Samples::Rgb(&image), Pixel::F16, &[]).is_err());
    }
    assert!(exr_bytes(1, 1, Samples::Rgb(&[[1.0; 3]]), Pixel::Rgb9e5, &[]).is_err());
}

/// Returns the files of a level folder.
fn level_folder(
    chain: &Chain,
    irradiance: Option<Level>,
    container: Container,
    pixel: Pixel,
) -> BTreeMap<String, Made> {
    let diffuse = if irradiance.is_some() { Diffuse::Cube } else { Diffuse::None };
    let layout = OutputLayout::Faces;
    let plan = TargetPlan { container, pixel, diffuse, layout, ..TargetPlan::new(&UNTARGETED) };
    let bake = Bake {
        pyramid: None,
        typical_error: None,
        chain: chain.clone(),
        stats: Vec::new(),
        irradiance,
        skybox: None,
        sheen: None,
        sheen_stats: Vec::new(),
        sh: vec![[0.0; 3]; 9],
        sh_window: ShWindow::None,
        oem: OemSize { inner: 64, border: 0 },
        source_energy: [0.0; 3],
        oem_energy: [0.0; 3],
        warnings: Vec::new(),
    };
    let made = files(&plan, "bake", &bake, &metadata(), reader).unwrap();
    made.into_iter().map(|file| (file.path.clone(), file)).collect()
}

#[test]
fn ktx2_counts_what_it_clamps() {
    let mut chain = chain(4, 2, false);
    chain.levels[0].texels[5] = [65_450.0, 1.0, 1.0];
    chain.levels[1].texels[2] = [0.0, 1e6, 1e7];
    let clamped = |pixel| level_folder(&chain, None, Container::Ktx2, pixel)["bake"].clamped.clone();
    assert_eq!(clamped(Pixel::F16), [0, 1]);
    assert_eq!(clamped(Pixel::Rgb9e5), [1, 1]);
    assert_eq!(clamped(Pixel::F32), [0, 0]);
}

#[test]
fn an_exr_folder_holds_every_face_bound_and_the_irradiance() {
    let mut chain = chain(16, 3, true);
    chain.levels[1].texels[3][2] = 70_000.0;
    let irradiance = Level::cube(4, 1.0, texels(96, 5));
    let clamped = |made: &BTreeMap<String, Made>| made.values().flat_map(|m| &m.clamped).sum::<u64>();
    let made = level_folder(&chain, Some(irradiance), Container::Exr, Pixel::Auto);
    assert_eq!((clamped(&made), made.len()), (0, 3 * 6 * 2 + 6));
    assert!(made.contains_key("irradiance_px.exr"));

    for (index, level) in chain.levels.iter().enumerate() {
        for face in Face::ALL {
            let name = face.short_name();
            let bytes = &made[&format!("m{index}_{name}.exr")].bytes;
            // Half floats, except where they do not suffice.
            let expected: Vec<Rgb> =
                level.face(face).iter().map(|t| if index == 1 { *t } else { to_half(*t) }).collect();
            assert_eq!(first_difference(&read_exr_rgb(bytes), &expected), None, "level {index} {name}");
            let attributes = read_exr(bytes, &["R", "G", "B"]).3.other;
            assert_eq!(attributes[&Text::from("roughness")], AttributeValue::F32(level.roughness as f32));
            let bytes = &made[&format!("m{index}_{name}_bound.exr")].bytes;
            let area = (level.size() * level.size()) as usize;
            let bounds = &level.bounds.as_ref().unwrap()[face.index() * area..][..area];
            assert_eq!(read_exr(bytes, &["Y"]).2, [bounds.to_vec()]);
        }
    }
    // A swapped face is detected.
    let other: Vec<Rgb> = chain.levels[0].face(Face::PosX).iter().map(|t| to_half(*t)).collect();
    assert!(first_difference(&read_exr_rgb(&made["m0_nx.exr"].bytes), &other).is_some());
    // On request, half clamps and counts; float does neither.
    assert_eq!(clamped(&level_folder(&chain, None, Container::Exr, Pixel::F16)), 1);
    assert_eq!(clamped(&level_folder(&chain, None, Container::Exr, Pixel::F32)), 0);
}

#[test]
fn equal_chains_give_equal_bytes_whatever_the_thread_count() {
    let chain = chain(32, 3, true);
    let written = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut all = level_folder(&chain, None, Container::Exr, Pixel::Auto);
            all.extend(level_folder(&chain, None, Container::Hdr, Pixel::Rgbe));
            let all: Vec<_> = all.into_iter().map(|(name, file)| (name, file.bytes)).collect();
            let ktx2 = ktx2_bytes(&chain.levels, Pixel::F16, &metadata()).unwrap();
            (all, ktx2)
        })
    };
    let one = written(1);
    assert_eq!(one.0.len(), 3 * 6 * 3);
    for threads in [1, 2, 5] {
        assert!(written(threads) == one, "{threads} threads");
    }
}

#[test]
fn hdr_files_come_back_within_half_a_step_without_bias() {
    let original = texels(64 * 32, 3);
    let bytes = hdr_bytes(64, 32, &original, &[]).unwrap();
    let decoded = image::load_from_memory_with_format(&bytes, image::ImageFormat::Hdr).unwrap().to_rgb32f();
    assert_eq!(decoded.dimensions(), (64, 32));
    let (mut sum, mut decoded_sum) = (0.0, 0.0);
    for (texel, back) in original.iter().zip(decoded.pixels()) {
        let greatest = texel.iter().copied().fold(0.0, f32::max);
        for c in 0..3 {
            // A mantissa has 8 bits, and the greatest lies in [128, 256) steps.
            assert!((texel[c] - back[c]).abs() <= greatest / 256.0, "{texel:?} {back:?}");
            sum += f64::from(texel[c]);
            decoded_sum += f64::from(back[c]);
        }
    }
    assert!((decoded_sum / sum - 1.0).abs() < 3e-4, "bias {}", decoded_sum / sum - 1.0);
}

#[test]
fn hdr_holds_extremes_without_wrapping() {
    let original = [[0.0; 3], [1e-42; 3], [f32::MAX, 0.0, 1.0], [1e6; 3], [255.9, 0.6, 128.0]];
    let bytes = hdr_bytes(5, 1, &original, &[]).unwrap();
    let decoded = image::load_from_memory_with_format(&bytes, image::ImageFormat::Hdr).unwrap().to_rgb32f();
    let back: Vec<Rgb> = decoded.pixels().map(|p| p.0).collect();
    assert_eq!(back[0], [0.0; 3]);
    assert_eq!(back[1], [0.0; 3]);
    assert!(back[2][0] > 1.6e38 && back[2][1] == 0.0);
    assert!((back[3][0] - 1e6).abs() < 1e6 / 256.0);
    assert_eq!(back[4], [256.0, 0.0, 128.0], "the greatest rounds up into the next exponent");
}

#[test]
fn an_hdr_folder_holds_every_face() {
    let irradiance = chain(4, 1, false).levels.remove(0);
    let made = level_folder(&chain(8, 2, false), Some(irradiance), Container::Hdr, Pixel::Rgbe);
    assert_eq!(made.len(), 18);
    assert!(made.contains_key("m1_nz.hdr") && made.contains_key("irradiance_py.hdr"));
}

#[test]
fn environments_are_written_by_extension_and_cubes_as_a_cross() {
    let folder = tempfile::tempdir().unwrap();
    let panorama = Environment::new(Layout::Panorama { width: 8, height: 4 }, texels(32, 2)).unwrap();
    let path = folder.path().join("panorama.exr");
    write_environment(&path, Existing::Keep, &panorama, "a comment").unwrap();
    let expected: Vec<Rgb> = panorama.texels().iter().map(|t| to_half(*t)).collect();
    assert_eq!(first_difference(&read_exr_rgb(&fs::read(&path).unwrap()), &expected), None);

    let size = 3;
    let cube = Environment::new(Layout::Cube { size }, texels(54, 4)).unwrap();
    let path = folder.path().join("cross.exr");
    write_environment(&path, Existing::Keep, &cube, "").unwrap();
    let cross = read_exr_rgb(&fs::read(&path).unwrap());
    assert_eq!(cross.len(), 12 * 9);
    for face in Face::ALL {
        let (column, row) = CROSS_CELLS[face.index()];
        for j in 0..size {
            for i in 0..size {
                let at = ((row * size + j) * 4 * size + column * size + i) as usize;
                let texel = cube.texels()[(face.index() as u32 * size * size + j * size + i) as usize];
                assert_eq!(cross[at], to_half(texel));
            }
        }
    }
    assert!(write_environment(&folder.path().join("x.png"), Existing::Keep, &cube, "").is_err());
    write_environment(&folder.path().join("x.hdr"), Existing::Keep, &cube, "").unwrap();
    assert_eq!(names_in(folder.path()), ["cross.exr", "panorama.exr", "x.hdr"]);
}

#[test]
fn a_bright_environment_is_written_as_float() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sun.exr");
    let sun = Environment::new(Layout::Panorama { width: 2, height: 1 }, vec![[1e6, 3.3, 0.1]; 2]).unwrap();
    write_environment(&path, Existing::Keep, &sun, "").unwrap();
    assert_eq!(first_difference(&read_exr_rgb(&fs::read(&path).unwrap()), sun.texels()), None);
}

#[test]
fn a_png_comes_back_as_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    let picture = Bitmap::from_fn(7, 5, |x, y| [x as u8 * 30, y as u8 * 50, 255]);
    write_png(&path, Existing::Keep, &picture).unwrap();
    assert_eq!(image::open(&path).unwrap().to_rgb8().as_raw()[..], *picture.bytes());
}

#[test]
fn another_decoder_reads_hdr_scanlines_of_every_length_and_run_as_ours() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.hdr");
    for (columns, seed) in [2, 6, 8, 10, 126, 128, 130, 256, 402].into_iter().zip(1_u64..) {
        let mut state = seed;
        let mut below = |most: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % most
        };
        let count = columns * columns / 2;
        let mut texels: Vec<Rgb> = Vec::new();
        while texels.len() < count {
            let texel = [0; 3].map(|_: u8| below(256) as f32 * 2.0_f32.powi(below(9) as i32 - 4));
            let run = if below(2) == 0 { 1 } else { below(400) as usize };
            texels.extend(std::iter::repeat_n(texel, run.min(count - texels.len())));
        }
        let bytes = hdr_bytes(columns as u32, columns as u32 / 2, &texels, &[]).unwrap();
        fs::write(&path, &bytes).unwrap();
        let ours = Environment::read(&path).unwrap();
        let theirs = image::load_from_memory(&bytes).unwrap().into_rgb32f();
        assert_eq!(ours.texels().as_flattened(), &theirs.as_raw()[..], "{columns} columns");
        for (texel, read) in texels.iter().zip(ours.texels()) {
            let most = texel.iter().copied().fold(0.0, f32::max);
            assert!((0..3).all(|c| (texel[c] - read[c]).abs() <= most / 255.0), "{texel:?} is {read:?}");
        }
    }
}
