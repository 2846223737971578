//! Runs every entry point over small inputs, on every adapter. Drivers named in OCTAGLOSS_BRIEF_ADAPTERS run
//! only these tests.

use crate::reflection::entry_points;
use crate::stages::TakeOver;
use crate::transfer::Upload as _;
use crate::{boxes, direct, lamp, oem, pyramid, reflections, sat, stages, unwrap};
use octagloss_core::light::environment::Layout;
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::light::sat::{Sat, Scan};
use octagloss_fixtures::adapters::{exceeds, on_every_adapter, wait};
use octagloss_fixtures::common::{Look, Random, oem as oem_of, texels};
use octagloss_gpu::device::readback;
use octagloss_gpu::stages::copy;
use octagloss_gpu::stages::sat_f32;
use octagloss_gpu::triangles::DirectMap;
use octagloss_gpu::{Context, OemPlanes, SatPlanes};

/// The entry points that each test below runs.
const RUN: [(&str, &[&str]); 7] = [
    (
        "scans",
        &[
            "fixed_point.wgsl finish",
            "fixed_point.wgsl greatest",
            "fixed_point.wgsl totals",
            "sat_hensley.wgsl double_sums",
            "sat_hensley.wgsl quantise_texels",
            "sat_scan.wgsl carries",
            "sat_scan.wgsl carry_rows",
            "sat_scan.wgsl tables",
            "sat_scan.wgsl tile_sums",
        ],
    ),
    (
        "maps",
        &[
            "lamp.wgsl lamp",
            "reparameterise.wgsl footprints",
            "reparameterise.wgsl footprints_by_groups",
            "reparameterise.wgsl oem",
            "reparameterise.wgsl oem_by_groups",
        ],
    ),
    (
        "stages",
        &[
            "adaptive.wgsl adaptive",
            "box_filter.wgsl radiance",
            "cells.wgsl coarser",
            "cells.wgsl finest",
            "least.wgsl least_of_all",
            "least.wgsl least_of_groups",
            "pack.wgsl pack",
        ],
    ),
    (
        "pyramids",
        &[
            "pyramid/cells.wgsl cells_of_texels",
            "pyramid/cells.wgsl cosine",
            "pyramid/cells.wgsl harmonics",
            "pyramid/levels.wgsl cascade",
            "pyramid/levels.wgsl mirror",
            "pyramid/levels.wgsl sharp",
            "pyramid/light.wgsl write_light",
            "pyramid/query.wgsl query",
            "pyramid/seeds.wgsl brightest",
            "pyramid/seeds.wgsl seek",
            "pyramid/suns.wgsl moments",
        ],
    ),
    (
        "float32 tables",
        &[
            "sat_f32.wgsl bias",
            "sat_f32.wgsl double_sums",
            "sat_f32.wgsl mean_of_all",
            "sat_f32.wgsl sums_of_groups",
        ],
    ),
    ("copies", &["copy.wgsl copy"]),
    (
        "triangles",
        &[
            "direct/cull.wgsl count_kept",
            "direct/cull.wgsl list_kept",
            "direct/draw.wgsl own_octant",
            "direct/draw.wgsl project",
            "direct/draw.wgsl project_corner",
            "direct/draw.wgsl project_piece",
            "direct/draw.wgsl whole",
            "direct/offsets.wgsl sum_chunks",
            "direct/split.wgsl count_pieces",
            "direct/split.wgsl write_pieces",
            "direct/unwrap.wgsl unwrap_corner",
            "direct/unwrap.wgsl unwrapped_pixel",
        ],
    ),
];

#[test]
fn every_entry_point_is_run() {
    let mut run: Vec<String> =
        RUN.iter().flat_map(|(_, names)| names.iter().map(|n| n.to_string())).collect();
    run.sort();
    let mut all = entry_points();
    all.sort();
    assert_eq!(run, all, "RUN must list every entry point");
}

#[test]
fn scans_of_small_tables_equal_the_cpu() {
    on_every_adapter("brief: scans", |context| {
        sat::scan(context, &[1, 3, 17]);
        sat::doubling(context, &[2, 16], &[3, 17]);
    });
}

#[test]
fn small_maps_match_the_cpu() {
    let layouts = [Layout::Panorama { width: 64, height: 32 }, Layout::Cube { size: 7 }];
    on_every_adapter("brief: maps", |context| {
        // A group gathers one texel of many sources; with sixteen per side, one invocation gathers each.
        oem::maps(context, &layouts, &[(1, 0), (16, 8)]);
        oem::footprints(context, &layouts[..1], &[1, 16]);
        lamp::lamps(context, &[(8, 8)]);
    });
}

#[test]
fn stages_match_the_cpu() {
    on_every_adapter("brief: stages", |context| {
        stages::take_overs(context, &[TakeOver::Cells]);
        boxes::integer_sums(context, &[5]);
    });
}

