#![no_main]

use libfuzzer_sys::fuzz_target;
use octagloss_fuzz::read_mesh;

fuzz_target!(|bytes: &[u8]| read_mesh("a.obj", bytes));
