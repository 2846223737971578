//! The sharp level: sums of the mirror's texels under a Gaussian, row by row of a window around its texel.

use super::levels::{Map, POINTS, Place, READ, oct_from};
use super::suns;
use crate::common::parallel;
use crate::common::vector::{Arch, Fused as _};
use crate::sphere::octahedral::{direction_from_oct, solid_angle_density, texel_centre, wrap_texel};
use glam::{Vec2, Vec3, Vec3A};
use std::ops::Range;

/// The Gaussian ends at so many standard deviations.
pub(crate) const CUT: f32 = 3.0;

/// The share of a Gaussian's covariance that is left of it where it ends at [`CUT`].
pub(crate) const CUT_COVARIANCE: f32 = 0.949_448;

/// More than it reaches by flat texels.
pub(crate) const MARGIN: f32 = 1.1;

/// Texels along an edge from which on the sphere is as flat under the Gaussian.
pub(crate) const LARGE: u32 = 256;

/// Texels of a row that are summed together.
const TOGETHER: usize = 16;

/// Texels of the unfolded plane around the square, for windows across its edges.
const BORDER: u32 = 32;

/// Bytes that building the sharp level of `inner` texels along an edge takes.
pub(crate) const fn bytes(inner: u32) -> u64 {
    let [quarter, whole] = [(inner / 2 + 2 * BORDER) as u64, (inner + 2 * BORDER) as u64];
    4 * (4 * quarter * quarter + 3 * whole * whole)
}

/// Planes of a square with [`BORDER`] texels around it, row by row those of each.
struct Planes<const COUNT: usize> {
    stride: usize,
    rows: Vec<f32>,
}

impl<const COUNT: usize> Planes<COUNT> {
    /// Of the first `columns` along each edge of a map of `inner` texels, and what lies beside them in the
    /// unfolded plane: `values(x, y)` of the map's texels.
    fn new(inner: u32, columns: u32, values: impl Fn(u32, u32) -> [f32; COUNT] + Sync) -> Self {
        let stride = (columns + 2 * BORDER) as usize;
        let mut rows = vec![0.0; stride * stride * COUNT];
        let border = i64::from(BORDER);
        parallel::for_each(rows.chunks_exact_mut(stride * COUNT).zip(-border..), |(row, y)| {
            for x in 0..stride {
                let (u, v) = wrap_texel(inner, x as i64 - border, y);
                let places = row[x..].iter_mut().step_by(stride);
                places.zip(values(u, v)).for_each(|(place, value)| *place = value);
            }
        });
        Self { stride, rows }
    }

    /// `LANES` texels' values of a plane, from (`x`, `y`) on.
    #[inline(always)]
    fn lanes<const LANES: usize>(&self, plane: usize, y: i32, x: i32) -> [f32; LANES] {
        let [x, y] = [x, y].map(|at| (at + BORDER as i32) as usize);
        lanes(&self.rows, (y * COUNT + plane) * self.stride + x)
    }
}

/// The texels of a mirror, clamped.
pub(super) struct Texels {
    inner: u32,
    /// Red, green and blue.
    light: Planes<3>,
    /// x, y and z of directions, and solid angle densities, in the first quarter and beside it.
    places: Planes<4>,
    arch: Arch,
}

impl Texels {
    pub(super) fn new(mirror: &Map, clamp: f32) -> Self {
        let inner = mirror.inner();
        let light = |x: u32, y: u32| {
            let own = mirror.texel(x as i32, y as i32);
            (own * suns::kept(own.max_element(), clamp)).to_array()
        };
        Self {
            inner,
            light: Planes::new(inner, inner, light),
            places: Planes::new(inner, inner / 2, |x, y| place_of_texel(inner, x, y)),
            arch: Arch::new(),
        }
    }

