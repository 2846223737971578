//! True reflections for lists of frames, for the tests.

use super::Context;
use super::device::readback;
use super::device::resources::group_at;
use super::device::stage::{Dispatch, Stage, in_rows};
use super::pyramid::{GROUP_SIZE, PyramidMaps};
use super::reflection::{Surfaces, bind_group};
use crate::error::Result;
use glam::DVec3;

/// What a reflection is asked for.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Query {
    /// Normal in the map's space.
    pub normal: [f32; 3],
    /// Perceptual roughness.
    pub roughness: f32,
    /// Towards the viewer, in the map's space.
    pub view: [f32; 3],
    /// Reflectance at grazing incidence.
    pub f90: f32,
    /// Reflectance at normal incidence.
    pub f0: [f32; 3],
    /// Anisotropy.
    pub anisotropy: f32,
    /// Tangent in the map's space, of any length.
    pub tangent: [f32; 3],
    pad: f32,
}

impl Query {
    /// A query with directions of any length: normal, view and tangent.
    #[must_use]
    pub fn new(directions: [DVec3; 3], roughness: f32, anisotropy: f32, f0: [f32; 3], f90: f32) -> Self {
        let [normal, view, tangent] = directions.map(|direction| direction.as_vec3().to_array());
        Self { normal, roughness, view, f90, f0, anisotropy, tangent, pad: 0.0 }
    }
}

/// For each of `queries` the radiance, and the share of f0 in the albedo along its tangent.
///
/// # Errors
/// [`crate::Error::Gpu`] if the device fails.
pub async fn reflect(context: &Context, maps: &PyramidMaps, queries: &[Query]) -> Result<Vec<[f32; 4]>> {
    let pipeline = context.pipeline("pyramid/reflect_query.wgsl", "query", None);
    let groups = u32::try_from(queries.len()).expect("what a buffer holds").div_ceil(GROUP_SIZE);
    let answers = context.storage("answers", 16 * queries.len() as u64);
    let queries = context.storage_of("queries", queries);
    let maps = bind_group(context, maps, false, Surfaces::Any, &pipeline.get_bind_group_layout(0));
    let lists = [(0, queries.as_entire_binding()), (1, answers.as_entire_binding())];
    let lists = group_at(context, "queries", &pipeline.get_bind_group_layout(1), lists);
    let dispatch = Dispatch::with_groups(&pipeline, vec![maps, lists], in_rows(groups));
    let stage = Stage::new("reflections", vec![dispatch]);
    context.submit(|encoder| stage.record(encoder));
    readback::read(context, &answers).await
}
