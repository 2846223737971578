//! The device and its helpers: shaders, stages, readback, timers.

#[cfg(not(target_arch = "wasm32"))]
pub(super) mod block_on;
pub mod context;
pub mod readback;
pub mod resources;
pub mod stage;
pub mod timer;
