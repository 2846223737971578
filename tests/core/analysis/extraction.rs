//! Suns parted from their environment: the rest and the lamps light every surface as the source does.

use glam::DVec3;
use octagloss_core::analysis::delivered::even_directions;
use octagloss_core::analysis::extraction::{Extraction, MAX_LAMPS, Suns, Why, extract};
use octagloss_core::analysis::sun::Sun;
use octagloss_core::light::environment::{Environment, Layout};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const LAYOUTS: [Layout; 3] = [
    Layout::Panorama { width: 256, height: 128 },
    Layout::Cube { size: 64 },
    Layout::Octahedral { size: 128 },
];

/// The poles, the panorama's seam, a cube's corner and edge, an octahedral fold.
const PLACES: [DVec3; 5] = [DVec3::Y, DVec3::NEG_Y, DVec3::NEG_X, DVec3::ONE, DVec3::new(1.0, 0.0, 1.0)];

/// The promised change of the irradiance.
const CHANGE: f64 = 0.01;

fn environment(layout: Layout, radiance: impl Fn(DVec3) -> [f64; 3]) -> Environment {
    let (width, height) = layout.sides();
    let images = (layout.texel_count() / (width as usize * height as usize)) as u32;
    let places = (0..images).flat_map(|k| (0..height).flat_map(move |j| (0..width).map(move |i| (k, i, j))));
    let texels = places.map(|(k, i, j)| radiance(layout.direction_from_texel(k, i, j)).map(|v| v as f32));
    Environment::new(layout, texels.collect()).expect("valid")
}

/// A disc of `degrees` in radius around `centre`, with a glow.
fn disc(direction: DVec3, centre: DVec3, degrees: f64, radiance: f64) -> f64 {
    let angle = direction.angle_between(centre.normalize()).to_degrees();
    let glow = 0.008 * radiance * (-angle / 1.5).exp();
    if angle < degrees { radiance + glow } else { glow }
}

/// Directions, solid angles and radiance of the texels, in the world.
fn texels(environment: &Environment) -> Vec<(DVec3, f64, [f64; 3])> {
    let mut all = Vec::new();
    environment.for_each_texel(|direction, w, texel| all.push((direction, w, texel.map(f64::from))));
    all
}

fn energy(texels: &[(DVec3, f64, [f64; 3])]) -> [f64; 3] {
    texels.iter().fold([0.0; 3], |sum, (_, w, rgb)| std::array::from_fn(|c| sum[c] + w * rgb[c]))
}

fn irradiance(texels: &[(DVec3, f64, [f64; 3])], normal: DVec3) -> [f64; 3] {
    texels.iter().fold([0.0; 3], |sum, (d, w, rgb)| {
        let cosine = d.dot(normal).max(0.0);
        std::array::from_fn(|c| sum[c] + cosine * w * rgb[c])
    })
}

/// The greatest change of irradiance over the greatest irradiance, of the worst channel: over the sphere and
/// close to the horizons of the lamps, where it is greatest.
fn change(environment: &Environment, Extraction { lamps, sunless, .. }: &Extraction) -> f64 {
    let (whole, rest) = (texels(environment), texels(sunless));
    let removed: Vec<(DVec3, f64, [f64; 3])> = whole
        .iter()
        .zip(&rest)
        .filter(|(a, b)| a.2 != b.2)
        .map(|((d, w, a), (_, _, b))| (*d, *w, std::array::from_fn(|c| a[c] - b[c])))
        .collect();
    let mut greatest = [0.0; 3];
    for normal in even_directions(100) {
        let irradiance = irradiance(&whole, normal);
        greatest = std::array::from_fn(|c| irradiance[c].max(greatest[c]));
    }
    let mut normals = even_directions(400);
    for lamp in lamps {
        let (u, v) = lamp.sun.direction.any_orthonormal_pair();
        for step in 0..40 * 15 {
            let turn = TAU * f64::from(step / 15) / 40.0;
            let tilt = FRAC_PI_2 + 0.01 * f64::from(step % 15 - 7);
            normals.push(tilt.cos() * lamp.sun.direction + tilt.sin() * (turn.cos() * u + turn.sin() * v));
        }
    }
    let mut worst = 0.0_f64;
    for normal in normals {
        let mut change = irradiance(&removed, normal);
        for lamp in lamps {
            let cosine = lamp.sun.direction.dot(normal).max(0.0);
            (0..3).for_each(|c| change[c] -= cosine * lamp.sun.irradiance[c]);
        }
        (0..3).for_each(|c| worst = worst.max(change[c].abs() / greatest[c]));
    }
    worst
}

