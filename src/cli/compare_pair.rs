//! `octagloss compare A B SOURCE`: two bakes side by side, each against the source.

use super::args::CompareArgs;
use super::compare_sources::{PreparedSource, Sources};
use super::comparison::bake_in;
use super::console::Console;
use super::input::{file_name, single_source};
use super::look_ups::{self, Delivered, Overlay};
use super::measures::Measures;
use super::outcome::{Outcome, print, print_json, refuse_given, usage};
use crate::files::Existing;
use crate::recipes::InputOptions;
use crate::{Chain, Ladder};
use glam::DVec3;
use octagloss_core::common::parallel;
use octagloss_core::files::image::side_by_side::{Column, directions, side_by_side};
use octagloss_core::files::io::LoadedChain;
use octagloss_core::files::io::ldr::write_png;
use octagloss_core::light::chain_lookup::ChainLookup;
use serde_json::json;
use std::path::PathBuf;
use std::rc::Rc;

/// Roughnesses of a picture unless the levels of both bakes agree.
const ROUGHNESSES: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

/// Most columns of levels' own roughnesses.
const MAX_COLUMNS: usize = 4;

/// A bake and its source.
struct Side {
    name: String,
    chain: Chain,
    ladder: Ladder,
    source: Rc<PreparedSource>,
    delivered: Delivered,
}

/// Measures the look-ups of both bakes, and draws them.
pub(super) fn run(args: &CompareArgs, existing: Existing, console: &Console) -> Outcome {
    let [other, source] = &args.against[..] else {
        return usage(format!(
            "{} is one bake, and {} files follow; name its source, or another bake and the source",
            args.bake.display(),
            args.against.len()
        ));
    };
    let options = [
        (args.fail_above.is_some() || args.from.is_some(), "--fail-above"),
        (args.chart.is_some(), "--chart"),
        (!args.overlay.is_empty(), "--overlay"),
        (args.texels.is_some(), "--texels"),
    ];
    refuse_given(&options, |option| {
        format!("compare A B SOURCE shows look-ups of two bakes; {option} is for one bake")
    })?;
    let files = single_source(vec![source.clone()], &args.input)?;
    let sources = Sources::new(files, &args.input, args.lobe, console);
    let loaded = [bake_in(&args.bake, console)?, bake_in(other, console)?];
    let asked = args.delivered.clone().filter(|asked| !asked.is_empty());
    let columns = asked.unwrap_or_else(|| roughnesses(&loaded));
    let measures = Measures { delivered: Some(columns.clone()), ..Measures::default() };
    let [a, b] = loaded;
    let side = |path: &PathBuf, bake: LoadedChain| -> Outcome<Side> {
        let (lobe, source) = sources.lobe_and_source(path, &bake.provenance)?;
        let delivered = look_ups::measure(&measures, path, &bake, lobe, &source, console)?;
        let ladder = look_ups::ladder(path, &bake)?;
        Ok(Side { name: path.display().to_string(), chain: bake.chain, ladder, source, delivered })
    };
    let sides = [side(&args.bake, a)?, side(other, b)?];
    let unturned = |side: &Side| InputOptions { rotate_y: None, mirror: false, ..side.source.input.clone() };
    if unturned(&sides[0]) != unturned(&sides[1]) {
        return usage(format!(
            "{} and {} are bakes of different light (scale, crop, padding or a removed sun); bake both alike",
            sides[0].name, sides[1].name
        ));
    }
    if let Some(path) = &args.picture {
        let names = [&sides[0].name[..], &sides[1].name];
        let against = file_name(source);
        let drawn = drawn(&sides, &columns)?;
        write_png(path, existing, &side_by_side(names, &against, &drawn).picture())?;
    }
    let bakes = sides.map(|Side { name, delivered, .. }| Overlay { bake: name, delivered });
    if args.json {
        return print_json(&json!({ "against": source.display().to_string(), "bakes": bakes }));
    }
    print(&bakes.iter().map(|Overlay { bake, delivered }| delivered.text(bake)).collect::<String>())
}

/// Roughnesses to show: those of the rough levels if both bakes have the same, thinned out.
fn roughnesses(bakes: &[LoadedChain; 2]) -> Vec<f64> {
    let of = |bake: &LoadedChain| -> Vec<f64> {
        bake.chain.levels.iter().map(|level| level.roughness).filter(|r| *r > 0.0).collect()
    };
    let (own, other) = (of(&bakes[0]), of(&bakes[1]));
    let is_same = own.len() == other.len() && own.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-4);
    if !is_same || own.is_empty() {
        return ROUGHNESSES.to_vec();
    }
    let count = own.len().min(MAX_COLUMNS);
    (1..=count).map(|k| own[k * own.len() / count - 1]).collect()
}

/// The columns of the picture at `roughnesses`.
fn drawn(sides: &[Side; 2], roughnesses: &[f64]) -> crate::Result<Vec<Column>> {
    // Turns can differ: directions are those of the source as it was read.
    let world_from_source = |side: &Side| side.source.environment.source_from_world().transpose();
    let sun = sides[0].source.sun.map(|sun| sides[0].source.environment.source_from_world() * sun);
    let directions = directions(sun);
    let seen: [Vec<DVec3>; 2] = [0, 1].map(|k| {
        let turn = world_from_source(&sides[k]);
        directions.iter().map(|direction| turn * *direction).collect()
    });
    let sharpest = roughnesses.iter().copied().filter(|r| *r > 0.0).fold(1.0, f64::min);
    let lobes = sides[0].source.lobes(sharpest)?;
    let column = |(k, roughness): (usize, &f64)| {
        let read = |side: usize| -> Vec<[f64; 3]> {
            let Side { chain, ladder, .. } = &sides[side];
            let lookup = ChainLookup::new(&chain.levels);
            let lod = ladder.lod(*roughness, chain.levels.len() as u32, chain.levels[0].size());
            parallel::values(seen[side].len(), |k| lookup.read(seen[side][k], lod))
        };
        Ok(Column {
            roughness: *roughness,
            reference: lobes(*roughness, &seen[0])?,
            bakes: [read(0), read(1)],
            errors: [0, 1].map(|side| sides[side].delivered.roughnesses[k].rmse),
        })
    };
    roughnesses.iter().enumerate().map(column).collect()
}
