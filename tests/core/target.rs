//! Targets: the labelled environment through each of them, looked up as the engine does, and the settings
//! that they expand to.

use crate::io::containers::{colours, parse_dds, parse_ktx1, texel_length};
use glam::DVec3;
use octagloss_core::analysis::oracle::Oracle;
use octagloss_core::bake::{Bake, BakeSettings, bake, bake_all, unwatched};
use octagloss_core::files::export::files::{Made, files};
use octagloss_core::files::format::Pixel;
use octagloss_core::files::format::container::Container;
use octagloss_core::files::io::{ReadOptions, read_from_memory};
use octagloss_core::files::target::{
    Content, Diffuse, Flip, TARGETS, Target, TargetPlan, flipped_texels, is_target_file,
};
use octagloss_core::light::chain::ChainKind;
use octagloss_core::light::environment::{Map, Rgb};
use octagloss_core::light::sh::scale::{ShScale, filament_irradiance, scaled};
use octagloss_core::light::synth::synth;
use octagloss_core::lobe::Lobe;
use octagloss_core::sphere::cube::{Face, direction_from_texel};
use octagloss_core::sphere::octahedral;
use octagloss_fixtures::common::{Random, sweep};
use octagloss_fixtures::files::oem_file::read_ktx2;
use octagloss_fixtures::files::written::rgb_from_rgbp;
use octagloss_shaders::reader;
use std::ops::ControlFlow;

/// Parses KTX2 levels by the `ktx2` crate and zstd.
fn parse_ktx2(bytes: &[u8], pixel: Pixel) -> Vec<Vec<Rgb>> {
    let reader = ktx2::Reader::new(bytes).unwrap();
    let header = reader.header();
    assert_eq!(header.face_count, 6);
    let vk_format = match pixel {
        Pixel::F16 => 97,
        Pixel::F32 => 109,
        Pixel::Rgb9e5 => 123,
        Pixel::R11g11b10 => 122,
        Pixel::Bc6h => 143,
        Pixel::Rgbd | Pixel::Rgbp | Pixel::Rgbe | Pixel::Auto => panic!("not in KTX2"),
    };
    assert_eq!(header.format.map(|format| format.value()), Some(vk_format));
    let level = |(index, level): (usize, ktx2::Level<'_>)| {
        let size = (header.pixel_width >> index).max(1);
        let length = level.uncompressed_byte_length as usize;
        let data = zstd::bulk::decompress(level.data, length).unwrap();
        let face = match pixel {
            Pixel::Bc6h => (size.div_ceil(4) * size.div_ceil(4) * 16) as usize,
            _ => (size * size) as usize * texel_length(pixel),
        };
        assert_eq!(length, 6 * face);
        data.chunks_exact(face).flat_map(|face| colours(pixel, size, face)).collect()
    };
    reader.levels().enumerate().map(level).collect()
}

fn levels(container: Container, pixel: Pixel, bytes: &[u8]) -> Vec<Vec<Rgb>> {
    match container {
        Container::Ktx2 => parse_ktx2(bytes, pixel),
        Container::Ktx1 => parse_ktx1(bytes, pixel).unwrap().levels,
        Container::Dds => parse_dds(bytes, pixel).unwrap().levels,
        Container::Exr | Container::Hdr => panic!("read elsewhere"),
    }
}

/// Reads a face as a PNG in RGBD, rows upwards.
fn png_face(bytes: &[u8]) -> Vec<Rgb> {
    let image = image::load_from_memory(bytes).unwrap().into_rgba8();
    assert_eq!(image.width(), image.height());
    let texels = colours(Pixel::Rgbd, image.width(), image.as_raw());
    texels.chunks(image.width() as usize).rev().flatten().copied().collect()
}

/// Parses the levels of an `.env` as Babylon.js does in `GetEnvInfo` and
/// `CreateRadianceImageDataArrayBufferViews`.
fn parse_env(bytes: &[u8]) -> (Vec<Vec<Rgb>>, serde_json::Value) {
    assert_eq!(bytes[..8], [0x86, 0x16, 0x87, 0x96, 0xf6, 0xd6, 0x96, 0x36]);
    let end = 8 + bytes[8..].iter().position(|byte| *byte == 0).unwrap();
    let manifest: serde_json::Value = serde_json::from_slice(&bytes[8..end]).unwrap();
    let mipmaps = manifest["specular"]["mipmaps"].as_array().unwrap();
    let width = manifest["width"].as_u64().unwrap();
    assert_eq!(mipmaps.len() as u32, 6 * (width.ilog2() + 1));
    let face = |place: &serde_json::Value| {
        let at = |key: &str| place[key].as_u64().unwrap() as usize;
        png_face(&bytes[end + 1 + at("position")..][..at("length")])
    };
    (mipmaps.chunks(6).map(|faces| faces.iter().flat_map(face).collect()).collect(), manifest)
}

