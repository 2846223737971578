//! The texels of a source: solid angles, first and second moments, and the pieces that they are made of.
//!
//! A layout repeats itself: the texels of a panorama's row differ by a turn about y, a cube's faces by a turn
//! of the cube. What is worked out once is a *block*; a *frame* carries a source direction into the block's
//! own space.

pub mod patch;

use crate::light::environment::Layout;
use crate::sphere::{cube, octahedral};
use glam::{DMat3, DVec2, DVec3};
use patch::{Accuracy, Band, Flat, Patch, Plane, Sample};
use std::f64::consts::{PI, TAU};

/// Outline of a texel, in its own space.
#[derive(Clone, Copy, Debug)]
pub struct Texel {
    /// Exact solid angle.
    pub solid_angle: f64,
    /// Mean direction, shorter than 1.
    pub mean: DVec3,
    /// Covariance of the direction.
    pub covariance: DMat3,
    /// Centre of a cap that holds it.
    pub centre: DVec3,
    /// The chord.
    pub radius: f64,
}

impl Texel {
    /// Mean of l l^T.
    pub fn second_moment(&self) -> DMat3 {
        self.covariance + outer(self.mean)
    }
}

/// v v^T.
pub fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// All texels of a layout.
#[derive(Debug)]
pub struct ExactTexels {
    layout: Layout,
    blocks: Vec<Texel>,
    frames: Vec<DMat3>,
}

/// The plane of the canonical cube face: (s, t, 1).
const CUBE_PLANE: Plane = Plane { origin: DVec3::Z, along_u: DVec3::X, along_v: DVec3::Y };

impl ExactTexels {
    /// Works out the distinct texels of `layout`.
    pub fn new(layout: Layout) -> Self {
        let (block_count, frames) = match layout {
            Layout::Panorama { width, height } => {
                let frames = (0..width)
                    .map(|i| DMat3::from_rotation_y((f64::from(i) + 0.5) / f64::from(width) * TAU - PI));
                (height as usize, frames.collect())
            }
            Layout::Cube { size } => {
                let frames = cube::Face::ALL.map(|face| {
                    let centre = cube::cube_point(face, 0.0, 0.0);
                    let (s, t) = (cube::cube_point(face, 1.0, 0.0), cube::cube_point(face, 0.0, 1.0));
                    DMat3::from_cols(s - centre, t - centre, centre).transpose()
                });
                (size as usize * size as usize, frames.to_vec())
            }
            Layout::Octahedral { size } => (size as usize * size as usize, vec![DMat3::IDENTITY]),
        };
        let mut texels = Self { layout, blocks: Vec::new(), frames };
        texels.blocks = (0..block_count).map(|block| texels.work_out(block)).collect();
        texels
    }

    /// The distinct texels.
    pub fn blocks(&self) -> &[Texel] {
        &self.blocks
    }

    /// Rotations (or reflections) from the source's space into the blocks' own.
    pub fn frames(&self) -> &[DMat3] {
        &self.frames
    }

    /// Calls `visit` with the index of every texel, its block and its frame.
    pub fn for_each(&self, mut visit: impl FnMut(usize, usize, usize)) {
        let (blocks, frames) = (self.blocks.len(), self.frames.len());
        if let Layout::Panorama { .. } = self.layout {
            for block in 0..blocks {
                for frame in 0..frames {
                    visit(block * frames + frame, block, frame);
                }
            }
        } else {
            for frame in 0..frames {
                for block in 0..blocks {
                    visit(frame * blocks + block, block, frame);
                }
            }
        }
    }

    /// Calls `visit` with directions and weights over a block, in its own space: a quadrature that integrates
    /// polynomials of the direction to rounding; weights sum to the solid angle.
    pub fn for_each_sample(&self, block: usize, visit: &mut impl FnMut(DVec3, f64)) {
        let accuracy = Accuracy::new(1e-15);
        match self.layout {
            Layout::Panorama { width, height } => {
                sample(&panorama_texel(width, height, block), &accuracy, visit);
            }
            Layout::Cube { size } => sample(&cube_texel(size, block), &accuracy, visit),
            Layout::Octahedral { size } => {
                for_each_octahedral_piece(size, block, |piece| sample(&piece, &accuracy, visit));
            }
        }
    }

