//! OpenEXR files.

use super::{assert_panorama, assert_texels, error_of, read};
use exr::meta::attribute::Chromaticities;
use exr::prelude::{AnyChannel, Blocks, Compression, Image, IntegerBounds, LayerAttributes, Vec2};
use octagloss_fixtures::files::inputs::{
    Rgb, Sample, exr_bytes, exr_mip_mapped, exr_rgb, layer, numbered, rgb_channels, samples,
};

/// Every lossless compression, half, float and uint, by scanlines and by tiles that do not divide the size.
#[test]
fn lossless_compressions_are_read_exactly() {
    let (size, pixels) = ((72, 36), numbered(72, 36));
    let compressions = [
        (Compression::Uncompressed, "uncompressed"),
        (Compression::RLE, "RLE"),
        (Compression::ZIP1, "ZIPS"),
        (Compression::ZIP16, "ZIP"),
        (Compression::PIZ, "PIZ"),
    ];
    for (compression, name) in compressions {
        for (kind, kind_name) in [(Sample::Half, "half"), (Sample::Float, "float"), (Sample::Uint, "uint")] {
            for (blocks, tiled) in [(Blocks::ScanLines, ""), (Blocks::Tiles(Vec2(16, 32)), ", tiled")] {
                let layer = layer(size, compression, blocks, rgb_channels("", kind, &pixels));
                let loaded = read("a.exr", &exr_bytes(&Image::from_layer(layer))).unwrap();
                assert_panorama(&loaded, size, &pixels);
                assert_eq!(loaded.format, format!("OpenEXR, {kind_name}, {name}{tiled}"));
            }
        }
    }
}

/// Blocks that would not shrink are stored uncompressed, among others that do.
#[test]
fn incompressible_blocks_are_read_exactly() {
    let size = (96, 48);
    let mut state = 1_u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        half::f16::from_bits((state >> 17) as u16 & 0x7bff).to_f32()
    };
    let pixels: Vec<Rgb> = (0..96 * 48)
        .map(|k| if k < 96 * 20 { [noise(), noise(), noise()] } else { [0.5, 1.0, (k % 96) as f32] })
        .collect();
    let bytes = exr_rgb(size, Sample::Half, Compression::ZIP1, &pixels);
    // A block's blue samples, as stored in memory.
    let row: Vec<u8> =
        pixels[..96].iter().flat_map(|[_, _, b]| half::f16::from_f32(*b).to_le_bytes()).collect();
    assert!(bytes.windows(row.len()).any(|window| window == row), "the block must be stored uncompressed");
    assert_panorama(&read("a.exr", &bytes).unwrap(), size, &pixels);
}

/// Refuses a file too short for its blocks before allocating its texels.
#[test]
fn files_too_short_for_their_blocks_are_refused() {
    let black = vec![[0.0; 3]; 64 * 32];
    // Lines per block; bytes of samples per byte of data at most, or 17 bytes per block.
    for (compression, lines, least) in [
        (Compression::Uncompressed, 1, 16_384 * 8192 * 6),
        (Compression::RLE, 1, 16_384 * 8192 * 6 / 64),
        (Compression::ZIP16, 16, 16_384 * 8192 * 6 / 1032),
        (Compression::PXR24, 16, 16_384 * 8192 * 6 / 1376),
        (Compression::PIZ, 32, 8192 / 32 * 17),
    ] {
        let whole = exr_rgb((64, 32), Sample::Half, compression, &black);
        read("a.exr", &whole).expect("the smallest valid file");
        // The same header, for an image of 16384 x 8192.
        let mut vast = whole.clone();
        let mut set = |name: &[u8], offset: usize, value: i32| {
            let at = vast.windows(name.len()).position(|window| window == name).expect("an attribute");
            vast[at + name.len() + offset..][..4].copy_from_slice(&value.to_le_bytes());
        };
        for window in [&b"dataWindow\0box2i\0\x10\0\0\0"[..], b"displayWindow\0box2i\0\x10\0\0\0"] {
            set(window, 8, 16_383);
            set(window, 12, 8191);
        }
        set(b"chunkCount\0int\0\x04\0\0\0", 0, 8192 / lines);
        let error = error_of(read("a.exr", &vast));
        let wanted = format!(
            "a.exr: truncated: its {} blocks take at least {least} bytes and the file has {}; copy it again",
            8192 / lines,
            vast.len()
        );
        assert_eq!(error, wanted);
    }
}

