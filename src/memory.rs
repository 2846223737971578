//! Memory that a bake or a query takes at its peak, computed before any of it is allocated.
//!
//! The figures are those of the types, and were held to the resident size of the program: an OEM of 8192
//! texels took 28.4 bytes a texel, a box filter's table 47, fitted tables 64, cells of one texel 161 by one
//! reconstruction and 246 by both, a level of a KTX2 file 20 to 23.

use crate::bake::job::Job;
use crate::bake::level::LevelJob;
use crate::bake::settings::BakeSettings;
use crate::environment::{Environment, Layout};
use crate::error::{Error, Result};
use crate::filter::Filter;
use crate::lobe::Lobe;
use crate::oem::{OemSize, bilinear_share};
use crate::reflector::ReflectorSettings;

/// The most bytes that a bake or a query may take: 4 GiB.
pub const LIMIT: u64 = 4 << 30;

/// Bytes of a source's texel.
const SOURCE: u64 = 12;
/// Bytes of an OEM's texel while it is made: its mean radiance, itself, and a quarter of a solid angle.
const OEM_MAKING: u64 = 12 + 16 + 1;
/// Bytes of an OEM's texel.
const OEM: u64 = 16;
/// Bytes of an entry of an exact table.
const TABLE: u64 = 32;
/// Bytes of a finest cell: its share of all quads, and its energy.
const CELL: u64 = 75 + 12;
/// Bytes of a finest cell while the tree is made: itself and its share of the next level.
const CELL_MAKING: u64 = 70;
/// Bytes of a texel of a finished level: radiance and bound.
const TEXEL: u64 = 16;
/// Bytes of a texel of the level that is baked: its answer, radiance and bound.
const TEXEL_MAKING: u64 = 44;

/// One lobe to be served.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Served {
    pub(crate) lobe: Lobe,
    pub(crate) roughness: f64,
    pub(crate) filter: Filter,
}

/// Fails where baking `environment` by all of `settings` at once would take more than [`LIMIT`]. `encoded` is
/// the bytes that a texel takes in an output that is encoded as a whole, 0 where none is.
///
/// # Errors
/// [`Error::Limit`], which names the largest size that fits; [`Error::Parameter`] as
/// [`crate::bake::bake_all`].
pub fn check_bake(environment: &Environment, settings: &[BakeSettings], encoded: u64) -> Result<()> {
    check_bake_within(environment, settings, encoded, LIMIT)
}

/// Fails where a query of one lobe would take more than [`LIMIT`].
///
/// # Errors
/// [`Error::Limit`], which names the largest size that fits; [`Error::Parameter`] for an OEM of no texels.
pub fn check_query(
    layout: Layout,
    settings: &ReflectorSettings,
    lobe: Lobe,
    roughness: f64,
    filter: Filter,
) -> Result<()> {
    check_query_within(layout, settings, Served { lobe, roughness, filter }, LIMIT)
}

fn check_bake_within(
    environment: &Environment,
    settings: &[BakeSettings],
    encoded: u64,
    limit: u64,
) -> Result<()> {
    let sized = |size: Option<u32>, oem_size: Option<u32>| {
        let mut settings = settings.to_vec();
        for settings in &mut settings {
            if let Some(size) = size {
                settings.size = settings.size.min(size);
                settings.levels = settings.levels.map(|l| l.min(settings.map.most_levels(settings.size)));
            }
            settings.oem_size = oem_size.or(settings.oem_size);
        }
        bake_bytes(environment, &settings, encoded)
    };
    let needed = bake_bytes(environment, settings, encoded)?;
    if needed <= limit {
        return Ok(());
    }
    let fits = |bytes: Result<u64>| bytes.is_ok_and(|bytes| bytes <= limit);
    let largest = settings.iter().map(|settings| settings.size).max().unwrap_or(1);
    // Without its levels, the OEM and its tables are what is too large, or the source itself.
    let remedy = if fits(sized(Some(1), None)) {
        at_most("`size`", largest_that(largest, |size| fits(sized(Some(size), None))))
    } else {
        let fitted = settings.iter().any(|settings| matches!(settings.filter, Filter::Fitted(_)));
        at_most("`oem_size`", largest_oem(fitted, |size| fits(sized(Some(1), Some(size)))))
    };
    Err(Error::Limit { what: "this bake".to_owned(), needed, available: limit, remedy })
}

