//! Tests of the core: one module per concern.

mod analysis;
mod atlas;
mod bake;
mod cpu;
mod geometry;
mod image;
mod io;
mod ladder;
mod misuse;
mod oem;
mod once;
mod parallel;
mod pyramid;
mod sat;
mod sphere;
mod synth;
mod target;
mod target_levels;

/// Counts allocations, for [`io::fuzz`].
#[global_allocator]
static MEMORY: peakmem_alloc::PeakMemAlloc<std::alloc::System> = peakmem_alloc::PeakMemAlloc::system();
