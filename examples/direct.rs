//! Draws a moving scene straight into a live environment, and a glossy sphere in it: `cargo run --release
//! --example direct -- 0.2 1.5` writes direct.png for roughness 0.2 after 1.5 seconds. Device, queue,
//! buffers, pipelines and encoder are the renderer's own.

mod common;

use glam::{DVec3, Mat3, Vec3};
use octagloss::wgpu::util::DeviceExt as _;
use octagloss::{LiveEnvironment, wgpu};

/// Draws a corner of a triangle into the map.
const SCENE: &str = "
struct Fragment { @builtin(position) position: vec4<f32>, @location(0) radiance: vec3<f32> }
@vertex fn project(@location(0) position: vec3<f32>, @location(1) radiance: vec3<f32>) -> Fragment {
    return Fragment(octagloss_direct_position(position), radiance);
}
@fragment fn paint(fragment: Fragment) -> @location(0) vec4<f32> {
    if !octagloss_direct_owns(fragment.position) { discard; }
    return vec4<f32>(fragment.radiance, 1.0);
}";

/// A sphere that reflects the map.
const SPHERE: &str = "
@group(1) @binding(0) var<storage, read_write> pixels: array<u32>;
@compute @workgroup_size(8, 8) fn sphere(@builtin(global_invocation_id) at: vec3<u32>) {
    let p = ((vec2<f32>(at.xy) + 0.5) / 256.0 - 1.0) * vec2<f32>(1.0, -1.0);
    let normal = vec3<f32>(p, sqrt(max(1.0 - dot(p, p), 0.0)));
    let radiance = octagloss_radiance(reflect(vec3<f32>(0.0, 0.0, -1.0), normal), ROUGHNESS);
    let display = pow(radiance / (1.0 + radiance), vec3<f32>(1.0 / 2.2));
    pixels[at.y * 512u + at.x] = pack4x8unorm(vec4<f32>(display * step(dot(p, p), 1.0), 1.0));
}";

/// Corners of a cube of half edge `half` around `centre`, turned about +Y: position and radiance.
fn cube(centre: Vec3, half: f32, turn: f32, radiance: impl Fn(Vec3) -> Vec3) -> Vec<[Vec3; 2]> {
    let (world_from_cube, mut corners) = (Mat3::from_rotation_y(turn), Vec::new());
    for axis in Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
        let (right, up) = (Vec3::new(axis.y, axis.z, axis.x), Vec3::new(axis.z, axis.x, axis.y));
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            let place = centre + half * (world_from_cube * (axis + x * right + y * up));
            corners.push([place, radiance(axis)]);
        }
    }
    corners
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<f32>());
    let (roughness, seconds) = (numbers.next().unwrap_or(Ok(0.2))?, numbers.next().unwrap_or(Ok(0.0))?);
    let (device, queue) = common::device()?;
    let mut live = LiveEnvironment::new(&device, &queue, 256)?;

    // A room with a bright ceiling, and three cubes that circle the sphere.
    let mut scene =
        cube(Vec3::ZERO, 5.0, 0.0, |axis| (0.6 + 0.3 * axis) * if axis.y > 0.5 { 3.0 } else { 1.0 });
    for (k, colour) in
        [Vec3::new(4.0, 0.3, 0.2), Vec3::new(0.2, 3.0, 0.3), Vec3::new(0.3, 0.4, 5.0)].iter().enumerate()
    {
        let angle = seconds + 2.1 * k as f32;
        let centre = Vec3::new(2.5 * angle.cos(), 0.4 * (2.0 * angle).sin(), 2.5 * angle.sin());
        scene.extend(cube(centre, 0.5, 3.0 * angle, |axis| *colour * (0.8 + 0.2 * axis.y)));
    }
    let words: Vec<f32> = scene.as_flattened().iter().flat_map(Vec3::to_array).collect();
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_ne_bytes()).collect();
    let usage = wgpu::BufferUsages::VERTEX;
    let corners =
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents: &bytes, usage });
    let module = |source: String| {
        let source = wgpu::ShaderSource::Wgsl(source.into());
        device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source })
    };
    let shader = module(LiveEnvironment::draw_wgsl(0) + SCENE);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        bind_group_layouts: &[Some(live.draw_layout())],
        ..Default::default()
    });
    let into_map = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: None,
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: 24,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
            })],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: LiveEnvironment::DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: None,
            compilation_options: Default::default(),
            targets: &[Some(LiveEnvironment::COLOUR.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let reflect = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module(LiveEnvironment::wgsl(0) + &format!("const ROUGHNESS = {roughness:?};") + SPHERE),
        entry_point: None,
        compilation_options: Default::default(),
        cache: None,
    });
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let size = 4 * 512 * 512;
    let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
    let pixels = device.create_buffer(&descriptor);
    let image = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &reflect.get_bind_group_layout(1),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: pixels.as_entire_binding() }],
    });
    let light = live.bind_group_of(&reflect.get_bind_group_layout(0));

    // Every frame: draw the scene around the sphere's centre, then reflect it.
    let mut encoder = device.create_command_encoder(&Default::default());
    live.draw(&mut encoder, DVec3::ZERO, 0.1, |pass, octant| {
        pass.set_pipeline(&into_map);
        pass.set_bind_group(0, octant, &[]);
        pass.set_vertex_buffer(0, corners.slice(..));
        pass.draw(0..scene.len() as u32, 0..1);
    })?;
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&reflect);
    pass.set_bind_group(0, &light, &[]);
    pass.set_bind_group(1, &image, &[]);
    pass.dispatch_workgroups(512 / 8, 512 / 8, 1);
    drop(pass);
    queue.submit([encoder.finish()]);

    common::save(&device, &queue, &pixels, 512, "direct.png")
}
