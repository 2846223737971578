//! Splits triangles with textures, so that colours at their corners show the textures.
//!
//! Maps of probes interpolate the radiance of corners. Edges are halved until they are short, or shorter than
//! a texel. Wherever an edge is halved, all triangles of the place that have it are split: no crack opens
//! between parts with and without textures.

use super::part::Part;
use super::texture::Texels;
use super::uniforms::SceneCorner;
use glam::Vec3;
use std::collections::{HashMap, HashSet};

/// Halvings of the scene's diameter that lead to the longest edges: a 64th of the radius, which is about a
/// pixel of a probe's map of the default size, seen from a radius away.
const HALVINGS: i32 = 7;

/// Most triangles of a scene with split ones.
const MAX: usize = 1 << 17;

/// An edge: parts that move as one, and the ends.
type Edge = (usize, [[u32; 3]; 2]);

/// Splits triangles of `parts` with textures, in a scene of `radius`, and sets the spread of their corners.
pub(super) fn split(parts: &mut [Part], texels: &Texels, radius: f64) {
    if parts.iter().any(|part| part.textures().next().is_some()) {
        halve_long_edges(parts, texels, radius);
        parts.iter_mut().filter(|part| part.textures().next().is_some()).for_each(set_spreads);
    }
}

fn halve_long_edges(parts: &mut [Part], texels: &Texels, radius: f64) {
    if parts.iter().map(|part| part.indices.len() / 3).sum::<usize>() > MAX {
        return;
    }
    let spaces = spaces(parts);
    // Long edges first, so that no triangle stays coarse if there are too many.
    for length in (0..=HALVINGS).map(|k| 2.0 * radius * 0.5_f64.powi(k)) {
        loop {
            let long = long_edges(parts, &spaces, texels, length);
            if long.is_empty() {
                break;
            }
            let is_long = |part: usize, triangle: &[u32]| {
                sides(triangle).map(|side| long.contains(&edge(spaces[part], &parts[part].corners, side)))
            };
            let triangles = |(number, part): (usize, &Part)| -> usize {
                let of = |triangle| 1 + is_long(number, triangle).iter().filter(|long| **long).count();
                part.indices.chunks_exact(3).map(of).sum()
            };
            if parts.iter().enumerate().map(triangles).sum::<usize>() > MAX {
                return;
            }
            let halved: Vec<Part> = parts
                .iter()
                .enumerate()
                .map(|(number, part)| halved(part, |triangle| is_long(number, triangle)))
                .collect();
            parts.iter_mut().zip(halved).for_each(|(part, halved)| *part = halved);
        }
    }
}

/// For each part the first one that is at the same place at all times.
fn spaces(parts: &[Part]) -> Vec<usize> {
    let pose = |part: &Part| (part.place, part.motion);
    let first = |part: &Part| parts.iter().position(|other| pose(other) == pose(part));
    parts.iter().map(|part| first(part).expect("the part itself")).collect()
}

/// The sides of a triangle.
fn sides(triangle: &[u32]) -> [[u32; 2]; 3] {
    let [a, b, c] = [0, 1, 2].map(|k| triangle[k]);
    [[a, b], [b, c], [c, a]]
}

fn edge(space: usize, corners: &[SceneCorner], side: [u32; 2]) -> Edge {
    // One zero.
    let mut ends = side.map(|index| corners[index as usize].position.map(|x| (x + 0.0).to_bits()));
    ends.sort_unstable();
    (space, ends)
}

/// The edges of triangles with textures that are longer than `length`, and than a texel, and have a middle
/// in float32.
fn long_edges(parts: &[Part], spaces: &[usize], texels: &Texels, length: f64) -> HashSet<Edge> {
    let mut long = HashSet::new();
    for (part, space) in parts.iter().zip(spaces) {
        let Part { corners, indices, .. } = part;
        let images: Vec<[u32; 2]> = part.textures().map(|texture| texels.sides(texture)).collect();
        for side in indices.chunks_exact(3).flat_map(sides) {
            let [a, b] = side.map(|index| &corners[index as usize]);
            let [u, v] = [a.u - b.u, a.v - b.v].map(|x| f64::from(x.abs()));
            let is_beyond =
                |[width, height]: &[u32; 2]| (u * f64::from(*width)).max(v * f64::from(*height)) > 1.0;
            let is_long = images.iter().any(is_beyond) && a.place().distance(b.place()) > length;
            if is_long && ![a, b].map(|end| end.position).contains(&between(a, b).position) {
                long.insert(edge(*space, corners, side));
            }
        }
    }
    long
}

