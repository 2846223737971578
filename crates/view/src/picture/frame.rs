//! Uniforms shared by every pixel of a picture, in the shaders' layout.

use crate::look::camera::Frame;
use crate::look::{self, Ball, Look};
use glam::{DMat3, DVec3};
use octagloss_core::light::environment::Environment;
use octagloss_core::light::sh;
use octagloss_gpu::live::columns;
use octagloss_gpu::stages::lamp::Lamp;
use std::f64::consts::{PI, TAU};

/// Most levels of a prefiltered cube.
pub(super) const MAX_LEVELS: usize = 16;

#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct BallUniform {
    centre: [f32; 3],
    radius: f32,
    roughness: f32,
    pad: [f32; 3],
}

/// Height of a ground so far below that nothing casts a shadow on it.
const NO_FLOOR: f64 = -1e6;

/// Uniform of a picture.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct ViewFrame {
    eye: [f32; 3],
    exposure: f32,
    right: [f32; 3],
    roughness: f32,
    up: [f32; 3],
    backdrop: f32,
    forward: [f32; 3],
    levels: f32,
    metal: [f32; 3],
    levels_scale: f32,
    tint: [f32; 3],
    roughness_factor: f32,
    size: [f32; 2],
    floor: f32,
    anisotropy: f32,
    brush: [f32; 2],
    clearcoat: f32,
    coat_roughness: f32,
    source_from_world: [[f32; 4]; 3],
    levels_from_source: [[f32; 4]; 3],
    clip_from_world: [[f32; 4]; 4],
    ladder: [[f32; 4]; MAX_LEVELS / 4],
    ball: [BallUniform; look::ROW as usize],
}

/// Parameters of the prefiltered cube.
#[derive(Clone, Copy, Debug)]
pub(super) struct LadderUniform {
    /// Number of levels.
    pub(super) count: u32,
    /// Roughness of each level.
    pub(super) roughness: [f32; MAX_LEVELS],
    /// Factor of the texels.
    pub(super) scale: f32,
    /// Maps directions in the environment's space to those of the levels.
    pub(super) levels_from_source: DMat3,
}

impl Default for LadderUniform {
    fn default() -> Self {
        let roughness = [0.0; MAX_LEVELS];
        Self { count: 1, roughness, scale: 1.0, levels_from_source: DMat3::IDENTITY }
    }
}

fn three(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

impl ViewFrame {
    /// The uniform of `look` for a picture's `frame`; `exposure` is in powers of two, `texel` the angle of
    /// the environment's texels.
    pub(super) fn new(
        look: &Look,
        frame: &Frame,
        exposure: f64,
        texel: f64,
        source_from_world: DMat3,
        size: [u32; 2],
        ladder: &LadderUniform,
    ) -> Self {
        let mut ball = [BallUniform::default(); look::ROW as usize];
        for (uniform, Ball { centre, radius, roughness }) in ball.iter_mut().zip(look.balls()) {
            *uniform = BallUniform {
                centre: three(centre),
                radius: radius as f32,
                roughness: roughness as f32,
                pad: [0.0; 3],
            };
        }
        Self {
            eye: three(frame.eye),
            exposure: exposure.exp2() as f32,
            right: three(frame.right),
            roughness: look.roughness as f32,
            up: three(frame.up),
            backdrop: look.backdrop_roughness(texel, frame.up.length()) as f32,
            forward: three(frame.forward),
            levels: ladder.count as f32,
            metal: look.metal,
            levels_scale: ladder.scale,
            tint: look.tint,
            roughness_factor: look.roughness_factor as f32,
            size: size.map(|side| side as f32),
            floor: look.floor().unwrap_or(NO_FLOOR) as f32,
            anisotropy: look.finish.anisotropy as f32,
            brush: brush(look.finish.direction),
            clearcoat: look.finish.clearcoat as f32,
            coat_roughness: look.finish.coat_roughness as f32,
            source_from_world: columns(source_from_world),
            levels_from_source: columns(ladder.levels_from_source),
            clip_from_world: frame.clip_from_world.as_mat4().to_cols_array_2d(),
            ladder: std::array::from_fn(|k| std::array::from_fn(|c| ladder.roughness[4 * k + c])),
            ball,
        }
    }
}

/// Cosine and sine of the direction of brushing in degrees, as shaders turn tangents.
pub(super) fn brush(degrees: f64) -> [f32; 2] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    [cosine as f32, sine as f32]
}

