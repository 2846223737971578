//! Resamples the environment to the OEM and to the cube of footprints: applies the CPU's overlap matrix to a
//! texture.

use super::oem::Table;
use crate::device::resources;
use crate::device::stage::Dispatch;
use crate::{Context, OemPlanes, Stage};
use octagloss_core::common::error::{Error, Result, wrong};
use octagloss_core::geometry::overlap::{Overlaps, Target};
use octagloss_core::geometry::solid_angles::solid_angles;
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::light::oem::OemSize;

/// Invocations along an edge of a workgroup.
pub const EDGE: u32 = 16;

/// Invocations of a workgroup that computes one texel.
pub const GROUP_SIZE: u32 = 256;

/// Mean number of sources per texel from which on a workgroup, not an invocation, computes a texel.
const MANY_SOURCES: usize = 256;

/// Most sources of one invocation, which reads each twice: llvmpipe silently ends loops after 65535
/// iterations.
const MAX_SOURCES: u32 = 24_576;

/// Uniform: target, source and the mirroring of octants.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Gather {
    edge: u32,
    border: u32,
    side: u32,
    pitch: u32,
    width: u32,
    height: u32,
    symmetric: u32,
    padding: u32,
    source_maps: [[[i32; 4]; 3]; 8],
}

/// Columns, rows and layers of the texture for `layout`.
pub(crate) const fn texture_size(layout: Layout) -> [u32; 3] {
    match layout {
        Layout::Panorama { width, height } => [width, height, 1],
        Layout::Cube { size } => [size, size, 6],
        Layout::Octahedral { size } => [size, size, 1],
    }
}

/// Uploads `environment` as an rgba32float texture with one layer, or six for the faces of a cube.
///
/// # Errors
/// [`Error::Limit`] if a side exceeds the device's texture size.
pub fn upload(context: &Context, environment: &Environment) -> Result<wgpu::Texture> {
    let [width, height, depth_or_array_layers] = texture_size(environment.layout());
    let most = context.device().limits().max_texture_dimension_2d;
    if width.max(height) > most {
        return Err(Error::Limit {
            what: format!("a texture of {width} x {height}"),
            // Textures are limited by their sides, so compare squares of the longer side.
            needed: u64::from(width.max(height)).pow(2) * 16,
            available: u64::from(most) * u64::from(most) * 16,
            remedy: format!("use an image of at most {most} texels per side, or `engine` cpu"),
        });
    }
    let (format, sides) = (wgpu::TextureFormat::Rgba32Float, [width, height, depth_or_array_layers]);
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = context.texture("environment", format, sides, 1, usage);
    // Upload strips of rows to limit the staging memory.
    let strip = (1_u32 << 20).div_ceil(width).min(height);
    for layer in 0..depth_or_array_layers {
        for top in (0..height).step_by(strip as usize) {
            let rows = strip.min(height - top);
            let first = (layer as usize * height as usize + top as usize) * width as usize;
            let texels: Vec<[f32; 4]> = environment.texels()[first..first + (rows * width) as usize]
                .iter()
                .map(|[r, g, b]| [*r, *g, *b, 1.0])
                .collect();
            context.queue().write_texture(
                wgpu::TexelCopyTextureInfo {
                    origin: wgpu::Origin3d { x: 0, y: top, z: layer },
                    ..texture.as_image_copy()
                },
                bytemuck::cast_slice(&texels),
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(16 * width),
                    rows_per_image: None,
                },
                wgpu::Extent3d { width, height: rows, depth_or_array_layers: 1 },
            );
        }
    }
    Ok(texture)
}

/// Stage that resamples `texture`, with texels in `layout`, to `planes`, border included. Also uploads
/// the solid angles of `planes`. The texture's first level must have `texture_size` and a format of
/// colours that shaders read as floats. Negative values and NaN count as 0, infinity as the greatest
/// float.
///
/// # Errors
/// [`Error::Limit`] if the overlap matrix is larger than the device can bind, [`Error::Parameter`] if the
/// texture has another size, or is not one that the stage can read.
pub fn stage(
    context: &Context,
    layout: Layout,
    texture: &wgpu::Texture,
    planes: &OemPlanes,
) -> Result<Stage> {
    let OemSize { inner, .. } = planes.size();
    let table = planes.table();
    upload_solid_angles(context, planes);
    let overlaps = Overlaps::new(layout, glam::DMat3::IDENTITY, Target::Octahedral(inner))?;
    let targets =
        [(4, 3), (5, 0), (6, 1), (7, 2)].map(|(k, channel)| (k, planes.planes[channel].as_entire_binding()));
    let entry_points = ["oem", "oem_by_groups"];
    let dispatch = dispatch(context, (layout, texture), &overlaps, table, 1, entry_points, &targets)?;
    Ok(Stage::new("reparameterise", vec![dispatch]))
}

/// Stage that computes the mean radiance over every texel of a cube with faces of `size`, in world space,
/// and its output: `size` x `size` x 6 four-component floats.
///
/// # Errors
/// Those of [`stage`].
pub fn footprints(
    context: &Context,
    environment: &Environment,
    texture: &wgpu::Texture,
    size: u32,
) -> Result<(Stage, wgpu::Buffer)> {
    let layout = environment.layout();
    let table = Table { inner: size, border: 0, side: size, pitch: size };
    let overlaps = Overlaps::new(layout, environment.source_from_world().transpose(), Target::Cube(size))?;
    let bytes = 16 * 6 * u64::from(size) * u64::from(size);
    context.fits(&format!("a cube of {size} x {size}"), bytes, |available| {
        format!("choose `size` of at most {}", (available / 96).isqrt())
    })?;
    let footprint = context.storage("footprints", bytes);
    let target = (8, footprint.as_entire_binding());
    let entry_points = ["footprints", "footprints_by_groups"];
    let dispatch = dispatch(context, (layout, texture), &overlaps, table, 6, entry_points, &[target])?;
    Ok((Stage::new("footprints", vec![dispatch]), footprint))
}

