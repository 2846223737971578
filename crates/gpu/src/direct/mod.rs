//! Draws triangles straight into octahedral maps of either layout, and into cubes for comparison.
//!
//! ```text
//! triangles --cull--> lists of triangles by octant --draw x 8--> octahedral map
//!     +------split--> pieces of triangles -----------draw------> octahedral map
//!     +------cull--> lists of triangles by face -----draw x 6--> cube --reparameterise--> octahedral map
//! ```
//!
//! [`Direct`] holds the pipelines for one kind of output. Bound to a mesh and a target by [`Direct::frame`],
//! a method is a [`DirectFrame`], which records into the caller's encoder. Every submission reads the mesh's
//! buffers again.

pub mod list;
mod mesh;
mod octants;
mod target;
pub mod unwrap;
pub mod view;

pub use mesh::DirectMesh;
pub(crate) use octants::OctantDraws;
pub use target::DirectTarget;

use super::Context;
use super::device::readback;
use super::device::resources::{Draw, UNIFORM, added, group, group_layout};
use super::device::timer::Timer;
use crate::triangles::{Corner, check_near};
use list::{Cut, List};
use octagloss_core::common::error::{Result, wrong};
use octagloss_core::common::names::named;
use target::{NEAREST, check_format};
pub use target::{cleared_depth, depth_texture};
use view::Bounded;

/// How triangles come into a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Method {
    /// The octahedral map, an octant per draw by the octant's own projective map. Each pixel takes part in
    /// the draw of the octant of its centre; a draw has only the triangles that may meet its octant.
    Octants,
    /// The same draws of all triangles: *perspective, clip mask* of Engelhardt and Dachsbacher 2008. The
    /// perspective projection to the face of the octahedron differs from the planar projection by an affine
    /// map, which is the layout's.
    ClipMask,
    /// One draw of the pieces of triangles that were cut at the coordinate planes: their *strict split*.
    StrictSplit,
    /// One draw of the parts of triangles above and below the plane y = 0, each corner projected by its own
    /// octant: their *XZ-split* for the rectangular layout, where either hemisphere is continuous. Wrong
    /// wherever a part leaves an octant; in the quadratic layout's lower half, as wrong as `PerCorner`.
    XzSplit,
    /// The same parts, with further corners where their edges cross the planes x = 0 and z = 0, as triangle
    /// strips: their *edge strip*. Outlines of parts are right, what is interpolated within them is not.
    EdgeStrip,
    /// One draw of whole triangles, each corner projected by its own octant: the error of their figure 2
    /// wherever a triangle leaves an octant.
    PerCorner,
    /// The cube, a face per draw of the triangles that may meet it.
    Cube,
    /// The cube, a face per draw of all triangles.
    WholeCube,
}

named!(Method {
    Octants = "octants",
    ClipMask = "clip-mask",
    StrictSplit = "strict-split",
    XzSplit = "xz-split",
    EdgeStrip = "edge-strip",
    PerCorner = "per-corner",
    Cube = "cube",
    WholeCube = "whole-cube",
});

impl Method {
    /// Whether maps are right to the pixel, except for the resampling of cubes.
    pub const fn is_exact(self) -> bool {
        !matches!(self, Self::XzSplit | Self::EdgeStrip | Self::PerCorner)
    }

    /// Whether the target is a cube.
    pub const fn is_cube(self) -> bool {
        matches!(self, Self::Cube | Self::WholeCube)
    }

    /// How triangles are cut into pieces before they are drawn.
    const fn cut(self) -> Option<Cut> {
        match self {
            Self::StrictSplit => Some(Cut::Octants),
            Self::XzSplit => Some(Cut::Halves),
            Self::EdgeStrip => Some(Cut::Edges),
            Self::Octants | Self::ClipMask | Self::PerCorner | Self::Cube | Self::WholeCube => None,
        }
    }
}

/// Treatment of pixels that several triangles cover.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overlap {
    /// The nearest triangle's values are kept, with their depth.
    Nearest,
    /// All values are added up, without depth: values of 1 count the triangles. In `Rgba16Float` only.
    Sum,
}

/// Pipelines of every method for one kind of output.
#[derive(Clone, Debug)]
pub struct Direct {
    context: Context,
    format: wgpu::TextureFormat,
    overlap: Overlap,
    group: wgpu::BindGroupLayout,
    whole: wgpu::RenderPipeline,
    own_octant: wgpu::RenderPipeline,
    pieces: wgpu::RenderPipeline,
    per_corner: wgpu::RenderPipeline,
}