/// Parses the levels of a light of EXT_lights_image_based in a binary glTF.
fn parse_glb(bytes: &[u8]) -> (Vec<Vec<Rgb>>, serde_json::Value) {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let binary_at = 20 + word(12);
    assert_eq!((&bytes[16..20], &bytes[binary_at + 4..binary_at + 8]), (&b"JSON"[..], &b"BIN\0"[..]));
    assert!(binary_at.is_multiple_of(4) && binary_at + 8 + word(binary_at) == bytes.len());
    let root: serde_json::Value = serde_json::from_slice(&bytes[20..binary_at]).unwrap();
    let light = &root["extensions"]["EXT_lights_image_based"]["lights"][0];
    let face = |image: &serde_json::Value| {
        let image = &root["images"][image.as_u64().unwrap() as usize];
        assert_eq!(image["mimeType"], "image/png");
        let view = &root["bufferViews"][image["bufferView"].as_u64().unwrap() as usize];
        let at = |key: &str| view[key].as_u64().unwrap() as usize;
        png_face(&bytes[binary_at + 8 + at("byteOffset")..][..at("byteLength")])
    };
    let levels = light["specularImages"].as_array().unwrap();
    let level = |faces: &serde_json::Value| faces.as_array().unwrap().iter().flat_map(face).collect();
    (levels.iter().map(level).collect(), root.clone())
}

/// The file with `content` among those `made` for `plan`.
fn file_with<'a>(plan: &TargetPlan, made: &'a [Made], content: Content) -> Option<&'a Made> {
    let planned = plan.files("any", 1, &[]);
    assert_eq!(planned.len(), made.len(), "one for one");
    planned.iter().zip(made).find(|((_, planned), _)| *planned == content).map(|(_, file)| file)
}

/// Reads the levels of a target's cube from its file of any format.
fn stored_levels(plan: &TargetPlan, made: &[Made]) -> Vec<Vec<Rgb>> {
    let file = |content| file_with(plan, made, content);
    match (file(Content::Specular), file(Content::Env), file(Content::Glb)) {
        (Some(file), ..) => levels(plan.container, plan.pixel, &file.bytes),
        (_, Some(file), _) => parse_env(&file.bytes).0,
        (.., Some(file)) => parse_glb(&file.bytes).0,
        _ => panic!("{} has no cube", plan.target.name),
    }
}

/// Reads the levels of an octahedral map without their borders.
fn octahedral_levels(made: &[Made]) -> Vec<Vec<Rgb>> {
    let (levels, _) = read_ktx2(&made.iter().find(|file| file.path.ends_with(".ktx2")).unwrap().bytes);
    let count = levels.len();
    let inside = |(index, (side, texels)): (usize, &(u32, Vec<[half::f16; 4]>))| {
        let border = 1_usize << (count - 1 - index);
        let rows = texels.chunks(*side as usize).skip(border).take(*side as usize - 2 * border);
        let inside = |row: &[[half::f16; 4]]| row[border..row.len() - border].to_vec();
        rows.flat_map(inside).map(|[r, g, b, _]| [r, g, b].map(|c| c.to_f32())).collect()
    };
    levels.iter().enumerate().map(inside).collect()
}

/// Nearest-texel look-up of the hardware (OpenGL 4.6, table 8.19), implemented independently.
fn look_up(level: &[Rgb], direction: DVec3) -> Rgb {
    let d = direction;
    let (x, y, z) = (d.x.abs(), d.y.abs(), d.z.abs());
    let (face, sc, tc, ma) = if x >= y && x >= z {
        if d.x > 0.0 { (0, -d.z, -d.y, x) } else { (1, d.z, -d.y, x) }
    } else if y >= z {
        if d.y > 0.0 { (2, d.x, d.z, y) } else { (3, d.x, -d.z, y) }
    } else if d.z > 0.0 {
        (4, d.x, -d.y, z)
    } else {
        (5, -d.x, -d.y, z)
    };
    let n = ((level.len() / 6) as f64).sqrt() as usize;
    let texel = |c: f64| (((c / ma + 1.0) / 2.0 * n as f64) as usize).min(n - 1);
    level[(face * n + texel(tc)) * n + texel(sc)]
}

