#![no_main]

//! A report that can be read survives a round trip through JSON.

use libfuzzer_sys::fuzz_target;
use octagloss::internals::bake::report::Report;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(report) = serde_json::from_slice::<Report>(bytes) {
        let text = serde_json::to_string(&report).expect("keys are strings");
        let again: Report = serde_json::from_str(&text).expect("what was written can be read");
        assert_eq!(serde_json::to_string(&again).expect("keys are strings"), text);
    }
});