impl Direct {
    /// Compiles the pipelines for targets whose colour has `format`.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for formats other than `Rgba16Float` and, with
    /// [`Overlap::Nearest`],
    /// `Rgba32Float`.
    pub fn new(context: &Context, format: wgpu::TextureFormat, overlap: Overlap) -> Result<Self> {
        check_format(format)?;
        if overlap == Overlap::Sum && format != wgpu::TextureFormat::Rgba16Float {
            return wrong(format!("{format:?} cannot be blended on every device; choose Rgba16Float"));
        }
        let group = view_layout(context);
        let corners = wgpu::VertexBufferLayout {
            array_stride: size_of::<Corner>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32, 2 => Float32x4],
        };
        let (blend, depth) = match overlap {
            Overlap::Sum => (Some(added()), None),
            Overlap::Nearest => (None, Some(NEAREST)),
        };
        let pipeline = |vertex, fragment| {
            Draw {
                file: "direct/draw.wgsl",
                entries: [vertex, fragment],
                groups: &[&group],
                corners: Some(corners.clone()),
                target: wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL },
                depth,
            }
            .pipeline(context)
        };
        Ok(Self {
            format,
            overlap,
            whole: pipeline("project", "whole"),
            own_octant: pipeline("project", "own_octant"),
            pieces: pipeline("project_piece", "whole"),
            per_corner: pipeline("project_corner", "whole"),
            group,
            context: context.clone(),
        })
    }

    /// Binds `method` to the triangles of `mesh` and to `target`. Points nearer than `near` are cut away: in
    /// the 1-norm for an octahedral map, in the greatest coordinate for a cube. The target is cleared to 0.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for a target of another map or format and for an
    /// invalid `near`, [`octagloss_core::common::error::Error::Limit`] if lists of triangles exceed the
    /// device's buffers.
    pub fn frame(
        &self,
        method: Method,
        mesh: &DirectMesh,
        target: &DirectTarget,
        near: f32,
    ) -> Result<DirectFrame> {
        check_near(near)?;
        target.has_format(self.format)?;
        let map = target.map();
        let fits = if method.is_cube() { map.is_cube() } else { map.is_octahedral() };
        if !fits {
            return wrong(format!(
                "{method:?} cannot draw into {map:?}; choose {}",
                if method.is_cube() { "a cube" } else { "an octahedral map" }
            ));
        }
        let views = match method {
            Method::Octants | Method::ClipMask => view::octants(map, near),
            Method::Cube | Method::WholeCube => view::faces(map.size(), near),
            Method::StrictSplit | Method::XzSplit | Method::EdgeStrip | Method::PerCorner => {
                vec![view::whole(map, near)]
            }
        };
        let list = match (method, method.cut()) {
            (Method::Octants | Method::Cube, _) => Some(list::kept(&self.context, mesh, &views)?),
            (_, Some(cut)) => Some(list::pieces(&self.context, mesh, cut)?),
            (_, None) => None,
        };
        let pipeline = match method {
            Method::Octants | Method::ClipMask => &self.own_octant,
            Method::StrictSplit | Method::XzSplit | Method::EdgeStrip => &self.pieces,
            Method::PerCorner => &self.per_corner,
            Method::Cube | Method::WholeCube => &self.whole,
        };
        let draw = |(index, Bounded { view, scissor, .. }): (usize, Bounded)| {
            let uniform = self.context.uniform("direct view", &view);
            let (corners, source) = match (&list, method.cut()) {
                (Some(list), Some(_)) => (&list.content, DrawnIndices::Pieces(list.draws.clone())),
                (Some(list), None) => {
                    let (content, offset) = (list.content.clone(), List::draw_offset(index));
                    (&mesh.corners, DrawnIndices::Listed(content, list.draws.clone(), offset))
                }
                (None, _) => (&mesh.corners, DrawnIndices::All(mesh.indices.clone(), 3 * mesh.triangles)),
            };
            let group = view_group(&self.context, &self.group, &uniform);
            MeshDraw { pipeline: pipeline.clone(), group, corners: corners.clone(), source, scissor }
        };
        let draws: Vec<MeshDraw> = views.into_iter().enumerate().map(draw).collect();
        // A pass per layer.
        let per_layer = if method.is_cube() { 1 } else { draws.len() };
        let pass = |([colour, depth], draws): (&[wgpu::TextureView; 2], &[MeshDraw])| {
            let depth = (self.overlap == Overlap::Nearest).then(|| depth.clone());
            Pass { colour: colour.clone(), depth, draws: draws.to_vec() }
        };
        let passes = target.views.iter().zip(draws.chunks(per_layer)).map(pass).collect();
        Ok(DirectFrame { list, passes, triangles: mesh.triangles })
    }
}