    /// Their light under a Gaussian of about `width` at `place` of another map.
    pub(super) fn under(&self, place: Place, width: f64) -> Vec3A {
        let signs = Vec3::new(-place.direction.x.signum(), 1.0, -place.direction.z.signum());
        let place = place.mirrored(signs);
        let uv = (oct_from(place.direction) + 1.0) * (0.5 * self.inner as f32);
        let centre = uv.to_array().map(|at| (at as u32).min(self.inner / 2 - 1));
        // Directions lie up to half a texel beside its centre.
        let reach = reach_of(&Place::new(self.inner, centre[0], centre[1], 1.0, READ), width)
            .map(|texels| texels + 1);
        let sums = self.mirrored(&place.of_points(self.inner), centre, reach, None);
        sums[usize::from(signs.x < 0.0) + 2 * usize::from(signs.z < 0.0)]
    }

    /// Their light under the Gaussian at `place` of the first quarter, and at its places mirrored along u,
    /// along v, and along both, from those within `reach` of texel `centre`.
    fn mirrored(
        &self,
        place: &Place,
        centre: [u32; 2],
        reach: [u32; 2],
        ellipse: Option<Ellipse>,
    ) -> [Vec3A; 4] {
        let bell = Bell::new(place);
        self.arch.dispatch(Window { texels: self, bell, centre, reach, ellipse })
    }
}

/// The direction and the solid angle density of texel (`x`, `y`) of a map of `inner` texels.
fn place_of_texel(inner: u32, x: u32, y: u32) -> [f32; 4] {
    let uv = texel_centre(inner, x, y);
    direction_from_oct(uv).as_vec3().extend(solid_angle_density(uv) as f32).to_array()
}

/// Texels along u and v that a Gaussian of `width` at `place` of their map reaches.
fn reach_of(place: &Place, width: f64) -> [u32; 2] {
    (place.reach() * (MARGIN * CUT * width as f32)).to_array().map(|texels| texels.ceil() as u32)
}

/// The sharp level: sums of the texels of `mirror`, clamped to `clamp`, under a Gaussian of `width`.
pub(crate) fn sharp(mirror: &Map, clamp: f32, width: f64) -> Map {
    let texels = Texels::new(mirror, clamp);
    let inner = mirror.inner();
    Map::of_quarters(inner, |x, y| {
        let place = Place::new(inner, x, y, width * width, READ + POINTS);
        let ellipse = Ellipse::new(&place, inner, [x, y], MARGIN * CUT * width as f32);
        texels.mirrored(&place, [x, y], reach_of(&place, width), ellipse)
    })
}

/// Texels of a face that are less than a width from one of them.
struct Ellipse {
    /// Columns that the middle of a row lies beside that of the row before.
    slope: f32,
    /// Half of the columns of the middle row, and of all rows.
    half: [f32; 2],
}

impl Ellipse {
    /// Around texel (`x`, `y`) of the first quarter of a map of `inner` texels; none where it is not flat
    /// there, or not in one face.
    fn new(place: &Place, inner: u32, [x, y]: [u32; 2], width: f32) -> Option<Self> {
        let [long, shear, wide] = place.steps;
        let reach = width * place.reach();
        // Along the sum of x and y, across the quarter's diagonal.
        let reach_of_sum = width * Vec2::new(long - shear, wide).length() / (long * wide).abs();
        let (half, [x, y]) = (inner as f32 / 2.0, [x, y].map(|at| at as f32));
        let is_inside = |at: f32, reach: f32| at >= reach.ceil() && at + reach.ceil() < half;
        let is_flat = inner >= LARGE
            && is_inside(x, reach.x)
            && is_inside(y, reach.y)
            && (x + y + 1.0 - half).abs() >= reach_of_sum;
        is_flat.then(|| Self { slope: -shear / long, half: [width / long, width / wide.abs()] })
    }

