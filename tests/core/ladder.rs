//! Default sizes and level counts, and their accuracy at look-ups between texels and levels.

use octagloss_core::analysis::oracle::Oracle;
use octagloss_core::bake::{BakeSettings, bake};
use octagloss_core::files::target::Target;
use octagloss_core::light::chain_lookup::ChainLookup;
use octagloss_core::light::environment::{Environment, Layout, Map};
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::ladder::Ladder;
use octagloss_fixtures::common::Random;

#[test]
fn the_linear_ladder_ends_where_look_ups_are_exact_enough() {
    let levels = |size| Ladder::Linear.default_levels(Map::Cube, size);
    let expected = [
        (1, 1),
        (2, 2),
        (4, 3),
        (8, 3),
        (16, 4),
        (32, 5),
        (64, 5),
        (128, 6),
        (256, 7),
        (512, 8),
        (640, 8),
        (1024, 8),
        (1280, 9),
        (2048, 9),
        (16_384, 12),
    ];
    for (size, count) in expected {
        assert_eq!(levels(size), count, "{size}");
    }
    for size in 1..2000 {
        let settings = BakeSettings { size, ..BakeSettings::default() };
        let specs = settings.level_specs().expect("a default for every size");
        assert_eq!(
            specs.last().map(|spec| spec.roughness),
            Some(if size == 1 { 0.0 } else { 1.0 }),
            "{size}"
        );
        for map in [Map::Panorama, Map::Octahedral] {
            assert!(
                BakeSettings { map, size, ..BakeSettings::default() }.level_specs().is_ok(),
                "{map:?} {size}"
            );
        }
    }
    // Other maps match a cube's resolution at two and three times its edge, also by default.
    assert_eq!(BakeSettings::default().size, 640);
    for (map, edges) in [(Map::Cube, 1), (Map::Panorama, 2), (Map::Octahedral, 3)] {
        assert_eq!(Ladder::Linear.default_size(map, Lobe::Ggx), edges * 640);
        assert_eq!(Ladder::Linear.default_levels(map, edges * 640), 8);
    }
    // The ladders of engines keep their defaults.
    for (ladder, count) in [(Ladder::Filament, 5), (Ladder::Unity, 7), (Ladder::Babylon, 9)] {
        assert_eq!(ladder.default_size(Map::Cube, Lobe::Ggx), 256);
        assert_eq!(ladder.default_levels(Map::Cube, 256), count);
    }
    let target = |name| Target::named(name).expect("a target");
    assert_eq!((target("generic").size, target("generic").levels(640)), (640, 8));
    for (name, count) in [
        ("three", 6),
        ("filament", 5),
        ("bevy", 7),
        ("khronos", 8),
        ("babylon", 9),
        ("gltf-ext", 5),
        ("unity", 7),
    ] {
        assert_eq!((target(name).size, target(name).levels(256)), (256, count), "{name}");
    }
}

/// Returns the relative RMS error of luminance-like sums for look-ups at `roughness` in a chain of `levels`
/// levels from 64 texels.
fn delivered(world: &Environment, levels: Option<u32>, roughness: f64) -> f64 {
    let settings = BakeSettings { size: 64, levels, ..BakeSettings::default() };
    let chain = bake(world, &settings).expect("a bake").chain;
    let oracle = Oracle::new(world);
    let place = roughness * (chain.levels.len() - 1) as f64;
    let lookup = ChainLookup::new(&chain.levels);
    let mut random = Random::new(5);
    let (mut errors, mut sum) = (0.0, 0.0);
    for _ in 0..200 {
        let direction = random.direction();
        let exact: f64 = oracle.reflect(Lobe::Ggx, roughness, direction).expect("valid").iter().sum();
        let found = lookup.read(direction, place).iter().sum::<f64>();
        errors += (found - exact).powi(2);
        sum += exact;
    }
    (errors / 200.0).sqrt() / (sum / 200.0)
}

#[test]
fn rough_look_ups_of_the_default_chain_are_exact_where_all_levels_down_to_one_texel_are_not() {
    let layout = Layout::Panorama { width: 32, height: 16 };
    let mut texels = vec![[0.2; 3]; layout.texel_count()];
    texels[5 * 32 + 9] = [500.0; 3];
    let world = Environment::new(layout, texels).expect("valid");
    for roughness in [0.9, 1.0] {
        let (own, all) = (delivered(&world, None, roughness), delivered(&world, Some(7), roughness));
        assert!(own < 0.1 && all > 0.2, "roughness {roughness}: {own}, and {all} down to one texel");
    }
}
