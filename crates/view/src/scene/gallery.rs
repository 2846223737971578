//! The built-in scene, and scenes from files.

use super::content::{Scene, SceneLight};
use super::look::{Proxy, SceneLook};
use super::part::{Gloss, Motion, Part};
use super::uniforms::{MAX_PROBES, SceneCorner};
use crate::look::camera::{Camera, FRONT};
use crate::picture::mip_levels::Space;
use glam::DVec3;
use octagloss_core::common::error::Result;
use octagloss_mesh::{Image, Material, Mesh, Texture, Vertex, Wrap, box_around};
use std::collections::HashMap;

/// Half edges of the built-in room.
const ROOM: DVec3 = DVec3::new(5.0, 2.5, 5.0);

/// Albedo of triangles without a material.
const GREY: [f32; 3] = [0.6; 3];

/// Least metalness of glossy parts.
const METALLIC: f64 = 0.5;

/// Edges from pole to pole of balls that reflect, and of others.
const FINE: u32 = 48;
const COARSE: u32 = 24;

impl Scene {
    /// The built-in scene: three glossy balls in a room of coloured walls, one of which moves, and a cube and
    /// two balls that circle them.
    ///
    /// # Errors
    /// None; the scene is valid.
    pub fn gallery() -> Result<Self> {
        let room = Part::room(ROOM, 10, |axis, middle| {
            let squares = (middle.x.floor() + middle.z.floor()).rem_euclid(2.0);
            let panel = middle.x.abs().max(middle.z.abs()) < 2.0;
            match axis {
                DVec3::Y if panel => [[0.8; 3], [2.2, 2.1, 1.9]],
                DVec3::Y => [[0.8; 3], [0.0; 3]],
                DVec3::NEG_Y => [[0.25 + 0.35 * squares as f32; 3], [0.0; 3]],
                DVec3::X => [[0.75, 0.72, 0.65], [0.0; 3]],
                DVec3::NEG_X => [[0.45, 0.50, 0.65], [0.0; 3]],
                DVec3::Z => [[0.25, 0.55, 0.30], [0.0; 3]],
                _ => [[0.70, 0.30, 0.22], [0.0; 3]],
            }
        });
        let ball = |at: f64, reflectance, roughness, motion| Part {
            place: DVec3::new(0.0, 0.0, at),
            gloss: Some(Gloss { reflectance, roughness }),
            motion,
            ..Part::ball(0.55, FINE, [0.0; 3], [0.0; 3])
        };
        let circle = |part: Part, height: f64, phase: f64| Part {
            place: DVec3::new(0.0, height, 0.0),
            motion: Motion {
                axis: DVec3::new(1.2, 0.25, 0.0),
                across: DVec3::new(0.0, 0.2, 2.4),
                rate: 0.1,
                phase,
                spin: 0.15,
            },
            ..part
        };
        let cube = Part::cuboid(DVec3::splat(0.28), 1, |axis, _| {
            [[0.8, 0.1 + 0.1 * axis.y as f32, 0.08], [0.3, 0.02, 0.02]]
        });
        let bob = Motion { axis: DVec3::new(0.0, 0.3, 0.0), rate: 0.2, phase: 0.25, ..Motion::default() };
        let scene = Self::new(
            vec![
                room,
                ball(-1.45, [0.95, 0.93, 0.88], 0.08, Motion::default()),
                ball(0.0, [0.98, 0.78, 0.42], 0.25, bob),
                ball(1.45, [0.93, 0.94, 0.95], 0.5, Motion::default()),
                circle(cube, 0.1, 0.1),
                circle(Part::ball(0.22, COARSE, [0.1, 0.7, 0.15], [0.02, 0.2, 0.03]), -0.3, 0.43),
                circle(Part::ball(0.2, COARSE, [0.1, 0.2, 0.8], [0.04, 0.1, 0.9]), 0.5, 0.77),
            ],
            SceneLight::default(),
        )?;
        // Reflections come from the walls.
        Ok(Self { first_look: SceneLook { proxy: Proxy::Box, ..SceneLook::default() }, ..scene })
    }

