//! Triangle meshes: a torus knot, and what glTF and OBJ files hold.

use super::roughness_map::RoughnessMap;
use crate::error::{Error, Result};
use glam::{DVec3, Mat4, Vec3};
use std::f64::consts::TAU;
use std::io::Cursor;
use std::path::Path;

/// A corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// Where it is.
    pub position: [f32; 3],
    /// The surface's unit normal there.
    pub normal: [f32; 3],
    /// Where it lies in maps.
    pub uv: [f32; 2],
}

/// Triangles within about 1 of the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Corners.
    pub vertices: Vec<Vertex>,
    /// Three a triangle.
    pub indices: Vec<u32>,
    /// The file's own roughness map.
    pub roughness: Option<RoughnessMap>,
}

/// Most corners that a file may have: more than that is no object to look at.
const MOST_VERTICES: usize = 20_000_000;

impl Mesh {
    /// A torus knot (2, 3): a tube that winds twice about +Y and three times about its own ring.
    #[must_use]
    pub fn knot() -> Self {
        const ALONG: u32 = 512;
        const AROUND: u32 = 48;
        const TUBE: f64 = 0.2;
        let curve = |t: f64| {
            let ring = 0.62 * (1.0 + 0.5 * (3.0 * t).cos());
            DVec3::new(ring * (2.0 * t).cos(), 0.34 * (3.0 * t).sin(), ring * (2.0 * t).sin())
        };
        let mut vertices = Vec::new();
        for i in 0..=ALONG {
            let t = f64::from(i % ALONG) / f64::from(ALONG) * TAU;
            let step = 1e-4;
            let (here, ahead, behind) = (curve(t), curve(t + step), curve(t - step));
            let tangent = (ahead - behind).normalize();
            // Across: away from the axis of the knot's ring, which the curve never touches.
            let outwards = here - tangent * here.dot(tangent);
            let across = outwards.normalize();
            let along = tangent.cross(across);
            for j in 0..=AROUND {
                let angle = f64::from(j % AROUND) / f64::from(AROUND) * TAU;
                let normal = across * angle.cos() + along * angle.sin();
                vertices.push(Vertex {
                    position: (here + TUBE * normal).as_vec3().to_array(),
                    normal: normal.as_vec3().to_array(),
                    uv: [6.0 * i as f32 / ALONG as f32, j as f32 / AROUND as f32],
                });
            }
        }
        let mut indices = Vec::new();
        for i in 0..ALONG {
            for j in 0..AROUND {
                let [a, b] = [i * (AROUND + 1) + j, (i + 1) * (AROUND + 1) + j];
                indices.extend([a, b, a + 1, a + 1, b, b + 1]);
            }
        }
        Self { vertices, indices, roughness: None }
    }

    /// The meshes of a file, as one, scaled and moved to within 1 of the origin: glTF (.gltf, .glb) or OBJ. Normals that
    /// are missing are the triangles'.
    ///
    /// # Errors
    /// [`Error::Io`] where the system refuses, [`Error::Input`] for a file that holds no mesh.
    pub fn read(path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
        match extension.as_str() {
            "gltf" => {
                // Its buffers and images lie beside it.
                std::fs::metadata(path).map_err(|error| Error::io(path, error))?;
                let imported = gltf::import(path).map_err(|error| Error::input(path, error.to_string()))?;
                from_gltf(path, imported)?.normalised(path)
            }
            _ => Self::read_from_memory(path, &std::fs::read(path).map_err(|e| Error::io(path, e))?),
        }
    }

    /// [`Mesh::read`] for a file in memory, which must be whole in itself: .glb, .obj, or .gltf with its data inside.
    ///
    /// # Errors
    /// [`Error::Input`] for a file that holds no mesh.
    pub fn read_from_memory(path: &Path, bytes: &[u8]) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
        match extension.as_str() {
            "glb" | "gltf" => {
                let imported =
                    gltf::import_slice(bytes).map_err(|error| Error::input(path, error.to_string()))?;
                from_gltf(path, imported)?.normalised(path)
            }
            "obj" => from_obj(path, bytes)?.normalised(path),
            _ => Err(Error::input(path, "no mesh by its name; .gltf, .glb and .obj are")),
        }
    }

    /// Moved to the origin and scaled to 1; refused where there is nothing to see.
    fn normalised(mut self, path: &Path) -> Result<Self> {
        if self.indices.is_empty() {
            return Err(Error::input(path, "no triangles"));
        }
        if let Some(index) = self.indices.iter().find(|index| **index as usize >= self.vertices.len()) {
            let message = format!("corner {index} is none of its {}", self.vertices.len());
            return Err(Error::input(path, message));
        }
        let places = || self.vertices.iter().map(|vertex| Vec3::from_array(vertex.position));
        let (low, high) = places().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), place| {
            (low.min(place), high.max(place))
        });
        let centre = 0.5 * (low + high);
        let radius = places().map(|place| place.distance(centre)).fold(0.0, f32::max);
        if !(radius.is_finite() && radius > 0.0) {
            return Err(Error::input(path, format!("corners from {low} to {high} make no object")));
        }
        for vertex in &mut self.vertices {
            vertex.position = ((Vec3::from_array(vertex.position) - centre) / radius).to_array();
            let normal = Vec3::from_array(vertex.normal).normalize_or(Vec3::Y);
            vertex.normal = normal.to_array();
        }
        Ok(self)
    }

    /// Adds corners and triangles; normals that are missing are the triangles', which then share no corners.
    fn add(
        &mut self,
        positions: &[Vec3],
        normals: Option<&[Vec3]>,
        uvs: Option<&[[f32; 2]]>,
        indices: &[u32],
    ) {
        let uv = |k: usize| uvs.and_then(|uvs| uvs.get(k)).copied().unwrap_or_default();
        let first = self.vertices.len() as u32;
        if let Some(normals) = normals.filter(|normals| normals.len() == positions.len()) {
            self.vertices.extend(positions.iter().zip(normals).enumerate().map(|(k, (position, normal))| {
                Vertex { position: position.to_array(), normal: normal.to_array(), uv: uv(k) }
            }));
            self.indices.extend(indices.iter().map(|index| first.saturating_add(*index)));
            return;
        }
        for triangle in indices.chunks_exact(3) {
            let corners = [0, 1, 2].map(|k| positions.get(triangle[k] as usize).copied());
            let [Some(a), Some(b), Some(c)] = corners else { continue };
            let normal = (b - a).cross(c - a).to_array();
            for (position, index) in [a, b, c].into_iter().zip(triangle) {
                self.indices.push(self.vertices.len() as u32);
                self.vertices.push(Vertex { position: position.to_array(), normal, uv: uv(*index as usize) });
            }
        }
    }

    const fn empty() -> Self {
        Self { vertices: Vec::new(), indices: Vec::new(), roughness: None }
    }
}

