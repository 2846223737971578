//! Radiance images.

use super::{assert_panorama, assert_texels, error_of, read};
use octagloss_fixtures::files::inputs::{Rgb, numbered, radiance, radiance_with_runs};

const RGBE: &str = "FORMAT=32-bit_rle_rgbe\n";

#[test]
fn flat_and_run_length_pictures_are_read() {
    let pixels = numbered(16, 8);
    assert_panorama(&read("a.hdr", &radiance(RGBE, "-Y 8 +X 16", &pixels)).unwrap(), (16, 8), &pixels);
    let loaded = read("a.hdr", &radiance_with_runs(16, 8, &pixels)).unwrap();
    assert_panorama(&loaded, (16, 8), &pixels);
    assert_eq!((loaded.format.as_str(), loaded.layout), ("Radiance RGBE", "panorama"), "described");
    assert!(loaded.warnings.is_empty(), "nothing to warn of: {:?}", loaded.warnings);
}

/// The eight orientations, with the positions of their first and second pixel in the upright image.
#[test]
fn all_eight_orientations_come_upright() {
    let (width, height) = (16u32, 8u32);
    let upright = numbered(width, height);
    for (resolution, first, second) in [
        ("-Y 8 +X 16", (0, 0), (1, 0)),
        ("-Y 8 -X 16", (15, 0), (14, 0)),
        ("+Y 8 +X 16", (0, 7), (1, 7)),
        ("+Y 8 -X 16", (15, 7), (14, 7)),
        ("+X 16 -Y 8", (0, 0), (0, 1)),
        ("+X 16 +Y 8", (0, 7), (0, 6)),
        ("-X 16 -Y 8", (15, 0), (15, 1)),
        ("-X 16 +Y 8", (15, 7), (15, 6)),
    ] {
        // Walk the file: along a scanline by the step to the second pixel, then on to the next line.
        let step = (second.0 - first.0, second.1 - first.1);
        let by_columns = step.0 == 0;
        let (lines, length) = if by_columns { (width, height) } else { (height, width) };
        let line_step: (i32, i32) = if by_columns {
            (if first.0 == 0 { 1 } else { -1 }, 0)
        } else {
            (0, if first.1 == 0 { 1 } else { -1 })
        };
        let scanned: Vec<Rgb> = (0..lines as i32)
            .flat_map(|line| (0..length as i32).map(move |at| (line, at)))
            .map(|(line, at)| {
                let x = first.0 + line * line_step.0 + at * step.0;
                let y = first.1 + line * line_step.1 + at * step.1;
                upright[(y * width as i32 + x) as usize]
            })
            .collect();
        let loaded = read("a.hdr", &radiance(RGBE, resolution, &scanned)).unwrap();
        assert_panorama(&loaded, (width, height), &upright);
    }
}

#[test]
fn exposures_multiply_and_divide_the_values() {
    let pixels = numbered(4, 2);
    let lines = format!("{RGBE}EXPOSURE=2\nEXPOSURE=4\nCOLORCORR=1 2 0.5\n");
    let loaded = read("a.hdr", &radiance(&lines, "-Y 2 +X 4", &pixels)).unwrap();
    let wanted: Vec<Rgb> = pixels.iter().map(|[r, g, b]| [r / 8.0, g / 16.0, b / 4.0]).collect();
    assert_texels(loaded.environment.texels(), &wanted);
    assert_eq!(loaded.format, "Radiance RGBE, exposure divided out");

    for line in ["EXPOSURE=0", "EXPOSURE=nonsense", "EXPOSURE=-1", "COLORCORR=1 2"] {
        let text = error_of(read("a.hdr", &radiance(&format!("{line}\n"), "-Y 2 +X 4", &pixels)));
        assert_eq!(
            text,
            format!("a.hdr: the header line {line} does not give positive numbers; fix or remove it")
        );
    }
}

#[test]
fn xyze_becomes_rgb_with_its_white_kept() {
    let grey = vec![[2.0; 3]; 8];
    let loaded = read("a.hdr", &radiance("FORMAT=32-bit_rle_xyze\n", "-Y 2 +X 4", &grey)).unwrap();
    for texel in loaded.environment.texels() {
        assert!(texel.iter().all(|value| (value - 2.0).abs() < 1e-5), "equal energy is grey: {texel:?}");
    }
    assert_eq!(loaded.format, "Radiance XYZE");
    // More X than white is red.
    let loaded = read("a.xyze", &radiance("FORMAT=32-bit_rle_xyze\n", "-Y 1 +X 2", &[[1.25, 1.0, 1.0]; 2]));
    let texel = loaded.unwrap().environment.texels()[0];
    assert!(texel[0] > texel[1] && texel[0] > texel[2], "{texel:?}");
}

