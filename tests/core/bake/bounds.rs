//! Certified bounds of baked texels, against bakes by exhaustive integration.

use octagloss_core::bake::{BakeSettings, bake};
use octagloss_core::light::chain::ChainKind;
use octagloss_core::light::environment::{Layout, Map, exact_luminance};
use octagloss_core::lobe::filter::Filter;
use octagloss_fixtures::common::{Look, Random, environment, texels};

/// The greatest error of a texel's luminance over its bound, per level. The first level's texels are nearly
/// as wide as their lobes, and so means over several directions; the second's are not. Exhaustive bakes turn
/// the world by `degrees`.
fn errors_over_bounds(map: Map, look: Look, degrees: f64) -> Vec<f64> {
    let layout = Layout::Panorama { width: 32, height: 16 };
    let world = environment(layout, texels(&mut Random::new(11), look, layout));
    let settings = |filter| BakeSettings {
        map,
        size: 8,
        levels: Some(3),
        chain: Some(ChainKind::Sampled),
        bounds: filter != Filter::Reference,
        filter,
        measure: false,
        ..BakeSettings::default()
    };
    let baked = bake(&world, &settings(Filter::default())).expect("a bake");
    let turned = world.rotated_y(degrees).expect("an angle");
    let exact = bake(&turned, &settings(Filter::Reference)).expect("a bake");
    let levels = baked.chain.levels.iter().zip(&exact.chain.levels).skip(1);
    levels
        .map(|(level, exact)| {
            let bounds = level.bounds.as_ref().expect("bounds");
            let pairs = level.texels.iter().zip(&exact.texels).zip(bounds);
            pairs
                .map(|((found, exact), bound)| {
                    let off: [f64; 3] = std::array::from_fn(|c| f64::from(found[c]) - f64::from(exact[c]));
                    // The exhaustive texel is rounded.
                    let rounded = 1e-6 * exact_luminance(exact.map(f64::from));
                    exact_luminance(off).abs() / (f64::from(*bound) + rounded).max(f64::MIN_POSITIVE)
                })
                .fold(0.0, f64::max)
        })
        .collect()
}

#[test]
fn baked_texels_are_within_their_bounds_of_exhaustive_ones() {
    let cubes = [Look::Suns, Look::Lone].map(|look| (Map::Cube, look));
    for (map, look) in cubes.into_iter().chain([(Map::Panorama, Look::Suns), (Map::Octahedral, Look::Lone)]) {
        let found = errors_over_bounds(map, look, 0.0);
        println!("{map:?}, {look:?}: {found:.3?}");
        assert!(found.iter().all(|error| *error <= 1.0), "{map:?}, {look:?}: {found:?} of the bounds");
    }
    let seen = errors_over_bounds(Map::Cube, Look::Suns, 2.0);
    assert!(seen.iter().any(|error| *error > 1.0), "a turned world is seen: {seen:?}");
}
