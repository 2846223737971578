//! A moving scene whose glossy parts reflect it, and each other, through probes.
//!
//! ```text
//! corners --pose--> corners around a probe --direct draw--> octahedral map or cube
//!    |                                                            +--tables--> octagloss_radiance(...)
//!    |                                                            |                     |
//!    +--picture: matte parts, then glossy parts by their probes <-+---------------------+
//! ```
//!
//! [`Scene`] has the parts. [`SceneRenderer`] keeps the probes' maps up to date and draws pictures. A probe
//! is at the centre of a glossy part, and does not show that part. In its map, the other glossy parts show
//! the reflections of the tables before: reflections of reflections build up from frame to frame.

mod content;
mod gallery;
mod look;
mod panel;
mod part;
mod picture;
mod probe;
mod renderer;
mod schedule;
mod split;
mod texture;
mod uniforms;
mod viewer;

pub use content::{Scene, SceneLight};
pub use look::{Proxy, SceneLook};
#[cfg(target_arch = "wasm32")]
pub(crate) use panel::Controls;
pub use panel::MAX_BUDGET;
pub use part::{Gloss, Motion, Part};
pub use renderer::{SceneRenderer, SceneSettings, check_scene_filter, screenshot_of_scene};
pub use uniforms::{MAX_PROBES, SceneCorner};
pub use viewer::SceneStart;
#[cfg(target_arch = "wasm32")]
pub(crate) use viewer::SceneViewer;
#[cfg(not(target_arch = "wasm32"))]
pub use viewer::run_scene;
