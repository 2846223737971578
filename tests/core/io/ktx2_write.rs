//! The KTX2 writer, against the specification by an independent parser, and against the `ktx2` crate.

use half::f16;
use octagloss_core::files::format::r11g11b10::{r11g11b10_from_rgb, rgb_from_r11g11b10};
use octagloss_core::files::format::{Pixel, rgb_from_rgb9e5, rgb9e5_from_rgb};
use octagloss_core::files::io::ktx2::write::{ROUGHNESS_KEY, ktx2_bytes};
use octagloss_core::light::environment::Rgb;
use octagloss_fixtures::files::written::{chain, first_difference, metadata, to_half};

/// Contents of a file as read by the independent parser below.
struct Parsed {
    size: u32,
    pairs: Vec<(String, Vec<u8>)>,
    samples: Vec<[u32; 4]>,
    levels: Vec<Vec<u8>>,
}

/// Reads a KTX2 file by the specification alone and checks all its rules for such files; returns the first
/// violated rule.
fn parse_ktx2(bytes: &[u8], vk_format: u32, type_size: u32, texel_bytes: u32) -> Result<Parsed, String> {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let long = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
    let rule = |holds: bool, what: &str| if holds { Ok(()) } else { Err(what.to_owned()) };
    rule(bytes.starts_with(b"\xabKTX 20\xbb\r\n\x1a\n"), "identifier")?;
    rule(word(12) == vk_format, "vkFormat")?;
    rule(word(16) == type_size, "typeSize")?;
    let size = word(20);
    rule(size > 0 && word(24) == size, "a cube's faces are square")?;
    rule(word(28) == 0 && word(32) == 0, "no depth, no layers")?;
    rule(word(36) == 6, "six faces")?;
    let level_count = word(40);
    rule(level_count >= 1 && level_count <= size.ilog2() + 1, "levelCount")?;
    rule(word(44) == 2, "Zstandard")?;

    // Index: the sections follow one another without gaps.
    let (dfd_at, dfd_len, kvd_at, kvd_len) =
        (word(48) as usize, word(52) as usize, word(56) as usize, word(60) as usize);
    rule(dfd_at == 80 + 24 * level_count as usize, "the DFD follows the level index")?;
    rule(kvd_at == dfd_at + dfd_len && kvd_at.is_multiple_of(4), "key/value data follow the DFD")?;
    rule(long(64) == 0 && long(72) == 0, "no global data")?;

    // Basic data format descriptor block (Khronos Data Format 1.3, section 5).
    rule(word(dfd_at) as usize == dfd_len, "dfdTotalSize")?;
    rule(word(dfd_at + 4) == 0, "vendor and descriptor type")?;
    rule(word(dfd_at + 8) & 0xffff == 2, "version 1.3")?;
    let block = (word(dfd_at + 8) >> 16) as usize;
    rule(block + 4 == dfd_len && (block - 24).is_multiple_of(16), "descriptorBlockSize")?;
    // BC6H, the only block-compressed format, has its own model (133) and blocks of 4 x 4.
    let (model, edge_of_block) = if vk_format == 143 { (133, 4) } else { (1, 1) };
    rule(word(dfd_at + 12) == model | 1 << 8 | 1 << 16, "RGBSDA, BT.709, linear, straight alpha")?;
    rule(word(dfd_at + 16) == (edge_of_block - 1) * 0x101, "texel blocks of one")?;
    rule(word(dfd_at + 20) == texel_bytes && word(dfd_at + 24) == 0, "bytesPlane")?;
    let samples = (dfd_at + 28..dfd_at + dfd_len)
        .step_by(16)
        .map(|at| [word(at), word(at + 4), word(at + 8), word(at + 12)])
        .collect();

    // Key/value data: in order, each pair padded to four bytes with zeros.
    let mut pairs: Vec<(String, Vec<u8>)> = Vec::new();
    let mut at = kvd_at;
    while at < kvd_at + kvd_len {
        let length = word(at) as usize;
        let pair = &bytes[at + 4..at + 4 + length];
        let nul = pair.iter().position(|b| *b == 0).ok_or("a key without NUL")?;
        let key = String::from_utf8(pair[..nul].to_vec()).map_err(|e| e.to_string())?;
        rule(pairs.last().is_none_or(|last| last.0 < key), "keys in order")?;
        pairs.push((key, pair[nul + 1..].to_vec()));
        let padded = (at + 4 + length).next_multiple_of(4);
        rule(bytes[at + 4 + length..padded].iter().all(|b| *b == 0), "padding of zeros")?;
        at = padded;
    }
    rule(at == kvd_at + kvd_len, "kvdByteLength")?;

    // Levels: the smallest first in the file, without padding, the last to the end of the file.
    let mut levels = Vec::new();
    for index in (0..level_count as usize).rev() {
        let entry = 80 + 24 * index;
        let (offset, length, uncompressed) = (long(entry), long(entry + 8), long(entry + 16));
        rule(offset == at, "levels follow one another, the smallest first")?;
        let edge = (size as usize >> index).div_ceil(edge_of_block as usize);
        rule(uncompressed == 6 * edge * edge * texel_bytes as usize, "uncompressedByteLength")?;
        let data = zstd::bulk::decompress(&bytes[offset..offset + length], uncompressed);
        levels.insert(0, data.map_err(|e| e.to_string())?);
        rule(levels[0].len() == uncompressed, "inflated length")?;
        at = offset + length;
    }
    rule(at == bytes.len(), "nothing after the last level")?;
    Ok(Parsed { size, pairs, samples, levels })
}

