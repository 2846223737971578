//! Computes the peak memory of a bake, a query or a bench before any of it is allocated.
//!
//! The figures follow from the types and were checked against the resident size of the program: a level of a
//! KTX2 file took 20 to 23 bytes per texel.

use super::job::Job;
use super::level::LevelJob;
use super::settings::BakeSettings;
use super::solve::solve_bytes;
use crate::common::error::{Error, Result};
use crate::cpu::reflector::ReflectorSettings;
pub(crate) use crate::cpu::table_bytes::LIMIT;
use crate::cpu::table_bytes::{LobeRequest, SOURCE, Tables, at_most, largest_oem, largest_that};
use crate::geometry::conversion::Source;
use crate::light::environment::{Environment, Layout};
use crate::lobe::Lobe;
use crate::lobe::filter::Filter;
use crate::sphere::grid::Grid;
use crate::sphere::registry::NamedMap;

/// Bytes per texel of a finished level: radiance and bound.
const TEXEL: u64 = 16;
/// Bytes per texel of a picture of floats.
const PIXEL: u64 = 12;
/// Bytes per texel of the level in progress: answer, radiance and bound.
const TEXEL_MAKING: u64 = 44;

/// Checks that baking `environment` with all of `settings` together takes at most [`LIMIT`]. `encoded` is the
/// bytes per texel of an output that is encoded as a whole, or 0.
///
/// # Errors
/// [`Error::Limit`], which names the largest size that fits; [`Error::Parameter`] as in
/// [`crate::bake::bake_all`].
pub(crate) fn check_bake(environment: &Environment, settings: &[BakeSettings], encoded: u64) -> Result<()> {
    check_bake_within(environment, settings, encoded, LIMIT)
}

/// Checks that a query of one lobe takes at most [`LIMIT`].
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
    settings.check_memory("this query", layout, &[LobeRequest { lobe, roughness, filter }], LIMIT)
}

/// Checks that `what`, with `bytes_a_texel` per texel of a square of `size` texels along an edge, takes at
/// most [`LIMIT`]; `option` sets the size.
///
/// # Errors
/// [`Error::Limit`], which names the largest size that fits.
pub fn check_square(what: &str, option: &str, size: u32, bytes_a_texel: u64) -> Result<()> {
    let bytes = |size: u32| u64::from(size) * u64::from(size) * bytes_a_texel;
    if bytes(size) <= LIMIT {
        return Ok(());
    }
    let remedy = at_most(option, largest_that(1, size, |size| bytes(size) <= LIMIT));
    Err(Error::Limit { what: what.to_owned(), needed: bytes(size), available: LIMIT, remedy })
}

/// Checks that converting `source` to a picture of `map` of `size` with `border` takes at most [`LIMIT`].
///
/// # Errors
/// [`Error::Limit`], which names the largest size that fits; [`Error::Parameter`] as in [`Grid::new`].
pub fn check_conversion(source: &Source, map: &NamedMap, size: u32, border: u32) -> Result<()> {
    let needed = conversion_bytes(source, map, size, border)?;
    if needed <= LIMIT {
        return Ok(());
    }
    // Maps of odd size have fewer mirrors, and take more.
    let fits = |size: u32| {
        let even = (size / 2 * 2).max(1);
        conversion_bytes(source, map, even, border.min(even)).is_ok_and(|needed| needed <= LIMIT)
    };
    let remedy = at_most("`size`", largest_that(1, size, fits));
    Err(Error::Limit { what: "this conversion".to_owned(), needed, available: LIMIT, remedy })
}

/// Peak bytes of a conversion.
fn conversion_bytes(source: &Source, map: &NamedMap, size: u32, border: u32) -> Result<u64> {
    let grid = Grid::new(map.map, size)?;
    let picture: u64 = grid.picture_sides(border).map(u64::from).iter().product();
    let drawing = PIXEL * (grid.texel_count() as u64 + picture);
    // A file that does not compress is as large as the picture.
    let encoding = 2 * PIXEL * picture;
    let light = source.grid().texel_count() as u64 * SOURCE;
    Ok((light + source.most_bytes(map, &grid).max(drawing)).max(encoding))
}

/// Edge of a cube beside a chain.
type Edge = fn(&mut BakeSettings) -> &mut Option<u32>;

