//! The pipeline as compute passes.
//!
//! Data that depends only on sizes and roughness (overlaps of source and target texels, solid angles, moments
//! of texels, the directions of a level) is computed once by the double-precision code of the CPU engine and
//! uploaded. Data that depends on the light is computed by shaders, one `.wgsl` file per stage with the same
//! stem as on the CPU:
//!
//! ```text
//! texture --reparameterise--> OEM planes --fixed_point--> exponents --sat_scan--> SAT planes --pack--> boxes
//!                                 +--build_pyramid--> mip chain of Gaussians, suns, harmonics --> pyramid
//!                                 +--cells--> quadtree of moments --adaptive--> lobes with bounds
//! ```
//!
//! Integer stages equal the CPU's word for word; float stages lie within bounds derived in their tests.
//! Everything runs on baseline WebGPU: no 64-bit integers, no subgroups, no waiting between workgroups, 8
//! storage buffers per stage, bindings up to 128 MiB.
//!
//! [`direct`] draws triangles into octahedral maps, in place of a texture to reparameterise.
//!
//! A pass is a function ([`stages::sat_scan::stage`]) that binds pipelines to buffers: a [`Stage`], which
//! records into the caller's encoder. Recording allocates nothing, submits nothing and waits for nothing. The
//! [`Context`] compiles pipelines when they are first asked for, and keeps them.

#![allow(rustdoc::private_intra_doc_links, reason = "who works on the crate follows them")]

pub mod device;
pub mod direct;
pub mod engine;
pub mod live;
pub mod live_probes;
pub mod shadow;
pub mod stages;
pub mod triangles;

pub use wgpu;

#[cfg(not(target_arch = "wasm32"))]
pub use device::block_on::block_on;
pub use device::context::{Context, adapters};
pub use device::stage::Stage;
pub use stages::oem::{OemPlanes, SatPlanes};
