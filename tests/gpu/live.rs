//! An environment as a renderer updates it: look-ups of its shader against the CPU's, before and after a
//! change of the light and of the rotation.

use glam::{DMat3, DVec3};
use octagloss_core::analysis::oracle::Oracle;
use octagloss_core::analysis::statistics::Statistics;
use octagloss_core::common::error::Error;
use octagloss_core::cpu::reflector::{Reflector, ReflectorSettings};
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::Filter;
use octagloss_fixtures::adapters::{exceeds, in_full, wait, with_passes};
use octagloss_fixtures::common::{Look, Random, environment, landmarks, texels};
use octagloss_gpu::Context;
use octagloss_gpu::block_on;
use octagloss_gpu::device::readback;
use octagloss_gpu::engine::GpuReflector;
use octagloss_gpu::live::LiveEnvironment;
use octagloss_gpu::shadow::ShadowMap;

/// Roughness of the glossy look-ups.
const ROUGHNESS: f64 = 0.4;

/// A shader that looks `names` up, each in the group of its place.
fn shader(names: &[&str]) -> String {
    let count = names.len();
    let look_up = |(k, name): (usize, &&str)| {
        format!(
            "answers[at.x * {count}u + {k}u][0] = vec4<f32>({name}_radiance(direction, 0.4), 1.0);\n\
             answers[at.x * {count}u + {k}u][1] = vec4<f32>({name}_irradiance(direction), 1.0);\n"
        )
    };
    shader_of(count, &names.iter().enumerate().map(look_up).collect::<String>())
}

/// A shader that writes answers by `look_ups`, with lists in `group`.
pub(super) fn shader_of(group: usize, look_ups: &str) -> String {
    format!(
        "@group({group}) @binding(0) var<storage, read> directions: array<vec4<f32>>;
@group({group}) @binding(1) var<storage, read_write> answers: array<array<vec4<f32>, 2>>;

@compute @workgroup_size(1)
fn look_up(@builtin(workgroup_id) at: vec3<u32>) {{
    let direction = directions[at.x].xyz;
    let roughness = directions[at.x].w;
{look_ups}}}
"
    )
}

/// Radiance and irradiance around a direction.
pub(super) type Answer = [[f32; 4]; 2];

/// Answers of `live` around `directions`, in the caller's own pipeline with an explicit layout.
pub(super) fn answers(context: &Context, live: &LiveEnvironment, directions: &[DVec3]) -> Vec<Answer> {
    let source = LiveEnvironment::wgsl(0) + &shader(&["octagloss"]);
    let look_ups = look_ups(context, source, &[live.bind_group_layout()], 1);
    look_ups.answers(context, &[live.bind_group()], directions, ROUGHNESS)
}

/// A pipeline of the caller's own that looks environments up, the layout of its lists, and its answers for a
/// direction.
pub(super) struct LookUps {
    pipeline: wgpu::ComputePipeline,
    lists: wgpu::BindGroupLayout,
    count: u64,
}

/// Look-ups by the shader `source`, whose groups have `layouts` in turn and the lists: `count` answers for
/// a direction.
pub(super) fn look_ups(
    context: &Context,
    source: String,
    layouts: &[&wgpu::BindGroupLayout],
    count: u64,
) -> LookUps {
    let device = context.device();
    let source = wgpu::ShaderSource::Wgsl(source.into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let entry = |binding, read_only| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let lists = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[entry(0, true), entry(1, false)],
    });
    let groups: Vec<_> = layouts.iter().copied().chain([&lists]).map(Some).collect();
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &groups,
        ..Default::default()
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: Some(&layout),
        module: &module,
        entry_point: None,
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    LookUps { pipeline, lists, count }
}