fn check_bake_within(
    environment: &Environment,
    settings: &[BakeSettings],
    encoded: u64,
    limit: u64,
) -> Result<()> {
    let bytes = |change: &dyn Fn(&mut BakeSettings)| {
        let mut settings = settings.to_vec();
        settings.iter_mut().for_each(change);
        bake_bytes(environment, &settings, encoded)
    };
    let needed = match bytes(&|_| ()) {
        Ok(needed) if needed <= limit => return Ok(()),
        // An OEM beyond 32-bit indices.
        Ok(needed) | Err(Error::Limit { needed, .. }) => needed,
        Err(other) => return Err(other),
    };
    let fits = |change: &dyn Fn(&mut BakeSettings)| bytes(change).is_ok_and(|bytes| bytes <= limit);
    let shrink = |settings: &mut BakeSettings, size: u32| {
        settings.size = settings.size.min(size);
        settings.levels = settings.levels.map(|l| l.min(settings.map.most_levels(settings.size)));
    };
    let narrow = |settings: &mut BakeSettings, border: u32| {
        settings.border = settings.border.map(|own| own.min(border));
    };
    let largest = settings.iter().map(|settings| settings.size).max().unwrap_or(1);
    let border = settings.iter().filter_map(|settings| settings.border).max().unwrap_or(0);
    // Cubes beside the chain: each by itself may be too large.
    let cubes: [(&str, Edge); 2] = [
        ("`skybox`", |settings| &mut settings.skybox),
        ("`irradiance`", |settings| &mut settings.irradiance),
    ];
    for (name, edge) in cubes {
        let asked = settings.to_vec().iter_mut().filter_map(|settings| *edge(settings)).max();
        let lower = |settings: &mut BakeSettings, size: u32| {
            let edge = edge(settings);
            *edge = edge.map(|own| own.min(size));
        };
        if let Some(asked) = asked
            && let Some(size) = largest_that(1, asked, |size| fits(&|settings| lower(settings, size)))
        {
            return Err(Error::Limit {
                what: "this bake".to_owned(),
                needed,
                available: limit,
                remedy: at_most(name, Some(size)),
            });
        }
    }
    // If the bake does not fit even with the smallest levels, the OEM and its tables, or the source, are too
    // large.
    let remedy = if fits(&|settings| shrink(settings, 1)) {
        at_most("`size`", largest_that(1, largest, |size| fits(&|settings| shrink(settings, size))))
    } else {
        let narrowed = largest_that(0, border, |border| {
            fits(&|settings| {
                shrink(settings, 1);
                narrow(settings, border);
            })
        });
        let pyramid = settings.iter().any(|settings| settings.filter == Filter::Pyramid);
        let oem = |size: u32| {
            fits(&|settings| {
                shrink(settings, 1);
                settings.oem_size = Some(size);
            })
        };
        match narrowed {
            Some(border) => at_most("`border`", Some(border)),
            None => at_most("`oem_size`", largest_oem(pyramid, oem)),
        }
    };
    Err(Error::Limit { what: "this bake".to_owned(), needed, available: limit, remedy })
}

