//! The OEM's cells: a quadtree whose nodes store their energy, its centroid and covariance on the sphere, and
//! its radius.
//!
//! The kernel's argument s = |l - R|^2/4 is linear in l, so its mean over a cell's energy is exactly
//! (|centroid - R|^2 + trace of the covariance)/4 and its variance R.covariance.R/4 (the centre of mass of
//! Barnes and Hut 1986, the clusters of Walter et al. 2005, "Lightcuts"). Energies are those above the least
//! radiance c of each channel, E - c*w, so that a constant environment is black and dark cells stay coarse.

use crate::environment::LUMINANCE;
use crate::geometry::tent::{Patch, Reconstruction, Tents};
use crate::oem::Oem;
use glam::{Vec3, Vec3Swizzles as _};
use rayon::prelude::*;

/// Four sibling cells, field by field, so that one visit evaluates all four.
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

/// Positions of the fields of [`Quad`] in `shaders/common/quad.wgsl`, in vectors of four floats.
#[cfg(feature = "gpu")]
pub(crate) const FIELDS: [(&str, usize); 9] = {
    use std::mem::offset_of;
    [
        ("FIELD_X", offset_of!(Quad, x) / 16),
        ("FIELD_Y", offset_of!(Quad, y) / 16),
        ("FIELD_Z", offset_of!(Quad, z) / 16),
        ("FIELD_COVARIANCE", offset_of!(Quad, covariance) / 16),
        ("FIELD_RADIUS", offset_of!(Quad, radius) / 16),
        ("FIELD_LUMINANCE", offset_of!(Quad, luminance) / 16),
        ("FIELD_RED", offset_of!(Quad, red) / 16),
        ("FIELD_GREEN", offset_of!(Quad, green) / 16),
        ("FIELD_BLUE", offset_of!(Quad, blue) / 16),
    ]
};

/// A smaller share of a texel's energy above the least radiance is rounding error. Without the cut, black
/// texels would enlarge the radius of their cells.
pub(crate) const RESIDUE: f32 = 1.0 / (1 << 21) as f32;

/// A channel's energy up to this counts as zero. Its product with a difference of directions, 2^-24, would be
/// subnormal, which GPUs flush, and the reciprocal of a subnormal luminance infinite. [`omitted_radiance`]
/// bounds the effect on an answer.
pub(crate) const FAINT: f32 = 1.0 / (1_u128 << 94) as f32;

/// Bound of the radiance that energies up to [`FAINT`] in the texels of an OEM of `inner` texels add to an
/// answer, for any lobe.
///
/// Energies e add the sum of e Kbar_t/W, with Kbar_t the kernel's mean over texel t in (u, v), whose area is
/// (2/n)^2. The sum of Kbar_t times that area is the kernel's integral over the square, which is at most W:
/// no solid angle is smaller than its area in (u, v).
pub(crate) fn omitted_radiance(inner: u32) -> f64 {
    f64::from(FAINT) * f64::from(inner).powi(2) / 4.0
}

/// One cell while the tree is built.
#[derive(Clone, Copy, Default)]
struct Cell {
    patch: Patch,
    energy: Vec3,
    luminance: f32,
}

/// One level of quads: the quad of cell (i, j) of the level above is at `first` + j * `width` + i.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellLevel {
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
    /// Levels from the finest (texels, or blocks of them) to the root, whose quad is the last.
    pub(super) levels: Vec<CellLevel>,
    pub(super) reconstruction: Reconstruction,
    /// Texels along an edge of a finest cell: 1 if the tree reaches texels.
    pub(super) block: u32,
    /// The texels' energies above the least radiance, for subdivision of texels; empty if the tree stops
    /// above texels.
    pub(super) energies: Vec<[f32; 3]>,
}

