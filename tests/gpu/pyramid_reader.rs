//! The files of `--target pyramid`, read by the shader code beside them, against the CPU's pyramid.

use crate::look;
use glam::{DMat3, DVec3};
use octagloss_core::bake::bake;
use octagloss_core::bake::dfg::ggx;
use octagloss_core::common::frame::Frame;
use octagloss_core::files::export::files::{Made, files};
use octagloss_core::files::io::pyramid_write::anisotropic_table;
use octagloss_core::files::recipe::Recipe;
use octagloss_core::files::target::{PyramidMap, Target};
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::pyramid::Pyramid;
use octagloss_fixtures::adapters::{exceeds, in_full};
use octagloss_fixtures::common::{Look, Random, landmarks, texels};
use octagloss_gpu::Context;
use octagloss_shaders::reader;
use wgpu::util::DeviceExt as _;

/// Hash of the reader in the head of its translations.
fn fnv(text: &str) -> u64 {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
    text.bytes().fold(0xcbf2_9ce4_8422_2325, step)
}

#[test]
fn translations_are_of_the_reader_of_pyramids() {
    for map in ["pyramid", "pyramid_cube"] {
        let made = reader(&format!("{map}.wgsl")).unwrap();
        for name in ["glsl", "hlsl", "metal"].map(|language| format!("{map}.{language}")) {
            let hash = format!("{:016x}", fnv(&made));
            assert!(reader(&name).unwrap().contains(&hash), "{name}: run tests/consumers/translate/run");
        }
    }
}

/// The files of `environment` on `map`, whose first level has `size` texels along an edge.
fn made(environment: &Environment, size: u32, map: PyramidMap) -> Vec<Made> {
    let recipe = Recipe { size: Some(size), map: Some(map), ..Recipe::default() };
    let plan = recipe.targeted(Target::named("pyramid").unwrap()).unwrap();
    files(&plan.plan, "sky", &bake(environment, &plan.settings).unwrap(), &[], reader).unwrap()
}

fn file<'a>(made: &'a [Made], path: &str) -> &'a [u8] {
    &made.iter().find(|file| file.path == path).unwrap_or_else(|| panic!("no {path}")).bytes
}

/// The file `bytes` as a texture.
fn texture(context: &Context, bytes: &[u8]) -> wgpu::Texture {
    let reader = ktx2::Reader::new(bytes).unwrap();
    let header = reader.header();
    assert_eq!(header.format, Some(ktx2::Format::R16G16B16A16_SFLOAT));
    let data: Vec<u8> = reader
        .levels()
        .flat_map(|level| {
            zstd::bulk::decompress(level.data, level.uncompressed_byte_length as usize).unwrap()
        })
        .collect();
    context.device().create_texture_with_data(
        context.queue(),
        &wgpu::TextureDescriptor {
            label: Some("file"),
            size: wgpu::Extent3d {
                width: header.pixel_width,
                height: header.pixel_height,
                depth_or_array_layers: header.layer_count.max(header.pixel_depth).max(header.face_count),
            },
            mip_level_count: header.level_count,
            sample_count: 1,
            dimension: if header.pixel_depth == 0 {
                wgpu::TextureDimension::D2
            } else {
                wgpu::TextureDimension::D3
            },
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::MipMajor,
        &data,
    )
}

/// What a surface is asked for: normal and roughness, view and f90, tangent and anisotropy.
type Query = [[f32; 4]; 3];

/// Reflection, albedo for f0 in w; radiance; irradiance; isotropic reflection.
type Answer = [[f32; 4]; 4];

const F0: [f32; 3] = [1.0, 0.5, 0.04];

/// What the reader reads.
struct Files {
    lights: wgpu::Buffer,
    /// Maps, tables, and that of reflections along a tangent.
    textures: [wgpu::TextureView; 3],
    linear: wgpu::Sampler,
}

impl Files {
    fn new(context: &Context, made: &[Made], size: u32, map: PyramidMap) -> Self {
        let light: serde_json::Value = serde_json::from_slice(file(made, "sky_pyramid.json")).unwrap();
        let uniform: Vec<f32> = serde_json::from_value(light["uniform"].clone()).unwrap();
        assert_eq!(uniform.len(), 256);
        let lights = context.device().create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("light"),
            contents: bytemuck::cast_slice(&uniform),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let rows = anisotropic_table(size, map).unwrap();
        let tables = match map {
            PyramidMap::Octahedral => "pyramid_tables.ktx2",
            PyramidMap::Cube => "pyramid_cube_tables.ktx2",
        };
        let textures = [file(made, "sky_pyramid.ktx2"), file(made, tables), &rows].map(|bytes| {
            let texture = texture(context, bytes);
            let is_cube = texture.depth_or_array_layers() == 6;
            let dimension = is_cube.then_some(wgpu::TextureViewDimension::Cube);
            texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() })
        });
        let linear = context.device().create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        Self { lights, textures, linear }
    }

    fn looked_up(&self, context: &Context, reader: &str, queries: &[Query]) -> Vec<Answer> {
        let source = format!(
            "{reader}
            @group(0) @binding(5) var<storage, read> asked: array<array<vec4<f32>, 3>>;
            @group(0) @binding(6) var<storage, read_write> answers: array<array<vec4<f32>, 4>>;
            @compute @workgroup_size(64) fn look(@builtin(global_invocation_id) id: vec3<u32>) {{
                if id.x < arrayLength(&asked) {{
                    let n = asked[id.x][0];
                    let v = asked[id.x][1];
                    let f0 = vec3<f32>({:?}, {:?}, {:?});
                    let t = asked[id.x][2];
                    let albedo = octagloss_albedo(dot(normalize(n.xyz), normalize(v.xyz)), n.w, t.w);
                    let light = octagloss_reflect(n.xyz, v.xyz, t.xyz, n.w, t.w, f0, v.w);
                    answers[id.x][0] = vec4<f32>(light, albedo.x);
                    answers[id.x][1] = vec4<f32>(octagloss_radiance(n.xyz, n.w), 1.0);
                    answers[id.x][2] = vec4<f32>(octagloss_irradiance(n.xyz), 1.0);
                    let round = octagloss_reflect_isotropic(n.xyz, v.xyz, n.w, f0, v.w);
                    answers[id.x][3] = vec4<f32>(round, 1.0);
                }}
            }}",
            F0[0], F0[1], F0[2]
        );
        let [maps, tables, rows] = &self.textures;
        let resources = [
            self.lights.as_entire_binding(),
            wgpu::BindingResource::TextureView(maps),
            wgpu::BindingResource::TextureView(tables),
            wgpu::BindingResource::Sampler(&self.linear),
            wgpu::BindingResource::TextureView(rows),
        ];
        look::answers(context, &source, &resources, queries)
    }
}