impl LookUps {
    /// For each direction in turn, all answers at `roughness`, with the resources of `groups`.
    pub(super) fn answers(
        &self,
        context: &Context,
        groups: &[&wgpu::BindGroup],
        directions: &[DVec3],
        roughness: f64,
    ) -> Vec<Answer> {
        let Self { pipeline, lists, count } = self;
        let device = context.device();
        let buffer = |size, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let places = directions.len() as u64;
        let asked = buffer(16 * places, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST);
        let words: Vec<f32> = directions
            .iter()
            .flat_map(|direction| direction.as_vec3().extend(roughness as f32).to_array())
            .collect();
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_ne_bytes()).collect();
        context.queue().write_buffer(&asked, 0, &bytes);
        let found = buffer(32 * count * places, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: lists,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: asked.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: found.as_entire_binding() },
            ],
        });
        context.submit(|encoder| {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(pipeline);
            let bound = groups.iter().copied().chain([&group]);
            (0..).zip(bound).for_each(|(place, bound)| pass.set_bind_group(place, bound, &[]));
            pass.dispatch_workgroups(directions.len() as u32, 1, 1);
        });
        wait(context, readback::read(context, &found))
    }
}

/// The first answer out of tolerance. Glossy: two engines, whose own tests have the derived bound; `allowed`
/// is the relative tolerance. Diffuse: the cosine level's texels and cells are about 0.05 wide, so a source's
/// whole energy, 4 pi times its mean radiance, can be off by a hundredth of 1/pi.
pub(super) fn difference(
    found: &[Answer],
    environment: &Environment,
    source_from_world: DMat3,
    directions: &[DVec3],
    allowed: f64,
) -> Option<String> {
    let settings = ReflectorSettings { oem_size: Some(64), pyramid: true, ..ReflectorSettings::default() };
    let reflector = Reflector::new(environment, &settings).expect("a small environment");
    let layout = environment.layout();
    let mean = Statistics::new(environment).mean;
    let far = |found: &[f32; 4], expected: [f64; 3], allowed: [f64; 3]| {
        (0..3).any(|c| exceeds((f64::from(found[c]) - expected[c]).abs(), allowed[c]))
    };
    directions.iter().zip(found).find_map(|(direction, [glossy, diffuse])| {
        let direction = source_from_world * *direction;
        let answer = reflector.query(direction, ROUGHNESS, Lobe::Ggx, Filter::Pyramid).expect("a pyramid");
        let expected = answer.radiance.map(f64::from);
        let cosine = Oracle::new(environment).reflect(Lobe::Cosine, 1.0, direction).expect("valid");
        let wrong = far(glossy, expected, expected.map(|value| allowed * value))
            || far(diffuse, cosine, mean.map(|value| 4.0 * 0.01 * value));
        wrong.then(|| {
            format!("{layout:?} {direction}: {glossy:?} not {expected:?}, {diffuse:?} not {cosine:?}")
        })
    })
}

#[test]
fn updates_and_rotations_are_the_cpus() {
    in_full("live environment", |context| {
        let mut random = Random::new(51);
        let mut light = |layout| environment(layout, texels(&mut random, Look::Suns, layout));
        let panorama = light(Layout::Panorama { width: 64, height: 32 });
        let cube = light(Layout::Cube { size: 16 });
        // Rounded up to 64.
        let mut live = LiveEnvironment::new(context.device(), context.queue(), 50).expect("small tables");
        let directions = &landmarks()[..];
        let turned = DMat3::from_rotation_y(1.0) * DMat3::from_rotation_x(0.5);
        for (environment, source_from_world) in
            [(&panorama, DMat3::IDENTITY), (&cube, turned), (&panorama, turned)]
        {
            let texture = live.upload(environment).expect("a small texture");
            live.set_rotation(source_from_world).expect("a rotation");
            let mut encoder = context.device().create_command_encoder(&Default::default());
            live.update(&mut encoder, &texture).expect("an environment");
            context.queue().submit([encoder.finish()]);
            let found = answers(context, &live, directions);
            let judge = |matrix| difference(&found, environment, matrix, directions, 1e-3);
            assert_eq!(judge(source_from_world), None, "on {}", context.describe());
            assert!(
                judge(source_from_world * DMat3::from_rotation_y(0.2)).is_some(),
                "another rotation shows"
            );
        }
    });
}