/// Transforms a world direction as each engine's shaders do before a cube look-up.
fn engine_direction(target: &str, d: DVec3) -> DVec3 {
    match target {
        // Left-handed engines, which import glTF with x negated.
        "three" | "babylon" | "gltf-ext" | "unity" => DVec3::new(-d.x, d.y, d.z),
        "bevy" => DVec3::new(d.x, d.y, -d.z),
        _ => d,
    }
}

fn small(target: &'static Target) -> (TargetPlan, BakeSettings) {
    let plan = TargetPlan::new(target);
    let settings = BakeSettings {
        map: target.map,
        size: 64,
        levels: Some(target.levels(64)),
        ladder: target.ladder,
        irradiance: matches!(plan.diffuse, Diffuse::Cube | Diffuse::Both).then_some(8),
        sheen: target.has_sheen(),
        ..BakeSettings::default()
    };
    (plan, settings)
}

/// Counts texels of the labelled world that the engine looks up at the wrong place.
fn misplaced(target: &'static Target, level: &[Rgb], exact: &[Rgb]) -> usize {
    let mut wrong = 0;
    let mut seen = 0;
    let n = 64;
    for face in Face::ALL {
        for k in 0..n * n {
            let direction = direction_from_texel(face, n, k % n, k / n);
            let shown = look_up(level, engine_direction(target.name, direction));
            let there = exact[face.index() * (n * n) as usize + k as usize];
            // RGB9E5 and R11G11B10F round by up to 1/64 of the brightest channel, RGBD's dark codes by 1/40.
            let most = there.iter().copied().fold(0.0, f32::max);
            let share = if target.pixel == Pixel::Rgbd { 40.0 } else { 60.0 };
            wrong += usize::from((0..3).any(|c| (shown[c] - there[c]).abs() > most / share));
            seen += 1;
        }
    }
    assert_eq!(seen, 6 * 64 * 64);
    wrong
}

fn specular_level0(target: &'static Target, plan: &TargetPlan, bake: &Bake) -> Vec<Rgb> {
    let made = files(plan, "labelled", bake, &[], reader).unwrap();
    let levels = stored_levels(plan, &made);
    assert_eq!(levels.len() as u32, target.levels(64), "{}", target.name);
    levels.into_iter().next().unwrap()
}

#[test]
fn every_letter_is_upright_on_its_side_of_every_engines_world() {
    let labelled = synth("labelled").unwrap();
    for target in TARGETS.iter().filter(|target| target.map == Map::Cube && !target.has_atlas()) {
        let (plan, settings) = small(target);
        let bake = bake(&labelled, &settings).unwrap();
        let exact = &bake.chain.levels[0].texels;
        let level = specular_level0(target, &plan, &bake);
        assert_eq!(misplaced(target, &level, exact), 0, "{}", target.name);
        // The check detects every other flip.
        for flip in [Flip::None, Flip::X, Flip::Z].into_iter().filter(|flip| *flip != plan.flip) {
            let wrong = TargetPlan { flip, ..plan.clone() };
            let level = specular_level0(target, &wrong, &bake);
            assert!(misplaced(target, &level, exact) > 1000, "{} by {flip:?}", target.name);
        }
    }
}

/// Returns where each engine looks up a world direction in a square or a panorama, from (0, 0) top left to
/// (1, 1): by its own code, for glTF's axes as its importer turns them.
fn engine_place(target: &str, d: DVec3) -> (f64, f64) {
    let turns = |y: f64, x: f64| y.atan2(x) / std::f64::consts::TAU;
    let elevation = d.y.acos() / std::f64::consts::PI;
    match target {
        "oem" => {
            let p = d / (d.x.abs() + d.y.abs() + d.z.abs());
            let s = |t: f64| if t >= 0.0 { 1.0 } else { -1.0 };
            let folded = ((1.0 - p.z.abs()) * s(p.x), (1.0 - p.x.abs()) * s(p.z));
            let (u, v) = if p.y >= 0.0 { (p.x, p.z) } else { folded };
            ((u + 1.0) / 2.0, (v + 1.0) / 2.0)
        }
        // atan(x, -z), from 0 on.
        "godot" => (turns(d.x, -d.z).rem_euclid(1.0), elevation),
        // X = x, Y = z, Z = y; the cube's side (X, Y, Z) is looked up as (X, Z, Y): u = (1 + atan2(X,
        // -Z')/pi)/2.
        "unreal" => {
            let world = DVec3::new(d.x, d.z, d.y);
            let side = DVec3::new(world.x, world.z, world.y);
            (0.5 + turns(side.x, -side.z), elevation)
        }
        // X = x, Y = -z, Z = y: u = 1/2 - atan2(Y, X)/2 pi.
        "blender" => (0.5 - turns(-d.z, d.x), elevation),
        other => panic!("{other} has a cube"),
    }
}

