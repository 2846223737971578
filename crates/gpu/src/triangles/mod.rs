//! Triangles around the origin, to be drawn straight into maps of the sphere.

mod map;
pub mod scene;

pub use map::DirectMap;

use octagloss_core::common::error::{Result, wrong};

/// Largest coordinate and near distance, and the inverse of the least near distance: sums and products of
/// three coordinates stay finite in float32.
pub const MAX: f32 = 1e12;

/// A corner of a triangle, in the layout of vertex and storage buffers.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Corner {
    /// Position; the map's centre is the origin.
    pub position: [f32; 3],
    /// Octant of a piece of a triangle that was cut at the coordinate planes; 0 elsewhere.
    pub octant: u32,
    /// Four numbers that triangles interpolate, such as radiance and opacity.
    pub value: [f32; 4],
}

impl Corner {
    /// A corner of a whole triangle.
    pub const fn new(position: [f32; 3], value: [f32; 4]) -> Self {
        Self { position, octant: 0, value }
    }
}

/// Triangles with valid indices and finite corners.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangles {
    corners: Vec<Corner>,
    indices: Vec<u32>,
}

impl Triangles {
    /// Triangles of three `indices` each into `corners`.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for an empty mesh, indices that are out of range
    /// or not whole triangles, and corners that are not finite or beyond [`MAX`].
    pub fn new(corners: Vec<Corner>, indices: Vec<u32>) -> Result<Self> {
        if corners.is_empty() || indices.is_empty() {
            return wrong(format!(
                "a mesh of {} corners and {} indices is empty; pass at least one triangle",
                corners.len(),
                indices.len()
            ));
        }
        if !indices.len().is_multiple_of(3) {
            return wrong(format!(
                "{} indices are not whole triangles; pass three per triangle",
                indices.len()
            ));
        }
        if let Some(place) = indices.iter().position(|index| *index as usize >= corners.len()) {
            return wrong(format!(
                "index {} at position {place} is out of range; the mesh has {} corners, use 0 to {}",
                indices[place],
                corners.len(),
                corners.len() - 1
            ));
        }
        for (place, Corner { position, value, .. }) in corners.iter().enumerate() {
            // Also true for NaN.
            if !position.iter().all(|x| x.abs() <= MAX) {
                let [x, y, z] = position;
                return wrong(format!(
                    "corner {place} is at ({x}, {y}, {z}); coordinates must be finite and at most {MAX:e}"
                ));
            }
            if let Some(at) = value.iter().position(|number| !number.is_finite()) {
                return wrong(format!(
                    "value {at} of corner {place} is {}; values must be finite",
                    value[at]
                ));
            }
        }
        Ok(Self { corners, indices })
    }

    /// The corners.
    pub fn corners(&self) -> &[Corner] {
        &self.corners
    }

    /// Three indices per triangle.
    pub fn indices(&self) -> &[u32] {
        &self.indices
    }

    /// Number of triangles.
    pub fn count(&self) -> usize {
        self.indices.len() / 3
    }
}

/// Checks the distance of the near surface.
///
/// # Errors
/// [`octagloss_core::common::error::Error::Parameter`] unless it is between 1 / [`MAX`] and [`MAX`].
pub fn check_near(near: f32) -> Result<()> {
    if (1.0 / MAX..=MAX).contains(&near) {
        return Ok(());
    }
    wrong(format!("`near` is {near}; choose a distance from {:e} to {MAX:e}", 1.0 / MAX))
}

#[cfg(test)]
mod tests {
    use super::{Corner, Triangles, check_near};

    fn message(positions: &[[f32; 3]], indices: &[u32]) -> String {
        let corners = positions.iter().map(|position| Corner::new(*position, [1.0; 4])).collect();
        Triangles::new(corners, indices.to_vec()).expect_err("an invalid mesh").to_string()
    }

    #[test]
    fn bad_meshes_are_errors_that_name_the_place() {
        let three = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let bad = |value| [three[0], [0.0, value, 0.0], three[2]];
        for (positions, indices, parts) in [
            (&[][..], &[][..], &["0 corners", "empty"][..]),
            (&three, &[], &["0 indices", "empty"]),
            (&three, &[0, 1], &["2 indices", "whole triangles"]),
            (&three, &[0, 1, 3], &["index 3 at position 2", "3 corners", "0 to 2"]),
            (&bad(f32::NAN), &[0, 1, 2], &["corner 1", "NaN", "finite"]),
            (&bad(f32::INFINITY), &[0, 1, 2], &["corner 1", "inf"]),
            (&bad(-1e13), &[0, 1, 2], &["corner 1", "1e12"]),
        ] {
            let message = message(positions, indices);
            assert!(parts.iter().all(|part| message.contains(part)), "{message}");
        }
        let mut corners = three.map(|position| Corner::new(position, [1.0; 4])).to_vec();
        corners[2].value[3] = f32::NAN;
        let message = Triangles::new(corners, vec![0, 1, 2]).expect_err("a NaN").to_string();
        assert!(message.contains("value 3 of corner 2 is NaN"), "{message}");
    }

    #[test]
    fn near_is_a_positive_distance() {
        assert!(check_near(0.1).is_ok());
        for near in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-13] {
            let message = check_near(near).expect_err("a bad distance").to_string();
            assert!(message.contains("`near`") && message.contains("1e12"), "{message}");
        }
    }
}
