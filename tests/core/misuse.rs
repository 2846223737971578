//! Calls of the library that break its preconditions: each is an error that says what is wrong.

use glam::{DVec2, DVec3};
use octagloss_core::analysis::extraction::{Suns, extract};
use octagloss_core::analysis::oracle::Oracle;
use octagloss_core::bake::query::Query;
use octagloss_core::bake::{Bake, BakeSettings, bake};
use octagloss_core::common::error::Error;
use octagloss_core::cpu::reflector::{Reflector, ReflectorSettings, Workspace};
use octagloss_core::files::export::produce::{Baked, check_memory, produce, products};
use octagloss_core::files::export::write::WriteOptions;
use octagloss_core::files::format::Pixel;
use octagloss_core::files::recipe::source::Source;
use octagloss_core::files::recipe::{InputOptions, Recipe};
use octagloss_core::files::target::Target;
use octagloss_core::light::environment::{Environment, Layout, Map, Rgb};
use octagloss_core::light::sh::scale::{ShScale, scaled};
use octagloss_core::light::sh::spherical_harmonics;
use octagloss_core::light::sh::window::ShWindow;
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::Filter;
use octagloss_core::lobe::ladder::Ladder;
use octagloss_core::sphere::map::Place;
use octagloss_core::sphere::registry::MAPS;
use octagloss_shaders::reader;

const GREY: Layout = Layout::Panorama { width: 16, height: 8 };

fn grey() -> Environment {
    Environment::new(GREY, vec![[0.5; 3]; 128]).expect("a valid environment")
}

/// The message of an [`Error::Parameter`].
fn refusal<T: std::fmt::Debug>(outcome: octagloss_core::common::error::Result<T>) -> String {
    match outcome {
        Err(Error::Parameter(message)) => message,
        other => panic!("not refused as a parameter: {other:?}"),
    }
}

/// Vectors that are no directions.
const NONE: [DVec3; 5] = [
    DVec3::ZERO,
    DVec3::new(f64::NAN, 0.0, 1.0),
    DVec3::new(1.0, f64::INFINITY, 0.0),
    DVec3::new(0.0, 0.0, f64::NEG_INFINITY),
    DVec3::NAN,
];

#[test]
fn vectors_without_a_direction_are_refused_by_every_filter() {
    let environment = grey();
    let settings = ReflectorSettings { oem_size: Some(32), ..ReflectorSettings::default() };
    let reflector = Reflector::new(&environment, &settings).unwrap();
    for filter in [Filter::Adaptive(0.01), Filter::Pyramid, Filter::Box, Filter::Reference] {
        for roughness in [0.0, 0.5] {
            for wrong in NONE {
                let message = refusal(reflector.query(wrong, roughness, Lobe::Ggx, filter));
                assert!(message.starts_with("direction 0 is ") && message.contains("not all 0"), "{message}");
                let both = [DVec3::Y, wrong];
                let message = refusal(reflector.query_all(&both, roughness, Lobe::Ggx, filter));
                assert!(message.starts_with("direction 1 is "), "{message}");
                let query = Query { lobe: Lobe::Ggx, filter, directions: &both, roughness: &[roughness; 2] };
                assert!(refusal(query.answered(&reflector)).starts_with("direction 1 is "));
            }
        }
    }
}

#[test]
fn directions_have_any_other_length() {
    let mut texels = vec![[0.1; 3]; 128];
    texels[40] = [50.0, 20.0, 5.0];
    let environment = Environment::new(GREY, texels).unwrap();
    let reflector = Reflector::new(&environment, &ReflectorSettings::default()).unwrap();
    let direction = DVec3::new(0.3, 0.7, -0.2);
    let ask = |direction| reflector.query(direction, 0.5, Lobe::Ggx, Filter::Adaptive(0.01)).unwrap();
    let expected = ask(direction);
    for length in [1e-320, 1e-200, 1e-3, 7.0, 1e200, 1e307] {
        let near = |answer: octagloss_core::lobe::filter::Answer| {
            (answer.radiance[0] / expected.radiance[0] - 1.0).abs() < 1e-3
        };
        assert!(near(ask(direction * length)), "{length:e}");
        let all = reflector.query_all(&[direction * length], 0.5, Lobe::Ggx, Filter::Adaptive(0.01)).unwrap();
        assert!(near(all[0]), "{length:e}");
    }
}

