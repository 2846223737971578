//! Draws a room in the light of a lamp with shadows from an octahedral map of depth: `cargo run --release
//! --example shadows -- 1.5` writes shadows.png for the lamp's place after 1.5 seconds. Device, queue,
//! buffers, pipelines and encoder are the renderer's own.

mod common;

use glam::{Mat3, Mat4, Vec3};
use octagloss::wgpu::util::DeviceExt as _;
use octagloss::{ShadowMap, wgpu};

/// Draws a corner of a triangle into the map.
const INTO_MAP: &str = "
@vertex fn project(@location(0) position: vec3<f32>) -> @builtin(position) vec4<f32> {
    return octagloss_direct_position(position);
}
@fragment fn keep(@builtin(position) position: vec4<f32>) {
    if !octagloss_direct_owns(position) { discard; }
}";

/// Draws the picture; the lamp has inverse squares and the room some light from everywhere.
const PICTURE: &str = "
struct Camera { clip_from_world: mat4x4<f32>, lamp: vec4<f32> }
@group(1) @binding(0) var<uniform> camera: Camera;
struct Fragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) albedo: vec3<f32>,
}
@vertex fn corner(@location(0) position: vec3<f32>, @location(1) normal: vec3<f32>,
        @location(2) albedo: vec3<f32>) -> Fragment {
    return Fragment(camera.clip_from_world * vec4<f32>(position, 1.0), position, normal, albedo);
}
@fragment fn paint(fragment: Fragment) -> @location(0) vec4<f32> {
    let normal = normalize(fragment.normal);
    let to_lamp = camera.lamp.xyz - fragment.position;
    let square = dot(to_lamp, to_lamp);
    let cosine = max(dot(normal, to_lamp), 0.0) / sqrt(square);
    let light = 0.08 + 9.0 * cosine / square * octagloss_lit(fragment.position, normal);
    let radiance = fragment.albedo * light;
    return vec4<f32>(pow(radiance / (1.0 + radiance), vec3<f32>(1.0 / 2.2)), 1.0);
}";

