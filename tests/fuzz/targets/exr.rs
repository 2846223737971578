#![no_main]

use libfuzzer_sys::fuzz_target;
use octagloss_fuzz::read_environment;

fuzz_target!(|bytes: &[u8]| read_environment("sky.exr", &[0x76, 0x2f, 0x31, 0x01], bytes));