/// Lossy compressions: a smooth image stays within 2 %.
#[test]
fn lossy_compressions_are_read_closely() {
    let size = (72, 36);
    let smooth: Vec<Rgb> =
        numbered(72, 36).iter().map(|[x, y, _]| [1.0 + x / 72.0, 1.0 + y / 36.0, 1.5]).collect();
    for (compression, name) in [
        (Compression::PXR24, "PXR24"),
        (Compression::B44, "B44"),
        (Compression::B44A, "B44A"),
        (Compression::DWAA(None), "DWAA"),
        (Compression::DWAB(None), "DWAB"),
    ] {
        let loaded = read("a.exr", &exr_rgb(size, Sample::Half, compression, &smooth)).unwrap();
        assert_eq!(loaded.format, format!("OpenEXR, half, {name}"));
        let texels = loaded.environment.texels();
        assert!(is_close(texels, &smooth), "{name}");
    }
}

fn is_close(got: &[Rgb], wanted: &[Rgb]) -> bool {
    got.len() == wanted.len()
        && got.iter().zip(wanted).all(|(a, b)| (0..3).all(|c| (a[c] - b[c]).abs() < 0.02 * b[c]))
}

#[test]
fn is_close_detects_a_shift_by_one_texel() {
    let ramp: Vec<Rgb> = (0..20).map(|k| [1.0 + k as f32 / 10.0; 3]).collect();
    assert!(is_close(&ramp, &ramp), "itself");
    let mut shifted = ramp.clone();
    shifted.rotate_left(1);
    assert!(!is_close(&shifted, &ramp), "shifted");
}

/// Large enough to be decoded in parallel.
#[test]
fn parallel_blocks_land_where_they_belong() {
    let size = (512, 256);
    let pixels: Vec<Rgb> = numbered(512, 256).iter().map(|[x, y, _]| [*x, *y, 1.0]).collect();
    let loaded = read("a.exr", &exr_rgb(size, Sample::Float, Compression::ZIP16, &pixels)).unwrap();
    assert_panorama(&loaded, size, &pixels);
}

#[test]
fn mip_mapped_tiles_give_their_largest_level() {
    let pixels = numbered(32, 16);
    assert_panorama(&read("a.exr", &exr_mip_mapped((32, 16), 8, &pixels)).unwrap(), (32, 16), &pixels);
}

#[test]
fn luminance_alone_is_grey() {
    let values: Vec<f32> = (0..32).map(|k| k as f32).collect();
    let channel = AnyChannel::new("Y", samples(Sample::Half, values.iter().copied()));
    let layer = layer((8, 4), Compression::PIZ, Blocks::ScanLines, vec![channel]);
    let loaded = read("a.exr", &exr_bytes(&Image::from_layer(layer))).unwrap();
    let grey: Vec<Rgb> = values.iter().map(|value| [*value; 3]).collect();
    assert_panorama(&loaded, (8, 4), &grey);
    assert_eq!(loaded.format, "OpenEXR, half, PIZ, luminance");
}

fn luminance_chroma() -> Vec<u8> {
    let channel =
        |name: &str, value: f32| AnyChannel::new(name, samples(Sample::Float, [value; 8].into_iter()));
    // Y = 1, R = 2, B = 0.5.
    let channels = vec![channel("Y", 1.0), channel("RY", 1.0), channel("BY", -0.5)];
    exr_bytes(&Image::from_layer(layer((4, 2), Compression::Uncompressed, Blocks::ScanLines, channels)))
}

#[test]
fn luminance_chroma_becomes_rgb() {
    let loaded = read("a.exr", &luminance_chroma()).unwrap();
    let [r, g, b] = loaded.environment.texels()[0];
    assert_eq!((r, b), (2.0, 0.5), "from RY and BY");
    assert!((0.2126 * r + 0.7152 * g + 0.0722 * b - 1.0).abs() < 1e-3, "Y is kept: {g}");
}

