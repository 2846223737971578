//! What every part uses: errors, names, numbers, directions.

pub mod direction;
pub mod error;
pub mod finite;
pub mod frame;
pub mod names;
pub mod once;
pub mod parallel;
pub mod percent;
pub mod smoothstep;
pub mod vector;
