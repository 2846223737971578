//! The levels: octahedral maps under Gaussian lobes, each from the next finer one.
//!
//! A Gaussian of variance s^2 over one of s^2 / 4 is one of 3 s^2 / 4. The finer level is smooth, so 25
//! bilinear reads of it make that Gaussian: three rings, whose radii and weights were optimised for the
//! Gaussian of all levels together; the next two terms of the error, an uneven ring and an uneven profile,
//! are below 1 % each. Every read is placed on the sphere, so the levels know no seams.
//!
//! A bilinear read of a level widens what it reads by a sixth of a texel's square, and texels are three times
//! as long as wide in the middle of the octahedron's faces. The Gaussians are narrowed by that covariance:
//! *reads* of levels are round. The sharp level's is narrowed twice: its texels, too, have the light of an
//! area at one point.

use super::suns;
use crate::common::parallel;
use crate::light::environment::Rgb;
use crate::light::oem::Oem;
use crate::sphere::cube::{Face, cube_from_direction, cube_from_texel, cube_point};
use crate::sphere::octahedral::{
    direction_from_oct, oct_from_direction, octahedron_from_oct, steps_from_oct, texel_centre, wrap_texel,
};
use glam::{DVec2, DVec3, Vec2, Vec3, Vec3A, Vec4};
use half::f16;

/// Rings of reads around a Gaussian: reads, radius in standard deviations, weight of all.
pub(crate) const RINGS: [(u32, f64, f64); 3] =
    [(5, 0.6158, 0.406), (9, 1.4614, 0.4518), (11, 2.4519, 0.1422)];

/// Reads of a Gaussian.
pub const TAPS: usize = 25;

/// The sharp level's Gaussian ends at so many standard deviations.
pub(crate) const CUT: f32 = 3.0;

/// The share of a Gaussian's covariance that is left of it where it ends at [`CUT`].
pub(crate) const CUT_COVARIANCE: f32 = 0.949_448;

/// Light is scaled to less than 2 to this power: sums of halves stay finite.
pub(crate) const BRIGHTEST: i32 = 15;

/// An octahedral square of texels with a border of one, or the six faces of a cube, each with such a border.
#[derive(Clone, Debug)]
pub struct Map {
    pub(super) inner: u32,
    pub(super) is_cube: bool,
    pub(super) texels: Vec<Vec3A>,
}