    /// The scene of `mesh`, under a sky, with a bright ball that circles it. Connected metal triangles are
    /// glossy parts, the largest first, with the mean of their base colour; a mesh without metals gets a
    /// glossy ball above it.
    ///
    /// # Errors
    /// Those of [`Scene::textured`].
    pub fn of_mesh(mesh: &Mesh) -> Result<Self> {
        // By material, after those without one.
        let mut matte = vec![Part::default(); mesh.materials.len() + 1];
        let mut metals = Vec::new();
        for submesh in &mesh.parts {
            let indices = &mesh.indices[submesh.indices.start as usize..submesh.indices.end as usize];
            let Some(number) = submesh.material else {
                append(&mut matte[0], mesh, indices, None);
                continue;
            };
            let material = &mesh.materials[number];
            let (metallic, roughness) = mean_surface(mesh, material, indices);
            if metallic < METALLIC {
                append(&mut matte[number + 1], mesh, indices, Some(material));
                continue;
            }
            for indices in connected(mesh, indices) {
                metals.push((indices, number, roughness));
            }
        }
        metals.sort_by_key(|(indices, ..)| std::cmp::Reverse(indices.len()));
        let few = metals.split_off(metals.len().min(MAX_PROBES));
        for (indices, number, _) in &few {
            append(&mut matte[number + 1], mesh, indices, Some(&mesh.materials[*number]));
        }
        let mut parts: Vec<Part> = metals
            .iter()
            .map(|(indices, number, roughness)| {
                let material = &mesh.materials[*number];
                let mut part = Part::default();
                append(&mut part, mesh, indices, Some(material));
                let reflectance = mean_base(mesh, material, &part);
                let gloss = Some(Gloss { reflectance, roughness: *roughness });
                centred(Part { gloss, base_texture: None, ..part })
            })
            .collect();
        let top = mesh.vertices.iter().map(|vertex| f64::from(vertex.position[1])).fold(-1.0, f64::max);
        if parts.is_empty() {
            parts.push(Part {
                place: DVec3::new(0.0, top + 0.3, 0.0),
                gloss: Some(Gloss { reflectance: [0.95, 0.93, 0.88], roughness: 0.15 }),
                ..Part::ball(0.25, FINE, [0.0; 3], [0.0; 3])
            });
        }
        parts.extend(matte.into_iter().filter(|part| !part.indices.is_empty()));
        parts.push(Part {
            motion: Motion {
                axis: DVec3::new(1.3, 0.0, 0.0),
                across: DVec3::new(0.0, 0.3, 1.3),
                rate: 0.1,
                phase: 0.35,
                spin: 0.0,
            },
            ..Part::ball(0.1, COARSE, [0.8, 0.5, 0.2], [3.0, 1.5, 0.4])
        });
        parts.push(sky());
        let scene = Self::textured(parts, &mesh.images, SceneLight::default())?;
        let look = SceneLook::default();
        // Models face +Z.
        let camera = Camera { yaw: FRONT, ..look.camera };
        Ok(Self { first_look: SceneLook { camera, ..look }, ..scene })
    }
}

/// A dome from dark ground to a bright horizon and a blue zenith.
fn sky() -> Part {
    let mut dome = Part { distant: true, ..Part::ball(60.0, FINE, [0.0; 3], [0.0; 3]) };
    for corner in &mut dome.corners {
        let height = corner.normal[1];
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t.clamp(0.0, 1.0);
        let [ground, horizon, zenith] = [[0.16, 0.14, 0.12], [0.85, 0.85, 0.82], [0.25, 0.42, 0.8]];
        corner.emission = std::array::from_fn(|c| {
            if height < 0.0 {
                mix(horizon[c], ground[c], -8.0 * height)
            } else {
                mix(horizon[c], zenith[c], 1.5 * height)
            }
        });
    }
    dome
}

/// Adds the triangles of `indices` to `part`.
fn append(part: &mut Part, mesh: &Mesh, indices: &[u32], material: Option<&Material>) {
    part.base_texture = material.and_then(|material| material.base_texture);
    part.emission_texture = material.and_then(|material| material.emission_texture);
    let emission = material.map_or([0.0; 3], |material| material.emission);
    let mut numbers = HashMap::new();
    for index in indices {
        let number = *numbers.entry(*index).or_insert_with(|| {
            let Vertex { position, normal, colour, uv, .. } = mesh.vertices[*index as usize];
            let factors = |material: &Material| std::array::from_fn(|c| material.base[c] * colour[c]);
            let albedo = material.map_or(GREY, factors);
            part.corners.push(SceneCorner::new(position, normal, albedo, emission).at(uv));
            part.corners.len() as u32 - 1
        });
        part.indices.push(number);
    }
}

/// Moves the origin of `part` to the middle of its box.
fn centred(mut part: Part) -> Part {
    let (low, high) = box_around(part.corners.iter().map(SceneCorner::place));
    part.place = 0.5 * (low + high);
    for corner in &mut part.corners {
        corner.position = (corner.place() - part.place).as_vec3().to_array();
    }
    part
}

/// Mean base colour of the corners of `part`.
fn mean_base(mesh: &Mesh, material: &Material, part: &Part) -> [f32; 3] {
    let count = part.corners.len() as f32;
    let mut mean = [0.0; 3];
    for SceneCorner { albedo, u, v, .. } in &part.corners {
        let texture = sampled(mesh, material.base_texture, [*u, *v], Space::Srgb);
        (0..3).for_each(|c| mean[c] += albedo[c] * texture[c] / count);
    }
    mean
}

/// Mean metalness and roughness of `material` over the corners of `indices`.
fn mean_surface(mesh: &Mesh, material: &Material, indices: &[u32]) -> (f64, f64) {
    let mut sums = [0.0; 2];
    for index in indices {
        let vertex = &mesh.vertices[*index as usize];
        let [_, roughness, metallic] =
            sampled(mesh, material.surface_texture, vertex.surface_uv, Space::Linear);
        sums[0] += f64::from(material.metallic * metallic);
        sums[1] += f64::from(material.roughness * roughness);
    }
    let [metallic, roughness] = sums.map(|sum| sum / indices.len().max(1) as f64);
    (metallic, roughness.clamp(0.0, 1.0))
}