/// Looks up `atlas` along `d` as PlayCanvas does (`mapUv`, `toSphericalUv`), in the rectangle at (x, y) of
/// width w, in texels of an atlas of 512.
fn atlas_look_up(atlas: &[Rgb], (x, y, w): (f64, f64, f64), d: DVec3) -> [f64; 3] {
    let d = DVec3::new(-d.x, d.y, d.z);
    let turns = std::f64::consts::TAU;
    let (u, v) = (d.x.atan2(d.z) / turns + 0.5, 0.5 - d.y.asin() / (turns / 2.0));
    let seam = 1.0;
    let edge = (atlas.len() as f64).sqrt();
    let place = |low: f64, high: f64, t: f64| (low + t * (high - low)) * edge / 512.0 - 0.5;
    let (i, j) = (place(x + seam, x + w - seam, u), place(y + seam, y + w / 2.0 - seam, v));
    let (a, b) = (i - i.floor(), j - j.floor());
    let texel = |di: f64, dj: f64| atlas[((j.floor() + dj) * edge + i.floor() + di) as usize];
    std::array::from_fn(|c| {
        let at = |di, dj| f64::from(texel(di, dj)[c]);
        (at(0.0, 0.0) * (1.0 - a) + at(1.0, 0.0) * a) * (1.0 - b)
            + (at(0.0, 1.0) * (1.0 - a) + at(1.0, 1.0) * a) * b
    })
}

#[test]
fn playcanvas_looks_up_every_level_and_the_irradiance_in_the_atlas() {
    let labelled = synth("labelled").unwrap();
    let oracle = Oracle::new(&labelled);
    let target = Target::named("playcanvas").unwrap();
    let (plan, settings) = small(target);
    let settings = BakeSettings { size: 256, irradiance: Some(32), ..settings };
    let bake = bake(&labelled, &settings).unwrap();
    let atlas_of = |plan: &TargetPlan| -> Vec<Rgb> {
        let made = files(plan, "labelled", &bake, &[], reader).unwrap();
        let [file] = &made[..] else { panic!("one file") };
        assert_eq!(file.path, "labelled_envatlas.png");
        let image = image::load_from_memory(&file.bytes).unwrap().into_rgba8();
        assert_eq!(image.dimensions(), (512, 512));
        image.pixels().map(|pixel| rgb_from_rgbp(pixel.0)).collect()
    };
    let directions: Vec<DVec3> = (0..60)
        .map(|k| {
            let (z, phi) = (1.0 - (2.0 * f64::from(k) + 1.0) / 60.0, f64::from(k) * 2.4);
            DVec3::new((1.0 - z * z).sqrt() * phi.cos(), z, (1.0 - z * z).sqrt() * phi.sin())
        })
        .collect();
    let error = |atlas: &[Rgb], rect: (f64, f64, f64), lobe: Lobe, roughness: f64| {
        let (mut sum, mut power) = (0.0, 0.0);
        for d in &directions {
            let (shown, exact) =
                (atlas_look_up(atlas, rect, *d), oracle.reflect(lobe, roughness, *d).expect("valid"));
            for c in 0..3 {
                sum += (shown[c] - exact[c]).powi(2);
                power += exact[c].powi(2);
            }
        }
        (sum / power).sqrt()
    };
    let mut atlases =
        [Flip::None, Flip::X, Flip::Z].map(|flip| (flip, atlas_of(&TargetPlan { flip, ..plan.clone() })));
    atlases.sort_by_key(|(flip, _)| *flip != Flip::X);
    for (flip, atlas) in &atlases {
        let rough = |level: u32| {
            let width = f64::from(512 >> level);
            ((0.0, 512.0 - width, width), Lobe::Ggx, f64::from(level) / 5.0)
        };
        let ambient = ((128.0, 384.0, 64.0), Lobe::Cosine, 0.0);
        for (rect, lobe, roughness) in (1..6).map(rough).chain([ambient]) {
            let error = error(atlas, rect, lobe, roughness);
            println!("{flip:?} {lobe:?} {roughness}: {error:.4}");
            if *flip == Flip::X {
                assert!(error < 0.03, "{lobe:?} {roughness}: {error}");
            } else {
                assert!(error > 0.09, "{flip:?} is not seen by {lobe:?} {roughness}: {error}");
            }
        }
    }
    // The mirror's chain of mipmaps: every level has the mean of the sharpest.
    let atlas = &atlases[0].1;
    let mean = |level: u32| -> [f64; 3] {
        let width = f64::from(512 >> level);
        let rect = (512.0 - width, 512.0 - width, width);
        let sum = |c: usize| directions.iter().map(|d| atlas_look_up(atlas, rect, *d)[c]).sum::<f64>();
        std::array::from_fn(|c| sum(c) / 60.0)
    };
    for level in 1..6 {
        for (own, sharp) in mean(level).iter().zip(mean(0)) {
            assert!((own / sharp - 1.0).abs() < 0.1, "mipmap {level}: {own} of {sharp}");
        }
    }
}

