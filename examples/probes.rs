//! Renders a cube map around two probes and blends their reflections by distance in a fragment shader: `cargo
//! run --release --example probes -- 0.2 1.5` writes probes.png for roughness 0.2 after 1.5 seconds. Device,
//! queue, textures, pipelines and encoder are the renderer's own.

mod common;

use octagloss::wgpu::util::DeviceExt as _;
use octagloss::{LiveProbes, wgpu};

/// Texels along an edge of the cube map, and pixels of the picture.
const FACE: u32 = 128;
const PICTURE: [u32; 2] = [1024, 448];

/// A room with a lamp that circles in it, seen along a ray.
const ROOM: &str = "
const HALF = vec3<f32>(6.0, 2.0, 3.0);
const CORNERS = array<vec2<f32>, 3>(vec2(-1.0, -1.0), vec2(3.0, -1.0), vec2(-1.0, 3.0));
fn hit_sphere(origin: vec3<f32>, ray: vec3<f32>, centre: vec3<f32>, radius: f32) -> f32 {
    let to_centre = centre - origin;
    let middle = dot(to_centre, ray);
    let below = radius * radius - dot(to_centre, to_centre) + middle * middle;
    return select(middle - sqrt(max(below, 0.0)), 1e9, below < 0.0 || middle < 0.0);
}
fn room(origin: vec3<f32>, ray: vec3<f32>, seconds: f32) -> vec3<f32> {
    let lamp = vec3<f32>(4.5 * cos(seconds), 1.2, 2.2 * sin(seconds));
    if hit_sphere(origin, ray, lamp, 0.3) < 1e8 { return vec3<f32>(60.0, 50.0, 35.0); }
    let away = (sign(ray) * HALF - origin) / ray;
    let distance = min(min(away.x, away.y), away.z);
    let place = origin + distance * ray;
    let wall = abs(place) > HALF - 1e-3;
    let colours = array<vec3<f32>, 3>(
        select(vec3<f32>(0.2, 0.3, 0.8), vec3<f32>(0.8, 0.25, 0.15), place.x > 0.0),
        select(vec3<f32>(0.35), vec3<f32>(0.9), place.y > 0.0),
        select(vec3<f32>(0.3, 0.6, 0.3), vec3<f32>(0.8, 0.7, 0.4), place.z > 0.0),
    );
    let tile = vec3<i32>(floor(place * 0.999 + 0.5));
    let shade = select(1.0, 0.6, ((tile.x + tile.y + tile.z) & 1) == 0);
    let near = lamp - place;
    let lit = 0.3 + 4.0 / (1.0 + dot(near, near));
    return shade * lit * colours[select(select(2, 1, wall.y), 0, wall.x)];
}";

/// One face of the cube map, by the instance's number.
const CUBE: &str = "
@group(0) @binding(0) var<uniform> view: vec4<f32>; // centre and seconds
struct Fragment { @builtin(position) position: vec4<f32>, @location(0) @interpolate(flat) face: u32 }
@vertex fn corner(@builtin(vertex_index) k: u32, @builtin(instance_index) face: u32) -> Fragment {
    return Fragment(vec4<f32>(CORNERS[k], 0.0, 1.0), face);
}
@fragment fn paint(at: Fragment) -> @location(0) vec4<f32> {
    let st = 2.0 * at.position.xy / FACE - 1.0;
    let rays = array<vec3<f32>, 6>(
        vec3(1.0, -st.y, -st.x), vec3(-1.0, -st.y, st.x), vec3(st.x, 1.0, st.y),
        vec3(st.x, -1.0, -st.y), vec3(st.x, -st.y, 1.0), vec3(-st.x, -st.y, -1.0));
    return vec4<f32>(room(view.xyz, normalize(rays[at.face]), view.w), 1.0);
}";

