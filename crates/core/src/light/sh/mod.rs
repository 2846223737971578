//! Spherical harmonics of an environment: coefficients, engines' scales, windows.

mod coefficients;
pub mod scale;
pub mod window;

pub use coefficients::*;
