//! The pipeline as compute passes: light on the GPU, geometry on the CPU.
//!
//! What depends on sizes and roughness alone (which source texel overlaps which target texel, solid angles,
//! moments of texels, the directions of a level) is computed once by the same double-precision code that
//! serves the CPU engine, and uploaded. What depends on the light runs in shaders, one `.wgsl` a stage with
//! the CPU's stem:
//!
//! ```text
//! texture --reparameterise--> OEM planes --fixed_point--> exponents --sat_scan--> SAT planes --pack--> textures, boxes
//!                                  +--emitters--> emitters, and the rest's SAT planes --blur, harmonics--+
//!                                  +--mirror--> texture, least radiance --------------------------------+--> fitted lobes
//!                                  +--cells--> quadtree of moments --adaptive--> lobes with bounds
//! ```
//!
//! Integer stages equal the CPU's word for word; float stages lie within bounds derived where they are
//! tested. All of it needs baseline WebGPU only: no 64-bit integers, no subgroups, no waiting between
//! workgroups, 8 storage buffers a stage, bindings up to 128 MiB.
//!
//! A pass is an immutable struct of pipelines ([`sat_scan::SatScan`]); bound to buffers it is a [`Stage`]
//! that records into the caller's encoder. Recording allocates nothing, submits nothing and waits for
//! nothing.

pub mod adaptive;
pub mod blur;
pub mod box_filter;
pub mod build_fitted;
pub mod cells;
pub mod copy;
pub mod device;
pub mod emitters;
pub mod engine;
pub mod fitted;
pub mod fixed_point;
pub mod harmonics;
pub mod lamp;
mod least;
pub mod live;
pub mod mirror;
pub mod octaves;
pub mod oem;
pub mod reparameterise;
pub mod sat_f32;
pub mod sat_hensley;
pub mod sat_scan;
#[doc(hidden)]
pub mod shared;

#[cfg(not(target_arch = "wasm32"))]
pub use device::block_on::block_on;
pub use device::context::{Context, adapters};
pub use device::stage::Stage;
pub use oem::{OemPlanes, SatPlanes};
