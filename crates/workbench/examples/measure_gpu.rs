//! Times what a renderer pays for pyramids, and how far the GPU is from the CPU, on every adapter: `cargo run
//! --release -p octagloss-workbench --example measure_gpu -- PANORAMA...`. Prints the passes of an update of
//! a map of 512, drawn frames of 1920 x 1080, and differences of look-ups.

#[path = "common/measure.rs"]
mod measure;

use glam::DVec3;
use measure::{Random, brightest, measures, median};
use octagloss::{Environment, LiveEnvironment, OemSize, wgpu};
use octagloss_core::cpu::reparameterise::oem_from_environment;
use octagloss_core::pyramid::Pyramid;
use octagloss_gpu::device::readback;
use octagloss_gpu::device::timer::{Clock, Timer, accounts_for};
use octagloss_gpu::stages::build_pyramid;
use octagloss_gpu::stages::pyramid::{PyramidMaps, radiance};
use octagloss_gpu::stages::reparameterise;
use octagloss_gpu::{Context, OemPlanes, Stage, adapters, block_on};
use std::f64::consts::TAU;
use std::time::Instant;

/// Texels along an edge of the map.
const SIZE: u32 = 512;

/// Runs of what is timed, after one that warms up; fewer once they have taken [`PATIENCE`] seconds.
const RUNS: usize = 9;
const PATIENCE: f64 = 5.0;

/// Seconds in which an idle GPU raises its clock.
const WARM_UP: f64 = 0.5;

const ROUGHNESS: [f64; 10] = [0.0, 0.03, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 0.8, 1.0];

/// Draws a hemisphere that fills the frame, seen from far away; roughness grows from left to right.
const FRAME: &str = "
@vertex fn corner(@builtin(vertex_index) k: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(k & 1u) * 4.0 - 1.0, f32(k >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment fn pixel(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let p = at.xy / vec2<f32>(1920.0, 1080.0) * 1.4 - 0.7;
    let normal = vec3<f32>(p, sqrt(1.0 - dot(p, p)));
    let view = vec3<f32>(0.0, 0.0, 1.0);
    let roughness = at.x / 1920.0;
    return vec4<f32>(LOOK, 1.0);
}";

/// Frames: name, look-up, and whether it reads the tables of reflections.
const FRAMES: [(&str, &str, bool); 4] = [
    ("constant", "normal", false),
    ("radiance", "octagloss_radiance(reflect(-view, normal), roughness)", false),
    (
        "reflection",
        "octagloss_reflect_isotropic(normal, view, roughness, vec3<f32>(0.9, 0.6, 0.3), 1.0)",
        true,
    ),
    (
        "brushed",
        "octagloss_reflect(normal, view, vec3<f32>(0.0, 1.0, 0.0), roughness, 0.5, \
         vec3<f32>(0.9, 0.6, 0.3), 1.0)",
        true,
    ),
];

/// Seconds of a frame of which each pixel is what `look` gives: by timestamps, if they are true, and from
/// submission to completion.
fn frame(context: &Context, live: &LiveEnvironment, (look, reflects): (&str, bool)) -> (Option<f64>, f64) {
    let device = context.device();
    let look_ups = if reflects { LiveEnvironment::reflect_wgsl(0) } else { LiveEnvironment::wgsl(0) };
    let source = look_ups + &FRAME.replace("LOOK", look);
    let module = &device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let group_layout =
        if reflects { live.reflect_bind_group_layout() } else { live.bind_group_layout().clone() };
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&group_layout)],
        immediate_size: 0,
    });
    let format = wgpu::TextureFormat::Rgba16Float;
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: None,
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: None,
            compilation_options: Default::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let light = if reflects { live.reflect_bind_group_of(&group_layout) } else { live.bind_group().clone() };
    let colour = context.texture("frame", format, [1920, 1080, 1], 1, wgpu::TextureUsages::RENDER_ATTACHMENT);
    let view = colour.create_view(&wgpu::TextureViewDescriptor::default());
    let timer = Timer::new(context, 1).ok();
    let (mut stamps, mut walls) = (Vec::new(), Vec::new());
    for run in 0..=RUNS {
        if walls.iter().sum::<f64>() > PATIENCE {
            break;
        }
        let start = Instant::now();
        context.submit(|encoder| {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations::default(),
                })],
                timestamp_writes: timer.as_ref().map(|timer| timer.render_writes(0)),
                ..Default::default()
            });
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &light, &[]);
            pass.draw(0..3, 0..1);
        });
        block_on(Some(context), readback::finished(context)).expect("a device").expect("a device");
        let wall = start.elapsed().as_secs_f64();
        if run > 0 {
            walls.push(wall);
            if let Some(timer) = &timer {
                stamps.extend(
                    block_on(Some(context), timer.read(context, 1)).expect("a device").expect("times"),
                );
            }
        }
    }
    let wall = median(walls);
    (timer.map(|_| median(stamps)).filter(|seconds| accounts_for(*seconds, wall)), wall)
}

