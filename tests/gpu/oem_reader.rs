//! The shader code that `--target oem` ships, run with an ordinary sampler over the file's levels.

use crate::look;
use octagloss_core::files::format::Pixel;
use octagloss_core::files::format::container::Container;
use octagloss_core::files::io::oem_write::oem_bytes;
use octagloss_core::light::chain::Level;
use octagloss_fixtures::adapters::in_full;
use octagloss_fixtures::files::oem_file::{directions, levels, read_ktx2, unfolded};
use octagloss_gpu::Context;
use octagloss_shaders::reader;

const SIDE: u32 = 48;
const LEVELS: u32 = 4;

/// Runs `reader` for each of `queries` (direction and roughness) over the file's `levels`.
fn read_on(context: &Context, reader: &str, levels: &[Level], queries: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let file = oem_bytes(Container::Ktx2, levels, Pixel::F16, &[]).unwrap();
    let (images, _) = read_ktx2(&file);
    let (device, queue) = (context.device(), context.queue());
    let size = wgpu::Extent3d { width: images[0].0, height: images[0].0, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("map"),
        size,
        mip_level_count: LEVELS,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, (side, texels)) in (0_u32..).zip(&images) {
        let bytes: Vec<u8> = texels.as_flattened().iter().flat_map(|half| half.to_le_bytes()).collect();
        queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: level, ..texture.as_image_copy() },
            &bytes,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(8 * side), rows_per_image: None },
            wgpu::Extent3d { width: *side, height: *side, depth_or_array_layers: 1 },
        );
    }
    // Clamped, not wrapped, as is the default for textures.
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    });
    let source = format!(
        "{reader}
        @group(0) @binding(0) var map: texture_2d<f32>;
        @group(0) @binding(1) var linear: sampler;
        @group(0) @binding(2) var<storage, read> asked: array<vec4<f32>>;
        @group(0) @binding(3) var<storage, read_write> answers: array<vec4<f32>>;
        @compute @workgroup_size(64) fn look(@builtin(global_invocation_id) id: vec3<u32>) {{
            if id.x < arrayLength(&asked) {{
                let query = asked[id.x];
                answers[id.x] = vec4<f32>(oem_radiance(map, linear, query.xyz, query.w), 1.0);
            }}
        }}"
    );
    let view = texture.create_view(&Default::default());
    let map = [wgpu::BindingResource::TextureView(&view), wgpu::BindingResource::Sampler(&sampler)];
    look::answers(context, &source, &map, queries)
}

fn queries() -> Vec<[f32; 4]> {
    let roughness = [0.0, 1.0, 1.0 / 3.0, 0.5, 0.77];
    let all = directions().into_iter().enumerate();
    all.map(|(k, d)| [d.x as f32, d.y as f32, d.z as f32, roughness[k % 5]]).collect()
}

/// Returns the greatest difference from trilinear interpolation on the unfolded plane; texels are between 0
/// and 1.
fn worst(levels: &[Level], queries: &[[f32; 4]], answers: &[[f32; 4]]) -> f64 {
    assert_eq!(queries.len(), answers.len());
    let off = queries.iter().zip(answers).map(|([x, y, z, roughness], answer)| {
        let direction = glam::DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z));
        let place = f64::from(*roughness) * f64::from(LEVELS - 1);
        let low = (place.floor() as usize).min(levels.len() - 2);
        let [fine, coarse] = [low, low + 1].map(|level| unfolded(&levels[level], direction));
        let share = place - low as f64;
        (0..3)
            .map(|c| (fine[c] + (coarse[c] - fine[c]) * share - f64::from(answer[c])).abs())
            .fold(0.0, f64::max)
    });
    off.fold(0.0, f64::max)
}

/// Samplers have at least 8 fractional bits of texel position and of level (Vulkan's `subTexelPrecisionBits`
/// and `mipmapPrecisionBits`): up to 1/256 of the difference of two texels three times over. Some interpolate
/// half floats at half precision.
const TOLERANCE: f64 = 3.0 / 256.0 + 2.0 / 1024.0;

#[test]
fn the_reader_looks_up_across_folds_edges_and_corners() {
    in_full("oem reader", |context| {
        let reader = reader("oem.wgsl").expect("a reader");
        let levels = levels(SIDE, LEVELS, 9);
        let queries = queries();
        let answers = read_on(context, &reader, &levels, &queries);
        let off = worst(&levels, &queries, &answers);
        assert!(off < TOLERANCE, "{}: {off}", context.describe());
        // The comparison detects a reader that takes the border for a part of the map, and one that folds to
        // the wrong side.
        for (right, wrong) in [("border / side", "0.0 * border / side"), ("p.x >= 0.0", "p.x < 0.0")] {
            assert!(reader.contains(right), "{right}");
            let answers = read_on(context, &reader.replace(right, wrong), &levels, &queries);
            assert!(worst(&levels, &queries, &answers) > 10.0 * TOLERANCE, "{wrong}");
        }
    });
}