/// Peak bytes of a bake.
fn bake_bytes(environment: &Environment, settings: &[BakeSettings], encoded: u64) -> Result<u64> {
    let job = Job::new(environment, settings)?;
    let reflector = job.reflector_settings();
    let (size, block) = reflector.plan(environment.layout())?;
    let parts = job.levels();
    let served = |part: &LevelJob| LobeRequest {
        lobe: part.lobe,
        roughness: part.spec.roughness,
        filter: part.filter,
    };
    let served: Vec<_> = parts.iter().map(served).collect();
    let tables = Tables::new(environment.layout(), size, block, reflector.scan, &served);
    let (mut levels, mut baking, mut largest) = (0, 0, 0);
    for part in parts {
        let texels = part.spec.layout.texel_count() as u64;
        let each = if part.is_mirror() { TEXEL } else { TEXEL_MAKING };
        baking = baking.max(levels + texels * each);
        levels += texels * TEXEL;
        largest = largest.max(texels);
    }
    // Chains are solved one after the other, once all levels are baked.
    let solving = settings.iter().map(|settings| {
        let nodes = settings.level_specs().map_or_else(|_| Vec::new(), |specs| settings.nodes(specs.len()));
        if nodes.is_empty() { 0 } else { solve_bytes(settings.size, &nodes) }
    });
    let solving = levels + solving.max().unwrap_or(0);
    // The tables are freed before a file is encoded. Encoding holds its largest level and the file.
    let encoding = levels + encoded * (largest + levels / TEXEL);
    let peak = tables.making.max(tables.resident + baking.max(solving)).max(encoding);
    Ok(environment.layout().texel_count() as u64 * SOURCE + peak)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::registry::MAPS;

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
        for filter in [Filter::Adaptive(0.005), Filter::Box] {
            let settings = BakeSettings { filter, oem_size: Some(16_384), border: Some(0), ..small.clone() };
            let words = remedy(check_bake(&environment, std::slice::from_ref(&settings), 8));
            let size: u32 = words.split(' ').nth(1).and_then(|word| word.parse().ok()).expect("a size");
            assert!(words.starts_with("`oem_size` "), "{words}");
            check_bake(&environment, &[BakeSettings { oem_size: Some(size), ..settings }], 8).expect("fits");
        }
    }

    #[test]
    fn a_skybox_that_is_too_large_is_named() {
        let environment = environment();
        let settings = BakeSettings { size: 64, skybox: Some(16_384), ..BakeSettings::default() };
        let words = remedy(check_bake(&environment, std::slice::from_ref(&settings), 8));
        let size: u32 = words.split(' ').nth(1).and_then(|word| word.parse().ok()).expect("a size");
        assert!(words.starts_with("`skybox` "), "{words}");
        check_bake(&environment, &[BakeSettings { skybox: Some(size), ..settings }], 8).expect("it fits");
        // With a small skybox, the size is to blame.
        let settings = BakeSettings { size: 16_384, skybox: Some(4), ..BakeSettings::default() };
        assert!(remedy(check_bake(&environment, &[settings], 8)).starts_with("`size` "));
    }

    #[test]
    fn a_border_that_is_too_wide_is_named() {
        let environment = environment();
        for (border, filter) in [(5500, Filter::Box), (9000, Filter::Adaptive(0.005)), (16_384, Filter::Box)]
        {
            let settings = BakeSettings { size: 64, border: Some(border), filter, ..BakeSettings::default() };
            let words = remedy(check_bake(&environment, std::slice::from_ref(&settings), 8));
            let largest = words.strip_prefix("`border` ").and_then(|rest| rest.split(' ').next());
            let largest: u32 = largest.and_then(|word| word.parse().ok()).expect("a border");
            check_bake(&environment, &[BakeSettings { border: Some(largest), ..settings.clone() }], 8)
                .expect("the border named fits");
            let query = ReflectorSettings { border: Some(border), ..ReflectorSettings::default() };
            let words = remedy(check_query(environment.layout(), &query, Lobe::Ggx, 0.5, filter));
            assert!(words.starts_with("`border` "), "{words}");
        }
        // The border fits with a smaller map.
        let settings = BakeSettings { oem_size: Some(16_384), border: Some(8), ..BakeSettings::default() };
        assert!(remedy(check_bake(&environment, &[settings], 8)).starts_with("`oem_size` "));
    }

    #[test]
    fn squares_are_refused_with_the_largest_that_fits() {
        check_square("this", "`size`", 4096, 256).expect("4 GiB");
        let words = remedy(check_square("this", "`size`", 4097, 256));
        assert_eq!(words, "`size` 4096 is the largest that fits");
    }

    #[test]
    fn conversions_are_refused_with_the_largest_size_that_fits() {
        let source = Source::from_environment(environment()).expect("2:1");
        for map in &MAPS {
            for border in [0, 16] {
                let check = |size| check_conversion(&source, map, size, border);
                check(256).expect("a small map");
                let words = remedy(check(16_384));
                let size: u32 = words.split(' ').nth(1).and_then(|word| word.parse().ok()).expect("a size");
                check(size).expect("the size named fits");
                assert_eq!(remedy(check(size + 64)), words, "and none above");
            }
        }
    }

    #[test]
    fn queries_and_sources_count() {
        let layout = environment().layout();
        let settings = ReflectorSettings { oem_size: Some(8192), ..ReflectorSettings::default() };
        let query = |settings: &ReflectorSettings, r| {
            check_query(layout, settings, Lobe::Ggx, r, Filter::Adaptive(0.01))
        };
        assert!(remedy(query(&settings, 0.005)).starts_with("`oem_size` "), "cells of one texel of the map");
        query(&settings, 0.05).expect("cells of the source's texels");
        query(&ReflectorSettings { sharpest: 0.5, ..settings }, 0.5).expect("coarse cells");
        let served = LobeRequest { lobe: Lobe::Ggx, roughness: 0.5, filter: Filter::Box };
        let few = ReflectorSettings::default().check_memory("this query", layout, &[served], 100);
        assert_eq!(remedy(few), "scale the source down first");
    }
}