#[test]
fn subsampled_chroma_is_refused() {
    let mut bytes = luminance_chroma();
    // An entry of the channel list: name, NUL, type, flags, then the two samplings.
    let at = bytes.windows(3).position(|name| name == b"RY\0").unwrap() + 3 + 8;
    bytes[at..at + 8].copy_from_slice(&[2, 0, 0, 0, 2, 0, 0, 0]);
    let text = error_of(read("a.exr", &bytes));
    assert_eq!(
        text,
        "a.exr: it has subsampled channels (luminance-chroma), which cannot be read; convert it to RGB"
    );
}

#[test]
fn named_layers_are_chosen_and_named() {
    let (wanted, other) = (numbered(8, 4), vec![[9.0; 3]; 32]);
    let file = |layers: &[(&str, &[Rgb])]| {
        let channels = layers.iter().flat_map(|(name, pixels)| rgb_channels(name, Sample::Half, pixels));
        exr_bytes(&Image::from_layer(layer(
            (8, 4),
            Compression::ZIP16,
            Blocks::ScanLines,
            channels.collect(),
        )))
    };
    for (layers, warning) in [
        (vec![("diffuse.", &wanted)], "read layer diffuse; there is no unnamed one"),
        (vec![("", &wanted), ("diffuse.", &other)], "read the unnamed layer; ignored: layer diffuse"),
        (
            vec![("View.AO.", &other), ("View.Combined.", &wanted)],
            "read layer View.Combined; ignored: layer View.AO",
        ),
    ] {
        let layers: Vec<(&str, &[Rgb])> =
            layers.iter().map(|(name, pixels)| (*name, pixels.as_slice())).collect();
        let loaded = read("a.exr", &file(&layers)).unwrap();
        assert_panorama(&loaded, (8, 4), &wanted);
        assert_eq!(loaded.warnings, [warning]);
    }
}

#[test]
fn a_part_among_several_is_chosen() {
    let (wanted, other) = (numbered(8, 4), vec![[9.0; 3]; 32]);
    let part = |name: &str, pixels: &[Rgb]| {
        let mut part =
            layer((8, 4), Compression::PIZ, Blocks::ScanLines, rgb_channels("", Sample::Half, pixels));
        part.attributes = LayerAttributes::named(name);
        part
    };
    let image = Image::empty(exr::prelude::ImageAttributes::with_size((8, 4)))
        .with_layer(part("depth", &other))
        .with_layer(part("beauty", &wanted));
    let loaded = read("a.exr", &exr_bytes(&image)).unwrap();
    assert_panorama(&loaded, (8, 4), &wanted);
    assert_eq!(loaded.warnings, ["read layer beauty; ignored: layer depth"]);
}

#[test]
fn missing_color_lists_the_channels() {
    let channel = |name: &str| AnyChannel::new(name, samples(Sample::Half, [1.0; 8].into_iter()));
    let channels = vec![channel("Z"), channel("id")];
    let layer = layer((4, 2), Compression::ZIP16, Blocks::ScanLines, channels);
    let text = error_of(read("a.exr", &exr_bytes(&Image::from_layer(layer))));
    assert_eq!(text, "a.exr: no channels R, G, B and no Y among Z, id; rename or convert them");
}

/// Returns a file with `pixels` as a data window of `data` size at `position`, in a display window from (10,
/// 20) on.
fn windowed(data: (u32, u32), position: (i32, i32), display: (usize, usize), pixels: &[Rgb]) -> Vec<u8> {
    let mut layer =
        layer(data, Compression::ZIP16, Blocks::ScanLines, rgb_channels("", Sample::Half, pixels));
    layer.attributes.layer_position = Vec2(10 + position.0, 20 + position.1);
    let mut image = Image::from_layer(layer);
    image.attributes.display_window = IntegerBounds::new((10, 20), display);
    exr_bytes(&image)
}

#[test]
fn smaller_data_window_is_filled_with_black() {
    let pixels = numbered(4, 2);
    let loaded = read("a.exr", &windowed((4, 2), (3, 1), (8, 4), &pixels)).unwrap();
    let mut wanted = vec![[0.0; 3]; 32];
    for y in 0..2 {
        wanted[(y + 1) * 8 + 3..][..4].copy_from_slice(&pixels[y * 4..][..4]);
    }
    assert_panorama(&loaded, (8, 4), &wanted);
    assert_eq!(
        loaded.warnings,
        ["its 4x2 data window at (3, 1) was cropped to the 8x4 display window, the rest is black"]
    );
}

