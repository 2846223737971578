//! The entry points of `shaders/`, and the resources that `src/gpu` binds to each.

use octagloss::internals::gpu::{
    adaptive, blur, box_filter, cells, copy, direct::list, emitters, fitted, fixed_point, harmonics, lamp,
    mirror, reparameterise, sat_f32, sat_hensley, sat_scan,
};

/// The resource at each binding of group 0 (of group 1 from 100 on), as `src/gpu` binds it.
pub(super) type Bindings = &'static [(u32, &'static str)];

/// Every entry point: workgroup size and bindings.
pub(super) const ENTRY_POINTS: &[(&str, &str, [u32; 3], Bindings)] = &[
    (
        "adaptive.wgsl",
        "adaptive",
        [adaptive::GROUP_SIZE, 1, 1],
        &[
            (0, "uniform lobe"),
            (1, "read least"),
            (2, "read quads"),
            (3, "read packets"),
            (4, "write results"),
            (5, "write leaf_counts"),
            (6, "read members"),
            (7, "read angles"),
            (8, "texture source"),
        ],
    ),
    (
        "blur.wgsl",
        "blur",
        [octagloss::internals::gpu::octaves::EDGE, octagloss::internals::gpu::octaves::EDGE, 1],
        &[
            (0, "uniform table"),
            (1, "read red"),
            (2, "read green"),
            (3, "read blue"),
            (4, "read solid_angle"),
            (5, "uniform octaves"),
            (6, "write words"),
        ],
    ),
    ("blur.wgsl", "columns", [blur::LINE_SIZE, 1, 1], &[(5, "uniform octaves"), (8, "write entries")]),
    (
        "blur.wgsl",
        "rows",
        [blur::LINE_SIZE, 1, 1],
        &[(5, "uniform octaves"), (7, "read texels"), (8, "write entries")],
    ),
    (
        "box_filter.wgsl",
        "box_sums",
        [box_filter::GROUP_SIZE, 1, 1],
        &[
            (0, "uniform octagloss_table"),
            (1, "texture octagloss_low"),
            (2, "texture octagloss_high"),
            (102, "read boxes"),
            (103, "write sums"),
        ],
    ),
    (
        "box_filter.wgsl",
        "radiance",
        [box_filter::GROUP_SIZE, 1, 1],
        &[
            (0, "uniform octagloss_table"),
            (1, "texture octagloss_low"),
            (2, "texture octagloss_high"),
            (100, "read queries"),
            (101, "write answers"),
            (104, "read stack"),
        ],
    ),
    ("cells.wgsl", "coarser", [4 * cells::EDGE, cells::EDGE, 1], &[(8, "write quads"), (9, "uniform level")]),
    (
        "cells.wgsl",
        "finest",
        [4 * cells::EDGE, cells::EDGE, 1],
        &[
            (0, "uniform table"),
            (1, "read red"),
            (2, "read green"),
            (3, "read blue"),
            (4, "read solid_angle"),
            (6, "read least"),
            (7, "read tents"),
            (8, "write quads"),
            (9, "uniform level"),
        ],
    ),
    ("copy.wgsl", "copy", [copy::GROUP_SIZE, 1, 1], &[(0, "read source"), (1, "write destination")]),
    ("direct/cull.wgsl", "count_kept", [list::GROUP_SIZE, 1, 1], COUNT_KEPT),
    ("direct/cull.wgsl", "list_kept", [list::GROUP_SIZE, 1, 1], LIST_KEPT),
    // Vertex and fragment stages have no workgroups.
    ("direct/draw.wgsl", "own_octant", [0; 3], &[(0, "uniform octagloss_view")]),
    ("direct/draw.wgsl", "project", [0; 3], &[(0, "uniform octagloss_view")]),
    ("direct/draw.wgsl", "project_corner", [0; 3], &[(0, "uniform octagloss_view")]),
    ("direct/draw.wgsl", "project_piece", [0; 3], &[(0, "uniform octagloss_view")]),
    ("direct/draw.wgsl", "whole", [0; 3], &[]),
    (
        "direct/offsets.wgsl",
        "sum_chunks",
        [list::GROUP_SIZE, 1, 1],
        &[(0, "uniform offsets"), (1, "write counts"), (2, "write draws")],
    ),
    ("direct/split.wgsl", "count_pieces", [list::GROUP_SIZE, 1, 1], PIECES),
    ("direct/split.wgsl", "write_pieces", [list::GROUP_SIZE, 1, 1], PIECES),
    (
        "direct/unwrap.wgsl",
        "unwrap_corner",
        [0; 3],
        &[(0, "uniform panel"), (1, "read corners"), (2, "read indices")],
    ),
    ("direct/unwrap.wgsl", "unwrapped_pixel", [0; 3], &[(0, "uniform panel")]),
    (
        "emitters.wgsl",
        "brightest_cells",
        [emitters::GROUP_SIZE, 1, 1],
        &[
            (0, "uniform table"),
            (1, "read red"),
            (2, "read green"),
            (3, "read blue"),
            (4, "read solid_angle"),
            (5, "write brightness"),
            (7, "write brightest"),
        ],
    ),
    (
        "emitters.wgsl",
        "brightest_of_lists",
        [emitters::GROUP_SIZE, 1, 1],
        &[(6, "read listed"), (7, "write brightest")],
    ),
    (
        "emitters.wgsl",
        "emitters",
        [emitters::KEPT, 1, 1],
        &[
            (0, "uniform table"),
            (1, "read red"),
            (2, "read green"),
            (3, "read blue"),
            (6, "read listed"),
            (11, "write light"),
        ],
    ),
    (
        "emitters.wgsl",
        "rest",
        [emitters::EDGE, emitters::EDGE, 1],
        &[
            (0, "uniform table"),
            (1, "read red"),
            (2, "read green"),
            (3, "read blue"),
            (5, "write brightness"),
            (6, "read listed"),
            (8, "write rest_red"),
            (9, "write rest_green"),
            (10, "write rest_blue"),
        ],
    ),
    (
        "fitted.wgsl",
        "fitted",
        [fitted::GROUP_SIZE, 1, 1],
        &[
            (0, "uniform octagloss_octaves"),
            (1, "uniform octagloss_lights"),
            (2, "read octagloss_entries"),
            (3, "read octagloss_parameters"),
            (4, "texture octagloss_oems"),
            (100, "read queries"),
            (101, "write answers"),
        ],
    ),
    (
        "fixed_point.wgsl",
        "finish",
        [fixed_point::GROUP_SIZE, 1, 1],
        &[(0, "uniform table"), (5, "write partials"), (6, "write exponents")],
    ),
    ("fixed_point.wgsl", "greatest", [fixed_point::GROUP_SIZE, 1, 1], PARTIALS),
    ("fixed_point.wgsl", "totals", [fixed_point::GROUP_SIZE, 1, 1], PARTIALS),
    (
        "harmonics.wgsl",
        "sum_of_all",
        [harmonics::GROUP_SIZE, 1, 1],
        &[(0, "uniform table"), (5, "read exponents"), (6, "write partials"), (7, "write light")],
    ),
    (
        "harmonics.wgsl",
        "sums_of_groups",
        [harmonics::GROUP_SIZE, 1, 1],
        &[
            (0, "uniform table"),
            (1, "read red"),
            (2, "read green"),
            (3, "read blue"),
            (4, "read solid_angle"),
            (6, "write partials"),
        ],
    ),
    (
        "lamp.wgsl",
        "lamp",
        [lamp::EDGE, lamp::EDGE, 1],
        &[
            (0, "uniform table"),
            (1, "write red"),
            (2, "write green"),
            (3, "write blue"),
            (4, "read solid_angle"),
            (5, "uniform light"),
        ],
    ),
    (
        "least.wgsl",
        "least_of_all",
        [fixed_point::GROUP_SIZE, 1, 1],
        &[(0, "uniform table"), (5, "write partials"), (6, "write least")],
    ),
    ("least.wgsl", "least_of_groups", [fixed_point::GROUP_SIZE, 1, 1], PARTIALS),
    (
        "mirror.wgsl",
        "mirror",
        [mirror::EDGE, mirror::EDGE, 1],
        &[
            (0, "uniform table"),
            (1, "read red"),
            (2, "read green"),
            (3, "read blue"),
            (4, "read solid_angle"),
            (5, "store energy"),
        ],
    ),
    (
        "pack.wgsl",
        "pack",
        [box_filter::EDGE, box_filter::EDGE, 1],
        &[
            (0, "uniform table"),
            (1, "read red"),
            (2, "read green"),
            (3, "read blue"),
            (4, "read solid_angle"),
            (5, "store low"),
            (6, "store high"),
            (7, "read exponents"),
            (8, "write header"),
        ],
    ),
    ("reparameterise.wgsl", "footprints", [reparameterise::EDGE, reparameterise::EDGE, 1], FOOTPRINTS),
    ("reparameterise.wgsl", "footprints_by_groups", [reparameterise::GROUP_SIZE, 1, 1], FOOTPRINTS),
    ("reparameterise.wgsl", "oem", [reparameterise::EDGE, reparameterise::EDGE, 1], OEM),
    ("reparameterise.wgsl", "oem_by_groups", [reparameterise::GROUP_SIZE, 1, 1], OEM),
    (
        "sat_f32.wgsl",
        "bias",
        [sat_f32::EDGE, sat_f32::EDGE, 1],
        &[
            (0, "uniform table"),
            (1, "read red"),
            (2, "read green"),
            (3, "read blue"),
            (4, "read solid_angle"),
            (6, "write mean"),
            (7, "write back"),
        ],
    ),
    (
        "sat_f32.wgsl",
        "double_sums",
        [sat_f32::EDGE, sat_f32::EDGE, 1],
        &[(7, "write back"), (8, "uniform doubling"), (9, "read front")],
    ),
    (
        "sat_f32.wgsl",
        "mean_of_all",
        [256, 1, 1],
        &[(0, "uniform table"), (5, "write partials"), (6, "write mean")],
    ),
    ("sat_f32.wgsl", "sums_of_groups", [256, 1, 1], PARTIALS),
    (
        "sat_hensley.wgsl",
        "double_sums",
        [sat_hensley::EDGE, sat_hensley::EDGE, 1],
        &[
            (0, "uniform doubling"),
            (4, "read front_0"),
            (5, "read front_1"),
            (6, "write back_0"),
            (7, "write back_1"),
        ],
    ),
    (
        "sat_hensley.wgsl",
        "quantise_texels",
        [sat_hensley::EDGE, sat_hensley::EDGE, 1],
        &[
            (0, "uniform doubling"),
            (1, "read exponents"),
            (2, "read texels_0"),
            (3, "read texels_1"),
            (6, "write back_0"),
            (7, "write back_1"),
        ],
    ),
    ("sat_scan.wgsl", "carries", [sat_scan::GROUP_SIZE, 1, 1], CARRIES),
    ("sat_scan.wgsl", "carry_rows", [sat_scan::GROUP_SIZE, 1, 1], &[(0, "uniform scan"), (5, "write above")]),
    (
        "sat_scan.wgsl",
        "tables",
        [16, 16, 1],
        &[
            (0, "uniform scan"),
            (1, "read exponents"),
            (2, "read texels_0"),
            (3, "read texels_1"),
            (4, "write rows_left"),
            (5, "write above"),
            (6, "write table_0"),
            (7, "write table_1"),
        ],
    ),
    (
        "sat_scan.wgsl",
        "tile_sums",
        [16, 16, 1],
        &[
            (0, "uniform scan"),
            (1, "read exponents"),
            (2, "read texels_0"),
            (3, "read texels_1"),
            (4, "write rows_left"),
            (5, "write above"),
        ],
    ),
];

