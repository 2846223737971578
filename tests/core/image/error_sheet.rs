//! The error sheet marks the wrong texel, in colours that its bar explains.

use octagloss_core::analysis::channels::Relative;
use octagloss_core::analysis::compare::{LevelErrors, errors_against_texels};
use octagloss_core::files::image::error_sheet::error_sheet;
use octagloss_core::light::chain::Level;
use octagloss_drawing::bitmap::Bitmap;
use octagloss_drawing::scale::RELATIVE_ERROR;
use octagloss_drawing::scene::Scene;
use octagloss_fixtures::files::written::chain;

fn sheet(pairs: &[(&Level, &Level)]) -> octagloss_core::common::error::Result<Scene> {
    let errors: Vec<LevelErrors> = (pairs.iter().enumerate())
        .map(|(number, (level, reference))| LevelErrors {
            size: 64,
            rmse: Relative { luminance: 0.0123, channels: [0.0123; 3] },
            reference: Some(Level::clone(reference)),
            ..errors_against_texels(number, level, level)
        })
        .collect();
    let levels: Vec<_> =
        errors.iter().zip(pairs).map(|(errors, (level, _))| (errors, Level::clone(level))).collect();
    error_sheet("Errors of \u{5929}.ktx2", "a.exr", &levels)
}

/// Left and upper edge of the first cross: the margin and the colour bar; the margin, the title's line, the
/// space below it and two lines of labels.
const CROSS: (u32, u32) = (26 + 96, 26 + 24 + 18 + 48);

/// A pixel amid texel `x`, `y` of face +Z, which has eight texels of 12 pixels along its edge.
fn pixel(picture: &Bitmap, x: u32, y: u32) -> [u8; 3] {
    picture.pixel(CROSS.0 + 96 + x * 12 + 6, CROSS.1 + 96 + y * 12 + 6)
}

#[test]
fn one_wrong_texel_shows_where_it_is() {
    let reference = &chain(8, 1, false).levels[0];
    let shown = |level: &Level| {
        let picture = sheet(&[(level, reference)]).expect("a sheet").picture();
        (0..64).filter(|k| pixel(&picture, k % 8, k / 8) != [0; 3]).collect::<Vec<_>>()
    };
    assert!(shown(reference).is_empty(), "no error is black");
    let mut wrong = reference.clone();
    wrong.texels[4 * 64 + 19][1] *= 1.5;
    assert_eq!(shown(&wrong), [19]);
    assert!(sheet(&[(reference, &chain(4, 1, false).levels[0])]).is_err());
    assert!(sheet(&[]).is_err());
}

#[test]
fn colours_are_those_of_the_bar_and_lighter_for_larger_errors() {
    let even = |radiance: f32| Level::cube(8, 0.0, vec![[radiance; 3]; 384]);
    let reference = even(1.0);
    let colour =
        |error: f32| pixel(&sheet(&[(&even(1.0 + error), &reference)]).expect("a sheet").picture(), 3, 3);
    let mut before = -1.0;
    for error in [0.0, 2e-4, 1e-3, 5e-3, 2e-2, 0.1, 0.3, 0.9] {
        let found = colour(error);
        // The divisor has a thousandth of the mean more; a float's rounding of 1 + error is below 1e-7.
        let shares = [0.999 - 1e-3, 1.0 + 1e-3].map(|f| RELATIVE_ERROR.colour(f * f64::from(error) / 1.001));
        for c in 0..3 {
            let (low, high) = (shares[0][c].min(shares[1][c]), shares[0][c].max(shares[1][c]));
            assert!(
                (low.saturating_sub(1)..=high.saturating_add(1)).contains(&found[c]),
                "{error}: {found:?}"
            );
        }
        let [r, g, b] = found.map(|c| f64::from(c).powf(2.2));
        let lightness = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        assert!(lightness > before, "{error}");
        before = lightness;
    }
}

#[test]
fn levels_are_labelled_without_collisions() {
    let levels: Vec<Level> =
        (0..16).map(|k| Level::cube(8, f64::from(k) / 15.0, vec![[1.0; 3]; 384])).collect();
    for count in [1, 2, 5, 16] {
        let pairs: Vec<_> = levels[..count].iter().map(|level| (level, level)).collect();
        let scene = sheet(&pairs).expect("a sheet");
        let texts = scene.labels();
        for (k, (text, own)) in texts.iter().enumerate() {
            assert!(scene.frame().holds(own), "{text:?} is cut off");
            for (other, others) in &texts[..k] {
                assert!(!own.overlaps(others), "{text:?} covers {other:?}");
            }
        }
        let has = |wanted: &str| texts.iter().filter(|(text, _)| text.contains(wanted)).count();
        assert_eq!(has("relRMSE 1.2 %, red 1.2 %; greatest 0 %"), count);
        assert_eq!(has("6 \u{d7} 8\u{b2} of 64\u{b2} texels"), count);
        for k in 0..count {
            assert_eq!(has(&format!("level {k}: roughness {:.3}", levels[k].roughness)), 1);
        }
        for tick in ["0.01 %", "0.1 %", "1 %", "10 %", "100 %", "relative error"] {
            assert!(texts.iter().any(|(text, _)| text == tick), "{tick}");
        }
    }
}
