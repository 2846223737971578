//! The reads of an anisotropic reflection, over roughness, n.v, the tangent's azimuth and anisotropy.
//!
//! A lobe's light is spread by twice S h, where h are slopes of the half vector along the plane of incidence
//! and across it, and S = diag(1, n.v). With A the matrix of GGX's squared alphas in these axes, M = S A S
//! is the lobe's shape in light: its greater eigenvalue the squared length, its lesser one the squared
//! width. Reads stand in a row along the length, by a law. Without anisotropy length is alpha, width alpha
//! n.v, and the row lies in the plane of incidence.

mod blend;
mod law;

use super::Levels;
use super::brdf::Brdf;
use super::fit::smooth;
use super::reads::{
    AROUND, HARMONICS, HARMONICS_FROM, Lobe, Point, RIDGE, Read, half_vectors, level_of, weights,
    wide_functions,
};
use crate::common::frame::LEAST_COSINE;
use crate::common::once::Known;
use crate::common::parallel;
use crate::lobe::legendre;
pub use blend::{albedo, albedo_along, mean_albedo};
use glam::{DVec2, DVec3};
use half::f16;
pub use law::LAW;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Reads at places of their own.
pub const READS: usize = 15;

/// The read in the middle of the row.
pub const MIDDLE: usize = 7;

/// Texels of a node with the weights of reads, by their distance from the middle: the middle's and the
/// cosine's, then those on either side.
pub const PAIRS: usize = 8;

/// Texels of a node. After those of reads come the weights of harmonics, two in a texel, those symmetric
/// about the plane of incidence first.
pub const LAYERS: usize = 21;

/// Harmonics that change sign in the plane of incidence: pairs of a direction of [`ASIDE`] and an order of at
/// least its place, from 1.
pub const SKEW: usize = 10;

/// Directions whose zonal harmonics, less those around their mirror images, change sign in the plane of
/// incidence: angles from the normal, and from the plane. Those of order l around the first l are as far from
/// dependent as four directions allow.
pub const ASIDE: [[f64; 2]; 4] = [[2.344, 0.869], [1.353, 0.407], [0.413, 1.272], [2.164, 1.401]];

const _: () = {
    assert!(2 * MIDDLE + 1 == READS && PAIRS == MIDDLE + 1, "pairs of reads");
    assert!(LAYERS == PAIRS + (HARMONICS + SKEW).div_ceil(2), "pairs of harmonics");
};

/// A node of the table. First numbers are for f0, second for f90; weights are shares of the albedo.
pub type Node = [[f32; 4]; LAYERS];

/// Nodes over roughness, evenly in log(1 + 5 r); over n.v, evenly in its root; over the azimuth of the
/// tangent from the plane of incidence, evenly in the power 2/3 of its distance from a right angle; and over
/// anisotropy, evenly in the logarithm of alpha along the tangent, from alpha across it to 1.
pub const NODES: [usize; 4] = [16, 10, 8, 7];

/// How much denser nodes are at roughness 0 than at 1, less 1.
const CROWDING: f64 = 5.0;

/// Alpha across the tangent from which on log(alpha) counts.
const SHARP: f64 = 1e-3;

/// Sine of the view's angle from which on the row is as tilted as the law says, and the cosine of the row's
/// angle to the plane of incidence from which on its sides differ as the table says.
const TILTED: f64 = 0.5;
const SKEWED: f64 = 0.2;

/// Functions of the fit: reads, cosine, harmonics.
const FUNCTIONS: usize = READS + 1 + HARMONICS + SKEW;

/// Rings and spokes of half vectors.
const FIT_GRID: [u32; 2] = [36, 28];

/// Places of reads are this far apart for the law.
const STEP: f64 = 8.0 / 14.0;

/// Width of a lobe over its length, from which on it grows no narrower for the law.
pub(super) const NARROWEST: f64 = 0.05;

/// What the law says of a row: its shift, logarithms of its step over its least width, of its bend, of the
/// least width over the length, of how widths grow with the slope, and of how they alternate.
pub const NUMBERS: usize = 6;