/// vkFormat, typeSize and bytes per texel.
const FORMATS: [(Pixel, u32, u32, u32); 4] = [
    (Pixel::F16, 97, 2, 8),
    (Pixel::F32, 109, 4, 16),
    (Pixel::Rgb9e5, 123, 4, 4),
    (Pixel::R11g11b10, 122, 4, 4),
];

fn colours(pixel: Pixel, level: &[u8]) -> Vec<Rgb> {
    let half = |b: &[u8]| f16::from_le_bytes([b[0], b[1]]).to_f32();
    let float = |b: &[u8]| f32::from_le_bytes(b.try_into().unwrap());
    match pixel {
        Pixel::F16 => level.chunks_exact(8).map(|t| [half(t), half(&t[2..]), half(&t[4..])]).collect(),
        Pixel::F32 => {
            level.chunks_exact(16).map(|t| [float(&t[..4]), float(&t[4..8]), float(&t[8..12])]).collect()
        }
        Pixel::Rgb9e5 => level
            .chunks_exact(4)
            .map(|t| rgb_from_rgb9e5(u32::from_le_bytes(t.try_into().unwrap())))
            .collect(),
        Pixel::R11g11b10 => level
            .chunks_exact(4)
            .map(|t| rgb_from_r11g11b10(u32::from_le_bytes(t.try_into().unwrap())))
            .collect(),
        Pixel::Bc6h => panic!("blocks hold no single texels"),
        Pixel::Rgbd | Pixel::Rgbp | Pixel::Rgbe | Pixel::Auto => panic!("not in KTX2"),
    }
}