/// Returns `bytes` with the key `from` renamed to `to`, of the same length.
fn renamed(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    while let Some(at) = bytes.windows(from.len()).position(|window| window == from) {
        bytes[at..at + to.len()].copy_from_slice(to);
    }
    bytes
}

#[test]
fn every_letter_is_upright_in_every_square_and_panorama() {
    let labelled = synth("labelled").unwrap();
    let cube = bake(&labelled, &BakeSettings { size: 64, levels: Some(1), ..Default::default() }).unwrap();
    let exact = &cube.chain.levels[0].texels;
    for target in TARGETS.iter().filter(|target| target.map != Map::Cube && !target.has_pyramid()) {
        let (plan, mut settings) = small(target);
        settings.size = 128;
        let bake = bake(&labelled, &settings).unwrap();
        let made = files(&plan, "labelled", &bake, &[], reader).unwrap();
        let (width, height, texels) = if target.name == "oem" {
            (128, 128, octahedral_levels(&made).swap_remove(0))
        } else {
            let [file] = &made[..] else { panic!("one file") };
            // Engines ignore the key by which this program turns the panorama back.
            let bytes = renamed(&file.bytes, b"quarter_turns", b"quarter_xurns");
            let loaded = read_from_memory(file.path.as_ref(), &bytes, &ReadOptions::default()).unwrap();
            (256, 128, loaded.environment.texels().to_vec())
        };
        let misplaced = |turned: fn(DVec3) -> DVec3| {
            let directions = (0..6 * 64 * 64)
                .map(|k| (k, direction_from_texel(Face::ALL[(k / 4096) as usize], 64, k % 64, k / 64 % 64)));
            let wrong = directions.filter(|(k, direction)| {
                let (u, v) = engine_place(target.name, turned(*direction));
                let texel = |c: f64, side: usize| ((c * side as f64) as usize).min(side - 1);
                let shown = texels[texel(v, height) * width + texel(u, width)];
                let there = exact[*k as usize];
                let most = there.iter().copied().fold(0.0, f32::max);
                (0..3).any(|c| (shown[c] - there[c]).abs() > 0.1 * most)
            });
            wrong.count() as f64 / (6.0 * 64.0 * 64.0)
        };
        // Texels on an edge of a letter or of a check differ from map to map.
        let share = misplaced(|d| d);
        println!("{}: {share:.4} of the texels differ", target.name);
        assert!(share < 0.25, "{}: {share}", target.name);
        let turns: [fn(DVec3) -> DVec3; 3] =
            [|d| DVec3::new(-d.x, d.y, d.z), |d| DVec3::new(d.x, d.y, -d.z), |d| DVec3::new(-d.z, d.y, d.x)];
        for turned in turns {
            assert!(misplaced(turned) > 2.0 * share, "{}: {}", target.name, misplaced(turned));
        }
    }
}

#[test]
fn babylons_and_gltfs_headers_hold_what_their_readers_need() {
    let studio = synth("studio").unwrap();
    let made = |name: &str| {
        let (plan, settings) = small(Target::named(name).unwrap());
        let bake = bake(&studio, &settings).unwrap();
        (files(&plan, "studio", &bake, &[], reader).unwrap().swap_remove(0), bake)
    };
    let (env, bake) = made("babylon");
    assert_eq!(env.path, "studio_ibl.env");
    let (levels, manifest) = parse_env(&env.bytes);
    assert_eq!((levels.len(), manifest["width"].as_u64()), (7, Some(64)));
    assert_eq!(manifest["specular"]["lodGenerationScale"], 0.8);
    for (level, expected) in bake.chain.levels.iter().enumerate().skip(1) {
        // getLodFromAlphaG of pbrIBLFunctions.fx: log2(width alpha) 0.8, until alpha is 1.
        let lod = (64.0 * expected.roughness.powi(2)).log2() * 0.8;
        assert!((lod - (level as f64).min(4.8)).abs() < 1e-12, "level {level}: {lod}");
    }
    let (glb, bake) = made("gltf-ext");
    let (levels, root) = parse_glb(&glb.bytes);
    assert_eq!((glb.path.as_str(), levels.len()), ("studio_ibl.glb", 3));
    assert_eq!(root["extensionsUsed"], serde_json::json!(["EXT_lights_image_based"]));
    assert_eq!(root["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"], 0);
    let light = &root["extensions"]["EXT_lights_image_based"]["lights"][0];
    assert_eq!(light["specularImageSize"], 64);
    let coefficients: Vec<[f64; 3]> =
        serde_json::from_value(light["irradianceCoefficients"].clone()).unwrap();
    for (read, exact) in
        coefficients.as_flattened().iter().zip(scaled(&bake.sh, ShScale::Irradiance).as_flattened())
    {
        assert!((read - exact).abs() < 1e-12, "{read} for {exact}");
    }
}

