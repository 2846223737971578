//! Atlases on the GPU: copies of maps into tiles, the tables of all tiles, and look-ups in WGSL.

use crate::look;
use crate::transfer::{Upload as _, read_sat};
use glam::DVec3;
use octagloss_core::common::error::Error;
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::light::sat::Scan;
use octagloss_fixtures::adapters::{exceeds, in_full, wait};
use octagloss_fixtures::atlas::table::{Atlas, Domain, Tile};
use octagloss_fixtures::common::{Random, landmarks, oem};
use octagloss_gpu::stages::{fixed_point, sat_scan};
use octagloss_gpu::{Context, OemPlanes, SatPlanes};

const SIDE: u32 = 128;

/// An atlas of several tiles, with the maps of those of the sphere.
fn filled() -> (Atlas, Vec<(Tile, Oem)>) {
    let mut atlas = Atlas::new(SIDE, 2).expect("an atlas");
    let mut random = Random::new(23);
    let mut tiles = Vec::new();
    for (k, side) in [32, 16, 64, 8, 32, 16].into_iter().enumerate() {
        let domain = if k % 3 == 1 { Domain::Hemisphere } else { Domain::Sphere };
        let tile = atlas.allocate(side, domain).expect("a valid size").expect("room");
        let texels: Vec<[f32; 3]> = (0..tile.size().inner.pow(2))
            .map(|_| [random.unit(), 30.0 * random.unit(), random.unit().powi(4)].map(|c| c as f32))
            .collect();
        let map = oem(tile.size(), &texels);
        atlas.write(tile, &map.square().copied().collect::<Vec<_>>()).expect("texels of the square");
        tiles.push((tile, map));
    }
    (atlas, tiles)
}

/// Records copies of `map`, border included, to `tile` of `atlas`.
fn copy(
    encoder: &mut wgpu::CommandEncoder,
    map: &OemPlanes,
    atlas: &OemPlanes,
    tile: Tile,
) -> Result<(), Error> {
    let (size, whole) = (tile.size(), atlas.table());
    let [x, y] = tile.corner();
    if map.size() != size || x.max(y) + size.bordered() > whole.side {
        let OemSize { inner, border } = map.size();
        return Err(Error::Parameter(format!(
            "a map of {inner} texels with a border of {border} for a tile of {} with {} at ({x}, {y}) of \
             {}; allocate a tile of the map's size",
            size.inner, size.border, whole.side
        )));
    }
    let pitch = map.table().pitch;
    for (from, to) in map.planes.iter().zip(&atlas.planes) {
        for row in 0..size.bordered() {
            let at = |pitch: u32, x: u32, y: u32| 4 * (u64::from(pitch) * u64::from(y) + u64::from(x));
            let bytes = 4 * u64::from(size.bordered());
            encoder.copy_buffer_to_buffer(from, at(pitch, 0, row), to, at(whole.pitch, x, y + row), bytes);
        }
    }
    Ok(())
}

#[test]
fn copies_of_maps_and_the_scan_of_all_tiles_equal_the_cpus() {
    let (atlas, tiles) = filled();
    let spheres = || tiles.iter().filter(|(tile, _)| tile.domain() == Domain::Sphere);
    let mut empty = Atlas::new(SIDE, 2).expect("an atlas");
    // The hemispheres alone; maps of the sphere come from the device.
    for (tile, map) in &tiles {
        let own = empty.allocate(tile.size().bordered(), tile.domain()).expect("valid").expect("room");
        assert_eq!(own.corner(), tile.corner());
        if tile.domain() == Domain::Hemisphere {
            empty.write(own, &map.square().copied().collect::<Vec<_>>()).expect("texels of the square");
        }
    }
    in_full("atlas", |context| {
        let texels = OemPlanes::upload(context, &empty.oem()).expect("small planes");
        let sat = SatPlanes::new(context, texels.size()).expect("small planes");
        let maps: Vec<OemPlanes> =
            spheres().map(|(_, map)| OemPlanes::upload(context, map).expect("small planes")).collect();
        let exponents = fixed_point::stage(context, &texels, &sat);
        let stages = [exponents, sat_scan::stage(context, &texels, &sat)];
        context.submit(|encoder| {
            for (map, (tile, _)) in maps.iter().zip(spheres()) {
                copy(encoder, map, &texels, *tile).expect("a tile of the map's size");
            }
            for stage in &stages {
                stage.record(encoder);
            }
        });
        assert!(wait(context, texels.read(context)).texels() == atlas.oem().texels());
        let (fixed, entries) = wait(context, read_sat(context, &sat));
        let wanted = atlas.sat(Scan::Blocks);
        assert_eq!(fixed, wanted.whole().fixed_point());
        assert!(entries == wanted.whole().entries());
        // Without the copies they differ.
        assert!(empty.sat(Scan::Blocks).whole().entries() != entries);

        let encoder = &mut context.device().create_command_encoder(&Default::default());
        let other = Oem::from_square(OemSize { inner: 8, border: 0 }, vec![[1.0; 4]; 64]);
        let other = OemPlanes::upload(context, &other).expect("small planes");
        assert!(matches!(copy(encoder, &other, &texels, tiles[0].0), Err(Error::Parameter(_))));
    });
}

