//! A renderer's own draws straight into a live environment: look-ups against the CPU's over the picture that
//! rays through the map's pixels see.

use crate::live::{answers, difference};
use glam::{DMat3, DVec3, Vec3};
use octagloss_core::common::error::Error;
use octagloss_core::light::environment::{Environment, Layout, Rgb};
use octagloss_fixtures::adapters::in_full;
use octagloss_fixtures::common::{Random, landmarks};
use octagloss_fixtures::meshes::closed;
use octagloss_fixtures::oracles::triangles::{TriangleOracle, corners_of};
use octagloss_gpu::Context;
use octagloss_gpu::live::LiveEnvironment;
use octagloss_gpu::triangles::{Corner, DirectMap, Triangles};
use wgpu::util::DeviceExt as _;

/// Pixels along an edge of the map.
const SIZE: u32 = 64;

const NEAR: f32 = 0.1;

/// Relative tolerance of glossy radiance: silhouettes within a sixteenth of a pixel, and half floats.
const ALLOWED: f64 = 0.03;

const SHADER: &str = "
struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) value: vec4<f32>,
}

@vertex
fn project(@location(0) position: vec3<f32>, @location(2) value: vec4<f32>) -> Fragment {
    return Fragment(octagloss_direct_position(position), value);
}

@fragment
fn paint(fragment: Fragment) -> @location(0) vec4<f32> {
    if !octagloss_direct_owns(fragment.position) {
        discard;
    }
    return fragment.value;
}
";

/// A room of smooth colours, and bright triangles in it that face the origin, counter-clockwise.
fn scene() -> Triangles {
    let mut random = Random::new(71);
    let room = closed(3, Some(5), 3.0..6.0);
    let mut corners = Vec::new();
    let mut facing = |mut places: [DVec3; 3], colours: [DVec3; 3]| {
        let [a, b, c] = places;
        let clockwise = a.dot(b.cross(c)) > 0.0;
        let mut values = colours;
        if clockwise {
            places.swap(1, 2);
            values.swap(1, 2);
        }
        for (place, colour) in places.iter().zip(values) {
            let value = colour.as_vec3().extend(1.0).to_array();
            corners.push(Corner::new(place.as_vec3().to_array(), value));
        }
    };
    for index in 0..room.count() {
        let places = corners_of(&room, index).map(|corner| DVec3::from_array(corner.position.map(f64::from)));
        facing(places, places.map(|place| 0.5 * place.normalize() + 0.7));
    }
    for k in 0..6 {
        let centre = 1.5 * random.direction();
        let colour = DVec3::AXES[k % 3] * 3.0 + 0.2;
        facing([0; 3].map(|_| centre + 0.8 * random.direction()), [colour; 3]);
    }
    let indices = (0..corners.len() as u32).collect();
    Triangles::new(corners, indices).expect("a valid mesh")
}

/// What rays from the origin through the pixels of the map see. Triangles whose edge is within a sixteenth of
/// a pixel are left out; a pixel that shows no other has the mean of its neighbours.
fn picture(triangles: &Triangles) -> Environment {
    let oracle =
        TriangleOracle::new(triangles, DirectMap::Octahedral { size: SIZE }, NEAR).expect("a valid map");
    let nearest = |x: u32, y: u32| {
        let (hits, _) = oracle.pixel(x, y);
        let hit = hits.into_iter().max_by(|a, b| a.depth.total_cmp(&b.depth));
        hit.map(|hit| DVec3::new(hit.value[0], hit.value[1], hit.value[2]))
    };
    let seen: Vec<Option<DVec3>> = (0..SIZE * SIZE).map(|k| nearest(k % SIZE, k / SIZE)).collect();
    let decided = seen.iter().flatten().count();
    assert!(decided * 25 > seen.len() * 24, "{decided} pixels are decided");
    let texel = |k: usize| -> Rgb {
        let (x, y) = (k as u32 % SIZE, k as u32 / SIZE);
        let around = |c: u32| c.saturating_sub(1)..=(c + 1).min(SIZE - 1);
        let near = around(y).flat_map(|y| around(x).map(move |x| (y * SIZE + x) as usize));
        let near: Vec<DVec3> = near.filter_map(|k| seen[k]).collect();
        let mean = near.iter().sum::<DVec3>() / near.len().max(1) as f64;
        seen[k].unwrap_or(mean).as_vec3().to_array()
    };
    let texels = (0..seen.len()).map(texel).collect();
    Environment::new(Layout::Octahedral { size: SIZE }, texels).expect("an environment")
}

/// `triangles`, moved by `offset`.
fn moved(triangles: &Triangles, offset: Vec3) -> Triangles {
    let corners = triangles.corners().iter().map(|corner| {
        let position = Vec3::from_array(corner.position) + offset;
        Corner::new(position.to_array(), corner.value)
    });
    Triangles::new(corners.collect(), triangles.indices().to_vec()).expect("a valid mesh")
}