/// Checks what holds for every extraction; returns the solid angle of each lamp.
fn check(environment: &Environment, extraction: &Extraction, what: &str) {
    let Extraction { lamps, sunless, .. } = extraction;
    let (whole, rest) = (texels(environment), texels(sunless));
    for c in 0..3 {
        let taken: f64 = lamps.iter().map(|lamp| lamp.sun.irradiance[c]).sum();
        let sum = energy(&rest)[c] + taken;
        // Sums of 10^5 terms in double precision.
        assert!((sum / energy(&whole)[c] - 1.0).abs() < 1e-11, "{what}: {sum} {:?}", energy(&whole));
    }
    let changed: f64 = whole.iter().zip(&rest).filter(|(a, b)| a.2 != b.2).map(|(a, _)| a.1).sum();
    assert!(changed <= 0.01 * lamps.len() as f64, "{what}: {changed} sr of {} lamps", lamps.len());
    assert!(
        whole.iter().zip(&rest).all(|(a, b)| (0..3).all(|c| 0.0 <= b.2[c] && b.2[c] <= a.2[c])),
        "{what}"
    );
    let change = change(environment, extraction);
    assert!(change < CHANGE, "{what}: the irradiance changes by {change}");
    assert_eq!(extraction.notes().len(), lamps.len());
}

/// A sky with a gradient, different in each channel.
fn sky(direction: DVec3) -> [f64; 3] {
    [2.0 + direction.z, 2.0 + direction.x, 5.0 + direction.y]
}

#[test]
fn a_sun_on_every_kind_of_edge_becomes_a_lamp() {
    for layout in LAYOUTS {
        for place in PLACES.map(DVec3::normalize) {
            let what = format!("{layout:?} {place}");
            let environment = environment(layout, |d| {
                let (sun, sky) = (disc(d, place, 1.5, 5000.0), sky(d));
                [sun + sky[0], 0.8 * sun + sky[1], 0.5 * sun + sky[2]]
            })
            .rotated_y(30.0)
            .expect("an angle");
            let extraction = extract(&environment, &Suns::Brightest).expect("directions");
            check(&environment, &extraction, &what);
            let [lamp] = &extraction.lamps[..] else { panic!("{what}: {:?}", extraction.warnings()) };
            let world = environment.source_from_world().transpose() * place;
            assert!(lamp.sun.direction.dot(world) > 0.9995, "{what}: {}", lamp.sun.direction);
            assert!(lamp.energy_share > 0.1, "{what}: {}", lamp.energy_share);
            assert!(extraction.warnings().is_empty(), "{what}: {:?}", extraction.warnings());
            assert_eq!(Sun::find(&extraction.sunless), None, "{what}");
        }
    }
}

#[test]
fn two_suns_are_taken_by_strength_or_by_direction() {
    // The brighter one gives less light.
    let (bright, strong) = (DVec3::new(-1.0, 0.02, 0.01).normalize(), DVec3::new(0.3, 0.9, -0.2).normalize());
    let source = environment(LAYOUTS[0], |d| {
        let (a, b) = (disc(d, bright, 1.0, 9000.0), disc(d, strong, 1.5, 6000.0));
        [a + 1.0, a + b + 1.0, 0.1 * a + 3.0 * b + 1.0]
    });
    let taken = |suns: Suns| {
        let extraction = extract(&source, &suns).expect("directions");
        check(&source, &extraction, &suns.to_string());
        let directions: Vec<DVec3> = extraction.lamps.iter().map(|lamp| lamp.sun.direction).collect();
        (directions, extraction)
    };
    let near = |found: &[DVec3], expected: &[DVec3]| {
        found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| a.dot(*b) > 0.9995)
    };
    let (found, both) = taken(Suns::Strongest(2));
    let by_strength = [strong, bright];
    assert!(near(&found, &by_strength), "{found:?}");
    let share = |k: usize| both.lamps[k].energy_share;
    assert!(share(0) > share(1), "{} {}", share(0), share(1));
    assert!(near(&taken(Suns::Strongest(1)).0, &by_strength[..1]));
    assert!(near(&taken(Suns::Brightest).0, &[bright]));
    // What the console prints finds the same lamps again, in any order, with the same rest.
    let (found, again) = taken(Suns::Towards(found));
    assert!(near(&found, &by_strength) && again.sunless.texels() == both.sunless.texels());
    let tilted = (strong + 0.1 * DVec3::X).normalize();
    assert!(near(&taken(Suns::Towards(vec![tilted])).0, &[strong]));
    let (found, dark) = taken(Suns::Towards(vec![DVec3::NEG_Y, bright]));
    assert!(near(&found, &[bright]) && dark.dark == [DVec3::NEG_Y], "{found:?}");
    let warnings = dark.warnings().join("\n");
    assert!(warnings.contains("1 of 2 suns") && warnings.contains("no light stands out"), "{warnings}");
    // A third is wanted.
    let (found, third) = taken(Suns::Strongest(3));
    assert!(near(&found, &by_strength), "{found:?}");
    assert!(third.warnings().join("\n").contains("2 of 3 suns"), "{:?}", third.warnings());
}

