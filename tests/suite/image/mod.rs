//! Pictures.

pub(super) mod preview;
