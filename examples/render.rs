//! Draws a glossy sphere of any roughness with the library's WGSL: `cargo run --release --example render --
//! 0.3` writes sphere.png. Device, queue, texture, pipeline and encoder are the renderer's own.

mod common;

use octagloss::{Environment, LiveEnvironment, wgpu};

const SPHERE: &str = "
@group(1) @binding(0) var<storage, read_write> pixels: array<u32>;
@compute @workgroup_size(8, 8) fn sphere(@builtin(global_invocation_id) at: vec3<u32>) {
    let p = ((vec2<f32>(at.xy) + 0.5) / 256.0 - 1.0) * vec2<f32>(1.0, -1.0);
    let normal = vec3<f32>(p, sqrt(max(1.0 - dot(p, p), 0.0)));
    let radiance = octagloss_radiance(reflect(vec3<f32>(0.0, 0.0, -1.0), normal), ROUGHNESS);
    let display = pow(radiance / (1.0 + radiance), vec3<f32>(1.0 / 2.2));
    pixels[at.y * 512u + at.x] = pack4x8unorm(vec4<f32>(display * step(dot(p, p), 1.0), 1.0));
}";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let roughness: f32 = std::env::args().nth(1).map_or(Ok(0.3), |text| text.parse())?;
    let (device, queue) = common::device()?;
    let mut live = LiveEnvironment::new(&device, &queue, 512)?;
    let texture = live.upload(&Environment::read("hdr/sky.exr")?)?;

    let source = LiveEnvironment::wgsl(0) + &format!("const ROUGHNESS = {roughness:?};") + SPHERE;
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(source.into()),
        }),
        entry_point: None,
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let descriptor = wgpu::BufferDescriptor { label: None, size: 4 << 18, usage, mapped_at_creation: false };
    let pixels = device.create_buffer(&descriptor);
    let image = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(1),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: pixels.as_entire_binding() }],
    });
    let light = live.bind_group_of(&pipeline.get_bind_group_layout(0));

    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    live.update(&mut encoder, &texture)?;
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &light, &[]);
    pass.set_bind_group(1, &image, &[]);
    pass.dispatch_workgroups(512 / 8, 512 / 8, 1);
    drop(pass);
    queue.submit([encoder.finish()]);

    common::save(&device, &queue, &pixels, 512, "sphere.png")
}
