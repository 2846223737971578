//! Flipped cubes, for engines that negate a coordinate at cube look-ups.

use crate::common::names::named;
use crate::light::chain::Level;
use crate::sphere::cube::{Face, cube_from_direction, cube_point};
use glam::DVec3;
use std::borrow::Cow;

/// Axis along which an engine negates a world direction before a cube look-up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Flip {
    /// None: the cube is looked up with world directions.
    #[default]
    None,
    /// (x, y, z) is looked up at (-x, y, z).
    X,
    /// (x, y, z) is looked up at (x, y, -z).
    Z,
}

named!(Flip { None = "none", X = "x", Z = "z" });

impl Flip {
    /// Maps a world direction to the engine's look-up direction, and back.
    #[must_use]
    pub fn apply(self, direction: DVec3) -> DVec3 {
        match self {
            Self::None => direction,
            Self::X => DVec3::new(-direction.x, direction.y, direction.z),
            Self::Z => DVec3::new(direction.x, direction.y, -direction.z),
        }
    }
}

/// Flips `levels`: their content at a direction moves to the flipped direction. Texels are permuted, not
/// resampled.
pub fn flipped(levels: &[Level], flip: Flip) -> Cow<'_, [Level]> {
    if flip == Flip::None {
        return Cow::Borrowed(levels);
    }
    let flipped = |level: &Level| Level {
        layout: level.layout,
        roughness: level.roughness,
        texels: flipped_texels(&level.texels, level.size(), flip),
        bounds: level.bounds.as_ref().map(|bounds| flipped_texels(bounds, level.size(), flip)),
    };
    Cow::Owned(levels.iter().map(flipped).collect())
}

/// The `values` of a cube's texels, flipped: a face maps to one face, and rows and columns to rows and
/// columns.
pub fn flipped_texels<T: Copy>(values: &[T], size: u32, flip: Flip) -> Vec<T> {
    let n = size as usize;
    let mut permuted = Vec::with_capacity(values.len());
    for face in Face::ALL {
        let (face, s, t) = cube_from_direction(flip.apply(cube_point(face, 0.5, 0.5)));
        for j in 0..n {
            let row = face.index() * n + if t > 0.0 { j } else { n - 1 - j };
            let row = &values[row * n..(row + 1) * n];
            if s > 0.0 { permuted.extend_from_slice(row) } else { permuted.extend(row.iter().rev()) }
        }
    }
    permuted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::cube::direction_from_texel;

    #[test]
    fn a_flipped_level_shows_at_flipped_directions_what_it_showed() {
        for size in [1, 2, 5, 8] {
            let direction = |k: u32| {
                direction_from_texel(Face::ALL[(k / (size * size)) as usize], size, k % size, k / size % size)
            };
            let texels = (0..6 * size * size).map(|k| direction(k).as_vec3().to_array()).collect();
            let levels = [Level::cube(size, 0.0, texels)];
            for flip in [Flip::None, Flip::X, Flip::Z] {
                let flipped = flipped(&levels, flip);
                for (k, texel) in (0..).zip(&flipped[0].texels) {
                    let expected = flip.apply(direction(k)).as_vec3();
                    assert!(
                        (glam::Vec3::from_array(*texel) - expected).length() < 1e-6,
                        "{flip:?} {size} {k}"
                    );
                }
                assert_eq!(self::flipped(&flipped, flip)[..], levels, "twice is none");
            }
        }
    }
}
