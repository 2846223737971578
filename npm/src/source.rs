//! Reads an environment as the command line opens its input.

use crate::given::{Given, wrong};
use octagloss::internals::analysis::sun::Sun;
use octagloss::internals::bake::report::SunReport;
use octagloss::internals::environment::luminance;
use octagloss::internals::io::provenance::{Provenance, TakenSun};
use octagloss::internals::io::{self, LayoutChoice, Loaded, Pad, ReadOptions};
use octagloss::{Environment, Result};
use std::path::Path;

/// Most bytes that reading a file may take.
const MEMORY_LIMIT: u64 = 2 << 30;

/// Options of reading.
pub(crate) struct Reading {
    pub(crate) options: ReadOptions,
    pub(crate) rotate_y: f64,
    pub(crate) mirror: bool,
    pub(crate) extract_sun: bool,
}

/// An environment, and what reports record of it.
pub(crate) struct Opened {
    pub(crate) environment: Environment,
    /// The file, without its texels.
    pub(crate) loaded: Loaded,
    /// Rotation, mirroring, scale and sun, for the outputs.
    pub(crate) turned: Provenance,
    pub(crate) sun: Option<SunReport>,
    pub(crate) warnings: Vec<String>,
    /// Size and hash of the file.
    pub(crate) bytes: u64,
    pub(crate) hash: String,
}

impl Reading {
    pub(crate) fn of(given: &mut Given) -> Result<Self> {
        let layouts = [
            ("auto", LayoutChoice::Auto),
            ("equirect", LayoutChoice::Equirect),
            ("cross", LayoutChoice::Cross),
            ("strip", LayoutChoice::Strip),
            ("faces", LayoutChoice::Faces),
            ("octahedral", LayoutChoice::Octahedral),
        ];
        let reading = Self {
            options: ReadOptions {
                layout: given.choice("layout", &layouts)?.unwrap_or_default(),
                sanitize: given.flag("sanitize")?,
                strict: given.flag("strict")?,
                scale: given.number("scale")?.unwrap_or(1.0),
                crop: given.flag("crop")?,
                pad: given.choice("pad", &[Pad::Black, Pad::Edge].map(|pad| (pad.name(), pad)))?,
                memory_limit: MEMORY_LIMIT,
            },
            rotate_y: given.number("rotateY")?.unwrap_or(0.0),
            mirror: given.flag("mirror")?,
            extract_sun: given.flag("extractSun")?,
        };
        let ReadOptions { layout, sanitize, strict, scale, crop, pad, .. } = &reading.options;
        if *scale <= 0.0 {
            return wrong(format!("`scale` is {scale}; it must be above 0"));
        }
        if *strict && *sanitize {
            return wrong("`strict` and `sanitize` contradict each other; omit one");
        }
        let is_panorama = matches!(layout, LayoutChoice::Auto | LayoutChoice::Equirect);
        if (*crop || pad.is_some()) && !is_panorama {
            return wrong("`pad` and `crop` are for panoramas; omit `layout`");
        }
        Ok(reading)
    }

    /// Reads the file `input` from `bytes`; rotates, mirrors and removes the sun.
    pub(crate) fn open(&self, input: &str, bytes: &[u8]) -> Result<Opened> {
        let mut loaded = io::read_from_memory(Path::new(input), bytes, &self.options)?;
        let nothing = Environment::new(octagloss::Layout::Cube { size: 1 }, vec![[0.0; 3]; 6])?;
        let mut environment = std::mem::replace(&mut loaded.environment, nothing);
        let mut warnings = std::mem::take(&mut loaded.warnings);
        if self.mirror {
            environment = environment.mirrored();
        }
        if self.rotate_y != 0.0 {
            environment = environment.rotated_y(self.rotate_y);
        }
        let mut sun = None;
        if self.extract_sun {
            match Sun::extract(&environment) {
                Some(extraction) => {
                    sun = Some(SunReport::new(&extraction.sun, extraction.energy_share));
                    environment = extraction.sunless;
                }
                None => warnings.push(no_sun(&environment)),
            }
        }
        let taken = |sun: &SunReport| TakenSun {
            direction: sun.direction,
            irradiance: sun.irradiance,
            solid_angle: sun.solid_angle,
        };
        let ReadOptions { scale, crop, pad, .. } = self.options;
        let turned = Provenance {
            rotate_y: Some(self.rotate_y),
            mirror: Some(self.mirror),
            sun: sun.as_ref().map(taken),
            scale: Some(scale).filter(|scale| *scale != 1.0),
            crop: crop.then_some(true),
            pad,
            ..Provenance::default()
        };
        let hash = blake3::hash(bytes).to_hex().to_string();
        Ok(Opened { environment, loaded, turned, sun, warnings, bytes: bytes.len() as u64, hash })
    }
}

/// Why no sun of `environment` was removed.
fn no_sun(environment: &Environment) -> String {
    match Sun::find(environment) {
        None => "no sun detected, so none was removed".to_owned(),
        Some(region) => format!(
            "no sun detected, so none was removed: the brightest region covers {:.2e} sr and is {:.0} times as \
             bright as its surroundings; a sun covers at most 0.01 sr and is at least 100 times as bright",
            region.solid_angle,
            f64::from(luminance(region.peak)) / region.surroundings,
        ),
    }
}
