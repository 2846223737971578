//! An environment between reading and baking: mirrored, rotated, without its sun.

use super::report::SunReport;
use crate::analysis::extraction::{Lamp, Suns, extract};
use crate::environment::Environment;
use crate::io::ReadOptions;
use crate::io::provenance::{Provenance, TakenSun};

/// Changes to an environment after reading, in this order.
#[derive(Clone, Debug, Default)]
pub struct Turn {
    /// Whether to mirror it: x becomes -x.
    pub mirror: bool,
    /// Rotation about +Y in degrees.
    pub rotate_y: f64,
    /// The suns to remove.
    pub extract_sun: Option<Suns>,
}

/// An environment as it is baked.
pub struct Turned {
    /// The light.
    pub environment: Environment,
    /// What outputs record of it.
    pub provenance: Provenance,
    /// The removed suns.
    pub suns: Vec<SunReport>,
    /// What was removed, one line each.
    pub notes: Vec<String>,
    /// What was to be removed or might be, and was not.
    pub warnings: Vec<String>,
}

impl Turn {
    /// Changes `environment`, which was read by `options`.
    #[must_use]
    pub fn applied(self, mut environment: Environment, options: &ReadOptions) -> Turned {
        let Self { mirror, rotate_y, extract_sun } = self;
        if mirror {
            environment = environment.mirrored();
        }
        if rotate_y != 0.0 {
            environment = environment.rotated_y(rotate_y);
        }
        let (mut taken, mut suns) = (Vec::new(), Vec::new());
        let (mut notes, mut warnings) = (Vec::new(), Vec::new());
        if let Some(asked) = extract_sun {
            let extraction = extract(&environment, &asked);
            (notes, warnings) = (extraction.notes(), extraction.warnings());
            taken = extraction.lamps.iter().map(|lamp| TakenSun::from(&lamp.sun)).collect();
            let report = |lamp: &Lamp| SunReport::new(&lamp.sun, lamp.energy_share);
            suns = extraction.lamps.iter().map(report).collect();
            environment = extraction.sunless;
        }
        let ReadOptions { scale, crop, pad, .. } = *options;
        let provenance = Provenance {
            rotate_y: Some(rotate_y),
            mirror: Some(mirror),
            suns: taken,
            scale: Some(scale).filter(|scale| *scale != 1.0),
            crop: crop.then_some(true),
            pad,
            ..Provenance::default()
        };
        Turned { environment, provenance, suns, notes, warnings }
    }
}