/// Five glossy spheres between the probes.
const SPHERES: &str = "
@group(1) @binding(0) var<uniform> view: vec4<f32>; // centre and seconds
@vertex fn corner(@builtin(vertex_index) k: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(CORNERS[k], 0.0, 1.0);
}
@fragment fn paint(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let ray = normalize(vec3<f32>((at.xy - 0.5 * SIZE) / SIZE.x * vec2<f32>(2.0, -2.0), -1.05));
    var nearest = 1e8;
    var centre = vec3<f32>();
    for (var k = -2; k <= 2; k++) {
        let sphere = vec3<f32>(f32(k), 0.0, 0.0);
        let distance = hit_sphere(view.xyz, ray, sphere, 0.45);
        if distance < nearest { nearest = distance; centre = sphere; }
    }
    var radiance = room(view.xyz, ray, view.w);
    if nearest < 1e8 {
        let normal = (view.xyz + nearest * ray - centre) / 0.45;
        let towards = reflect(ray, normal);
        // The probes stand at x = -2 and 2.
        let right = smoothstep(-2.0, 2.0, centre.x);
        radiance = vec3<f32>();
        for (var probe = 0u; probe < 2u; probe++) {
            let share = select(1.0 - right, right, probe == 1u);
            radiance += share * (0.9 * octagloss_radiance_of(probe, towards, ROUGHNESS)
                + 0.1 * octagloss_irradiance_of(probe, normal));
        }
    }
    return vec4<f32>(pow(radiance / (1.0 + radiance), vec3<f32>(1.0 / 2.2)), 1.0);
}";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<f32>());
    let (roughness, seconds) = (numbers.next().unwrap_or(Ok(0.2))?, numbers.next().unwrap_or(Ok(0.0))?);
    let (device, queue) = common::device()?;
    let mut probes = LiveProbes::new(&device, &queue, 256, 2)?;

    let pipeline = |source: String, format: wgpu::TextureFormat| {
        let source = wgpu::ShaderSource::Wgsl(source.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: None,
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: None,
                compilation_options: Default::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    };
    let (radiance, display) = (wgpu::TextureFormat::Rgba16Float, wgpu::TextureFormat::Rgba8Unorm);
    let cube_pipeline = pipeline(format!("const FACE = {FACE}.0;{ROOM}{CUBE}"), radiance);
    let [width, height] = PICTURE;
    let constants = format!("const SIZE = vec2<f32>({width}.0, {height}.0);const ROUGHNESS = {roughness:?};");
    let picture_pipeline = pipeline(LiveProbes::wgsl(0) + &constants + ROOM + SPHERES, display);

    let texture = |[width, height, depth_or_array_layers]: [u32; 3], format, usage| {
        let size = wgpu::Extent3d { width, height, depth_or_array_layers };
        device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
    };
    let cube = texture([FACE, FACE, 6], radiance, wgpu::TextureUsages::TEXTURE_BINDING);
    let picture = texture([width, height, 1], display, wgpu::TextureUsages::COPY_SRC);
    let view_from = |[x, y, z]: [f32; 3], layout: &wgpu::BindGroupLayout| {
        let contents: Vec<u8> = [x, y, z, seconds].iter().flat_map(|word| word.to_ne_bytes()).collect();
        let (contents, usage) = (&contents[..], wgpu::BufferUsages::UNIFORM);
        let view =
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage });
        let entries = &[wgpu::BindGroupEntry { binding: 0, resource: view.as_entire_binding() }];
        device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries })
    };
    let pass = |encoder: &mut wgpu::CommandEncoder, texture: &wgpu::Texture, layer: u32| {
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: layer,
            array_layer_count: Some(1),
            ..Default::default()
        });
        let ops = Default::default();
        let attachment =
            wgpu::RenderPassColorAttachment { view: &view, depth_slice: None, resolve_target: None, ops };
        let color_attachments = &[Some(attachment)];
        encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor { color_attachments, ..Default::default() })
            .forget_lifetime()
    };

    // Every frame: the cube map around each probe, its tables, then the picture.
    let mut encoder = device.create_command_encoder(&Default::default());
    for (probe, x) in probes.iter_mut().zip([-2.0, 2.0]) {
        let view = view_from([x, 0.0, 0.0], &cube_pipeline.get_bind_group_layout(0));
        for face in 0..6 {
            let mut pass = pass(&mut encoder, &cube, face);
            pass.set_pipeline(&cube_pipeline);
            pass.set_bind_group(0, &view, &[]);
            pass.draw(0..3, face..face + 1);
        }
        probe.update(&mut encoder, &cube)?;
    }
    let mut last = pass(&mut encoder, &picture, 0);
    last.set_pipeline(&picture_pipeline);
    last.set_bind_group(0, &probes.bind_group_of(&picture_pipeline.get_bind_group_layout(0)), &[]);
    last.set_bind_group(1, &view_from([0.0, 0.3, 2.9], &picture_pipeline.get_bind_group_layout(1)), &[]);
    last.draw(0..3, 0..1);
    drop(last);
    let (size, usage) = (4 * u64::from(width * height), wgpu::BufferUsages::COPY_DST);
    let pixels = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size,
        usage: usage | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        picture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &pixels, layout },
        picture.size(),
    );
    queue.submit([encoder.finish()]);

    common::save(&device, &queue, &pixels, width, "probes.png")
}
