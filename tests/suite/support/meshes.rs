//! Triangles around the origin whose values are their positions and a 1.

use super::common::Random;
use glam::{DMat3, DVec3};
use octagloss::internals::direct::{Corner, Triangles};
use std::collections::BTreeMap;
use std::ops::Range;

fn corner(position: DVec3) -> Corner {
    let [x, y, z] = position.as_vec3().to_array();
    Corner::new([x, y, z], [x, y, z, 1.0])
}

/// Separate triangles.
pub(crate) fn mesh(triangles: &[[DVec3; 3]]) -> Triangles {
    let corners: Vec<Corner> = triangles.iter().flatten().map(|position| corner(*position)).collect();
    let indices = (0..corners.len() as u32).collect();
    Triangles::new(corners, indices).expect("a valid mesh")
}

/// A surface that every ray from the origin meets once: an octahedron whose faces have `parts` edges along a
/// side, with corners at random distances. Turned at random by a `turn`; otherwise corners lie on the axes,
/// and edges on the coordinate planes.
pub(crate) fn closed(parts: i32, turn: Option<u64>, distance: Range<f64>) -> Triangles {
    let mut random = Random::new(turn.unwrap_or(0) + 100);
    let rotation = turn.map_or(DMat3::IDENTITY, |_| {
        DMat3::from_rotation_y(random.between(0.0, 6.0)) * DMat3::from_rotation_x(random.between(0.0, 6.0))
    });
    let mut corners = Vec::new();
    let mut numbers = BTreeMap::new();
    let mut indices = Vec::new();
    for octant in 0..8 {
        let sign = |bit: i32| if octant & bit == 0 { 1 } else { -1 };
        let mut number = |at: [i32; 3]| {
            let at = [at[0] * sign(1), at[1] * sign(2), at[2] * sign(4)];
            *numbers.entry(at).or_insert_with(|| {
                let direction = rotation * DVec3::from_array(at.map(f64::from)).normalize();
                corners.push(corner(direction * random.between(distance.start, distance.end)));
                corners.len() as u32 - 1
            })
        };
        for i in 0..parts {
            for j in 0..parts - i {
                let k = parts - 1 - i - j;
                indices.extend([[i + 1, j, k], [i, j + 1, k], [i, j, k + 1]].map(&mut number));
                if k > 0 {
                    let k = k - 1;
                    indices
                        .extend([[i, j + 1, k + 1], [i + 1, j, k + 1], [i + 1, j + 1, k]].map(&mut number));
                }
            }
        }
    }
    Triangles::new(corners, indices).expect("a valid mesh")
}
