//! Packets of directions, and the leaves of a cut that they share.

use crate::common::vector::Extremes as _;
use crate::cpu::cells::Quad;
use crate::cpu::cells::{Cells, QUAD_FIELDS};
use crate::geometry::source_texels::Piece;
use crate::geometry::tent::Patch;
use crate::geometry::tint::Tint;
use crate::geometry::tint::VARIATION;
use crate::light::environment::{LUMINANCE, Rgb};
use glam::{DVec3, Vec3};

/// Directions evaluated together.
pub const LANES: usize = 16;

/// Leaves for several packets are made for the directions within this share of their radius. For the quarter
/// of them that lies beyond, leaves may err by more than the tolerance. Measured at roughness .1: errors are
/// no more than with a cut for each packet, in .9 of the time.
const MOST: f32 = 0.75;

/// Up to [`LANES`] adjacent directions, in the space of the cells.
#[derive(Clone, Copy, Debug)]
pub struct Packet {
    pub(super) axis: DVec3,
    /// Greatest distance from the axis of a direction of any packet that shares the cut.
    pub(super) radius: f32,
    /// The distance up to which leaves are made to be within the tolerance.
    pub(super) judged: f32,
    /// The greatest reach of a footprint around its direction, and the greatest trace of its covariance; 0
    /// for directions alone.
    pub(super) reach: f32,
    pub(super) trace: f32,
    /// Directions minus the axis: differences keep the precision that sharp lobes need.
    pub(super) x: [f32; LANES],
    pub(super) y: [f32; LANES],
    pub(super) z: [f32; LANES],
}

impl Packet {
    /// A packet of 1 to [`LANES`] unit `directions`; padding lanes repeat the first.
    ///
    /// # Panics
    /// If there are no directions or more than [`LANES`].
    pub fn new(directions: &[DVec3]) -> Self {
        assert!((1..=LANES).contains(&directions.len()), "1 to {LANES} directions");
        Self::sharing_a_cut(directions).next().expect("a direction")
    }

    /// Packets of all of `directions`, in their order, with one axis and radius, so that leaves of the first
    /// serve every other.
    pub(super) fn sharing_a_cut(directions: &[DVec3]) -> impl Iterator<Item = Self> {
        let axis = match directions {
            [] => DVec3::ZERO,
            [only] => *only,
            [first, ..] => directions.iter().sum::<DVec3>().try_normalize().unwrap_or(*first),
        };
        let radius = directions.iter().map(|d| d.distance(axis)).fold(0.0, f64::max);
        let radius = (radius * (1.0 + 1e-6)) as f32;
        let judged = if directions.len() > LANES { MOST * radius } else { radius };
        directions.chunks(LANES).map(move |own| {
            let offset = |k: usize| own[if k < own.len() { k } else { 0 }] - axis;
            Self {
                axis,
                radius,
                judged,
                reach: 0.0,
                trace: 0.0,
                x: std::array::from_fn(|k| offset(k).x as f32),
                y: std::array::from_fn(|k| offset(k).y as f32),
                z: std::array::from_fn(|k| offset(k).z as f32),
            }
        })
    }
}

/// The energy whose error counts: that of the channel with the most, times its weight
/// ([`super::cells::Cells::channel_weights`]). The luminance is a mean of these, to a hundredth.
#[inline(always)]
pub(super) fn weighted([red, green, blue]: Rgb, weights: [f32; 3]) -> f32 {
    (weights[0] * red).at_least(weights[1] * green).at_least(weights[2] * blue)
}

/// One leaf of a cut, relative to the packet's axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf {
    pub(super) offset: [f32; 3],
    /// xx, yy, zz, yz, zx, xy.
    pub(super) covariance: [f32; 6],
    pub(super) radius: f32,
    pub(super) energy: Rgb,
    /// The cell, four times its quad plus its place, whose tints count; [`UNTINTED`] for light of one colour.
    pub(super) cell: u32,
}

/// [`Leaf::cell`] of light of one colour.
pub(super) const UNTINTED: u32 = u32::MAX;

/// A tint with a smaller share of its channel's energy is rounding error.
pub(crate) const NEGLIGIBLE_TINT: f32 = 1.0 / (1 << 20) as f32;