/// Of each look-up the greatest difference from `expected`, over its peak.
fn off(expected: &[Answer], found: &[Answer]) -> [f64; 4] {
    [0, 1, 2, 3].map(|k| {
        let channels = || {
            let pairs = expected.iter().zip(found);
            pairs.flat_map(move |(e, f)| (0..3).map(move |c| (f64::from(e[k][c]), f64::from(f[k][c]))))
        };
        let peak = channels().map(|(e, _)| e).fold(0.0, f64::max);
        // NaN counts as far off.
        channels()
            .map(|(e, f)| if f.is_nan() { f64::INFINITY } else { (e - f).abs() / peak })
            .fold(0.0, f64::max)
    })
}

/// Positions of reads are exact to a 512th of a texel in each direction and of a level, and texels differ by
/// less than the peak of the answers: .006. Weights are halves, which differ by a 2048th of themselves; the
/// absolute values of those of five reads sum to less than three, those of the reflection's ten to less than
/// eight: .004.
const TOLERANCE: f64 = 0.01;

#[test]
fn files_are_read_as_the_cpu_reads_its_pyramid() {
    in_full("pyramid reader", |context| {
        use PyramidMap::{Cube, Octahedral};
        for (size, look, degrees, map) in [
            (128, Look::Noise, 0.0, Octahedral),
            (64, Look::Suns, 40.0, Octahedral),
            (128, Look::Noise, 0.0, Cube),
            (64, Look::Suns, 40.0, Cube),
        ] {
            let mut random = Random::new(7);
            let layout = Layout::Panorama { width: 128, height: 64 };
            let light = texels(&mut random, look, layout);
            let environment = Environment::new(layout, light).unwrap().rotated_y(degrees).unwrap();
            let made = made(&environment, size, map);
            let pyramid = Pyramid::build(&environment, size).unwrap();
            let (pyramid, code) = match map {
                Octahedral => (pyramid, reader("pyramid.wgsl").unwrap()),
                Cube => (pyramid.on_cubes(), reader("pyramid_cube.wgsl").unwrap()),
            };
            let roughness = [0.0, 0.1, 0.25, 0.5, 0.8, 1.0];
            let mut normals = landmarks();
            normals.extend((0..200).map(|_| random.direction()));
            let anisotropy = [0.0, 0.5, 0.05, 0.9, 0.3];
            let asked: Vec<([DVec3; 3], f32, f32)> = (0..)
                .zip(normals)
                .map(|(k, normal)| {
                    let directions = [normal, random.direction() + 1.01 * normal, random.direction()];
                    (directions, roughness[k % 6], anisotropy[k % 5])
                })
                .collect();
            let queries: Vec<Query> = asked
                .iter()
                .map(|([n, v, t], r, a)| {
                    [(n, *r), (v, 0.9), (t, *a)].map(|(d, w)| d.as_vec3().extend(w).to_array())
                })
                .collect();
            let own = DMat3::from_rotation_y(degrees.to_radians()).transpose();
            let expected: Vec<Answer> = asked
                .iter()
                .map(|([n, v, t], r, a)| {
                    let frame = Frame::new(own * *n, own * *v, own * *t).unwrap();
                    let [albedo, _] = pyramid.albedo(frame.view.z as f32, *r, *a);
                    let with = |[r, g, b]: [f32; 3], w| [r, g, b, w];
                    [
                        with(pyramid.reflect(&frame, *r, *a, F0, 0.9), albedo),
                        with(pyramid.lobes(*r).radiance(own * *n), 1.0),
                        with(pyramid.irradiance(own * *n), 1.0),
                        with(pyramid.reflect(&frame, *r, 0.0, F0, 0.9), 1.0),
                    ]
                })
                .collect();
            let name = format!("{look:?} {size} {map} on {}", context.describe());
            let files = Files::new(context, &made, size, map);
            let found = files.looked_up(context, &code, &queries);
            let far = off(&expected, &found);
            assert!(far.iter().all(|off| !exceeds(*off, TOLERANCE)), "{name}: off by {far:?}");
            for (e, f) in expected.iter().zip(&found) {
                assert!((e[0][3] - f[0][3]).abs() < 2e-3, "{name}: albedo {} for {}", f[0][3], e[0][3]);
            }
            // The comparison detects a reader of the wrong square, border or row. A smooth sky is nearly the
            // same in several.
            let own = match map {
                Octahedral => vec![
                    ("map % octagloss_SQUARES", "(map + 1u) % octagloss_SQUARES"),
                    ("octagloss_SQUARES - 1u, octagloss_last_mip()", "0u, octagloss_last_mip()"),
                    ("1.0 + floor(", "2.0 + floor("),
                    ("(0.5 * inner / octagloss_map_side())", "(0.47 * inner / octagloss_map_side())"),
                    ("27u + row", "26u + row"),
                ],
                Cube => vec![
                    ("f32(map)", "f32(map + 1u)"),
                    ("LEVEL_OCTAVES = 1.0f", "LEVEL_OCTAVES = 0.9f"),
                    ("(1.0, 0.66666667", "(0.8, 0.66666667"),
                ],
            };
            let tables = [("(864.0, 40.0)", "(864.0, 39.0)"), ("1.0 + f32(layer)", "3.0 + f32(layer)")];
            // Both maps read the tables by the same code.
            let tables = tables.into_iter().filter(|_| map == Octahedral);
            for (right, wrong) in own.into_iter().chain(tables).filter(|_| look == Look::Noise) {
                assert!(code.contains(right), "{right}");
                let found = files.looked_up(context, &code.replace(right, wrong), &queries);
                let far = off(&expected, &found);
                assert!(far.iter().any(|off| exceeds(*off, TOLERANCE)), "{wrong} is not detected: {far:?}");
            }
        }
    });
}

