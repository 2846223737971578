#![no_main]

use libfuzzer_sys::fuzz_target;
use octagloss::internals::cli::directions::{LIMITS, Limits, read_either};
use octagloss_fuzz::assert_plain;

fuzz_target!(|bytes: &[u8]| {
    match read_either(bytes, Limits { rows: 50, ..LIMITS }) {
        Ok(directions) => {
            assert!(directions.asked.len() <= 50);
            for asked in directions.asked {
                assert!((asked.direction.length() - 1.0).abs() < 1e-9, "{:?}", asked.typed);
            }
        }
        Err(error) => assert_plain(&format!("{error:#}")),
    }
});
