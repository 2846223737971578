//! Geometry that both engines use.

mod resample;
