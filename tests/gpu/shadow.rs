//! Shadows of a lamp by an octahedral map of depth, against rays from the lamp.

use glam::{DVec2, DVec3};
use octagloss_core::sphere::octahedral::{direction_from_oct, oct_from_direction, wrap_oct};
use octagloss_fixtures::adapters::{in_full, wait};
use octagloss_fixtures::common::Random;
use octagloss_fixtures::meshes::{closed, mesh};
use octagloss_fixtures::oracles::triangles::corners_of;
use octagloss_gpu::Context;
use octagloss_gpu::device::readback;
use octagloss_gpu::shadow::ShadowMap;
use octagloss_gpu::triangles::{Corner, Triangles};
use std::f64::consts::SQRT_2;
use wgpu::util::DeviceExt as _;

/// Texels along an edge of the map.
const SIZE: u32 = 128;

const NEAR: f32 = 0.05;

/// Share of the distance by which receivers are taken to be nearer.
const BIAS: f64 = 1e-3;

/// Corners are snapped to a sixteenth of a pixel; a plane's depth at distance 1 changes by at most 2 in a
/// unit of the square, of which a pixel is 2 / SIZE.
const SNAP: f64 = SQRT_2 / 16.0 * 2.0 * 2.0 / SIZE as f64;

/// The look-up's allowance for it on the receiver, which is rounded up.
const SLACK: f64 = 0.36 / SIZE as f64;

/// Rounding of depths of at most 1.
const ROUNDING: f64 = 4e-6;

const INTO_MAP: &str = "
@vertex fn project(@location(0) position: vec3<f32>) -> @builtin(position) vec4<f32> {
    return octagloss_direct_position(position);
}
@fragment fn keep(@builtin(position) position: vec4<f32>) {
    if !octagloss_direct_owns(position) {
        discard;
    }
}
";

const LOOK_UP: &str = "
struct Point {
    position: vec4<f32>,
    normal: vec4<f32>,
}
@group(1) @binding(0) var<storage, read> points: array<Point>;
@group(1) @binding(1) var<storage, read_write> shares: array<f32>;
@compute @workgroup_size(64)
fn look_up(@builtin(global_invocation_id) at: vec3<u32>) {
    if at.x < arrayLength(&points) {
        shares[at.x] = octagloss_lit(points[at.x].position.xyz, points[at.x].normal.xyz);
    }
}
";

/// A point on a triangle of a scene.
struct Receiver {
    triangle: usize,
    position: DVec3,
    normal: DVec3,
}

/// What the lamp must give a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Light {
    Lit,
    Shadowed,
    /// Within two texels of an edge, or of where surfaces meet.
    Either,
}

fn position(corner: Corner) -> DVec3 {
    DVec3::from_array(corner.position.map(f64::from))
}

/// A closed surface that receives shadows, and triangles in it that cast and receive them, some across folds.
fn scene() -> Triangles {
    let room = closed(1, Some(5), 3.0..6.0);
    let mut random = Random::new(31);
    let mut triangles: Vec<[DVec3; 3]> =
        (0..room.count()).map(|k| corners_of(&room, k).map(position)).collect();
    for axis in DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
        let across = DVec3::new(axis.z, axis.x, axis.y);
        let beside = 0.9 * axis.cross(across);
        let centre = 1.5 * axis + 0.4 * random.direction();
        triangles.push(
            [across, -0.6 * across + beside, -0.6 * across - beside]
                .map(|offset| centre + offset + 0.3 * random.direction()),
        );
    }
    mesh(&triangles)
}

/// Points on the triangles, more on larger ones.
fn receivers(triangles: &Triangles, count: usize) -> Vec<Receiver> {
    let mut random = Random::new(8);
    (0..count)
        .map(|k| {
            let triangle = k % triangles.count();
            let [a, b, c] = corners_of(triangles, triangle).map(position);
            let (s, t) = (random.between(0.0, 1.0), random.between(0.0, 1.0));
            let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
            let normal = (b - a).cross(c - a).normalize();
            Receiver { triangle, position: a + s * (b - a) + t * (c - a), normal }
        })
        .collect()
}

/// Whether a triangle is between the origin and a receiver on another one (Moeller and Trumbore 1997).
fn is_between([a, b, c]: [DVec3; 3], to: DVec3) -> bool {
    let (ab, ac) = (b - a, c - a);
    let across = to.cross(ac);
    let determinant = ab.dot(across);
    let s = (-a).dot(across) / determinant;
    let along = (-a).cross(ab);
    let t = to.dot(along) / determinant;
    s >= 0.0 && t >= 0.0 && s + t <= 1.0 && (0.0..1.0).contains(&(ac.dot(along) / determinant))
}

