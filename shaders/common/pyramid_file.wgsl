// Reads of a pyramid's squares in its files: crates/core/src/files/io/pyramid_write.rs.
#include "common/pyramid_file_tables.wgsl"
#include "common/pyramid_squares.wgsl"

fn map_inner() -> f32 {
    return f32(1u << map_octave());
}
