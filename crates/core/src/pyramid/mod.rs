//! One pyramid: glossy reflections of any roughness from a few bilinear reads.
//!
//! ```text
//! OEM --suns--> suns
//!  +--mirror--> mirror
//!  +--the rest --sharp--> s = .011 --cascade--> .022 --cascade--> .044 ... .35
//!        |                                        middle levels .125, .25 <--+
//!        +--cells--> cosine level, harmonics
//!
//! L(d, r) = sum of w_k(r) level_k(d) + sum of a_l(r) (harmonics of order l at d) + suns
//! ```
//!
//! Levels are octahedral maps of the environment under Gaussian lobes exp(-(1 - cos t) / s^2); s doubles as
//! the texels halve, down to s = .35 at 32 x 32. The weights are a table over roughness ([`fit`]). CPU and
//! GPU build the levels by the same algorithm ([`levels`]), `shaders/pyramid/`.

pub mod albedo;
pub mod anisotropic;
mod baked;
pub mod brdf;
pub mod cells;
mod cube;
mod descent;
pub mod fit;
pub mod levels;
pub mod light;
pub mod places;
pub mod reads;
mod reflect;
pub(crate) mod sharp;
pub mod suns;

use crate::common::error::{Result, wrong};
use crate::common::vector::Arch;
use crate::cpu::reparameterise::oem_from_environment;
use crate::light::environment::Environment;
use crate::light::environment::Rgb;
use crate::light::oem::{Oem, OemSize};
use crate::light::sh::basis;
use crate::light::sh::scale::COSINE as COSINE_BANDS;
pub use baked::BakedPyramid;
use cells::{BASIS, Cells};
use fit::{COSINE, LOBE, MIDDLE, ORDERS, WEIGHTS, weights_at};
use glam::{DVec3, Vec3A};
use levels::Map;
use suns::{GlossySuns, Suns};

/// Texels along an edge of the coarsest level.
pub const COARSEST: u32 = 32;

/// Standard deviation of the coarsest level's Gaussian.
pub const WIDEST: f64 = 0.35;

/// Layers of an environment's squares.
pub const SQUARES: u32 = 3;

/// The layer of the two finest levels.
pub const FINE_LAYER: u32 = 0;

/// That of the mirror, the middle levels and the cosine level.
pub const MIRROR_LAYER: u32 = 1;

/// That of the sharp level and the others.
pub const SHARP_LAYER: u32 = 2;

/// Where a map of a pyramid stands among the squares of its textures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Square {
    /// One of [`SQUARES`].
    pub layer: u32,
    /// MIP level of the layer.
    pub mip: u32,
}

/// The levels of a pyramid, which follow from the size of its map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Octaves {
    count: u32,
    middles: u32,
}

impl Octaves {
    /// Most levels: those of a map of 2048 x 2048.
    pub const MOST: u32 = 7;

    /// Texels along an edge of the largest map.
    pub const LARGEST: u32 = COARSEST << (Self::MOST - 1);

    /// The sizes of maps, from small to large.
    pub fn sizes() -> impl DoubleEndedIterator<Item = u32> {
        (0..Self::MOST).map(|octave| COARSEST << octave)
    }

    /// The least size of a map that is at least `inner`, or the largest there is.
    pub fn size_for(inner: u32) -> u32 {
        Self::sizes().find(|size| *size >= inner).unwrap_or(Self::LARGEST)
    }

    /// Texels along an edge of a map whose sharp level is half as wide as lobes of `alpha`, or finer.
    pub(crate) fn texels_for(alpha: f64) -> u32 {
        (WIDEST * f64::from(COARSEST) / alpha).min(f64::from(Self::LARGEST)).ceil() as u32
    }

    /// The levels over a map of `inner` texels along an edge.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for an `inner` that is not a power of two from 32 to 2048.
    pub fn over(inner: u32) -> Result<Self> {
        if Self::sizes().any(|size| size == inner) {
            let count = inner.ilog2() - COARSEST.ilog2() + 1;
            return Ok(Self { count, middles: count.saturating_sub(2).min(2) });
        }
        wrong(format!(
            "an OEM of {inner} texels has no pyramid; choose a power of two from {COARSEST} to {} as \
             `oem_size`",
            Self::LARGEST
        ))
    }

    /// Those of the same map on a cube, which has no room for middle levels.
    pub(crate) const fn on_cubes(self) -> Self {
        Self { middles: 0, ..self }
    }

    /// The number of levels, without the sharp ones and the middle ones.
    pub const fn count(self) -> u32 {
        self.count
    }

    /// The number of middle levels, between the coarsest levels.
    pub const fn middles(self) -> u32 {
        self.middles
    }

    /// The level that `middle`, 0 the finest, lies half an octave above.
    pub const fn below_middle(self, middle: u32) -> u32 {
        self.count - 1 - self.middles + middle
    }