/// A softbox with a hot middle: its core is as small as a sun.
fn softbox(direction: DVec3) -> [f64; 3] {
    let angle = direction.angle_between(DVec3::ONE.normalize()).to_degrees();
    let value = 3000.0 * (-(angle / 2.2).powi(2)).exp() + if angle < 9.0 { 60.0 } else { 0.0 };
    [value + 1e-3, value + 1e-3, 0.9 * value + 1e-3]
}

#[test]
fn area_lights_stay_with_a_warning() {
    for layout in LAYOUTS {
        // A window in a dark room, a strip, a window with a small lamp elsewhere.
        let window = |d: DVec3| d.x > 0.0 && (d.y / d.x).abs() < 0.15 && (d.z / d.x).abs() < 0.2;
        let strip = |d: DVec3| d.x > 0.0 && (d.y / d.x).abs() < 0.016 && (d.z / d.x).abs() < 0.4;
        for (what, is_lit) in [("window", &window as &dyn Fn(DVec3) -> bool), ("strip", &strip)] {
            let source = environment(layout, |d| if is_lit(d) { [900.0; 3] } else { [0.01; 3] });
            for suns in [Suns::Brightest, Suns::Strongest(1), Suns::Towards(vec![DVec3::X])] {
                let extraction = extract(&source, &suns).expect("directions");
                assert!(extraction.lamps.is_empty(), "{layout:?} {what} {suns}");
                assert!(extraction.sunless.texels() == source.texels());
                let reasons: Vec<Why> = extraction.kept.iter().map(|kept| kept.why).collect();
                assert!(reasons == [Why::Large], "{layout:?} {what} {suns}: {:?}", extraction.kept);
                let warnings = extraction.warnings().join("\n");
                assert!(
                    warnings.contains("a light stays: azimuth") && warnings.contains("0.01 sr"),
                    "{warnings}"
                );
            }
        }
        let lamp = DVec3::new(-0.5, 0.6, 0.1).normalize();
        let source = environment(layout, |d| {
            let sun = disc(d, lamp, 1.5, 500.0);
            if window(d) { [900.0; 3] } else { [0.01 + sun; 3] }
        });
        let extraction = extract(&source, &Suns::Strongest(1)).expect("directions");
        check(&source, &extraction, "a lamp beside a window");
        let [found] = &extraction.lamps[..] else { panic!("{layout:?}: {:?}", extraction.warnings()) };
        assert!(
            found.sun.direction.dot(lamp) > 0.9995 && extraction.kept.len() == 1,
            "{:?}",
            extraction.kept
        );
        // The glow does not escape the limit.
        let source = environment(layout, softbox);
        for suns in [Suns::Brightest, Suns::Strongest(3)] {
            let extraction = extract(&source, &suns).expect("directions");
            check(&source, &extraction, &format!("{layout:?}, softbox"));
            assert!(!extraction.warnings().is_empty(), "{layout:?}");
        }
    }
}

#[test]
fn a_tube_is_no_sun_even_if_it_covers_little() {
    let source = environment(Layout::Panorama { width: 512, height: 256 }, |d| {
        let is_lit = d.x > 0.0 && (0.0..0.0123).contains(&(d.y / d.x)) && (d.z / d.x).abs() < 0.27;
        if is_lit { [900.0; 3] } else { [0.01; 3] }
    });
    let extraction = extract(&source, &Suns::Brightest).expect("directions");
    let [kept] = &extraction.kept[..] else { panic!("{:?}", extraction.lamps) };
    assert!(kept.why == Why::Long && kept.region.solid_angle < 0.01, "{kept:?}");
    assert!(extraction.lamps.is_empty() && extraction.warnings().join("\n").contains("reaches further"));
}

