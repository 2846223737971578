//! What a surface reflects of a white world along a tangent.
//!
//! A viewer sees a lobe by its alpha in the plane of incidence, by that across, and by how far the two are
//! correlated. Where n.v nears the first the albedo dips, as narrowly as that alpha; with the other two it
//! varies slowly. So the albedo of any lobe is, within 6e-4, a blend of those of sixteen lobes of the same
//! alpha in the plane, whose shares go by the other two alone: two tables of two axes stand for one of four.

use super::{LAYERS, NODES as ROW_NODES, nodes_around};
use crate::common::frame::LEAST_COSINE;
use crate::common::once::Known;
use crate::common::parallel;
use crate::pyramid::albedo::albedo_at;
use crate::pyramid::fit::solved;
use crate::sphere::quadrature::gauss_legendre;
use glam::{DVec2, DVec3, Vec3};
use half::f16;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::LazyLock;

/// Lobes that are blended.
const LOBES: usize = 16;

/// Roughness across the plane of incidence and [`Seen::round`] of each. Other lobes count by what their
/// albedo exceeds the first one's by.
const BLENDED: [[f64; 2]; LOBES] = [
    [0.6, 1.0],
    [0.0, 1.0],
    [0.4, 1.0],
    [0.8, 1.0],
    [1.0, 1.0],
    [0.6, 0.6],
    [0.8, 0.6],
    [1.0, 0.6],
    [0.8, 0.3],
    [1.0, 0.3],
    [0.25, 0.0],
    [0.4, 0.0],
    [0.55, 0.0],
    [0.7, 0.0],
    [0.85, 0.0],
    [1.0, 0.0],
];

/// Nodes of the lobes' albedos over roughness in the plane of incidence, evenly in log(1 + 15 r), and over
/// n.v, evenly in its fourth root.
const ALBEDO_NODES: [usize; 2] = [84, 61];

/// Nodes of shares over roughness across the plane, and over [`Seen::round`].
const SHARE_NODES: [usize; 2] = [49, 11];

/// Ratios of alpha across the tangent to that along it, whose means over azimuths are blended, beside that of
/// 1, by what they exceed it by.
const RATIOS: [f64; 8] = [0.0, 0.02, 0.08, 0.18, 0.32, 0.5, 0.68, 0.85];

/// Nodes of these means over roughness along the tangent and n.v, as above.
const MEAN_NODES: [usize; 2] = [84, 21];

/// Nodes of the means' shares, evenly in the root of the ratio.
const RATIO_NODES: usize = 33;

/// Azimuths of the mean, midpoints of a quarter turn.
const AZIMUTHS: u32 = 32;

/// Views, over n.v and alpha in the plane, at which shares fit best.
const FIT_VIEWS: [u32; 2] = [12, 10];

/// Ridge of shares: small ones need few digits.
const RIDGE: f64 = 3e-4;

/// How much denser nodes are at roughness 0 than at 1, less 1.
const CROWDING: f64 = 15.0;

/// Rings and spokes of the quadrature of the albedo: within 4e-4.
const RINGS: u32 = 48;
const SPOKES: u32 = 48;

/// Rows of nodes over n.v in a block of the texture, less 1: the last ones are the next block's first.
const STRIP: usize = 20;

/// Rows and columns of the texture with all of this.
pub(super) const ROWS: usize = STRIP + 1;
const COLUMNS: usize = ROW_NODES[0] * LAYERS;

/// First column of shares, and of those of means.
const SHARES_AT: usize = 3 * ALBEDO_NODES[0];
const RATIOS_AT: usize = SHARES_AT + SHARE_NODES[0] + 1;

const _: () = {
    assert!(ALBEDO_NODES[1] == 3 * STRIP + 1 && MEAN_NODES[1] == STRIP + 1, "blocks of nodes");
    assert!(
        SHARES_AT + MEAN_NODES[0] <= COLUMNS && RATIOS_AT + RATIO_NODES <= COLUMNS,
        "blocks side by side"
    );
    assert!(SHARE_NODES[0] < ALBEDO_NODES[0] && SHARE_NODES[1] <= ROWS, "shares in a block");
    assert!(LOBES == 2 * ROW_NODES[2] && LOBES == 2 * RATIOS.len(), "texels along the third axis");
};

