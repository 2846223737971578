//! Geometry that both engines use.

mod borders;
mod conversion;
mod resample;
