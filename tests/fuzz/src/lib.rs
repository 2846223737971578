//! Shared code of the fuzz targets.

use octagloss_core::files::io::{self, InputLayout, ReadOptions};
use std::path::Path;

/// Memory limit of a reader for one input, in bytes.
pub const MEMORY_LIMIT: u64 = 64 << 20;

/// Reads `bytes` as an environment if they begin with `magic`; `name` has the usual extension of the format.
pub fn read_environment(name: &str, magic: &[u8], bytes: &[u8]) {
    if bytes.starts_with(magic) {
        read_with_layout(name, bytes, InputLayout::Auto);
    }
}

/// Reads `bytes` as an environment in `layout` and checks the guarantees of the result.
pub fn read_with_layout(name: &str, bytes: &[u8], layout: InputLayout) {
    let options =
        ReadOptions { layout, sanitize: true, memory_limit: MEMORY_LIMIT, ..ReadOptions::default() };
    match io::read_from_memory(Path::new(name), bytes, &options) {
        Ok(loaded) => {
            let texels = loaded.environment.texels();
            assert_eq!(texels.len(), loaded.environment.layout().texel_count());
            assert!(texels.as_flattened().iter().all(|c| c.is_finite() && *c >= 0.0), "{}", loaded.format);
            loaded.warnings.iter().chain([&loaded.format]).for_each(|text| assert_plain(text));
        }
        Err(error) => assert_plain(&error.to_string()),
    }
}

/// Asserts that a message is short enough for a terminal and has no control characters.
pub fn assert_plain(message: &str) {
    assert!(message.len() < 2000, "{} bytes", message.len());
    assert!(!message.contains(char::is_control), "{message:?}");
}

/// Parses `bytes` as the mesh file `name` and checks the guarantees of the result.
pub fn read_mesh(name: &str, bytes: &[u8]) {
    match octagloss_mesh::Mesh::read_from_memory(Path::new(name), bytes) {
        Ok(mesh) => {
            let corners = mesh.vertices.len();
            let is_inside = |index: &u32| (*index as usize) < corners;
            assert!(mesh.indices.iter().all(is_inside), "an index within {corners}");
            let positions = mesh.vertices.iter().flat_map(|vertex| vertex.position);
            assert!(positions.into_iter().all(f32::is_finite), "positions are finite");
        }
        Err(error) => assert_plain(&error.to_string()),
    }
}