/// A lobe as a viewer sees it.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// Alpha in the plane of incidence, and across.
    alpha: DVec2,
    /// The product of the tangent's alphas over that of these: 1 where the tangent lies in the plane or at
    /// right angles to it, less the more the two are correlated.
    round: f64,
}

impl Seen {
    /// The lobe with `alpha` along a unit `tangent`, along the plane of incidence and across it, and across
    /// that.
    fn new(alpha: DVec2, tangent: DVec2) -> Self {
        let squares = alpha * alpha;
        let seen = (squares.y + (squares.x - squares.y) * tangent * tangent).map(f64::sqrt);
        Self { alpha: seen, round: (alpha.x * alpha.y / (seen.x * seen.y).max(1e-12)).min(1.0) }
    }

    /// What it reflects of a white world at n.v of `cosine`: [`albedo`] along the tangent that it has.
    fn albedo(&self, cosine: f64) -> [f64; 2] {
        let squares = self.alpha * self.alpha;
        let mixed = 2.0 * self.alpha.x * self.alpha.y * (1.0 - self.round * self.round).max(0.0).sqrt();
        let apart = squares.x - squares.y;
        let along = (0.5 * (squares.x + squares.y + apart.hypot(mixed))).sqrt();
        let across = self.alpha.x * self.alpha.y * self.round / along.max(f64::MIN_POSITIVE);
        let (y, x) = (0.5 * mixed.atan2(apart)).sin_cos();
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        albedo(DVec3::new(sine * x, sine * y, cosine), DVec2::new(along, across))
    }
}

/// Scale and bias of f0 at n.v of `cosine`, of the lobe with `alpha` along a unit `tangent`, along the plane
/// of incidence and across it, and across that.
pub fn albedo_along(alpha: DVec2, cosine: f64, tangent: DVec2) -> [f32; 2] {
    let seen = Seen::new(alpha, tangent);
    let between = nodes_around::<2, 4>(SHARE_NODES, [seen.alpha.y.sqrt(), seen.round]);
    let lobes = nodes_around::<2, 4>(ALBEDO_NODES, places(seen.alpha.x, cosine));
    blend([1.0, 0.0], shares_between(between, shares_of_node), lobes, albedos_of_node)
}

/// The same in the mean over the tangent's directions.
pub fn mean_albedo(alpha: DVec2, cosine: f64) -> [f32; 2] {
    let ratio = alpha.y / alpha.x.max(f64::MIN_POSITIVE);
    let between = nodes_around::<1, 2>([RATIO_NODES], [ratio.sqrt()]);
    let round = albedo_at(alpha.x.sqrt() as f32, cosine as f32);
    let means = nodes_around::<2, 4>(MEAN_NODES, places(alpha.x, cosine));
    blend(round, shares_between(between, shares_of_ratio), means, means_of_node)
}

/// Shares between those of some nodes, by index and weight.
fn shares_between<const COUNT: usize>(
    nodes: impl Iterator<Item = (usize, f32)>,
    shares_of: impl Fn(usize) -> &'static [f32; COUNT],
) -> [f32; COUNT] {
    let mut shares = [0.0; COUNT];
    for (index, weight) in nodes {
        shares.iter_mut().zip(shares_of(index)).for_each(|(sum, own)| *sum += weight * own);
    }
    shares
}

/// `sum` and the blend, by `shares`, of what is between some nodes, by index and weight.
fn blend<const COUNT: usize>(
    mut sum: [f32; 2],
    shares: [f32; COUNT],
    nodes: impl Iterator<Item = (usize, f32)>,
    blended_of: impl Fn(usize) -> &'static [[f32; 2]; COUNT],
) -> [f32; 2] {
    for (index, weight) in nodes {
        for (share, blended) in shares.iter().zip(blended_of(index)) {
            sum.iter_mut().zip(blended).for_each(|(sum, own)| *sum += weight * share * own);
        }
    }
    sum.map(|sum| sum.max(0.0))
}

