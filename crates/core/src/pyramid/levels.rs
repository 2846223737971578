//! The levels: octahedral maps under Gaussian lobes, each from the next finer one.
//!
//! A level is the next finer one under the Gaussian that lies [between](Between) them. The finer level is
//! smooth, so 25 bilinear reads make that Gaussian: three rings of its variance, whose radii and weights
//! were optimised for the Gaussian of all levels together; the next two terms of the error, an uneven ring
//! and an uneven profile, are below .5 % each. Every read is placed on the sphere, so the levels know no
//! seams.
//!
//! A bilinear read of a level widens what it reads by a sixth of a texel's square, and texels are three times
//! as long as wide in the middle of the octahedron's faces. The Gaussians are narrowed by that covariance:
//! *reads* of levels are round. The sharp level's is narrowed twice: its texels, too, have the light of an
//! area at one point.

use super::suns;
use crate::common::parallel;
use crate::common::vector::{Arch, Extremes as _, Fused as _};
use crate::light::environment::Rgb;
use crate::light::oem::Oem;
use crate::sphere::cube::{Face, cube_from_direction, cube_from_texel, cube_point};
use crate::sphere::octahedral::{direction_from_oct, steps_from_oct, texel_centre, wrap_texel};
use glam::{DVec2, DVec3, Vec2, Vec3, Vec3A, Vec4};
use half::f16;

/// Rings of reads around a Gaussian: reads, radius in standard deviations, weight of all.
pub(crate) const RINGS: [(u32, f64, f64); 3] = [(5, 0.6616, 0.458), (9, 1.571, 0.4425), (11, 2.6661, 0.0995)];

/// Reads of a Gaussian.
pub const TAPS: usize = 25;

/// Light is scaled to less than 2 to this power: sums of halves stay finite.
pub(crate) const BRIGHTEST: i32 = 15;

/// An octahedral square of texels with a border of one, or the six faces of a cube, each with such a border.
#[derive(Clone, Debug)]
pub struct Map {
    pub(super) inner: u32,
    pub(super) is_cube: bool,
    /// Red, green, blue and 0.
    pub(super) texels: Vec<[f32; 4]>,
}

impl Map {
    /// A map whose texels are `texel(x, y)`.
    pub(crate) fn new(inner: u32, texel: impl Fn(u32, u32) -> Vec3A + Sync) -> Self {
        let side = inner as usize + 2;
        let mut texels = vec![[0.0; 4]; side * side];
        let rows = texels.chunks_exact_mut(side).skip(1).take(inner as usize);
        parallel::for_each(rows.zip(0..inner), |(row, y)| {
            for (place, x) in row[1..].iter_mut().zip(0..inner) {
                *place = texel(x, y).extend(0.0).to_array();
            }
        });
        Self { inner, is_cube: false, texels }.bordered()
    }

    /// The square of `inner` texels within the square `texels`, whose border has `border`.
    pub(crate) fn of_bordered(inner: u32, border: u32, texels: &[Rgb]) -> Self {
        let side = inner + 2 * border;
        Self::new(inner, |x, y| texels[((y + border) * side + x + border) as usize].into())
    }

    /// A map whose texels are `texels(x, y)` for the quarter with x, y < `inner` / 2: the texel there, the
    /// one mirrored along u, along v, and along both. Four texels share geometry by the octahedron's mirrors.
    pub(crate) fn of_quarters(inner: u32, texels: impl Fn(u32, u32) -> [Vec3A; 4] + Sync) -> Self {
        let (last, half) = (inner as usize, inner as usize / 2);
        let side = last + 2;
        let mut all = vec![[0.0; 4]; side * side];
        let (top, bottom) = all.split_at_mut(side * (half + 1));
        let bottom = bottom.chunks_exact_mut(side).take(half).rev();
        let rows = top.chunks_exact_mut(side).skip(1).zip(bottom).zip(0..inner / 2);
        parallel::for_each(rows, |((above, below), y)| {
            for (x, at) in (0..inner / 2).zip(1..) {
                [above[at], above[last + 1 - at], below[at], below[last + 1 - at]] =
                    texels(x, y).map(|texel| texel.extend(0.0).to_array());
            }
        });
        Self { inner, is_cube: false, texels: all }.bordered()
    }