#[test]
fn irradiance_cubes_and_spherical_harmonics_agree_in_the_engines_world() {
    let sky = synth("labelled").unwrap();
    let bevy = Target::named("bevy").unwrap();
    let (plan, settings) = small(bevy);
    let bake = bake(&sky, &settings).unwrap();
    let made = files(&plan, "sky", &bake, &[], reader).unwrap();
    let diffuse = file_with(&plan, &made, Content::Irradiance).unwrap();
    let level = &levels(plan.container, plan.pixel, &diffuse.bytes)[0];
    let sh = scaled(&bake.sh, ShScale::Filament);
    for direction in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
        // A texel of 8 next to an axis is off by 7 degrees, and nine coefficients leave an error of a tenth.
        let direction = (direction + DVec3::splat(0.1)).normalize();
        let cube = look_up(level, engine_direction("bevy", direction));
        let polynomial = filament_irradiance(&sh, direction);
        for c in 0..3 {
            let (cube, polynomial) = (f64::from(cube[c]), polynomial[c]);
            assert!((cube / polynomial - 1.0).abs() < 0.15, "{direction}: {cube} against {polynomial}");
        }
    }
}

#[test]
fn filaments_key_holds_what_its_parser_reads() {
    let target = Target::named("filament").unwrap();
    let (plan, settings) = small(target);
    let bake = bake(&synth("studio").unwrap(), &settings).unwrap();
    let made = files(&plan, "studio", &bake, &[], reader).unwrap();
    let paths: Vec<&str> = made.iter().map(|file| file.path.as_str()).collect();
    assert_eq!(paths, ["studio_ibl.ktx", "studio_skybox.ktx", "sh.txt"]);
    let ibl = parse_ktx1(&made[0].bytes, Pixel::R11g11b10).unwrap();
    let (key, value) = &ibl.pairs[0];
    let numbers: Vec<f64> = value.split_whitespace().map(|word| word.parse().unwrap()).collect();
    assert_eq!((key.as_str(), numbers.len(), value.lines().count()), ("sh", 27, 9));
    let expected = scaled(&bake.sh, ShScale::Filament);
    assert_eq!(numbers, expected.as_flattened(), "every digit must match");
    assert_eq!(parse_ktx1(&made[1].bytes, Pixel::R11g11b10).unwrap().levels.len(), 1);
    let text = String::from_utf8(made[2].bytes.clone()).unwrap();
    assert_eq!(text.lines().count(), 9);
    let first = format!("{:.15}", expected[0][0]);
    assert!(text.lines().next().unwrap().contains(&first), "{text}");
}

#[test]
fn overrides_replace_what_the_preset_says() {
    let (mut plan, mut settings) = small(Target::named("three").unwrap());
    settings.irradiance = Some(8);
    let bake = bake(&synth("labelled").unwrap(), &settings).unwrap();
    plan.diffuse = Diffuse::Both;
    for (container, pixel) in [
        (Container::Dds, Pixel::Bc6h),
        (Container::Ktx2, Pixel::Bc6h),
        (Container::Ktx1, Pixel::F32),
        (Container::Ktx2, Pixel::R11g11b10),
    ] {
        (plan.container, plan.pixel) = (container, pixel);
        let made = files(&plan, "a", &bake, &[], reader).unwrap();
        let extension = container.name();
        let paths: Vec<&str> = made.iter().map(|file| file.path.as_str()).collect();
        assert_eq!(
            paths,
            [format!("a_pmrem.{extension}"), format!("a_irradiance.{extension}"), "a_sh.json".into()]
        );
        assert_eq!(levels(container, pixel, &made[0].bytes).len(), 4);
        for path in paths {
            assert!(is_target_file(path), "{path}");
        }
    }
    assert!(!is_target_file("notes.txt") && !is_target_file("holiday.ktx2") && !is_target_file("_ibl.ktx"));
    (plan.container, plan.pixel) = (Container::Ktx1, Pixel::Bc6h);
    assert!(files(&plan, "a", &bake, &[], reader).is_err());
}

