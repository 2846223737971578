#![no_main]

#[path = "../../../src/cli/directions.rs"]
#[allow(dead_code, reason = "the command line uses the rest")]
mod directions;

use directions::{LIMITS, Limits, parse_directions};
use libfuzzer_sys::fuzz_target;
use octagloss_fuzz::assert_plain;

fuzz_target!(|bytes: &[u8]| {
    match parse_directions(bytes, Limits { rows: 50, ..LIMITS }) {
        Ok(asked) => {
            assert!(asked.len() <= 50);
            for asked in asked {
                assert!((asked.direction.length() - 1.0).abs() < 1e-9, "{:?}", asked.typed);
            }
        }
        Err(error) => assert_plain(&format!("{error:#}")),
    }
});