    /// With the border filled.
    fn bordered(mut self) -> Self {
        let (side, last) = (self.inner as usize + 2, i64::from(self.inner));
        let edges = (-1..=last).flat_map(|k| [(k, -1), (k, last), (-1, k), (last, k)]);
        for (x, y) in edges {
            let (from_x, from_y) = wrap_texel(self.inner, x, y);
            self.texels[(y + 1) as usize * side + (x + 1) as usize] =
                self.texels[(from_y as usize + 1) * side + from_x as usize + 1];
        }
        self
    }

    /// Texels along an edge, without the border.
    #[must_use]
    pub const fn inner(&self) -> u32 {
        self.inner
    }

    /// Texel (`x`, `y`) of the square; the border has -1 and `inner`.
    #[must_use]
    pub fn texel(&self, x: i32, y: i32) -> Vec3A {
        let at = (y + 1) as usize * (self.inner as usize + 2) + (x + 1) as usize;
        Vec3A::from_vec4(Vec4::from_array(self.texels[at]))
    }

    /// The square with a border of `border` texels, by rows.
    pub(crate) fn with_border(&self, border: u32) -> Vec<Rgb> {
        let side = i64::from(self.inner + 2 * border);
        let texel = |(x, y): (i64, i64)| {
            let (x, y) = wrap_texel(self.inner, x - i64::from(border), y - i64::from(border));
            self.texel(x as i32, y as i32).to_array()
        };
        (0..side).flat_map(|y| (0..side).map(move |x| (x, y))).map(texel).collect()
    }

    /// Bilinear between the texels around `direction`, a unit vector.
    #[must_use]
    pub fn around(&self, direction: DVec3) -> Vec3A {
        self.bilinear(self.corner(self.place_of(direction)))
    }

    /// The face and the point in [-1, 1]^2 of `direction`, a unit vector; on a square 0 and its point on the
    /// octahedron |x| + |y| + |z| = 1. It is the same for all maps of a pyramid.
    pub(super) fn place_of(&self, direction: DVec3) -> (usize, Vec3) {
        if self.is_cube {
            let (face, s, t) = cube_from_direction(direction);
            (face.index(), DVec3::new(s, t, 0.0).as_vec3())
        } else {
            (0, (direction / direction.abs().element_sum()).as_vec3())
        }
    }

    /// The four texels around a place of [`Self::place_of`], the same for all maps of a size.
    ///
    /// Where the octahedron's faces meet, at x = 0 and z = 0, a read between the texels on either side does
    /// not bend as the faces do: there |x| and |z| count as those of the texels, as if the octahedron were
    /// flat between them. That makes reads linear on the sphere.
    #[inline(always)]
    pub(super) fn corner(&self, (face, point): (usize, Vec3)) -> Corner {
        let edge = 1.0 / self.inner as f32;
        let [x, y, z] = point.to_array();
        let uv = match self.is_cube {
            true => [x, y],
            false => folded([x, y, z], 1.0 / (x.abs().max(edge) + y.abs() + z.abs().max(edge))),
        };
        // With the border.
        let half = 0.5 * self.inner as f32;
        let [(x, right), (y, up)] = uv.map(|at| whole_and_share(half * (at + 1.0) + 0.5));
        let side = self.inner as usize + 2;
        Corner { first: (face * side + y as usize) * side + x as usize, right, up }
    }

    /// Bilinear between four texels.
    #[inline(always)]
    pub(super) fn bilinear(&self, Corner { first, right, up }: Corner) -> Vec3A {
        let row = |first: usize| {
            let texels: &[[f32; 4]; 2] = self.texels[first..].first_chunk().expect("two texels of a row");
            let [own, next] = texels.map(Vec4::from_array);
            own.lerp(next, right)
        };
        Vec3A::from_vec4(row(first).lerp(row(first + self.inner as usize + 2), up))
    }
}

/// Four texels: the first of all, and the shares of the next ones in its row and of the next row.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    first: usize,
    right: f32,
    up: f32,
}

/// What a bilinear read adds to a Gaussian's covariance, over a texel's square; and what sums of points add
/// that each have the light of a texel around them.
pub(super) const READ: f64 = 1.0 / 6.0;
pub(super) const POINTS: f64 = 1.0 / 12.0;

/// A texel's place: its direction, and the covariance of a Gaussian there in the plane that touches the
/// sphere, along two axes.
pub(super) struct Place {
    pub(super) direction: Vec3,
    pub(super) axes: [Vec3; 2],
    /// The covariance: of the first axis, of both, of the second.
    pub(super) covariance: [f32; 3],
    /// A texel's step along u, which the first axis has; along v, on both.
    pub(super) steps: [f32; 3],
}

