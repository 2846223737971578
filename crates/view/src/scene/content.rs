//! Scenes of moving parts.

use super::look::SceneLook;
use super::part::{Gloss, Motion, Part};
use super::split::split;
use super::texture::Texels;
use super::uniforms::{LightUniform, MAX_PROBES, PartUniform, SceneCorner, TextureUniform};
use glam::{DMat4, DVec3};
use octagloss_core::common::error::{Error, Result, wrong};
use octagloss_gpu::triangles::{Corner, Triangles};
use octagloss_mesh::{Image, MAX_INDICES, MAX_VERTICES, box_around};
use std::f64::consts::TAU;
use std::ops::Range;

/// Light of the matte parts: a distant lamp, and light from above and below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneLight {
    /// Direction to the lamp, of any length but 0.
    pub towards: DVec3,
    /// Radiance of a white surface that faces the lamp.
    pub lamp: [f32; 3],
    /// Radiance of a white surface that faces up, without the lamp.
    pub above: [f32; 3],
    /// Radiance of a white surface that faces down.
    pub below: [f32; 3],
}

impl Default for SceneLight {
    fn default() -> Self {
        Self {
            towards: DVec3::new(-0.5, 0.8, 0.35),
            lamp: [0.55, 0.52, 0.45],
            above: [0.40, 0.44, 0.50],
            below: [0.20, 0.18, 0.16],
        }
    }
}

/// A scene that can be drawn: matte parts, then glossy ones.
#[derive(Clone, Debug)]
pub struct Scene {
    pub(super) corners: Vec<SceneCorner>,
    pub(super) indices: Vec<u32>,
    pub(super) parts: Vec<Placed>,
    pub(super) texels: Texels,
    pub(super) light: SceneLight,
    pub(super) bounds: Bounds,
    pub(super) first_look: SceneLook,
}

/// A part in the lists of its scene.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub(super) corners: Range<u32>,
    pub(super) indices: Range<u32>,
    place: DVec3,
    motion: Motion,
    pub(super) gloss: Option<Gloss>,
    base: TextureUniform,
    glow: TextureUniform,
}

/// A box and a sphere around the parts that are not distant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    pub(super) radius: f64,
}

impl Scene {
    /// A scene of `parts` without textures.
    ///
    /// # Errors
    /// Those of [`Scene::textured`].
    pub fn new(parts: Vec<Part>, light: SceneLight) -> Result<Self> {
        Self::textured(parts, &[], light)
    }

    /// A scene of `parts` with textures of `images`. Triangles with textures are split, so that maps of
    /// probes, which see colours at corners, show them.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a scene without triangles, indices out of range, numbers that are not finite,
    /// images whose texels do not match their sides, and more than [`MAX_PROBES`] glossy parts;
    /// [`Error::Limit`] for too many corners.
    pub fn textured(mut parts: Vec<Part>, images: &[Image], light: SceneLight) -> Result<Self> {
        parts.sort_by_key(|part| part.gloss.is_some());
        let glossy = parts.iter().filter(|part| part.gloss.is_some()).count();
        if glossy > MAX_PROBES {
            return wrong(format!("{glossy} glossy parts; a scene has at most {MAX_PROBES}"));
        }
        let corners: usize = parts.iter().map(|part| part.corners.len()).sum();
        let indices: usize = parts.iter().map(|part| part.indices.len()).sum();
        if corners > MAX_VERTICES || indices > MAX_INDICES {
            return Err(Error::Limit {
                what: format!("a scene of {corners} corners and {indices} indices"),
                needed: (64 * corners + 4 * indices) as u64,
                available: (64 * MAX_VERTICES + 4 * MAX_INDICES) as u64,
                remedy: "use a scene of fewer triangles".to_owned(),
            });
        }
        if indices == 0 {
            return wrong("a scene without triangles; add a part");
        }
        for (number, part) in parts.iter().enumerate() {
            part.check(number, images)?;
        }
        let bounds = Bounds::around(&parts);
        let texels = Texels::new(images, parts.iter().flat_map(Part::textures))?;
        split(&mut parts, &texels, bounds.radius);
        let mut scene = Self {
            corners: Vec::new(),
            indices: Vec::new(),
            parts: Vec::new(),
            texels,
            light,
            bounds,
            first_look: SceneLook::default(),
        };
        for (number, part) in (0..).zip(parts) {
            let [base, glow] = [part.base_texture, part.emission_texture].map(|t| scene.texels.uniform(t));
            let Part { corners, indices, place, motion, gloss, .. } = part;
            let first = [scene.corners.len() as u32, scene.indices.len() as u32];
            scene.corners.extend(corners.into_iter().map(|corner| SceneCorner { part: number, ..corner }));
            scene.indices.extend(indices.into_iter().map(|index| first[0] + index));
            scene.parts.push(Placed {
                corners: first[0]..scene.corners.len() as u32,
                indices: first[1]..scene.indices.len() as u32,
                place,
                motion,
                gloss,
                base,
                glow,
            });
        }
        Ok(scene)
    }

