//! Names of the images of a bake: `m{level}_{face}`, irradiance and bounds.

use crate::sphere::cube::Face;
use std::fmt;

/// Identifies an image of a bake in a file or a part. Displays as its name without extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LevelName {
    /// The level, from 0; `None` for the irradiance.
    pub level: Option<u32>,
    /// The face; `None` if one image holds the whole level.
    pub face: Option<Face>,
    /// Whether it holds the certified bounds of the level instead of its radiance.
    pub is_bound: bool,
}

impl LevelName {
    /// The image of the whole level `level`.
    #[must_use]
    pub const fn whole(level: u32) -> Self {
        Self { level: Some(level), face: None, is_bound: false }
    }

    /// A face of the level `level`.
    #[must_use]
    pub const fn face(level: u32, face: Face) -> Self {
        Self { level: Some(level), face: Some(face), is_bound: false }
    }

    /// Parses a name without extension.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let (text, is_bound) = text.strip_suffix("_bound").map_or((text, false), |text| (text, true));
        let (level, face) = text.split_once('_').map_or((text, None), |(level, face)| (level, Some(face)));
        let face = match face {
            Some(name) => Some(Face::ALL.into_iter().find(|face| face.short_name() == name)?),
            None => None,
        };
        let level = match level {
            "irradiance" => None,
            _ => Some(level.strip_prefix('m')?.parse().ok()?),
        };
        Some(Self { level, face, is_bound })
    }
}

impl fmt::Display for LevelName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.level {
            Some(level) => write!(f, "m{level}")?,
            None => f.write_str("irradiance")?,
        }
        if let Some(face) = self.face {
            write!(f, "_{}", face.short_name())?;
        }
        f.write_str(if self.is_bound { "_bound" } else { "" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back_as_they_were() {
        for level in [None, Some(0), Some(14)] {
            for face in Face::ALL.into_iter().map(Some).chain([None]) {
                for is_bound in [false, true] {
                    let name = LevelName { level, face, is_bound };
                    assert_eq!(LevelName::parse(&name.to_string()), Some(name));
                }
            }
        }
        assert_eq!(LevelName::face(3, Face::NegY).to_string(), "m3_ny");
        for other in ["", "m", "m1_", "m1_qx", "n1_px", "m1_px_px", "irradiance_", "mx", "report"] {
            assert_eq!(LevelName::parse(other), None, "{other}");
        }
    }
}
