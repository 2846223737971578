#![no_main]

use libfuzzer_sys::fuzz_target;
use octagloss_core::files::io::read_chain_from_memory;
use octagloss_fuzz::{MEMORY_LIMIT, assert_plain};
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    match read_chain_from_memory(Path::new("chain.ktx2"), bytes, MEMORY_LIMIT) {
        Ok(chain) => {
            for level in &chain.levels {
                assert_eq!(level.texels.len(), 6 * level.size() as usize * level.size() as usize);
                assert!(level.texels.as_flattened().iter().all(|c| c.is_finite()));
            }
        }
        Err(error) => assert_plain(&error.to_string()),
    }
});
