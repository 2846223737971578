//! The live glossiness viewer: objects under an environment, with a lobe of its own roughness in every pixel.
//!
//! ```text
//! environment --light--> OEM, pyramid, harmonics ----------+
//! camera, object, look --scene--> uniforms ----------------+--> picture (linear, as fine as time allows)
//!                                                           |        |
//! truth: reflected directions read back, adaptive lobes ----+        +--present--> tone-mapped pixels
//! ```
//!
//! [`Look`] describes the picture. [`Renderer`] draws it into any texture: in a window, or by
//! [`screenshot()`] into an image. Surfaces follow glTF's metallic-roughness model by the split sum: radiance
//! of the lobe around the mirrored view, times the reflectance from the table of
//! [`octagloss_core::bake::dfg`], with multiple scattering; dielectrics add the irradiance of the
//! environment's harmonics. Spheres and knots are metals; meshes use the materials of their files. [`scene`]
//! shows moving scenes instead, which reflect themselves.

#![doc(hidden)]
#![allow(rustdoc::private_intra_doc_links, reason = "who works on the crate follows them")]

mod interface;
pub mod look;
pub mod picture;
pub mod scene;
#[cfg(target_arch = "wasm32")]
pub mod web;

#[cfg(not(target_arch = "wasm32"))]
pub use interface::viewer::run;
pub use interface::window::Start;
pub use look::camera::FRONT;
pub use look::camera::{Camera, Frame, field_around};
pub use look::{Finish, Ground, Look, Object, Paint, Show, Technique, Tone};
pub use octagloss_mesh::{Image, Material, Mesh, SubMesh, Texture, Vertex, Wrap};
pub use picture::levels::Levels;
pub use picture::light::Light;
pub use picture::present::{Display, Viewport};
pub use picture::renderer::Renderer;
pub use picture::screenshot::{Screenshot, screenshot};
pub use picture::truth::{PixelQuery, Truth};