#[test]
fn the_sheen_cube_holds_the_charlie_lobe() {
    let studio = synth("studio").unwrap();
    let (plan, settings) = small(Target::named("khronos").unwrap());
    let baked = bake(&studio, &settings).unwrap();
    let made =
        files(&plan, "a", &baked, &[("octaglossRecipe".to_owned(), r#"{"lobe":"ggx"}"#.to_owned())], reader)
            .unwrap();
    let paths: Vec<&str> = made.iter().map(|file| file.path.as_str()).collect();
    assert_eq!(paths, ["ggx/specular.ktx2", "charlie/sheen.ktx2", "lambertian/diffuse.ktx2"]);
    for (file, lobe) in made.iter().zip(["ggx", "charlie", "cosine"]) {
        let reader = ktx2::Reader::new(&file.bytes).unwrap();
        let (_, value) = reader.key_value_data().find(|(key, _)| *key == "octaglossRecipe").unwrap();
        let record: serde_json::Value = serde_json::from_slice(&value[..value.len() - 1]).unwrap();
        assert_eq!(record["lobe"], lobe, "{}", file.path);
    }
    let stored = levels(plan.container, plan.pixel, &made[1].bytes);
    let sheen = baked.sheen.as_ref().unwrap();
    assert_eq!((stored.len(), sheen.levels.len(), baked.sheen_stats.len()), (6, 6, 6));
    let oracle = Oracle::new(&studio);
    let mut random = Random::new(6);
    let (mut error, mut power) = (0.0, 0.0);
    for (level, stored) in sheen.levels.iter().zip(stored).take(4) {
        for _ in 0..sweep(15, 40) {
            let at = random.below(level.texels.len() as u32) as usize;
            let area = (level.size() * level.size()) as usize;
            let place = (at % area) as u32;
            let direction = direction_from_texel(
                Face::ALL[at / area],
                level.size(),
                place % level.size(),
                place / level.size(),
            );
            let exact = oracle.reflect(Lobe::Charlie, level.roughness, direction).expect("valid")[1];
            error += (f64::from(stored[at][1]) - exact).powi(2);
            power += exact * exact;
        }
    }
    let error = (error / power).sqrt();
    assert!(error < 0.01, "relRMSE {error}");
    let other = bake(&studio, &BakeSettings { lobe: Lobe::Charlie, sheen: false, ..settings }).unwrap();
    if other.oem == baked.oem {
        assert_eq!(other.chain, *sheen);
    }
    assert!(files(&plan, "a", &other, &[], reader).is_err(), "levels that were not baked must be refused");
}

#[test]
fn several_targets_share_their_levels_and_cost_them_once() {
    let studio = synth("studio").unwrap();
    let settings = ["generic", "bevy", "khronos"].map(|name| {
        let (_, settings) = small(Target::named(name).unwrap());
        BakeSettings { chain: Some(ChainKind::Sampled), ..settings }
    });
    let total = std::sync::Mutex::new(0);
    let bakes = bake_all(&studio, &settings, &|progress| {
        *total.lock().unwrap() = progress.total;
        ControlFlow::Continue(())
    })
    .unwrap();
    // generic and bevy have the same five levels; khronos has six of different roughness except the first,
    // and six of sheen.
    let texels = |sizes: &[u64]| sizes.iter().map(|n| 6 * n * n).sum::<u64>();
    assert_eq!(
        *total.lock().unwrap(),
        texels(&[64, 32, 16, 8, 4])
            + texels(&[32, 16, 8, 4, 2])
            + texels(&[64, 32, 16, 8, 4, 2])
            + texels(&[8])
    );
    assert_eq!(bakes[0].chain, bakes[1].chain);
    for (together, settings) in bakes.iter().zip(&settings) {
        let alone = bake(&studio, settings).unwrap();
        assert_eq!(together.chain.levels.len(), alone.chain.levels.len());
        if together.oem == alone.oem {
            assert_eq!(together.irradiance, alone.irradiance);
        }
    }
    assert!(bake_all(&studio, &[], &unwatched).is_err());
}

/// A level as baked and as stored, and the directions of its texels.
struct Stored<'a> {
    roughness: f64,
    baked: &'a [Rgb],
    stored: Vec<Rgb>,
    direction: Box<dyn Fn(u32) -> DVec3>,
}

/// Pairs the levels of a target with those read back from its file.
fn beside<'a>(plan: &TargetPlan, bake: &'a Bake) -> Vec<Stored<'a>> {
    let made = files(plan, "a", bake, &[], reader).unwrap();
    if plan.target.map == Map::Octahedral {
        let levels = bake.chain.levels.iter().zip(octahedral_levels(&made));
        let beside = |(level, stored): (&'a octagloss_core::light::chain::Level, Vec<Rgb>)| {
            let n = level.layout.sides().0;
            let direction =
                move |at: u32| octahedral::direction_from_oct(octahedral::texel_centre(n, at % n, at / n));
            let (roughness, baked) = (level.roughness, &level.texels[..]);
            Stored { roughness, baked, stored, direction: Box::new(direction) }
        };
        return levels.map(beside).collect();
    }
    let levels = bake.chain.levels.iter().zip(stored_levels(plan, &made));
    let beside = |(level, stored): (&'a octagloss_core::light::chain::Level, Vec<Rgb>)| {
        let n = level.size();
        let stored = flipped_texels(&stored, n, plan.flip);
        let direction =
            move |at: u32| direction_from_texel(Face::ALL[(at / (n * n)) as usize], n, at % n, at / n % n);
        let (roughness, baked) = (level.roughness, &level.texels[..]);
        Stored { roughness, baked, stored, direction: Box::new(direction) }
    };
    levels.map(beside).collect()
}

