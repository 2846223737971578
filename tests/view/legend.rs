//! Legends of debug views: what they say, and that nothing is cut off.

use octagloss_core::light::oem::OemSize;
use octagloss_view::look::legend::{INSET, MIN, Shown, legend_scene};
use octagloss_view::{Look, Show, Technique};

const SHOWN: Shown = Shown { mean: 0.0123, least: 0.0, greatest: 1520.4 };

fn texts(show: Show, filter: Technique, border: u32) -> Vec<String> {
    let look = Look { show, filter, ..Look::default() };
    let scene = legend_scene(&look, OemSize { inner: 512, border }, -1.25, SHOWN).expect("a legend");
    let labels = scene.labels();
    for (k, (text, own)) in labels.iter().enumerate() {
        assert!(scene.frame().holds(own), "{show:?}: {text:?} is cut off");
        for (other, others) in &labels[..k] {
            assert!(!own.overlaps(others), "{show:?}: {text:?} covers {other:?}");
        }
    }
    // The smallest picture with a legend shows something beside it.
    let picture = scene.picture();
    let (width, height) = (picture.width() + 2 * INSET, picture.height());
    assert!(width <= MIN[0] * 3 / 4 && height <= 190, "{show:?}: {width} x {height}");
    labels.into_iter().map(|(text, _)| text).collect()
}

#[test]
fn legends_name_what_is_shown_its_unit_and_its_range() {
    let error = texts(Show::Error, Technique::Pyramid, 0).join(" ");
    for words in ["Relative error of pyramid", "mean 1.2\u{a0}%", "greatest 152040\u{a0}%", "0.01 %", "100 %"]
    {
        assert!(error.contains(words), "{words}: {error}");
    }
    for filter in [Technique::Box, Technique::Levels, Technique::Adaptive] {
        assert!(texts(Show::Error, filter, 0).join(" ").contains(&filter.to_string()));
    }
    let error = texts(Show::Error, Technique::Reflect, 0).join(" ");
    assert!(error.contains("true reflections") && error.contains("against adaptive:1e-3"), "{error}");
    let oem = texts(Show::Oem, Technique::Box, 16).join(" ");
    for words in
        ["Octahedral map", "512 \u{d7} 512 texels, border 16", "0 to 1520", "mean 0.0123", "\u{2212}1.25"]
    {
        assert!(oem.contains(words), "{words}: {oem}");
    }
    let sat = texts(Show::Sat, Technique::Box, 16).join(" ");
    for words in ["Summed-area table", "544 \u{d7} 544 texels", "upper left corner", "in the file's unit"] {
        assert!(sat.contains(words), "{words}: {sat}");
    }
    assert!(legend_scene(&Look::default(), OemSize { inner: 1, border: 0 }, 0.0, SHOWN).is_none(), "a scene");
}
