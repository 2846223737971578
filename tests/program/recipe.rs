//! Recipes: as JSON, and as the plans that they are recorded with.

use octagloss_core::files::format::OutputLayout;
use octagloss_core::files::io::provenance::Provenance;
use octagloss_core::files::recipe::{InputOptions, Recipe, from_json};
use octagloss_core::files::target::TARGETS;
use serde_json::{Map, Value, json};

fn options(value: Value) -> Map<String, Value> {
    value.as_object().expect("options").clone()
}

fn read(path: &str) -> String {
    std::fs::read_to_string(format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn refusal(value: Value) -> String {
    from_json::<Recipe>(options(value)).and_then(|recipe| recipe.plans()).map(drop).unwrap_err().to_string()
}

#[test]
fn the_recipe_of_a_plan_makes_the_same_plan() {
    let untargeted = [
        json!({}),
        json!({"format": "hdr", "irradiance": 4, "skybox": "source"}),
        json!({"format": "exr", "bounds": true, "size": 32}),
        json!({"lobe": "cosine"}),
        json!({"filter": "pyramid", "oem_size": 256, "border": 0, "ladder": "filament", "pixel": "f32"}),
        json!({
            "filter": "box", "scan": "hensley:4", "chain": "sampled", "sh_order": 4, "sh_window": "lanczos:3"
        }),
        json!({"rotate_y": -90.5, "scale": 2, "mirror": true, "pad": "edge", "extract_sun": "0,1,0:-1,0,0"}),
    ];
    let layouts = OutputLayout::ALL.map(|layout| json!({"out_layout": layout.name()}));
    let targets = TARGETS.iter().flat_map(|target| {
        let changed = json!({"target": target.name, "size": 64, "lobe": "ggx", "overflow": "compress"});
        [json!({"target": [target.name]}), changed, json!({"target": target.name, "skybox": 8, "name": "a"})]
    });
    let more = [
        json!({
            "target": "three,generic", "diffuse": "both", "irradiance": 8, "format": "exr", "flip": "none"
        }),
        json!({"target": "pyramid", "map": "cube"}),
        json!({"target": "generic", "ladder": "unity", "levels": 3, "pixel": "f32", "format": "dds"}),
    ];
    let mut count = 0;
    for given in untargeted.into_iter().chain(layouts).chain(targets).chain(more) {
        let recipe: Recipe = from_json(options(given.clone())).unwrap();
        for plan in recipe.plans().unwrap() {
            let json = serde_json::to_value(&plan.recipe).unwrap();
            let again: Recipe = from_json(options(json)).unwrap();
            assert_eq!(again, plan.recipe, "{given}");
            let [same] = &again.plans().unwrap()[..] else { panic!("one target") };
            assert_eq!((&same.recipe, &same.plan), (&plan.recipe, &plan.plan), "{given}");
            // Levels and contents that were defaults are given now.
            let mut settings = plan.settings.clone();
            settings.levels = same.settings.levels;
            settings.chain = same.settings.chain;
            assert_eq!(format!("{settings:?}"), format!("{:?}", same.settings), "{given}");
            assert_eq!(plan.settings.level_specs().unwrap(), same.settings.level_specs().unwrap(), "{given}");
            assert_eq!(plan.settings.chain(), same.settings.chain(), "{given}");
            count += 1;
        }
    }
    assert_eq!(count, 7 + 9 + 3 * TARGETS.len() + 4);
}

#[test]
fn options_that_there_are_not_and_values_that_they_cannot_have_are_named() {
    for (given, error) in [
        (json!({"sizes": 4}), "there is no option `sizes`; there are `target`, `size`"),
        (json!({"size": "abc"}), "`size` is \"abc\"; a whole number is needed"),
        (json!({"size": -1}), "`size` is -1; a whole number is needed"),
        (json!({"size": 0}), "`size` is 0; it must be 1 to 16384"),
        (json!({"sh_order": 5}), "`sh_order` is 5; it must be 2 to 4"),
        (json!({"oem_size": 20000}), "`oem_size` is 20000; it must be 1 to 16384"),
        (json!({"scale": "x"}), "`scale` is \"x\"; a finite number is needed"),
        (json!({"scale": 0}), "`scale` is 0; it must be finite and above 0"),
        (json!({"rotate_y": 1e7}), "`rotate_y` is 10000000; it must be between"),
        (json!({"mirror": 1}), "`mirror` is 1; a boolean is needed"),
        (json!({"lobe": "ggxx"}), "`lobe` is \"ggxx\"; must be ggx, phong, cone, cosine or charlie"),
        (json!({"pixel": "auto"}), "`pixel` is \"auto\"; must be f16, f32"),
        (json!({"pad": {}}), "`pad` is {}; a text is needed"),
        (json!({"filter": "fitted:4"}), "`filter` is \"fitted:4\"; fitted:K is no more; use pyramid"),
        (json!({"skybox": 0}), "`skybox` is 0; must be 1 to 16384, or source"),
        (json!({"target": "quake"}), "`target` is \"quake\"; there are generic, three"),
        (json!({"target": ["three", "three"]}), "`target` names three twice"),
        (json!({"target": "three", "name": "a/b"}), "`name` is \"a/b\"; it must be a file name"),
        (json!({"sunless": true}), "`sunless` writes the environment without its sun; set `extract_sun`"),
        (json!({"strict": true, "sanitize": true}), "`strict` and `sanitize` contradict"),
        (json!({"crop": true, "layout": "cross"}), "`pad` and `crop` are for panoramas"),
        (json!({"map": "cube"}), "`map` is for pyramids; choose `target` pyramid, or omit it"),
        (json!({"target": "three", "map": "cube"}), "target three has no pyramid; omit `map` cube"),
        (json!({"flip": "x"}), "`flip` and `diffuse` are for targets"),
        (json!({"diffuse": "sh"}), "`flip` and `diffuse` are for targets"),
        (json!({"scan": "blocks"}), "`scan` blocks is for the filter over a summed-area table"),
    ] {
        let message = refusal(given.clone());
        assert!(message.starts_with(error), "{given}: {message}");
    }
}

#[test]
fn typings_have_every_option() {
    let (javascript, python) = (read("npm/js/index.d.ts"), read("python/octagloss/_octagloss.pyi"));
    let recipe = serde_json::to_value(Recipe::default()).unwrap();
    for name in recipe.as_object().unwrap().keys() {
        let mut words = name.split('_').map(str::to_owned);
        let first = words.next().unwrap();
        let camel = words.fold(first, |text, word| text + &word[..1].to_uppercase() + &word[1..]);
        assert!(
            javascript.contains(&format!("\n    {camel}?: "))
                || javascript.contains(&format!("\n    {camel}?:\n")),
            "npm/js/index.d.ts lacks {camel}"
        );
        let own = match name.as_str() {
            // Python draws no previews, and has methods for suns.
            "preview" | "exposure" | "sunless" | "extract_sun" => continue,
            "format" => "container",
            "out_layout" => "layout",
            name => name,
        };
        assert!(
            python.contains(&format!("\n    {own}: ")) || python.contains(&format!("\n        {own}: ")),
            "python/octagloss/_octagloss.pyi lacks {own}"
        );
    }
}

#[test]
fn typings_page_and_help_have_every_word() {
    let (typings, page) = (read("npm/js/index.d.ts"), read("web/bake.js"));
    let help = std::process::Command::new(env!("CARGO_BIN_EXE_octagloss")).args(["bake", "--help"]).output();
    let help = String::from_utf8(help.unwrap().stdout).unwrap();
    let mut lists = 0;
    for name in serde_json::to_value(Recipe::default()).unwrap().as_object().unwrap().keys() {
        let kebab = name.replace('_', "-");
        assert!(help.contains(&format!("--{kebab}")), "the help lacks --{kebab}");
        let Err(error) = from_json::<Recipe>(options(json!({ (name): "?" }))) else { continue };
        let error = error.to_string();
        let Some((_, words)) = error.split_once("must be ") else { continue };
        let words: Vec<&str> = words.split(", ").flat_map(|words| words.split(" or ")).collect();
        if words.len() < 3 || words.iter().any(|word| word.contains([' ', ':'])) {
            continue;
        }
        lists += 1;
        assert!(page.contains(&format!("'{kebab}'")), "web/bake.js lacks {kebab}");
        for word in words {
            assert!(typings.contains(&format!("'{word}'")), "npm/js/index.d.ts lacks {word} of {name}");
            assert!(help.contains(word), "the help lacks {word} of --{kebab}");
            let held = [" ", "'"].map(|c| page.contains(&format!("{word}{c}")));
            assert!(held.contains(&true), "web/bake.js lacks {word} of {kebab}");
        }
    }
    assert!(lists >= 9, "{lists} options have words");
}

/// Bakes are judged against their source as they record it.
#[test]
fn files_record_every_option_that_changes_the_input() {
    let recorded = serde_json::to_value(Provenance::default()).unwrap();
    for name in serde_json::to_value(InputOptions::default()).unwrap().as_object().unwrap().keys() {
        // How a file is read says nothing of its light, and of suns those that were found are recorded.
        if !["layout", "sanitize", "strict", "extract_sun"].contains(&name.as_str()) {
            assert!(recorded.get(name).is_some(), "Provenance lacks {name}");
        }
    }
}
