//! The axes that figures mark.

use glam::DVec3;

/// The six axes and their names.
pub(super) const AXES: [(DVec3, &str); 6] = [
    (DVec3::X, "+X"),
    (DVec3::NEG_X, "\u{2212}X"),
    (DVec3::Y, "+Y"),
    (DVec3::NEG_Y, "\u{2212}Y"),
    (DVec3::Z, "+Z"),
    (DVec3::NEG_Z, "\u{2212}Z"),
];
