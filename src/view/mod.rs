//! The live glossiness viewer: objects under an environment, with a lobe of its own roughness in every pixel.
//!
//! ```text
//! environment --light--> OEM, SAT, soft tables, harmonics --+
//! camera, object, look --scene--> uniforms ----------------+--> picture (linear, as fine as time allows)
//!                                                           |        |
//! truth: reflected directions read back, adaptive lobes ----+        +--present--> tone-mapped pixels
//! ```
//!
//! [`Look`] describes the picture. [`Renderer`] draws it into any texture: in a window, or by
//! [`screenshot()`] into an image. Surfaces follow glTF's metallic-roughness model by the split sum: radiance
//! of the lobe around the mirrored view, times the reflectance from the table of [`crate::bake::dfg`], with
//! multiple scattering; dielectrics add the irradiance of the environment's harmonics. Spheres and knots are
//! metals; meshes use the materials of their files. [`scene`] shows moving scenes instead, which reflect
//! themselves.

mod camera;
mod frame;
mod later;
pub mod legend;
mod levels;
mod light;
mod look;
mod mip_levels;
mod model;
mod panel;
mod present;
mod renderer;
mod resources;
mod roughness_map;
pub mod scene;
mod screenshot;
mod truth;
mod viewer;
#[cfg(target_arch = "wasm32")]
pub mod web;
mod window;

pub use crate::mesh::{Image, Material, Mesh, SubMesh, Texture, Vertex, Wrap};
pub(crate) use camera::FRONT;
pub use camera::{Camera, Frame, field_around};
pub use levels::Levels;
pub use light::Light;
pub use look::{Finish, Ground, Look, Object, Paint, Show, Technique, Tone};
pub use present::{Display, Viewport};
pub use renderer::Renderer;
pub use screenshot::{Screenshot, screenshot};
pub use truth::Truth;
pub use viewer::Viewer;
#[cfg(not(target_arch = "wasm32"))]
pub use viewer::run;
pub use window::Start;
