//! What isotropic surfaces reflect of a white world, in a table of its own.
//!
//! Where n.v nears alpha, grazing views see a dip that is as narrow as alpha: over a grid of roughness and
//! n.v it runs along a diagonal that nodes cannot follow. The table has the albedo over that dip's closed
//! form, and is smooth.

use crate::common::once::Once;
use crate::common::parallel;
use crate::lobe::reflectance;
use crate::sphere::quadrature::gauss_legendre;
use half::f16;
use std::sync::LazyLock;

/// Nodes over roughness, evenly in log(1 + 30 r), and over n.v, evenly in its fourth root.
pub const NODES: [usize; 2] = [91, 75];

/// n.v of the first nodes, below which the albedo stays.
pub const LEAST_COSINE: f64 = 1e-4;

/// How much denser nodes are at roughness 0 than at 1, less 1.
const CROWDING: f64 = 30.0;

/// The dip, as a share of the albedo: d0 t / (1 + d1 t + d2 t^2 + d3 t^3), t = n.v over alpha.
const DIP: [f32; 4] = [0.222, 0.634, 0.098, 0.3126];

/// Least alpha of the dip.
const LEAST_ALPHA: f32 = 1e-6;

/// Quadrature nodes for views below [`GRAZING`], where those of [`reflectance::ggx_albedo`] are off by up to
/// 3e-4.
const GRAZING_NODES: u32 = 64;
const GRAZING: f64 = 0.02;

/// Scale and bias of f0 over what [`dip`] leaves, at the nodes: those of the least n.v first.
fn table() -> &'static [[f32; 2]] {
    static TABLE: Once<Vec<[f32; 2]>> = Once::new();
    TABLE.get_or_make(|| {
        let [across, up] = NODES;
        parallel::map(0..across * up, |k| {
            let (roughness, cosine) = (roughness_of(k % across), cosine_of(k / across));
            let left = f64::from(left_by_dip(cosine as f32, roughness as f32));
            integral(cosine, roughness).map(|share| f16::from_f64(share / left).to_f32())
        })
    })
}

fn integral(cosine: f64, roughness: f64) -> [f64; 2] {
    static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(GRAZING_NODES));
    if cosine < GRAZING {
        return reflectance::ggx(cosine, roughness, &RULE);
    }
    reflectance::ggx_albedo(cosine, roughness)
}

/// Roughness of a node.
fn roughness_of(node: usize) -> f64 {
    (((1.0 + CROWDING).ln() * node as f64 / (NODES[0] - 1) as f64).exp() - 1.0) / CROWDING
}

/// n.v of a node.
fn cosine_of(node: usize) -> f64 {
    let least = LEAST_COSINE.powf(0.25);
    (least + (1.0 - least) * node as f64 / (NODES[1] - 1) as f64).powi(4)
}

/// What the dip leaves of the albedo.
fn left_by_dip(cosine: f32, roughness: f32) -> f32 {
    let t = cosine / (roughness * roughness).max(LEAST_ALPHA);
    1.0 - DIP[0] * t / (1.0 + t * (DIP[1] + t * (DIP[2] + t * DIP[3])))
}

/// The table as shaders read it: a node and its neighbour of greater roughness in each texel.
#[must_use]
pub fn texels() -> Vec<[f32; 4]> {
    let table = table();
    let node = |k: usize| table[k];
    (0..table.len())
        .map(|k| {
            let ([a, b], [c, d]) = (node(k), node((k + 1).min(table.len() - 1)));
            [a, b, c, d]
        })
        .collect()
}

/// Scale and bias of f0 at `roughness` in [0, 1] and n.v of `cosine` in (0, 1].
#[must_use]
pub fn albedo_at(roughness: f32, cosine: f32) -> [f32; 2] {
    let seen = cosine.clamp(LEAST_COSINE as f32, 1.0);
    let crowding = CROWDING as f32;
    let places =
        [(1.0 + crowding * roughness).log2() / (1.0 + crowding).log2(), (seen.sqrt().sqrt() - 0.1) / 0.9];
    let [(x, right), (y, up)] = [0, 1].map(|axis| {
        let place = places[axis].clamp(0.0, 1.0) * (NODES[axis] - 1) as f32;
        let node = (place as usize).min(NODES[axis] - 2);
        (node, place - node as f32)
    });
    let mix = |a: f32, b: f32, share: f32| a + share * (b - a);
    let left = left_by_dip(seen, roughness);
    let table = table();
    [0, 1].map(|side| {
        let row = |y: usize| {
            let first = x + NODES[0] * y;
            mix(table[first][side], table[first + 1][side], right)
        };
        left * mix(row(y), row(y + 1), up)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;

    #[test]
    fn albedos_are_within_a_thousandth_of_the_integral() {
        let rule = gauss_legendre(80);
        // Places that are no nodes, dense at both ends of both axes.
        let evenly = |many: u32| (0..many).map(move |k| (f64::from(k) + 0.5) / f64::from(many));
        let cosines = evenly(41).map(|t| LEAST_COSINE.powf(1.0 - t)).chain(evenly(31)).chain([1e-4, 1.0]);
        let cosines: Vec<f64> = cosines.collect();
        let roughness: Vec<f64> =
            evenly(37).map(|t| t * t).chain(evenly(33)).chain([0.0, 1e-4, 1e-3, 1.0]).collect();
        let worst = roughness
            .par_iter()
            .flat_map_iter(|roughness| cosines.iter().map(move |cosine| (*roughness, *cosine)))
            .map(|(roughness, cosine)| {
                let expected = reflectance::ggx(cosine, roughness, &rule);
                let found = albedo_at(roughness as f32, cosine as f32).map(f64::from);
                let off = [0, 1].map(|k| found[k] - expected[k]);
                let most = off[0].abs().max(off[1].abs()).max((off[0] + off[1]).abs());
                (most, roughness, cosine)
            })
            .reduce(|| (0.0, 0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
        assert!(worst.0 < 7e-4, "off, roughness, n.v: {worst:?}");
    }

    #[test]
    fn more_nodes_do_not_change_the_integral() {
        let rule = gauss_legendre(2 * GRAZING_NODES);
        for (x, y) in (0..NODES[0]).step_by(6).flat_map(|x| (0..NODES[1]).step_by(4).map(move |y| (x, y))) {
            let (roughness, cosine) = (roughness_of(x), cosine_of(y));
            let [found, expected] = [integral(cosine, roughness), reflectance::ggx(cosine, roughness, &rule)];
            let off = (0..2).map(|k| (found[k] - expected[k]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-4, "roughness {roughness}, n.v {cosine}: off by {off}");
        }
    }
}
