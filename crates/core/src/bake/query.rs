//! Queries of many directions, each with its own roughness.

use super::Engine;
use crate::common::direction::units;
use crate::common::error::{Result, wrong};
use crate::common::parallel;
use crate::cpu::reflector::{Lobes, Reflector, Workspace, check_answers};
use crate::lobe::Lobe;
use crate::lobe::filter::{Answer, Filter};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Directions to be answered by one lobe and filter.
#[derive(Clone, Copy, Debug)]
pub struct Query<'a> {
    /// The lobe.
    pub lobe: Lobe,
    /// The filter.
    pub filter: Filter,
    /// In world space, any length but zero.
    pub directions: &'a [DVec3],
    /// Roughness of each direction.
    pub roughness: &'a [f64],
}

/// Directions that share a roughness.
struct Alike {
    roughness: f64,
    /// Their indices in the query.
    indices: Vec<usize>,
    directions: Vec<DVec3>,
}

impl Query<'_> {
    /// Groups directions by roughness, so that each lobe is prepared once.
    fn alike(&self) -> Result<Vec<Alike>> {
        let directions = units(self.directions)?;
        if directions.len() != self.roughness.len() {
            return wrong(format!(
                "{} directions and {} numbers of roughness; one for each direction is needed",
                directions.len(),
                self.roughness.len()
            ));
        }
        // Bits of nonnegative floats sort like the numbers.
        let mut by_roughness: BTreeMap<u64, Alike> = BTreeMap::new();
        for (place, (direction, roughness)) in directions.iter().zip(self.roughness).enumerate() {
            let none = || Alike { roughness: *roughness, indices: Vec::new(), directions: Vec::new() };
            let alike = by_roughness.entry(roughness.to_bits()).or_insert_with(none);
            alike.indices.push(place);
            alike.directions.push(*direction);
        }
        Ok(by_roughness.into_values().collect())
    }

    /// Each roughness once.
    pub fn roughnesses(&self) -> Vec<f64> {
        let bits: BTreeSet<u64> = self.roughness.iter().map(|roughness| roughness.to_bits()).collect();
        bits.into_iter().map(f64::from_bits).collect()
    }

    /// The answers of `engine`, in the order of the directions.
    pub async fn answers(&self, engine: &impl Engine) -> Result<Vec<Answer>> {
        let mut ordered = vec![Answer { radiance: [0.0; 3], bound: None }; self.directions.len()];
        for Alike { roughness, indices, directions } in self.alike()? {
            let answers = engine.query_each(&directions, self.lobe, roughness, self.filter).await?;
            indices.into_iter().zip(answers).for_each(|(place, answer)| ordered[place] = answer);
        }
        Ok(ordered)
    }

    /// The answers of the CPU, in the order of the directions.
    ///
    /// # Errors
    /// As [`Reflector::query`].
    pub fn answered(&self, reflector: &Reflector<'_>) -> Result<Vec<Answer>> {
        self.answered_unless(reflector, &|| Ok(()))
    }

    /// [`Self::answered`], unless `check` fails, which is called often.
    ///
    /// # Errors
    /// As [`Reflector::query`]; those of `check`.
    pub fn answered_unless(
        &self,
        reflector: &Reflector<'_>,
        check: &(dyn Fn() -> Result<()> + Sync),
    ) -> Result<Vec<Answer>> {
        let mut ordered = vec![Answer { radiance: [0.0; 3], bound: None }; self.directions.len()];
        // The reference filter prepares every texel for each lobe.
        let at_once = if self.filter == Filter::Reference { 1 } else { LOBES_AT_ONCE };
        for batch in self.alike()?.chunks(at_once) {
            let mut lobes = Vec::with_capacity(batch.len());
            for Alike { roughness, .. } in batch {
                check()?;
                lobes.push(reflector.lobes(self.lobe, *roughness, self.filter)?);
            }
            let directions = lobes
                .iter()
                .zip(batch)
                .flat_map(|(lobes, alike)| alike.directions.iter().map(move |direction| (lobes, *direction)));
            let answers = each(directions, check)?;
            let places = batch.iter().flat_map(|alike| &alike.indices);
            places.zip(answers).for_each(|(place, answer)| ordered[*place] = answer);
        }
        check_answers(self.directions, &ordered)?;
        Ok(ordered)
    }
}

/// Lobes of different roughness that are prepared before their directions are answered side by side.
const LOBES_AT_ONCE: usize = 256;

/// Most tasks at once: few directions have one each.
const TASKS: usize = 1024;

/// The answers of lobes around unit vectors, each evaluated on its own.
pub(super) fn each<'l, 'r: 'l>(
    directions: impl IntoIterator<Item = (&'l Lobes<'r>, DVec3)>,
    check: &(dyn Fn() -> Result<()> + Sync),
) -> Result<Vec<Answer>> {
    let directions: Vec<_> = directions.into_iter().collect();
    let tasks = directions.chunks(directions.len().div_ceil(TASKS).max(1));
    let answers = parallel::try_map_with(tasks, Workspace::default, |workspace, directions| {
        let mut answers = Vec::with_capacity(directions.len());
        for (lobes, direction) in directions {
            check()?;
            lobes.evaluate(&[*direction], workspace, &mut answers)?;
        }
        Ok(answers)
    })?;
    Ok(answers.concat())
}