/// Places of an alpha and n.v between the first node and the last.
fn places(alpha: f64, cosine: f64) -> [f64; 2] {
    let least = LEAST_COSINE.powf(0.25);
    [
        (1.0 + CROWDING * alpha.sqrt()).ln() / (1.0 + CROWDING).ln(),
        (cosine.powf(0.25) - least) / (1.0 - least),
    ]
}

/// Alpha and n.v of a node.
fn view_of(nodes: [usize; 2], index: usize) -> (f64, f64) {
    let [x, y] = [index % nodes[0], index / nodes[0]];
    view_at(x as f64 / (nodes[0] - 1) as f64, y as f64 / (nodes[1] - 1) as f64)
}

/// Alpha and n.v of places.
fn view_at(x: f64, y: f64) -> (f64, f64) {
    let least = LEAST_COSINE.powf(0.25);
    let roughness = (((1.0 + CROWDING).ln() * x).exp() - 1.0) / CROWDING;
    (roughness.powi(2), (least + (1.0 - least) * y).powi(4).min(1.0))
}

/// What is blended at a node, as halves hold it: the albedo of the first lobe less that of a mirror without
/// Fresnel's term, which is near 1, and those of the others less the first.
fn albedos_of_node(index: usize) -> &'static [[f32; 2]; LOBES] {
    static KNOWN: Known<[[f32; 2]; LOBES]> = Known::new(ALBEDO_NODES[0] * ALBEDO_NODES[1]);
    KNOWN.get_or_init(index, || {
        let (alpha, cosine) = view_of(ALBEDO_NODES, index);
        blended(alpha, cosine).map(|lobe| lobe.map(as_half))
    })
}

/// The same of any alpha in the plane of incidence, not rounded.
fn blended(alpha: f64, cosine: f64) -> [[f64; 2]; LOBES] {
    let mut albedos = BLENDED
        .map(|[across, round]| Seen { alpha: DVec2::new(alpha, across * across), round }.albedo(cosine));
    let [scale, bias] = albedos[0];
    albedos[1..].iter_mut().for_each(|own| *own = [own[0] - scale, own[1] - bias]);
    albedos[0] = [scale - 1.0, bias];
    albedos
}

/// Shares of the lobes at a node, as halves hold them.
fn shares_of_node(index: usize) -> &'static [f32; LOBES] {
    static KNOWN: Known<[f32; LOBES]> = Known::new(SHARE_NODES[0] * SHARE_NODES[1]);
    /// Alpha in the plane, n.v, and the albedos of lobes there.
    struct View(f64, f64, [[f64; 2]; LOBES]);
    static VIEWED: LazyLock<Vec<View>> = LazyLock::new(|| {
        let evenly = |k: u32, count: u32| f64::from(k) / f64::from(count - 1);
        let [up, across] = FIT_VIEWS;
        let views = (0..up * across).map(|k| view_at(evenly(k % across, across), evenly(k / across, up)));
        views.map(|(alpha, cosine)| View(alpha, cosine, blended(alpha, cosine))).collect()
    });
    KNOWN.get_or_init(index, || {
        let [x, y] = [index % SHARE_NODES[0], index / SHARE_NODES[0]];
        let across = (x as f64 / (SHARE_NODES[0] - 1) as f64).powi(2);
        let round = y as f64 / (SHARE_NODES[1] - 1) as f64;
        let cases = VIEWED.iter().flat_map(|View(alpha, cosine, lobes)| {
            let [scale, bias] = Seen { alpha: DVec2::new(*alpha, across), round }.albedo(*cosine);
            let own = [scale - 1.0 - lobes[0][0], bias - lobes[0][1]];
            [0, 1].map(|side| (own[side], std::array::from_fn(|k| lobes[k + 1][side])))
        });
        let mut shares = [1.0; LOBES];
        shares[1..].copy_from_slice(&shares_of::<{ LOBES - 1 }>(cases));
        shares
    })
}