/// The albedo by the integral, at places dense at both ends of both axes, none of them a node.
#[test]
fn white_furnaces_are_within_a_thousandth() {
    let evenly = |many: u32| (0..many).map(move |k| (f64::from(k) + 0.5) / f64::from(many));
    let cosines: Vec<f64> =
        evenly(33).map(|t| 1e-4_f64.powf(1.0 - t)).chain(evenly(21)).chain([1.0]).collect();
    let roughness: Vec<f64> = evenly(31).map(|t| t * t).chain(evenly(23)).chain([0.0, 1.0]).collect();
    let places: Vec<[f64; 2]> =
        roughness.iter().flat_map(|r| cosines.iter().map(move |c| [*r, *c])).collect();
    let expected: Vec<[f64; 2]> = places.iter().map(|[r, c]| ggx(*c, *r)).collect();
    let queries: Vec<Query> = places
        .iter()
        .map(|[r, c]| {
            let (r, c) = (*r as f32, *c as f32);
            [[0.0, 0.0, 1.0, r], [(1.0 - c * c).sqrt(), 0.0, c, 0.9], [0.0; 4]]
        })
        .collect();
    in_full("white furnace", |context| {
        let (size, octahedral) = (64, PyramidMap::Octahedral);
        let white = Environment::new(Layout::Panorama { width: 8, height: 4 }, vec![[1.0; 3]; 32]).unwrap();
        let files = Files::new(context, &made(&white, size, octahedral), size, octahedral);
        let found = files.looked_up(context, &reader("pyramid.wgsl").unwrap(), &queries);
        for (([r, c], [scale, bias]), found) in places.iter().zip(&expected).zip(&found) {
            let name = format!("r {r} n.v {c} on {}", context.describe());
            let off = f64::from(found[0][3]) - scale;
            assert!(!exceeds(off.abs(), 1e-3), "{name}: albedo off by {off}");
            // Views below 0.01 are turned up to it.
            for (k, f0) in F0.into_iter().enumerate().filter(|_| *c >= 0.01) {
                let off = f64::from(found[3][k]) - f64::from(f0) * scale - 0.9 * bias;
                assert!(!exceeds(off.abs(), 1.5e-3), "{name}: reflection off by {off}");
            }
        }
    });
}