/// Returns relative RMS errors of luminance against exhaustive integration over the source, for the levels as
/// baked and as stored: levels of roughness 0.15 to 0.9, at random texels.
fn errors(plan: &TargetPlan, bake: &Bake, oracle: &Oracle<'_>) -> [f64; 2] {
    let mut random = Random::new(5);
    let (mut sums, mut power, mut count) = ([0.0; 2], 0.0, 0);
    for level in beside(plan, bake) {
        if !(0.15..0.9).contains(&level.roughness) {
            continue;
        }
        for _ in 0..60 {
            let at = random.below(level.baked.len() as u32);
            let exact = oracle.reflect(Lobe::Ggx, level.roughness, (level.direction)(at)).expect("valid");
            let luminance = |rgb: [f64; 3]| 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
            power += luminance(exact).powi(2);
            let texels = [level.baked[at as usize], level.stored[at as usize]];
            for (sum, texel) in sums.iter_mut().zip(texels) {
                *sum += (luminance(texel.map(f64::from)) - luminance(exact)).powi(2);
            }
            count += 1;
        }
    }
    assert!(count >= 120, "{count} texels to compare");
    sums.map(|sum| (sum / power).sqrt())
}

#[test]
fn encodings_add_to_the_error_what_the_readme_says() {
    for (name, most_baked) in [("studio", 0.01), ("sky", 0.01)].into_iter().take(sweep(1, 2)) {
        let environment = synth(name).unwrap();
        let oracle = Oracle::new(&environment);
        let with_levels = TARGETS
            .iter()
            .filter(|target| target.map != Map::Panorama && !target.has_atlas() && !target.has_pyramid());
        let mut plans: Vec<TargetPlan> = with_levels.map(TargetPlan::new).collect();
        plans.push(TargetPlan {
            pixel: Pixel::Bc6h,
            container: Container::Dds,
            ..TargetPlan::new(&TARGETS[1])
        });
        let settings: Vec<BakeSettings> = plans
            .iter()
            .map(|plan| BakeSettings {
                map: plan.target.map,
                size: 128,
                levels: Some(plan.target.levels(128)),
                ladder: plan.target.ladder,
                irradiance: matches!(plan.diffuse, Diffuse::Cube | Diffuse::Both).then_some(8),
                sheen: plan.target.has_sheen(),
                chain: Some(ChainKind::Sampled),
                ..BakeSettings::default()
            })
            .collect();
        let bakes = bake_all(&environment, &settings, &unwatched).unwrap();
        for (plan, bake) in plans.iter().zip(&bakes) {
            let [baked, stored] = errors(plan, bake, &oracle);
            println!("{name} | {} {} | {baked:.5} | {stored:.5}", plan.target.name, plan.pixel.name());
            assert!(baked < most_baked, "{name} {}: {baked}", plan.target.name);
            // Half the last place of each format; measured values for blocks and gamma.
            let most_added = match plan.pixel {
                Pixel::F16 | Pixel::F32 => 0.0003,
                Pixel::Rgb9e5 => 0.002,
                Pixel::R11g11b10 => 0.006,
                Pixel::Rgbd => 0.012,
                Pixel::Rgbp | Pixel::Rgbe | Pixel::Auto => panic!("no target uses them"),
                Pixel::Bc6h => 0.02,
            };
            assert!(stored < baked + most_added, "{name} {}: {stored} of {baked}", plan.target.name);
        }
    }
}