/// A direction and, as bits, the tile's corner, side and domain.
type Query = [f32; 8];

const ENTRY: &str = "
@group(0) @binding(0) var atlas: texture_2d<f32>;
@group(0) @binding(1) var<storage, read> asked: array<array<vec4<f32>, 2>>;
@group(0) @binding(2) var<storage, read_write> answers: array<vec4<f32>>;
@compute @workgroup_size(64) fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&asked) {
        return;
    }
    let words = asked[id.x][1];
    let tile = AtlasTile(u32(words.x), u32(words.y), u32(words.z), 2u);
    if words.w == 0.0 {
        answers[id.x] = vec4<f32>(atlas_sphere(atlas, tile, asked[id.x][0].xyz), 1.0);
    } else {
        answers[id.x] = vec4<f32>(atlas_hemisphere(atlas, tile, asked[id.x][0].xyz), 1.0);
    }
}";

fn answers(context: &Context, atlas: &Atlas, source: &str, queries: &[Query]) -> Vec<[f32; 4]> {
    let (device, queue) = (context.device(), context.queue());
    let size = wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("atlas"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    // Nothing outside the tiles is read: not a number.
    let radiance: Vec<[f32; 4]> =
        atlas.oem().texels().iter().map(|[r, g, b, w]| [r / w, g / w, b / w, 1.0]).collect();
    queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&radiance),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(16 * SIDE), rows_per_image: None },
        size,
    );
    let view = texture.create_view(&Default::default());
    look::answers(context, source, &[wgpu::BindingResource::TextureView(&view)], queries)
}

#[test]
fn look_ups_in_wgsl_are_those_of_the_cpu() {
    let (atlas, tiles) = filled();
    let mut random = Random::new(8);
    let mut asked = Vec::new();
    for (tile, _) in &tiles {
        let [x, y] = tile.corner().map(|c| c as f32);
        let domain = if tile.domain() == Domain::Sphere { 0.0 } else { 1.0 };
        for direction in landmarks().into_iter().chain((0..200).map(|_| random.direction())) {
            let [dx, dy, dz] = direction.as_vec3().to_array();
            let exact = DVec3::new(f64::from(dx), f64::from(dy), f64::from(dz));
            let Some(wanted) = atlas.radiance(*tile, exact).expect("allocated") else { continue };
            let query: Query = [dx, dy, dz, 0.0, x, y, tile.size().bordered() as f32, domain];
            asked.push((query, wanted));
        }
    }
    let queries: Vec<Query> = asked.iter().map(|(query, _)| *query).collect();
    let octahedral = octagloss_shaders::source("common/octahedral.wgsl");
    let source = octahedral + include_str!("oem_lookup.wgsl") + include_str!("atlas.wgsl") + ENTRY;
    // Coordinates of up to 64 texels differ by a few units in the last place, 64 * 4 * 2^-24 of a texel at
    // most; neighbours differ by at most 30.
    let allowed = 30.0 * 64.0 * 16.0 / f64::from(1 << 24);
    let worst = |context: &Context, source: &str| {
        let found = answers(context, &atlas, source, &queries);
        let off = found.iter().zip(&asked).flat_map(|(found, (_, wanted))| {
            found.iter().zip(wanted).map(|(a, b)| f64::from((a - b).abs())).collect::<Vec<_>>()
        });
        // A NaN is kept.
        off.fold(0.0, |most, off| if off > most || off.is_nan() { off } else { most })
    };
    in_full("atlas look-ups", |context| {
        let off = worst(context, &source);
        assert!(!exceeds(off, allowed), "{off} on {}", context.describe());
        // A border too small by one texel is seen.
        let wrong = source.replace("u32(words.z), 2u)", "u32(words.z), 1u)");
        assert!(wrong != source && exceeds(worst(context, &wrong), allowed));
    });
}
