//! The test suite: one binary, a module a concern.

mod analysis;
mod bake;
mod cli;
mod cpu;
mod geometry;
#[cfg(feature = "gpu")]
mod gpu;
mod image;
mod io;
mod ladder;
mod oem;
mod realtime;
mod sat;
mod sphere;
mod support;
mod synth;
mod target;
#[cfg(feature = "view")]
mod view;

/// Counts what is allocated, for [`io::fuzz`].
#[global_allocator]
static MEMORY: peakmem_alloc::PeakMemAlloc<std::alloc::System> = peakmem_alloc::PeakMemAlloc::system();