/// The shares of values that sum to others, with the least squares of what is left, as halves hold them.
fn shares_of<const COUNT: usize>(cases: impl Iterator<Item = (f64, [f64; COUNT])>) -> [f32; COUNT] {
    let mut rows: Vec<_> = (0..COUNT)
        .map(|k| {
            let mut row = vec![0.0; COUNT + 1];
            row[k] = RIDGE * RIDGE;
            row
        })
        .collect();
    for (own, values) in cases {
        for (row, value) in rows.iter_mut().zip(values) {
            row.iter_mut().zip(values.iter().chain([&own])).for_each(|(sum, other)| *sum += value * other);
        }
    }
    let mut shares = solved(rows).into_iter().map(as_half);
    std::array::from_fn(|_| shares.next().expect("a share of each"))
}

/// What the means of a node over azimuths exceed that of a round lobe by, for each of [`RATIOS`].
fn means_of_node(index: usize) -> &'static [[f32; 2]; RATIOS.len()] {
    static KNOWN: Known<[[f32; 2]; RATIOS.len()]> = Known::new(MEAN_NODES[0] * MEAN_NODES[1]);
    KNOWN.get_or_init(index, || {
        let (alpha, cosine) = view_of(MEAN_NODES, index);
        RATIOS.map(|ratio| beyond_round(alpha, ratio, cosine).map(as_half))
    })
}

/// What the mean over azimuths of a lobe with `alpha` along the tangent, `ratio` of that across it, exceeds
/// the albedo of a round one by.
fn beyond_round(alpha: f64, ratio: f64, cosine: f64) -> [f64; 2] {
    let round = albedo_at(alpha.sqrt() as f32, cosine as f32);
    let mut sum = round.map(|round| -f64::from(round));
    for k in 0..AZIMUTHS {
        let tangent = DVec2::from_angle(FRAC_PI_2 * (f64::from(k) + 0.5) / f64::from(AZIMUTHS));
        let own = albedo_along(DVec2::new(alpha, ratio * alpha), cosine, tangent);
        sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += f64::from(own) / f64::from(AZIMUTHS));
    }
    sum
}

/// Shares of the means at a node.
fn shares_of_ratio(index: usize) -> &'static [f32; RATIOS.len()] {
    static KNOWN: Known<[f32; RATIOS.len()]> = Known::new(RATIO_NODES);
    KNOWN.get_or_init(index, || {
        let ratio = (index as f64 / (RATIO_NODES - 1) as f64).powi(2);
        let [across, up] = MEAN_NODES;
        let views = (0..up).step_by(5).flat_map(|y| (0..across).step_by(9).map(move |x| x + across * y));
        shares_of(views.flat_map(|node| {
            let (alpha, cosine) = view_of(MEAN_NODES, node);
            let (own, means) = (beyond_round(alpha, ratio, cosine), means_of_node(node));
            [0, 1].map(|side| (own[side], means.map(|mean| f64::from(mean[side]))))
        }))
    })
}

fn as_half(value: f64) -> f32 {
    f16::from_f64(value).to_f32()
}