/// Prints the passes of an update.
fn update(context: &Context, stages: &[&Stage]) {
    let clock = block_on(Some(context), Clock::of(context, &[stages])).expect("a device").expect("a clock");
    let mut each = vec![Vec::new(); stages.len()];
    let (mut whole, mut wall) = (Vec::new(), Vec::new());
    let start = Instant::now();
    let mut timed = 0;
    while timed < RUNS {
        let times = block_on(Some(context), clock.time(context, stages)).expect("a device").expect("times");
        if start.elapsed().as_secs_f64() > WARM_UP {
            timed += 1;
            each.iter_mut().zip(times.each).for_each(|(each, seconds)| each.push(seconds));
            whole.push(times.whole);
            wall.push(times.wall);
        }
    }
    println!("    by {}", clock.name());
    for (stage, seconds) in stages.iter().zip(each) {
        println!("    {}: {:.1} us", stage.label(), 1e6 * median(seconds));
    }
    for part in stages.iter().flat_map(|stage| stage.parts()) {
        let mut seconds = Vec::new();
        for _ in 0..RUNS {
            let times = block_on(Some(context), clock.time(context, &[&part]));
            seconds.push(times.expect("a device").expect("times").whole);
        }
        println!("      {} by itself: {:.1} us", part.label(), 1e6 * median(seconds));
    }
    println!("    update: {:.1} us, {:.1} us until it is known", 1e6 * median(whole), 1e6 * median(wall));
}

fn main() {
    for path in std::env::args().skip(1) {
        let environment = Environment::read(&path).expect("a panorama");
        let size = OemSize { inner: SIZE, border: 0 };
        let oem = oem_from_environment(&environment, size).expect("small");
        let pyramid = Pyramid::of_oem(&oem).expect("a power of two");
        let sun = brightest(&environment);
        println!("{path}");
        for adapter in block_on(None, adapters()).expect("adapters") {
            let context = &block_on(None, Context::new(&adapter)).expect("a device").expect("a device");
            println!("  {}", context.describe());
            let mut live = LiveEnvironment::new(context.device(), context.queue(), SIZE).expect("a device");
            let texture = live.upload(&environment).expect("a texture");
            update(context, &live.stages(&texture).expect("stages").collect::<Vec<_>>());
            for (name, look, reflects) in FRAMES {
                let (stamps, wall) = frame(context, &live, (look, reflects));
                let stamps = stamps.map_or("no timestamps".to_owned(), |s| format!("{:.1} us", 1e6 * s));
                println!("    frame, {name}: {stamps}, {:.1} us until it is known", 1e6 * wall);
            }
            let planes = OemPlanes::new(context, size).expect("planes");
            let maps = PyramidMaps::new(context, SIZE).expect("maps");
            let layout = environment.layout();
            let filled = reparameterise::stage(context, layout, &texture, &planes).expect("a stage");
            context.submit(|encoder| {
                filled.record(encoder);
                build_pyramid::stage(context, &planes, &maps).record(encoder);
            });
            println!("    {:.2} MB", maps.bytes() as f64 / 1e6);
            let mut random = Random(9);
            for roughness in ROUGHNESS {
                // Anywhere, and every other around the sun.
                let mut direction = |k| match k % 2 {
                    0 => random.direction(),
                    _ => random.within(sun, (6.0 * roughness * roughness).clamp(0.01, TAU / 4.0)),
                };
                let queries: Vec<_> = (0..2000).map(|k| (direction(k), roughness)).collect();
                let wide = |rgb: [f32; 3]| DVec3::from_array(rgb.map(f64::from));
                let found = block_on(Some(context), radiance(context, &maps, &queries));
                let found: Vec<_> =
                    found.expect("a device").expect("answers").into_iter().map(wide).collect();
                let lobes = pyramid.lobes(roughness as f32);
                let expected: Vec<_> = queries.iter().map(|(d, _)| wide(lobes.radiance(*d))).collect();
                let [relative, _, peak] = measures(&found, &expected);
                println!("    r {roughness:4.2}: GPU from CPU relRMSE {relative:.6}, of peak {peak:.6}");
            }
        }
    }
}