/// Uniform of the diffuse light, in the environment's space.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct Diffuse {
    /// Harmonics of irradiance over pi.
    harmonics: [[f32; 4]; sh::MAX_COUNT],
    /// Direction of the lamp, and its energy over pi.
    lamp: [f32; 4],
}

impl Diffuse {
    /// The light of `environment`, without a lamp.
    pub(super) fn new(environment: &Environment) -> Self {
        // Convolution factors of cosine over pi per band (Ramamoorthi and Hanrahan 2001, equation 8).
        const BANDS: [f64; 5] = [1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0];
        let mut harmonics = [[0.0; 4]; sh::MAX_COUNT];
        let coefficients = sh::spherical_harmonics(environment, sh::MAX_ORDER).expect("the highest");
        for (index, (uniform, coefficient)) in harmonics.iter_mut().zip(coefficients).enumerate() {
            let [red, green, blue] = coefficient.map(|c| (BANDS[sh::band(index)] * c) as f32);
            *uniform = [red, green, blue, 0.0];
        }
        Self { harmonics, lamp: [0.0; 4] }
    }

    /// Byte offset of [`Diffuse::lamp`].
    pub(super) const LAMP_OFFSET: u64 = 16 * sh::MAX_COUNT as u64;

    /// The lamp entry of the uniform for `lamp`.
    pub(super) fn of_lamp(lamp: Option<Lamp>) -> [f32; 4] {
        const STEPS: u32 = 256;
        let Some(lamp) = lamp else { return [0.0; 4] };
        let towards = lamp.direction();
        let across = towards.any_orthonormal_vector();
        // Integrate over rings around the centre, out to the edge.
        let edge = lamp.edge_angle();
        let energy: f64 = (0..STEPS)
            .map(|k| {
                let angle = (f64::from(k) + 0.5) / f64::from(STEPS) * edge;
                let (sin, cos) = angle.sin_cos();
                lamp.radiance_towards(cos * towards + sin * across) * TAU * sin * edge / f64::from(STEPS)
            })
            .sum();
        let [x, y, z] = three(towards);
        [x, y, z, (energy / PI) as f32]
    }
}

#[cfg(test)]
mod tests {
    use super::{Diffuse, ViewFrame};
    use glam::DVec3;
    use octagloss_gpu::stages::lamp::Lamp;
    use std::mem::size_of;

    #[test]
    fn the_energy_of_a_lamp_is_that_of_its_disc() {
        let lamp = Lamp::new(DVec3::new(0.0, 2.0, 0.0), 5.0, 0.05, 0.06);
        let [x, y, z, energy] = Diffuse::of_lamp(Some(lamp));
        assert_eq!([x, y, z], [0.0, 1.0, 0.0]);
        // Radiance times solid angle over pi, for discs up to the inner and the outer radius.
        let [inner, outer] = [0.05_f64, 0.06].map(|angle| 10.0 * (1.0 - angle.cos()));
        assert!((inner..outer).contains(&f64::from(energy)), "{energy} is not within {inner} to {outer}");
        assert_eq!(Diffuse::of_lamp(None), [0.0; 4]);
    }

    #[test]
    fn uniforms_are_as_large_as_the_shaders_structs() {
        let source = octagloss_shaders::source("view/levels.wgsl");
        let module = naga::front::wgsl::parse_str(&source).expect("a shader that parses");
        for (name, size) in [("ViewFrame", size_of::<ViewFrame>()), ("Diffuse", size_of::<Diffuse>())] {
            let (_, found) =
                module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).expect("a struct");
            assert_eq!(found.inner.size(module.to_ctx()) as usize, size, "{name}");
        }
    }
}
