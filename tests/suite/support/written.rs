//! Shared code of the writers' tests: chains of distinct texels, and readers.

use exr::prelude::{ReadChannels as _, ReadLayers as _, read};
use half::f16;
use octagloss::internals::chain::{Chain, Level};
use octagloss::internals::environment::{Layout, Rgb};
use octagloss::internals::format::HALF_MAX;
use std::fs;
use std::io::Cursor;
use std::path::Path;

/// A number in [0, 1) determined by `seed` (splitmix64).
pub(crate) fn noise(seed: u64) -> f32 {
    let mut z = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32
}

/// Distinct texels, over ten octaves.
pub(crate) fn texels(count: usize, seed: u64) -> Vec<Rgb> {
    (0..count as u64)
        .map(|at| [0, 1, 2].map(|c| (noise(seed * 1_000_003 + at * 3 + c) * 10.0 - 5.0).exp2()))
        .collect()
}

pub(crate) fn chain(size: u32, levels: u32, bounds: bool) -> Chain {
    let level = |index: u32| {
        let size = size >> index;
        let count = 6 * (size * size) as usize;
        Level {
            layout: Layout::Cube { size },
            roughness: f64::from(index) / f64::from(levels.max(2) - 1),
            texels: texels(count, u64::from(index)),
            bounds: bounds.then(|| (0..count).map(|at| noise(at as u64) * 1e-3).collect()),
        }
    };
    Chain { levels: (0..levels).map(level).collect() }
}

pub(crate) fn metadata() -> Vec<(String, String)> {
    [
        ("octaglossLobe", "ggx"),
        ("octaglossFilter", "adaptive:0.005"),
        ("octaglossSpace", "right-handed, y up"),
    ]
    .map(|(key, value)| (key.to_owned(), value.to_owned()))
    .to_vec()
}

pub(crate) fn to_half(texel: Rgb) -> Rgb {
    texel.map(|c| f16::from_f32(c.min(HALF_MAX)).to_f32())
}

/// Index of the first texel that differs.
pub(crate) fn first_difference(a: &[Rgb], b: &[Rgb]) -> Option<usize> {
    assert_eq!(a.len(), b.len(), "images of one size");
    assert!(!a.is_empty(), "something to compare");
    (0..a.len()).find(|at| a[*at] != b[*at])
}

/// The samples of the named channels as f32, read by the `exr` crate.
pub(crate) fn read_exr(
    bytes: &[u8],
    names: &[&str],
) -> (usize, usize, Vec<Vec<f32>>, exr::meta::header::LayerAttributes) {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .expect("the exr crate reads it");
    let layer = image.layer_data;
    let channels = &layer.channel_data.list;
    assert_eq!(channels.len(), names.len());
    let planes = names
        .iter()
        .map(|name| {
            let channel = channels.iter().find(|c| c.name.eq(name)).expect("the channel is there");
            channel.sample_data.values_as_f32().collect()
        })
        .collect();
    (layer.size.x(), layer.size.y(), planes, layer.attributes)
}

pub(crate) fn read_exr_rgb(bytes: &[u8]) -> Vec<Rgb> {
    let (_, _, planes, _) = read_exr(bytes, &["R", "G", "B"]);
    (0..planes[0].len()).map(|at| [planes[0][at], planes[1][at], planes[2][at]]).collect()
}

pub(crate) fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Decodes RGBD. A divisor of 0 is read as 1, the minimum.
pub(crate) fn rgb_from_rgbd([r, g, b, divisor]: [u8; 4]) -> Rgb {
    let divisor = f64::from(divisor.max(1)) / 255.0;
    [r, g, b].map(|code| ((f64::from(code) / 255.0).powf(2.2) / divisor) as f32)
}

/// Decodes RGBP.
pub(crate) fn rgb_from_rgbp([r, g, b, scale]: [u8; 4]) -> Rgb {
    let scale = 8.0 - 7.0 * f64::from(scale) / 255.0;
    [r, g, b].map(|code| (f64::from(code) / 255.0 * scale).powi(2) as f32)
}
