//! KTX2 files and level folders.

use super::{assert_texels, error_of, read};
use exr::prelude::Compression;
use octagloss_core::files::io::{self, ReadOptions};
use octagloss_core::light::environment::Layout;
use octagloss_fixtures::files::inputs::{
    Ktx2Pixel, Rgb, Sample, exr_rgb, ktx2, numbered, radiance_with_runs,
};
use std::fs;
use std::path::{MAIN_SEPARATOR, Path};

const ROUGHNESS: &[(&str, &[u8])] = &[("KTXwriter", b"test\0"), ("octaglossRoughness", b"0,0.25,1\0")];

fn levels() -> Vec<Vec<Rgb>> {
    [8, 4, 2].map(|size| numbered(size, 6 * size)).to_vec()
}

fn read_chain(bytes: &[u8]) -> octagloss_core::common::error::Result<octagloss_core::light::chain::Chain> {
    io::read_chain_from_memory(Path::new("a.ktx2"), bytes, io::DEFAULT_MEMORY_LIMIT)
}

#[test]
fn cubes_of_every_pixel_are_read_whole() {
    for pixel in [Ktx2Pixel::Rgba16F, Ktx2Pixel::Rgba32F, Ktx2Pixel::Rgb9E5] {
        for zstd in [false, true] {
            let bytes = ktx2((8, 8), 6, pixel, zstd, ROUGHNESS, &levels());
            let chain = read_chain(&bytes).unwrap();
            assert_eq!(chain.levels.iter().map(|l| l.size()).collect::<Vec<_>>(), [8, 4, 2], "{pixel:?}");
            assert_eq!(
                chain.levels.iter().map(|l| l.roughness).collect::<Vec<_>>(),
                [0.0, 0.25, 1.0],
                "{pixel:?}"
            );
            for (level, wanted) in chain.levels.iter().zip(levels()) {
                assert_texels(&level.texels, &wanted);
            }
            let loaded = read("a.ktx2", &bytes).unwrap();
            assert_eq!(loaded.environment.layout(), Layout::Cube { size: 8 }, "as an environment");
            assert_texels(loaded.environment.texels(), &levels()[0]);
            assert_eq!((loaded.layout, loaded.width, loaded.height), ("cube", 8, 8), "described");
        }
    }
}

#[test]
fn flat_images_follow_their_orientation() {
    let pixels = numbered(8, 4);
    let file = |pairs: &[(&str, &[u8])]| {
        ktx2((8, 4), 1, Ktx2Pixel::Rgba32F, true, pairs, std::slice::from_ref(&pixels))
    };
    assert_texels(read("a.ktx2", &file(&[])).unwrap().environment.texels(), &pixels);
    let upwards: Vec<Rgb> = pixels.chunks(8).rev().flatten().copied().collect();
    let loaded = read("a.ktx2", &file(&[("KTXorientation", b"ru\0")])).unwrap();
    assert_texels(loaded.environment.texels(), &upwards);
    assert_eq!(
        read_chain(&file(&[])).unwrap_err().to_string(),
        "a.ktx2: it holds a 2D image; a chain is a cube"
    );
}

#[test]
fn chains_without_sound_roughness_are_refused() {
    for (pairs, wanted) in [
        (
            &[][..],
            "a.ktx2: it has no roughness of its levels (key octaglossRoughness); octagloss bake writes it",
        ),
        (
            &[("octaglossRoughness", &b"0,1\0"[..])][..],
            "a.ktx2: octaglossRoughness is not 3 numbers in [0, 1], one a level; bake it again",
        ),
        (
            &[("octaglossRoughness", &b"0,0.5,1.5\0"[..])][..],
            "a.ktx2: octaglossRoughness is not 3 numbers in [0, 1], one a level; bake it again",
        ),
    ] {
        let bytes = ktx2((8, 8), 6, Ktx2Pixel::Rgba16F, true, pairs, &levels());
        assert_eq!(read_chain(&bytes).unwrap_err().to_string(), wanted);
    }
}

#[test]
fn nan_in_a_chain_is_named() {
    let mut levels = levels();
    levels[1][16 + 5][2] = f32::NAN;
    let bytes = ktx2((8, 8), 6, Ktx2Pixel::Rgba32F, false, ROUGHNESS, &levels);
    let text = read_chain(&bytes).unwrap_err().to_string();
    assert_eq!(text, "a.ktx2: level 1 face nx pixel (1, 1) is [2.0, 6.0, NaN]; bake it again");
    let options = ReadOptions::default();
    levels[0][64 + 9][0] = f32::INFINITY;
    let bytes = ktx2((8, 8), 6, Ktx2Pixel::Rgba32F, false, ROUGHNESS, &levels);
    let text = io::read_from_memory(Path::new("a.ktx2"), &bytes, &options).unwrap_err().to_string();
    assert_eq!(text, "a.ktx2 face nx: pixel (1, 1) channel R is inf; `sanitize` repairs NaN and Inf");
}

