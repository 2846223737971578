//! The live glossiness slider: objects under an environment, every pixel a lobe of its own roughness.
//!
//! ```text
//! environment --light--> OEM, SAT, soft tables, harmonics --+
//! camera, object, look --scene--> uniforms ----------------+--> picture (linear, as fine as time allows)
//!                                                           |        |
//! truth: reflected directions read back, adaptive lobes ----+        +--present--> tone-mapped pixels
//! ```
//!
//! [`Look`] says what is shown; [`Renderer`] draws it into any texture, in a window or, by [`screenshot()`], into an image.
//! Surfaces are metals by the split sum: radiance of the lobe around the mirrored view, times what the table of
//! [`crate::dfg`] says that the metal reflects of white, multiple scattering included.

mod camera;
mod light;
mod look;
mod mesh;
mod panel;
mod present;
mod renderer;
mod roughness_map;
mod screenshot;
mod textures;
mod truth;
mod viewer;
#[cfg(target_arch = "wasm32")]
pub mod web;
mod window;

pub use camera::Camera;
pub use light::Light;
pub use look::{Filter, Look, Object, Show, Tone};
pub use mesh::{Mesh, Vertex};
pub use present::Viewport;
pub use renderer::Renderer;
pub use roughness_map::RoughnessMap;
pub use screenshot::{Screenshot, screenshot};
pub use truth::Truth;
pub use viewer::Viewer;
pub use window::Start;
#[cfg(not(target_arch = "wasm32"))]
pub use window::run;