#[test]
fn small_pyramids_match_the_cpu() {
    on_every_adapter("brief: pyramids", |context| {
        pyramid::look_ups(context, &[(32, Look::Suns, 1.0)], &[0.0, 0.3, 1.0]);
        reflections::reflections(context, &[(32, Look::Noise, 1.0)], &[0.3]);
    });
}

#[test]
fn drawn_triangles_match_the_oracle() {
    on_every_adapter("brief: triangles", |context| {
        let [square, rectangle] = [DirectMap::Octahedral { size: 16 }, DirectMap::Rectangular { size: 12 }];
        direct::closed_surfaces(context, &[(3, square), (3, rectangle)]);
        direct::cubes(context, &[(3, 7)]);
        direct::approximate(context);
        unwrap::remedies(context);
    });
}

/// Returns the first entry of the GPU's table of `oem` that differs from its prefix sum.
///
/// A sum over a tree of depth d = 2 ceil(log2 n) takes d roundings of at most the absolute total, plus those
/// of the mean and of the subtraction: (4 d + 3) units of the sum of the biased values' magnitudes bound it,
/// as derived in `crates/core/src/analysis/sat_f32.rs`. The mean enters the bias of every texel and is
/// compared separately.
fn f32_difference(oem: &Oem, entries: &[[f32; 4]], mean: [f32; 4]) -> Option<String> {
    let side = oem.size().bordered() as usize;
    assert_eq!(entries.len(), side * side, "entries");
    let depth = 2.0 * (side as f64).log2().ceil();
    let mut magnitude = [0.0_f64; 4];
    let mut sums = vec![[0.0_f64; 4]; side * side];
    for (k, texel) in oem.texels().iter().enumerate() {
        let (x, y) = (k % side, k / side);
        for c in 0..4 {
            let biased = f64::from(texel[c]) - f64::from(mean[c]);
            magnitude[c] += biased.abs();
            let at = |inside: bool, k: usize| if inside { sums[k][c] } else { 0.0 };
            sums[k][c] = biased + at(x > 0, k.wrapping_sub(1)) + at(y > 0, k.wrapping_sub(side))
                - at(x > 0 && y > 0, k.wrapping_sub(side + 1));
        }
    }
    entries.iter().zip(&sums).enumerate().find_map(|(k, (found, expected))| {
        let far = (0..4).any(|c| {
            let allowed = (4.0 * depth + 3.0) * octagloss_fixtures::adapters::UNIT * magnitude[c];
            exceeds((f64::from(found[c]) - expected[c]).abs(), allowed)
        });
        far.then(|| format!("entry {k} is {found:?}, not {expected:?}"))
    })
}

#[test]
fn float32_tables_are_sums() {
    let size = OemSize { inner: 17, border: 3 };
    let oem = oem_of(size, &texels(&mut Random::new(140), Look::Noise, Layout::Octahedral { size: 17 }));
    on_every_adapter("brief: float32 tables", |context| {
        let planes = OemPlanes::upload(context, &oem).expect("small planes");
        let (stage, table, mean) = sat_f32::stage(context, &planes).expect("a small table");
        context.submit(|encoder| stage.record(encoder));
        let mut entries: Vec<[f32; 4]> = wait(context, readback::read(context, &table));
        let mean: Vec<[f32; 4]> = wait(context, readback::read(context, &mean));
        let count = oem.texels().len() as f64;
        for c in 0..4 {
            let expected = oem.texels().iter().map(|texel| f64::from(texel[c])).sum::<f64>() / count;
            // Each of the sums rounds once at most.
            let off = (f64::from(mean[0][c]) / expected - 1.0).abs();
            assert!(
                !exceeds(off, count * octagloss_fixtures::adapters::UNIT),
                "mean {c}: {} for {expected}",
                mean[0][c]
            );
        }
        assert_eq!(f32_difference(&oem, &entries, mean[0]), None, "on {}", context.describe());
        entries[200][1] += 1e-3 * oem.totals()[1] as f32;
        assert!(
            f32_difference(&oem, &entries, mean[0]).is_some(),
            "an error of 0.1 % of the total is not detected"
        );
    });
}

/// Reads the words of each plane of `sat`.
fn words(context: &Context, sat: &SatPlanes) -> Vec<Vec<u32>> {
    sat.planes.iter().map(|plane| wait(context, readback::read(context, plane))).collect()
}

#[test]
fn copies_are_exact() {
    let size = OemSize { inner: 33, border: 1 };
    let oem = oem_of(size, &texels(&mut Random::new(141), Look::Suns, Layout::Octahedral { size: 33 }));
    let sat = Sat::new(&oem, Scan::default());
    on_every_adapter("brief: copies", |context| {
        let planes = SatPlanes::upload(context, &sat).expect("small planes");
        let before = words(context, &planes);
        let stage = copy::stage(context, &planes);
        context.submit(|encoder| stage.record(encoder));
        let after = words(context, &planes);
        // Copy the first plane to the last, then the second to the first, then the third to the second.
        assert!(before[0] != before[1] && before[1] != before[2], "the planes must differ");
        assert_eq!(after, [&before[1], &before[2], &before[2], &before[0]].map(Clone::clone));
    });
}
