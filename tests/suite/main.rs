//! The test suite: one binary, a module a concern.

mod common;
mod oem;
mod oracle;
mod sat;
mod sphere;
