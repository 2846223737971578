//! Builds the maps of a pyramid from an OEM.
//!
//! ```text
//! OEM planes --suns--> light (suns, scale)
//!  +--mirror--> mirror --sharp--> sharp level --cascade--> level 0 --cascade--> level 1 ...
//!  |                                                             middle levels <--+
//!  +--cells--> cells --cosine--> cosine level
//!                +--harmonics--> light
//! ```

use super::pyramid::PyramidMaps;
use crate::device::stage::Dispatch;
use crate::{Context, OemPlanes, Stage};
use octagloss_core::light::oem::OemSize;
use octagloss_core::pyramid::levels::{BETWEEN, FROM_MIDDLE, TAPS, taps};
use octagloss_core::pyramid::{Square, cells, suns};
use wgpu::BindingResource::{Sampler, TextureView};

/// Invocations of a workgroup in one dimension.
pub const GROUP_SIZE: u32 = 256;

/// Invocations along an edge of a workgroup over texels.
pub const EDGE: u32 = 8;

/// `Level` of the shaders.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Level {
    inner: u32,
    border: u32,
    finer_inner: u32,
    finer_border: u32,
    variance: f32,
    pad: [u32; 3],
    taps: [[f32; 4]; TAPS],
}

/// The uniform of a map of `size` under a Gaussian of `variance` over one of the size `finer`.
fn level(context: &Context, size: OemSize, finer: OemSize, variance: f64) -> wgpu::Buffer {
    let level = Level {
        inner: size.inner,
        border: size.border,
        finer_inner: finer.inner,
        finer_border: finer.border,
        variance: variance as f32,
        pad: [0; 3],
        taps: taps().map(|(place, weight)| [place.x, place.y, weight, 0.0]),
    };
    context.uniform("level", &level)
}

/// Workgroups over `texels` x `texels` texels.
const fn squares(texels: u32) -> [u32; 3] {
    [texels / EDGE, texels / EDGE, 1]
}

/// The stages that fill `maps` from `oem`, in order. Record them whenever `oem` has changed.
///
/// # Panics
/// If `maps` were made for another size.
pub fn stages(context: &Context, oem: &OemPlanes, maps: &PyramidMaps) -> Vec<Stage> {
    assert_eq!(oem.size().inner, maps.octaves().inner(), "maps for this size");
    vec![suns_of(context, oem, maps), levels(context, oem, maps), moments(context, oem, maps)]
}

fn suns_of(context: &Context, oem: &OemPlanes, maps: &PyramidMaps) -> Stage {
    let texels = oem.size().inner.pow(2);
    let file = "pyramid/suns.wgsl";
    let mut resources = oem.bindings();
    resources.push((5, maps.blocks.as_entire_binding()));
    let brightest = Dispatch::new(context, (file, "brightest"), &resources, [texels / GROUP_SIZE, 1, 1]);
    resources.push((6, maps.light()));
    let seek = Dispatch::new(context, (file, "seek"), &resources, [1, 1, 1]);
    let suns = Dispatch::new(context, (file, "suns"), &resources, [suns::COUNT as u32, 1, 1]);
    Stage::new("suns", vec![brightest, seek, suns])
}

fn levels(context: &Context, oem: &OemPlanes, maps: &PyramidMaps) -> Stage {
    let file = "pyramid/levels.wgsl";
    let (octaves, size) = (maps.octaves(), maps.octaves().size(0));
    let [mirror, sharp] = [0, 1].map(|map| maps.square(octaves.square_of(map)));
    let [to_mirror, to_sharp] =
        [0.0, octaves.sharp_width()].map(|width| level(context, size, size, width * width));
    let mut of_oem = oem.bindings();
    of_oem.extend([(5, maps.light()), (7, to_mirror.as_entire_binding()), (8, TextureView(&mirror))]);
    let of_mirror = [
        (5, maps.light()),
        (6, TextureView(&mirror)),
        (7, to_sharp.as_entire_binding()),
        (8, TextureView(&sharp)),
    ];
    let mut dispatches = vec![
        Dispatch::new(context, (file, "mirror"), &of_oem, squares(size.inner)),
        Dispatch::new(context, (file, "sharp"), &of_mirror, squares(size.inner / 2)),
    ];
    let mut cascade = |finer: Square, own: Square, variance| {
        let (finer_size, size) = (octaves.size(finer.mip), octaves.size(own.mip));
        let to_own = level(context, size, finer_size, variance);
        let [finer, own] = [finer, own].map(|square| maps.square(square));
        let resources = [
            (6, TextureView(&finer)),
            (7, to_own.as_entire_binding()),
            (8, TextureView(&own)),
            (9, Sampler(maps.linear())),
        ];
        dispatches.push(Dispatch::new(context, (file, "cascade"), &resources, squares(size.inner)));
    };
    for k in 0..octaves.count() {
        let [finer, own] = [k + 1, k + 2].map(|map| octaves.square_of(map));
        cascade(finer, own, BETWEEN * octaves.width(k).powi(2));
    }
    for middle in 0..octaves.middles() {
        let below = octaves.square_of(octaves.below_middle(middle) + 2);
        let variance = FROM_MIDDLE * octaves.middle_width(middle).powi(2);
        cascade(below, octaves.square_of_middle(middle), variance);
    }
    Stage::new("levels", dispatches)
}

fn moments(context: &Context, oem: &OemPlanes, maps: &PyramidMaps) -> Stage {
    let file = "pyramid/cells.wgsl";
    let planes = oem.bindings();
    let rows = oem.size().inner * oem.size().inner.min(cells::FINEST);
    let place = maps.octaves().square_of_cosine();
    let (cosine, size) = (maps.square(place), maps.octaves().size(place.mip));
    let to_cosine = level(context, size, size, 0.0);
    let stored = (6, maps.cells.as_entire_binding());
    let of_texels = [&planes[..], &[(5, maps.light()), stored.clone()]].concat();
    let of_cells =
        [planes[0].clone(), stored.clone(), (7, to_cosine.as_entire_binding()), (8, TextureView(&cosine))];
    let summed = [planes[0].clone(), (5, maps.light()), stored];
    Stage::new(
        "cells",
        vec![
            Dispatch::new(context, (file, "cells_of_texels"), &of_texels, [rows / GROUP_SIZE, 1, 1]),
            Dispatch::new(context, (file, "cosine"), &of_cells, [size.inner / 2, size.inner / 2, 1]),
            Dispatch::new(context, (file, "harmonics"), &summed, [25_u32.div_ceil(4), 1, 1]),
        ],
    )
}