#[test]
fn queries_need_one_roughness_for_each_direction() {
    let environment = grey();
    let reflector = Reflector::new(&environment, &ReflectorSettings::default()).unwrap();
    let directions = [DVec3::X, DVec3::Y];
    let ask = |roughness: &[f64]| {
        let filter = Filter::Adaptive(0.01);
        refusal(Query { lobe: Lobe::Ggx, filter, directions: &directions, roughness }.answered(&reflector))
    };
    assert!(ask(&[0.5]).contains("2 directions and 1 numbers of roughness"));
    assert!(ask(&[]).contains("2 directions and 0 numbers"));
    for wrong in [f64::NAN, -0.1, 1.1, f64::INFINITY] {
        assert!(ask(&[0.5, wrong]).contains("outside [0, 1]"), "{wrong}");
        let answer = reflector.query(DVec3::X, wrong, Lobe::Cosine, Filter::Reference);
        assert!(refusal(answer).contains("outside [0, 1]"), "{wrong}");
    }
}

#[test]
fn environments_name_what_their_texels_lack() {
    let new = |layout: Layout, count: usize| refusal(Environment::new(layout, vec![[1.0; 3]; count]));
    let message = new(Layout::Panorama { width: 64, height: 32 }, 5);
    assert!(message.ends_with("requires 2048 texels, got 5"), "{message}");
    for empty in
        [Layout::Panorama { width: 0, height: 0 }, Layout::Cube { size: 0 }, Layout::Octahedral { size: 0 }]
    {
        let message = new(empty, 0);
        assert!(message.contains("of no texels") && message.contains("at least 1"), "{message}");
    }
    for (width, height) in [(3, 1), (1, 2), (4, 4), (0, 3), (u32::MAX, 1), (65, 32), (2, 0)] {
        let message = new(Layout::Panorama { width, height }, 3);
        assert!(message.starts_with(&format!("a panorama of {width}x{height} is not 2:1")), "{message}");
    }
    // More texels than an address space has.
    for huge in [
        Layout::Panorama { width: u32::MAX - 1, height: u32::MAX / 2 },
        Layout::Cube { size: u32::MAX },
        Layout::Octahedral { size: u32::MAX },
    ] {
        assert!(new(huge, 6).ends_with("got 6"), "{huge:?}");
    }
    for wrong in [f32::NAN, f32::INFINITY, -1.0, -f32::MIN_POSITIVE] {
        let texels: Vec<Rgb> = vec![[0.0; 3], [0.0, wrong, 0.0]];
        let message = refusal(Environment::new(Layout::Panorama { width: 2, height: 1 }, texels));
        assert!(message.starts_with("texel 1 is "), "{message}");
    }
    Environment::new(Layout::Panorama { width: 1, height: 1 }, vec![[1.0; 3]]).expect("one texel");
}

#[test]
fn rotations_by_no_number_are_refused() {
    for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let message = refusal(grey().rotated_y(wrong));
        assert!(message.contains("not finite"), "{message}");
    }
}

#[test]
fn settings_out_of_range_are_named() {
    let small = BakeSettings { size: 4, ..BakeSettings::default() };
    let of = |settings: BakeSettings| match bake(&grey(), &settings) {
        Err(Error::Parameter(message)) => message,
        Err(other @ Error::Limit { .. }) => other.to_string(),
        other => panic!("{settings:?}: {:?}", other.map(|bake| bake.stats)),
    };
    for (settings, named) in [
        (BakeSettings { size: 0, ..small.clone() }, "`size`"),
        (BakeSettings { size: u32::MAX, ..small.clone() }, "`size`"),
        (BakeSettings { levels: Some(0), ..small.clone() }, "`levels`"),
        (BakeSettings { levels: Some(u32::MAX), ..small.clone() }, "`levels`"),
        (BakeSettings { oem_size: Some(0), ..small.clone() }, "`oem_size`"),
        (BakeSettings { oem_size: Some(u32::MAX), ..small.clone() }, "`oem_size`"),
        (BakeSettings { border: Some(u32::MAX), ..small.clone() }, "`border`"),
        (BakeSettings { irradiance: Some(0), ..small.clone() }, "`irradiance`"),
        (BakeSettings { irradiance: Some(u32::MAX), ..small.clone() }, "`irradiance`"),
        (BakeSettings { skybox: Some(0), ..small.clone() }, "`skybox`"),
        (BakeSettings { skybox: Some(u32::MAX), ..small.clone() }, "`skybox`"),
        (BakeSettings { sh_order: u32::MAX, ..small.clone() }, "`sh_order`"),
        (BakeSettings { sh_window: ShWindow::Hanning(f64::NAN), ..small.clone() }, "`sh_window`"),
        (BakeSettings { sh_window: ShWindow::Lanczos(f64::INFINITY), ..small.clone() }, "`sh_window`"),
        (BakeSettings { sh_window: ShWindow::Sinc4(0.0), ..small.clone() }, "`sh_window`"),
        (BakeSettings { filter: Filter::Adaptive(f64::NAN), ..small.clone() }, "adaptive:NaN"),
        (BakeSettings { filter: Filter::Adaptive(0.0), ..small.clone() }, "adaptive:0"),
        (
            BakeSettings { filter: Filter::Pyramid, oem_size: Some(48), ..small.clone() },
            "48 texels has no pyramid",
        ),
    ] {
        let message = of(settings);
        assert!(message.contains(named), "{named}: {message}");
    }
}

