//! Sheen levels, interpolated where texels are much finer than the lobe.

use octagloss_core::bake::{BakeSettings, bake};
use octagloss_core::light::environment::Layout;
use octagloss_core::lobe::Lobe;
use octagloss_fixtures::common::environment;

/// One sun: its ring of reflections has kinks, which no cubic follows.
#[test]
fn interpolated_sheen_is_that_of_every_texel() {
    let layout = Layout::Panorama { width: 64, height: 32 };
    let mut texels = vec![[0.0; 3]; layout.texel_count()];
    texels[12 * 64 + 20] = [9.0, 4.0, 1.0];
    let sun = environment(layout, texels);
    let (error, size) = (0.005, 256);
    let settings = BakeSettings { size, levels: Some(1), sheen: true, ..BakeSettings::default() };
    let baked = bake(&sun, &settings).expect("a bake");
    let (sheen, stats) = (&baked.sheen.as_ref().expect("sheen").levels[0], &baked.sheen_stats[0]);
    // On its own the lobe is interpolated, too, but where bounds are asked for.
    let alone = BakeSettings { lobe: Lobe::Charlie, sheen: false, ..settings };
    let same = bake(&sun, &alone).expect("a bake");
    assert!(same.chain.levels[0] == *sheen && same.stats[0].error_bound_max.is_none());
    let alone = bake(&sun, &BakeSettings { bounds: true, ..alone }).expect("a bake");
    let every = &alone.chain.levels[0];
    let pairs = || sheen.texels.iter().zip(&every.texels);
    for c in 0..3 {
        let (mut off, mut power) = (0.0, 0.0);
        for (ours, exact) in pairs() {
            off += (f64::from(ours[c]) - f64::from(exact[c])).powi(2);
            power += f64::from(exact[c]).powi(2);
        }
        let rmse = (off / power).sqrt();
        // Sheen has twice the tolerance; both err to the same side.
        assert!(rmse < 2.0 * error, "channel {c}: relRMSE {rmse}");
    }
    let differing = pairs().filter(|(ours, exact)| ours != exact).count();
    assert!(differing > sheen.texels.len() / 4, "{differing} texels are interpolated");
    assert!(stats.error_bound_max.is_none() && alone.stats[0].error_bound_max.is_some(), "bounds");
    let work = [stats, &alone.stats[0]].map(|stats| stats.leaves_per_texel.expect("quadrature"));
    assert!(work[0] < 0.9 * work[1], "leaves per texel: {work:?}");
}

/// Constant light is constant, up to the edges of faces.
#[test]
fn interpolated_sheen_of_a_furnace_is_white() {
    let layout = Layout::Panorama { width: 16, height: 8 };
    let furnace = environment(layout, vec![[1.0; 3]; layout.texel_count()]);
    let settings = BakeSettings { size: 256, levels: Some(1), sheen: true, ..BakeSettings::default() };
    let baked = bake(&furnace, &settings).expect("a bake");
    let sheen = &baked.sheen.as_ref().expect("sheen").levels[0];
    // The least radiance is subtracted first and nothing is left; weights add up to 1 in double precision.
    let off = |value: &f32| (value - 1.0).abs() > f32::EPSILON;
    assert_eq!(sheen.texels.as_flattened().iter().position(off), None, "a texel is not white");
}
