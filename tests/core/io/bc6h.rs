//! BC6H, decoded by another crate than the encoder.

use half::f16;
use octagloss_core::bake::{BakeSettings, bake};
use octagloss_core::files::format::bc6h::bc6h_blocks;
use octagloss_core::light::chain::Level;
use octagloss_core::light::environment::Rgb;
use octagloss_core::light::synth::synth;

/// Encoded bytes of a square of `size` x `size` texels.
fn length(size: u32) -> usize {
    size.div_ceil(4).pow(2) as usize * 16
}

/// Decodes one `size` x `size` square of blocks by `bcdec_rs`.
pub(crate) fn decoded(size: u32, blocks: &[u8]) -> Vec<Rgb> {
    let (n, across) = (size as usize, (size as usize).div_ceil(4));
    let mut texels = vec![[0.0; 3]; n * n];
    for (index, block) in blocks.chunks_exact(16).enumerate() {
        let mut rgb = [0.0_f32; 48];
        bcdec_rs::bc6h_float(block, &mut rgb, 12, false);
        for (at, texel) in rgb.chunks_exact(3).enumerate() {
            let (x, y) = (index % across * 4 + at % 4, index / across * 4 + at / 4);
            if x < n && y < n {
                texels[y * n + x] = [texel[0], texel[1], texel[2]];
            }
        }
    }
    texels
}

/// Encodes and decodes all six faces of a level.
pub(crate) fn through(level: &Level) -> Vec<Rgb> {
    let blocks = bc6h_blocks(level.size(), &level.texels);
    assert_eq!(blocks.len(), 6 * length(level.size()));
    blocks.chunks_exact(length(level.size())).flat_map(|face| decoded(level.size(), face)).collect()
}

/// Returns the PSNR in decibels of log2 of every channel; the peak is the range of the level itself.
pub(crate) fn log_psnr(exact: &[Rgb], stored: &[Rgb]) -> f64 {
    let stops = |v: f32| f64::from(v.max(1e-6)).log2();
    let channels = |texels: &[Rgb]| texels.as_flattened().iter().map(|v| stops(*v)).collect::<Vec<_>>();
    let (exact, stored) = (channels(exact), channels(stored));
    assert!(exact.len() == stored.len() && !exact.is_empty(), "something to compare");
    let least = exact.iter().copied().fold(f64::INFINITY, f64::min);
    let most = exact.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let noise = exact.iter().zip(&stored).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / exact.len() as f64;
    10.0 * ((most - least).powi(2) / noise).log10()
}

#[test]
fn baked_levels_keep_their_log_psnr() {
    let settings = BakeSettings { size: 64, levels: Some(4), ..BakeSettings::default() };
    for (name, least) in [("sky", [63.0, 54.0, 47.0, 40.0]), ("studio", [53.0, 49.0, 43.0, 38.0])] {
        let baked = bake(&synth(name).unwrap(), &settings).unwrap();
        for (level, least) in baked.chain.levels.iter().zip(least) {
            let stored = through(level);
            let psnr = log_psnr(&level.texels, &stored);
            println!("{name} {}: {psnr:.1} dB", level.size());
            assert!(psnr > least, "{name} level of {}: {psnr:.1} dB", level.size());
        }
    }
}

#[test]
fn levels_smaller_than_a_block_and_odd_ones_are_padded() {
    for size in [1, 2, 3, 5, 7] {
        let texels: Vec<Rgb> = (0..6 * size * size).map(|k| [(k / (size * size)) as f32 + 1.0; 3]).collect();
        let level = Level::cube(size, 0.0, texels.clone());
        // One value per face, so padding must repeat that value.
        for (stored, exact) in through(&level).iter().zip(&texels) {
            assert!((stored[0] / exact[0] - 1.0).abs() < 0.01, "{size}: {stored:?} for {exact:?}");
        }
    }
}

#[test]
fn the_measure_detects_one_wrong_texel() {
    let texels: Vec<Rgb> = (0..16).map(|k| [f16::from_f32(1.0 + k as f32).to_f32(); 3]).collect();
    let mut wrong = texels.clone();
    wrong[7][1] *= 2.0;
    assert!(log_psnr(&texels, &wrong) < 40.0);
    assert!(log_psnr(&texels, &texels).is_infinite());
}
