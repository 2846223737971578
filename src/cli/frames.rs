//! Frames of `octagloss query --frames`: a normal, a view and a tangent each, which may be missing.

use super::rows::Kind;
use crate::frame::Frame;
use anyhow::anyhow;
use glam::DVec3;

pub(super) const FRAMES: Kind<Frame> = Kind {
    columns: &["nx", "ny", "nz", "vx", "vy", "vz", "tx", "ty", "tz"],
    required: 6,
    plural: "frames",
    parse: |values| {
        let vector = |k: usize| DVec3::new(values[k], values[k + 1], values[k + 2]);
        let tangent = if values.len() == 9 { vector(6) } else { DVec3::ZERO };
        Frame::new(vector(0), vector(3), tangent)
            .ok_or_else(|| anyhow!("the normal or the view is 0,0,0, which is not a direction"))
    },
};
