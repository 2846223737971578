//! A mesh on the GPU: triangles, materials and textures.

use super::frame::brush;
use super::mip_levels::{Space, all_levels};
use octagloss_core::common::error::{Error, Result, wrong};
use octagloss_gpu::Context;
use octagloss_gpu::device::resources::{filled_texture, texture_of, write_level};
use octagloss_mesh::{Image, Material, Mesh, SubMesh, Texture, Wrap};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Uniform of a material.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct MaterialUniform {
    base: [f32; 4],
    metallic: f32,
    roughness: f32,
    cutoff: f32,
    own: f32,
    brush: [f32; 2],
    anisotropy: f32,
    clearcoat: f32,
    coat_roughness: f32,
    pad: [f32; 3],
}

/// A texture and how it is sampled.
type Sampled = (wgpu::TextureView, wgpu::Sampler);

/// A material on the GPU.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    uniform: wgpu::Buffer,
    base: Sampled,
    surface: Sampled,
}

impl Surface {
    /// A metal with the reflectance and roughness of the picture's uniform.
    pub(super) fn plain(context: &Context) -> Self {
        Self::new(context, &Material::default(), false, white(context), white(context))
    }

    fn new(
        context: &Context,
        material: &Material,
        is_of_file: bool,
        base: Sampled,
        surface: Sampled,
    ) -> Self {
        let uniform = MaterialUniform {
            base: material.base,
            metallic: material.metallic,
            roughness: material.roughness,
            cutoff: material.cutoff.unwrap_or(-1.0),
            own: f32::from(is_of_file),
            brush: brush(f64::from(material.direction).to_degrees()),
            anisotropy: material.anisotropy,
            clearcoat: material.clearcoat,
            coat_roughness: material.coat_roughness,
            pad: [0.0; 3],
        };
        let uniform = context.uniform("material", &uniform);
        Self { uniform, base, surface }
    }

    /// Resources of the material's bindings.
    pub(super) fn resources(&self) -> [wgpu::BindingResource<'_>; 5] {
        [
            self.uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(&self.base.0),
            wgpu::BindingResource::Sampler(&self.base.1),
            wgpu::BindingResource::TextureView(&self.surface.0),
            wgpu::BindingResource::Sampler(&self.surface.1),
        ]
    }
}

/// A white texture, which leaves factors unchanged.
fn white(context: &Context) -> Sampled {
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let view = texture_of(context, "white", format, [1; 2], &[255; 4]);
    (view, context.device().create_sampler(&wgpu::SamplerDescriptor::default()))
}

/// A mesh on the GPU.
#[derive(Debug)]
pub(super) struct Model {
    pub(super) vertices: wgpu::Buffer,
    pub(super) indices: wgpu::Buffer,
    pub(super) parts: Vec<SubMesh>,
    /// The mesh's materials.
    pub(super) surfaces: Vec<Surface>,
    /// Whether a material is brushed.
    pub(super) is_brushed: bool,
}

/// A buffer of the `content` of a `whole` made of triangles.
///
/// # Errors
/// [`Error::Limit`] for more than `available` bytes.
pub(crate) fn filled_buffer(
    context: &Context,
    [whole, content]: [&str; 2],
    usage: wgpu::BufferUsages,
    bytes: &[u8],
    available: u64,
) -> Result<wgpu::Buffer> {
    if bytes.len() as u64 > available {
        return Err(Error::Limit {
            what: format!("the {whole}'s {content}"),
            needed: bytes.len() as u64,
            available,
            remedy: format!("use a {whole} of fewer triangles"),
        });
    }
    Ok(context.buffer_of(content, bytes, usage))
}

impl Model {
    /// Uploads `mesh` to the device of `context`.
    ///
    /// # Errors
    /// [`Error::Limit`] and [`Error::Parameter`] if it does not fit the device.
    pub(super) fn new(context: &Context, mesh: &Mesh) -> Result<Self> {
        let most = context.device().limits().max_buffer_size;
        let buffer =
            |content, usage, bytes: &[u8]| filled_buffer(context, ["mesh", content], usage, bytes, most);
        let white = white(context);
        let mut views = HashMap::new();
        let mut texture = |texture: Option<Texture>, space: Space| -> Result<Sampled> {
            let Some(Texture { image, wrap, nearest }) = texture else { return Ok(white.clone()) };
            let view = match views.entry((image, space)) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(place) => place.insert(upload(context, &mesh.images[image], space)?),
            };
            Ok((view.clone(), sampler(context, wrap, nearest)))
        };
        let mut surfaces = Vec::with_capacity(mesh.materials.len());
        for material in &mesh.materials {
            let base = texture(material.base_texture, Space::Srgb)?;
            let surface = texture(material.surface_texture, Space::Linear)?;
            surfaces.push(Surface::new(context, material, true, base, surface));
        }
        Ok(Self {
            vertices: buffer("corners", wgpu::BufferUsages::VERTEX, bytemuck::cast_slice(&mesh.vertices))?,
            indices: buffer("triangles", wgpu::BufferUsages::INDEX, bytemuck::cast_slice(&mesh.indices))?,
            parts: mesh.parts.clone(),
            is_brushed: mesh.materials.iter().any(|material| material.anisotropy > 0.0),
            surfaces,
        })
    }
}

fn sampler(context: &Context, wrap: [Wrap; 2], nearest: bool) -> wgpu::Sampler {
    let mode = |wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    context.device().create_sampler(&wgpu::SamplerDescriptor {
        label: Some("texture"),
        address_mode_u: mode(wrap[0]),
        address_mode_v: mode(wrap[1]),
        mag_filter: if nearest { wgpu::FilterMode::Nearest } else { wgpu::FilterMode::Linear },
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}

/// Uploads `image` with all mip levels.
fn upload(context: &Context, image: &Image, space: Space) -> Result<wgpu::TextureView> {
    let most = context.device().limits().max_texture_dimension_2d;
    let (width, height) = (image.width, image.height);
    if width.max(height) > most {
        return wrong(format!(
            "texture of {width} x {height} texels; this GPU supports {most} per side, use a smaller one"
        ));
    }
    let levels = width.max(height).ilog2() + 1;
    let format = match space {
        Space::Srgb => wgpu::TextureFormat::Rgba8UnormSrgb,
        Space::Linear => wgpu::TextureFormat::Rgba8Unorm,
    };
    let texture = filled_texture(context, "texture of a mesh", format, [width, height, 1], levels);
    for (mip_level, level) in (0..).zip(all_levels(image, space)) {
        write_level(context, &texture, mip_level, bytemuck::cast_slice(&level.texels));
    }
    Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
}
