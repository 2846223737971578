//! The test suite: one binary, one module per concern.

mod analysis;
mod atlas;
mod bake;
mod cli;
mod cpu;
mod geometry;
#[cfg(feature = "gpu")]
mod gpu;
mod image;
mod io;
mod laboratory;
mod ladder;
mod layers;
#[cfg(feature = "mesh")]
mod mesh;
mod misuse;
mod oem;
#[cfg(feature = "plot")]
mod plot;
mod pyramid;
mod recipe;
mod sat;
mod sphere;
mod support;
mod synth;
mod target;
mod target_levels;
#[cfg(feature = "view")]
mod view;

/// Counts allocations, for [`io::fuzz`].
#[global_allocator]
static MEMORY: peakmem_alloc::PeakMemAlloc<std::alloc::System> = peakmem_alloc::PeakMemAlloc::system();