    /// Columns of `row`, both counted from the middle, and the column after them.
    #[inline(always)]
    fn columns(&self, row: i32) -> Range<i32> {
        let (row, [across, down]) = (row as f32, self.half);
        let middle = self.slope * row;
        let beside = across * (1.0 - (row / down).powi(2)).max(0.0).sqrt();
        (middle - beside).ceil() as i32..(middle + beside).floor() as i32 + 1
    }
}

/// A Gaussian around a direction.
struct Bell {
    direction: [f32; 3],
    axes: [[f32; 3]; 2],
    /// Factors in the exponent, of the first axis' square, of the product of both, of the second's square.
    exponent: [f32; 3],
}

impl Bell {
    fn new(place: &Place) -> Self {
        let [a, b, c] = place.covariance.map(|value| value / CUT_COVARIANCE);
        let half_inverse = [c, -2.0 * b, a].map(|value| 0.5 * value / (a * c - b * b));
        Self {
            direction: place.direction.to_array(),
            axes: place.axes.map(|axis| axis.to_array()),
            exponent: half_inverse,
        }
    }

    /// Its height at the direction (`x`, `y`, `z`); 0 beyond [`CUT`].
    #[inline(always)]
    fn height(&self, x: f32, y: f32, z: f32) -> f32 {
        let [x, y, z] = [x - self.direction[0], y - self.direction[1], z - self.direction[2]];
        let along = |axis: &[f32; 3]| x.times_plus(axis[0], y.times_plus(axis[1], z * axis[2]));
        let (p, q) = (along(&self.axes[0]), along(&self.axes[1]));
        let [pp, pq, qq] = self.exponent;
        let exponent = p.times_plus(pp.times_plus(p, pq * q), qq * q * q);
        if exponent < 0.5 * CUT * CUT { exp_of_negative(exponent) } else { 0.0 }
    }
}

/// exp(-x) for x from 0 to [`CUT`]^2 / 2, to a relative 3e-5: the eighth power of a polynomial.
#[inline(always)]
fn exp_of_negative(x: f32) -> f32 {
    let t = -0.125 * x;
    let terms = t.times_plus(t.times_plus(1.0 / 120.0, 1.0 / 24.0), 1.0 / 6.0);
    let root = t.times_plus(t.times_plus(t.times_plus(terms, 0.5), 1.0), 1.0);
    let square = root * root;
    let fourth = square * square;
    fourth * fourth
}

/// The texels within `reach` of texel `centre` in the unfolded plane, under a Gaussian.
struct Window<'a> {
    texels: &'a Texels,
    bell: Bell,
    centre: [u32; 2],
    reach: [u32; 2],
    /// What of them the Gaussian reaches, if it lies in one face.
    ellipse: Option<Ellipse>,
}

impl pulp::NullaryFnOnce for Window<'_> {
    type Output = [Vec3A; 4];

    #[inline(always)]
    fn call(self) -> [Vec3A; 4] {
        let Self { texels, bell, centre, reach, ellipse } = self;
        let inner = texels.inner as i32;
        let ([x, y], [across, down]) = (centre.map(|at| at as i32), reach.map(|texels| texels as i32));
        let mut sums = Sums::default();
        if let Some(ellipse) = ellipse {
            for row in -down..=down {
                for column in ellipse.columns(row).step_by(TOGETHER) {
                    sums.add_row(texels, &bell, [y + row, x + column]);
                }
            }
            return sums.means();
        }
        let count = (2 * reach[0] + 1).next_multiple_of(TOGETHER as u32) as i32;
        let columns = x - across..x - across + count;
        let rows = y - down..y + down + 1;
        // Around +-X and +-Z the unfolded plane shows texels twice: those on both sides of an edge's middle.
        let is_once = |along: &Range<i32>, other: &Range<i32>| {
            let is_inside = along.start >= 0 && along.end <= inner;
            is_inside || other.end <= inner / 2 || other.start >= inner / 2
        };
        let lies_in_planes =
            |range: &Range<i32>| range.start >= -(BORDER as i32) && range.end <= inner / 2 + BORDER as i32;
        let ranges = [(&columns, &rows), (&rows, &columns)];
        if ranges.into_iter().all(|(along, other)| lies_in_planes(along) && is_once(along, other)) {
            for row in rows {
                for column in columns.clone().step_by(TOGETHER) {
                    sums.add_row(texels, &bell, [row, column]);
                }
            }
        } else {
            for row in rows {
                for column in x - across..=x + across {
                    let own = wrap_texel(texels.inner, column.into(), row.into());
                    let (u, v) = (own.0 as i32, own.1 as i32);
                    if (u, v) == (column, row) || u.abs_diff(x) > reach[0] || v.abs_diff(y) > reach[1] {
                        let place = place_of_texel(texels.inner, own.0, own.1);
                        sums.add(texels, &bell, |plane| [place[plane]], [v, u]);
                    }
                }
            }
        }
        sums.means()
    }
}

