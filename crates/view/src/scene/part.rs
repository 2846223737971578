//! Parts of scenes: triangles that move as one.

use super::uniforms::SceneCorner;
use glam::DVec3;
use octagloss_core::common::error::{Result, wrong};
use octagloss_mesh::{Image, Texture};
use std::f64::consts::{PI, TAU};

/// A metal that reflects its surroundings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gloss {
    /// Reflectance, linear, the same at every angle.
    pub reflectance: [f32; 3],
    /// Perceptual roughness in \[0, 1\].
    pub roughness: f64,
}

/// How a part moves: on an ellipse around its place, turning about +Y.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Offset at phase 0.
    pub axis: DVec3,
    /// Offset at a quarter of the round.
    pub across: DVec3,
    /// Rounds per second.
    pub rate: f64,
    /// Start in rounds.
    pub phase: f64,
    /// Turns about +Y per second.
    pub spin: f64,
}

/// Triangles that move as one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Corners in the part's space.
    pub corners: Vec<SceneCorner>,
    /// Three indices per triangle.
    pub indices: Vec<u32>,
    /// Place of the part's origin in the world. The probe of a glossy part is there.
    pub place: DVec3,
    /// Motion around the place.
    pub motion: Motion,
    /// Its reflections; `None` for matte parts.
    pub gloss: Option<Gloss>,
    /// Whether it is far away, as a sky: proxies do not enclose it.
    pub distant: bool,
    /// Factors of the corners' albedo, in sRGB. Glossy parts have none.
    pub base_texture: Option<Texture>,
    /// Factors of the corners' emission, in sRGB.
    pub emission_texture: Option<Texture>,
}

impl Part {
    /// A ball around its origin, with `along` edges from pole to pole.
    pub fn ball(radius: f64, along: u32, albedo: [f32; 3], emission: [f32; 3]) -> Self {
        let (along, around) = (along.max(3), 2 * along.max(3));
        let mut part = Self::default();
        for j in 0..=along {
            let (ring, y) = (f64::from(j) / f64::from(along) * PI).sin_cos();
            for i in 0..=around {
                let (sin, cos) = (f64::from(i % around) / f64::from(around) * TAU).sin_cos();
                let normal = DVec3::new(ring * cos, y, ring * sin);
                let [position, normal] = [radius * normal, normal].map(|v| v.as_vec3().to_array());
                part.corners.push(SceneCorner::new(position, normal, albedo, emission));
            }
        }
        for (j, i) in (0..along).flat_map(|j| (0..around).map(move |i| (j, i))) {
            let at = j * (around + 1) + i;
            let below = at + around + 1;
            part.indices.extend([at, at + 1, below, at + 1, below + 1, below]);
        }
        part
    }

    /// A box with half edges `half` around its origin, whose faces have `parts` squares along an edge.
    /// `colour` gives albedo and emission by outward axis and position.
    pub fn cuboid(half: DVec3, parts: u32, colour: impl Fn(DVec3, DVec3) -> [[f32; 3]; 2]) -> Self {
        let mut part = Self::default();
        for axis in DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
            let right = DVec3::new(axis.y, axis.z, axis.x);
            let up = axis.cross(right);
            let normal = axis.as_vec3().to_array();
            let side = |k: u32| 2.0 * f64::from(k) / f64::from(parts) - 1.0;
            for (j, i) in (0..parts).flat_map(|j| (0..parts).map(move |i| (j, i))) {
                // Squares have corners of their own, so that colours may change from one to the next.
                let place = |i: u32, j: u32| half * (axis + side(i) * right + side(j) * up);
                let middle = 0.5 * (place(i, j) + place(i + 1, j + 1));
                let [albedo, emission] = colour(axis, middle);
                let first = part.corners.len() as u32;
                for at in [place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)] {
                    let position = at.as_vec3().to_array();
                    part.corners.push(SceneCorner::new(position, normal, albedo, emission));
                }
                part.indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
            }
        }
        part
    }

    /// The box of [`Self::cuboid`] from inside.
    pub fn room(half: DVec3, parts: u32, colour: impl Fn(DVec3, DVec3) -> [[f32; 3]; 2]) -> Self {
        let mut part = Self::cuboid(half, parts, colour);
        for corner in &mut part.corners {
            corner.normal = corner.normal.map(|along| -along);
        }
        part
    }

    /// The textures that it shows.
    pub(super) fn textures(&self) -> impl Iterator<Item = Texture> + use<> {
        [self.base_texture, self.emission_texture].into_iter().flatten()
    }

    /// Checks it as part `number` of a scene with `images`.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for indices out of range and numbers that are not
    /// finite.
    pub(super) fn check(&self, number: usize, images: &[Image]) -> Result<()> {
        let Self { corners, indices, place, motion, gloss, .. } = self;
        let Motion { axis, across, rate, phase, spin } = *motion;
        let numbers = [rate, phase, spin, gloss.map_or(0.0, |gloss| gloss.roughness)];
        let vectors = [*place, axis, across];
        if !(numbers.iter().all(|x| x.is_finite()) && vectors.iter().all(|v| v.is_finite())) {
            return wrong(format!("part {number} has a place or motion that is not finite"));
        }
        if let Some(gloss) = gloss.filter(|gloss| !(0.0..=1.0).contains(&gloss.roughness)) {
            return wrong(format!("part {number} has roughness {}; use 0 to 1", gloss.roughness));
        }
        let finite = |corner: &SceneCorner| {
            let SceneCorner { position, normal, albedo, emission, u, v, .. } = corner;
            let numbers = [position, normal, albedo, emission].into_iter().flatten().chain([u, v]);
            numbers.copied().all(f32::is_finite)
        };
        if let Some(at) = corners.iter().position(|corner| !finite(corner)) {
            let SceneCorner { position: [x, y, z], .. } = corners[at];
            return wrong(format!(
                "corner {at} of part {number}, at ({x}, {y}, {z}), is not finite; use finite numbers"
            ));
        }
        if let Some(at) = indices.iter().position(|index| *index as usize >= corners.len()) {
            return wrong(format!(
                "index {} at position {at} of part {number} is out of range for {} corners",
                indices[at],
                corners.len()
            ));
        }
        if !indices.len().is_multiple_of(3) {
            return wrong(format!("{} indices of part {number} are not whole triangles", indices.len()));
        }
        if let Some(texture) = self.textures().find(|texture| texture.image >= images.len()) {
            return wrong(format!(
                "part {number} has image {} for a texture, but the scene has {} images",
                texture.image,
                images.len()
            ));
        }
        Ok(())
    }
}

impl Motion {
    /// Offset from the place at `time` in seconds.
    pub(super) fn offset(&self, time: f64) -> DVec3 {
        let (sin, cos) = ((self.rate * time + self.phase).fract() * TAU).sin_cos();
        cos * self.axis + sin * self.across
    }
}