fn check_query_within(
    layout: Layout,
    settings: &ReflectorSettings,
    served: Served,
    limit: u64,
) -> Result<()> {
    let bytes = |oem_size: Option<u32>| {
        let settings = ReflectorSettings { oem_size: oem_size.or(settings.oem_size), ..*settings };
        let (size, block) = settings.plan(layout)?;
        Ok(layout.texel_count() as u64 * SOURCE + Tables::of(size, block, &[served]).peak())
    };
    let needed = bytes(None)?;
    if needed <= limit {
        return Ok(());
    }
    let fits = |size| bytes(Some(size)).is_ok_and(|bytes: u64| bytes <= limit);
    let remedy = at_most("`oem_size`", largest_oem(settings.fitted, fits));
    Err(Error::Limit { what: "this query".to_owned(), needed, available: limit, remedy })
}

/// Bytes at the peak of a bake.
fn bake_bytes(environment: &Environment, settings: &[BakeSettings], encoded: u64) -> Result<u64> {
    let job = Job::new(environment, settings)?;
    let (size, block) = job.reflector_settings().plan(environment.layout())?;
    let parts = job.levels();
    let served =
        |part: &LevelJob| Served { lobe: part.lobe, roughness: part.spec.roughness, filter: part.filter };
    let tables = Tables::of(size, block, &parts.iter().map(served).collect::<Vec<_>>());
    let (mut levels, mut baking, mut largest) = (0, 0, 0);
    for part in parts {
        let texels = part.spec.layout.texel_count() as u64;
        let each = if part.is_mirror() { TEXEL } else { TEXEL_MAKING };
        baking = baking.max(levels + texels * each);
        levels += texels * TEXEL;
        largest = largest.max(texels);
    }
    // The tables are gone when a file is encoded: its largest level, and the file.
    let encoding = levels + encoded * (largest + levels / TEXEL);
    let peak = tables.making.max(tables.resident + baking).max(encoding);
    Ok(environment.layout().texel_count() as u64 * SOURCE + peak)
}

/// Bytes of an OEM and of what lobes are read from.
struct Tables {
    /// While the OEM is made.
    making: u64,
    /// With all tables.
    resident: u64,
}

impl Tables {
    fn of(size: OemSize, block: u32, served: &[Served]) -> Self {
        let square = |side: u32| u64::from(side) * u64::from(side);
        let (inner, bordered) = (square(size.inner), square(size.bordered()));
        let border = if size.border > 0 { OEM * bordered } else { 0 };
        let (mut bilinear, mut constant, mut boxes, mut fitted) = (false, false, false, false);
        for &Served { lobe, roughness, filter } in served {
            match filter {
                Filter::Adaptive(_) if lobe.has_mirror() && roughness == 0.0 => {}
                Filter::Adaptive(_) => {
                    let share = bilinear_share(lobe, roughness * roughness, size.inner);
                    bilinear |= share > 0.0;
                    constant |= share < 1.0;
                }
                Filter::Fitted(_) => fitted = true,
                Filter::Box => boxes = true,
                Filter::Reference => {}
            }
        }
        let trees = u64::from(bilinear) + u64::from(constant);
        let cells = square(size.inner.div_ceil(block.max(1)));
        let resident = OEM * bordered
            + cells * (CELL * trees + CELL_MAKING * trees.min(1))
            + if boxes { TABLE * bordered } else { 0 }
            // The map without its emitters, its table, and blurred tables, which are coarse.
            + if fitted { (OEM + TABLE + 4) * bordered } else { 0 };
        Self { making: OEM_MAKING * inner + border, resident }
    }

