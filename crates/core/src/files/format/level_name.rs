//! Names of the images of a bake: `m{level}_{face}`, irradiance and bounds.

use crate::sphere::cube::Face;
use std::fmt;

/// Content of an image of a bake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The level of that number, from 0.
    Level(u32),
    /// The irradiance.
    Irradiance,
    /// The unfiltered environment.
    Skybox,
}

/// Identifies an image of a bake in a file or a part. Displays as its name without extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LevelName {
    /// Its content.
    pub shown: Shown,
    /// The face; `None` if one image holds the whole level.
    pub face: Option<Face>,
    /// Whether it holds the certified bounds of the level instead of its radiance.
    pub is_bound: bool,
}

impl LevelName {
    /// The image of the whole level `level`.
    #[must_use]
    pub const fn whole(level: u32) -> Self {
        Self { shown: Shown::Level(level), face: None, is_bound: false }
    }

    /// A face of the level `level`.
    #[must_use]
    pub const fn face(level: u32, face: Face) -> Self {
        Self { shown: Shown::Level(level), face: Some(face), is_bound: false }
    }

    /// Parses a name without extension.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let (text, is_bound) = text.strip_suffix("_bound").map_or((text, false), |text| (text, true));
        let (shown, face) = text.split_once('_').map_or((text, None), |(shown, face)| (shown, Some(face)));
        let face = match face {
            Some(name) => Some(Face::ALL.into_iter().find(|face| face.short_name() == name)?),
            None => None,
        };
        let shown = match shown {
            "irradiance" => Shown::Irradiance,
            "skybox" => Shown::Skybox,
            _ => Shown::Level(shown.strip_prefix('m')?.parse().ok()?),
        };
        Some(Self { shown, face, is_bound })
    }
}

impl fmt::Display for LevelName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.shown {
            Shown::Level(level) => write!(f, "m{level}")?,
            Shown::Irradiance => f.write_str("irradiance")?,
            Shown::Skybox => f.write_str("skybox")?,
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
        for shown in [Shown::Irradiance, Shown::Skybox, Shown::Level(0), Shown::Level(14)] {
            for face in Face::ALL.into_iter().map(Some).chain([None]) {
                for is_bound in [false, true] {
                    let name = LevelName { shown, face, is_bound };
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