impl Map {
    /// A map whose texels are `texel(x, y)`.
    pub(crate) fn new(inner: u32, texel: impl Fn(u32, u32) -> Vec3A + Sync) -> Self {
        let side = inner as usize + 2;
        let mut texels = vec![Vec3A::ZERO; side * side];
        let rows = texels.chunks_exact_mut(side).skip(1).take(inner as usize);
        parallel::for_each(rows.zip(0..inner), |(row, y)| {
            for (place, x) in row[1..].iter_mut().zip(0..inner) {
                *place = texel(x, y);
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
        let mut all = vec![Vec3A::ZERO; side * side];
        let (top, bottom) = all.split_at_mut(side * (half + 1));
        let bottom = bottom.chunks_exact_mut(side).take(half).rev();
        let rows = top.chunks_exact_mut(side).skip(1).zip(bottom).zip(0..inner / 2);
        parallel::for_each(rows, |((above, below), y)| {
            for (x, at) in (0..inner / 2).zip(1..) {
                [above[at], above[last + 1 - at], below[at], below[last + 1 - at]] = texels(x, y);
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
        self.texels[(y + 1) as usize * (self.inner as usize + 2) + (x + 1) as usize]
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
        let (face, uv) = if self.is_cube {
            let (face, s, t) = cube_from_direction(direction);
            (face.index(), DVec2::new(s, t))
        } else {
            (0, oct_from_direction(direction))
        };
        let ([x, y], share) = self.place(uv.as_vec2());
        let side = self.inner as usize + 2;
        let first = (face * side + y) * side + x;
        let row = |first: usize| self.texels[first].lerp(self.texels[first + 1], share.x);
        row(first).lerp(row(first + side), share.y)
    }

    /// The first of the four texels around `uv` in [-1, 1]^2, border included, and the shares of the next.
    fn place(&self, uv: Vec2) -> ([usize; 2], Vec2) {
        let at = (uv + 1.0) * (0.5 * self.inner as f32) + 0.5;
        let (x, y) = (at.x as usize, at.y as usize);
        ([x, y], at - Vec2::new(x as f32, y as f32))
    }

    /// Adds `weight` times the bilinear reads around `uv` and its mirrors to `sums`, as in
    /// [`Self::of_quarters`].
    #[inline]
    fn add_mirrored(&self, sums: &mut [Vec3A; 4], uv: Vec2, weight: f32) {
        let ([x, y], share) = self.place(uv);
        let side = self.inner as usize + 2;
        let far = side - 2 - x;
        for (y, own) in [(y, weight * (1.0 - share.y)), (y + 1, weight * share.y)] {
            let (near, next) = (own * (1.0 - share.x), own * share.x);
            for (sums, row) in sums.chunks_exact_mut(2).zip([y, side - 1 - y]) {
                let row = &self.texels[row * side..][..side];
                let (left, right) = (&row[x..x + 2], &row[far..far + 2]);
                sums[0] += near * left[0] + next * left[1];
                sums[1] += near * right[1] + next * right[0];
            }
        }
    }
}

/// A texel's place: its direction, and the covariance of a Gaussian there in the plane that touches the
/// sphere, along two axes.
pub(super) struct Place {
    direction: Vec3,
    axes: [Vec3; 2],
    /// The covariance: of the first axis, of both, of the second.
    covariance: [f32; 3],
    /// Texels that a Gaussian of standard deviation 1 reaches along u and v.
    reach: Vec2,
}

impl Place {
    /// Texel (`x`, `y`) of a map of `inner` texels, for a Gaussian of `variance` less what a bilinear read
    /// adds.
    fn new(inner: u32, x: u32, y: u32, variance: f64) -> Self {
        let uv = texel_centre(inner, x, y);
        Self::of_texel(direction_from_oct(uv), steps_from_oct(uv), 2.0 / f64::from(inner), variance)
    }

    /// The same for texel (`x`, `y`) of a cube's `face`.
    pub(super) fn on_cube(inner: u32, face: Face, x: u32, y: u32, variance: f64) -> Self {
        let [s, t] = cube_from_texel(inner, x, y);
        let point = cube_point(face, s, t);
        let length = point.length();
        let direction = point / length;
        let steps = [cube_point(face, s + 1.0, t), cube_point(face, s, t + 1.0)]
            .map(|next| (next - point).reject_from_normalized(direction) / length);
        Self::of_texel(direction, steps, 2.0 / f64::from(inner), variance)
    }

    /// Around `direction`, which moves by `by_u` and `by_v`, times the side of a `texel`.
    fn of_texel(direction: DVec3, [by_u, by_v]: [DVec3; 2], texel: f64, variance: f64) -> Self {
        let along = by_u.normalize();
        let across = direction.cross(along);
        let (long, shear, wide) = (by_u.length(), by_v.dot(along), by_v.dot(across));
        let read = texel * texel / 6.0;
        let covariance = [
            variance - read * (long * long + shear * shear),
            -read * shear * wide,
            variance - read * wide * wide,
        ];
        let reach = DVec2::new(by_v.length(), by_u.length()) / (long * wide).abs() / texel;
        Self {
            direction: direction.as_vec3(),
            axes: [along.as_vec3(), across.as_vec3()],
            covariance: covariance.map(|value| value as f32),
            reach: reach.as_vec2(),
        }
    }

    /// Narrowed by what sums of points add that each have the light of a texel of a map of `inner` texels
    /// around them: a twelfth of its square.
    pub(super) fn of_points(mut self, inner: u32) -> Self {
        let texel = 2.0 / inner as f32;
        for step in steps_from_oct(oct_from(self.direction).as_dvec2()) {
            let [p, q] = self.axes.map(|axis| axis.dot(step.as_vec3()) * texel);
            let own = [p * p, p * q, q * q];
            self.covariance.iter_mut().zip(own).for_each(|(covariance, own)| *covariance -= own / 12.0);
        }
        self
    }

    /// Where a read around the Gaussian stands, by its place around one of covariance 1.
    pub(super) fn read(self) -> impl Fn(Vec2) -> Vec3 {
        let Self { direction, axes: [along, across], covariance: [a, b, c], .. } = self;
        // The covariance's root, a triangle.
        let long = a.sqrt();
        let (shear, wide) = (b / long, (c - b * b / a).sqrt());
        move |tap| {
            let [p, q] = [long * tap.x, shear * tap.x + wide * tap.y];
            // A distance on the sphere whose 1 - cos is half its square.
            let half = 0.5 * (p * p + q * q);
            direction * (1.0 - half) + (along * p + across * q) * (1.0 - 0.5 * half).sqrt()
        }
    }

    /// The Gaussian at a direction whose fourth component is ignored; `None` beyond [`CUT`].
    fn bell(&self) -> impl Fn(Vec4) -> Option<f32> {
        let [a, b, c] = self.covariance.map(|value| value / CUT_COVARIANCE);
        // Half of the inverse.
        let [a, b, c] = [c, -b, a].map(|value| 0.5 * value / (a * c - b * b));
        let [along, across] = self.axes.map(|axis| axis.extend(0.0));
        let direction = self.direction.extend(0.0);
        move |other| {
            let offset = other - direction;
            let (p, q) = (offset.dot(along), offset.dot(across));
            let exponent = a * p * p + 2.0 * b * p * q + c * q * q;
            (exponent < 0.5 * CUT * CUT).then(|| exp_of_negative(exponent))
        }
    }
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

/// The texels of a mirror, clamped, for sums over those around a direction.
pub(super) struct Texels {
    inner: u32,
    /// Direction and solid angle density of every texel.
    directions: Vec<Vec4>,
    light: Vec<Vec3A>,
}

impl Texels {
    pub(super) fn new(mirror: &Map, clamp: f32) -> Self {
        let inner = mirror.inner();
        let (count, at) = ((inner * inner) as usize, |k: usize| [k as u32 % inner, k as u32 / inner]);
        let directions = parallel::values(count, |k| {
            let [x, y] = at(k);
            let point = octahedron_from_oct(texel_centre(inner, x, y));
            point.normalize().as_vec3().extend(point.length().powi(-3) as f32)
        });
        let light = parallel::values(count, |k| {
            let [x, y] = at(k).map(|at| at as i32);
            let own = mirror.texel(x, y);
            own * suns::kept(own.max_element(), clamp)
        });
        Self { inner, directions, light }
    }

    /// Their light under a Gaussian of about `width` at `place` of another map.
    pub(super) fn under(&self, place: Place, width: f64) -> Vec3A {
        let size = self.inner as usize;
        let uv = (oct_from(place.direction) + 1.0) * (0.5 * self.inner as f32);
        let centre = uv.to_array().map(|at| (at as u32).min(self.inner - 1));
        // Directions lie up to half a texel beside its centre.
        let reach =
            reach_of(&Place::new(self.inner, centre[0], centre[1], 1.0), width).map(|texels| texels + 1);
        let place = place.of_points(self.inner);
        let bell = place.bell();
        let (mut sum, mut total) = (Vec3A::ZERO, 0.0);
        visit_window(self.inner, centre, reach, |y, columns| {
            let row = y as usize * size + columns.start as usize..y as usize * size + columns.end as usize;
            for (other, light) in self.directions[row.clone()].iter().zip(&self.light[row]) {
                if let Some(height) = bell(*other) {
                    sum += other.w * height * light;
                    total += other.w * height;
                }
            }
        });
        sum / total
    }
}

/// Texels along u and v that a Gaussian of `width` at `place` of their map reaches.
fn reach_of(place: &Place, width: f64) -> [u32; 2] {
    (place.reach * (1.1 * CUT * width as f32)).to_array().map(|texels| texels.ceil() as u32)
}

/// The sharp level: sums of the texels of `mirror`, clamped to `clamp`, under a Gaussian of `width`.
pub(crate) fn sharp(mirror: &Map, clamp: f32, width: f64) -> Map {
    let Texels { inner, directions, light } = Texels::new(mirror, clamp);
    let size = inner as usize;
    Map::of_quarters(inner, |x, y| {
        let place = Place::new(inner, x, y, width * width).of_points(inner);
        let bell = place.bell();
        let mut sums = [Vec3A::ZERO; 4];
        let mut total = 0.0;
        visit_window(inner, [x, y], reach_of(&place, width), |y, columns| {
            let (first, count) = (columns.start as usize, columns.len());
            let (y, far) = (y as usize, size - first - count);
            let row = |y: usize, first: usize| &light[y * size + first..][..count];
            let directions = &directions[y * size + first..][..count];
            let above = row(y, first).iter().zip(row(y, far).iter().rev());
            let below = row(size - 1 - y, first).iter().zip(row(size - 1 - y, far).iter().rev());
            for ((other, above), below) in directions.iter().zip(above).zip(below) {
                if let Some(height) = bell(*other) {
                    let weight = other.w * height;
                    sums[0] += weight * above.0;
                    sums[1] += weight * above.1;
                    sums[2] += weight * below.0;
                    sums[3] += weight * below.1;
                    total += weight;
                }
            }
        });
        sums.map(|sum| sum / total)
    })
}

/// exp(-x) for x from 0 to [`CUT`]^2 / 2, to a relative 3e-5: the eighth power of a polynomial.
fn exp_of_negative(x: f32) -> f32 {
    let t = -0.125 * x;
    let root = 1.0 + t * (1.0 + t * (0.5 + t * (1.0 / 6.0 + t * (1.0 / 24.0 + t * (1.0 / 120.0)))));
    let square = root * root;
    let fourth = square * square;
    fourth * fourth
}

/// Visits the texels within `reach` of texel `centre` in the unfolded plane, each once, as rows and their
/// columns: around +-X and +-Z that plane shows them twice.
fn visit_window(
    inner: u32,
    centre: [u32; 2],
    reach: [u32; 2],
    mut visit: impl FnMut(u32, std::ops::Range<u32>),
) {
    let [x, y] = centre;
    let is_inside = |at: u32, reach: u32| at >= reach && at + reach < inner;
    if is_inside(x, reach[0]) && is_inside(y, reach[1]) {
        (y - reach[1]..=y + reach[1]).for_each(|row| visit(row, x - reach[0]..x + reach[0] + 1));
        return;
    }
    let [i, j] = reach.map(i64::from);
    for row in i64::from(y) - j..=i64::from(y) + j {
        for column in i64::from(x) - i..=i64::from(x) + i {
            let own = wrap_texel(inner, column, row);
            let is_own = (i64::from(own.0), i64::from(own.1)) == (column, row);
            if is_own || own.0.abs_diff(x) > reach[0] || own.1.abs_diff(y) > reach[1] {
                visit(own.1, own.0..own.0 + 1);
            }
        }
    }
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

/// Over the variance of a level's Gaussian, that of the one between it and the next finer level.
pub(super) const BETWEEN: f64 = 0.75;

/// The level of `inner` texels under a Gaussian of `width`, from the one of half that width.
pub(crate) fn cascade(finer: &Map, inner: u32, width: f64) -> Map {
    let taps = taps();
    Map::of_quarters(inner, |x, y| {
        let read = Place::new(inner, x, y, BETWEEN * width * width).read();
        let mut sums = [Vec3A::ZERO; 4];
        for (tap, weight) in taps {
            finer.add_mirrored(&mut sums, oct_from(read(tap)), weight);
        }
        sums
    })
}

/// [`oct_from_direction`] in single precision.
fn oct_from(direction: Vec3) -> Vec2 {
    let p = direction / direction.abs().element_sum();
    if p.y >= 0.0 {
        Vec2::new(p.x, p.z)
    } else {
        Vec2::new((1.0 - p.z.abs()).copysign(p.x), (1.0 - p.x.abs()).copysign(p.z))
    }
}