#[test]
fn ktx2_files_hold_to_the_specification_and_come_back_as_written() {
    for size in [1, 2, 16, 24] {
        let chain = chain(size, size.ilog2() + 1, false);
        for (pixel, vk_format, type_size, texel_bytes) in FORMATS {
            let ktx2 = ktx2_bytes(&chain.levels, pixel, &metadata()).unwrap();
            let parsed = parse_ktx2(&ktx2, vk_format, type_size, texel_bytes).unwrap();
            assert_eq!(parsed.size, size);
            assert!(chain.levels.iter().all(|level| pixel.clamped(&level.texels) == 0));
            for (level, data) in chain.levels.iter().zip(&parsed.levels) {
                let expected: Vec<Rgb> = match pixel {
                    Pixel::F16 => level.texels.iter().map(|t| to_half(*t)).collect(),
                    Pixel::F32 => level.texels.clone(),
                    Pixel::Rgb9e5 => {
                        level.texels.iter().map(|t| rgb_from_rgb9e5(rgb9e5_from_rgb(*t))).collect()
                    }
                    Pixel::R11g11b10 => {
                        level.texels.iter().map(|t| rgb_from_r11g11b10(r11g11b10_from_rgb(*t))).collect()
                    }
                    Pixel::Bc6h | Pixel::Rgbd | Pixel::Rgbp | Pixel::Rgbe | Pixel::Auto => {
                        panic!("not among the formats")
                    }
                };
                assert_eq!(first_difference(&colours(pixel, data), &expected), None);
                match pixel {
                    Pixel::F16 => assert!(data.chunks_exact(8).all(|t| t[6..] == [0x00, 0x3c])),
                    Pixel::F32 => assert!(data.chunks_exact(16).all(|t| t[12..] == 1_f32.to_le_bytes())),
                    _ => {}
                }
            }
            let value = |key: &str| {
                let pair = parsed.pairs.iter().find(|(k, _)| k == key).expect(key);
                String::from_utf8(pair.1.clone()).unwrap()
            };
            assert_eq!(value("KTXorientation"), "rd\0");
            assert_eq!(value("KTXwriter"), format!("octagloss {}\0", env!("CARGO_PKG_VERSION")));
            assert_eq!(value("octaglossLobe"), "ggx\0");
            let roughness: Vec<f64> =
                value(ROUGHNESS_KEY).trim_end_matches('\0').split(',').map(|r| r.parse().unwrap()).collect();
            assert_eq!(roughness, chain.levels.iter().map(|l| l.roughness).collect::<Vec<_>>());
        }
    }
}

#[test]
fn ktx2_samples_are_those_of_the_data_format_specification() {
    let chain = chain(4, 1, false);
    let samples = |index: usize| {
        let (pixel, vk_format, type_size, texel_bytes) = FORMATS[index];
        let ktx2 = ktx2_bytes(&chain.levels, pixel, &[]).unwrap();
        parse_ktx2(&ktx2, vk_format, type_size, texel_bytes).unwrap().samples
    };
    // Words: offset, length - 1, channel and qualifiers; position; lower; upper. Signed float: qualifiers
    // 0xc, lower -1.0, upper 1.0; alpha is channel 15.
    let float_samples = |bits: u32| -> Vec<[u32; 4]> {
        [0_u32, 1, 2, 15]
            .iter()
            .zip(0_u32..)
            .map(|(channel, at)| {
                [
                    (at * bits) | ((bits - 1) << 16) | ((channel | 0xc0) << 24),
                    0,
                    (-1_f32).to_bits(),
                    1_f32.to_bits(),
                ]
            })
            .collect()
    };
    assert_eq!(samples(0), float_samples(16));
    assert_eq!(samples(1), float_samples(32));
    // RGB9E5 as defined by vk2dfd of Khronos' dfdutils, which `ktx validate` compares with: three times a
    // mantissa of 9 bits and the exponent of bits 27..31. The exponent has the qualifier 0x2, its lower is
    // the bias 15, its upper 31.
    let expected: Vec<[u32; 4]> = (0..3)
        .flat_map(|channel: u32| {
            [
                [(channel * 9) | (8 << 16) | (channel << 24), 0, 0, 8448],
                [27 | 4 << 16 | (channel | 0x20) << 24, 0, 15, 31],
            ]
        })
        .collect();
    assert_eq!(samples(2), expected);
    // B10G11R11: red in the lowest bits; unsigned float, qualifier 0x8, from 0 to 1.0.
    let expected = [(0, 11, 0), (11, 11, 1), (22, 10, 2)]
        .map(|(at, bits, channel)| [at | (bits - 1) << 16 | (channel | 0x80) << 24, 0, 0, 1_f32.to_bits()]);
    assert_eq!(samples(3), expected);
}