/// The layout of a group that holds a view.
pub(crate) fn view_layout(context: &Context) -> wgpu::BindGroupLayout {
    group_layout(context, "direct view", wgpu::ShaderStages::VERTEX_FRAGMENT, &[UNIFORM])
}

fn view_group(context: &Context, layout: &wgpu::BindGroupLayout, uniform: &wgpu::Buffer) -> wgpu::BindGroup {
    group(context, "direct view", layout, [uniform.as_entire_binding()])
}

/// A method bound to a mesh and a target. Recording allocates no buffers, submits nothing and waits for
/// nothing.
#[derive(Clone, Debug)]
pub struct DirectFrame {
    list: Option<List>,
    passes: Vec<Pass>,
    /// Triangles of the mesh.
    triangles: u32,
}

/// A render pass.
#[derive(Clone, Debug)]
struct Pass {
    colour: wgpu::TextureView,
    depth: Option<wgpu::TextureView>,
    draws: Vec<MeshDraw>,
}

#[derive(Clone, Debug)]
struct MeshDraw {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    corners: wgpu::Buffer,
    source: DrawnIndices,
    scissor: [u32; 4],
}

/// Triangles of a draw.
#[derive(Clone, Debug)]
enum DrawnIndices {
    /// So many indices of a buffer.
    All(wgpu::Buffer, u32),
    /// Listed indices, and the arguments of the draw with their byte offset.
    Listed(wgpu::Buffer, wgpu::Buffer, u64),
    /// All pieces, by the arguments of their draw.
    Pieces(wgpu::Buffer),
}

impl DirectFrame {
    /// Triangles of every draw: those of the lists are counted once the frame was submitted.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Gpu`] if the device fails.
    pub async fn triangles(&self, context: &Context) -> Result<Vec<u32>> {
        let draws = self.passes.iter().map(|pass| pass.draws.len()).sum();
        let Some(list) = &self.list else { return Ok(vec![self.triangles; draws]) };
        let words: Vec<u32> = readback::read(context, &list.draws).await?;
        Ok(words
            .chunks_exact(List::draw_offset(1) as usize / 4)
            .take(draws)
            .map(|draw| draw[0] / 3)
            .collect())
    }

    /// Whether the first pass lists or cuts triangles.
    pub const fn has_list(&self) -> bool {
        self.list.is_some()
    }

    /// Number of passes, of all kinds.
    pub fn passes(&self) -> u32 {
        self.passes.len() as u32 + u32::from(self.list.is_some())
    }

    /// Records the frame's passes into `encoder`, their times to the first slots of `timer`.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, timer: Option<&Timer>) {
        if let Some(List { stage, .. }) = &self.list {
            stage.record_timed(encoder, timer.map(|timer| timer.compute_writes(0)));
        }
        for (place, pass) in (u32::from(self.list.is_some())..).zip(&self.passes) {
            pass.record(encoder, timer.map(|timer| timer.render_writes(place)));
        }
    }
}

/// Begins a pass into `colour` and `depth`, both cleared to 0.
pub(crate) fn cleared<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    colour: &wgpu::TextureView,
    depth: Option<&wgpu::TextureView>,
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("direct"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: colour,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: depth.map(cleared_depth),
        timestamp_writes,
        ..Default::default()
    })
}

impl Pass {
    fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let mut pass = cleared(encoder, &self.colour, self.depth.as_ref(), timestamp_writes);
        for MeshDraw { pipeline, group, corners, source, scissor: [left, top, width, height] } in &self.draws
        {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.set_scissor_rect(*left, *top, *width, *height);
            pass.set_vertex_buffer(0, corners.slice(..));
            match source {
                DrawnIndices::All(indices, count) => {
                    pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                    pass.draw_indexed(0..*count, 0, 0..1);
                }
                DrawnIndices::Listed(indices, draws, offset) => {
                    pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                    pass.draw_indexed_indirect(draws, *offset);
                }
                DrawnIndices::Pieces(draws) => pass.draw_indirect(draws, 0),
            }
        }
    }
}
