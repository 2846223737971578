//! Builds the maps of a pyramid from an OEM.
//!
//! ```text
//! OEM planes --brightest, seek--> seeds, scale
//!  +--mirror--> mirror; rest --sharp--> sharp level --cascade--> next level --cascade--> ...
//!  +--moments--> light above the clamp --suns--> light
//!  +--cells_of_texels--> cells --cosine--> cosine level
//!                          +--harmonics--> light
//! ```

use super::pyramid::PyramidMaps;
use crate::device::stage::Dispatch;
use crate::{Context, OemPlanes, Stage};
use octagloss_core::light::oem::OemSize;
use octagloss_core::pyramid::levels::{Between, TAPS, taps};
use octagloss_core::pyramid::{Square, cells};
use wgpu::BindingResource::{Sampler, TextureView};

/// Invocations of a workgroup in one dimension.
pub const GROUP_SIZE: u32 = 256;

/// Invocations along an edge of a workgroup over texels.
pub const EDGE: u32 = 8;

/// The shader of levels.
const LEVELS: &str = "pyramid/levels.wgsl";

/// Areas of an OEM along an edge, in which seeds of suns are sought.
pub const AREAS: u32 = 16;

/// Texels of the cosine level along an edge of those that a workgroup takes.
const COSINE_EDGE: u32 = 4;

/// `Level` of the shaders.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Level {
    inner: u32,
    border: u32,
    finer_inner: u32,
    finer_border: u32,
    variance: f32,
    bend: f32,
    pad: [u32; 2],
    taps: [[f32; 4]; TAPS],
}

/// The uniform of a map of `size` that `between` makes of one of the size `finer`.
fn level(context: &Context, size: OemSize, finer: OemSize, between: Between) -> wgpu::Buffer {
    let level = Level {
        inner: size.inner,
        border: size.border,
        finer_inner: finer.inner,
        finer_border: finer.border,
        variance: between.variance as f32,
        bend: between.bend as f32,
        pad: [0; 2],
        taps: taps().map(|(place, weight)| [place.x, place.y, weight, 0.0]),
    };
    context.uniform("level", &level)
}

/// Workgroups over `texels` x `texels` texels.
const fn squares(texels: u32) -> [u32; 3] {
    [texels / EDGE, texels / EDGE, 1]
}

/// The stage that fills `maps` from `oem`. Record it whenever `oem` has changed.
///
/// # Panics
/// If `maps` were made for another size.
pub fn stage(context: &Context, oem: &OemPlanes, maps: &PyramidMaps) -> Stage {
    assert_eq!(oem.size().inner, maps.levels().inner(), "maps for this size");
    let [brightest, seek] = seeds(context, oem, maps);
    let [moments, light] = light(context, oem, maps);
    let [cells, cosine, harmonics] = diffuse(context, oem, maps);
    let [mirror, sharp] = sharp(context, oem, maps);
    let mut cascades = cascades(context, maps).into_iter();
    let first = cascades.next().expect("a level");
    // Side by side stand those that only read what others wrote; the first of each line waits for all that
    // the others read.
    let mut dispatches = vec![brightest, seek];
    dispatches.extend([mirror, moments, cells]);
    dispatches.extend([sharp, cosine, harmonics]);
    dispatches.extend([first, light]);
    dispatches.extend(cascades);
    Stage::new("pyramid", dispatches)
}

fn seeds(context: &Context, oem: &OemPlanes, maps: &PyramidMaps) -> [Dispatch; 2] {
    let passed = maps.passed();
    let (file, mut resources) = ("pyramid/seeds.wgsl", oem.bindings());
    let brightness = (5, passed.texels.as_entire_binding());
    resources.extend([brightness.clone(), (6, passed.areas.as_entire_binding())]);
    let brightest = Dispatch::new(context, (file, "brightest"), &resources, [AREAS.pow(2), 1, 1]);
    let resources = [
        resources[0].clone(),
        brightness,
        (7, passed.seeds.as_entire_binding()),
        (8, passed.areas.as_entire_binding()),
    ];
    [brightest, Dispatch::new(context, (file, "seek"), &resources, [1, 1, 1])]
}

