//! Bakes and the DFG table.

pub(super) mod cancel;
pub(super) mod maps;
mod sheen;
mod solve;
