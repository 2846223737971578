//! An environment's light without its maps, as shaders hold it.

use super::cells::BASIS;
use super::{Pyramid, suns};
use bytemuck::{Pod, Zeroable};
use glam::DMat3;

/// A sun: `OctaglossSun` of the shaders.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct OctaglossSun {
    /// Mean direction of red light, and the mean squared distance of its light from its disc's centre.
    pub red: [f32; 4],
    /// The same of green light.
    pub green: [f32; 4],
    /// The same of blue light.
    pub blue: [f32; 4],
    /// Radiance times solid angle.
    pub energy: [f32; 3],
    pad: f32,
}

/// `OctaglossLight` of the shaders.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct OctaglossLight {
    /// Columns of the rotation that takes a direction of the map to one of the world.
    pub world_from_source: [[f32; 4]; 3],
    /// The power of two that scales the maps.
    pub scale: f32,
    /// Its inverse.
    pub unscale: f32,
    /// What the rest is clamped to, scaled.
    pub clamp: f32,
    pad: f32,
    /// Harmonics of the rest, scaled. The fourth components of the first 24 are the suns' half axes, three
    /// for each: so 64 lights fit in a uniform buffer.
    pub harmonics: [[f32; 4]; BASIS],
    /// Suns.
    pub suns: [OctaglossSun; suns::COUNT],
    pad_to_256: [f32; 12],
}

impl OctaglossLight {
    /// The light of `pyramid`, turned; 2^`exponent` times its light is that of the source.
    pub(crate) fn new(pyramid: &Pyramid, exponent: i32, world_from_source: DMat3) -> Self {
        let power = |exponent: i32| f64::from(exponent).exp2() as f32;
        let column = |axis: glam::DVec3| axis.as_vec3().extend(0.0).to_array();
        let mut light = Self::zeroed();
        light.world_from_source =
            [world_from_source.x_axis, world_from_source.y_axis, world_from_source.z_axis].map(column);
        (light.scale, light.unscale) =
            (power(-pyramid.exponent - exponent), power(pyramid.exponent + exponent));
        light.clamp = (f64::from(pyramid.suns.clamp) * f64::from(-pyramid.exponent).exp2()) as f32;
        light.harmonics = pyramid.harmonics.map(|harmonic| harmonic.extend(0.0).to_array());
        for (own, sun) in light.suns.iter_mut().zip(&pyramid.suns.suns) {
            let [red, green, blue] =
                sun.channels.map(|channel| channel.direction.extend(channel.spread).to_array());
            let energy =
                sun.channels.map(|channel| (f64::from(channel.energy) * f64::from(exponent).exp2()) as f32);
            *own = OctaglossSun { red, green, blue, energy, pad: 0.0 };
        }
        for (k, sun) in pyramid.suns.suns.iter().enumerate() {
            (0..3).for_each(|axis| light.harmonics[3 * k + axis][3] = sun.half_axis[axis]);
        }
        light
    }

    /// The half axis of sun `k`.
    pub(crate) fn half_axis(&self, k: usize) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.harmonics[3 * k + axis][3])
    }
}
