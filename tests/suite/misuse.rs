//! Calls of the library that break its preconditions: each is an error that says what is wrong.

use glam::DVec3;
use octagloss::internals::bake::query::Query;
use octagloss::internals::sh::window::ShWindow;
use octagloss::{
    Bake, BakeSettings, Environment, Error, Filter, Ladder, Layout, Lobe, Reflector, ReflectorSettings, Rgb,
    WriteOptions, bake,
};

const GREY: Layout = Layout::Panorama { width: 16, height: 8 };

fn grey() -> Environment {
    Environment::new(GREY, vec![[0.5; 3]; 128]).expect("a valid environment")
}

/// The message of an [`Error::Parameter`].
fn refusal<T: std::fmt::Debug>(outcome: octagloss::Result<T>) -> String {
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
    let settings = ReflectorSettings { oem_size: Some(16), ..ReflectorSettings::default() };
    let reflector = Reflector::new(&environment, &settings).unwrap();
    for filter in [Filter::Adaptive(0.01), Filter::Fitted(4), Filter::Box, Filter::Reference] {
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
        let near = |answer: octagloss::Answer| (answer.radiance[0] / expected.radiance[0] - 1.0).abs() < 1e-3;
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
        let environment = grey().rotated_y(wrong);
        let message = refusal(Reflector::new(&environment, &ReflectorSettings::default()));
        assert!(message.contains("not finite"), "{message}");
        let settings = BakeSettings { size: 4, ..BakeSettings::default() };
        assert!(refusal(bake(&environment, &settings)).contains("not finite"));
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
        (BakeSettings { filter: Filter::Fitted(3), ..small.clone() }, "fitted:3"),
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
