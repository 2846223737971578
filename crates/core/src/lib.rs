//! The core of octagloss: maps of the sphere, lobes, tables of light, the CPU engine, bakes and files.
//! Programs use the package `octagloss`, which exports what is public of it.

#![allow(rustdoc::private_intra_doc_links, reason = "who works on the crate follows them")]

pub mod analysis;
pub mod bake;
pub mod common;
pub mod cpu;
pub mod files;
pub mod geometry;
pub mod light;
pub mod lobe;
pub mod pyramid;
pub mod sphere;
