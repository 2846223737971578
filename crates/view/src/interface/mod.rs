//! The interface: the viewer, its window and its panel.

pub(crate) mod later;
pub(crate) mod panel;
pub(crate) mod viewer;
pub(crate) mod window;