/// Terms of the law: 1, x, x^2, y, x y, y^2, e, e x, x^3, y^3, x^2 y and x y^2, x = ln (width over length),
/// y = ln(1 + 6 length), e the square of the cosine of the row's angle to the plane of incidence. Shift
/// counts that cosine times. Both fade out where the view is along the normal, and that plane means nothing.
pub const TERMS: usize = 12;

/// A law of reads: each number of a row is the sum of these times the terms.
pub type Law = [[f64; TERMS]; NUMBERS];

/// A row of reads.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Slopes of the half vector along the plane of incidence and across it, of a read of slope 1.
    pub axis: DVec2,
    /// Slope along the axis, and width in light, of each read.
    pub reads: [[f64; 2]; READS],
    /// Width of the lobe over its length, and its length.
    pub shape: [f64; 2],
    /// How much of the difference between weights either side of the middle counts: none of it in a row
    /// across the plane of incidence, whose sides are mirror images.
    pub skew: f64,
}

impl Row {
    /// The row of a lobe with `alpha` along `tangent` and across it. The tangent is a unit vector along the
    /// plane of incidence and across it, `cosine` is n.v.
    pub fn new(alpha: DVec2, tangent: DVec2, cosine: f64) -> Self {
        Shape::new(alpha, tangent, cosine).row(&LAW)
    }
}

/// What the law goes by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// Slopes of the half vector along the plane of incidence and across it, of a read of slope 1.
    axis: DVec2,
    /// Width of the lobe over its length, and its length.
    ratio: f64,
    pub(super) length: f64,
    /// The cosine of the row's angle to the plane of incidence, and as the law counts it.
    along: f64,
    pub(super) tilt: f64,
    pub(super) terms: [f64; TERMS],
}

impl Shape {
    /// The shape of the lobe of [`Row::new`].
    fn new(alpha: DVec2, tangent: DVec2, cosine: f64) -> Self {
        let squares = alpha * alpha;
        let more = squares.x - squares.y;
        let (along, across) = (squares.y + more * tangent.x.powi(2), squares.y + more * tangent.y.powi(2));
        let mixed = more * tangent.x * tangent.y * cosine;
        let across = across * cosine * cosine;
        let (mean, apart) = (f64::midpoint(along, across), 0.5 * (along - across));
        let root = apart.hypot(mixed);
        let length = (mean + root).sqrt();
        let ratio = alpha.x * alpha.y * cosine / (mean + root).max(f64::MIN_POSITIVE);
        let axis = if apart >= 0.0 {
            DVec2::new(apart + root, mixed)
        } else {
            DVec2::new(mixed.abs(), if mixed >= 0.0 { root - apart } else { apart - root })
        };
        let axis = axis.normalize_or(DVec2::X);
        let (x, y) = (ratio.max(NARROWEST).ln(), (1.0 + 6.0 * length).ln());
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let tilt = axis.x * smooth(sine / TILTED);
        let e = axis.x * tilt;
        Self {
            axis: DVec2::new(axis.x, axis.y / cosine) * (2.0 * root).sqrt(),
            ratio,
            length,
            along: axis.x,
            tilt,
            terms: [1.0, x, x * x, y, x * y, y * y, e, e * x, x.powi(3), y.powi(3), x * x * y, x * y * y],
        }
    }

    /// The numbers of the row by `law`.
    pub(super) fn numbers(&self, law: &Law) -> [f64; NUMBERS] {
        let mut numbers = law.map(|own| own.iter().zip(self.terms).map(|(own, term)| own * term).sum());
        numbers[0] *= self.tilt;
        numbers
    }

    /// The row by `law`.
    fn row(&self, law: &Law) -> Row {
        Row {
            axis: self.axis,
            reads: row(self.numbers(law)).map(|[slope, width]| [slope, width * self.length]),
            shape: [self.ratio, self.length],
            skew: smooth(self.along / SKEWED),
        }
    }
}

/// Slope and width of each read by the numbers of the law.
pub(super) fn row([shift, spacing, bend, width, growth, alternation]: [f64; NUMBERS]) -> [[f64; 2]; READS] {
    let [spacing, bend, width, growth] = [spacing, bend, width, growth].map(f64::exp);
    std::array::from_fn(|read| {
        let place = (read as f64 - MIDDLE as f64) * STEP + shift;
        let slope = width * spacing * (bend * place).sinh() / bend;
        let wider = if read % 2 == MIDDLE % 2 { alternation } else { -alternation }.exp();
        [slope, wider * width * (1.0 + (growth * slope).powi(2)).sqrt()]
    })
}

