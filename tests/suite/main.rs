//! The test suite: one binary, a module a concern.

mod io_write;
mod ktx2_write;
mod output;
mod preview;
mod synth;
mod written;
