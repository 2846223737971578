//! An environment that a renderer updates while it runs.
//!
//! ```text
//! texture --reparameterise--> OEM planes --build_pyramid--> maps +-> octagloss_radiance(...)
//!                                                               +-> octagloss_irradiance(...)
//! ```
//!
//! The texture is the renderer's, or the octahedral map that [`LiveEnvironment::draw`] draws into.

use super::direct::{DirectTarget, OctantDraws, cleared, view_layout};
use super::{Context, OemPlanes, Stage};
use crate::stages::build_pyramid;
use crate::stages::pyramid::{PyramidMaps, wgsl};
use crate::stages::reflection::{self, Surfaces};
use crate::stages::reparameterise::{self, check_readable, upload};
use crate::triangles::DirectMap;
use glam::{DMat3, DVec3};
use octagloss_core::common::error::{Error, Result, wrong};
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::light::oem::OemSize;
use octagloss_core::pyramid::Levels;
use octagloss_shaders::names::named;

/// Glossy reflections of any roughness out of a texture that changes, for the caller's own shaders.
///
/// The renderer owns device, queue and encoder. [`LiveEnvironment::update`] records the compute passes that
/// follow a change of the light; [`LiveEnvironment::wgsl`] and [`LiveEnvironment::bind_group`] give its
/// shaders the look-ups. `examples/render.rs` draws a sphere with it.
///
/// [`LiveEnvironment::draw`] takes a scene of triangles instead of a texture: the renderer's own draws go
/// straight into the octahedral map. `examples/direct.rs` does so.
#[derive(Debug)]
pub struct LiveEnvironment {
    context: Context,
    planes: OemPlanes,
    maps: PyramidMaps,
    /// From the planes to the maps.
    build: Stage,
    /// The texture of the last update, and the stage that reads it.
    source: Option<(wgpu::Texture, Stage)>,
    /// The map of the first draw, its draws, and the stage that reads it.
    drawn: Option<(DirectTarget, OctantDraws, Stage)>,
    draw_layout: wgpu::BindGroupLayout,
    layout: wgpu::BindGroupLayout,
    bind_group: wgpu::BindGroup,
}

