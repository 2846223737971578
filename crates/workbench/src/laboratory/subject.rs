//! Subjects of the comparison: a map with its tables, or two octahedral maps of half the texels each.

use super::adaptive::Adaptive;
use super::boxes::{LobeAnswer, radiance};
use super::cells::Cells;
use super::charts::{CHARTS, Charts};
use super::light::Light;
use super::tables::{Tables, Texels};
use glam::{DMat3, DVec3};
use octagloss_core::common::error::Result;
use octagloss_core::cpu::box_filter::StackedBox;
use octagloss_core::lobe::Lobe;
use octagloss_core::sphere::grid::Grid;
use std::f64::consts::FRAC_PI_4;
use std::time::Duration;
use std::time::Instant;

/// How several maps answer one query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// One map.
    Only,
    /// The map whose cone points +-X and +-Z are farthest from the direction.
    Farthest,
    /// The mean of all, weighted by the square of 1 - cos of the angle to the nearest cone point.
    Blend,
}

/// A row of the comparison.
#[derive(Clone, Copy, Debug)]
pub struct Subject {
    /// Name on the command line.
    pub name: &'static str,
    /// Name in tables and captions.
    pub title: &'static str,
    /// Boxes of its map.
    pub charts: &'static dyn Charts,
    /// Its answers.
    pub choice: Choice,
    /// Whether the border for boxes counts among its texels.
    pub with_border: bool,
}

const fn subject(
    name: &'static str,
    title: &'static str,
    charts: &'static dyn Charts,
    choice: Choice,
    with_border: bool,
) -> Subject {
    Subject { name, title, charts, choice, with_border }
}

/// All rows.
pub static SUBJECTS: [Subject; 7] = [
    subject("octahedral", "Octahedral", CHARTS[0], Choice::Only, false),
    subject("octahedral-chosen", "Two octahedral, chosen", CHARTS[0], Choice::Farthest, false),
    subject("octahedral-blended", "Two octahedral, blended", CHARTS[0], Choice::Blend, false),
    subject("tennis-ball", "Tennis-ball", CHARTS[1], Choice::Only, false),
    subject("equirect", "Latitude-longitude", CHARTS[2], Choice::Only, false),
    subject("cube", "Cube", CHARTS[3], Choice::Only, false),
    subject("tennis-ball-small", "Tennis-ball with border", CHARTS[1], Choice::Only, true),
];

impl Subject {
    /// Turns the world into the space of each of its maps: two maps are 45 degrees about y apart.
    fn turns(&self) -> Vec<DMat3> {
        match self.choice {
            Choice::Only => vec![DMat3::IDENTITY],
            Choice::Farthest | Choice::Blend => vec![DMat3::IDENTITY, DMat3::from_rotation_y(FRAC_PI_4)],
        }
    }

    /// Its maps' grid with about `texels` texels in all, for boxes of up to `widest` steradians.
    ///
    /// # Errors
    /// As [`Grid::new`], if there are too few.
    pub fn grid(&self, texels: usize, widest: f64) -> Result<Grid> {
        let charts = self.charts;
        let map = charts.named().map();
        let cells = Grid::new(map, 1)?.texel_count() * self.turns().len();
        let mut grid = Grid::new(map, (texels as f64 / cells as f64).sqrt().round() as u32)?;
        let bordered = |grid: &Grid| -> usize {
            let border = charts.border(grid.size(), widest);
            let of = |k| grid.sides(k).map(|side| (side + 2 * border) as usize).iter().product::<usize>();
            (0..map.components()).map(of).sum()
        };
        while self.with_border && bordered(&grid) > texels {
            grid = Grid::new(map, grid.size() - 1)?;
        }
        Ok(grid)
    }
}

/// One map of a [`Carrier`].
#[derive(Debug)]
struct CarriedMap {
    map_from_world: DMat3,
    /// With the border of the widest box.
    bordered: Tables,
    /// Without a border, where that differs.
    inner: Option<Tables>,
}

