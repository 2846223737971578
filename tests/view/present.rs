//! Presented frames do not depend on each other.

use octagloss_core::cpu::reflector::ReflectorSettings;
use octagloss_core::light::synth::synth;
use octagloss_fixtures::adapters::{in_full, wait};
use octagloss_gpu::device::readback;
use octagloss_view::screenshot;
use octagloss_view::{Display, Look, Renderer, Screenshot, Tone, Viewport};

#[test]
fn frames_of_pictures_of_several_sizes_can_share_a_submission() {
    in_full("present", |context| {
        let mut renderer = Renderer::new(context.clone()).expect("shaders that compile");
        let table = ReflectorSettings { oem_size: Some(64), ..ReflectorSettings::default() };
        let light = renderer.light(&synth("sky").expect("the sky"), &table).expect("a small map");
        let (width, height) = (48, 32);
        let format = wgpu::TextureFormat::Rgba8Unorm;
        // A picture of all samples of its frame, one coarser than it, and another tone.
        let frames = [(2, Tone::Neutral), (1, Tone::Neutral), (3, Tone::Linear)];
        let mut encoder = context.device().create_command_encoder(&Default::default());
        let mut textures = Vec::new();
        for (samples, tone) in frames {
            let look = Look { tone, ..Look::default() };
            renderer.draw(&look, &light, samples * width, samples * height).expect("a picture");
            let texture = context.device().create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            });
            let viewport = Viewport { x: 0, y: 0, width, height };
            let view = texture.create_view(&Default::default());
            renderer.present(Display { encoder: &mut encoder, view: &view, format, viewport }, &look);
            textures.push(texture);
        }
        context.queue().submit([encoder.finish()]);
        let mut alone = Vec::new();
        for ((samples, tone), texture) in frames.into_iter().zip(&textures) {
            let look = Look { tone, ..Look::default() };
            let shot = Screenshot { width, height, samples };
            let picture = wait(context, screenshot(&mut renderer, &look, &light, None, shot));
            let pixels: Vec<[u8; 4]> = wait(context, readback::read_texture(context, texture));
            let found: Vec<u8> = pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
            assert!(found == picture.bytes()[..], "{samples} samples, {tone:?} on {}", context.describe());
            alone.push(found);
        }
        assert!(alone[0] != alone[1] && alone[0] != alone[2], "the frames differ");
    });
}
