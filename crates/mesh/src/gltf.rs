//! Reads glTF files: the triangles of a scene, transformed by its nodes, and their materials.

use super::accessor::{Buffers, Refusal};
use super::confined::Confined;
use super::material::{Image, MAX_TEXTURES, Material, Texture, Wrap};
use super::{Builder, Corners, Mesh};
use ::gltf::json::accessor::Type;
use ::gltf::json::material::AlphaMode;
use ::gltf::json::mesh::{Mode, Primitive, Semantic};
use ::gltf::json::scene::Node;
use ::gltf::json::texture::{Info, MagFilter, WrappingMode};
use ::gltf::json::validation::Checked;
use ::gltf::json::{self, Root};
use glam::{DMat4, DQuat, DVec3};
use octagloss_core::common::error::{Error, Result, quoted};
use std::borrow::Cow;
use std::path::Path;

/// Greatest depth of a node.
const MAX_DEPTH: usize = 1000;

/// Reads the mesh in `bytes`, the glTF file `path`; `files` reads the files that it refers to.
pub(super) fn read(path: &Path, bytes: &[u8], files: &mut Confined<'_>) -> Result<Mesh> {
    let ::gltf::Gltf { document, blob } =
        ::gltf::Gltf::from_slice(bytes).map_err(|error| Error::input(path, said(&error)))?;
    let root = document.into_json();
    let refused = |message: Refusal| Error::input(path, message);
    let data = buffers(path, &root, blob, files)?;
    let mut scene = Scene {
        buffers: Buffers { root: &root, data },
        builder: Builder::default(),
        materials: vec![None; root.materials.len() + 1],
        images: vec![None; root.images.len()],
        used: Vec::new(),
    };
    scene.walk().map_err(refused)?;
    let images = scene.decoded(path, files)?;
    scene.builder.finished(path, images)
}

/// The decoder's message, on one line and shortened.
fn said(error: &::gltf::Error) -> String {
    const MAX: usize = 300;
    let text = match error {
        ::gltf::Error::Validation(errors) => errors.first().map_or_else(String::new, |(place, error)| {
            let more = errors.len() - 1;
            let more = if more > 0 { format!(" and {more} more faults") } else { String::new() };
            format!("invalid glTF: {place}: {error}{more}")
        }),
        _ => error.to_string(),
    };
    let text: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > MAX { text.chars().take(MAX).chain("...".chars()).collect() } else { text }
}

/// Reads the content of all buffers.
fn buffers(
    path: &Path,
    root: &Root,
    mut blob: Option<Vec<u8>>,
    files: &mut Confined<'_>,
) -> Result<Vec<Vec<u8>>> {
    let mut all = Vec::with_capacity(root.buffers.len());
    for (index, buffer) in root.buffers.iter().enumerate() {
        let mut bytes = match &buffer.uri {
            Some(uri) => files.read(uri)?,
            None => blob.take().ok_or_else(|| {
                let message = format!("buffer {index} has no URI, and the file has no binary chunk");
                Error::input(path, message)
            })?,
        };
        let length = buffer.byte_length.0;
        if length > bytes.len() as u64 {
            let what = buffer.uri.as_deref().map_or_else(|| "its binary chunk".to_owned(), quoted);
            let held = bytes.len();
            let message = format!("buffer {index} has {length} bytes, but {what} holds {held}");
            return Err(Error::input(path, message));
        }
        bytes.truncate(length as usize);
        all.push(bytes);
    }
    Ok(all)
}

/// State while a scene is read.
struct Scene<'a> {
    buffers: Buffers<'a>,
    builder: Builder,
    /// Index in the builder of each material of the file; the last is glTF's default.
    materials: Vec<Option<usize>>,
    /// Index in the mesh of each image of the file.
    images: Vec<Option<usize>>,
    /// Images of the file that materials use.
    used: Vec<usize>,
}

