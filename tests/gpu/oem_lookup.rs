//! Compares the WGSL look-ups in mip-mapped octahedral maps with those of double precision.

use crate::look;
use glam::{DVec2, DVec3};
use octagloss_core::files::image::oem_mips::{Addressing, OemMips, Weights};
use octagloss_core::light::environment::Rgb;
use octagloss_core::light::oem::OemSize;
use octagloss_core::sphere::oem_lookup::{level_of_cell, quadratic_level, rectangular_place};
use octagloss_fixtures::adapters::{UNIT, exceeds, in_full};
use octagloss_fixtures::common::{Random, landmarks, oem};
use octagloss_fixtures::oracles::oem_mips::rectangular_level;
use octagloss_gpu::Context;

const INNER: u32 = 48;
const BORDER: u32 = 8;

/// A look-up: the cell's three directions and the level in the fourth word of the first.
type Query = [[f32; 4]; 3];

/// Entry point that answers each query by the levels of its cell in both layouts, without and with the
/// mirrored cell, and by the radiance at its level.
const ENTRY: &str = "
@group(0) @binding(0) var map: texture_2d_array<f32>;
@group(0) @binding(1) var<storage, read> asked: array<array<vec4<f32>, 3>>;
@group(0) @binding(2) var<storage, read_write> answers: array<array<vec4<f32>, 2>>;
@compute @workgroup_size(64) fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&asked) {
        return;
    }
    let own = asked[id.x][0].xyz;
    let right = asked[id.x][1].xyz;
    let below = asked[id.x][2].xyz;
    answers[id.x][0] = vec4<f32>(
        level_of_cell(own, right, below, INNER), quadratic_level(own, right, below, INNER),
        rectangular_level(own, right, below, INNER), 0.0);
    var place = vec3<f32>(quadratic_coordinates(own) * 2.0 - 1.0, 0.0);
    if textureNumLayers(map) == 2u {
        place = rectangular_place(own);
    }
    let found = oem_trilinear(map, i32(place.z), place.xy, INNER, BORDER, asked[id.x][0].w);
    answers[id.x][1] = vec4<f32>(found, 1.0);
}";

fn source() -> String {
    let entry = ENTRY.replace("INNER", &format!("{INNER}.0")).replace("BORDER", &format!("{BORDER}.0"));
    octagloss_shaders::source("common/octahedral.wgsl") + include_str!("oem_lookup.wgsl") + &entry
}

/// Runs `source` over the texture of `mips`.
fn answers(context: &Context, source: &str, mips: &OemMips, queries: &[Query]) -> Vec<[[f32; 4]; 2]> {
    let (device, queue) = (context.device(), context.queue());
    let levels = mips.levels();
    let side = levels[0].side;
    let layers = levels[0].texels.len() as u32 / (side * side);
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("map"),
        size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: layers },
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, own) in (0_u32..).zip(levels) {
        let words: Vec<[f32; 4]> = own.texels.iter().map(|[r, g, b]| [*r, *g, *b, 1.0]).collect();
        queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: level, ..texture.as_image_copy() },
            bytemuck::cast_slice(&words),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(16 * own.side),
                rows_per_image: Some(own.side),
            },
            wgpu::Extent3d { width: own.side, height: own.side, depth_or_array_layers: layers },
        );
    }
    let view = texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    });
    look::answers(context, source, &[wgpu::BindingResource::TextureView(&view)], queries)
}

/// Cells of half a texel to some texels around random directions, landmarks and cuts, at every level.
fn queries() -> Vec<Query> {
    let mut random = Random::new(41);
    let mut centres = landmarks();
    for k in 0..200 {
        // Close to the cuts of the lower hemisphere and to the equator.
        let angle = f64::from(k) * 0.0314;
        let shift = random.between(-0.02, 0.02);
        centres.push(DVec3::new(angle.cos(), -angle.sin().abs(), shift));
        centres.push(DVec3::new(shift, -angle.sin().abs(), angle.cos()));
        centres.push(DVec3::new(angle.cos(), shift, angle.sin()));
    }
    centres.extend((0..600).map(|_| random.direction()));
    let query = |(k, own): (usize, &DVec3), level: f32| {
        let size = 0.05 * (1.0 + (k % 4) as f64);
        let right = own.normalize().any_orthonormal_vector();
        let below = own.normalize().cross(right);
        let cell = [*own, own + right * size, own + below * (0.6 * size)];
        let mut query = cell.map(|d| d.as_vec3().extend(0.0).to_array());
        query[0][3] = level;
        query
    };
    // One level per workgroup: lavapipe of Mesa 22.3 reads the same level in neighbouring invocations.
    centres.truncate(centres.len() / look::GROUP * look::GROUP);
    let levels = [0.0, 0.25, 1.0, 1.5, 2.75, 3.0, 4.0];
    let all =
        levels.into_iter().flat_map(|level| centres.iter().enumerate().map(move |own| query(own, level)));
    all.collect()
}

fn cell_of(query: &Query) -> [DVec3; 3] {
    query.map(|[x, y, z, _]| DVec3::new(f64::from(x), f64::from(y), f64::from(z)))
}

/// Rounding of coordinates in [-1, 1]: the sum of three absolute values, 2 units; a quotient, which WGSL
/// rounds within 2.5 units in the last place, 5; the folding or the sum of two components, 2.
const COORDINATE: f64 = 9.0 * UNIT;