impl Place {
    /// Texel (`x`, `y`) of a map of `inner` texels, for a Gaussian of `variance` less what `widening` adds.
    pub(super) fn new(inner: u32, x: u32, y: u32, variance: f64, widening: f64) -> Self {
        let uv = texel_centre(inner, x, y);
        let texel = 2.0 / f64::from(inner);
        Self::of_texel(direction_from_oct(uv), steps_from_oct(uv), texel, [variance, widening])
    }

    /// The same for texel (`x`, `y`) of a cube's `face`.
    pub(super) fn on_cube(inner: u32, face: Face, x: u32, y: u32, variance: f64) -> Self {
        let [s, t] = cube_from_texel(inner, x, y);
        let point = cube_point(face, s, t);
        let length = point.length();
        let direction = point / length;
        let steps = [cube_point(face, s + 1.0, t), cube_point(face, s, t + 1.0)]
            .map(|next| (next - point).reject_from_normalized(direction) / length);
        Self::of_texel(direction, steps, 2.0 / f64::from(inner), [variance, READ])
    }

    /// Around `direction`, which moves by `by_u` and `by_v`, times the side of a `texel`.
    fn of_texel(
        direction: DVec3,
        [by_u, by_v]: [DVec3; 2],
        texel: f64,
        [variance, widening]: [f64; 2],
    ) -> Self {
        let along = by_u.normalize();
        let across = direction.cross(along);
        let (long, shear, wide) = (by_u.length(), by_v.dot(along), by_v.dot(across));
        let read = widening * texel * texel;
        let covariance = [
            variance - read * (long * long + shear * shear),
            -read * shear * wide,
            variance - read * wide * wide,
        ];
        Self {
            direction: direction.as_vec3(),
            axes: [along.as_vec3(), across.as_vec3()],
            covariance: covariance.map(|value| value as f32),
            steps: [long, shear, wide].map(|step| (step * texel) as f32),
        }
    }

    /// Mirrored: `signs` are 1 or -1.
    pub(super) fn mirrored(mut self, signs: Vec3) -> Self {
        self.direction *= signs;
        self.axes.iter_mut().for_each(|axis| *axis *= signs);
        self
    }

    /// Texels that a Gaussian of standard deviation 1 reaches along u and v.
    pub(super) fn reach(&self) -> Vec2 {
        let [long, shear, wide] = self.steps;
        Vec2::new(Vec2::new(shear, wide).length(), long) / (long * wide).abs()
    }

    /// Narrowed by what sums of points of another map, of `inner` texels, add.
    pub(super) fn of_points(mut self, inner: u32) -> Self {
        let texel = 2.0 / inner as f32;
        for step in steps_from_oct(oct_from(self.direction).as_dvec2()) {
            let [p, q] = self.axes.map(|axis| axis.dot(step.as_vec3()) * texel);
            for (covariance, own) in self.covariance.iter_mut().zip([p * p, p * q, q * q]) {
                *covariance -= POINTS as f32 * own;
            }
        }
        self
    }

    /// The covariance's root, a triangle: of the first axis, of both, of the second.
    fn root(&self) -> [f32; 3] {
        let [a, b, c] = self.covariance;
        let long = a.sqrt();
        [long, b / long, (c - b * b / a).sqrt()]
    }
}

/// Reads around a Gaussian, in whole lanes: those beyond [`TAPS`] have no weight.
const PADDED_TAPS: usize = TAPS.next_multiple_of(16);

/// Reads around a Gaussian of covariance 1, by lanes, with the bend of [`Between`].
pub(super) struct Taps {
    x: [f32; PADDED_TAPS],
    y: [f32; PADDED_TAPS],
    weight: [f32; PADDED_TAPS],
    bend: f32,
    arch: Arch,
}

impl Taps {
    pub(super) fn new(bend: f64) -> Self {
        let of = |part: fn((Vec2, f32)) -> f32| {
            let mut lanes = [0.0; PADDED_TAPS];
            lanes.iter_mut().zip(taps()).for_each(|(lane, tap)| *lane = part(tap));
            lanes
        };
        let (x, y, weight) = (of(|(at, _)| at.x), of(|(at, _)| at.y), of(|(_, weight)| weight));
        Self { x, y, weight, bend: bend as f32, arch: Arch::new() }
    }

