//! The levels of every target, by the formula with which its engine looks roughness up.

use octagloss_core::common::error::Error;
use octagloss_core::files::recipe::Recipe;
use octagloss_core::files::recipe::plan::BakePlan;
use octagloss_core::files::target::{TARGETS, Target};
use octagloss_core::lobe::ladder::Ladder;

/// The MIP level that `target`'s engine reads for perceptual roughness `r` from a chain of `levels` below
/// `size` texels; `None` for readers that filter or read the report themselves. The sources are cited in
/// `crates/core/src/files/target/mod.rs`.
fn engine_mip(target: &str, r: f64, levels: u32, size: u32) -> Option<f64> {
    let last = f64::from(levels - 1);
    match target {
        // roughnessToMip: ENVMAP_MAX_LOD is the number of mipmaps less one.
        "three" | "filament" => Some(last * r * (2.0 - r)),
        "bevy" | "khronos" | "oem" | "gltf-ext" => Some(last * r),
        // getLodFromAlphaG, times lodGenerationScale.
        "babylon" => Some((0.8 * (r * r * f64::from(size)).log2()).clamp(0.0, last)),
        // saturate(1 - gloss) * 5.
        "playcanvas" => Some(5.0 * r),
        "unity" => Some(6.0 * r * (1.7 - 0.7 * r)),
        "generic" | "pyramid" | "unreal" | "godot" | "blender" => None,
        _ => panic!("{target}: what does its engine read?"),
    }
}

/// The first roughness that `target`'s engine looks up at levels which do not enclose it.
fn misread(target: &Target, plan: &BakePlan) -> Option<String> {
    let levels = plan.settings.level_specs().unwrap();
    let (count, size) = (levels.len() as u32, plan.settings.size);
    (0..=100).map(|k| f64::from(k) / 100.0).find_map(|r| {
        let mip = engine_mip(target.name, r, count, size)?;
        let at = |level: f64| levels.get(level as usize).map_or(f64::NAN, |level| level.roughness);
        // Babylon.js reads level 0 for lobes within one of its texels.
        let within_texel = target.name == "babylon" && r * r * f64::from(size) <= 1.0;
        // A mip above the last level is NaN here, and not enclosed.
        let is_enclosed = at((mip + 1e-9).floor()) <= r + 1e-9 && at((mip - 1e-9).ceil()) >= r - 1e-9;
        (!within_texel && !is_enclosed)
            .then(|| format!("{}: size {size}, {count} levels: roughness {r} at mip {mip}", target.name))
    })
}

#[test]
fn every_engine_finds_every_roughness_at_every_size_and_number_of_levels() {
    let powers = (7..=12).flat_map(|log2| [(1 << log2) - 1, 1 << log2, (1 << log2) + 1]);
    let sizes: Vec<u32> = (1..=72).chain(powers).chain([96, 300, 640, 1000, 2000, 3000]).collect();
    for target in &TARGETS {
        let mut accepted = 0;
        for size in sizes.iter().copied() {
            let few = [1, 2, 5, 6, 7, 8, 13].map(Some);
            let given = few.into_iter().filter(|_| size < 20 || size.is_power_of_two());
            for levels in std::iter::once(None).chain(given) {
                let options = Recipe { size: Some(size), levels, ..Recipe::default() };
                match options.targeted(target) {
                    Ok(plan) => {
                        accepted += u32::from(levels.is_none());
                        assert_eq!(misread(target, &plan), None);
                    }
                    Err(Error::Parameter(message)) => {
                        let is_named = message.contains(target.name)
                            && ["`size`", "`levels`"].iter().any(|option| message.contains(option));
                        assert!(is_named || message.contains("omit `levels`"), "{message}");
                        let most = if target.has_pyramid() { 2048 } else { u32::MAX };
                        let is_common =
                            size.is_power_of_two() && (64..=most).contains(&size) && levels.is_none();
                        assert!(!is_common, "size {size} must do: {message}");
                    }
                    Err(other) => panic!("{other}"),
                }
            }
        }
        assert!(accepted >= 6, "{}: {accepted} sizes", target.name);
    }
}

#[test]
fn unity_has_seven_levels_at_every_size_or_an_error() {
    let unity = Target::named("unity").unwrap();
    let of = |size, levels| Recipe { size: Some(size), levels, ..Recipe::default() }.targeted(unity);
    for size in [64, 100, 128, 256, 512, 1024, 4096] {
        let roughness: Vec<f64> =
            of(size, None).unwrap().settings.level_specs().unwrap().iter().map(|l| l.roughness).collect();
        assert_eq!((roughness.len(), roughness[6]), (7, 1.0), "{size}");
    }
    for (size, levels) in [(32, None), (1, None), (63, None), (256, Some(5)), (1024, Some(9))] {
        let message = of(size, levels).unwrap_err().to_string();
        assert!(message.contains("target unity: its reader") && message.contains("7 levels"), "{message}");
    }
}

#[test]
fn a_ladder_that_the_engine_does_not_look_up_is_refused() {
    for target in &TARGETS {
        for ladder in Ladder::ALL {
            let plan = Recipe { ladder: Some(ladder), ..Recipe::default() }.targeted(target);
            let fits = ladder == target.ladder || target.name == "generic";
            assert_eq!(plan.is_ok(), fits, "{} {}", target.name, ladder.name());
        }
    }
}

#[test]
fn a_wrong_number_of_levels_is_seen() {
    let unity = Target::named("unity").unwrap();
    let mut plan = Recipe { size: Some(1024), ..Recipe::default() }.targeted(unity).unwrap();
    assert_eq!(misread(unity, &plan), None);
    for wrong in [6, 8, 9] {
        plan.settings.levels = Some(wrong);
        assert!(misread(unity, &plan).is_some(), "{wrong}");
    }
}