    /// The look that it is first shown with.
    pub const fn first_look(&self) -> SceneLook {
        self.first_look
    }

    /// Number of glossy parts, each with a place for a probe.
    pub fn glossy_parts(&self) -> usize {
        self.parts.iter().filter(|part| part.gloss.is_some()).count()
    }

    /// Indices of the glossy parts.
    pub(super) fn glossy(&self) -> Range<usize> {
        self.parts.len() - self.glossy_parts()..self.parts.len()
    }

    /// Place of part `index` at `time` in seconds.
    pub fn place(&self, index: usize, time: f64) -> DVec3 {
        let Placed { place, motion, .. } = &self.parts[index];
        *place + motion.offset(time)
    }

    fn world_from_part(&self, index: usize, time: f64) -> DMat4 {
        let turn = (self.parts[index].motion.spin * time).fract() * TAU;
        DMat4::from_translation(self.place(index, time)) * DMat4::from_rotation_y(turn)
    }

    /// The parts at `time`; glossy ones have `roughness`, or their own. The first `probes` of these have
    /// probes.
    pub(super) fn part_uniforms(&self, time: f64, roughness: Option<f64>, probes: usize) -> Vec<PartUniform> {
        let with_probes = || self.glossy().take(probes);
        let uniform = |(index, part): (usize, &Placed)| {
            let away = |other: &usize| self.place(*other, time).distance_squared(self.place(index, time));
            let own = with_probes().position(|other| other == index);
            let nearest = || with_probes().min_by(|a, b| away(a).total_cmp(&away(b)));
            let probe = own.or_else(|| nearest().map(|part| part - self.glossy().start));
            let gloss = part.gloss.unwrap_or(Gloss { reflectance: [0.0; 3], roughness: 0.0 });
            PartUniform {
                world_from_part: self.world_from_part(index, time).as_mat4().to_cols_array_2d(),
                reflectance: gloss.reflectance,
                roughness: roughness.unwrap_or(gloss.roughness) as f32,
                base: part.base,
                glow: part.glow,
                probe: probe.unwrap_or(0) as u32,
                own: u32::from(own.is_some()),
                pad: [0; 2],
            }
        };
        self.parts.iter().enumerate().map(uniform).collect()
    }

    pub(super) fn light_uniform(&self) -> LightUniform {
        let SceneLight { towards, lamp, above, below } = self.light;
        let towards = towards.normalize_or(DVec3::Y).as_vec3().to_array();
        LightUniform { towards, pad_0: 0.0, lamp, pad_1: 0.0, above, pad_2: 0.0, below, pad_3: 0.0 }
    }

    /// The triangles around part `hidden` at time 0, without radiance. That part is a point at the centre, as
    /// in the map of its probe.
    ///
    /// # Errors
    /// [`Error::Parameter`] for corners beyond [`octagloss_gpu::triangles::MAX`].
    pub fn triangles(&self, hidden: usize) -> Result<Triangles> {
        let world: Vec<DMat4> = (0..self.parts.len()).map(|part| self.world_from_part(part, 0.0)).collect();
        let posed = |corner: &SceneCorner| {
            let part = corner.part as usize;
            let position = world[part].transform_point3(corner.place());
            let position = if part == hidden { DVec3::ZERO } else { position - self.place(hidden, 0.0) };
            Corner::new(position.as_vec3().to_array(), [0.0; 4])
        };
        Triangles::new(self.corners.iter().map(posed).collect(), self.indices.clone())
    }
}