/// Texels for shaders, first axes first, of [`COLUMNS`] x [`ROWS`] x 8. Along the third axis: the albedos of
/// two lobes each, in three blocks of nodes over n.v; beside them, of four lobes each, their shares, and of
/// four ratios each, those of means, and then two means each.
pub(super) fn texels() -> Vec<[f32; 4]> {
    let albedos = parallel::map(0..ALBEDO_NODES.iter().product(), albedos_of_node);
    let shares = parallel::map(0..SHARE_NODES.iter().product(), shares_of_node);
    let means = parallel::map(0..MEAN_NODES.iter().product(), means_of_node);
    let ratios: Vec<_> = (0..RATIO_NODES).map(shares_of_ratio).collect();
    let two = |lobes: &[[f32; 2]]| [lobes[0][0], lobes[0][1], lobes[1][0], lobes[1][1]];
    let four = |shares: &[f32]| [shares[0], shares[1], shares[2], shares[3]];
    let texel = |z: usize, row: usize, x: usize| {
        let column = x % ALBEDO_NODES[0];
        if x < SHARES_AT {
            let block = x / ALBEDO_NODES[0];
            return two(&albedos[column + ALBEDO_NODES[0] * (row + STRIP * block)][2 * z..]);
        }
        if z >= LOBES / 4 {
            return two(&means[column + MEAN_NODES[0] * row][2 * z - LOBES / 2..]);
        }
        if column < SHARE_NODES[0] && row < SHARE_NODES[1] {
            return four(&shares[column + SHARE_NODES[0] * row][4 * z..]);
        }
        let is_ratio = 4 * z < RATIOS.len() && (RATIOS_AT..RATIOS_AT + RATIO_NODES).contains(&x);
        if is_ratio { four(&ratios[x - RATIOS_AT][4 * z..]) } else { [0.0; 4] }
    };
    (0..ROW_NODES[2])
        .flat_map(|z| (0..ROWS).flat_map(move |row| (0..COLUMNS).map(move |x| (z, row, x))))
        .map(|(z, row, x)| texel(z, row, x))
        .collect()
}

/// Visible normals of an albedo.
static DISC: LazyLock<Vec<Normals>> = LazyLock::new(|| disc(RINGS, SPOKES));

/// Normals that are worked on together, with what processors do on several numbers at a time.
const AT_ONCE: usize = 8;

/// Visible normals: points of the unit disc, the rim's y at their x, and their shares.
#[derive(Default)]
struct Normals {
    x: [f32; AT_ONCE],
    y: [f32; AT_ONCE],
    rim: [f32; AT_ONCE],
    share: [f32; AT_ONCE],
}

/// Points of the unit disc on `rings` and `spokes`, denser at the rim, where normals are at right angles to
/// the view.
fn disc(rings: u32, spokes: u32) -> Vec<Normals> {
    let mut normals = Vec::new();
    let points = gauss_legendre(rings).into_iter().flat_map(|(x, weight)| {
        let radius = (1.0 - x * x).sqrt();
        (0..spokes).map(move |k| {
            let spoke = DVec2::from_angle(TAU * (f64::from(k) + 0.5) / f64::from(spokes));
            (radius * spoke, 2.0 * weight * x / f64::from(spokes))
        })
    });
    for (k, (point, share)) in points.enumerate() {
        if k % AT_ONCE == 0 {
            normals.push(Normals::default());
        }
        let (group, lane) = (&mut normals[k / AT_ONCE], k % AT_ONCE);
        group.x[lane] = point.x as f32;
        group.y[lane] = point.y as f32;
        group.rim[lane] = (1.0 - point.x * point.x).max(0.0).sqrt() as f32;
        group.share[lane] = share as f32;
    }
    normals
}

/// What the lobe reflects of a white world, scale and bias of f0, by the normals that the viewer sees.
///
/// `view` is in axes of the tangent. The visible normals of an ellipsoid are those of a disc, half of it
/// squeezed (Heitz 2018).
pub fn albedo(view: DVec3, alpha: DVec2) -> [f64; 2] {
    albedo_by(&DISC, view, alpha)
}

