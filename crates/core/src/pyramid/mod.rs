//! One pyramid: glossy reflections of any roughness from a few bilinear reads.
//!
//! ```text
//! OEM --suns--> suns
//!  +--mirror--> mirror
//!  +--the rest --sharp--> s = .0096 --cascade--> .0175 --cascade--> .032 ... .35
//!        +--cells--> cosine level, harmonics
//!
//! L(d, r) = sum of w_k(r) level_k(d) + sum of a_l(r) (harmonics of order l at d) + suns
//! ```
//!
//! Levels are octahedral maps of the environment under Gaussian lobes exp(-(1 - cos t) / s^2), each 1.82
//! times as wide as the one before, up to s = .35. The weights are a table over roughness ([`fit`]). CPU and
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
use fit::{COSINE, LOBE, ORDERS, WEIGHTS, weights_at};
use glam::{DVec3, Vec3A};
use levels::Map;
use suns::{GlossySuns, Suns};

/// Texels along an edge of the smallest map.
pub const SMALLEST: u32 = 32;

/// Standard deviation of the widest level's Gaussian.
pub const WIDEST: f64 = 0.35;

/// Octaves between the standard deviations of levels on squares, each 1.82 times as wide as the one before.
/// On a cube, whose MIP levels halve, it is 1.
pub const LEVEL_OCTAVES: f64 = 0.864;

/// Texels along an edge of the map times the finest Gaussian's standard deviation, at least.
const FINEST: f64 = 3.3;

/// Most maps: those of 2048 x 2048.
pub const MOST_MAPS: usize = 10;

/// Layers of an environment's squares.
pub const SQUARES: u32 = 3;

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
pub struct Levels {
    inner: u32,
    count: u32,
    is_cube: bool,
}

impl Levels {
    /// Sizes of maps.
    const SIZES: usize = 7;

    /// Levels of all sizes, of squares and of cubes.
    pub(super) const ALL: usize = 2 * Self::SIZES;

    /// Texels along an edge of the largest map.
    pub const LARGEST: u32 = SMALLEST << (Self::SIZES - 1);

    /// The sizes of maps, from small to large.
    pub fn sizes() -> impl DoubleEndedIterator<Item = u32> {
        (0..Self::SIZES).map(|octave| SMALLEST << octave)
    }

    /// The least size of a map that is at least `inner`, or the largest there is.
    pub fn size_for(inner: u32) -> u32 {
        Self::sizes().find(|size| *size >= inner).unwrap_or(Self::LARGEST)
    }

    /// Texels along an edge of a map whose finest level is about half as wide as lobes of `alpha`.
    pub(crate) fn texels_for(alpha: f64) -> u32 {
        (3.4 * FINEST / alpha).min(f64::from(Self::LARGEST)).ceil() as u32
    }

    /// The levels over a map of `inner` texels along an edge.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for an `inner` that is not a power of two from 32 to 2048.
    pub fn over(inner: u32) -> Result<Self> {
        if Self::sizes().any(|size| size == inner) {
            let gaussians = 1 + ((WIDEST * f64::from(inner) / FINEST).log2() / LEVEL_OCTAVES) as u32;
            return Ok(Self { inner, count: 1 + gaussians, is_cube: false });
        }
        wrong(format!(
            "an OEM of {inner} texels has no pyramid; choose a power of two from {SMALLEST} to {} as \
             `oem_size`",
            Self::LARGEST
        ))
    }

    /// Those of the same map on a cube, of which each MIP level is one.
    pub const fn on_cubes(self) -> Self {
        Self { count: self.inner.ilog2() - 2, is_cube: true, ..self }
    }

    /// Whether they are those of a cube.
    pub const fn is_cube(self) -> bool {
        self.is_cube
    }

    /// Their place among [`Self::ALL`].
    pub(super) const fn index(self) -> usize {
        2 * (self.inner / SMALLEST).ilog2() as usize + self.is_cube as usize
    }