    fn work_out(&self, block: usize) -> Texel {
        let (mut area, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        self.for_each_sample(block, &mut |direction, weight| {
            area += weight;
            first += direction * weight;
            second += outer(direction) * weight;
        });
        let (size, (centre, radius)) = match self.layout {
            Layout::Panorama { width, height } => (1, panorama_texel(width, height, block).cap()),
            Layout::Cube { size } => (size, cube_texel(size, block).cap()),
            Layout::Octahedral { size } => {
                let (x, y) = (block as u32 % size, block as u32 / size);
                let centre = octahedral::direction_from_oct(octahedral::texel_centre(size, x, y));
                let mut radius: f64 = 0.0;
                for_each_octahedral_piece(size, block, |piece| {
                    let (middle, spread) = piece.cap();
                    radius = radius.max(middle.distance(centre) + spread).min(2.0);
                });
                (size, (centre, radius))
            }
        };
        let solid_angle = self.layout.texel_solid_angle(block as u32 % size, block as u32 / size);
        let mean = first / area;
        let covariance = second * (1.0 / area) - outer(mean);
        Texel { solid_angle, mean, covariance, centre, radius }
    }
}

/// To rounding: the integrands' poles lie where |point| = 0, half a unit or more away.
fn sample<P: Patch>(patch: &P, accuracy: &Accuracy, visit: &mut impl FnMut(DVec3, f64)) {
    match accuracy.rule(patch.cap().1 / 0.5) {
        Some(rule) => {
            patch.sample(rule, &mut |s: Sample| visit(s.point / s.length_squared.sqrt(), s.weight));
        }
        None => {
            for quarter in patch.split() {
                sample(&quarter, accuracy, visit);
            }
        }
    }
}

/// The piece that is row `row` around longitude 0.
pub fn panorama_texel(width: u32, height: u32, row: usize) -> Band {
    let half = PI / f64::from(width);
    let edge = |k: usize| k as f64 / f64::from(height) * PI;
    Band::new([-half, half], [edge(row), edge(row + 1)])
}

/// The piece that is texel `block` of the canonical face.
pub fn cube_texel(size: u32, block: usize) -> Flat {
    let edge = |k: usize| 2.0 * k as f64 / f64::from(size) - 1.0;
    let (i, j) = (block % size as usize, block / size as usize);
    Flat::rectangle(CUBE_PLANE, DVec2::new(edge(i), edge(j)), DVec2::new(edge(i + 1), edge(j + 1)))
}

/// Calls `visit` with the pieces of texel `block` of an octahedral square.
pub fn for_each_octahedral_piece(size: u32, block: usize, mut visit: impl FnMut(Flat)) {
    let (x, y) = (block % size as usize, block / size as usize);
    for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        for_each_flat_of_quadrant(size, 2 * x + i, 2 * y + j, &mut visit);
    }
}

/// The flat pieces of quadrant (`i`, `j`) of an octahedral square of `size` x `size` texels, its half-texels
/// counted from 0 to 2 `size`: one, or two where the fold runs through it from corner to corner.
pub fn for_each_flat_of_quadrant(size: u32, i: usize, j: usize, visit: &mut impl FnMut(Flat)) {
    let n = size as usize;
    // Half-texels from the axis to the nearer and the farther edge, and on which side.
    let span = |k: usize| if k >= n { (k - n, 1.0) } else { (n - 1 - k, -1.0) };
    let ((a, sign_u), (b, sign_v)) = (span(i), span(j));
    let at = |a: usize, b: usize| DVec2::new(sign_u * a as f64, sign_v * b as f64) / f64::from(size);
    // Points of the octahedron |x| + |y| + |z| = 1: (u, y, v) above the fold; below it |x| = 1 - |v|, |z| = 1
    // - |u|.
    let upper = Plane {
        origin: DVec3::Y,
        along_u: DVec3::new(1.0, -sign_u, 0.0),
        along_v: DVec3::new(0.0, -sign_v, 1.0),
    };
    let lower = Plane {
        origin: DVec3::new(sign_u, 1.0, sign_v),
        along_u: DVec3::new(0.0, -sign_u, -sign_u * sign_v),
        along_v: DVec3::new(-sign_u * sign_v, -sign_v, 0.0),
    };
    let (near, far) = (at(a, b), at(a + 1, b + 1));
    let (across_u, across_v) = (at(a + 1, b), at(a, b + 1));
    if a + b + 2 <= n {
        visit(Flat::rectangle(upper, near, far));
    } else if a + b >= n {
        visit(Flat::rectangle(lower, near, far));
    } else {
        visit(Flat::triangle(upper, near, across_u, across_v));
        visit(Flat::triangle(lower, far, across_u, across_v));
    }
}
