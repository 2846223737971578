//! An environment between reading and baking: mirrored, rotated, without its sun.

use super::report::SunReport;
use crate::analysis::sun::Sun;
use crate::environment::Environment;
use crate::io::ReadOptions;
use crate::io::provenance::{Provenance, TakenSun};

/// Changes to an environment after reading, in this order.
#[derive(Clone, Copy, Debug, Default)]
pub struct Turn {
    /// Whether to mirror it: x becomes -x.
    pub mirror: bool,
    /// Rotation about +Y in degrees.
    pub rotate_y: f64,
    /// Whether to remove the sun.
    pub extract_sun: bool,
}

/// An environment as it is baked.
pub struct Turned {
    /// The light.
    pub environment: Environment,
    /// What outputs record of it.
    pub provenance: Provenance,
    /// The removed sun.
    pub sun: Option<SunReport>,
    /// Why no sun was removed, although one was to be.
    pub warning: Option<String>,
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
        let (mut taken, mut sun, mut warning) = (None, None, None);
        if extract_sun {
            match Sun::extract(&environment) {
                Some(extraction) => {
                    taken = Some(TakenSun::from(&extraction.sun));
                    sun = Some(SunReport::new(&extraction.sun, extraction.energy_share));
                    environment = extraction.sunless;
                }
                None => warning = Some(Sun::why_none(&environment)),
            }
        }
        let ReadOptions { scale, crop, pad, .. } = *options;
        let provenance = Provenance {
            rotate_y: Some(rotate_y),
            mirror: Some(mirror),
            sun: taken,
            scale: Some(scale).filter(|scale| *scale != 1.0),
            crop: crop.then_some(true),
            pad,
            ..Provenance::default()
        };
        Turned { environment, provenance, sun, warning }
    }
}