    /// The number of maps: the mirror, and Gaussians.
    pub const fn count(self) -> u32 {
        self.count
    }

    /// Octaves between the standard deviations of levels.
    pub(crate) const fn octaves(self) -> f64 {
        if self.is_cube { 1.0 } else { LEVEL_OCTAVES }
    }

    /// Texels along an edge of the map.
    pub const fn inner(self) -> u32 {
        self.inner
    }

    /// MIP levels of the squares. The coarsest have 64 texels along an edge, and 32 where the map has less
    /// than 512; 16 of the smallest map.
    pub const fn mips(self) -> u32 {
        let octave = self.inner.ilog2();
        if octave > 8 {
            octave - 5
        } else if octave > 6 {
            octave - 4
        } else {
            2
        }
    }

    /// Size of the squares of MIP level `mip`, with borders that halve with the levels.
    pub const fn size(self, mip: u32) -> OemSize {
        OemSize { inner: self.inner >> mip, border: 1 << (self.mips() - 1 - mip) }
    }

    /// Where `map` stands: 0 is the mirror, then come the Gaussians from fine to coarse, three a MIP level.
    pub const fn square_of(self, map: u32) -> Square {
        Square { layer: map % SQUARES, mip: map / SQUARES }
    }

    /// Where the cosine level stands.
    pub const fn square_of_cosine(self) -> Square {
        Square { layer: SQUARES - 1, mip: self.mips() - 1 }
    }

    /// Standard deviation of the Gaussian of `map`; of the mirror that of a bilinear read, roughly: half of a
    /// mean texel's width.
    pub fn width(self, map: u32) -> f64 {
        if map == 0 {
            return 1.8 / f64::from(self.inner);
        }
        WIDEST * (self.octaves() * (f64::from(map) + 1.0 - f64::from(self.count))).exp2()
    }
}

/// An environment's pyramid.
#[derive(Clone, Debug)]
pub struct Pyramid {
    levels: Levels,
    /// The mirror, then Gaussians from fine to coarse. Light is multiplied by 2^-exponent.
    maps: Vec<Map>,
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
        let own = Levels::over(oem.size().inner)?;
        let suns = Suns::of(oem);
        let exponent = levels::exponent(suns.greatest, suns.clamp);
        let mirror = levels::mirror(oem, exponent);
        let clamp = suns.clamp * levels::scale(exponent);
        let mut maps = vec![sharp::sharp(&mirror, clamp, own.width(1))];
        let texels = |square: Square| own.size(square.mip).inner;
        for map in 2..own.count() {
            let finer = maps.last().expect("the sharp level at least");
            let between = levels::Between::new(own.width(map), own.width(map - 1));
            maps.push(levels::cascade(finer, texels(own.square_of(map)), between));
        }
        maps.insert(0, mirror);
        let cells = Cells::new(oem, suns.clamp, exponent);
        let (cosine, harmonics) = (cells.cosine(texels(own.square_of_cosine())), cells.harmonics());
        Ok(Self { levels: own, maps, cosine: Some(cosine), harmonics, suns, exponent })
    }

    /// GGX lobes of `roughness` in [0, 1].
    pub fn lobes(&self, roughness: f32) -> PyramidLobes<'_> {
        let weights = weights_at(self.levels, roughness);
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

    /// The mirror, then Gaussians from fine to coarse; light is multiplied by 2^-[`Self::exponent`].
    pub fn maps(&self) -> &[Map] {
        &self.maps
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
    pub(crate) const fn levels(&self) -> Levels {
        self.levels
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
        Levels::over(size)?;
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
        self.around(direction.normalize())
    }

    /// The same around a unit vector.
    pub(crate) fn around(&self, direction: DVec3) -> Rgb {
        self.arch.dispatch(LookUp { lobes: self, direction })
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
        let (mut inner, mut corner) = (pyramid.maps[0].inner, pyramid.maps[0].corner(place));
        for (map, weight) in maps.filter(|(_, weight)| **weight != 0.0) {
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