    /// Standard deviation of the Gaussian of `middle`.
    pub fn middle_width(self, middle: u32) -> f64 {
        self.width(self.below_middle(middle)) * std::f64::consts::SQRT_2
    }

    /// Texels along an edge of the map.
    pub const fn inner(self) -> u32 {
        COARSEST << (self.count - 1)
    }

    /// MIP levels of the squares. The coarsest have 64 texels along an edge, and 32 where the map has less
    /// than 512; 16 of the smallest map.
    pub const fn mips(self) -> u32 {
        let (levels, others) = (self.count - 1, self.middles + 2);
        if levels > others { levels } else { others }
    }

    /// Size of the squares of MIP level `mip`, with borders that halve with the levels.
    pub const fn size(self, mip: u32) -> OemSize {
        OemSize { inner: self.inner() >> mip, border: 1 << (self.mips() - 1 - mip) }
    }

    /// Where `map` stands: 0 is the mirror, 1 the sharp level, then come the levels from fine to coarse.
    pub const fn square_of(self, map: u32) -> Square {
        match map {
            0 => Square { layer: MIRROR_LAYER, mip: 0 },
            1 => Square { layer: SHARP_LAYER, mip: 0 },
            2 | 3 => Square { layer: FINE_LAYER, mip: map - 2 },
            _ => Square { layer: SHARP_LAYER, mip: map - 3 },
        }
    }

    /// Where `middle`, 0 the finest, stands.
    pub const fn square_of_middle(self, middle: u32) -> Square {
        Square { layer: MIRROR_LAYER, mip: self.mips() - 1 - self.middles + middle }
    }

    /// Where the cosine level stands.
    pub const fn square_of_cosine(self) -> Square {
        Square { layer: MIRROR_LAYER, mip: self.mips() - 1 }
    }

    /// Standard deviation of the Gaussian of `level`, 0 the finest.
    pub fn width(self, level: u32) -> f64 {
        WIDEST / f64::from(1_u32 << (self.count - 1 - level))
    }

    /// That of the sharp level, which has as many texels as level 0.
    pub fn sharp_width(self) -> f64 {
        self.width(0) / 2.0
    }

    /// That of a bilinear read of the map itself, roughly: half of a mean texel's width.
    pub fn mirror_width(self) -> f64 {
        1.8 / f64::from(self.inner())
    }
}

/// An environment's pyramid.
#[derive(Clone, Debug)]
pub struct Pyramid {
    octaves: Octaves,
    /// Mirror, sharp level, levels from fine to coarse. Light is multiplied by 2^-exponent.
    maps: Vec<Map>,
    /// Those half an octave between the coarsest, from fine to coarse; none on cubes.
    middles: Vec<Map>,
    /// `None` on cubes, which have harmonics instead.
    cosine: Option<Map>,
    harmonics: [Vec3A; BASIS],
    suns: Suns,
    exponent: i32,
}

impl Pyramid {
    /// Builds the pyramid of `oem`.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] if its size is not a power of two from 32 to 2048.
    pub fn of_oem(oem: &Oem) -> Result<Self> {
        let octaves = Octaves::over(oem.size().inner)?;
        let suns = Suns::of(oem);
        let exponent = levels::exponent(suns.greatest, suns.clamp);
        let mirror = levels::mirror(oem, exponent);
        let clamp = suns.clamp * levels::scale(exponent);
        let mut maps = vec![sharp::sharp(&mirror, clamp, octaves.sharp_width())];
        let texels = |square: Square| octaves.size(square.mip).inner;
        for level in 0..octaves.count() {
            let finer = maps.last().expect("the sharp level at least");
            let variance = levels::BETWEEN * octaves.width(level).powi(2);
            maps.push(levels::cascade(finer, texels(octaves.square_of(level + 2)), variance));
        }
        let middle = |middle: u32| {
            let variance = levels::FROM_MIDDLE * octaves.middle_width(middle).powi(2);
            let below = &maps[octaves.below_middle(middle) as usize + 1];
            levels::cascade(below, texels(octaves.square_of_middle(middle)), variance)
        };
        let middles = (0..octaves.middles()).map(middle).collect();
        maps.insert(0, mirror);
        let cells = Cells::new(oem, suns.clamp, exponent);
        let (cosine, harmonics) = (cells.cosine(texels(octaves.square_of_cosine())), cells.harmonics());
        Ok(Self { octaves, maps, middles, cosine: Some(cosine), harmonics, suns, exponent })
    }