impl Scene<'_> {
    /// Adds the triangles of all nodes of the default scene, or of the first if there is no default.
    fn walk(&mut self) -> Result<(), Refusal> {
        let root = self.buffers.root;
        let index = root.scene.map_or(0, |scene| scene.value());
        let scene = root.scenes.get(index).ok_or_else(|| "no scene".to_owned())?;
        let mut pending: Vec<(usize, DMat4, usize)> =
            scene.nodes.iter().rev().map(|node| (node.value(), DMat4::IDENTITY, 0)).collect();
        let mut seen = vec![false; root.nodes.len()];
        while let Some((index, parent, depth)) = pending.pop() {
            let node = &root.nodes[index];
            if std::mem::replace(&mut seen[index], true) {
                return Err(format!(
                    "node {index} is reached twice, in a cycle or from two parents; nodes must form trees"
                ));
            }
            if depth > MAX_DEPTH {
                return Err(format!("node {index} is nested more than {MAX_DEPTH} levels deep"));
            }
            let world = parent * transform(node).map_err(|message| format!("node {index}: {message}"))?;
            if !world.is_finite() {
                return Err(format!("node {index}: its transform is not finite"));
            }
            if let Some(number) = node.mesh.map(|mesh| mesh.value()) {
                for (k, primitive) in root.meshes[number].primitives.iter().enumerate() {
                    self.add(primitive, world)
                        .map_err(|message| format!("mesh {number}, primitive {k}: {message}"))?;
                }
            }
            let children = node.children.iter().flatten().rev();
            pending.extend(children.map(|child| (child.value(), world, depth + 1)));
        }
        Ok(())
    }

    /// Adds the triangles of `primitive`.
    fn add(&mut self, primitive: &Primitive, world: DMat4) -> Result<(), Refusal> {
        let mode = match primitive.mode {
            Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
            // Points and lines have no surface.
            _ => return Ok(()),
        };
        let (most, most_indices) = self.builder.room();
        let attribute = |semantic: Semantic| {
            primitive.attributes.get(&Checked::Valid(semantic)).map(|accessor| accessor.value())
        };
        let positions = attribute(Semantic::Positions).ok_or_else(|| "no POSITION".to_owned())?;
        let buffers = &self.buffers;
        let positions = buffers.vectors::<3>(positions, most, &[Type::Vec3], false)?;
        let normals = attribute(Semantic::Normals)
            .map(|index| buffers.vectors::<3>(index, most, &[Type::Vec3], false))
            .transpose()?;
        let colours = attribute(Semantic::Colors(0))
            .map(|index| buffers.vectors::<4>(index, most, &[Type::Vec3, Type::Vec4], true))
            .transpose()?;
        let root = buffers.root;
        let material = primitive.material.map(|material| material.value());
        let textures = material.map(|index| {
            let material = &root.materials[index];
            let surface = &material.pbr_metallic_roughness;
            let base = surface.base_color_texture.as_ref().or(emissive_texture(material));
            [base, surface.metallic_roughness_texture.as_ref()].map(|info| info.map(|info| info.tex_coord))
        });
        let mut uvs = [None, None];
        for (uv, set) in uvs.iter_mut().zip(textures.unwrap_or_default()) {
            let Some(set) = set else { continue };
            let index = attribute(Semantic::TexCoords(set))
                .ok_or_else(|| format!("its material requires TEXCOORD_{set}, which is missing"))?;
            *uv = Some(buffers.vectors::<2>(index, most, &[Type::Vec2], true)?);
        }
        let listed = match primitive.indices {
            Some(index) => buffers.indices(index.value(), most_indices)?,
            None => (0..positions.len() as u32).collect(),
        };
        let indices = triangles(mode, listed)?;
        let material = self.material(material)?;
        let [uv, surface_uv] = &uvs;
        let corners = Corners {
            positions: &positions,
            normals: normals.as_deref(),
            colours: colours.as_deref(),
            uv: uv.as_deref(),
            surface_uv: surface_uv.as_deref(),
        };
        self.builder.add(&corners, &indices, Some(material), world)
    }

    /// Index in the builder of material `index` of the file, or of glTF's default.
    fn material(&mut self, index: Option<usize>) -> Result<usize, Refusal> {
        let root = self.buffers.root;
        let place = index.unwrap_or(root.materials.len());
        if let Some(known) = self.materials[place] {
            return Ok(known);
        }
        let material = match root.materials.get(place) {
            None => Material::default(),
            Some(material) => {
                self.read(material).map_err(|message| format!("material {place}: {message}"))?
            }
        };
        let added = self.builder.add_material(material);
        self.materials[place] = Some(added);
        Ok(added)
    }

    fn read(&mut self, material: &json::Material) -> Result<Material, Refusal> {
        let surface = &material.pbr_metallic_roughness;
        let fraction = |what: &str, value: f32| {
            if (0.0..=1.0).contains(&value) {
                Ok(value)
            } else {
                Err(format!("{what} {value} is outside [0, 1]"))
            }
        };
        let base = surface.base_color_factor.0;
        for factor in base {
            fraction("baseColorFactor", factor)?;
        }
        let cutoff = match material.alpha_mode {
            Checked::Valid(AlphaMode::Mask) => {
                Some(material.alpha_cutoff.as_ref().map_or(0.5, |cutoff| cutoff.0))
            }
            _ => None,
        };
        let radiance = |what: &str, value: f32| {
            if value.is_finite() && value >= 0.0 {
                Ok(value)
            } else {
                Err(format!("{what} {value} is negative or not finite"))
            }
        };
        let strength = radiance("emissiveStrength", emissive_strength(material))?;
        let mut emission = [0.0; 3];
        for (value, given) in emission.iter_mut().zip(material.emissive_factor.0) {
            let factor = radiance("emissiveFactor", given)?;
            *value = radiance("emissiveFactor times emissiveStrength", factor * strength)?;
        }
        // Vertices have one set of coordinates for both.
        let emission_texture = emissive_texture(material).filter(|info| {
            surface.base_color_texture.as_ref().is_none_or(|base| base.tex_coord == info.tex_coord)
        });
        let number = |extension: &str, name: &str| finish_number(material, extension, name);
        Ok(Material {
            anisotropy: fraction("anisotropyStrength", number(ANISOTROPY, "anisotropyStrength"))?,
            direction: number(ANISOTROPY, "anisotropyRotation"),
            clearcoat: fraction("clearcoatFactor", number(CLEARCOAT, "clearcoatFactor"))?,
            coat_roughness: fraction(
                "clearcoatRoughnessFactor",
                number(CLEARCOAT, "clearcoatRoughnessFactor"),
            )?,
            emission,
            emission_texture: emission_texture.map(|info| self.texture(info)),
            base,
            metallic: fraction("metallicFactor", surface.metallic_factor.0)?,
            roughness: fraction("roughnessFactor", surface.roughness_factor.0)?,
            cutoff,
            base_texture: surface.base_color_texture.as_ref().map(|info| self.texture(info)),
            surface_texture: surface.metallic_roughness_texture.as_ref().map(|info| self.texture(info)),
        })
    }

    fn texture(&mut self, info: &Info) -> Texture {
        let root = self.buffers.root;
        let texture = &root.textures[info.index.value()];
        let image = texture.source.value();
        let image = *self.images[image].get_or_insert_with(|| {
            self.used.push(image);
            self.used.len() - 1
        });
        let sampler = texture.sampler.map(|index| &root.samplers[index.value()]);
        let wrap = |mode: &Checked<WrappingMode>| match mode {
            Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
            Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
            Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
        };
        Texture {
            image,
            wrap: sampler.map_or_else(Default::default, |s| [wrap(&s.wrap_s), wrap(&s.wrap_t)]),
            nearest: sampler.is_some_and(|s| s.mag_filter == Some(Checked::Valid(MagFilter::Nearest))),
        }
    }

    /// Decodes the images that materials use, in the order of their indices in the mesh.
    fn decoded(&self, path: &Path, files: &mut Confined<'_>) -> Result<Vec<Image>> {
        let mut images = Vec::with_capacity(self.used.len());
        let mut bytes = 0;
        for index in &self.used {
            let image = &self.buffers.root.images[*index];
            let mut name = format!("image {index}");
            let encoded = match (&image.buffer_view, &image.uri) {
                (Some(view), _) => {
                    let view = self.buffers.view(view.value());
                    Cow::Borrowed(view.map_err(|message| Error::input(path, format!("{name}: {message}")))?.0)
                }
                (None, Some(uri)) => {
                    name += &format!(" ({})", quoted(uri));
                    Cow::Owned(files.read(uri)?)
                }
                (None, None) => {
                    return Err(Error::input(path, format!("{name} has neither a bufferView nor a URI")));
                }
            };
            let decoded = Image::decoded(path, &name, &encoded)?;
            bytes += 4 * decoded.texels.len() as u64;
            if bytes > MAX_TEXTURES {
                return Err(Error::Limit {
                    what: format!("{}: {name} and the textures before it", path.display()),
                    needed: bytes,
                    available: MAX_TEXTURES,
                    remedy: "use smaller textures".to_owned(),
                });
            }
            images.push(decoded);
        }
        Ok(images)
    }
}