const COUNT_KEPT: Bindings =
    &[(0, "uniform cull"), (1, "read corners"), (2, "read indices"), (3, "write counts")];

const LIST_KEPT: Bindings =
    &[(0, "uniform cull"), (1, "read corners"), (2, "read indices"), (3, "write counts"), (4, "write kept")];

const PIECES: Bindings = &[
    (0, "uniform split"),
    (1, "read corners"),
    (2, "read indices"),
    (3, "write counts"),
    (4, "write pieces"),
];

const PARTIALS: Bindings = &[
    (0, "uniform table"),
    (1, "read red"),
    (2, "read green"),
    (3, "read blue"),
    (4, "read solid_angle"),
    (5, "write partials"),
];

const CARRIES: Bindings = &[(0, "uniform scan"), (4, "write rows_left"), (5, "write above")];

const OEM: Bindings = &[
    (0, "uniform gather"),
    (1, "read starts"),
    (2, "read overlaps"),
    (3, "texture source"),
    (4, "read solid_angle"),
    (5, "write red"),
    (6, "write green"),
    (7, "write blue"),
];

const FOOTPRINTS: Bindings = &[
    (0, "uniform gather"),
    (1, "read starts"),
    (2, "read overlaps"),
    (3, "texture source"),
    (8, "write footprint"),
];
