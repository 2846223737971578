//! KTX 1 and DDS files, read by independent parsers; DDS also by the program's reader.

use crate::io::bc6h::decoded;
use half::f16;
use octagloss_core::files::format::container::Container;
use octagloss_core::files::format::r11g11b10::{r11g11b10_from_rgb, rgb_from_r11g11b10};
use octagloss_core::files::format::rgbd::{RGBD_MAX, rgbd_from_rgb, rgbd_png_bytes};
use octagloss_core::files::format::rgbp::{RGBP_MAX, rgbp_from_rgb};
use octagloss_core::files::format::{Pixel, rgb_from_rgb9e5, rgb9e5_from_rgb};
use octagloss_core::files::io::cube_write::cube_bytes;
use octagloss_core::files::io::{ReadOptions, read_chain, read_chain_from_memory, read_from_memory};
use octagloss_core::light::chain::Chain;
use octagloss_core::light::environment::Rgb;
use octagloss_fixtures::files::written::{chain, first_difference, rgb_from_rgbd, rgb_from_rgbp, to_half};
use std::path::Path;

const PLAIN: [Pixel; 4] = [Pixel::F16, Pixel::F32, Pixel::Rgb9e5, Pixel::R11g11b10];

/// A cube as parsed: size, levels, and each level's six faces.
pub(crate) struct Cube {
    pub(crate) size: u32,
    pub(crate) pairs: Vec<(String, String)>,
    pub(crate) levels: Vec<Vec<Rgb>>,
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

pub(crate) fn texel_length(pixel: Pixel) -> usize {
    match pixel {
        Pixel::F16 => 8,
        Pixel::F32 => 16,
        _ => 4,
    }
}

/// Decodes one face of `size` x `size` from the bytes of `pixel`.
pub(crate) fn colours(pixel: Pixel, size: u32, bytes: &[u8]) -> Vec<Rgb> {
    let half = |at: usize| f16::from_le_bytes([bytes[at], bytes[at + 1]]).to_f32();
    let float = |at: usize| f32::from_bits(word(bytes, at));
    let texels = (0..(size * size) as usize).map(|k| k * texel_length(pixel));
    match pixel {
        Pixel::F16 => texels.map(|at| [half(at), half(at + 2), half(at + 4)]).collect(),
        Pixel::F32 => texels.map(|at| [float(at), float(at + 4), float(at + 8)]).collect(),
        Pixel::Rgb9e5 => texels.map(|at| rgb_from_rgb9e5(word(bytes, at))).collect(),
        Pixel::R11g11b10 => texels.map(|at| rgb_from_r11g11b10(word(bytes, at))).collect(),
        Pixel::Bc6h => decoded(size, bytes),
        Pixel::Rgbd | Pixel::Rgbp | Pixel::Rgbe | Pixel::Auto => (0..(size * size) as usize)
            .map(|k| rgb_from_rgbd(bytes[4 * k..4 * k + 4].try_into().unwrap()))
            .collect(),
    }
}

/// Parses KTX 1 by its specification; `rule` names the violated rule.
pub(crate) fn parse_ktx1(bytes: &[u8], pixel: Pixel) -> Result<Cube, String> {
    let rule = |holds: bool, what: &str| if holds { Ok(()) } else { Err(what.to_owned()) };
    rule(bytes.starts_with(b"\xabKTX 11\xbb\r\n\x1a\n"), "identifier")?;
    let header: Vec<u32> = (12..64).step_by(4).map(|at| word(bytes, at)).collect();
    rule(header[0] == 0x0403_0201, "endianness")?;
    let (kind, kind_bytes, format, internal) = match pixel {
        Pixel::F16 => (0x140b, 2, 0x1908, 0x881a),
        Pixel::F32 => (0x1406, 4, 0x1908, 0x8814),
        Pixel::Rgb9e5 => (0x8c3e, 4, 0x1907, 0x8c3d),
        Pixel::R11g11b10 => (0x8c3a, 4, 0x1907, 0x8c3a),
        Pixel::Bc6h | Pixel::Rgbd | Pixel::Rgbp | Pixel::Rgbe | Pixel::Auto => {
            return Err("neither BC6H nor RGBD here".to_owned());
        }
    };
    rule(header[1..6] == [kind, kind_bytes, format, internal, format], "formats")?;
    let size = header[6];
    rule(size > 0 && header[7] == size && header[8] == 0 && header[9] == 0, "square, flat, no array")?;
    rule(header[10] == 6, "six faces")?;
    rule((1..=size.ilog2() + 1).contains(&header[11]), "levels")?;
    rule(header[12].is_multiple_of(4), "pairs are padded")?;
    let (mut at, end) = (64, 64 + header[12] as usize);
    let mut pairs = Vec::new();
    while at < end {
        let length = word(bytes, at) as usize;
        let pair = &bytes[at + 4..at + 4 + length];
        let nul = pair.iter().position(|b| *b == 0).ok_or("a key without NUL")?;
        rule(pair.last() == Some(&0), "values end in NUL")?;
        let text = |b: &[u8]| String::from_utf8(b.to_vec()).map_err(|e| e.to_string());
        pairs.push((text(&pair[..nul])?, text(&pair[nul + 1..length - 1])?));
        at = (at + 4 + length).next_multiple_of(4);
    }
    rule(at == end, "pairs fill their bytes")?;
    let mut levels = Vec::new();
    for level in 0..header[11] {
        let edge = (size >> level).max(1);
        let face = word(bytes, at) as usize;
        rule(face == (edge * edge) as usize * texel_length(pixel), "imageSize is one face's")?;
        at += 4;
        levels.push((0..6).flat_map(|k| colours(pixel, edge, &bytes[at + k * face..][..face])).collect());
        at += 6 * face;
    }
    rule(at == bytes.len(), "nothing after the last level")?;
    Ok(Cube { size, pairs, levels })
}

/// Parses DDS by Microsoft's guide.
pub(crate) fn parse_dds(bytes: &[u8], pixel: Pixel) -> Result<Cube, String> {
    let rule = |holds: bool, what: &str| if holds { Ok(()) } else { Err(what.to_owned()) };
    rule(bytes.starts_with(b"DDS ") && word(bytes, 4) == 124, "magic and header size")?;
    // CAPS, HEIGHT, WIDTH, PIXELFORMAT, and MIPMAPCOUNT if there are several levels.
    let count = word(bytes, 28).max(1);
    let flags = word(bytes, 8);
    rule(flags & 0x1007 == 0x1007, "flags")?;
    rule(count == 1 || flags & 0x20000 != 0, "flag of levels")?;
    let size = word(bytes, 12);
    rule(word(bytes, 16) == size && (1..=size.ilog2() + 1).contains(&count), "square, levels")?;
    rule(
        word(bytes, 76) == 32 && word(bytes, 80) & 4 != 0 && &bytes[84..88] == b"DX10",
        "pixel format DX10",
    )?;
    rule(word(bytes, 108) & 0x1000 != 0, "caps: texture")?;
    rule(word(bytes, 112) & 0xfe00 == 0xfe00, "caps2: cube with six faces")?;
    let format = match pixel {
        Pixel::F32 => 2,
        Pixel::F16 => 10,
        Pixel::R11g11b10 => 26,
        Pixel::Rgb9e5 => 67,
        Pixel::Bc6h => 95,
        Pixel::Rgbd | Pixel::Rgbp | Pixel::Rgbe | Pixel::Auto => return Err("no RGBD here".to_owned()),
    };
    rule(word(bytes, 128) == format, "DXGI format")?;
    rule(word(bytes, 132) == 3 && word(bytes, 136) == 4 && word(bytes, 140) == 1, "2D, a cube, one of it")?;
    let mut levels = vec![Vec::new(); count as usize];
    let mut at = 148;
    for _face in 0..6 {
        for (level, texels) in (0..count).zip(&mut levels) {
            let edge = (size >> level).max(1);
            let length = match pixel {
                Pixel::Bc6h => (edge.div_ceil(4) * edge.div_ceil(4) * 16) as usize,
                _ => (edge * edge) as usize * texel_length(pixel),
            };
            rule(bytes.len() >= at + length, "bytes of every level")?;
            texels.extend(colours(pixel, edge, &bytes[at..at + length]));
            at += length;
        }
    }
    rule(at == bytes.len(), "nothing after the last level")?;
    Ok(Cube { size, pairs: Vec::new(), levels })
}

/// Returns `texel` as stored in `pixel`.
fn stored(pixel: Pixel, texel: Rgb) -> Rgb {
    match pixel {
        Pixel::F16 => to_half(texel),
        Pixel::F32 => texel,
        Pixel::Rgb9e5 => rgb_from_rgb9e5(rgb9e5_from_rgb(texel)),
        Pixel::R11g11b10 => rgb_from_r11g11b10(r11g11b10_from_rgb(texel)),
        Pixel::Bc6h | Pixel::Rgbd | Pixel::Rgbp | Pixel::Rgbe | Pixel::Auto => {
            unreachable!("not among the formats")
        }
    }
}

fn same(found: &Cube, chain: &Chain, pixel: Pixel) {
    assert_eq!((found.size, found.levels.len()), (chain.levels[0].size(), chain.levels.len()));
    for (found, level) in found.levels.iter().zip(&chain.levels) {
        let expected: Vec<Rgb> = level.texels.iter().map(|t| stored(pixel, *t)).collect();
        assert_eq!(first_difference(found, &expected), None, "{pixel:?} level of {}", level.size());
    }
}

#[test]
fn ktx1_and_dds_hold_every_level_by_their_specifications() {
    for size in [1, 2, 16, 24] {
        let chain = chain(size, size.ilog2() + 1, false);
        for pixel in PLAIN {
            let pairs = vec![("sh".to_owned(), "1 2 3\n".to_owned()), ("a".to_owned(), String::new())];
            let ktx = cube_bytes(Container::Ktx1, &chain.levels, pixel, &pairs).unwrap();
            let found = parse_ktx1(&ktx, pixel).unwrap();
            // The roughness follows.
            assert_eq!(found.pairs[..2], pairs);
            assert_eq!((found.pairs.len(), found.pairs[2].0.as_str()), (3, "octaglossRoughness"));
            same(&found, &chain, pixel);
            let dds = cube_bytes(Container::Dds, &chain.levels, pixel, &pairs).unwrap();
            same(&parse_dds(&dds, pixel).unwrap(), &chain, pixel);
            assert!(chain.levels.iter().all(|level| pixel.clamped(&level.texels) == 0));
        }
        let dds = cube_bytes(Container::Dds, &chain.levels, Pixel::Bc6h, &[]).unwrap();
        parse_dds(&dds, Pixel::Bc6h).unwrap();
    }
}

#[test]
fn the_program_reads_the_dds_that_it_writes() {
    let chain = chain(16, 5, false);
    for pixel in PLAIN {
        let dds = cube_bytes(Container::Dds, &chain.levels, pixel, &[]).unwrap();
        let read = |bytes: &[u8]| read_from_memory(Path::new("a.dds"), bytes, &ReadOptions::default());
        let loaded = read(&dds).unwrap();
        let expected: Vec<Rgb> = chain.levels[0].texels.iter().map(|t| stored(pixel, *t)).collect();
        assert_eq!(first_difference(loaded.environment.texels(), &expected), None);
        assert!(loaded.format.starts_with("DDS cube") && loaded.warnings.is_empty(), "{loaded:?}");
        for (bytes, words) in
            [(&dds[..dds.len() - 1], "truncated"), (&dds[..140], "truncated"), (&dds[..60], "truncated")]
        {
            let error = read(bytes).unwrap_err().to_string();
            assert!(error.starts_with("a.dds: ") && error.contains(words), "{error}");
        }
    }
}

#[test]
fn the_program_reads_the_bc6h_and_r11g11b10f_that_it_writes() {
    // Size 5 has partial blocks on every level, size 8 on the last only.
    for size in [8, 5] {
        let chain = chain(size, 3, false);
        for pixel in [Pixel::Bc6h, Pixel::R11g11b10] {
            let dds = cube_bytes(Container::Dds, &chain.levels, pixel, &[]).unwrap();
            let ktx2 = cube_bytes(Container::Ktx2, &chain.levels, pixel, &[]).unwrap();
            let expected = parse_dds(&dds, pixel).unwrap().levels;
            for (name, bytes) in [("a.dds", &dds), ("a.ktx2", &ktx2)] {
                let loaded = read_from_memory(Path::new(name), bytes, &ReadOptions::default()).unwrap();
                assert_eq!(
                    first_difference(loaded.environment.texels(), &expected[0]),
                    None,
                    "{name} {size}"
                );
                let cut =
                    read_from_memory(Path::new(name), &bytes[..bytes.len() - 1], &ReadOptions::default());
                assert!(cut.is_err(), "{name} {size}");
            }
            let read = read_chain_from_memory(Path::new("a.ktx2"), &ktx2, 1 << 30).unwrap();
            for (found, (expected, exact)) in read.levels.iter().zip(expected.iter().zip(&chain.levels)) {
                assert_eq!(first_difference(&found.texels, expected), None, "{size} {pixel:?}");
                assert_eq!((found.size(), found.roughness), (exact.size(), exact.roughness));
            }
            // A DDS file's report contains the roughness.
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.dds");
            std::fs::write(&path, &dds).unwrap();
            let error = read_chain(&path).unwrap_err().to_string();
            assert!(error.contains("there is no") && error.contains("a.dds.report.json"), "{error}");
            let levels: Vec<_> = (0..).zip(&chain.levels).map(|(level, l)| {
                serde_json::json!({ "level": level, "size": l.size(), "roughness": l.roughness })
            }).collect();
            let report = serde_json::json!({ "levels": levels }).to_string();
            std::fs::write(folder.path().join("a.dds.report.json"), report).unwrap();
            assert_eq!(read_chain(&path).unwrap(), read);
        }
    }
}

#[test]
fn rgbp_keeps_radiance_within_what_eight_bits_of_the_root_hold() {
    for k in 0..6400_u16 {
        let value = f32::from(k) / 100.0;
        let [decoded, ..] = rgb_from_rgbp(rgbp_from_rgb([value, value / 3.0, 0.0]));
        // Half a code of the root, whose scale is rounded up by up to 7/255.
        let root = value.sqrt();
        let most = root * (root.max(1.0) + 7.0 / 255.0) / 255.0 + 1e-5;
        assert!((decoded - value).abs() <= most, "{value} is {decoded}");
    }
    assert_eq!(rgb_from_rgbp(rgbp_from_rgb([0.0, 1.0, 0.0])), [0.0, 1.0, 0.0]);
    assert_eq!(rgb_from_rgbp(rgbp_from_rgb([1e9, 0.0, RGBP_MAX])), [RGBP_MAX, 0.0, RGBP_MAX]);
}

#[test]
fn rgbd_keeps_radiance_within_what_eight_bits_of_gamma_hold() {
    let mut worst = 0.0_f32;
    for k in 0..4000 {
        let value = 2_f32.powf(k as f32 / 250.0 - 8.0).min(RGBD_MAX);
        let code = rgbd_from_rgb([value, value / 3.0, 0.0]);
        let [r, g, b] = rgb_from_rgbd(code);
        // Half a code, and up to half of the range lost because the divisor is rounded down.
        worst = worst.max((r - value).abs() / value.max(0.25));
        assert!((g - value / 3.0).abs() < 0.02 * value.max(0.25) && b == 0.0, "{value}: {code:?}");
    }
    assert!(worst < 0.013, "{worst}");
    assert_eq!(rgbd_from_rgb([1.0, 0.5, 0.0])[3], 255);
    assert_eq!(rgb_from_rgbd(rgbd_from_rgb([1e9, 0.0, 0.0])), [RGBD_MAX, 0.0, 0.0]);
    assert_eq!(rgb_from_rgbd([255, 0, 0, 0]), [255.0, 0.0, 0.0], "a divisor of 0 must not divide by 0");
    let png = rgbd_png_bytes(2, &[[1.0, 0.0, 2.0], [0.2; 3]]).unwrap();
    let read = image::load_from_memory(&png).unwrap().into_rgba8();
    assert_eq!(read.dimensions(), (2, 1));
    assert_eq!(read.get_pixel(0, 0).0, rgbd_from_rgb([1.0, 0.0, 2.0]));
    assert!(rgbd_png_bytes(2, &[[1.0; 3]; 3]).is_err() && rgbd_png_bytes(0, &[]).is_err());
}

#[test]
fn the_parsers_detect_faults() {
    let chain = chain(8, 4, false);
    let ktx = cube_bytes(Container::Ktx1, &chain.levels, Pixel::R11g11b10, &[]).unwrap();
    for (at, what) in [(0, "identifier"), (12, "endianness"), (16, "formats"), (52, "six faces")] {
        let mut bad = ktx.clone();
        bad[at] ^= 1;
        assert_eq!(parse_ktx1(&bad, Pixel::R11g11b10).err().as_deref(), Some(what));
    }
    let dds = cube_bytes(Container::Dds, &chain.levels, Pixel::F16, &[]).unwrap();
    for (at, what) in [(4, "magic and header size"), (128, "DXGI format"), (136, "2D, a cube, one of it")] {
        let mut bad = dds.clone();
        bad[at] ^= 1;
        assert_eq!(parse_dds(&bad, Pixel::F16).err().as_deref(), Some(what));
    }
    let mut swapped = chain.clone();
    swapped.levels[0].texels.swap(3, 64 + 3);
    let bytes = cube_bytes(Container::Dds, &swapped.levels, Pixel::F32, &[]).unwrap();
    let found = parse_dds(&bytes, Pixel::F32).unwrap();
    assert_eq!(first_difference(&found.levels[0], &chain.levels[0].texels), Some(3));
}

#[test]
fn impossible_requests_are_refused() {
    let good = chain(4, 2, false);
    let words = |result: octagloss_core::common::error::Result<Vec<u8>>| result.unwrap_err().to_string();
    assert!(words(cube_bytes(Container::Ktx1, &good.levels, Pixel::Bc6h, &[])).contains("bc6h"));
    assert!(!Container::Ktx1.holds(Pixel::Bc6h) && Container::Dds.holds(Pixel::Bc6h));
    let twice = vec![("sh".to_owned(), String::new()); 2];
    assert!(words(cube_bytes(Container::Ktx1, &good.levels, Pixel::F16, &twice)).contains("twice"));
    let mut uneven = good.clone();
    uneven.levels[1] = uneven.levels[0].clone();
    for container in [Container::Ktx1, Container::Dds, Container::Ktx2] {
        assert!(words(cube_bytes(container, &uneven.levels, Pixel::F16, &[])).contains("level 1"));
        let none = Chain { levels: vec![] };
        assert!(words(cube_bytes(container, &none.levels, Pixel::F16, &[])).contains("at least one level"));
    }
}
