//! A map of the sphere divided into texels.

use super::map::{Component, Place, SphereMap, Texel};
use crate::common::error::{Result, wrong};
use glam::DVec2;

/// A map whose images are divided into texels. Texels are numbered component by component, row by row.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
    map: &'static dyn SphereMap,
    size: u32,
}

/// Maximum size; positions in a picture of all components stay exact.
pub const MAX_SIZE: u32 = 16_384;

impl Grid {
    /// `map` with `size` texels along the shorter side of each component, 1 to [`MAX_SIZE`].
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for another size.
    pub fn new(map: &'static dyn SphereMap, size: u32) -> Result<Self> {
        if size == 0 || size > MAX_SIZE {
            return wrong(format!("a map of {size} texels a side; use 1 to {MAX_SIZE}"));
        }
        Ok(Self { map, size })
    }

    /// The map.
    pub fn map(&self) -> &'static dyn SphereMap {
        self.map
    }

    /// Texels along the shorter side of each component.
    pub const fn size(&self) -> u32 {
        self.size
    }

    /// Columns and rows of the image of `component`.
    pub fn sides(&self, component: u32) -> [u32; 2] {
        self.map.component(component).cells.map(|cells| cells * self.size)
    }

    /// Total number of texels.
    pub fn texel_count(&self) -> usize {
        self.first_texel(self.map.components())
    }

    /// Index of the first texel of `component`; for one past the last component the number of texels.
    pub fn first_texel(&self, component: u32) -> usize {
        (0..component).map(|k| self.sides(k).map(|side| side as usize).iter().product::<usize>()).sum()
    }

    /// Columns and rows of a picture of all components, in texels, each with `border` texels around it.
    pub fn picture_sides(&self, border: u32) -> [u32; 2] {
        let mut sides = [0; 2];
        for index in 0..self.map.components() {
            let component = self.map.component(index);
            for (axis, side) in sides.iter_mut().enumerate() {
                let end = component.at[axis] + component.cells[axis];
                *side = (*side).max(end * self.size + 2 * border * self.rank(index, axis));
            }
        }
        sides
    }

    /// Rank, from 1, of the column (`axis` 0) or row (1) in which component `index` starts, among all start
    /// columns or rows.
    fn rank(&self, index: u32, axis: usize) -> u32 {
        let begins =
            |place: &u32| (0..self.map.components()).any(|k| self.map.component(k).at[axis] == *place);
        u32::try_from((0..=self.map.component(index).at[axis]).filter(begins).count())
            .expect("few components")
    }

    /// Position of column 0, row 0 of `component` in [`Grid::picture_sides`], without its border.
    pub fn picture_origin(&self, component: u32, border: u32) -> [u32; 2] {
        let at = self.map.component(component).at;
        [0, 1].map(|axis| at[axis] * self.size + border * (2 * self.rank(component, axis) - 1))
    }

    /// Width and height of a texel of `component` in the map's own coordinates.
    pub fn step(&self, component: &Component) -> DVec2 {
        component.extent() / DVec2::from(component.cells.map(|cells| f64::from(cells * self.size)))
    }

    /// Coordinates of the point (`x`, `y`), in texels from the image's corner, of `component`.
    pub fn uv(&self, component: u32, x: f64, y: f64) -> DVec2 {
        let component = self.map.component(component);
        component.low + self.step(&component) * DVec2::new(x, y)
    }

    /// Unit direction of the centre of `texel`.
    pub fn direction_from_texel(&self, texel: Texel) -> glam::DVec3 {
        let uv = self.uv(texel.component, f64::from(texel.x) + 0.5, f64::from(texel.y) + 0.5);
        self.map.direction(texel.component, uv)
    }

    /// The place of the centre of `texel`.
    pub(crate) fn centre(&self, texel: Texel) -> Place {
        let uv = self.uv(texel.component, f64::from(texel.x) + 0.5, f64::from(texel.y) + 0.5);
        Place { component: texel.component, uv }
    }

    /// The texel whose centre is at `place`, if there is one.
    pub(crate) fn texel_from_centre(&self, place: Place) -> Option<Texel> {
        let component = self.map.component(place.component);
        let at = (place.uv - component.low) / self.step(&component) - 0.5;
        let nearest = at.round();
        let [width, height] = component.cells.map(|cells| f64::from(cells * self.size));
        let is_texel = (at - nearest).abs().max_element() < 1e-4
            && nearest.min_element() >= 0.0
            && nearest.x < width
            && nearest.y < height;
        is_texel.then_some(Texel { component: place.component, x: nearest.x as u32, y: nearest.y as u32 })
    }

    /// The texel whose directions are those of `texel` with their coordinate `axis` (0 to 2 for x to z)
    /// negated; `None` if this mirror does not map texels onto texels.
    pub fn mirrored(&self, texel: Texel, axis: usize) -> Option<Texel> {
        self.texel_from_centre(self.map.mirrored(self.centre(texel), axis)?)
    }

    /// Index of `texel`.
    pub fn index(&self, texel: Texel) -> usize {
        let width = self.sides(texel.component)[0] as usize;
        self.first_texel(texel.component) + texel.y as usize * width + texel.x as usize
    }

    /// The texel of number `index`.
    ///
    /// # Panics
    /// If there is no such texel.
    pub(crate) fn texel(&self, index: usize) -> Texel {
        let mut rest = index;
        for component in 0..self.map.components() {
            let [width, height] = self.sides(component).map(|side| side as usize);
            if rest < width * height {
                return Texel { component, x: (rest % width) as u32, y: (rest / width) as u32 };
            }
            rest -= width * height;
        }
        panic!("texel {index} of {}", self.texel_count());
    }

    /// Exact solid angle, in steradians, of the part of `texel` in its component's domain.
    pub fn solid_angle(&self, texel: Texel) -> f64 {
        let (x, y) = (f64::from(texel.x), f64::from(texel.y));
        let low = self.uv(texel.component, x, y);
        let high = self.uv(texel.component, x + 1.0, y + 1.0);
        self.map.solid_angle(texel.component, low, high)
    }

    /// All texels, in order.
    pub fn texels(&self) -> impl Iterator<Item = Texel> + use<> {
        let grid = *self;
        (0..self.map.components()).flat_map(move |component| {
            let [width, height] = grid.sides(component);
            (0..height).flat_map(move |y| (0..width).map(move |x| Texel { component, x, y }))
        })
    }
}
