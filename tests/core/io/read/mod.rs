//! Inputs: every format, orientation and layout, every repair, and every error text.

mod errors;
mod exr;
mod ktx2;
mod layouts;
mod map_header;
mod radiance;
mod repairs;

use octagloss_core::common::error::Result;
use octagloss_core::files::io::{self, Loaded, ReadOptions};
use octagloss_core::light::environment::Layout;
use octagloss_fixtures::files::inputs::Rgb;
use std::path::Path;

/// Reads `bytes` as a file called `name`.
fn read(name: &str, bytes: &[u8]) -> Result<Loaded> {
    read_with(name, bytes, &ReadOptions::default())
}

fn read_with(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Loaded> {
    io::read_from_memory(Path::new(name), bytes, options)
}

/// Returns the one line of the error.
fn error_of(outcome: Result<Loaded>) -> String {
    let text = outcome.expect_err("an error was expected").to_string();
    assert_eq!(text.lines().count(), 1, "one line: {text}");
    text
}

/// Asserts that `loaded` is a panorama of exactly `pixels`.
#[track_caller]
fn assert_panorama(loaded: &Loaded, size: (u32, u32), pixels: &[Rgb]) {
    assert_eq!(loaded.environment.layout(), Layout::Panorama { width: size.0, height: size.1 }, "the layout");
    assert_texels(loaded.environment.texels(), pixels);
}

/// Asserts equality to the last bit, naming the first texel that differs.
#[track_caller]
fn assert_texels(got: &[Rgb], wanted: &[Rgb]) {
    assert!(!wanted.is_empty(), "something must be compared");
    assert_eq!(got.len(), wanted.len(), "texels in all");
    if let Some(at) = (0..got.len()).find(|&at| got[at] != wanted[at]) {
        panic!("texel {at} is {:?}, {:?} was expected", got[at], wanted[at]);
    }
}

#[test]
#[should_panic(expected = "texel 3 is")]
fn assert_texels_detects_one_wrong_texel() {
    let pixels = octagloss_fixtures::files::inputs::numbered(4, 2);
    let mut wrong = pixels.clone();
    wrong[3][1] += 0.5;
    assert_texels(&wrong, &pixels);
}
