//! One level of a bake that several bakes may share.

use crate::chain::Rung;
use crate::filter::Filter;
use crate::lobe::Lobe;

/// What makes one level differ from another of the same environment.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Part {
    pub(crate) rung: Rung,
    pub(crate) lobe: Lobe,
    pub(crate) filter: Filter,
}
