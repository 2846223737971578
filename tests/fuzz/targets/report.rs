#![no_main]

//! A recipe that can be read survives a round trip through JSON.

use libfuzzer_sys::fuzz_target;
use octagloss_core::files::recipe::Recipe;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(recipe) = serde_json::from_slice::<Recipe>(bytes) {
        let text = serde_json::to_string(&recipe).expect("keys are strings");
        let again: Recipe = serde_json::from_str(&text).expect("what was written can be read");
        assert_eq!(again, recipe);
    }
});
