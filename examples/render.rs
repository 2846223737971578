//! Renders a glossy sphere of any roughness with the library's WGSL: `cargo run --release --example render --
//! 0.3` writes sphere.png. Device and command encoder are the caller's own.

use octagloss::gpu::build_fitted::BuildFitted;
use octagloss::gpu::device::readback;
use octagloss::gpu::fitted::{FittedTables, wgsl};
use octagloss::gpu::reparameterise::{Reparameterise, upload};
use octagloss::gpu::{Context, OemPlanes, adapters, block_on};
use octagloss::oem::OemSize;
use octagloss::{io, wgpu};

const SIZE: u32 = 512;

const SPHERE: &str = "
@group(1) @binding(0) var<storage, read_write> pixels: array<u32>;

@compute @workgroup_size(8, 8)
fn render(@builtin(global_invocation_id) at: vec3<u32>) {
    let p = ((vec2<f32>(at.xy) + 0.5) / 256.0 - 1.0) * vec2<f32>(1.0, -1.0);
    let view = vec3<f32>(0.0, 0.0, -1.0);
    let inside = dot(p, p) < 1.0;
    let normal = vec3<f32>(p, sqrt(max(1.0 - dot(p, p), 0.0)));
    let radiance = octagloss_fitted(select(view, reflect(view, normal), inside), select(0.0, ROUGHNESS, inside));
    let display = pow(radiance / (1.0 + radiance), vec3<f32>(1.0 / 2.2));
    pixels[at.y * 512u + at.x] = pack4x8unorm(vec4<f32>(display, 1.0));
}
";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let roughness: f32 = std::env::args().nth(1).map_or(Ok(0.3), |text| text.parse())?;
    let adapters = block_on(None, adapters())?;
    let adapter = adapters.first().ok_or("no adapter")?;
    let (device, queue) = block_on(None, adapter.request_device(&wgpu::DeviceDescriptor::default()))??;
    let context = Context::from_device(device.clone(), queue.clone());

    // Upload the environment as a texture; a renderer would use its own.
    let environment = io::read("hdr/sky.exr".as_ref(), &io::ReadOptions::default())?.environment;
    let texture = upload(&context, &environment)?;

    // Create the stages once; record them whenever the light changes.
    let planes = OemPlanes::new(&context, OemSize { inner: 512, border: 0 })?;
    let tables = FittedTables::new(&context, 512, 4)?;
    let reparameterise = Reparameterise::new(&context);
    let mut stages = vec![reparameterise.stage(&context, environment.layout(), &texture, &planes)?];
    stages.extend(BuildFitted::new(&context).stages(&context, &planes, &tables)?);

    let source = wgsl(0) + &format!("const ROUGHNESS = {roughness:?};") + SPHERE;
    let source = wgpu::ShaderSource::Wgsl(source.into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("sphere"), source });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("sphere"),
        layout: None,
        module: &module,
        entry_point: None,
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let pixels = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("pixels"),
        size: u64::from(4 * SIZE * SIZE),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let light = tables.bind_group(&device, &pipeline.get_bind_group_layout(0));
    let image = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("image"),
        layout: &pipeline.get_bind_group_layout(1),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: pixels.as_entire_binding() }],
    });

    // Record one frame in one encoder: the light's stages, then the drawing.
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    stages.iter().for_each(|stage| stage.record(&mut encoder));
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &light, &[]);
    pass.set_bind_group(1, &image, &[]);
    pass.dispatch_workgroups(SIZE / 8, SIZE / 8, 1);
    drop(pass);
    queue.submit([encoder.finish()]);

    let pixels: Vec<u8> = block_on(Some(&context), readback::read(&context, &pixels))??;
    image::save_buffer("sphere.png", &pixels, SIZE, SIZE, image::ColorType::Rgba8)?;
    Ok(())
}