#[test]
fn textures_of_no_layout_are_refused() {
    in_full("live refusals", |context| {
        let mut live = LiveEnvironment::new(context.device(), context.queue(), 16).expect("small tables");
        let mut refused = |width, height, depth_or_array_layers| {
            let texture = context.device().create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width, height, depth_or_array_layers },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba16Float,
                usage: wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            let mut encoder = context.device().create_command_encoder(&Default::default());
            live.update(&mut encoder, &texture)
        };
        for (width, height, layers) in [(16, 9, 1), (8, 16, 1), (16, 8, 6), (8, 8, 2)] {
            let error = refused(width, height, layers).expect_err("no environment");
            assert!(
                matches!(&error, Error::Parameter(text) if text.contains(&format!("{width} x {height}")))
            );
        }
        refused(8, 8, 6).expect("a cube");
        refused(8, 8, 1).expect("an octahedral map");
        refused(16, 8, 1).expect("a panorama");
        for size in [u32::MAX, 2049] {
            let error = LiveEnvironment::new(context.device(), context.queue(), size).expect_err("too large");
            assert!(error.to_string().contains("choose 1 to 2048"), "{error}");
        }
    });
}

#[test]
fn siblings_share_buffers_but_not_light() {
    in_full("sibling environments", |context| {
        let mut random = Random::new(52);
        let layout = Layout::Cube { size: 16 };
        let mut light = || environment(layout, texels(&mut random, Look::Suns, layout));
        let (first, second) = (light(), light());
        let directions = &landmarks()[..];
        let update = |live: &mut LiveEnvironment, texture: &wgpu::Texture| {
            let mut encoder = context.device().create_command_encoder(&Default::default());
            live.update(&mut encoder, texture).expect("an environment");
            context.queue().submit([encoder.finish()]);
        };
        let mut left = LiveEnvironment::new(context.device(), context.queue(), 64).expect("small tables");
        let textures = [&first, &second].map(|light| left.upload(light).expect("a small texture"));
        let alone = textures.each_ref().map(|texture| {
            update(&mut left, texture);
            answers(context, &left, directions)
        });
        assert_ne!(alone[0], alone[1], "the lights differ");

        // `left` has the second light.
        let mut right = left.sibling();
        let names = ["left", "right"];
        let source: String = (0..)
            .zip(names)
            .map(|(group, name)| LiveEnvironment::wgsl_named(name, group).expect("a name"))
            .collect();
        let layouts = [left.bind_group_layout(), right.bind_group_layout()];
        let both = look_ups(context, source + &shader(&names), &layouts, 2);
        for [own, other] in [[1, 0], [0, 0], [0, 1]] {
            update(&mut right, &textures[other]);
            update(&mut left, &textures[own]);
            let groups = [left.bind_group(), right.bind_group()];
            let found = both.answers(context, &groups, directions, ROUGHNESS);
            // The same code over the same words.
            for (k, light) in [own, other].into_iter().enumerate() {
                let found: Vec<Answer> = found.iter().skip(k).step_by(2).copied().collect();
                assert!(found == alone[light], "{} on {}", names[k], context.describe());
            }
        }
        // Siblings of an environment without light have none to share.
        let fresh = LiveEnvironment::new(context.device(), context.queue(), 64).expect("small tables");
        let mut early = fresh.sibling();
        update(&mut early, &textures[0]);
        assert!(answers(context, &early, directions) == alone[0]);
        assert!(LiveEnvironment::wgsl_named("2nd", 0).is_err());
        for wrong in [DMat3::NAN, DMat3::ZERO, 1.01 * DMat3::IDENTITY] {
            let error = left.set_rotation(wrong).expect_err("no rotation").to_string();
            assert!(error.contains("`source_from_world`"), "{error}");
        }
    });
}

