//! Triangle meshes: a torus knot, and meshes from glTF and OBJ files.

#![doc(hidden)]
#![allow(rustdoc::private_intra_doc_links, reason = "who works on the crate follows them")]

mod accessor;
mod confined;
mod gltf;
mod material;
mod obj;

pub use material::{Image, Material, Texture, Wrap};

use confined::Confined;
use glam::{DMat3, DMat4, DVec3};
use octagloss_core::common::error::{Error, Result};
use octagloss_core::files::io::panics::catching_panics;
use octagloss_core::files::io::regular::read_regular;
use std::f64::consts::TAU;
use std::ops::Range;
use std::path::Path;

/// A vertex.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// Position.
    pub position: [f32; 3],
    /// Unit normal of the surface.
    pub normal: [f32; 3],
    /// Factor of the base colour, linear.
    pub colour: [f32; 4],
    /// Coordinates in the texture of the base colour, and in the viewer's roughness map.
    pub uv: [f32; 2],
    /// Coordinates in the texture of metalness and roughness.
    pub surface_uv: [f32; 2],
}

/// Triangles of one material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SubMesh {
    /// Range of the mesh's indices; whole triangles.
    pub indices: Range<u32>,
    /// Index of the mesh's material; `None` if the file has none.
    pub material: Option<usize>,
}

/// Triangles within about 1 of the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Three indices per triangle.
    pub indices: Vec<u32>,
    /// All triangles, by material.
    pub parts: Vec<SubMesh>,
    /// The materials of the file.
    pub materials: Vec<Material>,
    /// The images of their textures.
    pub images: Vec<Image>,
}

/// Most vertices of a mesh, as read and as drawn.
pub const MAX_VERTICES: usize = 10_000_000;

/// Most indices of a mesh.
pub const MAX_INDICES: usize = 6 * MAX_VERTICES;

/// Most bytes of a mesh's file and of all files that it refers to.
pub(crate) const MAX_BYTES: u64 = 1 << 30;

impl Mesh {
    /// A torus knot (2, 3): a tube that winds twice about +Y and three times about its own ring.
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
                    colour: [1.0; 4],
                    uv: [6.0 * i as f32 / ALONG as f32, j as f32 / AROUND as f32],
                    surface_uv: [0.0; 2],
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
        let parts = vec![SubMesh { indices: 0..indices.len() as u32, material: None }];
        Self { vertices, indices, parts, materials: Vec::new(), images: Vec::new() }
    }

    /// Reads all meshes of a glTF (.gltf, .glb) or OBJ file as one, scaled and moved to within 1 of the
    /// origin. Missing normals are those of the triangles. Other files that it refers to must lie in its
    /// folder.
    ///
    /// # Errors
    /// Those of [`Mesh::read_within`].
    pub fn read(path: &Path) -> Result<Self> {
        Self::read_within(path, None)
    }

    /// [`Mesh::read`] for a mesh whose other files lie below the folder `root`, which also holds the mesh.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read, [`Error::Input`] if it holds no mesh or refers to files
    /// outside `root`, [`Error::Limit`] if the mesh is too large.
    pub fn read_within(path: &Path, root: Option<&Path>) -> Result<Self> {
        let read = reader(path)?;
        let bytes = read_regular(path, MAX_BYTES)?;
        let left = MAX_BYTES - bytes.len() as u64;
        let mut files = Confined::below(path, root, left)?;
        catching_panics(path, || read(path, &bytes, &mut files))
    }

    /// [`Mesh::read`] for a file in memory, which must be self-contained: .glb, .obj, or .gltf with embedded
    /// data.
    ///
    /// # Errors
    /// [`Error::Input`] if the file holds no mesh, [`Error::Limit`] if the mesh is too large.
    pub fn read_from_memory(path: &Path, bytes: &[u8]) -> Result<Self> {
        let read = reader(path)?;
        catching_panics(path, || read(path, bytes, &mut Confined::inside(path, MAX_BYTES)))
    }

    /// Moves the mesh to the origin and scales it to 1; rejects a mesh without triangles or extent.
    fn normalised(mut self, path: &Path) -> Result<Self> {
        if self.indices.is_empty() {
            return Err(Error::input(path, "no triangles; export surfaces, not points or lines"));
        }
        let place = |vertex: &Vertex| DVec3::from_array(vertex.position.map(f64::from));
        let (low, high) = box_around(self.vertices.iter().map(place));
        let centre = 0.5 * (low + high);
        let radius = self.vertices.iter().map(|vertex| place(vertex).distance(centre)).fold(0.0, f64::max);
        if !(radius.is_finite() && radius > 0.0) {
            return Err(Error::input(path, format!("vertices span {low} to {high}, which has no extent")));
        }
        for vertex in &mut self.vertices {
            vertex.position = ((place(vertex) - centre) / radius).as_vec3().to_array();
        }
        Ok(self)
    }
}

/// Least and greatest coordinates of `points`.
pub fn box_around(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
}

/// Whether the extension of `path` is that of a mesh.
pub fn is_mesh(path: &Path) -> bool {
    reader(path).is_ok()
}

/// Reads the mesh in a file's bytes; the last argument reads the files that it refers to.
type Reader = fn(&Path, &[u8], &mut Confined<'_>) -> Result<Mesh>;

/// The reader for the extension of `path`.
fn reader(path: &Path) -> Result<Reader> {
    match path.extension().unwrap_or_default().to_ascii_lowercase().to_str() {
        Some("glb" | "gltf") => Ok(gltf::read),
        Some("obj") => Ok(|path, bytes, _| obj::read(path, bytes)),
        _ => Err(Error::input(path, "unknown mesh format; use .gltf, .glb or .obj")),
    }
}

/// Attributes of vertices, all finite.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corners<'a> {
    pub(crate) positions: &'a [[f32; 3]],
    pub(crate) normals: Option<&'a [[f32; 3]]>,
    pub(crate) colours: Option<&'a [[f32; 4]]>,
    pub(crate) uv: Option<&'a [[f32; 2]]>,
    pub(crate) surface_uv: Option<&'a [[f32; 2]]>,
}