/// Sums of weights and of light, by lanes.
#[derive(Default)]
struct Sums {
    weight: [f32; TOGETHER],
    /// Red, green and blue of the texels as they are, mirrored along u, along v, and along both.
    light: [[[f32; TOGETHER]; 3]; 4],
}

impl Sums {
    /// Adds [`TOGETHER`] texels of row `y` from column `x` on, in the first quarter or beside it.
    #[inline(always)]
    fn add_row(&mut self, texels: &Texels, bell: &Bell, [y, x]: [i32; 2]) {
        self.add::<TOGETHER>(texels, bell, |plane| texels.places.lanes(plane, y, x), [y, x]);
    }

    /// Adds `COUNT` texels of row `y` from column `x` on, whose directions and densities are `place`.
    #[inline(always)]
    fn add<const COUNT: usize>(
        &mut self,
        texels: &Texels,
        bell: &Bell,
        place: impl Fn(usize) -> [f32; COUNT],
        [y, x]: [i32; 2],
    ) {
        let (dx, dy, dz, density) = (place(0), place(1), place(2), place(3));
        let (mut weights, mut own) = ([0.0; COUNT], lanes::<COUNT>(&self.weight, 0));
        let mut is_dark = true;
        for k in 0..COUNT {
            weights[k] = density[k] * bell.height(dx[k], dy[k], dz[k]);
            is_dark &= weights[k] == 0.0;
            own[k] += weights[k];
        }
        if is_dark {
            return;
        }
        self.weight[..COUNT].copy_from_slice(&own);
        let reversed = std::array::from_fn(|k| weights[COUNT - 1 - k]);
        let [below, aside] = [texels.inner as i32 - 1 - y, texels.inner as i32 - x - COUNT as i32];
        let places = [(weights, y, x), (reversed, y, aside), (weights, below, x), (reversed, below, aside)];
        for (sums, (weights, y, x)) in self.light.iter_mut().zip(places) {
            for (sum, plane) in sums.iter_mut().zip(0..) {
                let (light, mut own) = (texels.light.lanes::<COUNT>(plane, y, x), lanes::<COUNT>(sum, 0));
                for k in 0..COUNT {
                    own[k] = weights[k].times_plus(light[k], own[k]);
                }
                sum[..COUNT].copy_from_slice(&own);
            }
        }
    }

    #[inline(always)]
    fn means(&self) -> [Vec3A; 4] {
        let share = 1.0 / total(&self.weight);
        self.light.map(|channels| Vec3A::from_array(channels.map(|sum| total(&sum) * share)))
    }
}

/// The sum of `lanes`, by halves.
#[inline(always)]
fn total(lanes: &[f32; TOGETHER]) -> f32 {
    let mut sums = *lanes;
    let mut count = TOGETHER;
    while count > 1 {
        count /= 2;
        for k in 0..count {
            sums[k] += sums[k + count];
        }
    }
    sums[0]
}