impl Leaf {
    /// Cell `k` of `quad`, which is number `index`.
    #[inline(always)]
    pub(super) fn new(quad: &Quad, index: u32, k: usize, axis: DVec3) -> Self {
        let tinted = (quad.red_tint[VARIATION][k] > NEGLIGIBLE_TINT * quad.red[k])
            | (quad.blue_tint[VARIATION][k] > NEGLIGIBLE_TINT * quad.blue[k]);
        Self {
            offset: [
                (f64::from(quad.x[k]) - axis.x) as f32,
                (f64::from(quad.y[k]) - axis.y) as f32,
                (f64::from(quad.z[k]) - axis.z) as f32,
            ],
            covariance: std::array::from_fn(|c| quad.covariance[c][k]),
            radius: quad.radius[k],
            energy: [quad.red[k], quad.green[k], quad.blue[k]],
            cell: if tinted { 4 * index + k as u32 } else { UNTINTED },
        }
    }

    /// Energy with the moments `patch`, whose centroid is at `offset` from the packet's axis.
    pub(super) fn of_patch(patch: &Patch, offset: Vec3, energy: Rgb) -> Self {
        let Patch { diagonal, mixed, radius, .. } = *patch;
        Self {
            offset: offset.to_array(),
            covariance: [diagonal.x, diagonal.y, diagonal.z, mixed.x, mixed.y, mixed.z],
            radius,
            energy,
            cell: UNTINTED,
        }
    }
}

/// Buffers of an evaluation, kept between packets.
#[derive(Debug, Default)]
pub struct Scratch {
    pub(super) leaves: Vec<Leaf>,
    /// Certified widths, times the energy of each channel, of pieces without an exact centroid.
    pub(super) slack: [f64; 3],
    pub(super) stack: Vec<Visit>,
    /// What a cut for footprints leaves to their directions.
    pub(super) frontier: Vec<Visit>,
    /// Finest cells to be divided into texels of the source, and the pieces of these that are left.
    pub(super) refined: Vec<(u32, u32)>,
    pub(super) pieces: Vec<LitPiece>,
}

/// A quad to visit: that of the cell in column `i` of row `j` of the level above.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Visit {
    pub(super) level: u8,
    /// A bit for each of its cells that counts.
    pub(super) cells: u8,
    pub(super) i: u32,
    pub(super) j: u32,
}

/// A piece of a texel of the source.
#[derive(Clone, Copy, Debug)]
pub(super) struct LitPiece {
    pub(super) column: u32,
    pub(super) row: u32,
    pub(super) piece: Piece,
    /// Radiance above the least.
    pub(super) above: Vec3,
    /// What of it counts.
    pub(super) weight: f32,
}

/// [`Visit::cells`] of all four.
pub(super) const ALL: u8 = 0b1111;

impl Scratch {
    /// The leaves of the last evaluation, of `packet` over `cells`, as fields of `shaders/common/quad.wgsl`,
    /// to replay the cut.
    pub fn leaf_fields(&self, cells: &Cells, packet: &Packet) -> Vec<[f32; QUAD_FIELDS]> {
        let fields = |leaf: &Leaf| {
            let mut fields = [0.0; QUAD_FIELDS];
            let centroid = (packet.axis + Vec3::from(leaf.offset).as_dvec3()).as_vec3();
            let luminance = Vec3::from(leaf.energy).dot(Vec3::from(LUMINANCE));
            fields[..3].copy_from_slice(&centroid.to_array());
            fields[3..9].copy_from_slice(&leaf.covariance);
            fields[9..11].copy_from_slice(&[leaf.radius, luminance]);
            fields[11..14].copy_from_slice(&leaf.energy);
            if let Some(tints) = cells.tints(leaf.cell) {
                fields[14..].copy_from_slice(tints.map(Tint::to_fields).as_flattened());
            }
            fields
        };
        self.leaves.iter().map(fields).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_that_share_a_cut_hold_all_directions_around_one_axis() {
        let place = |k: u32| 0.01 * f64::from(k);
        let directions: Vec<DVec3> =
            (0..37).map(|k| DVec3::new(place(k % 7), 1.0, place(k / 7)).normalize()).collect();
        let packets: Vec<Packet> = Packet::sharing_a_cut(&directions).collect();
        assert_eq!(packets.len(), 3);
        for (packet, own) in packets.iter().zip(directions.chunks(LANES)) {
            assert_eq!((packet.axis, packet.radius), (packets[0].axis, packets[0].radius));
            assert_eq!(packet.judged, MOST * packet.radius);
            for k in 0..LANES {
                let offset = DVec3::new(packet.x[k].into(), packet.y[k].into(), packet.z[k].into());
                let direction = own.get(k).unwrap_or(&own[0]);
                assert!((packet.axis + offset).distance(*direction) < 1e-8, "lane {k}");
                assert!(offset.length() <= f64::from(packet.radius), "lane {k}");
            }
        }
        let one = Packet::new(&directions[..LANES]);
        assert!(one.radius > 0.0 && one.judged == one.radius);
    }
}