/// State while a mesh is read.
#[derive(Debug, Default)]
pub(crate) struct Builder {
    vertices: Vec<Vertex>,
    materials: Vec<Material>,
    /// Indices by material, after those without one.
    indices: Vec<Vec<u32>>,
    count: usize,
}

impl Builder {
    /// Vertices and indices that may still be added.
    pub(crate) fn room(&self) -> (usize, usize) {
        (MAX_VERTICES - self.vertices.len(), MAX_INDICES - self.count)
    }

    /// Adds `material`; returns its index.
    pub(crate) fn add_material(&mut self, material: Material) -> usize {
        self.materials.push(material);
        self.materials.len() - 1
    }

    /// Adds triangles of `material`, transformed by `world`. Where normals are missing, each vertex gets that
    /// of its triangle.
    ///
    /// # Errors
    /// The reason if they are rejected.
    pub(crate) fn add(
        &mut self,
        corners: &Corners<'_>,
        indices: &[u32],
        material: Option<usize>,
        world: DMat4,
    ) -> Result<(), String> {
        let count = corners.positions.len();
        let lengths = [
            ("NORMAL", corners.normals.map(<[_]>::len)),
            ("COLOR_0", corners.colours.map(<[_]>::len)),
            ("TEXCOORD", corners.uv.map(<[_]>::len)),
            ("TEXCOORD", corners.surface_uv.map(<[_]>::len)),
        ];
        for (name, length) in lengths {
            if let Some(length) = length.filter(|length| *length != count) {
                return Err(format!("{count} elements of POSITION, but {length} of {name}"));
            }
        }
        if let Some(place) = indices.iter().position(|index| *index as usize >= count) {
            return Err(format!(
                "index {} at position {place} is out of range for {count} vertices",
                indices[place]
            ));
        }
        let (room, room_of_indices) = self.room();
        let added = if corners.normals.is_some() { count } else { indices.len() };
        if added > room || indices.len() > room_of_indices {
            return Err(format!("more than {MAX_VERTICES} vertices or {MAX_INDICES} indices in total"));
        }
        let axes = DMat3::from_mat4(world);
        // A reflection reverses the winding of triangles.
        let mirrored = axes.determinant() < 0.0;
        // Cofactors keep normals perpendicular under non-uniform scale, and exist for every matrix.
        let normal_axes = DMat3::from_cols(
            axes.y_axis.cross(axes.z_axis),
            axes.z_axis.cross(axes.x_axis),
            axes.x_axis.cross(axes.y_axis),
        ) * if mirrored { -1.0 } else { 1.0 };
        let mut points = Vec::with_capacity(count);
        for position in corners.positions {
            let place = world.transform_point3(DVec3::from_array(position.map(f64::from)));
            if !place.as_vec3().is_finite() {
                return Err(format!("vertex position {place} is out of range"));
            }
            points.push(place);
        }
        let vertex = |k: usize, normal: DVec3| Vertex {
            position: points[k].as_vec3().to_array(),
            normal: unit(normal).as_vec3().to_array(),
            colour: corners.colours.map_or([1.0; 4], |colours| colours[k]),
            uv: corners.uv.map_or([0.0; 2], |uv| uv[k]),
            surface_uv: corners.surface_uv.map_or([0.0; 2], |uv| uv[k]),
        };
        let list = material.map_or(0, |material| material + 1);
        if self.indices.len() <= list {
            self.indices.resize_with(list + 1, Vec::new);
        }
        let (vertices, list) = (&mut self.vertices, &mut self.indices[list]);
        let first = vertices.len() as u32;
        for triangle in indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| triangle[k]);
            let [a, b, c] = if mirrored { [a, c, b] } else { [a, b, c] };
            if corners.normals.is_some() {
                list.extend([first + a, first + b, first + c]);
                continue;
            }
            let [p, q, r] = [a, b, c].map(|k| points[k as usize]);
            let normal = (q - p).cross(r - p);
            for k in [a, b, c] {
                list.push(vertices.len() as u32);
                vertices.push(vertex(k as usize, normal));
            }
        }
        if let Some(normals) = corners.normals {
            let turned = |normal: &[f32; 3]| normal_axes * DVec3::from_array(normal.map(f64::from));
            vertices.extend(normals.iter().enumerate().map(|(k, normal)| vertex(k, turned(normal))));
        }
        self.count += indices.len();
        Ok(())
    }

    /// Builds the mesh with `images`.
    ///
    /// # Errors
    /// [`Error::Input`] if there is nothing visible.
    pub(crate) fn finished(self, path: &Path, images: Vec<Image>) -> Result<Mesh> {
        let mut indices = Vec::with_capacity(self.count);
        let mut parts = Vec::new();
        for (list, material) in self.indices.into_iter().zip(std::iter::once(None).chain((0..).map(Some))) {
            let first = indices.len() as u32;
            indices.extend(list);
            if indices.len() as u32 > first {
                parts.push(SubMesh { indices: first..indices.len() as u32, material });
            }
        }
        let Self { vertices, materials, .. } = self;
        Mesh { vertices, indices, parts, materials, images }.normalised(path)
    }
}

/// `vector` at length 1, whatever its length; +Y if it is zero.
fn unit(vector: DVec3) -> DVec3 {
    let largest = vector.abs().max_element();
    (vector / largest).normalize_or(DVec3::Y)
}
