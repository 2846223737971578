//! The OEM's cells: a quadtree whose nodes know their energy, its centroid and covariance on the sphere, and its reach.
//!
//! The kernel's argument s = |l - R|^2/4 is linear in l, so its mean over a cell's energy is exactly (|centroid - R|^2
//! + trace of the covariance)/4 and its variance R.covariance.R/4 (the centre of mass of Barnes and Hut 1986, the
//! clusters of Walter et al. 2005, "Lightcuts"). Energies are those above the least radiance c of each channel,
//! E - c*w, so that a constant environment is black and dark cells stay coarse.

use super::tent::{Moments, Reconstruction, Tents};
use crate::environment::LUMINANCE;
use crate::oem::Oem;
use rayon::prelude::*;

/// Four sibling cells, field by field, so that one visit judges all four at once.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(super) struct Quad {
    pub(super) x: [f32; 4],
    pub(super) y: [f32; 4],
    pub(super) z: [f32; 4],
    /// Covariance of the directions: xx, yy, zz, yz, zx, xy.
    pub(super) covariance: [[f32; 4]; 6],
    /// Greatest distance from the centroid.
    pub(super) radius: [f32; 4],
    /// Luminance of the energy.
    pub(super) luminance: [f32; 4],
    pub(super) red: [f32; 4],
    pub(super) green: [f32; 4],
    pub(super) blue: [f32; 4],
}

/// One cell while the tree is built.
#[derive(Clone, Copy, Default)]
struct Cell {
    moments: Moments,
    energy: [f32; 3],
    weight: f64,
}

/// One level of quads: those of cell (i, j) of the level above at `first` + j * `width` + i.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    pub(super) first: u32,
    pub(super) width: u32,
}

/// The quadtree over an OEM's square.
#[derive(Debug)]
pub struct Cells {
    /// Texels along an edge of the square.
    pub(super) n: u32,
    /// The least radiance of each channel.
    pub(super) least: [f32; 3],
    /// Mean luminance over the sphere.
    pub(super) mean_luminance: f64,
    pub(super) quads: Vec<Quad>,
    /// From the finest (texels, or blocks of them) to the root, whose quad is the last.
    pub(super) levels: Vec<Level>,
    pub(super) reconstruction: Reconstruction,
    /// Texels along an edge of a finest cell: 1 where the tree goes down to texels.
    pub(super) block: u32,
    /// The texels' energies above the least radiance, for what goes below texels; empty where the tree stops above.
    pub(super) energies: Vec<[f32; 3]>,
}

impl Cells {
    /// The cells of `oem`, down to blocks of `block` x `block` texels (1 for all queries; coarser where only lobes
    /// much wider than a block will be asked for).
    ///
    /// # Panics
    /// Where `block` is zero.
    #[must_use]
    pub fn new(oem: &Oem, block: u32, reconstruction: Reconstruction) -> Self {
        assert!(block > 0, "blocks of at least one texel");
        let n = oem.size().inner;
        let least = least_radiance(oem);
        let totals = oem.totals();
        let mean_luminance =
            (0..3).map(|c| f64::from(LUMINANCE[c]) * totals[c]).sum::<f64>() / (4.0 * std::f64::consts::PI);
        let tents = Tents::new(n, reconstruction);
        let above_least = |x: u32, y: u32| -> [f32; 3] {
            let texel = oem.texel(x, y);
            std::array::from_fn(|c| (texel[c] - least[c] * texel[3]).max(0.0))
        };

        let mut width = n.div_ceil(block);
        let mut cells: Vec<Cell> = (0..width)
            .into_par_iter()
            .flat_map_iter(|j| {
                let (tents, above_least) = (&tents, &above_least);
                (0..width).map(move |i| {
                    let texel = |x: u32, y: u32| {
                        let energy = above_least(x, y);
                        Cell { moments: tents.at(x, y), energy, weight: weight(energy) }
                    };
                    if block == 1 {
                        return texel(i, j);
                    }
                    let range = |k: u32| k * block..((k + 1) * block).min(n);
                    let members: Vec<Cell> =
                        range(j).flat_map(|y| range(i).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect();
                    merge(&members)
                })
            })
            .collect();
        let energies = if block == 1 { cells.iter().map(|cell| cell.energy).collect() } else { Vec::new() };

        let (mut quads, mut levels) = (Vec::new(), Vec::new());
        loop {
            let above = width.div_ceil(2);
            levels.push(Level { first: u32::try_from(quads.len()).expect("fewer than 2^32 cells"), width: above });
            let (level, parents): (Vec<Quad>, Vec<Cell>) = (0..above * above)
                .into_par_iter()
                .map(|k| {
                    let (i, j) = (k % above, k / above);
                    let siblings = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(di, dj)| {
                        let (i, j) = (2 * i + di, 2 * j + dj);
                        let inside = i < width && j < width;
                        if inside { cells[(j * width + i) as usize] } else { Cell::default() }
                    });
                    (quad(&siblings), merge(&siblings))
                })
                .unzip();
            quads.extend(level);
            cells = parents;
            width = above;
            if width == 1 {
                break;
            }
        }
        Self { n, least, mean_luminance, quads, levels, reconstruction, block, energies }
    }
}