#[test]
fn bc6h_files_hold_to_the_specification() {
    for size in [1, 2, 16, 24] {
        let chain = chain(size, size.ilog2() + 1, false);
        let bytes = ktx2_bytes(&chain.levels, Pixel::Bc6h, &metadata()).unwrap();
        let parsed = parse_ktx2(&bytes, 143, 1, 16).unwrap();
        // One sample of 128 bits, unsigned float, 0 to 1.0.
        assert_eq!(parsed.samples, [[127 << 16 | 0x80 << 24, 0, 0, 1_f32.to_bits()]]);
        assert_eq!(parsed.levels.len(), chain.levels.len());
    }
}

#[test]
fn the_ktx2_crate_reads_what_is_written() {
    let chain = chain(16, 5, false);
    for (pixel, vk_format, ..) in FORMATS {
        let bytes = ktx2_bytes(&chain.levels, pixel, &metadata()).unwrap();
        let reader = ktx2::Reader::new(&bytes).unwrap();
        let header = reader.header();
        assert_eq!(header.format.map(|f| f.value()), Some(vk_format));
        assert_eq!((header.pixel_width, header.face_count, header.level_count), (16, 6, 5));
        assert_eq!(reader.transfer_function(), Some(ktx2::TransferFunction::Linear));
        assert_eq!(reader.levels().len(), 5);
        assert_eq!(reader.key_value_data().count(), 6);
    }
}

#[test]
fn the_ktx2_checks_detect_faults() {
    let chain = chain(8, 4, false);
    let good = ktx2_bytes(&chain.levels, Pixel::F16, &metadata()).unwrap();
    let parse = |bytes: &[u8]| parse_ktx2(bytes, 97, 2, 8).map(drop);
    assert_eq!(parse(&good), Ok(()));
    let dfd_at = 80 + 24 * 4;
    for (at, what) in [
        (0, "identifier"),
        (12, "vkFormat"),
        (16, "typeSize"),
        (36, "six faces"),
        (44, "Zstandard"),
        (80 + 16, "uncompressedByteLength"),
        (80 + 24, "levels follow one another, the smallest first"),
        (dfd_at + 14, "RGBSDA, BT.709, linear, straight alpha"),
        (dfd_at + 20, "bytesPlane"),
    ] {
        let mut bad = good.clone();
        bad[at] ^= 1;
        assert_eq!(parse(&bad), Err(what.to_owned()));
    }
    let mut swapped = chain.clone();
    let area = 64;
    let (first, rest) = swapped.levels[0].texels.split_at_mut(area);
    first.swap_with_slice(&mut rest[..area]);
    let bytes = ktx2_bytes(&swapped.levels, Pixel::F32, &[]).unwrap();
    let parsed = parse_ktx2(&bytes, 109, 4, 16).unwrap();
    assert_eq!(first_difference(&colours(Pixel::F32, &parsed.levels[0]), &chain.levels[0].texels), Some(0));
}

#[test]
fn ktx2_refuses_bad_chains_and_bad_keys() {
    assert!(ktx2_bytes(&[], Pixel::F16, &[]).is_err());
    let mut uneven = chain(8, 2, false);
    uneven.levels[1] = uneven.levels[0].clone();
    assert!(ktx2_bytes(&uneven.levels, Pixel::F16, &[]).is_err());
    let mut many = chain(1, 1, false);
    many.levels.push(many.levels[0].clone());
    assert!(ktx2_bytes(&many.levels, Pixel::F16, &[]).is_err());
    let good = chain(2, 1, false);
    for key in ["", "KTXsecret", "ktxsecret", "a\0b", ROUGHNESS_KEY] {
        assert!(ktx2_bytes(&good.levels, Pixel::F16, &[(key.to_owned(), String::new())]).is_err(), "{key:?}");
    }
}
