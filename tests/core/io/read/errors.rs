//! Unreadable files: each has its own one-line error.

use super::{error_of, read, read_with};
use exr::prelude::Compression;
use octagloss_core::common::error::Error;
use octagloss_core::files::io::{self, ReadOptions};
use octagloss_fixtures::files::inputs::{Sample, exr_rgb, ldr, numbered, radiance, radiance_with_runs};
#[cfg(unix)]
use std::path::Path;

fn hdr() -> Vec<u8> {
    radiance_with_runs(32, 16, &numbered(32, 16))
}

fn exr() -> Vec<u8> {
    exr_rgb((32, 16), Sample::Half, Compression::ZIP16, &numbered(32, 16))
}

fn ldr_of(format: image::ImageFormat) -> Vec<u8> {
    let pixels: Vec<[u8; 3]> =
        (0..512u32).map(|at| [(at * 7) as u8, (at * 13) as u8, (at / 3) as u8]).collect();
    ldr(32, 16, format, &pixels)
}

#[test]
fn truncation_is_reported_at_every_length_past_the_header() {
    for (name, format, bytes, from) in [
        ("a.hdr", "Radiance HDR", hdr(), 200),
        ("a.exr", "OpenEXR", exr(), 12),
        ("a.png", "PNG", ldr_of(image::ImageFormat::Png), 60),
        ("a.jpg", "JPEG", ldr_of(image::ImageFormat::Jpeg), 3),
    ] {
        assert!(read(name, &bytes).is_ok(), "{name} is sound");
        for length in [from, (from + bytes.len()) / 2, bytes.len() - 20] {
            assert_eq!(
                error_of(read(name, &bytes[..length])),
                format!("{name}: truncated: the {format} data ends after {length} bytes; copy it again")
            );
        }
    }
}

#[test]
fn a_png_without_pixels_is_refused() {
    let mut bytes = ldr_of(image::ImageFormat::Png);
    bytes[16..20].fill(0);
    assert_eq!(error_of(read("a.png", &bytes)), "a.png: 0x16 has no pixels");
}

#[test]
fn empty_and_foreign_files_are_refused() {
    assert_eq!(error_of(read("a.hdr", b"")), "a.hdr: the file is empty (0 bytes)");
    assert_eq!(
        error_of(read("a.hdr", b"Dear diary,")),
        "a.hdr: not an image that can be read; Radiance .hdr, OpenEXR, KTX, KTX2, DDS, PNG and JPEG can, by \
         their content"
    );
}

#[test]
fn misnamed_files_are_read_by_their_content_with_a_warning() {
    for (name, warning) in [
        ("a.exr", "named .exr but holds Radiance HDR; read by its content"),
        ("A.PNG", "named .png but holds Radiance HDR; read by its content"),
        ("a.tiff", "named .tiff but holds Radiance HDR; read by its content"),
    ] {
        assert_eq!(read(name, &hdr()).unwrap().warnings, [warning]);
    }
    for fitting in ["a.hdr", "a.HDR", "a.pic", "a", "a.download"] {
        assert!(read(fitting, &hdr()).unwrap().warnings.is_empty(), "{fitting}");
    }
}

#[test]
fn promises_of_more_pixels_than_memory_are_refused_before_anything_is_allocated() {
    let small = ReadOptions { memory_limit: 4000, ..ReadOptions::default() };
    for (name, bytes) in [
        ("a.hdr", hdr()),
        ("a.exr", exr_rgb((32, 16), Sample::Half, Compression::RLE, &vec![[1.0; 3]; 512])),
        ("a.png", ldr(32, 16, image::ImageFormat::Png, &[[9; 3]; 512])),
    ] {
        let Err(Error::Limit { what, needed, available, .. }) = read_with(name, &bytes, &small) else {
            panic!("{name} must not fit into 4000 bytes");
        };
        assert_eq!((what, available), (format!("{name}: an image of 32x16 pixels"), 4000));
        assert!(needed >= 512 * 12, "{name}: {needed}");
    }
    // Headers of a few bytes that promise terabytes.
    let vast = radiance("", "-Y 500000 +X 1000000", &[]);
    assert_eq!(
        error_of(read("a.hdr", &vast)),
        "a.hdr: an image of 1000000x500000 pixels needs 6000000000033 bytes and the limit is 3221225472; \
         scale it down first"
    );
}

#[test]
fn missing_files_and_directories_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().display().to_string();
    let options = ReadOptions::default();
    let none = folder.path().join("none.hdr");
    // In the system's words.
    let missing = std::io::Error::from_raw_os_error(2);
    assert_eq!(error_of(io::read(&none, &options)), format!("{}: {missing}", none.display()));
    assert_eq!(
        error_of(io::read(folder.path(), &options)),
        format!(
            "{place}: a directory without a report.json; give an image, or a level folder that octagloss \
             bake wrote"
        )
    );
}

#[cfg(unix)]
#[test]
fn devices_are_refused() {
    let options = ReadOptions::default();
    assert_eq!(
        error_of(io::read(Path::new("/dev/null"), &options)),
        "/dev/null: a device, not a regular file; copy its content to a file first"
    );
}

/// Root can read every file, so the error is made as the system would report it.
#[cfg(unix)]
#[test]
fn refused_permission_is_named() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.hdr");
    std::fs::write(&path, hdr()).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
    let wanted = format!("{}: Permission denied (os error 13)", path.display());
    if std::fs::File::open(&path).is_ok() {
        let denied = Error::io(&path, std::io::Error::from_raw_os_error(13));
        assert_eq!(denied.to_string(), wanted, "the text");
    } else {
        assert_eq!(error_of(io::read(&path, &ReadOptions::default())), wanted);
    }
}

/// Every kind of damage yields a one-line error: no decoder's newline passes through.
#[test]
fn corrupt_blocks_end_in_one_line() {
    for compression in [Compression::ZIP16, Compression::PIZ, Compression::DWAB(None), Compression::B44] {
        let sound = exr_rgb((32, 16), Sample::Half, compression, &numbered(32, 16));
        for from_end in (1..200).step_by(7) {
            let mut bytes = sound.clone();
            let at = bytes.len() - from_end.min(bytes.len() / 3);
            bytes[at] ^= 0x55;
            if let Err(error) = read("a.exr", &bytes) {
                assert_eq!(error.to_string().lines().count(), 1, "{error}");
            }
        }
    }
}
