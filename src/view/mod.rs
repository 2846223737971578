//! The live glossiness slider: objects under an environment, every pixel a lobe of its own roughness.
//!
//! ```text
//! environment --light--> OEM, SAT, soft tables, harmonics --+
//! camera, object, look --scene--> uniforms ----------------+--> picture (linear, as fine as time allows)
//!                                                           |        |
//! truth: reflected directions read back, adaptive lobes ----+        +--present--> tone-mapped pixels
//! ```
//!
//! [`Look`] says what is shown; [`Renderer`] draws it into any texture, in a window or, by [`screenshot()`],
//! into an image. Surfaces are glTF's metallic-roughness model by the split sum: radiance of the lobe around
//! the mirrored view, times what the table of [`crate::bake::dfg`] says that the surface reflects of white,
//! multiple scattering included; and for dielectrics the irradiance of the environment's harmonics. Spheres
//! and knots are metals, meshes have the materials of their files.

mod accessor;
mod camera;
mod frame;
mod gltf;
mod levels;
mod light;
mod look;
mod material;
pub mod mesh;
mod model;
mod obj;
mod panel;
mod present;
mod renderer;
mod roughness_map;
mod screenshot;
#[doc(hidden)]
pub mod shared;
mod textures;
mod truth;
mod viewer;
#[cfg(target_arch = "wasm32")]
pub mod web;
mod window;

pub use camera::{Camera, FRONT};
pub use levels::Levels;
pub use light::Light;
pub use look::{Filter, Look, Object, Paint, Show, Tone};
pub use material::{Image, Material, Texture, Wrap};
pub use mesh::{Mesh, Part, Vertex};
pub use present::Viewport;
pub use renderer::Renderer;
pub use screenshot::{Screenshot, screenshot};
pub use truth::Truth;
pub use viewer::Viewer;
pub use window::Start;
#[cfg(not(target_arch = "wasm32"))]
pub use window::run;