const ANISOTROPY: &str = "KHR_materials_anisotropy";
const CLEARCOAT: &str = "KHR_materials_clearcoat";

/// A number of a material's extension, 0 if it is not there. Their textures are not read.
fn finish_number(material: &json::Material, extension: &str, name: &str) -> f32 {
    let extensions = material.extensions.as_ref();
    let value = extensions.and_then(|all| all.others.get(extension)?.get(name)?.as_f64());
    value.unwrap_or_default() as f32
}

/// The factor of a material's emission beyond 1: KHR_materials_emissive_strength.
fn emissive_strength(material: &json::Material) -> f32 {
    let extension = material.extensions.as_ref().and_then(|all| all.emissive_strength.as_ref());
    extension.map_or(1.0, |extension| extension.emissive_strength.0)
}

/// The texture of a material's emission, unless that is black.
fn emissive_texture(material: &json::Material) -> Option<&Info> {
    material.emissive_texture.as_ref().filter(|_| material.emissive_factor.0 != [0.0; 3])
}

/// The transform from the node to its parent.
fn transform(node: &Node) -> Result<DMat4, Refusal> {
    if let Some(matrix) = &node.matrix {
        return Ok(DMat4::from_cols_array(&matrix.map(f64::from)));
    }
    let vector = |values: Option<[f32; 3]>, other: DVec3| {
        values.map_or(other, |values| DVec3::from_array(values.map(f64::from)))
    };
    let turn = node.rotation.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |turn| turn.0);
    let length = turn.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return Err(format!("rotation {turn:?} is not a valid quaternion"));
    }
    let turn = DQuat::from_array(turn.map(|c| f64::from(c) / length));
    let (scale, place) = (vector(node.scale, DVec3::ONE), vector(node.translation, DVec3::ZERO));
    Ok(DMat4::from_scale_rotation_translation(scale, turn, place))
}

/// Expands strips and fans in glTF's order to three indices per triangle.
fn triangles(mode: Mode, indices: Vec<u32>) -> Result<Vec<u32>, Refusal> {
    let count = indices.len();
    match mode {
        Mode::TriangleStrip => {
            let odd = |k: usize| k % 2;
            let three = |k: usize| [indices[k], indices[k + 1 + odd(k)], indices[k + 2 - odd(k)]];
            Ok((0..count.saturating_sub(2)).flat_map(three).collect())
        }
        Mode::TriangleFan => {
            let three = |k: usize| [indices[k + 1], indices[k + 2], indices[0]];
            Ok((0..count.saturating_sub(2)).flat_map(three).collect())
        }
        _ if count.is_multiple_of(3) => Ok(indices),
        _ => Err(format!("{count} indices do not form whole triangles")),
    }
}
