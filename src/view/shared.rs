//! Declarations that the viewer's shaders repeat; see [`crate::gpu::shared`] for those of the stages.

use super::frame::{BallUniform, Diffuse, MOST_LEVELS, ViewFrame};
use super::look::ROW;
use super::model::MaterialUniform;
use super::present::Present;
#[cfg(not(target_arch = "wasm32"))]
use super::scene;
use crate::gpu::shared::{Constant, Struct};

/// Constants that the viewer's shaders share with Rust.
#[must_use]
pub fn constants() -> Vec<Constant> {
    vec![
        ("common/view_scene.wgsl", "BALLS", vec![f64::from(ROW)]),
        ("common/view_scene.wgsl", "MOST_LEVELS", vec![MOST_LEVELS as f64]),
        #[cfg(not(target_arch = "wasm32"))]
        ("view/scene.wgsl", "MOST_PROBES", vec![scene::MOST_PROBES as f64]),
        #[cfg(not(target_arch = "wasm32"))]
        ("view/scene.wgsl", "MOST_RADIANCE", vec![scene::MOST_RADIANCE]),
        #[cfg(not(target_arch = "wasm32"))]
        ("view/scene_pose.wgsl", "POSE_GROUP", vec![f64::from(scene::POSE_GROUP)]),
    ]
}

/// Uniforms of the viewer's shaders.
#[must_use]
pub fn structs() -> Vec<Struct> {
    let file = "common/view_scene.wgsl";
    #[cfg(not(target_arch = "wasm32"))]
    let parts = "common/view_parts.wgsl";
    vec![
        #[cfg(not(target_arch = "wasm32"))]
        (parts, "SceneCorner", scene::SceneCorner::MEMBERS, size_of::<scene::SceneCorner>()),
        #[cfg(not(target_arch = "wasm32"))]
        (parts, "SceneLight", scene::LightUniform::MEMBERS, size_of::<scene::LightUniform>()),
        #[cfg(not(target_arch = "wasm32"))]
        (parts, "ScenePart", scene::PartUniform::MEMBERS, size_of::<scene::PartUniform>()),
        #[cfg(not(target_arch = "wasm32"))]
        ("view/scene.wgsl", "SceneDraw", scene::DrawUniform::MEMBERS, size_of::<scene::DrawUniform>()),
        #[cfg(not(target_arch = "wasm32"))]
        ("view/scene.wgsl", "SceneFrame", scene::FrameUniform::MEMBERS, size_of::<scene::FrameUniform>()),
        #[cfg(not(target_arch = "wasm32"))]
        ("view/scene_pose.wgsl", "ScenePose", scene::PoseUniform::MEMBERS, size_of::<scene::PoseUniform>()),
        (file, "Ball", BallUniform::MEMBERS, size_of::<BallUniform>()),
        (file, "Diffuse", Diffuse::MEMBERS, size_of::<Diffuse>()),
        (file, "Material", MaterialUniform::MEMBERS, size_of::<MaterialUniform>()),
        (file, "ViewFrame", ViewFrame::MEMBERS, size_of::<ViewFrame>()),
        ("view/present.wgsl", "Present", Present::MEMBERS, size_of::<Present>()),
    ]
}