/// Alpha along the tangent and across it at places between the first node and the last.
fn alphas_of(roughness: f64, anisotropy: f64) -> DVec2 {
    let r = (((1.0 + CROWDING).ln() * roughness).exp() - 1.0) / CROWDING;
    DVec2::new((r * r).max(SHARP).powf(1.0 - anisotropy), r * r)
}

/// n.v of a place.
fn cosine_of(place: f64) -> f64 {
    place.powi(2).max(LEAST_COSINE)
}

/// Azimuth of a place.
fn azimuth_of(place: f64) -> f64 {
    FRAC_PI_2 * (1.0 - (1.0 - place).powf(1.5))
}

/// Alphas, n.v and azimuth of a node.
fn lobe_of(index: usize) -> (DVec2, f64, f64) {
    let [across, up, around, deep] = NODES;
    let share = |node: usize, nodes: usize| node as f64 / (nodes - 1) as f64;
    let (x, y) = (index % across, index / across % up);
    let (z, w) = (index / across / up % around, index / across / up / around);
    let alpha = alphas_of(share(x, across), share(w, deep));
    (alpha, cosine_of(share(y, up)), azimuth_of(share(z, around)))
}

/// The fit of node `index`, first axes first.
pub fn fit_of_node(levels: Levels, index: usize) -> Fit {
    let (alpha, cosine, azimuth) = lobe_of(index);
    Fit::new(levels, alpha, cosine, azimuth)
}

/// All nodes over the levels of `levels`, first axes first.
pub fn table(levels: Levels) -> Vec<Node> {
    parallel::map(0..NODES.iter().product(), |index| *node(levels, index))
}

/// Width, height and depth of the table as a texture.
pub const TEXTURE: [u32; 3] =
    [(NODES[0] * LAYERS) as u32, (NODES[1] * NODES[3] + blend::ROWS) as u32, NODES[2] as u32];

/// The table as shaders read it: nodes over roughness side by side, for each texel of a node; below one
/// another those over n.v, for each anisotropy; azimuths along the third axis. Below them the albedo.
pub fn texels(levels: Levels) -> Vec<[f32; 4]> {
    let [across, up, around, deep] = NODES;
    let nodes = table(levels);
    let node = |x, y, z, w| &nodes[x + across * (y + up * (z + around * w))];
    let albedo = blend::texels();
    let mut texels = Vec::with_capacity(TEXTURE.iter().product::<u32>() as usize);
    for (z, albedo) in albedo.chunks(albedo.len() / around).enumerate() {
        for (w, y) in (0..deep).flat_map(|w| (0..up).map(move |y| (w, y))) {
            texels.extend((0..LAYERS).flat_map(|layer| (0..across).map(move |x| node(x, y, z, w)[layer])));
        }
        texels.extend_from_slice(albedo);
    }
    texels
}

/// One node, fitted at the first call.
fn node(levels: Levels, index: usize) -> &'static Node {
    static FITTED: [Known<Node>; Levels::ALL] =
        [const { Known::new(NODES[0] * NODES[1] * NODES[2] * NODES[3]) }; Levels::ALL];
    FITTED[levels.index()].get_or_init(index, || {
        let (alpha, cosine, azimuth) = lobe_of(index);
        fitted(levels, alpha, cosine, azimuth)
    })
}

/// The node for `alpha` along the tangent and across it, n.v of `cosine`, and the tangent's `azimuth` from
/// the plane of incidence, between those of [`table`], which are fitted as they are needed.
pub fn node_at(levels: Levels, alpha: DVec2, cosine: f64, azimuth: f64) -> Node {
    let mut sum = [[0.0; 4]; LAYERS];
    for (index, weight) in corners(alpha, cosine, azimuth) {
        for (texel, own) in sum.iter_mut().zip(node(levels, index)) {
            texel.iter_mut().zip(own).for_each(|(value, own)| *value += weight * own);
        }
    }
    sum
}

