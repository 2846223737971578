//! Resamples between any two maps of the sphere by overlaps of their texels.
//!
//! A source texel's corners are mapped to the target's coordinates. The quadrilateral between them is
//! rasterised over the target's texels, which gives the overlap areas, and with the target's density the
//! solid angles. Where the mapping is smooth the corners of a block of texels are interpolated from a few of
//! its points. At kinks, seams and poles a texel is quartered until the mapping is flat or its parts are
//! negligible. Shares are scaled to the source texel's exact solid angle, which conserves energy; a target
//! texel is the mean over its shares, which reproduces constants. The remaining energy error of a channel, a
//! few parts in a million for even light, is corrected where the light is.
//!
//! Where coordinate planes are mirrors of both maps and cut no texel of the source, only the part of the
//! sphere on their positive sides is computed, an eighth at best: a share stands for as many shares as
//! there are images of the part. Each image has its own source texel, and its own sums in the target texel.

mod band;
mod carrier;
mod chart;
mod continuation;
mod mirrors;
mod plane;
mod sums;

use super::light::Light;
use super::overlap::{Share, most_overlaps};
use crate::common::parallel;
use crate::light::environment::Rgb;
use crate::sphere::grid::Grid;
use band::Band;
pub use continuation::Continuation;
use glam::DMat3;
use mirrors::Mirrors;
use std::ops::Range;
use sums::{Sums, Totals};

/// Texels along the edge of a block whose corners are interpolated.
const BLOCK: u32 = 8;

/// Most rows processed as one task.
const BAND: u32 = 16;

/// Most bands processed in parallel before their shares are summed.
const BANDS_AT_ONCE: usize = 16;

/// Shares, by estimate, that are summed together; bounds memory.
const SHARES_AT_ONCE: usize = 1 << 22;

/// The radiance of `light` over every texel of `target`: the mean over the overlaps with the part of the
/// target texel in its domain. Texels outside the domain follow the target's continuation.
///
/// # Panics
/// If the number of the light's texels is not that of its grid.
pub fn resample(light: &Light<'_>, target: &Grid) -> Vec<Rgb> {
    assert_eq!(light.texels.len(), light.grid.texel_count(), "texels of the source");
    let mirrors = if light.world_from_source == DMat3::IDENTITY {
        Mirrors::shared(&light.grid, target)
    } else {
        Mirrors::default()
    };
    let (mut texels, totals) = resample_by(&mirrors, light, target)
        .or_else(|| resample_by(&Mirrors::default(), light, target))
        .expect("without mirrors nothing is cut by them");
    let filled = Continuation::new(light, target).fill(&mut texels);
    totals.plus(&filled).correct(&mut texels);
    texels
}

/// [`resample`] by `mirrors` of both grids, NaN where nothing of the source arrives. `None` if a mirror cuts
/// texels of the source.
fn resample_by(mirrors: &Mirrors, light: &Light<'_>, target: &Grid) -> Option<(Vec<Rgb>, Totals)> {
    let mut sums = Sums::new(mirrors, target);
    let grid = &light.grid;
    let rows: u32 = (0..grid.map().components()).map(|component| grid.sides(component)[1]).sum();
    let overlaps = most_overlaps(grid.texel_count(), target.texel_count());
    let per_row = (overlaps / (rows as usize * mirrors.images())).max(1);
    let most = u32::try_from(SHARES_AT_ONCE / per_row / BANDS_AT_ONCE).unwrap_or(BAND).clamp(1, BAND);
    let bands: Vec<(u32, Range<u32>)> = (0..grid.map().components())
        .flat_map(|component| {
            let rows = grid.sides(component)[1];
            (0..rows).step_by(most as usize).map(move |row| (component, row..(row + most).min(rows)))
        })
        .collect();
    let at_once = (SHARES_AT_ONCE / per_row / most as usize).clamp(1, BANDS_AT_ONCE);
    for some in bands.chunks(at_once) {
        let band = |(component, rows): &(u32, Range<u32>)| {
            Band::of_rows(light, target, *component, rows.clone(), mirrors)
        };
        let bands: Vec<Band> = parallel::map(some, band).into_iter().collect::<Option<_>>()?;
        sums.add(&bands, light.texels)?;
    }
    sums.means()
}

/// The most bytes that [`resample`] takes from `source` to `target`, its result included.
pub(crate) fn most_bytes(source: &Grid, target: &Grid) -> u64 {
    // Shares that are summed together, in vectors that grow by doubling; at least those of a row.
    let rows: u32 = (0..source.map().components()).map(|component| source.sides(component)[1]).sum();
    let overlaps = most_overlaps(source.texel_count(), target.texel_count());
    let shares = (2 * SHARES_AT_ONCE).max(overlaps / rows as usize);
    let texels = target.texel_count();
    (texels * (sums::MAX_BYTES + size_of::<Rgb>()) + 2 * size_of::<Share>() * shares) as u64
}