type Imported = (gltf::Document, Vec<gltf::buffer::Data>, Vec<gltf::image::Data>);

/// All triangles of the default scene, where its nodes put them.
fn from_gltf(path: &Path, (document, buffers, images): Imported) -> Result<Mesh> {
    let mut mesh = Mesh::empty();
    let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) else {
        return Err(Error::input(path, "no scene"));
    };
    let mut pending: Vec<(gltf::Node<'_>, Mat4)> = scene.nodes().map(|node| (node, Mat4::IDENTITY)).collect();
    while let Some((node, parent)) = pending.pop() {
        let world = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
            if primitive.mode() != gltf::mesh::Mode::Triangles {
                continue;
            }
            let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(|data| data.0.as_slice()));
            let Some(positions) = reader.read_positions() else { continue };
            let positions: Vec<Vec3> =
                positions.map(|p| world.transform_point3(Vec3::from_array(p))).collect();
            if mesh.vertices.len() + positions.len() > MOST_VERTICES {
                return Err(Error::input(path, format!("more than {MOST_VERTICES} corners")));
            }
            // Normals go by the inverse's transpose, which stretching does not tilt.
            let normal_matrix = glam::Mat3::from_mat4(world).inverse().transpose();
            let normals: Option<Vec<Vec3>> =
                reader.read_normals().map(|n| n.map(|n| normal_matrix * Vec3::from_array(n)).collect());
            let uvs: Option<Vec<[f32; 2]>> = reader.read_tex_coords(0).map(|uv| uv.into_f32().collect());
            let indices: Vec<u32> = match reader.read_indices() {
                Some(indices) => indices.into_u32().collect(),
                None => (0..positions.len() as u32).collect(),
            };
            if mesh.roughness.is_none() {
                let texture = primitive.material().pbr_metallic_roughness().metallic_roughness_texture();
                let image = texture.and_then(|info| images.get(info.texture().source().index()));
                mesh.roughness = image.and_then(roughness_of);
            }
            mesh.add(&positions, normals.as_deref(), uvs.as_deref(), &indices);
        }
        pending.extend(node.children().map(|child| (child, world)));
    }
    Ok(mesh)
}

/// The green channel, which is roughness in glTF's metallic-roughness maps.
fn roughness_of(image: &gltf::image::Data) -> Option<RoughnessMap> {
    let channels = match image.format {
        gltf::image::Format::R8G8 => 2,
        gltf::image::Format::R8G8B8 => 3,
        gltf::image::Format::R8G8B8A8 => 4,
        _ => return None,
    };
    let texels = image.pixels.chunks_exact(channels).map(|pixel| pixel[1]).collect();
    Some(RoughnessMap { width: image.width, height: image.height, texels })
}

fn from_obj(path: &Path, bytes: &[u8]) -> Result<Mesh> {
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    // Materials are of no use here, and their files may not be there.
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, no_materials)
        .map_err(|error| Error::input(path, error.to_string()))?;
    let mut mesh = Mesh::empty();
    for model in models {
        let threes = |values: &[f32]| -> Vec<Vec3> { values.chunks_exact(3).map(Vec3::from_slice).collect() };
        let positions = threes(&model.mesh.positions);
        let normals = (!model.mesh.normals.is_empty()).then(|| threes(&model.mesh.normals));
        // OBJ counts v upwards.
        let uvs: Vec<[f32; 2]> =
            model.mesh.texcoords.chunks_exact(2).map(|uv| [uv[0], 1.0 - uv[1]]).collect();
        let uvs = (!uvs.is_empty()).then_some(uvs);
        if mesh.vertices.len() + positions.len() > MOST_VERTICES {
            return Err(Error::input(path, format!("more than {MOST_VERTICES} corners")));
        }
        mesh.add(&positions, normals.as_deref(), uvs.as_deref(), &model.mesh.indices);
    }
    Ok(mesh)
}