/// The least radiance of each channel over the square.
fn least_radiance(oem: &Oem) -> [f32; 3] {
    let mut least = [f32::INFINITY; 3];
    for [r, g, b, w] in (0..oem.size().inner).flat_map(|y| oem.row(y)) {
        for (least, energy) in least.iter_mut().zip([r, g, b]) {
            *least = least.min(energy / w);
        }
    }
    least
}

fn weight(energy: [f32; 3]) -> f64 {
    (0..3).map(|c| f64::from(LUMINANCE[c]) * f64::from(energy[c])).sum()
}

/// The union of cells, centred by luminance; cells without energy do not count.
fn merge(members: &[Cell]) -> Cell {
    let mut union = Cell::default();
    for member in members {
        union.weight += member.weight;
        union.moments.centroid += member.moments.centroid * member.weight;
        for (sum, energy) in union.energy.iter_mut().zip(member.energy) {
            *sum += energy;
        }
    }
    if union.weight > 0.0 {
        union.moments.centroid /= union.weight;
        for member in members.iter().filter(|member| member.weight > 0.0) {
            union.moments.add_spread(&member.moments, member.weight / union.weight);
            let apart = member.moments.centroid.distance(union.moments.centroid);
            union.moments.radius = union.moments.radius.max(apart + member.moments.radius);
        }
    }
    union
}

fn quad(siblings: &[Cell; 4]) -> Quad {
    let field = |get: fn(&Cell) -> f64| std::array::from_fn(|k| get(&siblings[k]) as f32);
    // Rounded up where the bound relies on it.
    let upward = |get: fn(&Cell) -> f64| std::array::from_fn(|k| (get(&siblings[k]) * (1.0 + 1e-6)) as f32);
    Quad {
        x: field(|cell| cell.moments.centroid.x),
        y: field(|cell| cell.moments.centroid.y),
        z: field(|cell| cell.moments.centroid.z),
        covariance: [
            field(|cell| cell.moments.diagonal.x),
            field(|cell| cell.moments.diagonal.y),
            field(|cell| cell.moments.diagonal.z),
            field(|cell| cell.moments.mixed.x),
            field(|cell| cell.moments.mixed.y),
            field(|cell| cell.moments.mixed.z),
        ],
        radius: upward(|cell| cell.moments.radius),
        luminance: upward(|cell| cell.weight),
        red: std::array::from_fn(|k| siblings[k].energy[0]),
        green: std::array::from_fn(|k| siblings[k].energy[1]),
        blue: std::array::from_fn(|k| siblings[k].energy[2]),
    }
}