/// `COUNT` of `all` from the one at `first` on: values, as loops over references that might overlap are not
/// vectorised.
#[inline(always)]
fn lanes<const COUNT: usize>(all: &[f32], first: usize) -> [f32; COUNT] {
    *all[first..].first_chunk().expect("windows lie within the planes")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pyramid::Levels;

    /// Ellipses have every texel under the Gaussian, as narrower ones have not.
    #[test]
    fn rows_reach_as_far_as_the_gaussian() {
        for inner in [LARGE, 2 * LARGE, 8 * LARGE] {
            let width = Levels::over(inner).expect("a size").width(1);
            let missing = |margin: f32| {
                let half = inner / 2;
                let texels =
                    (0..half).step_by(inner as usize / 73).flat_map(|y| (0..half).map(move |x| (x, y)));
                let missing_of = |(x, y): (u32, u32)| {
                    let place = Place::new(inner, x, y, width * width, READ + POINTS);
                    let ellipse = Ellipse::new(&place, inner, [x, y], margin * CUT * width as f32)?;
                    let (bell, reach) =
                        (Bell::new(&place), reach_of(&place, width).map(|texels| texels as i32));
                    let rows =
                        (-reach[1]..=reach[1]).flat_map(|j| (-reach[0]..=reach[0]).map(move |i| (i, j)));
                    let is_missing = |(i, j): &(i32, i32)| {
                        let at = texel_centre(inner, x.wrapping_add_signed(*i), y.wrapping_add_signed(*j));
                        let [x, y, z] = direction_from_oct(at).as_vec3().to_array();
                        bell.height(x, y, z) > 0.0 && !ellipse.columns(*j).contains(i)
                    };
                    Some(rows.filter(is_missing).count())
                };
                let counts: Vec<usize> = texels.filter_map(missing_of).collect();
                assert!(
                    counts.len() > (half * half / (inner / 73)) as usize / 2,
                    "{} in a face",
                    counts.len()
                );
                counts.iter().sum::<usize>()
            };
            assert_eq!(missing(MARGIN), 0, "{inner}");
            assert!(missing(1.0) > 0, "{inner}: a narrower ellipse is not detected");
        }
    }

    /// Windows see every texel under the Gaussian, each once: also across edges, around their middles and at
    /// corners.
    #[test]
    fn windows_have_the_sums_over_all_texels() {
        for inner in [32, 64, 128] {
            let width = Levels::over(inner).expect("a size").width(1);
            let light = |x: u32, y: u32| (x * 7919 + y * 104_729 + x * y) % 1009;
            let mirror = Map::new(inner, |x, y| {
                Vec3A::new(light(x, y) as f32, light(y, x) as f32, light(x + 1, y + 2) as f32)
            });
            let sharp = sharp(&mirror, f32::INFINITY, width);
            let of_row = |y: i32| {
                let mut worst = (0.0, 0);
                for x in 0..inner as i32 {
                    let place = Place::new(inner, x as u32, y as u32, width * width, READ + POINTS);
                    let bell = Bell::new(&place);
                    let (mut sum, mut total) = (Vec3A::ZERO, 0.0);
                    for (v, u) in (0..inner as i32).flat_map(|v| (0..inner as i32).map(move |u| (v, u))) {
                        let [dx, dy, dz, density] = place_of_texel(inner, u as u32, v as u32);
                        // The plane that touches the sphere shows its other side, too.
                        let is_near = place.direction.dot(Vec3::new(dx, dy, dz)) > 0.0;
                        let weight = if is_near { density * bell.height(dx, dy, dz) } else { 0.0 };
                        sum += weight * mirror.texel(u, v);
                        total += weight;
                    }
                    let off = (sharp.texel(x, y) - sum / total).abs().max_element();
                    worst = if off > worst.0 { (off, x) } else { worst };
                }
                worst
            };
            for (y, (off, x)) in parallel::map(0..inner as i32, |y| (y, of_row(y))) {
                assert!(off < 0.05, "{inner}: texel {x}, {y} is off by {off} of 1009");
            }
        }
    }
}
