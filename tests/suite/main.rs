//! The test suite: one binary, a module a concern.

mod common;
mod oracle;
mod sphere;
