//! Declarations that the viewer's shaders repeat; see [`crate::gpu::shared`] for those of the stages.

use super::frame::{BallUniform, Diffuse, MOST_LEVELS, ViewFrame};
use super::look::ROW;
use super::model::MaterialUniform;
use super::present::Present;
use crate::gpu::shared::{Constant, Struct};

/// Constants that the viewer's shaders share with Rust.
#[must_use]
pub fn constants() -> Vec<Constant> {
    vec![
        ("common/view_scene.wgsl", "BALLS", vec![f64::from(ROW)]),
        ("common/view_scene.wgsl", "MOST_LEVELS", vec![MOST_LEVELS as f64]),
    ]
}

/// Uniforms of the viewer's shaders.
#[must_use]
pub fn structs() -> Vec<Struct> {
    let file = "common/view_scene.wgsl";
    vec![
        (file, "Ball", BallUniform::MEMBERS, size_of::<BallUniform>()),
        (file, "Diffuse", Diffuse::MEMBERS, size_of::<Diffuse>()),
        (file, "Material", MaterialUniform::MEMBERS, size_of::<MaterialUniform>()),
        (file, "ViewFrame", ViewFrame::MEMBERS, size_of::<ViewFrame>()),
        ("view/present.wgsl", "Present", Present::MEMBERS, size_of::<Present>()),
    ]
}