#[test]
fn a_light_that_a_lamp_cannot_replace_stays() {
    // A disc of 0.0097 sr that gives nearly all light: a lamp's horizon is sharper than its own.
    let source = environment(Layout::Panorama { width: 512, height: 256 }, |d| {
        let is_lit = d.angle_between(DVec3::new(0.2, 0.7, 0.4).normalize()).to_degrees() < 3.18;
        if is_lit { [1000.0; 3] } else { [1e-3; 3] }
    });
    let extraction = extract(&source, &Suns::Brightest).expect("directions");
    assert!(extraction.lamps.is_empty() && extraction.sunless.texels() == source.texels());
    let Why::Spread(change) = extraction.kept[0].why else { panic!("{:?}", extraction.kept) };
    // 2/(3 pi) of the radius.
    assert!((change - 2.0 / (3.0 * PI) * 3.18_f64.to_radians()).abs() < 0.001, "{change}");
    assert!(
        extraction.warnings().join("\n").contains("would change by 1.2 %"),
        "{:?}",
        extraction.warnings()
    );
}

#[test]
fn a_sun_of_one_texel_leaves_its_neighbours_mean() {
    let layout = Layout::Cube { size: 32 };
    let mut texels = vec![[1.0, 2.0, 3.0]; layout.texel_count()];
    texels[5 * 32 + 7] = [900.0, 2.0, 1.0];
    let environment = Environment::new(layout, texels.clone()).expect("valid");
    let extraction = extract(&environment, &Suns::Brightest).expect("directions");
    // Blue was darker than its surroundings and stays unchanged.
    texels[5 * 32 + 7] = [1.0, 2.0, 1.0];
    assert_eq!(extraction.sunless.texels(), texels);
    let sun = &extraction.lamps[0].sun;
    assert_eq!(sun.texels, 1);
    assert!(sun.irradiance[1] == 0.0 && sun.irradiance[0] > 0.0);
}

#[test]
fn dark_and_tiny_environments_have_no_sun() {
    for value in [0.0, 3.0] {
        for layout in [Layout::Cube { size: 8 }, Layout::Panorama { width: 2, height: 1 }] {
            let source = environment(layout, |_| [value; 3]);
            for suns in [Suns::Brightest, Suns::Strongest(MAX_LAMPS), Suns::Towards(vec![DVec3::X])] {
                let extraction = extract(&source, &suns).expect("directions");
                assert!(extraction.lamps.is_empty() && extraction.sunless.texels() == source.texels());
                assert!(extraction.warnings()[0].contains("no sun detected"), "{:?}", extraction.warnings());
            }
        }
    }
    // One lit texel of a very coarse picture is no sun.
    for (width, height) in [(2, 1), (6, 3), (10, 5)] {
        let layout = Layout::Panorama { width, height };
        let mut texels = vec![[1e-3; 3]; layout.texel_count()];
        texels[layout.texel_count() / 2] = [1000.0; 3];
        let source = Environment::new(layout, texels).expect("valid");
        let found = Sun::find(&source).map(|sun| sun.kind.name());
        assert_ne!(found, Some("sun"), "{width}x{height}");
        assert!(extract(&source, &Suns::Brightest).expect("directions").lamps.is_empty(), "{width}x{height}");
    }
}

#[test]
fn texts_choose_suns() {
    for text in ["brightest", "1", "32", "0,1,0", "0,1,0:1,0,0"] {
        assert_eq!(Suns::parsed(text).map(|suns| suns.to_string()), Ok(text.to_owned()));
    }
    let Ok(Suns::Towards(directions)) = Suns::parsed("90,30:0,-90: -1e300 , 0, 0") else {
        panic!("directions")
    };
    let expected = [DVec3::new(0.0, 0.5, 0.75_f64.sqrt()), DVec3::NEG_Y, DVec3::NEG_X];
    assert!(directions.iter().zip(expected).all(|(a, b)| a.distance(b) < 1e-12), "{directions:?}");
    for text in ["", "0", "33", "-1", "1.5", "sky.exr", "0,0,0", "1,2,3,4", "nan,1", "10,91", "1,2:", "1;2"] {
        assert!(Suns::parsed(text).unwrap_err().contains("number of lights from 1 to 32"), "{text}");
    }
}
