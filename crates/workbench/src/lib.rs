//! Measurements and figures of octagloss: maps of the sphere, and lobes over the tables of several.

#![allow(missing_docs, reason = "only the workbench and its tests use it")]

pub mod figures;
pub mod laboratory;
pub mod map_table;
pub mod stretch;
