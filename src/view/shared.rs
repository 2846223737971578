//! What the viewer's shaders declare a second time, as [`crate::gpu::shared`] has it for the stages.

use super::frame::{BallUniform, Diffuse, MOST_LEVELS, ViewFrame};
use super::look::ROW;
use super::model::MaterialUniform;
use super::present::Present;
use crate::gpu::shared::{Constant, Struct};

/// The constants that the viewer's shaders share with Rust.
#[must_use]
pub fn constants() -> Vec<Constant> {
    vec![
        ("common/view_scene.wgsl", "BALLS", vec![f64::from(ROW)]),
        ("common/view_scene.wgsl", "MOST_LEVELS", vec![MOST_LEVELS as f64]),
    ]
}

/// The uniforms of the viewer's shaders.
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