#[test]
fn reflectors_name_a_roughness_out_of_range() {
    for sharpest in [-0.1, 1.5, f64::NAN] {
        let settings = ReflectorSettings { sharpest, ..ReflectorSettings::default() };
        let message = refusal(Reflector::new(&grey(), &settings));
        assert!(message.contains("`sharpest`"), "{message}");
    }
}

#[test]
fn levels_beyond_the_last_are_as_rough_as_it() {
    for ladder in Ladder::ALL {
        for (levels, size) in [(0, 0), (1, 1), (5, 16), (7, 64)] {
            let last = ladder.roughness(u32::max(levels, 1) - 1, levels, size);
            for level in [levels, levels + 1, u32::MAX] {
                assert_eq!(ladder.roughness(level, levels, size), last, "{} {levels}", ladder.name());
            }
        }
    }
}

#[test]
fn bakes_that_were_changed_are_checked_before_they_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let settings = BakeSettings { size: 4, levels: Some(2), irradiance: Some(2), ..BakeSettings::default() };
    let sound = bake(&grey(), &settings).unwrap();
    type Change = fn(&mut Bake);
    let changes: [(Change, &str); 7] = [
        (|bake| bake.chain.levels.clear(), "no levels"),
        (|bake| bake.chain.levels.swap(0, 1), "level 1 is Cube { size: 4 }, but"),
        (|bake| bake.chain.levels[1].texels.truncate(5), "has 5 texels"),
        (|bake| bake.chain.levels[0].texels.clear(), "has 0 texels"),
        (|bake| bake.chain.levels[0].texels[3][1] = f32::NAN, "holds NaN"),
        (|bake| bake.irradiance.as_mut().unwrap().texels[0][0] = -1.0, "holds -1"),
        (|bake| bake.chain.levels[0].bounds = Some(vec![0.0; 3]), "has 3 texels or bounds"),
    ];
    for (change, words) in changes {
        for name in ["a.ktx2", "a.dds", "a.exr"] {
            let mut changed = sound.clone();
            change(&mut changed);
            let message = refusal(changed.write(folder.path().join(name), &WriteOptions::default()));
            assert!(message.contains(words), "{words}: {message}");
        }
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is written");
    sound.write(folder.path().join("a.ktx2"), &WriteOptions::default()).unwrap();
}

#[test]
fn lobes_refuse_directions_that_are_no_unit_vectors() {
    let environment = grey();
    let reflector = Reflector::new(&environment, &ReflectorSettings::default()).unwrap();
    for filter in [Filter::Adaptive(0.01), Filter::Box, Filter::Reference] {
        let lobes = reflector.lobes(Lobe::Ggx, 0.5, filter).unwrap();
        for wrong in NONE.into_iter().chain([DVec3::Y * 1.001]) {
            let mut answers = Vec::new();
            let outcome = lobes.evaluate(&[DVec3::Y, wrong], &mut Workspace::default(), &mut answers);
            assert!(refusal(outcome).contains("no unit vector") && answers.is_empty());
        }
    }
}

#[test]
fn the_oracle_refuses_a_roughness_out_of_range_and_no_direction() {
    let environment = grey();
    let oracle = Oracle::new(&environment);
    for roughness in [-0.1, 1.1, f64::NAN] {
        assert!(refusal(oracle.reflect(Lobe::Ggx, roughness, DVec3::Y)).contains("outside [0, 1]"));
    }
    for wrong in NONE {
        assert!(refusal(oracle.reflect(Lobe::Ggx, 0.5, wrong)).contains("not all 0"));
    }
    for length in [1e-300, 1e-8, 3.0, 1e300] {
        let [red, ..] = oracle.reflect(Lobe::Ggx, 0.5, DVec3::new(1.0, 2.0, 3.0) * length).unwrap();
        assert!((red - 0.5).abs() < 1e-6, "{length}: {red}");
    }
}

#[test]
fn harmonics_refuse_bands_and_windows_that_there_are_not() {
    assert!(refusal(spherical_harmonics(&grey(), 5)).contains("`order` is 5"));
    let coefficients = spherical_harmonics(&grey(), 4).unwrap();
    for width in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for window in [ShWindow::Hanning(width), ShWindow::Lanczos(width), ShWindow::Sinc4(width)] {
            assert!(refusal(window.apply(&coefficients)).contains("`sh_window`"));
        }
    }
    // A grey sky has no ringing.
    assert_eq!(ShWindow::Nonnegative.apply(&coefficients).unwrap(), coefficients);
    let many = vec![[1.0; 3]; 36];
    assert_eq!(scaled(&many, ShScale::Irradiance).len(), 25);
    assert_eq!(scaled(&many, ShScale::Filament).len(), 9);
}