impl LiveEnvironment {
    /// Allocates maps over an octahedral map of `size` texels along an edge, at least 1, rounded up to a
    /// power of two from 32 to 2048. A panorama of 1024 x 512 needs 512. The environment is black until the
    /// first update.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a size of 0 or above 2048; [`Error::Limit`] where the device's textures are
    /// smaller; it names the largest size that fits.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, size: u32) -> Result<Self> {
        let context = Context::from_device(device.clone(), queue.clone());
        Ok(Self::several(&context, size, 1)?.remove(0))
    }

    /// Another environment of this size, black until its first update: a further probe of a scene, say. The
    /// two share pipelines, all buffers that an update only passes through and, if this one has been updated
    /// before, what was computed for the texture or the map of its draws. A sibling takes half
    /// the memory or less, and does not compute overlaps again for that texture.
    ///
    /// Updates of environments that share buffers run one after another on the GPU. A draw of one and a draw
    /// of the other need a submission each.
    #[must_use]
    pub fn sibling(&self) -> Self {
        let maps = self.maps.sibling(&self.context);
        let live = Self::over(&self.context, &self.planes, maps);
        // Draws of its own, for another centre.
        let drawn = self.drawn.as_ref().map(|(target, _, stage)| {
            let octants = OctantDraws::new(&self.context, &live.draw_layout, target.map());
            (target.clone(), octants, stage.clone())
        });
        Self { source: self.source.clone(), drawn, ..live }
    }

    /// `count` environments over maps of `size` texels along an edge, which share buffers.
    pub(super) fn several(context: &Context, size: u32, count: u32) -> Result<Vec<Self>> {
        let inner = checked_inner(context, size, count)?;
        let maps = PyramidMaps::sharing(context, inner, count)?;
        let planes = OemPlanes::new(context, OemSize { inner, border: 0 })?;
        Ok(maps.into_iter().map(|maps| Self::over(context, &planes, maps)).collect())
    }

    /// An environment of these maps over these planes.
    fn over(context: &Context, planes: &OemPlanes, maps: PyramidMaps) -> Self {
        let build = build_pyramid::stage(context, planes, &maps);
        let layout = layout(context);
        let bind_group = maps.bind_group(context, &layout);
        let draw_layout = view_layout(context);
        Self {
            context: context.clone(),
            planes: planes.clone(),
            maps,
            build,
            source: None,
            drawn: None,
            draw_layout,
            layout,
            bind_group,
        }
    }

    /// `environment` as a texture for [`Self::update`].
    ///
    /// # Errors
    /// [`Error::Limit`] where a side is longer than the device has textures.
    pub fn upload(&self, environment: &Environment) -> Result<wgpu::Texture> {
        upload(&self.context, environment)
    }

    /// Records the passes that bring the tables up to `texture`, of radiance in a float format of three or
    /// four channels with the usage `TEXTURE_BINDING` and one sample: six square layers are a cube (+X -X +Y
    /// -Y +Z -Z), one layer of 2:1 is a panorama, one square layer is an octahedral map. Negative texels and
    /// NaN count as 0. Texture and encoder must be of this device, which wgpu checks.
    ///
    /// The overlaps of source and target texels are computed on the CPU for the first texture, and again for
    /// every other one; update the content of one texture where the light changes every frame.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a texture of another shape, format or usage, [`Error::Limit`] where its
    /// overlaps exceed the device's buffers.
    pub fn update(&mut self, encoder: &mut wgpu::CommandEncoder, texture: &wgpu::Texture) -> Result<()> {
        self.stages(texture)?.for_each(|stage| stage.record(encoder));
        Ok(())
    }

    /// The stages that [`Self::update`] records.
    pub fn stages(&mut self, texture: &wgpu::Texture) -> Result<impl Iterator<Item = &Stage>> {
        if self.source.as_ref().is_none_or(|(known, _)| known != texture) {
            check_readable(&self.context, texture)?;
            let layout = layout_of(texture.size())?;
            let stage = reparameterise::stage(&self.context, layout, texture, &self.planes)?;
            self.source = Some((texture.clone(), stage));
        }
        Ok(self.source.iter().map(|(_, stage)| stage).chain([&self.build]))
    }

    /// Edge of the octahedral map in texels.
    pub const fn size(&self) -> u32 {
        self.planes.size().inner
    }

    /// Format of the colour that [`Self::draw`] draws: radiance, up to 65504.
    pub const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

    /// Format of the depth of [`Self::draw`]: `near` over the distance, cleared to 0. The nearest fragment
    /// has the greatest depth.
    pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

    /// Records one render pass that draws a scene into the octahedral map around `centre` (world space), and
    /// the passes that bring the tables up to it, as [`Self::update`] does for a texture.
    ///
    /// The pass has eight parts, one per octant of directions. `record` is called for each with the group of
    /// [`Self::draw_layout`] to bind, and records all draws of the scene with the caller's own pipelines:
    /// colour [`Self::COLOUR`], depth [`Self::DEPTH`] compared by `Greater`, one sample. Vertex stages return
    /// `octagloss_direct_position(position)`, fragment stages discard what `octagloss_direct_owns` denies;
    /// both are in [`Self::draw_wgsl`]. As in the faces of a cube, triangles wind the other way round than in
    /// a picture: to cull back faces, exchange `Ccw` and `Cw`. The scissor is the octant's.
    ///
    /// Points nearer than `near` are cut away, measured by |x| + |y| + |z|. The map is black where nothing is
    /// drawn; a sky is a large box or dome. It has the world's axes: a rotation by [`Self::set_rotation`]
    /// turns it with the scene in it.
    ///
    /// Centre and `near` take effect with the next submission: submit once for each draw.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a `near` that is not positive or a `centre` that is not finite,
    /// [`Error::Limit`] where the map exceeds the device's textures.
    pub fn draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        centre: DVec3,
        near: f32,
        record: impl FnMut(&mut wgpu::RenderPass<'_>, &wgpu::BindGroup),
    ) -> Result<()> {
        let OemSize { inner: size, .. } = self.planes.size();
        let (target, octants, stage) = match &mut self.drawn {
            Some(drawn) => drawn,
            none => {
                let map = DirectMap::Octahedral { size };
                let target = DirectTarget::new(&self.context, map, Self::COLOUR)?;
                let octants = OctantDraws::new(&self.context, &self.draw_layout, map);
                let layout = Layout::Octahedral { size };
                let stage = reparameterise::stage(&self.context, layout, &target.colour, &self.planes)?;
                none.insert((target, octants, stage))
            }
        };
        octants.place(&self.context, "centre", centre, near)?;
        let [colour, depth] = &target.views[0];
        octants.record(&mut cleared(encoder, colour, Some(depth), None), record);
        stage.record(encoder);
        self.build.record(encoder);
        Ok(())
    }

    /// WGSL for the caller's shaders that draw into the map; their resource is declared in bind group
    /// `group`. It can stand in one shader with [`Self::wgsl`] and [`crate::shadow::ShadowMap::wgsl`] of
    /// other groups.
    ///
    /// - `octagloss_direct_position(position: vec3<f32>) -> vec4<f32>`: clip coordinates of a position in
    ///   world space, for the vertex stage.
    /// - `octagloss_direct_owns(position: vec4<f32>) -> bool`: whether a pixel, by the fragment stage's
    ///   built-in position, belongs to the octant. Discard it otherwise.
    #[must_use]
    pub fn draw_wgsl(group: u32) -> String {
        let resources = ["var<uniform> octagloss_view: OctaglossView"];
        octagloss_shaders::for_callers("common/direct_view.wgsl", &resources, group, "octagloss_draw")
    }

    /// The layout of the group that [`Self::draw`] passes on, for the caller's pipeline layouts.
    #[must_use]
    pub const fn draw_layout(&self) -> &wgpu::BindGroupLayout {
        &self.draw_layout
    }

    /// Turns the environment from the next submission on: `source_from_world` is the rotation that takes a
    /// direction of the renderer's world to one of the texture's. No table changes.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a matrix that is no rotation or reflection, to a thousandth.
    pub fn set_rotation(&self, source_from_world: DMat3) -> Result<()> {
        let off = (source_from_world.transpose() * source_from_world - DMat3::IDENTITY).to_cols_array();
        // NaN is off, too.
        if !off.iter().all(|entry| entry.abs() <= 1e-3) {
            return wrong(format!(
                "`source_from_world` is {source_from_world}; its columns must be unit vectors at right angles"
            ));
        }
        self.maps.set_rotation(&self.context, columns(source_from_world.transpose()));
        Ok(())
    }

    /// WGSL with `octagloss_radiance(direction, roughness)` and `octagloss_irradiance(normal)`, both of
    /// `vec3<f32>`; their resources are declared in bind group `group`. All its global names begin with
    /// `octagloss_` or `Octagloss`.
    ///
    /// Directions and normals have any length but zero, and a roughness is in [0, 1]. Shaders do not check:
    /// what a zero vector, NaN or another roughness gives is undefined, NaN as a rule.
    #[must_use]
    pub fn wgsl(group: u32) -> String {
        wgsl(1, group)
    }

    /// [`Self::wgsl`] with the prefix `name`, so that one shader can look up several environments:
    /// `NAME_radiance(direction, roughness)` and `NAME_irradiance(normal)`. All else that the source declares
    /// begins with `NAME_`, too.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `name` does not begin with an ASCII letter, or has characters other than ASCII
    /// letters, digits and single underscores between them.
    pub fn wgsl_named(name: &str, group: u32) -> Result<String> {
        named(&Self::wgsl(group), name).or_else(wrong)
    }

    /// The layout of [`Self::bind_group`], for the caller's pipeline layouts: visible to vertex, fragment and
    /// compute shaders.
    #[must_use]
    pub const fn bind_group_layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// The resources of [`Self::wgsl`]; the same group after every update.
    #[must_use]
    pub const fn bind_group(&self) -> &wgpu::BindGroup {
        &self.bind_group
    }

    /// The resources as a group of `layout`, which wgpu derived for a pipeline from its shader.
    #[must_use]
    pub fn bind_group_of(&self, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        self.maps.bind_group(&self.context, layout)
    }

    /// [`Self::wgsl`], and with it the true reflection. `octagloss_reflect(normal, view, tangent, roughness,
    /// anisotropy, f0, f90)` is radiance that a surface reflects to a viewer in the direction `view`, by GGX
    /// with Smith's height-correlated masking and Schlick's Fresnel term, `f0` a `vec3<f32>`. It needs no
    /// table of the split sum. A view with n.v below 0.01 is turned up to that.
    ///
    /// `anisotropy` is that of `KHR_materials_anisotropy`, taken to [0, 1]: alpha along the tangent is r^2 +
    /// (1 - r^2) anisotropy^2, across it r^2. The tangent has any length and either sign; what is at right
    /// angles to the normal counts. If nothing is, as of a zero tangent, the reflection is isotropic. Without
    /// anisotropy the tangent is not read.
    ///
    /// `octagloss_albedo(n.v, roughness, anisotropy)` is what a white world gives, f0 times its x plus f90
    /// times its y: for multiple scattering and what lies under a clear coat. With anisotropy it is the mean
    /// over the tangent's directions; `octagloss_albedo_along(n.v, t.v, roughness, anisotropy)` is that of
    /// one tangent, of length 1 and at right angles to the normal.
    #[must_use]
    pub fn reflect_wgsl(group: u32) -> String {
        reflection::wgsl(1, group)
    }

    /// The layout of a group with the resources of [`Self::reflect_wgsl`], visible to vertex, fragment and
    /// compute shaders.
    #[must_use]
    pub fn reflect_bind_group_layout(&self) -> wgpu::BindGroupLayout {
        reflection::bind_group_layout(&self.context, VISIBILITY)
    }

    /// The resources of [`Self::reflect_wgsl`] as a group of `layout`: that of
    /// [`Self::reflect_bind_group_layout`], or what wgpu derived for a pipeline from its shader. The first
    /// call for a size of maps fits tables, for three to four seconds of one core in all.
    #[must_use]
    pub fn reflect_bind_group_of(&self, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        reflection::bind_group(&self.context, &self.maps, false, Surfaces::Any, layout)
    }

    /// The same for shaders that reflect without anisotropy only, as `octagloss_reflect_isotropic` does: a
    /// table that takes a tenth of that time. Reflections with anisotropy are wrong.
    #[must_use]
    pub fn isotropic_bind_group_of(&self, layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        reflection::bind_group(&self.context, &self.maps, false, Surfaces::Isotropic, layout)
    }

    pub(super) const fn maps(&self) -> &PyramidMaps {
        &self.maps
    }
}

