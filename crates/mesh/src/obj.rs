//! Reads OBJ files, without their material libraries.

use super::{Builder, Corners, Mesh};
use glam::DMat4;
use octagloss_core::common::error::{Error, Result};
use std::borrow::Cow;
use std::io::Cursor;
use std::path::Path;

/// Reads the mesh in `bytes`, the OBJ file `path`.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh> {
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    let bytes = without_lines(bytes);
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(&*bytes), &options, no_materials)
        .map_err(|error| Error::input(path, error.to_string()))?;
    let mut builder = Builder::default();
    for (number, model) in models.iter().enumerate() {
        let mesh = &model.mesh;
        let finite = [("v", &mesh.positions), ("vn", &mesh.normals), ("vt", &mesh.texcoords)];
        for (keyword, values) in finite {
            if let Some(value) = values.iter().find(|value| !value.is_finite()) {
                return Err(Error::input(path, format!("{value} in a `{keyword}` line is not finite")));
            }
        }
        let threes = |values: &[f32]| -> Vec<[f32; 3]> { values.as_chunks().0.to_vec() };
        let positions = threes(&mesh.positions);
        let normals = (!mesh.normals.is_empty()).then(|| threes(&mesh.normals));
        // In OBJ v increases upwards.
        let uv = mesh.texcoords.as_chunks::<2>().0.iter().map(|[u, v]| [*u, 1.0 - v]);
        let uv: Option<Vec<[f32; 2]>> = (!mesh.texcoords.is_empty()).then(|| uv.collect());
        let corners = Corners {
            positions: &positions,
            // Some vertices of a group may have none.
            normals: normals.as_deref().filter(|normals| normals.len() == positions.len()),
            colours: None,
            uv: uv.as_deref().filter(|uv| uv.len() == positions.len()),
            surface_uv: None,
        };
        builder
            .add(&corners, &mesh.indices, None, DMat4::IDENTITY)
            .map_err(|message| Error::input(path, format!("group {number}: {message}")))?;
    }
    builder.finished(path, Vec::new())
}

/// Removes lines and points, which have no surface: the parser would read those with three vertices as
/// triangles.
fn without_lines(bytes: &[u8]) -> Cow<'_, [u8]> {
    let is_bare = |line: &[u8]| {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        matches!(words.next(), Some(b"l" | b"p"))
    };
    let lines = || bytes.split_inclusive(|byte| *byte == b'\n');
    if lines().any(is_bare) {
        lines().filter(|line| !is_bare(line)).flatten().copied().collect()
    } else {
        Cow::Borrowed(bytes)
    }
}