/// What the lamp at `lamp` must give: the same all over the four texels around the receiver's direction, also
/// for triangles that are moved by [`SNAP`].
///
/// On the four texels all that decides is linear but for kinks along their sides and diagonals: edges of
/// triangles, and depths of their planes. The signs at the texels' nine corners hold in between.
fn light(triangles: &Triangles, lamp: DVec3, receiver: &Receiver) -> Light {
    let to = receiver.position - lamp;
    let texel = ((oct_from_direction(to) * 0.5 + 0.5) * f64::from(SIZE) - 0.5).floor();
    let corners: Vec<DVec3> = (0..9)
        .map(|k| {
            let place = texel + DVec2::new(f64::from(k % 3), f64::from(k / 3));
            let p = direction_from_oct(wrap_oct(place * (2.0 / f64::from(SIZE)) - 1.0));
            p / p.abs().element_sum()
        })
        .collect();
    let near = f64::from(NEAR);
    let distance = receiver.normal.dot(to);
    let own = |p: DVec3| near * receiver.normal.dot(p) / distance;
    let slack = near * SLACK / distance.abs();
    let here = near / to.abs().element_sum();
    // The look-up bounds the slope of planes that are seen from their edges.
    let mut is_decided = corners.iter().all(|p| (0.5..=2.0).contains(&(own(*p) / here)));
    let mut shadowed = false;
    for index in (0..triangles.count()).filter(|index| *index != receiver.triangle) {
        let [a, b, c] = corners_of(triangles, index).map(|corner| position(corner) - lamp);
        let determinant = a.dot(b.cross(c));
        let edges = [b.cross(c), c.cross(a), a.cross(b)].map(|normal| normal * determinant.signum());
        let is = |inside: f64| move |edge: &DVec3, p: &DVec3| inside * edge.dot(*p) > SNAP * edge.length();
        if edges.iter().any(|edge| corners.iter().all(|p| is(-1.0)(edge, p))) {
            continue;
        }
        let covers = edges.iter().all(|edge| corners.iter().all(|p| is(1.0)(edge, p)));
        let normal = (b - a).cross(c - a).normalize();
        let depth = |p: &DVec3| near * normal.dot(*p) / normal.dot(a);
        let moved = near * SNAP / normal.dot(a).abs() + ROUNDING;
        let is_nearer = |p: &DVec3| (depth(p) - moved) * (1.0 - BIAS) > own(*p) + slack + ROUNDING;
        let is_farther = |p: &DVec3| depth(p) < own(*p) && depth(p) + moved < own(*p) + slack;
        if covers && corners.iter().all(is_nearer) {
            shadowed = true;
        } else if !corners.iter().all(is_farther) {
            is_decided = false;
        }
    }
    match (is_decided, shadowed) {
        (false, _) => Light::Either,
        (true, true) => Light::Shadowed,
        (true, false) => Light::Lit,
    }
}

/// Describes the first receiver whose share of the light is wrong.
fn difference(expected: &[Light], shares: &[f32]) -> Option<String> {
    assert_eq!(expected.len(), shares.len());
    let wrong = |(k, (light, share)): (usize, (&Light, &f32))| {
        // Weights of four texels, which round.
        let allowed = match light {
            Light::Lit => 1.0 - 1e-5..=1.0 + 1e-5,
            Light::Shadowed => 0.0..=0.0,
            Light::Either => 0.0..=1.0 + 1e-5,
        };
        (!allowed.contains(share)).then(|| format!("receiver {k} has {share}, not {light:?}"))
    };
    expected.iter().zip(shares).enumerate().find_map(wrong)
}

/// Draws the map of a lamp at `lamp` in the scene, and looks up the shares of the receivers.
fn shares(
    context: &Context,
    triangles: &Triangles,
    lamp: DVec3,
    receivers: &[Receiver],
) -> octagloss_core::common::error::Result<Vec<f32>> {
    let device = context.device();
    let buffer = |contents: &[u8], usage| {
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    };
    let corners = buffer(bytemuck::cast_slice(triangles.corners()), wgpu::BufferUsages::VERTEX);
    let indices = buffer(bytemuck::cast_slice(triangles.indices()), wgpu::BufferUsages::INDEX);
    let mut map = ShadowMap::new(device, context.queue(), SIZE)?;
    map.set_bias(BIAS as f32)?;
    let into_map = into_map(device, &map);
    let words: Vec<[f32; 4]> = receivers
        .iter()
        .flat_map(|receiver| [receiver.position, receiver.normal].map(|v| v.as_vec3().extend(0.0).to_array()))
        .collect();
    let points = buffer(bytemuck::cast_slice(&words), wgpu::BufferUsages::STORAGE);
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let found = buffer(&vec![0; 4 * receivers.len()], usage);
    let source = wgpu::ShaderSource::Wgsl((ShadowMap::wgsl(0) + LOOK_UP).into());
    let look_up = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source }),
        entry_point: None,
        compilation_options: Default::default(),
        cache: None,
    });
    let light = map.bind_group_of(&look_up.get_bind_group_layout(0));
    let resources = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &look_up.get_bind_group_layout(1),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: points.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: found.as_entire_binding() },
        ],
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    map.draw(&mut encoder, lamp, NEAR, |pass, octant| {
        pass.set_pipeline(&into_map);
        pass.set_bind_group(0, octant, &[]);
        pass.set_vertex_buffer(0, corners.slice(..));
        pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..triangles.indices().len() as u32, 0, 0..1);
    })?;
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&look_up);
    pass.set_bind_group(0, &light, &[]);
    pass.set_bind_group(1, &resources, &[]);
    pass.dispatch_workgroups((receivers.len() as u32).div_ceil(64), 1, 1);
    drop(pass);
    context.queue().submit([encoder.finish()]);
    Ok(wait(context, readback::read(context, &found)))
}

