//! Bakes and the DFG table.

pub(super) mod cancel;
pub(super) mod dfg;
pub(super) mod maps;
pub(super) mod report;
mod sheen;
mod solve;
