//! The test suite: one binary, a module a concern.

mod adaptive;
mod bc6h;
mod cli;
mod cli_full;
mod cli_layouts;
mod cli_sun;
mod cli_targets;
mod cli_unchanged;
#[cfg(feature = "view")]
mod cli_view;
mod common;
mod containers;
mod dfg;
mod emitters;
mod fitted;
mod fuzz;
#[cfg(feature = "gpu")]
mod gpu;
mod inputs;
mod io_read;
mod io_write;
mod ktx2_write;
mod maps;
#[cfg(feature = "view")]
mod meshes;
mod mutation;
mod oem;
mod oem_file;
mod oracle;
mod output;
mod preview;
mod sat;
mod sphere;
mod synth;
mod targets;
mod written;

/// Counts what is allocated, for [`fuzz`].
#[global_allocator]
static MEMORY: peakmem_alloc::PeakMemAlloc<std::alloc::System> = peakmem_alloc::PeakMemAlloc::system();
