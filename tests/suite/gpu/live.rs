//! An environment as a renderer updates it: look-ups of its shader against the CPU's, before and after a
//! change of the light and of the rotation.

use super::{exceeds, in_full, wait};
use crate::support::common::{Look, Random, landmarks, texels};
use glam::{DMat3, DVec3};
use octagloss::internals::analysis::oracle;
use octagloss::internals::analysis::statistics::Statistics;
use octagloss::internals::filter::Filter;
use octagloss::internals::gpu::Context;
use octagloss::internals::gpu::device::readback;
use octagloss::internals::lobe::Lobe;
use octagloss::internals::reflector::{Reflector, ReflectorSettings};
use octagloss::{Environment, Error, Layout, LiveEnvironment, wgpu};

/// Roughness of the glossy look-ups.
const ROUGHNESS: f64 = 0.4;

const SHADER: &str = "
@group(1) @binding(0) var<storage, read> directions: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> answers: array<array<vec4<f32>, 2>>;

@compute @workgroup_size(1)
fn look_up(@builtin(workgroup_id) at: vec3<u32>) {
    let direction = directions[at.x].xyz;
    answers[at.x][0] = vec4<f32>(octagloss_radiance(direction, 0.4), 1.0);
    answers[at.x][1] = vec4<f32>(octagloss_irradiance(direction), 1.0);
}
";

/// Radiance and irradiance around `directions`, in the caller's own pipeline with an explicit layout.
pub(super) fn answers(context: &Context, live: &LiveEnvironment, directions: &[DVec3]) -> Vec<[[f32; 4]; 2]> {
    let device = context.device();
    let source = wgpu::ShaderSource::Wgsl((LiveEnvironment::wgsl(0) + SHADER).into());
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
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(live.bind_group_layout()), Some(&lists)],
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
    let buffer = |size, usage| {
        device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    };
    let count = directions.len() as u64;
    let asked = buffer(16 * count, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST);
    let words: Vec<f32> =
        directions.iter().flat_map(|direction| direction.as_vec3().extend(0.0).to_array()).collect();
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_ne_bytes()).collect();
    context.queue().write_buffer(&asked, 0, &bytes);
    let found = buffer(32 * count, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &lists,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: asked.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: found.as_entire_binding() },
        ],
    });
    context.submit(|encoder| {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, live.bind_group(), &[]);
        pass.set_bind_group(1, &group, &[]);
        pass.dispatch_workgroups(directions.len() as u32, 1, 1);
    });
    wait(context, readback::read(context, &found))
}

/// The first answer out of tolerance. Glossy: two engines, whose own tests have the derived bound; `allowed`
/// is the relative tolerance. Diffuse: harmonics up to order 4 and the cosine lobe differ by at most 0.034/pi
/// anywhere, which a source's whole energy, 4 pi times its mean radiance, can meet.
pub(super) fn difference(
    found: &[[[f32; 4]; 2]],
    environment: &Environment,
    source_from_world: DMat3,
    directions: &[DVec3],
    allowed: f64,
) -> Option<String> {
    let settings = ReflectorSettings { oem_size: Some(64), fitted: true, ..ReflectorSettings::default() };
    let reflector = Reflector::new(environment, &settings).expect("a small environment");
    let layout = environment.layout();
    let mean = Statistics::of(environment).mean;
    let far = |found: &[f32; 4], expected: [f64; 3], allowed: [f64; 3]| {
        (0..3).any(|c| exceeds((f64::from(found[c]) - expected[c]).abs(), allowed[c]))
    };
    directions.iter().zip(found).find_map(|(direction, [glossy, diffuse])| {
        let direction = source_from_world * *direction;
        let answer = reflector.query(direction, ROUGHNESS, Lobe::Ggx, Filter::Fitted(4)).expect("fitted");
        let expected = answer.radiance.map(f64::from);
        let cosine = oracle::reflect(environment, Lobe::Cosine, 1.0, direction);
        let wrong = far(glossy, expected, expected.map(|value| allowed * value))
            || far(diffuse, cosine, mean.map(|value| 4.0 * 0.034 * value));
        wrong.then(|| {
            format!("{layout:?} {direction}: {glossy:?} not {expected:?}, {diffuse:?} not {cosine:?}")
        })
    })
}

#[test]
fn updates_and_rotations_are_the_cpus() {
    in_full("live environment", |context| {
        let mut random = Random::new(51);
        let mut light =
            |layout| Environment::new(layout, texels(&mut random, Look::Suns, layout)).expect("fits");
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
            live.set_rotation(source_from_world);
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
        for size in [u32::MAX, 1 << 20] {
            let error = LiveEnvironment::new(context.device(), context.queue(), size).expect_err("too large");
            assert!(matches!(error, Error::Limit { .. }), "{error}");
        }
    });
}
