//! Lobes over exact summed-area tables of four maps of the sphere, by one interface, and their comparison.
//!
//! [`charts::Charts`] says for a map how large a lobe's box is and where boxes that leave a chart continue;
//! [`tables::Tables`] holds the sums; [`boxes::radiance`] and [`adaptive::Adaptive`] evaluate lobes;
//! [`measure`] compares maps with exhaustive integration over the source. Double precision, CPU only. The
//! engines use the octahedral square alone (`sat`, `cpu`).

pub mod adaptive;
pub mod boxes;
pub mod cells;
pub mod charts;
mod cube;
mod equirect;
pub mod light;
pub mod measure;
mod octahedral;
pub mod subject;
pub mod tables;
mod tennis_ball;