/// `part` with the sides halved that `is_long` names for a triangle.
fn halved(part: &Part, is_long: impl Fn(&[u32]) -> [bool; 3]) -> Part {
    let mut halved = Part { indices: Vec::new(), ..part.clone() };
    let mut middles = HashMap::new();
    let Part { corners, indices, .. } = &mut halved;
    for triangle in part.indices.chunks_exact(3) {
        let long = is_long(triangle);
        // Begins with a long side, and ends with the short one of three.
        let turn = match long {
            [_, false, true] => 2,
            [false, true, _] => 1,
            _ => 0,
        };
        let [a, b, c] = [0, 1, 2].map(|k| triangle[(k + turn) % 3]);
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                corners.push(between(&part.corners[a as usize], &part.corners[b as usize]));
                corners.len() as u32 - 1
            })
        };
        match long.iter().filter(|long| **long).count() {
            0 => indices.extend([a, b, c]),
            1 => {
                let ab = middle(a, b);
                indices.extend([a, ab, c, ab, b, c]);
            }
            2 => {
                let (ab, bc) = (middle(a, b), middle(b, c));
                indices.extend([ab, b, bc]);
                let place = |index: u32| Vec3::from_array(corners[index as usize].position);
                // The shorter diagonal.
                if place(a).distance(place(bc)) < place(ab).distance(place(c)) {
                    indices.extend([a, ab, bc, a, bc, c]);
                } else {
                    indices.extend([a, ab, c, ab, bc, c]);
                }
            }
            _ => {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                indices.extend([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca]);
            }
        }
    }
    halved
}

/// The corner halfway from `a` to `b`, the same as from `b` to `a`.
fn between(a: &SceneCorner, b: &SceneCorner) -> SceneCorner {
    // No sum overflows.
    let mean = |a: f32, b: f32| 0.5 * a + 0.5 * b;
    let means = |a: [f32; 3], b: [f32; 3]| std::array::from_fn(|k| mean(a[k], b[k]));
    let normal = Vec3::from_array(means(a.normal, b.normal));
    SceneCorner {
        position: means(a.position, b.position),
        normal: normal.normalize_or(Vec3::from_array(a.normal)).to_array(),
        u: mean(a.u, b.u),
        albedo: means(a.albedo, b.albedo),
        v: mean(a.v, b.v),
        emission: means(a.emission, b.emission),
        ..*a
    }
}