/// The nodes around a lobe and their weights, those of none left out.
fn corners(alpha: DVec2, cosine: f64, azimuth: f64) -> impl Iterator<Item = (usize, f32)> {
    let sharp = alpha.y.max(SHARP);
    let places = [
        (1.0 + CROWDING * alpha.y.sqrt()).ln() / (1.0 + CROWDING).ln(),
        cosine.sqrt(),
        1.0 - (1.0 - azimuth / FRAC_PI_2).max(0.0).powf(2.0 / 3.0),
        (alpha.x.max(sharp) / sharp).ln() / -(sharp.min(1.0 - 1e-6).ln()),
    ];
    nodes_around::<4, 16>(NODES, places)
}

/// The nodes of a table around `places`, between the first node and the last of each axis, and their weights,
/// those of none left out. First axes come first; there are `CORNERS`, two to the power of the axes.
fn nodes_around<const AXES: usize, const CORNERS: usize>(
    nodes: [usize; AXES],
    places: [f64; AXES],
) -> impl Iterator<Item = (usize, f32)> {
    let mut corners = [(0, 1.0_f32); CORNERS];
    let mut stride = 1;
    for (axis, (nodes, place)) in nodes.into_iter().zip(places).enumerate() {
        let place = place.clamp(0.0, 1.0) * (nodes - 1) as f64;
        let whole = (place as usize).min(nodes - 2);
        let share = (place - whole as f64) as f32;
        for (k, (index, weight)) in corners.iter_mut().enumerate() {
            let upper = k >> axis & 1;
            *index += (whole + upper) * stride;
            *weight *= if upper == 1 { share } else { 1.0 - share };
        }
        stride *= nodes;
    }
    corners.into_iter().filter(|(_, weight)| *weight != 0.0)
}

/// A reflection that is fitted.
#[derive(Clone, Debug)]
pub struct Fit {
    levels: Levels,
    view: DVec3,
    pub(super) shape: Shape,
    pub(super) lobe: Lobe,
    /// Scale and bias of f0.
    albedo: [f64; 2],
    /// Functions in use, and the ridge of each.
    used: usize,
    pub(super) ridge: [f64; FUNCTIONS],
}

impl Fit {
    /// The reflection with `alpha` along the tangent and across it, at n.v of `cosine`, its tangent at
    /// `azimuth` from the plane of incidence.
    pub fn new(levels: Levels, alpha: DVec2, cosine: f64, azimuth: f64) -> Self {
        let (y, x) = azimuth.sin_cos();
        let tangent = DVec2::new(x, y);
        let view = DVec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
        // The view in axes of the tangent, and the way back from there to those of the plane of incidence.
        let seen = DVec3::new(view.x * x, -view.x * y, view.z);
        let back = |d: DVec3| (tangent * d.x + tangent.perp() * d.y).extend(d.z);
        // Sharper lobes than the mirror's are served by the mirror.
        let least = (0.5 * levels.width(0)).powi(4);
        let served = DVec2::from_array(alpha.to_array().map(|alpha| (alpha.powi(4) + least).powf(0.25)));
        let brdf = Brdf::of_alphas(seen, served);
        let [from, to] = HARMONICS_FROM;
        let use_harmonics = smooth((alpha.x.sqrt() - from) / (to - from));
        // Half vectors are dense as the lobe is, stretched along the tangent at the same area.
        let stretch = (served.x / served.y).sqrt();
        let stretch = DVec3::new(stretch, 1.0 / stretch, 1.0);
        let points = half_vectors((served.x * served.y).sqrt(), FIT_GRID, TAU)
            .filter_map(|(half, area)| {
                let half = half * stretch;
                let length = half.length();
                Point::new(half / length, area / length.powi(3), seen, &brdf)
            })
            .map(|point| Point { light: back(point.light), ..point });
        // Lobes narrower than the mirror's texels are served by equal reads of it.
        let shape = Shape::new(alpha, tangent, cosine);
        let narrow = levels.width(0) / (2.0 * shape.ratio.max(NARROWEST) * shape.length.max(1e-6));
        let mut ridge = [RIDGE[1] / use_harmonics; FUNCTIONS];
        ridge[..READS].fill(RIDGE[0] * (1.0 + narrow.powi(4)));
        Self {
            levels,
            view,
            shape,
            lobe: Lobe::new(points),
            albedo: albedo(seen, alpha),
            used: if use_harmonics > 0.0 { FUNCTIONS } else { READS },
            ridge,
        }
    }

