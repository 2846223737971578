// Arranges workgroups in rows, for dispatches that exceed one dimension: `in_rows` of
// crates/gpu/src/device/stage.rs.

const ROW = 32768u;

// The index of a workgroup.
fn index_in_rows(group: vec3<u32>) -> u32 {
    return group.y * ROW + group.x;
}