#[test]
fn maps_refuse_places_that_they_have_not() {
    for map in &MAPS {
        let count = map.components();
        assert!(refusal(map.component(count)).contains(&format!("has 0 to {}", count - 1)));
        for wrong in NONE {
            assert!(refusal(map.place(wrong)).contains("not all 0"));
        }
        let high = map.component(0).unwrap().high;
        for (component, uv) in [(count, high), (0, high + 0.1), (0, DVec2::NAN)] {
            refusal(map.direction(Place { component, uv }));
            refusal(map.density(Place { component, uv }));
        }
        let up = map.place(DVec3::Y * 3.0).unwrap();
        assert!(map.direction(up).unwrap().distance(DVec3::Y) < 1e-6, "{}", map.name);
        assert!(map.density(up).unwrap() >= 0.0, "{}", map.name);
    }
}

#[test]
fn texels_beyond_the_last_are_the_last() {
    for (layout, last) in [
        (Layout::Panorama { width: 4, height: 2 }, (3, 1)),
        (Layout::Cube { size: 3 }, (2, 2)),
        (Layout::Octahedral { size: 3 }, (2, 2)),
    ] {
        let (i, j) = last;
        assert_eq!(layout.texel_solid_angle(u32::MAX, u32::MAX), layout.texel_solid_angle(i, j));
        let direction = layout.direction_from_texel(9, u32::MAX, u32::MAX);
        assert_eq!(direction, layout.direction_from_texel(5, i, j));
    }
    assert!(Layout::Cube { size: 0 }.texel_solid_angle(0, 0).is_nan());
}

#[test]
fn ladders_take_any_roughness_and_size() {
    for ladder in Ladder::ALL {
        for (wrong, right) in [(-1.0, 0.0), (2.0, 1.0), (f64::INFINITY, 1.0), (f64::NAN, 0.0)] {
            assert_eq!(ladder.lod(wrong, 7, 64), ladder.lod(right, 7, 64), "{} {wrong}", ladder.name());
        }
        for map in [Map::Cube, Map::Panorama, Map::Octahedral] {
            assert!(ladder.default_levels(map, 0) >= 1, "{}", ladder.name());
        }
    }
}

#[test]
fn suns_towards_no_direction_are_refused() {
    for wrong in NONE {
        let message = refusal(extract(&grey(), &Suns::Towards(vec![DVec3::Y, wrong])));
        assert!(message.starts_with("direction 1 is "), "{message}");
    }
}

#[test]
fn memory_is_counted_for_the_widest_texels_of_all_plans() {
    let environment = Environment::new(Layout::Panorama { width: 8, height: 4 }, vec![[1.0; 3]; 32]);
    let environment = environment.expect("32 texels");
    let needed = |pixels: [Pixel; 2]| {
        let plans = pixels.map(|pixel| {
            let recipe = Recipe { size: Some(16_384), pixel: Some(pixel), ..Recipe::default() };
            recipe.plans().expect("one plan").remove(0)
        });
        match check_memory(&plans, &environment) {
            Err(Error::Limit { needed, .. }) => needed,
            other => panic!("{other:?}"),
        }
    };
    let mixed = needed([Pixel::F16, Pixel::F32]);
    assert_eq!(mixed, needed([Pixel::F32, Pixel::F16]));
    assert!(mixed > needed([Pixel::F16, Pixel::F16]), "floats take more");
}

#[test]
fn products_need_a_bake_for_each_plan() {
    let source = Source::new(grey(), "grey".to_owned(), "a panorama");
    let target = vec![Target::named("bevy").unwrap()];
    let recipe = Recipe { target, size: Some(64), ..Recipe::default() };
    let start = std::time::Instant::now();
    let none = produce(&recipe, &source, start, reader, |_| Ok(Baked::on_cpu(Vec::new())));
    assert!(refusal(none.map(drop)).starts_with("0 bakes for 1 plans"));
    assert!(
        refusal(products(&[], &source, Baked::on_cpu(Vec::new()), "a", start, reader).map(drop))
            .contains("0 plans")
    );
    let changed = |settings: &[BakeSettings]| {
        let mut bake = bake(&grey(), &settings[0])?;
        bake.sh.clear();
        Ok(Baked::on_cpu(vec![bake]))
    };
    assert!(refusal(produce(&recipe, &source, start, reader, changed).map(drop)).contains("harmonics"));
    assert!(refusal(source.turned(false, f64::NAN)).contains("not finite"));
    let strict = InputOptions { scale: Some(-1.0), ..InputOptions::default() };
    assert!(refusal(strict.open(&[])).contains("`scale`"));
}