impl CarriedMap {
    /// Its tables without a border.
    fn inner(&self) -> &Tables {
        self.inner.as_ref().unwrap_or(&self.bordered)
    }
}

/// A [`Subject`] filled with light.
#[derive(Debug)]
pub struct Carrier {
    subject: Subject,
    parts: Vec<CarriedMap>,
    cells: Cells,
    /// Time to resample the light and to scan it.
    pub times: [Duration; 2],
}

impl Carrier {
    /// Fills the maps of `subject`, of `texels` texels in all, for boxes of up to `widest` steradians.
    ///
    /// # Errors
    /// As [`Subject::grid`].
    pub fn new(subject: Subject, texels: usize, widest: f64, light: &Light<'_>) -> Result<Self> {
        let (grid, charts) = (subject.grid(texels, widest)?, subject.charts);
        let border = charts.border(grid.size(), widest);
        let mut times = [Duration::ZERO; 2];
        let mut filled = |border: u32, light: &Light<'_>| {
            let start = Instant::now();
            let texels = Texels::new(charts, grid, border, light);
            let middle = Instant::now();
            let tables = Tables::new(charts, &texels);
            times[0] += middle - start;
            times[1] += middle.elapsed();
            tables
        };
        let parts = subject
            .turns()
            .into_iter()
            .map(|turn| {
                let light = light.turned(turn);
                let bordered = filled(border, &light);
                let inner = (border > 0).then(|| filled(0, &light));
                CarriedMap { map_from_world: turn, bordered, inner }
            })
            .collect();
        Ok(Self { subject, parts, cells: Cells::new(grid), times })
    }

    /// Texels of all its maps, without borders.
    pub fn texels(&self) -> usize {
        self.parts.iter().map(|part| part.bordered.grid.texel_count()).sum()
    }

    /// Bytes of the tables that boxes read, and that adaptive queries read.
    pub fn bytes(&self) -> [usize; 2] {
        let sum =
            |tables: fn(&CarriedMap) -> &Tables| self.parts.iter().map(|part| tables(part).bytes()).sum();
        [sum(|part| &part.bordered), sum(CarriedMap::inner)]
    }

    /// The boxes of `stack` around `direction`.
    pub fn boxes(&self, stack: &[StackedBox], direction: DVec3) -> LobeAnswer {
        self.combined(direction, |part, direction| radiance(&part.bordered, stack, direction))
    }

    /// `lobe` at `alpha` around `direction`, adaptively, to about `error` of the mean.
    pub fn adaptive(&self, lobe: Lobe, alpha: f64, error: f64, direction: DVec3) -> LobeAnswer {
        self.combined(direction, |part, direction| {
            Adaptive::new(part.inner(), &self.cells, lobe, alpha, error).radiance(direction).0
        })
    }

    fn combined(&self, direction: DVec3, answer: impl Fn(&CarriedMap, DVec3) -> LobeAnswer) -> LobeAnswer {
        let locals = self.parts.iter().map(|part| (part, part.map_from_world * direction));
        // 1 - cos of the angle to the nearest cone point.
        let distance = |local: DVec3| 1.0 - local.x.abs().max(local.z.abs());
        match self.subject.choice {
            Choice::Only | Choice::Farthest => {
                let farthest = locals.max_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
                let (part, local) = farthest.expect("a subject has a map");
                answer(part, local)
            }
            Choice::Blend => {
                let (mut radiance, mut reads, mut total) = ([0.0; 3], 0, 0.0);
                for (part, local) in locals {
                    let weight = distance(local).powi(2);
                    let own = answer(part, local);
                    radiance.iter_mut().zip(own.radiance).for_each(|(sum, value)| *sum += weight * value);
                    reads += own.reads;
                    total += weight;
                }
                LobeAnswer { radiance: radiance.map(|channel| channel / total), reads }
            }
        }
    }
}