fn albedo_by(disc: &[Normals], view: DVec3, alpha: DVec2) -> [f64; 2] {
    let stretched = (view * alpha.extend(1.0)).normalize();
    let level = DVec2::new(stretched.x, stretched.y);
    let first = DVec2::new(-level.y, level.x).normalize_or(DVec2::X).extend(0.0);
    let second = stretched.cross(first);
    let squeeze = f64::midpoint(1.0, stretched.z) as f32;
    // Half vectors are normals of the ellipsoid, squeezed as it was stretched.
    let [first, second, stretched] =
        [first, second, stretched].map(|axis| (axis * alpha.extend(1.0)).as_vec3());
    let (view, alpha) = (view.as_vec3(), alpha.as_vec2());
    let masking = |w: Vec3| (alpha.extend(1.0) * w).length();
    let seen = masking(view);
    let mut sums = [[0.0_f32; AT_ONCE]; 2];
    for normals in disc {
        for lane in 0..AT_ONCE {
            let (x, rim) = (normals.x[lane], normals.rim[lane]);
            let y = (1.0 - squeeze) * rim + squeeze * normals.y[lane];
            let height = (rim * rim - y * y).max(0.0).sqrt();
            let half = first * x + second * y + stretched * height;
            let half = half * (1.0 / half.length_squared().max(1e-30).sqrt());
            let towards = view.dot(half);
            let light = half * (2.0 * towards) - view;
            let above = light.z.max(0.0);
            let both = (seen * above + view.z * masking(light)).max(f32::MIN_POSITIVE);
            let share = normals.share[lane] * (seen + view.z) * above / both;
            let dark = (1.0 - towards).max(0.0);
            let fresnel = share * dark * (dark * dark) * (dark * dark);
            sums[0][lane] += share - fresnel;
            sums[1][lane] += fresnel;
        }
    }
    sums.map(|lanes| lanes.into_iter().map(f64::from).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;

    /// The most by which `found` exceeds or falls short of the integral over a finer disc, in scale, bias or
    /// their sum, over `count` lobes of alpha along the tangent and across it, n.v and azimuth.
    fn most_off(
        count: u32,
        azimuths: u32,
        found: impl Fn(DVec2, f64, DVec2) -> [f32; 2] + Sync,
    ) -> (f64, DVec2, f64, f64) {
        let fine = disc(96, 96);
        let part = |k: u32, by: f64| (0.5 + f64::from(k) * by).fract();
        (0..count)
            .into_par_iter()
            .map(|k| {
                // Roughness and anisotropy from 0 to 1, both ends among them; n.v by its root, and densely
                // about alpha; lobes of one sequence.
                let [a, b, c, d] = [
                    0.856_674_883_854_503,
                    0.733_891_856_627_126,
                    0.628_706_717_118_617,
                    0.538_597_238_616_762,
                ]
                .map(|by| part(k, by));
                let roughness = (1.02 * a - 0.01).clamp(0.0, 1.0);
                let anisotropy = (1.02 * b - 0.01).clamp(0.0, 1.0);
                let alpha = crate::pyramid::brdf::alphas(roughness, anisotropy);
                let near = if k % 3 == 0 { 4.0 * c * alpha.y } else { c * c };
                let cosine = near.clamp(LEAST_COSINE, 1.0);
                let sine = (1.0 - cosine * cosine).sqrt();
                let mut expected = [0.0; 2];
                for around in 0..azimuths {
                    let azimuth =
                        if azimuths == 1 { d } else { (f64::from(around) + 0.5) / f64::from(azimuths) };
                    let (y, x) = (FRAC_PI_2 * azimuth).sin_cos();
                    let own = albedo_by(&fine, DVec3::new(sine * x, sine * y, cosine), alpha);
                    expected.iter_mut().zip(own).for_each(|(sum, own)| *sum += own / f64::from(azimuths));
                }
                let azimuth = FRAC_PI_2 * d;
                let found = found(alpha, cosine, DVec2::from_angle(azimuth)).map(f64::from);
                let off = [0, 1].map(|k| found[k] - expected[k]);
                (off[0].abs().max(off[1].abs()).max((off[0] + off[1]).abs()), alpha, cosine, azimuth)
            })
            .reduce(|| (0.0, DVec2::ZERO, 0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a })
    }

    #[test]
    fn albedos_along_tangents_are_within_a_thousandth_of_the_integral() {
        let worst = most_off(6000, 1, albedo_along);
        assert!(worst.0 < 1e-3, "off, alphas, n.v, azimuth: {worst:?}");
    }

    #[test]
    fn mean_albedos_are_within_a_thousandth_of_the_integral() {
        let worst = most_off(300, 96, |alpha, cosine, _| mean_albedo(alpha, cosine));
        assert!(worst.0 < 1e-3, "off, alphas, n.v, azimuth: {worst:?}");
    }
}