#[test]
fn textures_that_shaders_cannot_read_are_refused() {
    in_full("live textures", |context| {
        let mut live = LiveEnvironment::new(context.device(), context.queue(), 16).expect("small tables");
        let sound = wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: 8, height: 8, depth_or_array_layers: 6 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        let mut update = |descriptor: &wgpu::TextureDescriptor<'_>| {
            let texture = context.device().create_texture(descriptor);
            let mut encoder = context.device().create_command_encoder(&Default::default());
            let outcome = live.update(&mut encoder, &texture);
            context.queue().submit([encoder.finish()]);
            outcome
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let one = wgpu::Extent3d { width: 8, height: 8, depth_or_array_layers: 1 };
        let wrong = [
            (
                wgpu::TextureDescriptor { usage: wgpu::TextureUsages::COPY_DST, ..sound.clone() },
                "TEXTURE_BINDING",
            ),
            (wgpu::TextureDescriptor { usage: attachment, ..sound.clone() }, "TEXTURE_BINDING"),
            (wgpu::TextureDescriptor { dimension: wgpu::TextureDimension::D3, ..sound.clone() }, "D2"),
            (
                wgpu::TextureDescriptor {
                    sample_count: 4,
                    size: one,
                    usage: sound.usage | attachment,
                    ..sound.clone()
                },
                "one sample",
            ),
        ];
        let formats = [
            wgpu::TextureFormat::Rgba8Uint,
            wgpu::TextureFormat::Rgba32Sint,
            wgpu::TextureFormat::Depth32Float,
            wgpu::TextureFormat::R32Float,
            wgpu::TextureFormat::Rg16Float,
        ];
        let of_format = |format| (wgpu::TextureDescriptor { format, ..sound.clone() }, "the format ");
        for (descriptor, words) in wrong.into_iter().chain(formats.map(of_format)) {
            let error = update(&descriptor).expect_err(words);
            assert!(matches!(&error, Error::Parameter(text) if text.contains(words)), "{words}: {error}");
        }
        let formats = [
            wgpu::TextureFormat::Rgba16Float,
            wgpu::TextureFormat::Rgba32Float,
            wgpu::TextureFormat::Rg11b10Ufloat,
            wgpu::TextureFormat::Rgb9e5Ufloat,
            wgpu::TextureFormat::Rgba8Unorm,
        ];
        for format in formats {
            update(&wgpu::TextureDescriptor { format, ..sound.clone() }).expect("colours");
        }
        update(&wgpu::TextureDescriptor { mip_level_count: 3, ..sound.clone() }).expect("its first level");
    });
}

#[test]
fn sizes_and_counts_are_named_as_the_caller_names_them() {
    in_full("live sizes", |context| {
        let live = |size| LiveEnvironment::new(context.device(), context.queue(), size);
        let message = live(0).expect_err("no texels").to_string();
        assert!(message.contains("`size` is 0"), "{message}");
        live(1).expect("rounded up");
        let error = live(u32::MAX).expect_err("too large").to_string();
        assert!(error.contains("`size` is 4294967295; choose 1 to 2048"), "{error}");
        for size in [0, 1, 7, u32::MAX] {
            let error = ShadowMap::new(context.device(), context.queue(), size).expect_err("no such map");
            assert!(error.to_string().contains(&format!("`size` {size}; choose an even number")), "{error}");
        }
        let mut shadow = ShadowMap::new(context.device(), context.queue(), 8).expect("a small map");
        let mut encoder = context.device().create_command_encoder(&Default::default());
        for (lamp, near, name) in [(DVec3::NAN, 0.1, "`lamp`"), (DVec3::ZERO, f32::NAN, "`near`")] {
            let error = shadow.draw(&mut encoder, lamp, near, |_, _| {}).expect_err(name);
            assert!(error.to_string().contains(name), "{error}");
        }
    });
}

#[test]
fn vectors_without_a_direction_are_refused_on_the_gpu() {
    with_passes("no directions", |context, engine| {
        let layout = Layout::Cube { size: 4 };
        let environment = environment(layout, vec![[1.0; 3]; layout.texel_count()]);
        let settings = ReflectorSettings { oem_size: Some(32), ..ReflectorSettings::default() };
        let reflector = GpuReflector::new(engine, &environment, &settings).expect("a small OEM");
        for wrong in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
            for filter in [Filter::Adaptive(0.01), Filter::Pyramid, Filter::Box] {
                let asked = [DVec3::Y, wrong];
                let answer = block_on(Some(context), reflector.query(&asked, Lobe::Ggx, 0.5, filter));
                let error = answer.and_then(|answer| answer).expect_err("no direction").to_string();
                assert!(error.starts_with("direction 1 is "), "{error}");
            }
        }
    });
}
