//! The target's images, over whose texels outlines are rasterised.

use crate::geometry::overlap::{Accumulator, Share, scale_to, walk_outline};
use crate::sphere::grid::Grid;
use crate::sphere::map::Place;
use glam::{DVec2, DVec3};

/// The image of a component.
struct Frame {
    low: DVec2,
    texels_per_unit: DVec2,
    sides: [u32; 2],
    first_texel: usize,
}

/// The images of a map; reuses its buffer.
pub(super) struct Plane<'a> {
    grid: &'a Grid,
    frames: Vec<Frame>,
    window: Vec<Accumulator>,
}

impl<'a> Plane<'a> {
    pub(super) fn new(grid: &'a Grid) -> Self {
        let frames = (0..grid.map().components())
            .map(|k| {
                let rectangle = grid.map().component(k);
                let texels_per_unit = DVec2::ONE / grid.step(&rectangle);
                let (sides, first_texel) = (grid.sides(k), grid.first_texel(k));
                Frame { low: rectangle.low, texels_per_unit, sides, first_texel }
            })
            .collect();
        Self { grid, frames, window: Vec::new() }
    }

    pub(super) fn locate(&self, direction: DVec3) -> Place {
        self.grid.map().locate(direction)
    }

    /// Columns and rows of `component`.
    pub(super) fn sides(&self, component: u32) -> DVec2 {
        DVec2::from(self.frames[component as usize].sides.map(f64::from))
    }

    /// `place` in texels of its image.
    pub(super) fn in_texels(&self, place: Place) -> DVec2 {
        let frame = &self.frames[place.component as usize];
        ((place.uv - frame.low) * frame.texels_per_unit).clamp(DVec2::ZERO, self.sides(place.component))
    }

    /// Index of the texel at `at` of `component`.
    pub(super) fn index(&self, component: u32, at: DVec2) -> u32 {
        // Coordinates are not negative: casts round down.
        self.index_of(component, at.x as u32, at.y as u32)
    }

    fn index_of(&self, component: u32, x: u32, y: u32) -> u32 {
        let Frame { sides: [width, height], first_texel, .. } = self.frames[component as usize];
        let at = y.min(height - 1) as usize * width as usize + x.min(width - 1) as usize;
        u32::try_from(first_texel + at).expect("texels fit")
    }

    /// Appends the overlaps of the quadrilateral `outline` with the texels of `component`; they sum to
    /// `solid_angle`.
    pub(super) fn walk(
        &mut self,
        component: u32,
        outline: [DVec2; 4],
        solid_angle: f64,
        source: u32,
        shares: &mut Vec<Share>,
    ) {
        let texel = |corner: DVec2| [corner.x as u32, corner.y as u32];
        let first = texel(outline[0]);
        let whole = |plane: &Self| {
            let target = plane.index(component, outline[0]);
            Share { target, source, solid_angle: solid_angle as f32 }
        };
        if outline.iter().all(|corner| texel(*corner) == first) {
            return shares.push(whole(self));
        }
        let start = shares.len();
        let mut window = std::mem::take(&mut self.window);
        let Frame { low, texels_per_unit, .. } = self.frames[component as usize];
        let map = self.grid.map();
        walk_outline(&outline, &mut window, |x, y, overlap| {
            let uv = low + overlap.centroid(x, y) / texels_per_unit;
            let solid_angle = (overlap.area * map.density(component, uv)) as f32;
            shares.push(Share { target: self.index_of(component, x, y), source, solid_angle });
        });
        self.window = window;
        if !scale_to(solid_angle, &mut shares[start..]) {
            // Negligible area: assign all of it to one texel.
            shares.truncate(start);
            shares.push(whole(self));
        }
    }
}