/// Corners of a cube of half edge `half` around `centre`, turned about +Y: position, normal and albedo.
fn cube(centre: Vec3, half: f32, turn: f32, albedo: impl Fn(Vec3) -> Vec3) -> Vec<[Vec3; 3]> {
    let (world_from_cube, mut corners) = (Mat3::from_rotation_y(turn), Vec::new());
    for axis in Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
        let (right, up) = (Vec3::new(axis.y, axis.z, axis.x), Vec3::new(axis.z, axis.x, axis.y));
        // A negative half edge makes a room, which is seen from inside.
        let normal = world_from_cube * axis * half.signum();
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            let place = centre + half.abs() * (world_from_cube * (axis + x * right + y * up));
            corners.push([place, normal, albedo(axis)]);
        }
    }
    corners
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seconds: f32 = std::env::args().nth(1).map_or(Ok(0.0), |text| text.parse())?;
    let (device, queue) = common::device()?;
    let mut shadows = ShadowMap::new(&device, &queue, 1024)?;

    // A room, and cubes around the lamp.
    let mut scene = cube(Vec3::ZERO, -4.0, 0.0, |axis| 0.6 + 0.25 * axis);
    for k in 0..7 {
        let (sin, cos) = (0.9 * k as f32).sin_cos();
        let centre = Vec3::new(2.2 * cos, -1.2 + 0.5 * k as f32 % 2.5, 2.2 * sin);
        scene.extend(cube(centre, 0.3 + 0.05 * k as f32, 0.7 * k as f32, |_| Vec3::splat(0.8)));
    }
    let lamp = Vec3::new(0.6 * seconds.cos(), 0.3, 0.6 * seconds.sin());
    let eye = Vec3::new(3.6, 2.6, 3.4);
    let forward = (Vec3::new(-0.3, -0.6, -0.3) - eye).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let row = |axis: Vec3, offset: f32| axis.extend(offset - axis.dot(eye));
    // Depth 0 at a distance of 0.1, towards 1 far away.
    let camera = Mat4::from_rows(
        row(1.4 * right, 0.0),
        row(1.4 * right.cross(forward), 0.0),
        row(forward, -0.1),
        row(forward, 0.0),
    );

    let bytes = |words: Vec<f32>| words.iter().flat_map(|word| word.to_ne_bytes()).collect::<Vec<u8>>();
    let buffer = |words: Vec<f32>, usage| {
        let contents = &bytes(words);
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    };
    let words = scene.as_flattened().iter().flat_map(Vec3::to_array).collect();
    let corners = buffer(words, wgpu::BufferUsages::VERTEX);
    let words = [&camera.to_cols_array()[..], &lamp.extend(0.0).to_array()].concat();
    let camera = buffer(words, wgpu::BufferUsages::UNIFORM);
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let pipeline = |source, groups: &[_], depth_compare, targets: &[Option<wgpu::ColorTargetState>]| {
        let bind_group_layouts = groups;
        let descriptor = wgpu::PipelineLayoutDescriptor { bind_group_layouts, ..Default::default() };
        let layout = &device.create_pipeline_layout(&descriptor);
        let source = wgpu::ShaderSource::Wgsl(std::borrow::Cow::Owned(source));
        let module = &device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let attributes = &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3];
        let step_mode = wgpu::VertexStepMode::Vertex;
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: None,
                compilation_options: Default::default(),
                buffers: &[Some(wgpu::VertexBufferLayout { array_stride: 36, step_mode, attributes })],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: ShadowMap::DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(depth_compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: None,
                compilation_options: Default::default(),
                targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    };
    let camera_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        }],
    });
    let camera = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &camera_layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: camera.as_entire_binding() }],
    });
    let (greater, less) = (wgpu::CompareFunction::Greater, wgpu::CompareFunction::Less);
    let source = ShadowMap::draw_wgsl(0) + INTO_MAP;
    let into_map = pipeline(source, &[Some(shadows.draw_layout())], greater, &[]);
    let groups = [Some(shadows.bind_group_layout()), Some(&camera_layout)];
    let picture = pipeline(ShadowMap::wgsl(0) + PICTURE, &groups, less, &[Some(format.into())]);
    let texture = |format| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: 512, height: 512, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    };
    let (colour, depth) = (texture(format), texture(ShadowMap::DEPTH));
    let [colour_view, depth_view] = [&colour, &depth].map(|texture| texture.create_view(&Default::default()));

    // Every frame: draw what the lamp sees, then the picture.
    let mut encoder = device.create_command_encoder(&Default::default());
    shadows.draw(&mut encoder, lamp.as_dvec3(), 0.05, |pass, octant| {
        pass.set_pipeline(&into_map);
        pass.set_bind_group(0, octant, &[]);
        pass.set_vertex_buffer(0, corners.slice(..));
        pass.draw(0..scene.len() as u32, 0..1);
    })?;
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &colour_view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations::default(),
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth_view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(1.0),
                store: wgpu::StoreOp::Discard,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    pass.set_pipeline(&picture);
    pass.set_bind_group(0, shadows.bind_group(), &[]);
    pass.set_bind_group(1, &camera, &[]);
    pass.set_vertex_buffer(0, corners.slice(..));
    pass.draw(0..scene.len() as u32, 0..1);
    drop(pass);
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * 512), rows_per_image: None };
    let usage = wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
    let descriptor = wgpu::BufferDescriptor { label: None, size: 4 << 18, usage, mapped_at_creation: false };
    let pixels = device.create_buffer(&descriptor);
    encoder.copy_texture_to_buffer(
        colour.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &pixels, layout },
        colour.size(),
    );
    queue.submit([encoder.finish()]);

    common::save(&device, &queue, &pixels, 512, "shadows.png")
}