impl Cells {
    /// Builds the cells of `oem`, down to blocks of `block` x `block` texels: 1 for all queries, more if all
    /// lobes will be much wider than a block.
    ///
    /// # Panics
    /// If `block` is zero.
    #[must_use]
    pub fn new(oem: &Oem, block: u32, reconstruction: Reconstruction) -> Self {
        assert!(block > 0, "blocks of at least one texel");
        let n = oem.size().inner;
        let least = oem.least_radiance();
        let totals = oem.totals();
        let mean_luminance =
            (0..3).map(|c| f64::from(LUMINANCE[c]) * totals[c]).sum::<f64>() / (4.0 * std::f64::consts::PI);
        let tents = Tents::new(n, reconstruction);
        let texel = |x: u32, y: u32| {
            let [r, g, b, w] = oem.texel(x, y);
            let all = Vec3::new(r, g, b);
            let above = all - Vec3::from(least) * w;
            let energy =
                Vec3::select(above.cmpgt((all * RESIDUE).max(Vec3::splat(FAINT))), above, Vec3::ZERO);
            Cell { patch: tents.at(x, y), energy, luminance: energy.dot(Vec3::from(LUMINANCE)) }
        };

        let mut width = n.div_ceil(block);
        let mut cells = vec![Cell::default(); width as usize * width as usize];
        cells.par_chunks_mut(width as usize).zip(0..width).for_each(|(row, j)| {
            let range = |k: u32| k * block..((k + 1) * block).min(n);
            let mut members = Vec::with_capacity((block * block) as usize);
            for (cell, i) in row.iter_mut().zip(0..width) {
                members.clear();
                for y in range(j) {
                    members.extend(range(i).map(|x| texel(x, y)));
                }
                *cell = merge(&members);
            }
        });
        let energies =
            if block == 1 { cells.iter().map(|cell| cell.energy.to_array()).collect() } else { Vec::new() };

        let (mut quads, mut levels) = (Vec::new(), Vec::new());
        loop {
            let above = width.div_ceil(2);
            let first = quads.len();
            levels.push(CellLevel {
                first: u32::try_from(first).expect("fewer than 2^32 cells"),
                width: above,
            });
            quads.resize(first + above as usize * above as usize, Quad::default());
            let mut parents = vec![Cell::default(); above as usize * above as usize];
            let rows =
                quads[first..].par_chunks_mut(above as usize).zip(parents.par_chunks_mut(above as usize));
            rows.zip(0..above).for_each(|((quads, parents), j)| {
                for ((quad, parent), i) in quads.iter_mut().zip(parents).zip(0..above) {
                    let siblings = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(di, dj)| {
                        let (i, j) = (2 * i + di, 2 * j + dj);
                        let inside = i < width && j < width;
                        if inside { cells[(j * width + i) as usize] } else { Cell::default() }
                    });
                    *quad = Quad::of(&siblings);
                    *parent = merge(&siblings);
                }
            });
            cells = parents;
            width = above;
            if width == 1 {
                break;
            }
        }
        Self { n, least, mean_luminance, quads, levels, reconstruction, block, energies }
    }

    /// The least radiance of each channel.
    #[cfg(feature = "gpu")]
    #[must_use]
    pub const fn least(&self) -> [f32; 3] {
        self.least
    }

    /// Sibling cells in the layout of `shaders/common/quad.wgsl`: fourteen fields of four, and one of
    /// padding.
    #[cfg(feature = "gpu")]
    #[must_use]
    pub fn quad_fields(&self) -> Vec<[[f32; 4]; 15]> {
        let fields = |quad: &Quad| {
            let Quad { x, y, z, covariance: [xx, yy, zz, yz, zx, xy], radius, luminance, red, green, blue } =
                *quad;
            [x, y, z, xx, yy, zz, yz, zx, xy, radius, luminance, red, green, blue, [0.0; 4]]
        };
        self.quads.iter().map(fields).collect()
    }
}

/// Merges cells, centred by luminance; cells without energy contribute nothing.
fn merge(members: &[Cell]) -> Cell {
    if let [only] = members {
        return *only;
    }
    let members = || members.iter().filter(|member| member.luminance > 0.0);
    let mut union = Cell::default();
    let mut offset = Vec3::ZERO;
    for member in members() {
        if union.luminance == 0.0 {
            union.patch.centroid = member.patch.centroid;
        }
        union.luminance += member.luminance;
        union.energy += member.energy;
        // Sum differences, which float32 resolves.
        offset += (member.patch.centroid - union.patch.centroid) * member.luminance;
    }
    if union.luminance == 0.0 {
        return union;
    }
    let share = 1.0 / union.luminance;
    union.patch.centroid += offset * share;
    for member in members() {
        let apart = member.patch.centroid - union.patch.centroid;
        let share = member.luminance * share;
        union.patch.diagonal += (member.patch.diagonal + apart * apart) * share;
        union.patch.mixed += (member.patch.mixed + apart.yzx() * apart.zxy()) * share;
        union.patch.radius = union.patch.radius.max((apart.length() + member.patch.radius) * (1.0 + 1e-6));
    }
    union
}

impl Quad {
    fn of(siblings: &[Cell; 4]) -> Self {
        let field = |get: fn(&Cell) -> f32| siblings.each_ref().map(get);
        Self {
            x: field(|cell| cell.patch.centroid.x),
            y: field(|cell| cell.patch.centroid.y),
            z: field(|cell| cell.patch.centroid.z),
            covariance: [
                field(|cell| cell.patch.diagonal.x),
                field(|cell| cell.patch.diagonal.y),
                field(|cell| cell.patch.diagonal.z),
                field(|cell| cell.patch.mixed.x),
                field(|cell| cell.patch.mixed.y),
                field(|cell| cell.patch.mixed.z),
            ],
            radius: field(|cell| cell.patch.radius),
            luminance: field(|cell| cell.luminance),
            red: field(|cell| cell.energy.x),
            green: field(|cell| cell.energy.y),
            blue: field(|cell| cell.energy.z),
        }
    }
}
