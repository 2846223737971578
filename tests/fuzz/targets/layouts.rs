#![no_main]

//! The last byte chooses the layout; the rest is a file of any format.

use libfuzzer_sys::fuzz_target;
use octagloss_core::files::io::InputLayout;
use octagloss_fuzz::read_with_layout;

const LAYOUTS: [InputLayout; 6] = [
    InputLayout::Auto,
    InputLayout::Equirect,
    InputLayout::Cross,
    InputLayout::Strip,
    InputLayout::Faces,
    InputLayout::Octahedral,
];

fuzz_target!(|bytes: &[u8]| {
    if let Some((layout, file)) = bytes.split_last() {
        read_with_layout("sky.hdr", file, LAYOUTS[usize::from(*layout) % LAYOUTS.len()]);
    }
});