    /// The light of `map`, a square, under the Gaussian at `place`, and at its places mirrored along u, along
    /// v, and along both.
    pub(super) fn mirrored(&self, map: &Map, place: &Place) -> [Vec3A; 4] {
        self.arch.dispatch(Reads { taps: self, map, place })
    }
}

/// The reads of [`Taps`] around one place.
struct Reads<'a> {
    taps: &'a Taps,
    map: &'a Map,
    place: &'a Place,
}

impl pulp::NullaryFnOnce for Reads<'_> {
    type Output = [Vec3A; 4];

    #[inline(always)]
    fn call(self) -> [Vec3A; 4] {
        let Self { taps, map, place } = self;
        let [long, shear, wide] = place.root();
        let (direction, [along, across]) = (place.direction, place.axes);
        let half = 0.5 * map.inner as f32;
        let [mut first_x, mut first_y] = [[0_u32; PADDED_TAPS]; 2];
        let [mut share_x, mut share_y] = [[0.0; PADDED_TAPS]; 2];
        for k in 0..PADDED_TAPS {
            let (p, q) = (long * taps.x[k], shear.times_plus(taps.x[k], wide * taps.y[k]));
            let flat = 0.5 * p.times_plus(p, q * q);
            let bent = flat.times_plus(taps.bend, 1.0);
            let versine = flat * bent;
            let (ahead, aside) = (1.0 - versine, (bent * (1.0 - 0.5 * versine)).sqrt());
            let (p, q) = (aside * p, aside * q);
            let x = ahead.times_plus(direction.x, p.times_plus(along.x, q * across.x));
            let y = ahead.times_plus(direction.y, p.times_plus(along.y, q * across.y));
            let z = ahead.times_plus(direction.z, p.times_plus(along.z, q * across.z));
            let [u, v] = oct(x, y, z);
            (first_x[k], share_x[k]) = whole_and_share(half.times_plus(u, half + 0.5));
            (first_y[k], share_y[k]) = whole_and_share(half.times_plus(v, half + 0.5));
        }
        let side = map.inner as usize + 2;
        // Two texels of a row for every place.
        let mut sums = [[0.0; 8]; 4];
        for k in 0..TAPS {
            let (x, y, share) = (first_x[k] as usize, first_y[k] as usize, share_x[k]);
            let far = side - 2 - x;
            let below = taps.weight[k] * share_y[k];
            for (y, own) in [(y, taps.weight[k] - below), (y + 1, below)] {
                let (near, next) = (own * (1.0 - share), own * share);
                let (plain, mirrored) = (twice(near, next), twice(next, near));
                for (sums, row) in sums.chunks_exact_mut(2).zip([y, side - 1 - y]) {
                    let row = &map.texels[row * side..][..side];
                    add(&mut sums[0], plain, &row[x..x + 2]);
                    add(&mut sums[1], mirrored, &row[far..far + 2]);
                }
            }
        }
        // The fourth numbers, too: without them the sums above are not made by whole lanes.
        sums.map(|sum| {
            let [near, next] = [0, 4].map(|first| Vec4::from_slice(&sum[first..first + 4]));
            Vec3A::from_vec4(near + next)
        })
    }
}

/// Two weights, each for the four numbers of a texel.
#[inline(always)]
const fn twice(a: f32, b: f32) -> [f32; 8] {
    [a, a, a, a, b, b, b, b]
}

/// Adds two texels times their `weights`.
#[inline(always)]
fn add(sum: &mut [f32; 8], weights: [f32; 8], texels: &[[f32; 4]]) {
    let texels = texels.as_flattened();
    for k in 0..8 {
        sum[k] = weights[k].times_plus(texels[k], sum[k]);
    }
}

/// A number from .5 to 2^22 as a whole number, and the share of the next: up to 1 where it is whole itself.
/// The share of NaN is NaN.
#[inline(always)]
fn whole_and_share(number: f32) -> (u32, f32) {
    // The sum's last bit is worth 1.
    const ONES: f32 = 8_388_608.0;
    let sum = (number.at_least(0.5) - 0.5) + ONES;
    (sum.to_bits() - ONES.to_bits(), number - (sum - ONES))
}

