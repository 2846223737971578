//! An environment that a renderer updates while it runs.
//!
//! ```text
//! texture --reparameterise--> OEM planes --build_fitted--> tables +-> octagloss_radiance(...)
//!                                                                +-> octagloss_irradiance(...)
//! ```
//!
//! The texture is the renderer's, or the octahedral map that [`LiveEnvironment::draw`] draws into.

use super::build_fitted::{Scratch, stages_through};
use super::device::names::named;
use super::device::shader;
use super::direct::{Surroundings, view_layout};
use super::fitted::FittedTables;
use super::reparameterise::{self, check_readable, upload};
use super::{Context, OemPlanes, SatPlanes, Stage};
use crate::environment::{Environment, Layout};
use crate::error::{Error, Result};
use crate::oem::OemSize;
use crate::sat::Scan;
use glam::{DMat3, DVec3};

/// Boxes of a fitted lobe at first.
pub(super) const BOXES: u32 = 4;

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
    scratch: Scratch,
    tables: FittedTables,
    /// From the planes to the tables.
    build: Vec<Stage>,
    /// The texture of the last update, and the stage that reads it.
    source: Option<(wgpu::Texture, Stage)>,
    /// The map of the first draw, and the stage that reads it.
    drawn: Option<(Surroundings, Stage)>,
    draw_layout: wgpu::BindGroupLayout,
    layout: wgpu::BindGroupLayout,
    bind_group: wgpu::BindGroup,
}

impl LiveEnvironment {
    /// Allocates tables over an octahedral map of `size` texels along an edge, at least 1, rounded up to a
    /// power of two from 16 on. A panorama of 1024 x 512 needs 512. The environment is black until the first
    /// update.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a size of 0; [`Error::Limit`] where the tables exceed the buffers or textures
    /// of the device; it names the largest size that fits.
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
        let tables = self.tables.sibling(&self.context, BOXES);
        let live = Self::over(&self.context, &self.planes, &self.scratch, tables);
        let drawn = self.drawn.as_ref().map(|(surroundings, stage)| {
            (surroundings.sharing_target(&self.context, &live.draw_layout), stage.clone())
        });
        Self { source: self.source.clone(), drawn, ..live }
    }

    /// `count` environments over maps of `size` texels along an edge, which share buffers.
    pub(super) fn several(context: &Context, size: u32, count: u32) -> Result<Vec<Self>> {
        let inner = checked_inner(context, size, count)?;
        let tables = FittedTables::sharing(context, inner, BOXES, count)?;
        let planes = OemPlanes::new(context, OemSize { inner, border: 0 })?;
        let scratch = Scratch::new(context, &planes)?;
        let over = |tables| Self::over(context, &planes, &scratch, tables);
        Ok(tables.into_iter().map(over).collect())
    }

    /// An environment of these tables, planes and buffers between passes.
    fn over(context: &Context, planes: &OemPlanes, scratch: &Scratch, tables: FittedTables) -> Self {
        let device = context.device();
        let build = stages_through(context, Scan::Blocks, planes, scratch, &tables)
            .expect("every device scans by blocks");
        tables.set_rotation(context, columns(DMat3::IDENTITY));
        let layout = layout(device);
        let bind_group = tables.bind_group(device, &layout);
        let draw_layout = view_layout(context);
        Self {
            context: context.clone(),
            planes: planes.clone(),
            scratch: scratch.clone(),
            tables,
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
    pub(crate) fn stages(&mut self, texture: &wgpu::Texture) -> Result<impl Iterator<Item = &Stage>> {
        if self.source.as_ref().is_none_or(|(known, _)| known != texture) {
            check_readable(&self.context, texture)?;
            let layout = layout_of(texture.size())?;
            let stage = reparameterise::stage(&self.context, layout, texture, &self.planes)?;
            self.source = Some((texture.clone(), stage));
        }
        Ok(self.source.iter().map(|(_, stage)| stage).chain(&self.build))
    }

    /// Edge of the octahedral map in texels.
    pub(crate) const fn size(&self) -> u32 {
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
        let (surroundings, stage) = match &mut self.drawn {
            Some(drawn) => drawn,
            none => {
                let surroundings = Surroundings::new(&self.context, &self.draw_layout, size)?;
                let (layout, map) = (Layout::Octahedral { size }, &surroundings.target.colour);
                let stage = reparameterise::stage(&self.context, layout, map, &self.planes)?;
                none.insert((surroundings, stage))
            }
        };
        surroundings.draw(&self.context, encoder, centre, near, record)?;
        std::iter::once(&*stage).chain(&self.build).for_each(|stage| stage.record(encoder));
        Ok(())
    }

    /// WGSL for the caller's shaders that draw into the map; their resource is declared in bind group
    /// `group`. It can stand in one shader with [`Self::wgsl`] and [`crate::ShadowMap::wgsl`] of other
    /// groups.
    ///
    /// - `octagloss_direct_position(position: vec3<f32>) -> vec4<f32>`: clip coordinates of a position in
    ///   world space, for the vertex stage.
    /// - `octagloss_direct_owns(position: vec4<f32>) -> bool`: whether a pixel, by the fragment stage's
    ///   built-in position, belongs to the octant. Discard it otherwise.
    #[must_use]
    pub fn draw_wgsl(group: u32) -> String {
        draw_wgsl(group)
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
            return Err(Error::Parameter(format!(
                "`source_from_world` is {source_from_world}; its columns must be unit vectors at right angles"
            )));
        }
        self.tables.set_rotation(&self.context, columns(source_from_world.transpose()));
        Ok(())
    }

    /// Selects lobes of `count` boxes (1, 2, 4 or 8; 4 at first) from the next submission on: more are slower
    /// and more accurate. Environments of one [`LiveProbes`](super::live_probes::LiveProbes) have one count.
    ///
    /// # Errors
    /// [`Error::Parameter`] for any other count.
    pub fn set_boxes(&self, count: u32) -> Result<()> {
        self.tables.set_count(&self.context, count)
    }

    /// WGSL with `octagloss_radiance(direction, roughness)` and `octagloss_irradiance(normal)`, both of
    /// `vec3<f32>`; their resources are declared in bind group `group`. All its global names begin with
    /// `octagloss_` or `Octagloss`.
    ///
    /// Directions and normals have any length but zero, and a roughness is in [0, 1]. Shaders do not check:
    /// what a zero vector, NaN or another roughness gives is undefined, NaN as a rule.
    #[must_use]
    pub fn wgsl(group: u32) -> String {
        look_ups("array<OctaglossLight, 1>", group)
    }

    /// [`Self::wgsl`] with the prefix `name`, so that one shader can look up several environments:
    /// `NAME_radiance(direction, roughness)` and `NAME_irradiance(normal)`. All else that the source declares
    /// begins with `NAME_`, too.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `name` does not begin with an ASCII letter, or has characters other than ASCII
    /// letters, digits and single underscores between them.
    pub fn wgsl_named(name: &str, group: u32) -> Result<String> {
        named(&Self::wgsl(group), name)
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
        self.tables.bind_group(self.context.device(), layout)
    }

    pub(super) const fn tables(&self) -> &FittedTables {
        &self.tables
    }
}