/// Error of a level. Corners in texels of level 0 are off by `COORDINATE` times half the side and three more
/// roundings of numbers up to the side; both ends of the longer side, of `length` texels, by sqrt(2) times
/// that in each of two coordinates. The logarithm is off by 3 units in the last place or 2^-21 (WGSL), and
/// its argument by 4 units.
fn level_bound(level: f64) -> f64 {
    let side = f64::from(INNER);
    let corner = COORDINATE * side / 2.0 + 3.0 * UNIT * side;
    let relative = 2.0 * 2_f64.sqrt() * corner / level.exp2();
    std::f64::consts::LOG2_E * (relative / (1.0 - relative) + 4.0 * UNIT)
        + 8.0 * UNIT
        + 6.0 * UNIT * level.abs()
}

/// Error of a look-up in texels of [0, 1]: the place in texels is off as a corner is; the sum, the product,
/// the border and the half round once and the division by a level's texel within 5 units of up to the side
/// with its border; each axis moves the value by at most 1 per texel. Three interpolations round
/// four times each, twice, and once more between levels.
fn radiance_bound() -> f64 {
    let side = f64::from(INNER + 2 * BORDER);
    2.0 * (COORDINATE * side / 2.0 + 9.0 * UNIT * side) + 28.0 * UNIT
}

/// The first query whose answer is off by more than its bound, in words.
fn difference(mips: &OemMips, queries: &[Query], answers: &[[[f32; 4]; 2]]) -> Option<String> {
    assert_eq!(queries.len(), answers.len());
    queries.iter().zip(answers).find_map(|(query, [levels, radiance])| {
        let cell = cell_of(query);
        let expected =
            [level_of_cell(cell, INNER), quadratic_level(cell, INNER), rectangular_level(cell, INNER)];
        let at = f64::from(query[0][3]);
        let exact = mips.look_up(mips.place(cell[0]), at, Addressing::Clamp);
        // On a cut or on the equator, rounding decides the side of a corner, which moves both coordinates.
        let is_clear = cell.iter().all(|d| [d.x, d.y, d.z].iter().all(|c| c.abs() > 1e-5));
        let far = is_clear
            && (0..3).any(|k| exceeds((f64::from(levels[k]) - expected[k]).abs(), level_bound(expected[k])));
        let wrong = (0..3).any(|c| exceeds((f64::from(radiance[c]) - exact[c]).abs(), radiance_bound()));
        (far || wrong).then(|| {
            format!("{query:?}: levels {levels:?} for {expected:?}, radiance {radiance:?} for {exact:?}")
        })
    })
}

fn maps() -> [OemMips; 2] {
    let mut random = Random::new(8);
    let mut texel = |_| -> Rgb { std::array::from_fn(|_| random.unit() as f32) };
    let noise: Vec<Rgb> = (0..INNER * INNER).map(&mut texel).collect();
    let quadratic =
        OemMips::quadratic(&oem(OemSize { inner: INNER, border: BORDER }, &noise), Weights::SolidAngle);
    let radiance = |direction: DVec3| {
        let (layer, uv) = rectangular_place(direction);
        let at = ((uv + 1.0) * (f64::from(INNER) / 2.0))
            .floor()
            .clamp(DVec2::ZERO, DVec2::splat(f64::from(INNER - 1)));
        let [r, g, b] = noise[(at.y * f64::from(INNER) + at.x) as usize];
        if layer == 0 { [r, g, b] } else { [b, r, g] }
    };
    [quadratic, OemMips::rectangular(INNER, BORDER, Weights::SolidAngle, radiance)]
}

#[test]
fn look_ups_are_those_of_double_precision() {
    in_full("look-ups in octahedral maps", |context| {
        let queries = queries();
        for mips in maps() {
            assert_eq!(mips.greatest_level(), Some(4));
            let found = answers(context, &source(), &mips, &queries);
            assert_eq!(difference(&mips, &queries, &found), None, "{}", context.describe());
        }
        // The comparison detects every wrong part of the shader.
        let [quadratic, rectangular] = maps();
        for (right, wrong, mips) in [
            ("vec3<f32>(1.0, -1.0, 1.0)", "vec3<f32>(1.0, 1.0, 1.0)", &quadratic),
            ("0.5 * log2(max(", "0.5 * log2(min(", &quadratic),
            ("oct_from_direction(direction) * 0.5 + 0.5", "direction.xz * 0.5 + 0.5", &quadratic),
            ("* (inner / 2.0) + border", "* (inner / 2.0)", &quadratic),
            ("min(fine + 1, i32(most))", "fine", &quadratic),
            ("at.xy + vec2<f32>(2.0, 0.0)", "at.xy + vec2<f32>(9.0, 0.0)", &rectangular),
            ("-at.x, 2.0 - at.y", "-at.x, 9.0 - at.y", &rectangular),
            ("vec3<f32>(p.z - p.x, p.x + p.z, 1.0)", "vec3<f32>(p.x - p.z, p.x + p.z, 1.0)", &rectangular),
        ] {
            let mutant = source().replacen(right, wrong, 1);
            assert_ne!(mutant, source(), "{right}");
            let found = answers(context, &mutant, mips, &queries);
            assert!(difference(mips, &queries, &found).is_some(), "{wrong} is not detected");
        }
    });
}
