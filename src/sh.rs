//! Spherical harmonics of an environment.
