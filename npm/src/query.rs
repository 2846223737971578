//! Single queries: lobes around directions.

use crate::options::wrong;
use glam::DVec3;
use octagloss::queries::{Query as Directions, sharpest};
use octagloss::recipes::{InputOptions, TableOptions};
use octagloss::{Answer, Bound, Environment, Filter, Lobe, Reflector, Result};
use serde::{Deserialize, Serialize};

/// Options of a query other than directions and roughness.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Query {
    #[serde(flatten)]
    pub(crate) input: InputOptions,
    #[serde(flatten)]
    table: TableOptions,
    lobe: Lobe,
    filter: Filter,
    bound: bool,
}

impl Query {
    pub(crate) fn check(&self) -> Result<()> {
        self.input.check()?;
        self.table.check(self.filter)?;
        if self.bound && !matches!(self.filter, Filter::Adaptive(_)) {
            return wrong("`bound` needs `filter` adaptive:E; other filters have no certified bounds");
        }
        Ok(())
    }

    /// Red, green and blue of each of `directions`, three numbers each, and with `bound` a fourth number.
    /// `roughness` has one number, or one for each direction; none for the cosine lobe.
    pub(crate) fn answer(
        &self,
        environment: &Environment,
        directions: &[f64],
        roughness: &[f64],
    ) -> Result<Vec<f32>> {
        let (directions, rest) = directions.as_chunks::<3>();
        if !rest.is_empty() {
            return wrong(format!(
                "`directions` has {} numbers; three a direction are needed",
                3 * directions.len() + rest.len()
            ));
        }
        let directions: Vec<DVec3> = directions.iter().copied().map(DVec3::from_array).collect();
        let each = self.roughness(roughness, directions.len())?;
        self.filter.check(self.lobe, self.table.oem_size)?;
        let settings = self.table.reflector(self.filter, sharpest(self.lobe, &each).unwrap_or(1.0));
        let reflector = Reflector::new(environment, &settings)?;
        let query =
            Directions { lobe: self.lobe, filter: self.filter, directions: &directions, roughness: &each };
        let answers = query.answered(&reflector)?;
        let row = |answer: &Answer| {
            let bounds = self.bound.then(|| answer.bound.unwrap_or(Bound::NONE).values());
            answer.radiance.into_iter().chain(bounds.into_iter().flatten())
        };
        Ok(answers.iter().flat_map(row).collect())
    }

    /// One roughness for each of `count` directions.
    fn roughness(&self, given: &[f64], count: usize) -> Result<Vec<f64>> {
        let name = self.lobe.name();
        let each = match (self.lobe, given) {
            (Lobe::Cosine, []) => vec![1.0; count],
            (Lobe::Cosine, _) => return wrong("the lobe cosine has no roughness; omit `roughness`"),
            (_, []) => return wrong(format!("the lobe {name} needs `roughness`, from 0 to 1")),
            (_, [one]) => vec![*one; count],
            (_, many) if many.len() == count => many.to_vec(),
            (_, many) => {
                return wrong(format!(
                    "`roughness` has {} numbers for {count} directions; one, or one for each, is needed",
                    many.len()
                ));
            }
        };
        match each.iter().find(|value| !(0.0..=1.0).contains(*value)) {
            Some(value) => wrong(format!("`roughness` {value} is outside of 0 to 1")),
            None => Ok(each),
        }
    }
}