/// The exponent that brings light of up to `greatest` into the range of half floats: it is multiplied by
/// 2^-exponent. Light of less than 2^-100 stays dim. What the rest is clamped to stays above 2^-5, a million
/// times what a half float can hold: beyond that suns are dimmed in the mirror.
pub(crate) fn exponent(greatest: f32, clamp: f32) -> i32 {
    let of = |light: f32| ((light.to_bits() >> 23) as i32 - 126).max(-100) - BRIGHTEST;
    let own = if greatest > 0.0 { of(greatest) } else { 0 };
    if clamp > 0.0 { (of(clamp) + 19).clamp(own - 40, own) } else { own }
}

/// What light is multiplied by for the exponent of [`exponent`].
pub(crate) fn scale(exponent: i32) -> f32 {
    (-f64::from(exponent)).exp2() as f32
}

/// Radiance of `oem` by texel, times 2^-`exponent`, in half floats as textures hold it: suns stay in it.
pub(crate) fn mirror(oem: &Oem, exponent: i32) -> Map {
    let scale = scale(exponent);
    Map::new(oem.size().inner, |x, y| {
        let light = Vec3A::from_array(oem.radiance(x, y)) * scale;
        let held = light * suns::kept(light.max_element(), f16::MAX.to_f32());
        Vec3A::from_array(held.to_array().map(|value| f16::from_f32(value).to_f32()))
    })
}

/// Reads around a Gaussian of covariance 1, and their weights.
pub fn taps() -> [(Vec2, f32); TAPS] {
    let mut taps = [(Vec2::ZERO, 0.0); TAPS];
    let rings = RINGS.iter().flat_map(|&(count, radius, weight)| {
        (0..count).map(move |k| {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(count);
            (DVec2::from_angle(angle) * radius, weight / f64::from(count))
        })
    });
    for (tap, (place, weight)) in taps.iter_mut().zip(rings) {
        *tap = (place.as_vec2(), weight as f32);
    }
    taps
}

/// What makes a level of another one: its reads stand at distances of a Gaussian, bent a little.
#[derive(Clone, Copy, Debug)]
pub struct Between {
    /// Mean of h, half of the squared distance of a read.
    pub variance: f64,
    /// A read stands where 1 - cos is h (1 + bend h).
    pub bend: f64,
}

impl Between {
    /// What makes a level of `width` of one of the width `finer`.
    ///
    /// Gaussians exp(-(1 - cos) / s^2) do not make another one: on the sphere the means of Legendre's
    /// polynomials multiply. Those of the first two orders are as they should be: without the bend, the
    /// widest level's peak is 2.6 % low.
    pub fn new(width: f64, finer: f64) -> Self {
        // Means of the first two polynomials.
        let means = |width: f64| {
            let square = width * width;
            let first = 1.0 / square.recip().tanh() - square;
            [first, 1.0 - 3.0 * square * first]
        };
        let ([a, b], [c, d]) = (means(width), means(finer));
        // Means of 1 - cos and of its square.
        let first = 1.0 - a / c;
        let second = (b / d - 1.0 + 3.0 * first) / 1.5;
        // h is an exponential variable of mean m: they are m + 2 bend m^2 and about 2 m^2 + 12 bend m^3.
        let bent = 0.5 * (0.5 * second / (first * first) - 1.0);
        let variance = first / (1.0 + 2.0 * bent);
        Self { variance, bend: bent / variance }
    }

    /// A Gaussian of `width` over the map itself.
    pub const fn round(width: f64) -> Self {
        Self { variance: width * width, bend: 0.0 }
    }
}

/// The level of `inner` texels that `between` makes of `finer`.
pub(crate) fn cascade(finer: &Map, inner: u32, between: Between) -> Map {
    let taps = Taps::new(between.bend);
    Map::of_quarters(inner, |x, y| taps.mirrored(finer, &Place::new(inner, x, y, between.variance, READ)))
}

/// [`crate::sphere::octahedral::oct_from_direction`] in single precision.
pub(super) fn oct_from(direction: Vec3) -> Vec2 {
    oct(direction.x, direction.y, direction.z).into()
}

#[inline(always)]
fn oct(x: f32, y: f32, z: f32) -> [f32; 2] {
    folded([x, y, z], 1.0 / (x.abs() + y.abs() + z.abs()))
}

/// Coordinates in the square of (`x`, `y`, `z`) times `scale`, a point of the octahedron.
#[inline(always)]
fn folded([x, y, z]: [f32; 3], scale: f32) -> [f32; 2] {
    let (u, v) = (x * scale, z * scale);
    let folded = [(1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v)];
    if y >= 0.0 { [u, v] } else { folded }
}