/// The shaders that look environments up.
const VISIBILITY: wgpu::ShaderStages = wgpu::ShaderStages::VERTEX_FRAGMENT.union(wgpu::ShaderStages::COMPUTE);

/// The layout of a group for shaders that look environments up.
pub fn layout(context: &Context) -> wgpu::BindGroupLayout {
    PyramidMaps::bind_group_layout(context, VISIBILITY)
}

/// Edge of the octahedral map for `size` texels of `count` environments that share textures, before any is
/// allocated.
///
/// # Errors
/// [`Error::Parameter`] for a size of 0 or above [`Levels::LARGEST`], [`Error::Limit`] where the device is
/// too small; it names the parameter `size` or `count` that fits.
fn checked_inner(context: &Context, size: u32, count: u32) -> Result<u32> {
    let most = Levels::LARGEST;
    if !(1..=most).contains(&size) {
        return wrong(format!("`size` is {size}; choose 1 to {most} texels along an edge"));
    }
    let inner = Levels::size_for(size);
    match PyramidMaps::check_fits(context, Levels::over(inner)?, count) {
        Err(Error::Limit { what, needed, available, remedy }) => {
            let remedy = remedy.replace("`oem_size`", "`size`");
            Err(Error::Limit { what, needed, available, remedy })
        }
        other => other.map(|()| inner),
    }
}

/// The layout of an environment in a texture of `size`.
fn layout_of(size: wgpu::Extent3d) -> Result<Layout> {
    let wgpu::Extent3d { width, height, depth_or_array_layers: layers } = size;
    match layers {
        6 if width == height => Ok(Layout::Cube { size: width }),
        1 if width == height => Ok(Layout::Octahedral { size: width }),
        1 if width == 2 * height => Ok(Layout::Panorama { width, height }),
        _ => wrong(format!(
            "a texture of {width} x {height} in {layers} layers is no environment; six square layers are a \
             cube, one layer of 2:1 is a panorama, one square layer is an octahedral map"
        )),
    }
}

/// A matrix as uniforms hold it: columns of four floats.
pub fn columns(matrix: DMat3) -> [[f32; 4]; 3] {
    [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|column| column.as_vec3().extend(0.0).to_array())
}