impl Bounds {
    /// Bounds of the matte parts that neither move nor are distant, or of all that are not distant.
    fn around(parts: &[Part]) -> Self {
        let still = |part: &&Part| part.motion == Motion::default() && !part.distant && part.gloss.is_none();
        let chosen: Vec<&Part> = match parts.iter().filter(still).count() {
            0 => parts.iter().filter(|part| !part.distant).collect(),
            _ => parts.iter().filter(still).collect(),
        };
        let points =
            || chosen.iter().flat_map(|part| part.corners.iter().map(|corner| part.place + corner.place()));
        let (low, high) = box_around(points());
        let centre = 0.5 * (low + high);
        let radius = points().map(|at| at.distance(centre)).fold(0.0, f64::max);
        Self { low, high, radius }
    }
}

#[cfg(test)]
mod tests {
    use super::{Gloss, Part, Scene, SceneLight};
    use crate::scene::uniforms::MAX_PROBES;
    use glam::DVec3;
    use octagloss_core::common::error::Error;
    use octagloss_mesh::{Image, Texture, Wrap};

    fn message(parts: Vec<Part>) -> String {
        Scene::new(parts, SceneLight::default()).expect_err("an invalid scene").to_string()
    }

    #[test]
    fn bad_scenes_are_errors_that_name_the_place() {
        let ball = || Part::ball(1.0, 4, [0.5; 3], [0.0; 3]);
        let with = |change: fn(&mut Part)| {
            let mut part = ball();
            change(&mut part);
            vec![ball(), part]
        };
        let cases: [(Vec<Part>, &[&str]); 8] = [
            (Vec::new(), &["without triangles"]),
            (vec![Part::default()], &["without triangles"]),
            (with(|part| part.corners[3].position[1] = f32::NAN), &["corner 3 of part 1", "NaN", "finite"]),
            (with(|part| part.corners[2].emission[0] = f32::INFINITY), &["corner 2 of part 1", "finite"]),
            (with(|part| part.indices[4] = 1000), &["index 1000 at position 4 of part 1", "45 corners"]),
            (with(|part| part.indices.truncate(4)), &["4 indices of part 1", "whole triangles"]),
            (with(|part| part.place = DVec3::NAN), &["part 1", "finite"]),
            (
                with(|part| part.gloss = Some(Gloss { reflectance: [1.0; 3], roughness: 1.5 })),
                &["part 1", "roughness 1.5", "0 to 1"],
            ),
        ];
        for (parts, expected) in cases {
            let message = message(parts);
            assert!(expected.iter().all(|part| message.contains(part)), "{message}");
        }
        let texture = |image| Some(Texture { image, wrap: [Wrap::Repeat; 2], nearest: false });
        let image = Image { width: 2, height: 2, texels: vec![[0; 4]; 3] };
        for (number, words) in [(1, "part 0 has image 1 for a texture"), (0, "image 0 of 2 x 2 texels has 3")]
        {
            let part = Part { emission_texture: texture(number), ..ball() };
            let scene = Scene::textured(vec![part], std::slice::from_ref(&image), SceneLight::default());
            let message = scene.expect_err("a bad texture").to_string();
            assert!(message.contains(words), "{message}");
        }
        let gloss = Some(Gloss { reflectance: [1.0; 3], roughness: 0.5 });
        let many = vec![Part { gloss, ..ball() }; MAX_PROBES + 1];
        assert!(message(many).contains("at most 8"));
        let far = Part { place: DVec3::splat(1e20), ..ball() };
        let scene = Scene::new(vec![ball(), far], SceneLight::default()).expect("finite");
        let error = scene.triangles(0).expect_err("too far");
        assert!(matches!(&error, Error::Parameter(text) if text.contains("at most")), "{error}");
    }
}
