//! Queries of many directions, each with its own roughness.

use super::{Engine, ready};
use crate::common::direction::units;
use crate::common::error::{Result, wrong};
use crate::cpu::reflector::Reflector;
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
        ready(self.answers(reflector))
    }
}
