//! Sources that `octagloss compare` measures bakes against: each is read once, each of its lobes integrated
//! once.

use super::args::CompareArgs;
use super::console::Console;
use super::input;
use super::outcome::Outcome;
use super::shared_args::InputArgs;
use crate::analysis::extraction::Suns;
use crate::environment::Rgb;
use crate::filter::Filter;
use crate::io::provenance::{Provenance, TakenSun};
use crate::lobe::Lobe;
use crate::reflector::{Reflector, ReflectorSettings};
use crate::{Environment, Result};
use glam::DVec3;
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

/// Tolerance of the reference lobes.
const TOLERANCE: f64 = 0.002;

/// The source of a comparison, as the compared bakes need it: they can differ in rotation, scale or sun.
pub(super) struct Sources<'a> {
    args: &'a CompareArgs,
    console: &'a Console,
    prepared: RefCell<Vec<Rc<PreparedSource>>>,
}

/// The source, prepared by the options `input`.
pub(super) struct PreparedSource {
    input: InputArgs,
    pub(super) environment: Environment,
    /// Lobes by the bits of the sharpest roughness of their reflector and of their own.
    lobes: RefCell<HashMap<[u64; 2], Vec<Rgb>>>,
}

impl<'a> Sources<'a> {
    pub(super) fn new(args: &'a CompareArgs, console: &'a Console) -> Self {
        Self { args, console, prepared: RefCell::default() }
    }

    /// The lobe of the bake in `path`, and the source prepared like the bake's, unless options override it:
    /// scaled, cropped, padded, rotated, mirrored and without its sun.
    pub(super) fn lobe_and_source(
        &self,
        path: &Path,
        provenance: &Provenance,
    ) -> Outcome<(Lobe, Rc<PreparedSource>)> {
        let Self { args, console, .. } = self;
        let lobe = args.lobe.or(provenance.lobe).unwrap_or_else(|| {
            console.warn(&format!(
                "{} does not record its lobe; assuming ggx (override with --lobe)",
                path.display()
            ));
            Lobe::Ggx
        });
        if provenance.rotate_y.or(args.input.rotate_y).is_none() {
            console.warn(&format!(
                "{} does not record its source's rotation; assuming none (override with --rotate-y, \
                 --mirror, --extract-sun)",
                path.display()
            ));
        }
        let input = InputArgs {
            rotate_y: args.input.rotate_y.or(provenance.rotate_y),
            mirror: args.input.mirror || provenance.mirror.unwrap_or(false),
            extract_sun: args.input.extract_sun.clone().or_else(|| taken(provenance)),
            scale: args.input.scale.or(provenance.scale),
            crop: args.input.crop || provenance.crop.unwrap_or(false),
            pad: args.input.pad.or(provenance.pad),
            ..args.input.clone()
        };
        Ok((lobe, self.prepared(input)?))
    }

    /// The source prepared by `input`.
    fn prepared(&self, input: InputArgs) -> Outcome<Rc<PreparedSource>> {
        if let Some(known) = self.prepared.borrow().iter().find(|known| known.input == input) {
            return Ok(Rc::clone(known));
        }
        let source = input::single_source(vec![self.args.against.clone()], &input)?;
        let environment = source.open(&input, self.console)?.environment;
        let prepared = Rc::new(PreparedSource { input, environment, lobes: RefCell::default() });
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
    /// Calls `measure` with the reference lobes of GGX along `directions`, always the same ones, at a
    /// roughness of at least `sharpest` or 0.
    pub(super) fn with_lobes<T>(
        &self,
        sharpest: f64,
        measure: impl FnOnce(&dyn Fn(f64, &[DVec3]) -> Result<Vec<Rgb>>) -> Result<T>,
    ) -> Result<T> {
        let settings = ReflectorSettings { sharpest, ..ReflectorSettings::default() };
        let reflector = Reflector::new(&self.environment, &settings)?;
        measure(&|roughness, directions| {
            let key = [sharpest, roughness].map(f64::to_bits);
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