/// Checks that shaders can read colours from `texture`.
///
/// # Errors
/// [`Error::Parameter`] naming what it has and what it needs.
pub fn check_readable(context: &Context, texture: &wgpu::Texture) -> Result<()> {
    let refused = |has: String, needs: &str| wrong(format!("a texture of {has}; {needs}"));
    let (format, usage) = (texture.format(), texture.usage());
    if !usage.contains(wgpu::TextureUsages::TEXTURE_BINDING) {
        return refused(format!("the usage {usage:?}"), "its usage must include TEXTURE_BINDING");
    }
    if texture.dimension() != wgpu::TextureDimension::D2 {
        return refused(format!("the dimension {:?}", texture.dimension()), "its dimension must be D2");
    }
    if texture.sample_count() != 1 {
        return refused(format!("{} samples", texture.sample_count()), "resolve it to one sample");
    }
    let sampled = format.sample_type(None, Some(context.device().features()));
    if !matches!(sampled, Some(wgpu::TextureSampleType::Float { .. })) || format.components() < 3 {
        return refused(
            format!("the format {format:?}"),
            "choose one of three or four float channels, as Rgba16Float",
        );
    }
    Ok(())
}

/// Writes the solid angles of `planes`, which depend only on their size.
fn upload_solid_angles(context: &Context, planes: &OemPlanes) {
    let Table { inner, border, side, pitch } = planes.table();
    let weights = solid_angles(inner);
    let mut words = vec![0.0_f32; planes.table().count() as usize];
    for (row, y) in words.chunks_exact_mut(pitch as usize).zip(0..side) {
        for (word, x) in row.iter_mut().zip(0..side) {
            let place = |k: u32| i64::from(k) - i64::from(border);
            let (x, y) = octagloss_core::sphere::octahedral::wrap_texel(inner, place(x), place(y));
            *word = weights.at(x, y);
        }
    }
    context.queue().write_buffer(&planes.planes[3], 0, bytemuck::cast_slice(&words));
}

/// The dispatch that applies the matrix `overlaps` to `texture`, with texels in `layout`, for the texels of
/// `layers` images of `target`. Of the two entry points, which have further `targets`, the first computes a
/// texel by an invocation, the second by a group.
fn dispatch(
    context: &Context,
    (layout, texture): (Layout, &wgpu::Texture),
    overlaps: &Overlaps,
    target: Table,
    layers: u32,
    [by_texels, by_groups]: [&'static str; 2],
    targets: &[(u32, wgpu::BindingResource<'_>)],
) -> Result<Dispatch> {
    check_readable(context, texture)?;
    let [width, height, depth] = texture_size(layout);
    let size = texture.size();
    if [size.width, size.height, size.depth_or_array_layers] != [width, height, depth] {
        return wrong(format!(
            "texture of {} x {} x {}; {layout:?} requires {width} x {height} x {depth}",
            size.width, size.height, size.depth_or_array_layers
        ));
    }
    let (starts, entries) = overlaps.rows();
    context.fits("the overlap of source and target texels", 8 * entries.len() as u64, |_| {
        "bake from a smaller or unturned source, or with `engine` cpu".to_owned()
    })?;
    let is_by_groups = entries.len() / starts.len() >= MANY_SOURCES;
    let most = starts.windows(2).map(|row| row[1] - row[0]).max().unwrap_or(0);
    let available = if is_by_groups { GROUP_SIZE * MAX_SOURCES } else { MAX_SOURCES };
    // Two rows contribute to a texel on a fold diagonal.
    if 2 * most > available {
        return Err(Error::Limit {
            what: format!("a texel of {} x {}", target.inner, target.inner),
            needed: 16 * u64::from(most),
            available: 8 * u64::from(available),
            remedy: "bake from a smaller source, or with `engine` cpu".to_owned(),
        });
    }
    let entries: Vec<[u32; 2]> =
        entries.iter().map(|(source, solid_angle)| [*source, solid_angle.to_bits()]).collect();
    let gather = Gather {
        edge: target.inner,
        border: target.border,
        side: target.side,
        pitch: target.pitch,
        width,
        height,
        symmetric: u32::from(overlaps.is_symmetric()),
        padding: 0,
        source_maps: overlaps.source_maps(),
    };
    let gather = context.uniform("gather", &gather);
    let (starts, entries) =
        (context.storage_of("overlap rows", starts), context.storage_of("overlaps", &entries));
    let view = resources::layers(texture);
    let sources = [
        (0, gather.as_entire_binding()),
        (1, starts.as_entire_binding()),
        (2, entries.as_entire_binding()),
        (3, wgpu::BindingResource::TextureView(&view)),
    ];
    let (entry_point, across) =
        if is_by_groups { (by_groups, target.side) } else { (by_texels, target.side.div_ceil(EDGE)) };
    let file = "reparameterise.wgsl";
    Ok(Dispatch::new(context, (file, entry_point), &[&sources, targets].concat(), [across, across, layers]))
}