/// The texel of `texture` at `uv`, linear; 1 without a texture.
fn sampled(mesh: &Mesh, texture: Option<Texture>, uv: [f32; 2], space: Space) -> [f32; 3] {
    let Some(Texture { image, wrap, .. }) = texture else { return [1.0; 3] };
    let Image { width, height, texels } = &mesh.images[image];
    let place =
        |x: f32, wrap: Wrap, side: u32| ((wrap.within(f64::from(x)) * f64::from(side)) as u32).min(side - 1);
    let (x, y) = (place(uv[0], wrap[0], *width), place(uv[1], wrap[1], *height));
    let [red, green, blue, _] = texels[(y * width + x) as usize];
    [red, green, blue].map(|byte| space.light(byte))
}

/// The triangles of `indices` by connected surfaces: corners at one position are one.
fn connected(mesh: &Mesh, indices: &[u32]) -> Vec<Vec<u32>> {
    let mut numbers: HashMap<[u32; 3], usize> = HashMap::new();
    let mut parents: Vec<usize> = Vec::new();
    let corners: Vec<usize> = indices
        .iter()
        .map(|index| {
            // One zero.
            let key = mesh.vertices[*index as usize].position.map(|x| (x + 0.0).to_bits());
            *numbers.entry(key).or_insert_with(|| {
                parents.push(parents.len());
                parents.len() - 1
            })
        })
        .collect();
    let root = |parents: &mut Vec<usize>, mut at: usize| {
        while parents[at] != at {
            parents[at] = parents[parents[at]];
            at = parents[at];
        }
        at
    };
    for triangle in corners.chunks_exact(3) {
        let first = root(&mut parents, triangle[0]);
        for corner in &triangle[1..] {
            let other = root(&mut parents, *corner);
            parents[other] = first;
        }
    }
    let mut surfaces: Vec<Vec<u32>> = Vec::new();
    let mut places = HashMap::new();
    for (triangle, corners) in indices.chunks_exact(3).zip(corners.chunks_exact(3)) {
        let place = *places.entry(root(&mut parents, corners[0])).or_insert_with(|| {
            surfaces.push(Vec::new());
            surfaces.len() - 1
        });
        surfaces[place].extend(triangle);
    }
    surfaces
}

#[cfg(test)]
mod tests {
    use super::{Scene, connected};
    use octagloss_mesh::{Material, Mesh, SubMesh, Vertex};

    /// Two separate quads, each of two triangles with corners of their own.
    fn quads(material: Option<Material>) -> Mesh {
        let vertex = |x: f32, y: f32| Vertex {
            position: [x, y, 0.0],
            normal: [0.0, 0.0, 1.0],
            colour: [1.0; 4],
            uv: [0.0; 2],
            surface_uv: [0.0; 2],
        };
        let quad = |x: f32| {
            [[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.0], [0.5, 0.5], [0.0, 0.5]]
                .map(|[a, b]| vertex(x + a, b))
        };
        let vertices = [quad(-1.0), quad(0.25)].concat();
        let indices: Vec<u32> = (0..12).collect();
        let part = SubMesh { indices: 0..12, material: material.is_some().then_some(0) };
        Mesh {
            vertices,
            indices,
            parts: vec![part],
            materials: material.into_iter().collect(),
            images: vec![],
        }
    }

    #[test]
    fn metals_are_glossy_by_connected_surfaces() {
        let mesh =
            quads(Some(Material { base: [0.9, 0.5, 0.1, 1.0], roughness: 0.3, ..Material::default() }));
        assert_eq!(connected(&mesh, &mesh.indices), [(0..6).collect::<Vec<_>>(), (6..12).collect()]);
        let scene = Scene::of_mesh(&mesh).expect("a scene");
        assert_eq!(scene.glossy_parts(), 2);
        let gloss = scene.parts[scene.glossy().start].gloss.expect("a metal");
        assert!((gloss.roughness - 0.3).abs() < 1e-6 && (gloss.reflectance[1] - 0.5).abs() < 1e-6);
        let places: Vec<f64> = scene.glossy().map(|part| scene.place(part, 0.0).x).collect();
        assert!(places.contains(&-0.75) && places.contains(&0.5), "{places:?}");
    }

    #[test]
    fn meshes_without_metals_get_a_glossy_ball() {
        let plastic = Material { metallic: 0.0, emission: [0.5, 0.0, 0.0], ..Material::default() };
        for mesh in [quads(Some(plastic)), quads(None)] {
            let scene = Scene::of_mesh(&mesh).expect("a scene");
            assert_eq!(scene.glossy_parts(), 1);
            let lit = scene.corners.iter().any(|corner| corner.emission == [0.5, 0.0, 0.0]);
            assert_eq!(lit, !mesh.materials.is_empty());
        }
    }

    #[test]
    fn the_gallery_is_valid() {
        assert_eq!(Scene::gallery().expect("a scene").glossy_parts(), 3);
    }
}
