//! The viewer's parts that need no device.

mod framing;
mod legend;