    /// The same, with what counts for places.
    pub fn for_places(self) -> Self {
        Self { lobe: self.lobe.for_places(), ..self }
    }

    /// What the law goes by.
    pub fn terms(&self) -> [f64; TERMS] {
        self.shape.terms
    }

    /// A read at `slope` along the row's axis, of `width`.
    pub(super) fn read(&self, [slope, width]: [f64; 2]) -> Read {
        let half = (DVec3::Z + (slope * self.shape.axis).extend(0.0)).normalize();
        let direction = half * (2.0 * self.view.dot(half)) - self.view;
        let level = level_of(self.levels, width);
        Read::new(self.levels, direction, level)
    }

    /// What the weights multiply, of light from a unit vector: reads, the clamped cosine, harmonics.
    pub(super) fn functions(reads: &[Read; READS]) -> impl Fn(DVec3) -> [f64; FUNCTIONS] {
        let around = AROUND.map(|angle| DVec3::new(angle.sin(), 0.0, angle.cos()));
        let aside = ASIDE.map(aside);
        move |light| {
            let mut values = [0.0; FUNCTIONS];
            for (value, read) in values.iter_mut().zip(reads) {
                *value = read.at(light);
            }
            let (wide, skew) = values[READS..].split_at_mut(1 + HARMONICS);
            wide_functions(wide, &around, light);
            let mirrored = light * DVec3::new(1.0, -1.0, 1.0);
            let zonal = aside.iter().enumerate().flat_map(|(k, direction)| {
                let [own, other] = [light, mirrored].map(|light| legendre(direction.dot(light)));
                (1 + k..5).map(move |order| {
                    f64::from(2 * order as u32 + 1) / (4.0 * PI) * (own[order] - other[order])
                })
            });
            skew.iter_mut().zip(zonal).for_each(|(value, zonal)| *value = zonal);
            values
        }
    }

    /// The weights for f0 and f90 with these `reads`.
    pub(super) fn weights(&self, reads: &[Read; READS]) -> Vec<[f32; 2]> {
        weights(&self.lobe, READS, self.used, &self.ridge, self.albedo, Self::functions(reads))
    }
}

/// The node that fits the reflection with `alpha` along the tangent and across it, at n.v of `cosine`, its
/// tangent at `azimuth` from the plane of incidence.
pub fn fitted(levels: Levels, alpha: DVec2, cosine: f64, azimuth: f64) -> Node {
    let fit = Fit::new(levels, alpha, cosine, azimuth);
    let reads = fit.shape.row(&LAW).reads.map(|place| fit.read(place));
    let mut node = [[0.0; 4]; LAYERS];
    for (k, pair) in fit.weights(&reads).into_iter().enumerate() {
        let [texel, at] = place_of(k);
        // Where nothing is reflected, shares mean nothing.
        let share = |side: usize| pair[side] / (fit.albedo[side] as f32).max(1e-6);
        node[texel][at..at + 2].copy_from_slice(&[share(0), share(1)]);
    }
    node.map(|texel| texel.map(|value| f16::from_f32(value).to_f32()))
}

/// The texel of function `k`, and the place of its two weights there.
fn place_of(k: usize) -> [usize; 2] {
    match k {
        _ if k < MIDDLE => [MIDDLE - k, 2],
        _ if k < READS => [k - MIDDLE, 0],
        READS => [0, 2],
        _ => [PAIRS + (k - READS - 1) / 2, 2 * ((k - READS - 1) % 2)],
    }
}

/// The direction at angles from the normal and from the plane of incidence.
pub fn aside([from_normal, from_plane]: [f64; 2]) -> DVec3 {
    let ((sine, cosine), (y, x)) = (from_normal.sin_cos(), from_plane.sin_cos());
    DVec3::new(sine * x, sine * y, cosine)
}