fn light(context: &Context, oem: &OemPlanes, maps: &PyramidMaps) -> [Dispatch; 2] {
    let passed = maps.passed();
    let mut resources = oem.bindings();
    resources.extend([
        (5, passed.areas.as_entire_binding()),
        (6, passed.seeds.as_entire_binding()),
        (7, passed.excess.as_entire_binding()),
    ]);
    let moments = Dispatch::new(context, ("pyramid/suns.wgsl", "moments"), &resources, [AREAS.pow(2), 1, 1]);
    let resources = [
        (0, passed.seeds.as_entire_binding()),
        (1, passed.excess.as_entire_binding()),
        (2, passed.harmonics.as_entire_binding()),
        (3, maps.light()),
    ];
    [moments, Dispatch::new(context, ("pyramid/light.wgsl", "write_light"), &resources, [1, 1, 1])]
}

fn sharp(context: &Context, oem: &OemPlanes, maps: &PyramidMaps) -> [Dispatch; 2] {
    let passed = maps.passed();
    let (levels, size) = (maps.levels(), maps.levels().size(0));
    let [mirror, sharp] = [0, 1].map(|map| maps.square(levels.square_of(map)));
    let [to_mirror, to_sharp] =
        [0.0, levels.width(1)].map(|width| level(context, size, size, Between::round(width)));
    let rest = (10, passed.texels.as_entire_binding());
    let mut of_oem = oem.bindings();
    of_oem.extend([
        (5, passed.seeds.as_entire_binding()),
        (7, to_mirror.as_entire_binding()),
        (8, TextureView(&mirror)),
        rest.clone(),
    ]);
    let of_rest = [
        (7, to_sharp.as_entire_binding()),
        (8, TextureView(&sharp)),
        rest,
        (11, passed.cells.as_entire_binding()),
    ];
    [
        Dispatch::new(context, (LEVELS, "mirror"), &of_oem, squares(size.inner)),
        Dispatch::new(context, (LEVELS, "sharp"), &of_rest, squares(size.inner / 2)),
    ]
}

/// Each level from the next finer one.
fn cascades(context: &Context, maps: &PyramidMaps) -> Vec<Dispatch> {
    let (levels, passed) = (maps.levels(), maps.passed());
    let cascade = |finer: Square, own: Square, between| {
        let (finer_size, size) = (levels.size(finer.mip), levels.size(own.mip));
        let to_own = level(context, size, finer_size, between);
        let [finer, own] = [finer, own].map(|square| maps.square(square));
        let resources = [
            (6, TextureView(&finer)),
            (7, to_own.as_entire_binding()),
            (8, TextureView(&own)),
            (9, Sampler(maps.linear())),
            (12, passed.excess.as_entire_binding()),
            (13, passed.harmonics.as_entire_binding()),
        ];
        Dispatch::new(context, (LEVELS, "cascade"), &resources, squares(size.inner))
    };
    let own = |map| {
        let between = Between::new(levels.width(map), levels.width(map - 1));
        cascade(levels.square_of(map - 1), levels.square_of(map), between)
    };
    (2..levels.count()).map(own).collect()
}

fn diffuse(context: &Context, oem: &OemPlanes, maps: &PyramidMaps) -> [Dispatch; 3] {
    let file = "pyramid/cells.wgsl";
    let planes = oem.bindings();
    let rows = oem.size().inner * oem.size().inner.min(cells::FINEST);
    let place = maps.levels().square_of_cosine();
    let (cosine, size) = (maps.square(place), maps.levels().size(place.mip));
    let to_cosine = level(context, size, size, Between::round(0.0));
    let seeds = (5, maps.passed().seeds.as_entire_binding());
    let stored = (6, maps.passed().cells.as_entire_binding());
    let of_texels = [&planes[..], &[seeds, stored.clone()]].concat();
    let of_cells =
        [planes[0].clone(), stored.clone(), (7, to_cosine.as_entire_binding()), (8, TextureView(&cosine))];
    let summed = [planes[0].clone(), stored, (9, maps.passed().harmonics.as_entire_binding())];
    let groups = size.inner / COSINE_EDGE;
    [
        Dispatch::new(context, (file, "cells_of_texels"), &of_texels, [rows / GROUP_SIZE, 1, 1]),
        Dispatch::new(context, (file, "cosine"), &of_cells, [groups, groups, 1]),
        Dispatch::new(context, (file, "harmonics"), &summed, [maps.passed().sums_of_harmonics(), 1, 1]),
    ]
}