#[test]
fn larger_data_window_is_cropped() {
    let pixels = numbered(12, 40);
    let loaded = read("a.exr", &windowed((12, 40), (-2, -30), (8, 4), &pixels)).unwrap();
    let wanted: Vec<Rgb> = (0..4).flat_map(|y| pixels[(y + 30) * 12 + 2..][..8].to_vec()).collect();
    assert_panorama(&loaded, (8, 4), &wanted);
}

#[test]
fn data_window_outside_is_refused() {
    let text = error_of(read("a.exr", &windowed((4, 2), (100, 0), (8, 4), &numbered(4, 2))));
    assert_eq!(text, "a.exr: its 4x2 data window at (100, 0) lies outside the 8x4 display window");
}

#[test]
fn chromaticities_are_converted() {
    let with = |chromaticities| {
        let layer = layer(
            (2, 1),
            Compression::ZIP16,
            Blocks::ScanLines,
            rgb_channels("", Sample::Float, &[[1.0, 0.0, 0.0]; 2]),
        );
        let mut image = Image::from_layer(layer);
        image.attributes.chromaticities = Some(chromaticities);
        read("a.exr", &exr_bytes(&image)).unwrap()
    };
    let rec709 = Chromaticities {
        red: Vec2(0.64, 0.33),
        green: Vec2(0.3, 0.6),
        blue: Vec2(0.15, 0.06),
        white: Vec2(0.3127, 0.329),
    };
    let loaded = with(rec709);
    assert_texels(loaded.environment.texels(), &[[1.0, 0.0, 0.0]; 2]);
    assert!(loaded.warnings.is_empty(), "no warning for Rec. 709: {:?}", loaded.warnings);

    let swapped = Chromaticities { red: rec709.green, green: rec709.red, ..rec709 };
    let loaded = with(swapped);
    let texel = loaded.environment.texels()[0];
    assert!((texel[1] - 1.0).abs() < 1e-5 && texel[0].abs() < 1e-5, "its red is our green: {texel:?}");
    assert_eq!(loaded.warnings[0], "its chromaticities are not Rec. 709; converted");

    let point = Vec2(0.3, 0.3);
    let loaded = with(Chromaticities { red: point, green: point, blue: point, white: point });
    assert_eq!(loaded.warnings, ["its chromaticities are degenerate; ignored"]);
}

#[test]
fn an_empty_data_window_is_refused() {
    let mut bytes = exr_rgb((4, 2), Sample::Half, Compression::ZIP16, &numbered(4, 2));
    let name = b"dataWindow\0box2i\0\x10\0\0\0";
    let at = bytes.windows(name.len()).position(|window| window == name).expect("every file has one");
    // A last column before the first.
    bytes[at + name.len() + 8..][..4].copy_from_slice(&(-1_i32).to_le_bytes());
    assert_eq!(error_of(read("a.exr", &bytes)), "a.exr: 0x2 has no pixels");
}

#[test]
fn deep_data_is_refused() {
    let mut bytes = exr_rgb((4, 2), Sample::Half, Compression::ZIP16, &numbered(4, 2));
    bytes[5] |= 0x08;
    assert_eq!(error_of(read("a.exr", &bytes)), "a.exr: deep data; flatten it to one sample a pixel");
}

/// An offset table with one block twice lacks another.
#[test]
fn repeated_blocks_are_refused() {
    let bytes = exr_rgb((8, 4), Sample::Half, Compression::Uncompressed, &numbered(8, 4));
    let block = 8 * 3 * 2 + 8;
    let first = bytes.len() - 4 * block;
    let table = first - 4 * 8;
    let mut broken = bytes.clone();
    broken.copy_within(table..table + 8, table + 8);
    let text = error_of(read("a.exr", &broken));
    assert_eq!(text, "a.exr: corrupt: its offset table references wrong blocks; re-export the file");
    assert!(read("a.exr", &bytes).is_ok(), "the original file is valid");
}