    /// GGX lobes of `roughness` in [0, 1].
    pub fn lobes(&self, roughness: f32) -> PyramidLobes<'_> {
        let weights = weights_at(self.octaves, roughness);
        let harmonics = self.weighted_harmonics(|order| weights[ORDERS + order]);
        let suns =
            GlossySuns::new(&self.suns.suns, roughness * roughness, (1.0 - weights[0]) * weights[LOBE]);
        PyramidLobes { pyramid: self, weights, harmonics, suns, arch: Arch::new() }
    }

    /// Irradiance on a surface with `normal` (any length but zero) over pi.
    pub fn irradiance(&self, normal: DVec3) -> Rgb {
        let normal = normal.normalize();
        let suns: Vec3A = self.suns.suns.iter().map(|sun| sun.diffuse(normal.as_vec3a())).sum();
        (self.unscaled(self.cosine_around(normal)) + suns).to_array()
    }

    /// Mirror, sharp level, and levels from fine to coarse; light is multiplied by 2^-[`Self::exponent`].
    pub fn maps(&self) -> &[Map] {
        &self.maps
    }

    /// Middle levels from fine to coarse, scaled so, too.
    pub fn middles(&self) -> &[Map] {
        &self.middles
    }

    /// Irradiance over pi, scaled so, too.
    pub(crate) const fn cosine(&self) -> Option<&Map> {
        self.cosine.as_ref()
    }

    /// The cosine level around the unit vector `direction`.
    fn cosine_around(&self, direction: DVec3) -> Vec3A {
        match &self.cosine {
            Some(map) => map.around(direction),
            None => harmonics_around(direction, &self.weighted_harmonics(|order| COSINE_BANDS[order] as f32)),
        }
    }

    /// The harmonics, those of each order times its weight.
    fn weighted_harmonics(&self, weight: impl Fn(usize) -> f32) -> [Vec3A; BASIS] {
        std::array::from_fn(|k| weight(k.isqrt()) * self.harmonics[k])
    }

    /// Its levels.
    pub(crate) const fn octaves(&self) -> Octaves {
        self.octaves
    }

    fn unscaled(&self, light: Vec3A) -> Vec3A {
        (light.as_dvec3() * f64::from(self.exponent).exp2()).as_vec3a()
    }
}

/// For tests and measurements.
impl Pyramid {
    /// Builds the pyramid of `environment` over a map of `size` texels along an edge, a power of two from 32
    /// to 2048.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for another size, [`crate::common::error::Error::Limit`] if
    /// the overlaps of texels exceed the memory.
    pub fn build(environment: &Environment, size: u32) -> Result<Self> {
        Octaves::over(size)?;
        Self::of_oem(&oem_from_environment(environment, OemSize { inner: size, border: 0 })?)
    }

    /// Harmonics of radiance to order 4, scaled so, too.
    pub const fn harmonics(&self) -> &[Vec3A; BASIS] {
        &self.harmonics
    }

    /// The suns, which are in no map but the mirror.
    pub const fn suns(&self) -> &Suns {
        &self.suns
    }

    /// The power of two that brings the light into the range of half floats.
    pub const fn exponent(&self) -> i32 {
        self.exponent
    }
}

/// The sum of `harmonics` around the unit vector `direction`.
fn harmonics_around(direction: DVec3, harmonics: &[Vec3A; BASIS]) -> Vec3A {
    basis(direction).into_iter().zip(harmonics).map(|(basis, harmonic)| basis as f32 * *harmonic).sum()
}

/// Lobes of one roughness over a pyramid.
#[derive(Debug)]
pub struct PyramidLobes<'a> {
    pyramid: &'a Pyramid,
    weights: [f32; WEIGHTS],
    /// Times their weights.
    harmonics: [Vec3A; BASIS],
    suns: GlossySuns,
    arch: Arch,
}

impl PyramidLobes<'_> {
    /// Radiance of a reflection around `direction` (any length but zero, in the map's space).
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        self.arch.dispatch(LookUp { lobes: self, direction: direction.normalize() })
    }
}

/// One look-up, around a unit vector.
struct LookUp<'a> {
    lobes: &'a PyramidLobes<'a>,
    direction: DVec3,
}

impl pulp::NullaryFnOnce for LookUp<'_> {
    type Output = Rgb;

    #[inline(always)]
    fn call(self) -> Rgb {
        let Self { lobes: PyramidLobes { pyramid, weights, harmonics, suns, .. }, direction } = self;
        let place = pyramid.maps[0].place_of(direction);
        let mut sum = harmonics_around(direction, harmonics);
        let maps = pyramid.maps.iter().zip(&weights[..]);
        let middles = pyramid.middles.iter().zip(&weights[MIDDLE..]);
        let (mut inner, mut corner) = (pyramid.maps[0].inner, pyramid.maps[0].corner(place));
        for (map, weight) in maps.chain(middles).filter(|(_, weight)| **weight != 0.0) {
            if map.inner != inner {
                (inner, corner) = (map.inner, map.corner(place));
            }
            sum += *weight * map.bilinear(corner);
        }
        if weights[COSINE] != 0.0 {
            sum += weights[COSINE] * pyramid.cosine_around(direction);
        }
        (pyramid.unscaled(sum.max(Vec3A::ZERO)) + suns.around(direction.as_vec3a())).to_array()
    }
}
