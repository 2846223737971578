//! Prefiltered cubes on the GPU: a bake's own levels, or those of an environment.

use super::frame::{LadderUniform, MAX_LEVELS};
use glam::DMat3;
use half::f16;
use octagloss_core::common::error::{Error, Result, wrong};
use octagloss_core::light::chain::Chain;
use octagloss_core::light::environment::Layout;
use octagloss_gpu::Context;
use octagloss_gpu::device::resources::{filled_texture, write_level};

/// The levels of a bake, shown unchanged.
#[derive(Clone, Debug)]
pub struct Levels {
    pub(super) chain: Chain,
    pub(super) levels_from_world: DMat3,
}

impl Levels {
    /// The levels of `chain`; `levels_from_world` maps world directions to theirs. `None` for a single level
    /// and for other maps than cubes, which are plain environments.
    ///
    /// # Errors
    /// [`Error::Parameter`] for sizes that do not halve, decreasing roughness, and more than the supported
    /// number of levels.
    pub fn new(chain: Chain, levels_from_world: DMat3) -> Result<Option<Self>> {
        let is_cube = chain.levels.iter().all(|level| matches!(level.layout, Layout::Cube { .. }));
        if chain.levels.len() < 2 || !is_cube {
            return Ok(None);
        }
        let largest = chain.levels[0].size();
        let refused = |message: String| wrong(format!("cannot show these levels: {message}"));
        if chain.levels.len() > MAX_LEVELS {
            return refused(format!("{} levels; at most {MAX_LEVELS} are supported", chain.levels.len()));
        }
        for (number, level) in (0..).zip(&chain.levels) {
            let expected = largest.checked_shr(number).unwrap_or(0).max(1);
            if level.size() != expected || level.texels.len() != 6 * expected as usize * expected as usize {
                return refused(format!(
                    "level {number} has {} texels per side instead of {expected}",
                    level.size()
                ));
            }
        }
        if largest.ilog2() + 1 < chain.levels.len() as u32 {
            return refused(format!("{} levels for faces of {largest} texels", chain.levels.len()));
        }
        if let Some([a, b]) = chain.levels.array_windows().find(|[a, b]| a.roughness > b.roughness) {
            return refused(format!(
                "roughness {} follows {}; it must not decrease",
                b.roughness, a.roughness
            ));
        }
        Ok(Some(Self { chain, levels_from_world }))
    }
}

/// A prefiltered cube of half floats.
#[derive(Debug)]
pub(super) struct Cube {
    pub(super) view: wgpu::TextureView,
    pub(super) ladder: LadderUniform,
}

/// Uploads `chain` as a texture, scaled by a power of two if its range exceeds that of half floats, for a
/// world whose light is multiplied by 2^`light`.
pub(super) fn upload(
    context: &Context,
    chain: &Chain,
    levels_from_source: DMat3,
    light: i32,
) -> Result<Cube> {
    let size = chain.levels[0].size();
    let most = context.device().limits().max_texture_dimension_2d;
    if size > most {
        return Err(Error::Limit {
            what: format!("a cube of {size} x {size} texels a face"),
            needed: 48 * u64::from(size).pow(2),
            available: 48 * u64::from(most).pow(2),
            remedy: "choose a filter other than levels".to_owned(),
        });
    }
    let count = chain.levels.len() as u32;
    let format = wgpu::TextureFormat::Rgba16Float;
    let texture = filled_texture(context, "prefiltered cube", format, [size, size, 6], count);
    let texels = chain.levels.iter().flat_map(|level| level.texels.as_flattened());
    let exponent = exponent_of(texels.copied().fold(0.0, f32::max));
    // Scale in two steps, each within the range of float32.
    let (first, second) = (exponent / 2, exponent - exponent / 2);
    let scale = |value: f32| value * (-first as f32).exp2() * (-second as f32).exp2();
    for (mip_level, level) in (0..).zip(&chain.levels) {
        let texels: Vec<[f16; 4]> = level
            .texels
            .iter()
            .map(|[r, g, b]| [scale(*r), scale(*g), scale(*b), 1.0].map(f16::from_f32))
            .collect();
        write_level(context, &texture, mip_level, bytemuck::cast_slice(&texels));
    }
    let view = texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::Cube),
        ..Default::default()
    });
    let mut roughness = [0.0; MAX_LEVELS];
    for (value, level) in roughness.iter_mut().zip(&chain.levels) {
        *value = level.roughness as f32;
    }
    let scale = ((exponent + light) as f32).exp2();
    Ok(Cube { view, ladder: LadderUniform { count, roughness, scale, levels_from_source } })
}

/// log2 of the divisor for light of at most `brightest`: 0 if it suits half floats.
fn exponent_of(brightest: f32) -> i32 {
    if brightest == 0.0 || (1.0 / 16.0..=f16::MAX.to_f32()).contains(&brightest) {
        return 0;
    }
    // The brightest texel lies in [2^14, 2^15).
    (f64::from(brightest).log2().floor() as i32 - 14).clamp(-120, 120)
}

#[cfg(test)]
mod tests {
    use super::exponent_of;

    #[test]
    fn half_floats_hold_what_is_scaled() {
        for brightest in [0.0, 0.07, 1.0, 65504.0] {
            assert_eq!(exponent_of(brightest), 0, "{brightest}");
        }
        for brightest in [1e-30_f32, 1e-3, 65505.0, 1e9, 3e38] {
            let scaled = f64::from(brightest) / f64::from(exponent_of(brightest)).exp2();
            assert!((16384.0..32768.0).contains(&scaled), "{brightest} becomes {scaled}");
        }
    }
}