#[test]
fn damaged_and_foreign_files_are_named() {
    let whole = ktx2((8, 8), 6, Ktx2Pixel::Rgba16F, false, ROUGHNESS, &levels());
    let length = whole.len() - 10;
    assert_eq!(
        error_of(read("a.ktx2", &whole[..length])),
        format!("a.ktx2: truncated: the KTX2 data ends after {length} bytes; copy it again")
    );
    let mut foreign = whole.clone();
    foreign[12] = 37;
    assert_eq!(
        error_of(read("a.ktx2", &foreign)),
        "a.ktx2: its pixels are R8G8B8A8_UNORM; RGBA16F, RGBA32F, RGB9E5, R11G11B10F and BC6H can be read"
    );
    let mut five_faces = whole;
    five_faces[36] = 5;
    assert_eq!(error_of(read("a.ktx2", &five_faces)), "a.ktx2: 5 faces; 1 (2D) and 6 (cube) can be read");
}

/// Returns a folder of two levels in `extension`, as written by `bake`.
fn level_folder(extension: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (level, size) in [(0u32, 4u32), (1, 2)] {
        for (face, name) in ["px", "nx", "py", "ny", "pz", "nz"].iter().enumerate() {
            let pixels: Vec<Rgb> =
                numbered(size, size).iter().map(|[x, y, _]| [*x, *y, face as f32 + 1.0]).collect();
            let bytes = match extension {
                "exr" => exr_rgb((size, size), Sample::Half, Compression::ZIP16, &pixels),
                _ => radiance_with_runs(size, size, &pixels),
            };
            fs::write(folder.path().join(format!("m{level}_{name}.{extension}")), bytes).unwrap();
        }
    }
    let report = r#"{"input": "a.hdr", "levels": [
        {"level": 0, "size": 4, "roughness": 0.0, "seconds": 0.1},
        {"level": 1, "size": 2, "roughness": 1.0, "seconds": 0.1}]}"#;
    fs::write(folder.path().join("report.json"), report).unwrap();
    folder
}

#[test]
fn level_folders_are_read() {
    for extension in ["exr", "hdr"] {
        let folder = level_folder(extension);
        let chain = io::read_chain(folder.path()).unwrap();
        assert_eq!(
            chain.levels.iter().map(|l| (l.size(), l.roughness)).collect::<Vec<_>>(),
            [(4, 0.0), (2, 1.0)]
        );
        assert_eq!(chain.levels[1].texels.len(), 24, "six faces");
        assert_eq!(chain.levels[1].texels[23], [2.0, 2.0, 6.0], "the last texel of -Z");
        let loaded = io::read(folder.path(), &ReadOptions::default()).unwrap();
        assert_texels(loaded.environment.texels(), &chain.levels[0].texels);
        assert!(loaded.format.starts_with("level folder, "), "{}", loaded.format);
    }
}

#[test]
fn broken_level_folders_are_named() {
    let folder = level_folder("exr");
    let place = folder.path().display().to_string();
    let fails = |wanted: String| assert_eq!(io::read_chain(folder.path()).unwrap_err().to_string(), wanted);

    fs::copy(folder.path().join("m0_px.exr"), folder.path().join("m1_px.exr")).unwrap();
    fails(format!("{place}{MAIN_SEPARATOR}m1_px.exr: 4x4, but report.json says that level 1 is 2x2"));
    fs::remove_file(folder.path().join("m1_px.exr")).unwrap();
    fails(format!(
        "{place}: m1_px.exr (or .hdr) is missing, though report.json lists its level; bake it again"
    ));
    fs::write(folder.path().join("report.json"), r#"{"levels":[{"level":0,"size":4,"roughness":2}]}"#)
        .unwrap();
    fails(format!(
        "{place}{MAIN_SEPARATOR}report.json: its entry 0 is level 0 of size 4 and roughness 2; level 0 of \
         size 4 and a roughness in [0, 1] is needed"
    ));
    fs::write(folder.path().join("report.json"), r#"{"levels":[]}"#).unwrap();
    fails(format!("{place}{MAIN_SEPARATOR}report.json: it lists no levels"));
    fs::remove_file(folder.path().join("report.json")).unwrap();
    fails(format!(
        "{place}: a directory without a report.json; give an image, or a level folder that octagloss bake \
         wrote"
    ));
}