/// Draws `triangles`, moved by `centre`, with fronts that wind as `front_face`.
fn draw(
    context: &Context,
    live: &mut LiveEnvironment,
    triangles: &Triangles,
    centre: DVec3,
    front_face: wgpu::FrontFace,
) -> octagloss_core::common::error::Result<()> {
    let device = context.device();
    let moved: Vec<Corner> = triangles
        .corners()
        .iter()
        .map(|corner| {
            let position = DVec3::from_array(corner.position.map(f64::from)) + centre;
            Corner::new(position.as_vec3().to_array(), corner.value)
        })
        .collect();
    let corners = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: None,
        contents: bytemuck::cast_slice(&moved),
        usage: wgpu::BufferUsages::VERTEX,
    });
    let source = wgpu::ShaderSource::Wgsl((LiveEnvironment::draw_wgsl(2) + SHADER).into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[None, None, Some(live.draw_layout())],
        ..Default::default()
    });
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Corner>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32, 2 => Float32x4],
            })],
        },
        primitive: wgpu::PrimitiveState {
            front_face,
            cull_mode: Some(wgpu::Face::Back),
            ..Default::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: LiveEnvironment::DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            targets: &[Some(LiveEnvironment::COLOUR.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let count = moved.len() as u32;
    live.draw(&mut encoder, centre, NEAR, |pass, octant| {
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(2, octant, &[]);
        pass.set_vertex_buffer(0, corners.slice(..));
        pass.draw(0..count, 0..1);
    })?;
    context.queue().submit([encoder.finish()]);
    Ok(())
}

#[test]
fn drawn_scenes_light_as_rays_see_them() {
    let triangles = scene();
    let environment = picture(&triangles);
    in_full("draws into a live environment", |context| {
        let mut live = LiveEnvironment::new(context.device(), context.queue(), SIZE).expect("small tables");
        let directions = &landmarks()[..];
        let centre = DVec3::new(7.0, -2.0, 5.0);
        // In an octahedral map, as in a cube, what is counter-clockwise to the eye is clockwise.
        let mut judge = |triangles: &Triangles, front_face| {
            draw(context, &mut live, triangles, centre, front_face).expect("a valid draw");
            let found = answers(context, &live, directions);
            difference(&found, &environment, DMat3::IDENTITY, directions, ALLOWED)
        };
        assert_eq!(judge(&triangles, wgpu::FrontFace::Cw), None, "on {}", context.describe());
        // The comparison sees culled fronts, and a scene that has moved by a fifth of its distance.
        assert!(judge(&triangles, wgpu::FrontFace::Ccw).is_some(), "back faces are black");
        let moved = moved(&triangles, Vec3::X * 0.3);
        assert!(judge(&moved, wgpu::FrontFace::Cw).is_some(), "a moved scene differs");
        assert_eq!(judge(&triangles, wgpu::FrontFace::Cw), None, "the next frame is of the next scene");
    });
}

#[test]
fn draws_and_textures_take_turns() {
    let triangles = scene();
    let environment = picture(&triangles);
    in_full("draws and updates", |context| {
        let mut live = LiveEnvironment::new(context.device(), context.queue(), SIZE).expect("small tables");
        let directions = &landmarks()[..];
        let texture = live.upload(&environment).expect("a small texture");
        let grey = Environment::new(Layout::Octahedral { size: 2 }, vec![[0.5; 3]; 4]).expect("a grey map");
        let grey_texture = live.upload(&grey).expect("a small texture");
        let update = |live: &mut LiveEnvironment, texture: &wgpu::Texture| {
            let mut encoder = context.device().create_command_encoder(&Default::default());
            live.update(&mut encoder, texture).expect("an environment");
            context.queue().submit([encoder.finish()]);
        };
        let judge = |live: &LiveEnvironment, environment: &Environment| {
            let found = answers(context, live, directions);
            difference(&found, environment, DMat3::IDENTITY, directions, ALLOWED)
        };
        draw(context, &mut live, &triangles, DVec3::ZERO, wgpu::FrontFace::Cw).expect("a valid draw");
        assert_eq!(judge(&live, &environment), None);
        update(&mut live, &grey_texture);
        assert_eq!(judge(&live, &grey), None);
        assert!(judge(&live, &environment).is_some(), "the scene is gone");
        draw(context, &mut live, &triangles, DVec3::ZERO, wgpu::FrontFace::Cw).expect("a valid draw");
        assert_eq!(judge(&live, &environment), None);
        update(&mut live, &texture);
        assert_eq!(judge(&live, &environment), None);
        // A sibling draws into the same map, a scene far below.
        let mut sibling = live.sibling();
        let below = moved(&triangles, Vec3::NEG_Y * 1e3);
        draw(context, &mut sibling, &below, DVec3::ZERO, wgpu::FrontFace::Cw).expect("a valid draw");
        assert_eq!(judge(&live, &environment), None);
        assert!(judge(&sibling, &environment).is_some(), "the scene is far below");
        draw(context, &mut live, &triangles, DVec3::ZERO, wgpu::FrontFace::Cw).expect("a valid draw");
        draw(context, &mut sibling, &triangles, DVec3::ZERO, wgpu::FrontFace::Cw).expect("a valid draw");
        for drawn in [&live, &sibling] {
            assert_eq!(judge(drawn, &environment), None);
        }
    });
}

#[test]
fn bad_centres_and_distances_are_refused() {
    in_full("refused draws", |context| {
        let mut live = LiveEnvironment::new(context.device(), context.queue(), 16).expect("small tables");
        let mut refused = |centre, near| {
            let mut encoder = context.device().create_command_encoder(&Default::default());
            let outcome = live.draw(&mut encoder, centre, near, |_, _| panic!("nothing is drawn"));
            outcome.expect_err("an invalid draw")
        };
        for (centre, near, part) in [
            (DVec3::ZERO, 0.0, "`near` is 0"),
            (DVec3::ZERO, f32::NAN, "`near` is NaN"),
            (DVec3::new(0.0, f64::NAN, 0.0), 0.1, "`centre`"),
            (DVec3::new(0.0, 0.0, 1e13), 0.1, "`centre`"),
        ] {
            let error = refused(centre, near);
            assert!(matches!(&error, Error::Parameter(text) if text.contains(part)), "{error}");
        }
    });
}