fn set_spreads(part: &mut Part) {
    for [a, b] in part.indices.chunks_exact(3).flat_map(sides) {
        let [from, to] = [a, b].map(|index| part.corners[index as usize]);
        let spread = (from.u - to.u).abs().max((from.v - to.v).abs());
        for index in [a, b] {
            let corner = &mut part.corners[index as usize];
            corner.spread = corner.spread.max(spread);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{MAX, Part, edge, sides, split};
    use crate::scene::texture::Texels;
    use crate::scene::uniforms::SceneCorner;
    use glam::{DVec3, Vec3};
    use octagloss_mesh::{Image, Texture, Wrap};
    use std::collections::{BTreeMap, HashMap};

    /// Triangles of a plane, with corners at their coordinates of the texture.
    fn part(corners: &[[f32; 2]], indices: &[u32], texture: Option<Texture>) -> Part {
        let corner = |[u, v]: &[f32; 2]| {
            SceneCorner::new([*u, *v, 0.3 * u], [0.0, 0.0, 1.0], [1.0; 3], [0.0; 3]).at([*u, *v])
        };
        let corners = corners.iter().map(corner).collect();
        Part { corners, indices: indices.to_vec(), base_texture: texture, ..Part::default() }
    }

    fn image(side: u32) -> Image {
        Image { width: side, height: side, texels: vec![[200; 4]; (side * side) as usize] }
    }

    const TEXTURE: Texture = Texture { image: 0, wrap: [Wrap::Repeat; 2], nearest: false };

    /// Splits `parts`, whose texture has `side` texels along an edge.
    fn parted(mut parts: Vec<Part>, side: u32, radius: f64) -> Vec<Part> {
        let texels = Texels::new(&[image(side)], std::iter::once(TEXTURE)).expect("a valid image");
        split(&mut parts, &texels, radius);
        parts
    }

    fn area(part: &Part) -> f32 {
        let place = |index: u32| Vec3::from_array(part.corners[index as usize].position);
        let of = |t: &[u32]| (place(t[1]) - place(t[0])).cross(place(t[2]) - place(t[0])).z;
        part.indices.chunks_exact(3).map(of).sum()
    }

    /// How many edges have one triangle, and the longest edge.
    fn border(parts: &[Part]) -> (usize, f64) {
        let mut counts = HashMap::new();
        let mut longest = 0.0_f64;
        for part in parts {
            for side in part.indices.chunks_exact(3).flat_map(sides) {
                *counts.entry(edge(0, &part.corners, side)).or_insert(0) += 1;
                let [a, b] =
                    side.map(|k| DVec3::from_array(part.corners[k as usize].position.map(f64::from)));
                longest = longest.max(a.distance(b));
            }
        }
        assert!(counts.values().all(|count| *count <= 2), "an edge has two triangles at most");
        (counts.values().filter(|count| **count == 1).count(), longest)
    }

    /// A square of which the right half has no texture, with a sliver beside.
    fn square() -> Vec<Part> {
        let corners =
            [[-1.0, -1.0], [0.0, -1.0], [1.0, -1.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.01, 0.9]];
        vec![
            part(&corners, &[0, 1, 4, 0, 4, 5, 0, 5, 6], Some(TEXTURE)),
            part(&corners, &[1, 2, 3, 1, 3, 4], None),
        ]
    }

    #[test]
    fn edges_become_short_and_no_crack_opens() {
        let whole: f32 = square().iter().map(area).sum();
        let parts = parted(square(), 1024, 1.5);
        let (border, longest) = border(&parts[..1]);
        assert!(longest <= 1.5 / 64.0 && border > 64 * 4, "{border} {longest}");
        let areas: Vec<f32> = parts.iter().map(area).collect();
        assert!((areas.iter().sum::<f32>() - whole).abs() < 1e-3, "{areas:?}");
        // Along the seam both parts have the same edges; with a coarser part they would not.
        let seam = |part: &Part| -> BTreeMap<[[u32; 3]; 2], usize> {
            let mut counts = BTreeMap::new();
            for side in part.indices.chunks_exact(3).flat_map(sides) {
                if side.iter().all(|k| part.corners[*k as usize].u == 0.0) {
                    *counts.entry(edge(0, &part.corners, side).1).or_insert(0) += 1;
                }
            }
            counts
        };
        assert!(seam(&parts[0]).len() >= 128, "{}", seam(&parts[0]).len());
        assert_eq!(seam(&parts[0]), seam(&parts[1]));
        assert_ne!(seam(&parts[0]), seam(&square()[1]));
        // A part that moves by itself is no neighbour.
        let mut apart = square();
        apart[1].place = DVec3::Y;
        assert_eq!(parted(apart, 1024, 1.5)[1].indices.len(), 6);
    }

    #[test]
    fn edges_of_a_texel_are_not_split() {
        let triangles = |side| parted(square(), side, 1.5)[0].indices.len() / 3;
        assert!(triangles(2) < triangles(4) && triangles(4) < triangles(8) && triangles(8) < triangles(1024));
        let spread = |side| {
            let corners = &parted(square(), side, 1.5)[0].corners;
            corners.iter().map(|corner| corner.spread).fold(0.0, f32::max)
        };
        assert!(spread(4) > 0.125 && spread(4) <= 0.25, "{}", spread(4));
        assert!(spread(1024) < 0.025, "{}", spread(1024));
    }

    #[test]
    fn triangles_are_bounded() {
        let count = |parts: &[Part]| parts.iter().map(|part| part.indices.len() / 3).sum::<usize>();
        let few = parted(square(), 8192, 1.5);
        assert!(count(&few) > MAX / 16 && count(&few) <= MAX, "{}", count(&few));
        // Edges are all long in a scene that is small beside them.
        let many = parted(square(), 8192, 0.01);
        assert!(count(&many) <= MAX, "{}", count(&many));
        let plain = vec![square().remove(1)];
        assert_eq!(parted(plain.clone(), 8192, 1.5), plain, "nothing without textures is split");
    }
}
