//! Bakes one level. Tiles of neighbouring texels share their tree walks.

use crate::common::error::{Error, Result};
use crate::common::names::named;
use crate::common::parallel;
use crate::cpu::reflector::{Reflector, Workspace};
use crate::geometry::footprints::footprints_over;
use crate::geometry::tiling::{Tile, Tiling};
use crate::light::chain::LevelSpec;
use crate::light::environment::{Layout, Rgb, first_wrong};
use crate::lobe::Lobe;
use crate::lobe::filter::{Answer, Bound, Filter};
use crate::sphere::cube::Face;
use std::mem::take;

/// Engine that computed a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Processor {
    /// The CPU, including levels that the GPU engine delegates to it.
    Cpu,
    /// The GPU.
    Gpu,
}

named!(Processor { Cpu = "cpu", Gpu = "gpu" });

/// A level to bake, possibly shared by several bakes.
#[derive(Clone, Copy, PartialEq)]
pub struct LevelJob {
    /// Its layout and roughness.
    pub spec: LevelSpec,
    /// Its lobe.
    pub lobe: Lobe,
    /// How the lobe is evaluated.
    pub filter: Filter,
    /// Whether texels may be interpolated, where that is as good; those of sheen then have no bounds.
    pub(crate) sparse: bool,
}

impl LevelJob {
    /// Whether the level is a mirror: the mean radiance over each texel.
    pub fn is_mirror(&self) -> bool {
        self.spec.roughness == 0.0 && self.lobe.has_mirror()
    }
}

/// Called with the number of texels done since the last call, from any thread; an error stops the bake.
pub type Advance<'a> = &'a (dyn Fn(u64) -> Result<()> + Sync);

/// Called when part `part` of `parts` is done, from any thread; an error stops the bake.
pub type Part<'a> = &'a (dyn Fn(u64, u64) -> Result<()> + Sync);

/// A baked level.
pub struct BakedLevel {
    /// The engine that computed it.
    pub processor: Processor,
    /// Its texels, in the order of the layout.
    pub texels: Vec<Rgb>,
    /// Certified bounds of the luminance.
    pub bounds: Option<Vec<f32>>,
    /// The greatest certified bound of each channel.
    pub channel_bounds: Option<Rgb>,
    /// Average quadrature leaves per texel; `None` if the filter has none.
    pub leaves_per_texel: Option<f64>,
}

/// Counts of quadrature leaves, packets and directions of a level.
#[derive(Default)]
pub struct LeafCounts {
    /// Leaves of all packets.
    pub leaves: u64,
    /// Packets of directions.
    pub packets: u64,
    /// Directions of all packets.
    pub directions: u64,
}

impl LeafCounts {
    /// Takes those of `workspace`, which starts anew.
    pub(super) fn take(workspace: &mut Workspace) -> Self {
        let Workspace { leaves, packets, directions, .. } = workspace;
        Self { leaves: take(leaves), packets: take(packets), directions: take(directions) }
    }

    /// Adds `counts`.
    pub(super) const fn add(&mut self, counts: &Self) {
        self.leaves += counts.leaves;
        self.packets += counts.packets;
        self.directions += counts.directions;
    }
}

/// Bakes `level`; calls `advance` with the number of texels done, from any thread.
pub(super) fn bake_texels(
    reflector: &Reflector<'_>,
    level: &LevelJob,
    advance: Advance<'_>,
) -> Result<BakedLevel> {
    let LevelJob { spec, lobe, filter, .. } = *level;
    if level.is_mirror() {
        // A mirror level is the mean radiance over each texel.
        let texels = footprints_over(reflector.environment(), spec.layout)?;
        advance(texels.len() as u64)?;
        return Ok(BakedLevel::unbounded(texels));
    }
    let lobes = reflector.lobes(lobe, spec.roughness, filter)?;
    let tiling = Tiling::new(reflector.size().inner, spec, lobe);
    let start = || (Tile::default(), Workspace::default(), Vec::new());
    let rows = parallel::try_map_with(0..tiling.rows(), start, |(tile, workspace, answers), row| {
        let mut line = tiling.line(row);
        tiling.for_each_tile(row, tile, |tile| {
            lobes.evaluate_tile(tile, workspace, answers, &mut line);
        });
        advance(line.len() as u64)?;
        Ok((line, LeafCounts::take(workspace)))
    })?;
    let mut work = LeafCounts::default();
    rows.iter().for_each(|(_, counts)| work.add(counts));
    Ok(BakedLevel::new(Processor::Cpu, rows.into_iter().flat_map(|(line, _)| line), work))
}

impl BakedLevel {
    /// Creates a level of the CPU engine without bounds.
    pub const fn unbounded(texels: Vec<Rgb>) -> Self {
        Self { processor: Processor::Cpu, texels, bounds: None, channel_bounds: None, leaves_per_texel: None }
    }

    /// Checks that radiance and bounds are finite and non-negative.
    ///
    /// # Errors
    /// [`Error::NonFiniteResult`] naming the first texel that is NaN, infinite or negative.
    pub(crate) fn check(&self, level: &LevelJob) -> Result<()> {
        let fault = |at: usize, what: &str, value: f32| {
            let (columns, rows) = level.spec.layout.sides();
            let area = columns as usize * rows as usize;
            let (image, inside) = (at / area, at % area);
            let face = match level.spec.layout {
                Layout::Cube { .. } => format!("face {} ", Face::ALL[image].short_name()),
                Layout::Panorama { .. } | Layout::Octahedral { .. } => String::new(),
            };
            let (x, y) = (inside % columns as usize, inside / columns as usize);
            let (lobe, roughness) = (level.lobe.name(), level.spec.roughness);
            let place = format!(
                "{what} of the level of {columns} x {rows} ({lobe}, roughness {roughness}) {face}pixel \
                 ({x}, {y})"
            );
            Err(Error::NonFiniteResult { place, value: f64::from(value) })
        };
        if let Some(at) = first_wrong(self.texels.as_flattened()) {
            return fault(at / 3, "radiance", self.texels.as_flattened()[at]);
        }
        let bounds = self.bounds.as_deref().unwrap_or_default();
        if let Some(at) = first_wrong(bounds) {
            return fault(at, "error bound", bounds[at]);
        }
        let greatest = self.channel_bounds.unwrap_or_default();
        match first_wrong(&greatest) {
            Some(c) => fault(0, "a channel's greatest error bound, from", greatest[c]),
            None => Ok(()),
        }
    }

    /// Creates a level from `answers`, one a texel.
    pub fn new(processor: Processor, answers: impl Iterator<Item = Answer>, work: LeafCounts) -> Self {
        let mut greatest: Option<Bound> = None;
        let (mut texels, mut bounds) = (Vec::new(), Vec::new());
        for Answer { radiance, bound } in answers {
            greatest = bound.map(|bound| greatest.map_or(bound, |most| most.max(bound)));
            texels.push(radiance);
            bounds.extend(bound.map(|bound| bound.luminance));
        }
        // Every direction of a packet sums all leaves of the packet.
        let LeafCounts { leaves, packets, directions } = work;
        let per_texel = leaves as f64 / packets as f64 * directions as f64 / texels.len() as f64;
        Self {
            processor,
            texels,
            bounds: greatest.is_some().then_some(bounds),
            channel_bounds: greatest.map(|bound| bound.channels),
            leaves_per_texel: (packets > 0).then_some(per_texel),
        }
    }
}
