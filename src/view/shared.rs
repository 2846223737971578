//! Declarations that the viewer's shaders repeat; see [`crate::gpu::shared`] for those of the stages.

use super::frame::{BallUniform, Diffuse, MAX_LEVELS, ViewFrame};
use super::look::ROW;
use super::model::MaterialUniform;
use super::present::Present;
use super::scene;
use crate::gpu::shared::{Constant, Struct};

/// Constants that the viewer's shaders share with Rust.
#[must_use]
pub fn constants() -> Vec<Constant> {
    vec![
        ("common/view_texture.wgsl", "MIRROR", vec![f64::from(scene::MIRROR)]),
        ("common/view_texture.wgsl", "CLAMP", vec![f64::from(scene::CLAMP)]),
        ("common/view_texture.wgsl", "NEAREST", vec![f64::from(scene::NEAREST)]),
        ("common/view_scene.wgsl", "BALLS", vec![f64::from(ROW)]),
        ("common/view_scene.wgsl", "MAX_LEVELS", vec![MAX_LEVELS as f64]),
        ("view/scene.wgsl", "MAX_PROBES", vec![scene::MAX_PROBES as f64]),
        ("view/scene.wgsl", "MAX_RADIANCE", vec![scene::MAX_RADIANCE]),
        ("view/scene_pose.wgsl", "POSE_GROUP", vec![f64::from(scene::POSE_GROUP)]),
    ]
}

/// Uniforms of the viewer's shaders.
#[must_use]
pub fn structs() -> Vec<Struct> {
    let file = "common/view_scene.wgsl";
    let parts = "common/view_parts.wgsl";
    let textures = "common/view_texture.wgsl";
    vec![
        (parts, "SceneCorner", scene::SceneCorner::MEMBERS, size_of::<scene::SceneCorner>()),
        (parts, "SceneLight", scene::LightUniform::MEMBERS, size_of::<scene::LightUniform>()),
        (parts, "ScenePart", scene::PartUniform::MEMBERS, size_of::<scene::PartUniform>()),
        (textures, "SceneTexture", scene::TextureUniform::MEMBERS, size_of::<scene::TextureUniform>()),
        ("view/scene.wgsl", "SceneFrame", scene::FrameUniform::MEMBERS, size_of::<scene::FrameUniform>()),
        ("view/scene_pose.wgsl", "ScenePose", scene::PoseUniform::MEMBERS, size_of::<scene::PoseUniform>()),
        (file, "Ball", BallUniform::MEMBERS, size_of::<BallUniform>()),
        (file, "Diffuse", Diffuse::MEMBERS, size_of::<Diffuse>()),
        (file, "Material", MaterialUniform::MEMBERS, size_of::<MaterialUniform>()),
        (file, "ViewFrame", ViewFrame::MEMBERS, size_of::<ViewFrame>()),
        ("view/present.wgsl", "Present", Present::MEMBERS, size_of::<Present>()),
    ]
}
