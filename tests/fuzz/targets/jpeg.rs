#![no_main]

use libfuzzer_sys::fuzz_target;
use octagloss_fuzz::read_environment;

fuzz_target!(|bytes: &[u8]| read_environment("sky.jpg", &[0xff, 0xd8, 0xff], bytes));
