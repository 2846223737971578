//! A pyramid with what its files need besides.

use super::levels::{BRIGHTEST, Map};
use super::light::OctaglossLight;
use super::suns::{self, Sun, SunChannel, Suns};
use super::{Levels, Pyramid, PyramidLobes};
use crate::common::error::{Result, wrong};
use crate::cpu::reparameterise::oem_from_environment;
use crate::light::environment::{Environment, Rgb};
use crate::light::light_scale::LightScale;
use crate::light::oem::OemSize;
use glam::{DMat3, DVec3, Vec3A};

/// Float32 holds powers of two up to this exponent, and their inverses.
const MAX_EXPONENT: i32 = 126;

/// The pyramid of one environment, in its own space and units.
#[derive(Clone, Debug)]
pub struct BakedPyramid {
    pub(crate) pyramid: Pyramid,
    pub(crate) light: OctaglossLight,
}

impl BakedPyramid {
    /// The pyramid of `environment` over a map of `size` texels along an edge.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for a `size` that is not a power of two from 32 to 2048,
    /// and for light that is too dim or too bright for shaders in float32;
    /// [`crate::common::error::Error::Limit`] if the overlaps of texels exceed the memory.
    pub(crate) fn new(environment: &Environment, size: u32) -> Result<Self> {
        Levels::over(size)?;
        let scale = LightScale::new(environment);
        let size = OemSize { inner: size, border: 0 };
        let pyramid = Pyramid::of_oem(&oem_from_environment(&scale.scaled(environment), size)?)?;
        let exponent = pyramid.exponent - scale.exponent();
        let light =
            OctaglossLight::new(&pyramid, -scale.exponent(), environment.source_from_world().transpose());
        let is_finite = light.suns.iter().flat_map(|sun| sun.energy).all(f32::is_finite);
        let brightest = exponent + BRIGHTEST;
        // Pixels may round light up to the next power of two, and weights exceed 1.
        if exponent < -MAX_EXPONENT || brightest >= f32::MAX_EXP || !is_finite {
            return wrong(format!(
                "light of about 2^{brightest} is beyond what shaders multiply in float32; choose a `scale` \
                 that brings it near 1"
            ));
        }
        Ok(Self { pyramid, light })
    }

    /// That of a file, whose light is checked.
    ///
    /// # Errors
    /// What is wrong with the light.
    pub(crate) fn of_parts(
        levels: Levels,
        maps: Vec<Map>,
        cosine: Option<Map>,
        light: OctaglossLight,
    ) -> std::result::Result<Self, String> {
        let numbers: &[f32] = bytemuck::cast_slice(std::slice::from_ref(&light));
        if let Some(number) = numbers.iter().find(|number| !number.is_finite()) {
            return Err(format!("{number} among its numbers"));
        }
        let axes = light.world_from_source.map(|[x, y, z, _]| Vec3A::new(x, y, z));
        let products = (0..9).map(|k| axes[k / 3].dot(axes[k % 3]) - f32::from(u8::from(k / 3 == k % 3)));
        if products.into_iter().any(|off| off.abs() > 1e-3) {
            return Err("its rotation is none".to_owned());
        }
        let exponent = light.unscale.log2();
        if light.unscale <= 0.0 || exponent.fract() != 0.0 || exponent.abs() > MAX_EXPONENT as f32 {
            return Err(format!("a scale of {}, no power of two", light.unscale));
        }
        let mut axes = (0..suns::COUNT).map(|k| light.half_axis(k));
        let suns = light.suns.map(|sun| {
            let mut energies = sun.energy.into_iter();
            let channels = [sun.red, sun.green, sun.blue].map(|[x, y, z, spread]| SunChannel {
                direction: Vec3A::new(x, y, z),
                spread,
                energy: energies.next().unwrap_or_default(),
            });
            Sun { channels, half_axis: axes.next().unwrap_or_default().into() }
        });
        let is_sound = |channel: &SunChannel| {
            let is_unit = (channel.direction.length_squared() - 1.0).abs() < 1e-3;
            channel.energy == 0.0 || (channel.energy > 0.0 && channel.spread >= 0.0 && is_unit)
        };
        if !suns.iter().flat_map(|sun| &sun.channels).all(is_sound) {
            return Err("a sun without a direction or of negative light".to_owned());
        }
        let suns = Suns { suns, clamp: light.clamp * light.unscale, greatest: f32::MAX };
        let harmonics = light.harmonics.map(|[r, g, b, _]| Vec3A::new(r, g, b));
        let pyramid = Pyramid { levels, maps, cosine, harmonics, suns, exponent: exponent as i32 };
        Ok(Self { pyramid, light })
    }

    /// GGX lobes of `roughness` in [0, 1] in the world.
    pub(crate) fn lobes(&self, roughness: f32) -> WorldLobes<'_> {
        WorldLobes { lobes: self.pyramid.lobes(roughness), source_from_world: self.source_from_world() }
    }

    /// Irradiance on a surface with `normal` (in the world, any length but zero) over pi.
    pub(crate) fn irradiance(&self, normal: DVec3) -> Rgb {
        self.pyramid.irradiance(self.source_from_world() * normal)
    }

    fn source_from_world(&self) -> DMat3 {
        let column = |[x, y, z, _]: [f32; 4]| DVec3::new(x.into(), y.into(), z.into());
        let [x, y, z] = self.light.world_from_source.map(column);
        DMat3::from_cols(x, y, z).transpose()
    }

    /// Its levels.
    pub(crate) const fn levels(&self) -> Levels {
        self.pyramid.levels
    }
}

/// Lobes of one roughness in the world.
pub(crate) struct WorldLobes<'a> {
    lobes: PyramidLobes<'a>,
    source_from_world: DMat3,
}

impl WorldLobes<'_> {
    /// Radiance of a reflection around `direction` (any length but zero).
    pub(crate) fn radiance(&self, direction: DVec3) -> Rgb {
        self.lobes.radiance(self.source_from_world * direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::environment::Layout;

    #[test]
    fn light_that_shaders_cannot_multiply_is_an_error() {
        let constant = |light: f32| {
            let texels = vec![[light; 3]; 32];
            let environment = Environment::new(Layout::Panorama { width: 8, height: 4 }, texels);
            BakedPyramid::new(&environment.expect("light"), 64)
        };
        for light in [1e-30, 1.0, 1.6e38] {
            assert!(constant(light).is_ok(), "{light}");
        }
        for light in [1.8e38, f32::MAX] {
            let error = constant(light).map(|_| ()).expect_err("light that pixels round up to infinity");
            assert!(error.to_string().contains("choose a `scale`"), "{light}: {error}");
        }
    }
}