fn into_map(device: &wgpu::Device, map: &ShadowMap) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        bind_group_layouts: &[Some(map.draw_layout())],
        ..Default::default()
    });
    let source = wgpu::ShaderSource::Wgsl((ShadowMap::draw_wgsl(0) + INTO_MAP).into());
    let module = &device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let compilation_options = wgpu::PipelineCompilationOptions::default;
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: None,
            compilation_options: compilation_options(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Corner>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &wgpu::vertex_attr_array![0 => Float32x3],
            })],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: ShadowMap::DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: None,
            compilation_options: compilation_options(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    })
}

#[test]
fn shadows_are_those_of_rays_from_the_lamp() {
    let triangles = scene();
    let receivers = receivers(&triangles, 4000);
    in_full("shadows", |context| {
        for lamp in [DVec3::ZERO, DVec3::new(0.3, -0.2, 0.25)] {
            let expected: Vec<Light> =
                receivers.iter().map(|receiver| light(&triangles, lamp, receiver)).collect();
            let count = |light: Light| expected.iter().filter(|one| **one == light).count();
            let [lit, shadowed, either] = [Light::Lit, Light::Shadowed, Light::Either].map(count);
            assert!(
                lit > 1000 && shadowed > 300 && either < 1200,
                "{lit} lit, {shadowed} not, {either} open"
            );
            // The band leaves out no ray's answer that the rest contradicts.
            for (light, receiver) in expected.iter().zip(&receivers) {
                let blocked =
                    (0..triangles.count()).filter(|index| *index != receiver.triangle).any(|index| {
                        let corners = corners_of(&triangles, index).map(|corner| position(corner) - lamp);
                        is_between(corners, receiver.position - lamp)
                    });
                let of_ray = if blocked { Light::Shadowed } else { Light::Lit };
                assert!(*light == Light::Either || *light == of_ray, "{light:?}, not {of_ray:?}");
            }
            let shares = shares(context, &triangles, lamp, &receivers).expect("shares");
            assert_eq!(difference(&expected, &shares), None, "lamp at {lamp}");
            // Within the band, some receivers are lit in part.
            assert!(shares.iter().any(|share| (0.2..0.8).contains(share)));
            // The comparison sees one wrong receiver, and another lamp.
            for light in [Light::Lit, Light::Shadowed] {
                let place = expected.iter().position(|one| *one == light).expect("both");
                let mut wrong = shares.clone();
                wrong[place] = 1.0 - wrong[place];
                assert!(difference(&expected, &wrong).is_some());
            }
            let other = self::shares(context, &triangles, lamp + 0.3 * DVec3::Y, &receivers).expect("shares");
            assert!(difference(&expected, &other).is_some());
        }
    });
}

#[test]
fn bad_lamps_are_errors_that_name_the_remedy() {
    in_full("shadows: errors", |context| {
        let new = |size| ShadowMap::new(context.device(), context.queue(), size);
        for (size, part) in [(7, "even"), (0, "an even number"), (1 << 20, "from 2 to")] {
            let message = new(size).expect_err("a bad size").to_string();
            assert!(message.contains(part), "{message}");
        }
        let mut map = new(16).expect("a map");
        for bias in [-0.1, 0.6, f32::NAN] {
            let message = map.set_bias(bias).expect_err("a bad bias").to_string();
            assert!(message.contains("`bias`") && message.contains("0 to 0.5"), "{message}");
        }
        let mut encoder = context.device().create_command_encoder(&Default::default());
        for (lamp, near, part) in
            [(DVec3::ZERO, 0.0, "`near` is 0"), (DVec3::NAN, 0.1, "finite"), (DVec3::INFINITY, 0.1, "finite")]
        {
            let message = map.draw(&mut encoder, lamp, near, |_, _| {}).expect_err("a bad lamp").to_string();
            assert!(message.contains(part), "{message}");
        }
    });
}
