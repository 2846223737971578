//! Sources that `octagloss compare` measures bakes against: each is read once, each of its lobes integrated
//! once.

use super::console::Console;
use super::input::InputFiles;
use super::outcome::Outcome;
use crate::read::{Provenance, TakenSun};
use crate::recipes::InputOptions;
use crate::suns::{Sun, Suns};
use crate::{Environment, Filter, Lobe, Reflector, ReflectorSettings, Result, Rgb};
use glam::DVec3;
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

/// Tolerance of the reference lobes.
const TOLERANCE: f64 = 0.002;

/// The source of a comparison, as the compared bakes need it: they can differ in rotation, scale or sun.
pub(super) struct Sources<'a> {
    files: InputFiles,
    input: &'a InputOptions,
    /// The lobe of all bakes, whatever they record.
    lobe: Option<Lobe>,
    pub(super) console: &'a Console,
    prepared: RefCell<Vec<Rc<PreparedSource>>>,
}

/// The source, prepared by the options `input`.
pub(super) struct PreparedSource {
    /// Its file, the first of six faces.
    pub(super) path: PathBuf,
    pub(super) input: InputOptions,
    pub(super) environment: Arc<Environment>,
    /// Direction of its brightest region.
    pub(super) sun: Option<DVec3>,
    /// Lobes by the bits of the sharpest roughness of their reflector and of their own, and their number.
    lobes: RefCell<HashMap<[u64; 3], Vec<Rgb>>>,
}

impl<'a> Sources<'a> {
    /// The environment in `files`, read by the options `input`.
    pub(super) fn new(
        files: InputFiles,
        input: &'a InputOptions,
        lobe: Option<Lobe>,
        console: &'a Console,
    ) -> Self {
        Self { files, input, lobe, console, prepared: RefCell::default() }
    }

    /// The source's path; the first of six faces.
    pub(super) fn path(&self) -> &Path {
        self.files.path()
    }

    /// The lobe of the bake in `path`, and the source prepared like the bake's, unless options override it:
    /// scaled, cropped, padded, rotated, mirrored and without its sun.
    pub(super) fn lobe_and_source(
        &self,
        path: &Path,
        provenance: &Provenance,
    ) -> Outcome<(Lobe, Rc<PreparedSource>)> {
        let Self { input: given, lobe, console, .. } = self;
        let name = path.display();
        let lobe = lobe.or(provenance.lobe).unwrap_or_else(|| {
            console.warn(&format!("{name} does not record its lobe; assuming ggx (override with --lobe)"));
            Lobe::Ggx
        });
        if provenance.rotate_y.or(given.rotate_y).is_none() {
            console.warn(&format!(
                "{name} does not record its source's rotation; assuming none (override with --rotate-y, \
                 --mirror, --extract-sun)"
            ));
        }
        let input = InputOptions {
            rotate_y: given.rotate_y.or(provenance.rotate_y),
            mirror: given.mirror || provenance.mirror.unwrap_or(false),
            extract_sun: given.extract_sun.clone().or_else(|| taken(provenance)),
            // 1 is what a bake without a record has.
            scale: given.scale.or(provenance.scale).filter(|scale| *scale != 1.0),
            crop: given.crop || provenance.crop.unwrap_or(false),
            pad: given.pad.or(provenance.pad),
            ..(*given).clone()
        };
        Ok((lobe, self.prepared(input)?))
    }

    /// The source prepared by `input`.
    fn prepared(&self, input: InputOptions) -> Outcome<Rc<PreparedSource>> {
        if let Some(known) = self.prepared.borrow().iter().find(|known| known.input == input) {
            return Ok(Rc::clone(known));
        }
        let environment = self.files.open(&input, self.console)?.environment;
        let sun = Sun::find(&environment).map(|sun| sun.direction);
        let prepared = PreparedSource {
            path: self.path().to_owned(),
            input,
            environment,
            sun,
            lobes: RefCell::default(),
        };
        let prepared = Rc::new(prepared);
        self.prepared.borrow_mut().push(Rc::clone(&prepared));
        Ok(prepared)
    }
}

/// The suns that a bake's source has lost.
fn taken(provenance: &Provenance) -> Option<Suns> {
    let direction = |sun: &TakenSun| DVec3::from_array(sun.direction).try_normalize();
    let directions: Vec<DVec3> = provenance.suns.iter().filter_map(direction).collect();
    (!directions.is_empty()).then_some(Suns::Towards(directions))
}

impl PreparedSource {
    /// The reference lobes of GGX along directions, always the same ones for their number and a roughness of
    /// at least `sharpest` or 0.
    pub(super) fn lobes(&self, sharpest: f64) -> Result<impl Fn(f64, &[DVec3]) -> Result<Vec<Rgb>>> {
        let settings = ReflectorSettings { sharpest, ..ReflectorSettings::default() };
        let reflector = Reflector::new(&self.environment, &settings)?;
        Ok(move |roughness: f64, directions: &[DVec3]| {
            let key = [sharpest.to_bits(), roughness.to_bits(), directions.len() as u64];
            if let Some(known) = self.lobes.borrow().get(&key) {
                return Ok(known.clone());
            }
            let answers =
                reflector.query_all(directions, roughness, Lobe::Ggx, Filter::Adaptive(TOLERANCE))?;
            let lobes: Vec<Rgb> = answers.into_iter().map(|answer| answer.radiance).collect();
            self.lobes.borrow_mut().insert(key, lobes.clone());
            Ok(lobes)
        })
    }
}