#[test]
fn primaries_are_converted_with_a_warning() {
    let pixels = vec![[1.0; 3]; 2];
    let lines = "PRIMARIES=0.708 0.292 0.17 0.797 0.131 0.046 0.3127 0.329\n";
    let loaded = read("a.hdr", &radiance(lines, "-Y 1 +X 2", &pixels)).unwrap();
    assert_eq!(loaded.warnings, ["its PRIMARIES are not Rec. 709; converted"]);
    let loaded = read("a.hdr", &radiance("PRIMARIES=0 0 0 0 0 0 0 0\n", "-Y 1 +X 2", &pixels)).unwrap();
    assert_eq!(loaded.warnings, ["its PRIMARIES are degenerate; ignored"]);
    assert_texels(loaded.environment.texels(), &pixels);
}

#[test]
fn bad_headers_are_named() {
    let pixels = numbered(4, 2);
    for (bytes, wanted) in [
        (
            radiance("FORMAT=16-bit_floats\n", "-Y 2 +X 4", &pixels),
            "a.hdr: FORMAT=16-bit_floats is not supported; 32-bit_rle_rgbe and 32-bit_rle_xyze are",
        ),
        (
            radiance("", "-Y 2 +Y 4", &pixels),
            "a.hdr: the resolution line \"-Y 2 +Y 4\" is not like \"-Y 256 +X 512\"",
        ),
        (
            b"#?RADIANCE\nFORMAT=32-bit".to_vec(),
            "a.hdr: truncated: the Radiance header does not end; copy it again",
        ),
        (radiance("", "-Y 0 +X 4", &[]), "a.hdr: 4x0 has no pixels"),
        (
            radiance("", "-Y 4000000000 +X 8000000000", &pixels),
            "a.hdr: the resolution line \"-Y 4000000000 +X 8000000000\" has more pixels than can be read",
        ),
        (
            radiance("", "-Y 2000 +X 4000", &pixels),
            "a.hdr: truncated: 32 bytes cannot hold the 2000 scanlines of its header; copy it again",
        ),
    ] {
        assert_eq!(error_of(read("a.hdr", &bytes)), wanted);
    }
}

/// A picture of twice as many columns as rows, each of which is `data`.
fn scanlines(columns: usize, data: &[u8]) -> Vec<u8> {
    let rows = columns / 2;
    let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {rows} +X {columns}\n");
    [header.as_bytes(), &data.repeat(rows)].concat()
}

#[test]
fn pixels_that_repeat_are_counted_in_powers_of_256() {
    let data = [128, 64, 32, 129, 1, 1, 1, 2, 1, 1, 1, 1, 1, 1, 1, 0, 2, 2, 2, 129];
    let columns = 1 + 2 + 256 + 1;
    let texels = read("a.hdr", &scanlines(columns, &data)).unwrap().environment.texels().to_vec();
    for row in texels.chunks(columns) {
        assert_eq!(row[..columns - 1], vec![[1.0, 0.5, 0.25]; columns - 1]);
        assert_eq!(row[columns - 1], [2.0 / 128.0; 3]);
    }
}

#[test]
fn corrupt_scanlines_are_errors() {
    let planes = |length: u8, code: &[u8]| [&[2, 2, 0, length], code].concat();
    for (data, wanted) in [
        (planes(8, &[128 + 9, 1]), "a.hdr: corrupt: scanline 0 has a run beyond its end; re-export the file"),
        (planes(8, &[9, 1, 1, 1, 1, 1, 1, 1, 1, 1]), "scanline 0 has a run beyond its end"),
        (planes(9, &[128 + 8, 1]), "scanline 0 has another length than the picture"),
        (planes(8, &[128 + 8, 1, 128 + 8]), "scanline 0 has a run beyond its end"),
        (vec![1, 1, 1, 4], "scanline 0 repeats a pixel beyond its ends"),
        (vec![9, 9, 9, 128, 1, 1, 1, 8], "scanline 0 repeats a pixel beyond its ends"),
        // The unit overflows.
        ([&[9, 9, 9, 128][..], &[1, 1, 1, 0].repeat(9), &[1, 1, 1, 9]].concat(), "repeats a pixel beyond"),
    ] {
        let text = error_of(read("a.hdr", &scanlines(8, &data)));
        assert!(text.contains(wanted), "{text} for {data:?}");
    }
    let whole = scanlines(8, &planes(8, &[128 + 8, 1].repeat(4)));
    assert!(read("a.hdr", &whole).is_ok());
    for length in whole.len() - 30..whole.len() {
        let text = error_of(read("a.hdr", &whole[..length]));
        assert_eq!(
            text,
            format!("a.hdr: truncated: the Radiance HDR data ends after {length} bytes; copy it again")
        );
    }
}
