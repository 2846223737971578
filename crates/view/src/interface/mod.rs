//! The interface: the viewer, its window and its panel.

pub(crate) mod later;
pub(crate) mod panel;
mod view_panel;
pub(crate) mod viewer;
pub(crate) mod window;