/// The layout of a group for shaders that look environments up.
pub(crate) fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let visibility = wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE;
    FittedTables::bind_group_layout(device, visibility)
}

/// WGSL of the look-ups over `lights`, with their resources in bind group `group`.
pub(super) fn look_ups(lights: &str, group: u32) -> String {
    let resources = [
        "var<uniform> octagloss_octaves: OctaglossOctaves",
        &format!("var<uniform> octagloss_lights: {lights}"),
        "var<storage, read> octagloss_entries: array<Sum>",
        "var<storage, read> octagloss_parameters: array<vec4<u32>>",
        "var octagloss_oems: texture_2d_array<f32>",
    ];
    shader::for_callers("common/live.wgsl", &resources, group, "octagloss")
}

/// WGSL for draws into octahedral maps, with its resource in bind group `group`.
pub(super) fn draw_wgsl(group: u32) -> String {
    let resources = ["var<uniform> octagloss_view: OctaglossView"];
    shader::for_callers("common/direct_view.wgsl", &resources, group, "octagloss_draw")
}

/// Edge of the octahedral map for `size` texels, rounded up as [`LiveEnvironment::new`] says.
pub(super) fn inner_of(size: u32) -> u32 {
    size.max(16).checked_next_power_of_two().unwrap_or(1 << 31)
}

/// [`inner_of`] for `count` environments that share buffers, before any is allocated.
///
/// # Errors
/// [`Error::Parameter`] for a size of 0, [`Error::Limit`] where the device is too small; it names the
/// parameters `size` and `count` that fit.
fn checked_inner(context: &Context, size: u32, count: u32) -> Result<u32> {
    if size == 0 {
        return Err(Error::Parameter("`size` is 0; choose at least one texel along an edge".to_owned()));
    }
    let fits = |inner: u32, count: u32| {
        FittedTables::check_fits(context, inner, count)?;
        SatPlanes::check_fits(context, OemSize { inner, border: 0 })
    };
    let inner = inner_of(size);
    fits(inner, count).map(|()| inner).map_err(|error| match error {
        Error::Limit { what, needed, available, .. } => {
            let smaller =
                (4..inner.ilog2()).rev().map(|log2| 1 << log2).find(|size| fits(*size, count).is_ok());
            let fewer = (1..count).rev().find(|count| fits(inner, *count).is_ok());
            let remedies = [("count", fewer), ("size", smaller)]
                .into_iter()
                .filter_map(|(name, most)| Some(format!("`{name}` of at most {}", most?)))
                .collect::<Vec<_>>();
            let remedy = match &remedies[..] {
                [] => "use a device with larger buffers".to_owned(),
                some => format!("choose {}", some.join(", or ")),
            };
            Error::Limit { what, needed, available, remedy }
        }
        other => other,
    })
}

/// The layout of an environment in a texture of `size`.
fn layout_of(size: wgpu::Extent3d) -> Result<Layout> {
    let wgpu::Extent3d { width, height, depth_or_array_layers: layers } = size;
    match layers {
        6 if width == height => Ok(Layout::Cube { size: width }),
        1 if width == height => Ok(Layout::Octahedral { size: width }),
        1 if width == 2 * height => Ok(Layout::Panorama { width, height }),
        _ => Err(Error::Parameter(format!(
            "a texture of {width} x {height} in {layers} layers is no environment; six square layers are a \
             cube, one layer of 2:1 is a panorama, one square layer is an octahedral map"
        ))),
    }
}

/// A matrix as uniforms hold it: columns of four floats.
fn columns(matrix: DMat3) -> [[f32; 4]; 3] {
    [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|column| column.as_vec3().extend(0.0).to_array())
}
