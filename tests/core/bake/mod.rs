//! Bakes and the DFG table.

mod bounds;
pub(super) mod cancel;
pub(super) mod maps;
mod sheen;
mod solve;
