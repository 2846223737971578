//! Lists of triangles for indirect draws: those that each view may show, and pieces cut at octants' borders.

use super::mesh::DirectMesh;
use super::view::{Bounded, NOWHERE, PLANES, Plane, VIEWS};
use crate::device::stage::{Dispatch, in_rows};
use crate::triangles::Corner;
use crate::{Context, Stage};
use octagloss_core::common::error::Result;

/// Invocations of a workgroup, and triangles of a chunk.
pub const GROUP_SIZE: u32 = 256;

/// Triangles of the pieces of a triangle, at most.
pub const PIECES: u32 = 13;

/// How a triangle is cut into pieces, by its number in the shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Cut {
    /// At the three coordinate planes.
    Octants = 0,
    /// At the plane y = 0.
    Halves = 1,
    /// At the plane y = 0, and the edges of both parts at the other planes.
    Edges = 2,
}

impl Cut {
    /// Triangles of the pieces of a triangle, at most.
    const fn pieces(self) -> u32 {
        match self {
            Self::Octants => PIECES,
            // A triangle and a quadrilateral.
            Self::Halves => 3,
            // Each has at most four corners more.
            Self::Edges => 11,
        }
    }
}

/// Words of the arguments of a draw.
const DRAW_WORDS: u64 = 5;

/// Rounding of a distance from a plane relative to the position's coordinates: four products, their sum, and
/// the rounding of the plane, of 2^-24 each.
const SLACK: f32 = 1e-6;

/// Uniform of the lists of views.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Cull {
    planes: [[Plane; PLANES]; VIEWS],
    triangles: u32,
    chunks: u32,
    slack: f32,
    pad: u32,
}

/// Uniform of the pieces.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Split {
    triangles: u32,
    chunks: u32,
    cut: u32,
}

/// Uniform of the sums of counts.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Offsets {
    chunks: u32,
    room: u32,
}

/// A list on the GPU: the stage that fills it, its corners or indices, and the arguments of its draws.
#[derive(Clone, Debug)]
pub(super) struct List {
    pub(super) stage: Stage,
    pub(super) content: wgpu::Buffer,
    pub(super) draws: wgpu::Buffer,
}

impl List {
    /// Byte offset of the arguments of draw `index`.
    pub(super) const fn draw_offset(index: usize) -> u64 {
        4 * DRAW_WORDS * index as u64
    }
}

/// The triangles of `mesh` that each of `views` may show.
///
/// # Errors
/// [`octagloss_core::common::error::Error::Limit`] if the lists exceed the device's buffers.
pub(super) fn kept(context: &Context, mesh: &DirectMesh, views: &[Bounded]) -> Result<List> {
    let mut planes = [NOWHERE; VIEWS];
    planes.iter_mut().zip(views).for_each(|(planes, bounded)| *planes = bounded.planes);
    let (triangles, chunks) = (mesh.triangles, mesh.triangles.div_ceil(GROUP_SIZE));
    let uniform = context.uniform("cull", &Cull { planes, triangles, chunks, slack: SLACK, pad: 0 });
    let list = Plan {
        label: "direct cull",
        lists: VIEWS as u32,
        room: triangles,
        bytes_per_triangle: 12,
        usage: wgpu::BufferUsages::INDEX,
        file: "direct/cull.wgsl",
        entries: ["count_kept", "list_kept"],
        bindings: 4,
    };
    list.build(context, mesh, &uniform)
}

/// The pieces of the triangles of `mesh`, three corners per triangle.
///
/// # Errors
/// [`octagloss_core::common::error::Error::Limit`] if they exceed the device's buffers.
pub(super) fn pieces(context: &Context, mesh: &DirectMesh, cut: Cut) -> Result<List> {
    let triangles = mesh.triangles;
    let chunks = triangles.div_ceil(GROUP_SIZE);
    let uniform = context.uniform("split", &Split { triangles, chunks, cut: cut as u32 });
    let list = Plan {
        label: "direct split",
        lists: 1,
        room: triangles.saturating_mul(cut.pieces()),
        bytes_per_triangle: 3 * size_of::<Corner>() as u64,
        usage: wgpu::BufferUsages::VERTEX,
        file: "direct/split.wgsl",
        entries: ["count_pieces", "write_pieces"],
        // One function counts and writes.
        bindings: 5,
    };
    list.build(context, mesh, &uniform)
}

/// Differences between the two kinds of lists.
struct Plan {
    label: &'static str,
    lists: u32,
    /// Triangles that a list has room for.
    room: u32,
    bytes_per_triangle: u64,
    usage: wgpu::BufferUsages,
    file: &'static str,
    /// Entry points that count, and that write the content.
    entries: [&'static str; 2],
    /// Bindings of the first of them.
    bindings: usize,
}

impl Plan {
    fn build(&self, context: &Context, mesh: &DirectMesh, uniform: &wgpu::Buffer) -> Result<List> {
        let chunks = mesh.triangles.div_ceil(GROUP_SIZE);
        let bytes = u64::from(self.lists) * u64::from(self.room) * self.bytes_per_triangle;
        let per_triangle = bytes / u64::from(mesh.triangles);
        context.fits(&format!("{} of {} triangles", self.label, mesh.triangles), bytes, |available| {
            format!("draw the mesh in parts of at most {} triangles", available / per_triangle)
        })?;
        let shared = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let buffer = |label, size, usage| context.buffer(label, size, usage | shared);
        let content = buffer(self.label, bytes, self.usage);
        let draws =
            buffer("direct draws", 4 * DRAW_WORDS * u64::from(self.lists), wgpu::BufferUsages::INDIRECT);
        let counts = context.storage("direct counts", 4 * u64::from(self.lists) * u64::from(chunks));
        let offsets = context.uniform("direct offsets", &Offsets { chunks, room: self.room });
        let [count, write] = self.entries;
        let groups = in_rows(chunks);
        let input = [
            (0, uniform.as_entire_binding()),
            (1, mesh.corners.as_entire_binding()),
            (2, mesh.indices.as_entire_binding()),
            (3, counts.as_entire_binding()),
            (4, content.as_entire_binding()),
        ];
        let sums = [
            (0, offsets.as_entire_binding()),
            (1, counts.as_entire_binding()),
            (2, draws.as_entire_binding()),
        ];
        let dispatches = vec![
            Dispatch::new(context, (self.file, count), &input[..self.bindings], groups),
            Dispatch::new(context, ("direct/offsets.wgsl", "sum_chunks"), &sums, [self.lists, 1, 1]),
            Dispatch::new(context, (self.file, write), &input, groups),
        ];
        Ok(List { stage: Stage::new(self.label, dispatches), content, draws })
    }
}
