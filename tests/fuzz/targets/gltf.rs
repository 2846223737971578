#![no_main]

//! A self-contained glTF file: JSON with data URIs, or binary.

use libfuzzer_sys::fuzz_target;
use octagloss_fuzz::read_mesh;

fuzz_target!(|bytes: &[u8]| read_mesh(if bytes.starts_with(b"glTF") { "a.glb" } else { "a.gltf" }, bytes));
