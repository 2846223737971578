#![no_main]

use libfuzzer_sys::fuzz_target;
use octagloss::cli::rows::{DIRECTIONS, LIMITS, Limits};
use octagloss_fuzz::assert_plain;

fuzz_target!(|bytes: &[u8]| {
    match DIRECTIONS.read_from(bytes, Limits { rows: 50, ..LIMITS }) {
        Ok(directions) => {
            assert!(directions.values.len() <= 50);
            for ((direction, _), typed) in directions.values.iter().zip(directions.typed) {
                assert!((direction.length() - 1.0).abs() < 1e-9, "{typed:?}");
            }
        }
        Err(error) => assert_plain(&format!("{error:#}")),
    }
});