    fn peak(&self) -> u64 {
        self.making.max(self.resident)
    }
}

/// The largest size of at most `most` that fits, by bisection; round where it is not small.
fn largest_that(most: u32, fits: impl Fn(u32) -> bool) -> Option<u32> {
    if !fits(1) {
        return None;
    }
    let (mut low, mut high) = (1, most);
    while low < high {
        let middle = low + (high - low).div_ceil(2);
        if fits(middle) { low = middle } else { high = middle - 1 }
    }
    Some(if low >= 64 { low / 64 * 64 } else { low })
}

/// The largest OEM that fits; a power of two for fitted lobes.
fn largest_oem(fitted: bool, fits: impl Fn(u32) -> bool) -> Option<u32> {
    if fitted {
        return (4..=14).rev().map(|log2| 1 << log2).find(|size| fits(*size));
    }
    largest_that(16_384, fits)
}

fn at_most(option: &str, size: Option<u32>) -> String {
    size.map_or_else(
        || "scale the source down first".to_owned(),
        |size| format!("{option} {size} is the largest that fits"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn environment() -> Environment {
        Environment::new(Layout::Panorama { width: 8, height: 4 }, vec![[1.0; 3]; 32]).expect("32 texels")
    }

    fn remedy(outcome: Result<()>) -> String {
        match outcome {
            Err(Error::Limit { remedy, .. }) => remedy,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn what_is_too_large_is_refused_with_the_largest_size_that_fits() {
        let environment = environment();
        let small = BakeSettings { size: 64, ..BakeSettings::default() };
        check_bake(&environment, std::slice::from_ref(&small), 8).expect("64 texels a side");
        let wide = BakeSettings { size: 16_384, ..small.clone() };
        let too_large = remedy(check_bake(&environment, &[small.clone(), wide.clone()], 8));
        let size: u32 = too_large.split(' ').nth(1).and_then(|word| word.parse().ok()).expect("a size");
        assert!((2048..8192).contains(&size) && too_large.starts_with("`size` "), "{too_large}");
        check_bake(&environment, &[BakeSettings { size, ..wide.clone() }], 8).expect("the size named fits");
        let more = BakeSettings { size: size + 64, ..wide };
        assert_eq!(remedy(check_bake(&environment, &[more], 8)), too_large, "and none above");
        for filter in [Filter::Adaptive(0.005), Filter::Box, Filter::Fitted(4)] {
            let settings = BakeSettings { filter, oem_size: Some(16_384), border: Some(0), ..small.clone() };
            let words = remedy(check_bake(&environment, std::slice::from_ref(&settings), 8));
            let size: u32 = words.split(' ').nth(1).and_then(|word| word.parse().ok()).expect("a size");
            assert!(words.starts_with("`oem_size` "), "{words}");
            check_bake(&environment, &[BakeSettings { oem_size: Some(size), ..settings }], 8).expect("fits");
        }
    }

    #[test]
    fn queries_and_sources_count() {
        let layout = environment().layout();
        let settings = ReflectorSettings { oem_size: Some(8192), ..ReflectorSettings::default() };
        let query = |settings: &ReflectorSettings, r| {
            check_query(layout, settings, Lobe::Ggx, r, Filter::Adaptive(0.01))
        };
        assert!(remedy(query(&settings, 0.05)).starts_with("`oem_size` "), "cells of one texel");
        query(&ReflectorSettings { sharpest: 0.5, ..settings }, 0.5).expect("coarse cells");
        let served = Served { lobe: Lobe::Ggx, roughness: 0.5, filter: Filter::Box };
        let few = check_query_within(layout, &ReflectorSettings::default(), served, 100);
        assert_eq!(remedy(few), "scale the source down first");
    }
}
