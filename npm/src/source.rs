//! Reads an environment as the command line opens its input.

use crate::given::{Given, wrong};
use octagloss::internals::bake::report::SunReport;
use octagloss::internals::bake::turned::Turn;
use octagloss::read::Provenance;
use octagloss::read::{self, InputLayout, Loaded, Pad, ReadOptions};
use octagloss::suns::Suns;
use octagloss::{Environment, MAX_DEGREES, Result};
use std::path::Path;

/// Most bytes that reading a file may take.
const MEMORY_LIMIT: u64 = 2 << 30;

/// Options of reading.
pub(crate) struct Reading {
    pub(crate) options: ReadOptions,
    pub(crate) rotate_y: f64,
    pub(crate) mirror: bool,
    pub(crate) extract_sun: Option<Suns>,
}

/// An environment, and what reports record of it.
pub(crate) struct Opened {
    pub(crate) environment: Environment,
    /// The file, without its texels.
    pub(crate) loaded: Loaded,
    /// Rotation, mirroring, scale and sun, for the outputs.
    pub(crate) turned: Provenance,
    pub(crate) suns: Vec<SunReport>,
    pub(crate) warnings: Vec<String>,
    /// Size and hash of the file.
    pub(crate) bytes: u64,
    pub(crate) hash: String,
}

/// true for the brightest light, a number of lights, or their directions as texts of the command line.
fn extract_sun(given: &mut Given) -> Result<Option<Suns>> {
    let Some(text) = given.switch_number_or_text("extractSun")? else { return Ok(None) };
    Suns::parsed(&text).map(Some).or_else(|needed| wrong(format!("`extractSun` is {text:?}; {needed}")))
}

impl Reading {
    pub(crate) fn of(given: &mut Given) -> Result<Self> {
        let layouts = InputLayout::ALL.map(|layout| (layout.name(), layout));
        let reading = Self {
            options: ReadOptions {
                layout: given.choice("layout", &layouts)?.unwrap_or_default(),
                sanitize: given.flag("sanitize")?,
                strict: given.flag("strict")?,
                scale: given.number("scale")?.unwrap_or(1.0),
                crop: given.flag("crop")?,
                pad: given.choice("pad", &Pad::ALL.map(|pad| (pad.name(), pad)))?,
                memory_limit: MEMORY_LIMIT,
            },
            rotate_y: given.number("rotateY")?.unwrap_or(0.0),
            mirror: given.flag("mirror")?,
            extract_sun: extract_sun(given)?,
        };
        let ReadOptions { layout, sanitize, strict, scale, crop, pad, .. } = &reading.options;
        if reading.rotate_y.abs() > MAX_DEGREES {
            let degrees = reading.rotate_y;
            return wrong(format!("`rotateY` is {degrees}; it must be at most {MAX_DEGREES} either way"));
        }
        if *scale <= 0.0 {
            return wrong(format!("`scale` is {scale}; it must be above 0"));
        }
        if *strict && *sanitize {
            return wrong("`strict` and `sanitize` contradict each other; omit one");
        }
        let is_panorama = matches!(layout, InputLayout::Auto | InputLayout::Equirect);
        if (*crop || pad.is_some()) && !is_panorama {
            return wrong("`pad` and `crop` are for panoramas; omit `layout`");
        }
        Ok(reading)
    }

    /// Reads the file `input` from `bytes`; rotates, mirrors and removes the sun.
    pub(crate) fn open(&self, input: &str, bytes: &[u8]) -> Result<Opened> {
        let mut loaded = read::read_from_memory(Path::new(input), bytes, &self.options)?;
        let nothing = Environment::new(octagloss::Layout::Cube { size: 1 }, vec![[0.0; 3]; 6])?;
        let environment = std::mem::replace(&mut loaded.environment, nothing);
        let turn =
            Turn { mirror: self.mirror, rotate_y: self.rotate_y, extract_sun: self.extract_sun.clone() };
        let turned = turn.applied(environment, &self.options);
        let mut warnings = std::mem::take(&mut loaded.warnings);
        warnings.extend(turned.warnings);
        let hash = blake3::hash(bytes).to_hex().to_string();
        Ok(Opened {
            environment: turned.environment,
            loaded,
            turned: turned.provenance,
            suns: turned.suns,
            warnings,
            bytes: bytes.len() as u64,
            hash,
        })
    }
}
