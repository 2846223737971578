//! Image output.

pub(super) mod preview;
