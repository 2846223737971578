//! An environment in memory: radiance on a panorama, a cube or an octahedral square, and its orientation.

use crate::common::error::{Result, wrong};
use crate::common::names::named;
use crate::sphere::{cube, equirect, octahedral};
use glam::{DMat3, DVec2, DVec3};

/// Linear radiance, red, green, blue.
pub type Rgb = [f32; 3];

/// The weights of luminance (Rec. 709 primaries).
pub const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Luminance of `rgb`; finite if `rgb` is.
#[must_use]
pub fn luminance(rgb: Rgb) -> f32 {
    // The sum of the weights rounds to above 1.
    (LUMINANCE[0] * rgb[0] + LUMINANCE[1] * rgb[1] + LUMINANCE[2] * rgb[2]).min(f32::MAX)
}

/// Luminance of `rgb` in double precision, which resolves the faintest radiance.
pub fn exact_luminance<T: Into<f64>>(rgb: [T; 3]) -> f64 {
    LUMINANCE.iter().zip(rgb).map(|(weight, value)| f64::from(*weight) * value.into()).sum()
}

/// How an environment's texels cover the sphere; the crate's conventions give the formulas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// `width` x `height` texels. The panorama of an [`Environment`] is 2:1, or one texel.
    Panorama {
        /// Columns, at least 1.
        width: u32,
        /// Rows, at least 1.
        height: u32,
    },
    /// Six faces of `size` x `size` texels in the order of [`cube::Face::ALL`].
    Cube {
        /// Texels along an edge, at least 1.
        size: u32,
    },
    /// `size` x `size` texels.
    Octahedral {
        /// Texels along an edge, at least 1.
        size: u32,
    },
}

/// A map of the sphere without a size; [`Layout`] adds the size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Map {
    /// Six faces.
    #[default]
    Cube,
    /// A panorama, 2:1.
    Panorama,
    /// An octahedral square.
    Octahedral,
}

named!(Map { Cube = "cube", Panorama = "panorama", Octahedral = "octahedral" });

impl Map {
    /// Number of levels down to a single texel (per face) from level 0 of `size` texels along its shorter
    /// edge.
    #[must_use]
    pub fn most_levels(self, size: u32) -> u32 {
        let longer = if self == Self::Panorama { size.saturating_mul(2) } else { size };
        longer.checked_ilog2().map_or(0, |log2| log2 + 1)
    }

    /// Level `level` of a map whose level 0 has `size` texels along its shorter edge: sides halve, down to
    /// one texel.
    #[must_use]
    pub fn layout(self, size: u32, level: u32) -> Layout {
        let side = |full: u32| full.checked_shr(level).unwrap_or(0).max(1);
        match self {
            Self::Cube => Layout::Cube { size: side(size) },
            Self::Panorama => Layout::Panorama { width: side(size.saturating_mul(2)), height: side(size) },
            Self::Octahedral => Layout::Octahedral { size: side(size) },
        }
    }
}

impl Layout {
    /// The map without its size.
    #[must_use]
    pub const fn map(self) -> Map {
        match self {
            Self::Panorama { .. } => Map::Panorama,
            Self::Cube { .. } => Map::Cube,
            Self::Octahedral { .. } => Map::Octahedral,
        }
    }

    /// Name of the map.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Panorama { .. } => "a panorama",
            Self::Cube { .. } => "a cube",
            Self::Octahedral { .. } => "an octahedral square",
        }
    }

    /// Edge of the faces of a cube with as many texels around the horizon.
    pub const fn face_edge(self) -> u32 {
        match self {
            Self::Panorama { width, .. } => width.div_ceil(4),
            Self::Cube { size } => size,
            Self::Octahedral { size } => size.div_ceil(2),
        }
    }

    /// Columns and rows of one image; of one face for a cube.
    #[must_use]
    pub const fn sides(self) -> (u32, u32) {
        match self {
            Self::Panorama { width, height } => (width, height),
            Self::Cube { size } | Self::Octahedral { size } => (size, size),
        }
    }

    /// Number of texels; the greatest `usize` if there are more.
    #[must_use]
    pub fn texel_count(self) -> usize {
        let area = |w: u32, h: u32| (w as usize).saturating_mul(h as usize);
        match self {
            Self::Panorama { width, height } => area(width, height),
            Self::Cube { size } => area(size, size).saturating_mul(6),
            Self::Octahedral { size } => area(size, size),
        }
    }

    fn inside(self, i: u32, j: u32) -> (u32, u32) {
        let (columns, rows) = self.sides();
        (i.min(columns.saturating_sub(1)), j.min(rows.saturating_sub(1)))
    }

    /// Solid angle of the texel in column `i`, row `j` of its image, where those beyond the last count as the
    /// last; NaN for a layout of no texels.
    #[must_use]
    pub fn texel_solid_angle(self, i: u32, j: u32) -> f64 {
        let (i, j) = self.inside(i, j);
        match self {
            Self::Panorama { width, height } => equirect::texel_solid_angle(width, height, j),
            Self::Cube { size } => cube::texel_solid_angle(size, i, j),
            Self::Octahedral { size } => octahedral::texel_solid_angle(size, i, j),
        }
    }

    /// Unit direction of the centre of the texel in column `i`, row `j` of image `image` (a cube's face;
    /// without meaning elsewhere), where those beyond the last count as the last; NaN for a layout of no
    /// texels.
    #[must_use]
    pub fn direction_from_texel(self, image: u32, i: u32, j: u32) -> DVec3 {
        let (i, j) = self.inside(i, j);
        match self {
            Self::Panorama { width, height } => equirect::direction_from_equirect(
                (f64::from(i) + 0.5) / f64::from(width),
                (f64::from(j) + 0.5) / f64::from(height),
            ),
            Self::Cube { size } => {
                cube::direction_from_texel(cube::Face::ALL[image.min(5) as usize], size, i, j)
            }
            Self::Octahedral { size } => octahedral::direction_from_oct(octahedral::texel_centre(size, i, j)),
        }
    }

    /// Image (a cube's face, otherwise 0), column and row of texel `at`.
    pub(crate) const fn place(self, at: usize) -> (u32, u32, u32) {
        let (width, height) = self.sides();
        let (width, height) = (width as usize, height as usize);
        ((at / (width * height)) as u32, (at % width) as u32, (at / width % height) as u32)
    }

    /// [`Self::direction_from_texel`] of texel `at`.
    pub(crate) fn direction_at(self, at: usize) -> DVec3 {
        let (image, i, j) = self.place(at);
        self.direction_from_texel(image, i, j)
    }

    /// [`Self::texel_solid_angle`] of texel `at`.
    pub fn solid_angle_at(self, at: usize) -> f64 {
        let (_, i, j) = self.place(at);
        self.texel_solid_angle(i, j)
    }

    /// Unit direction of the point (`x`, `y`), in texels from the corner of an image, and the solid angle
    /// there per area, up to a factor.
    pub(crate) fn direction_within(self, image: u32, x: f64, y: f64) -> (DVec3, f64) {
        let signed = |x: f64, size: u32| x * 2.0 / f64::from(size) - 1.0;
        match self {
            Self::Cube { size } => {
                let point =
                    cube::cube_point(cube::Face::ALL[image as usize], signed(x, size), signed(y, size));
                (point.normalize(), point.length_squared().powf(-1.5))
            }
            Self::Panorama { width, height } => {
                let direction =
                    equirect::direction_from_equirect(x / f64::from(width), y / f64::from(height));
                (direction, direction.x.hypot(direction.z))
            }
            Self::Octahedral { size } => {
                let uv = DVec2::new(signed(x, size), signed(y, size));
                (octahedral::direction_from_oct(uv), octahedral::solid_angle_density(uv))
            }
        }
    }
}

/// Most degrees that front ends turn an environment by, either way; far more would leave doubles no fine
/// angles.
pub const MAX_DEGREES: f64 = 1e6;

/// Rotation about +Y that maps +Z to +X for 90 degrees. Quarter turns are exact.
pub fn rotation_y(degrees: f64) -> DMat3 {
    let (sin, cos) = match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    };
    DMat3::from_cols(DVec3::new(cos, 0.0, -sin), DVec3::Y, DVec3::new(sin, 0.0, cos))
}

/// Radiance from every direction.
///
/// Texels are row-major, a cube's faces in order; each is finite, not negative, and constant over its own
/// solid angle. [`Environment::source_from_world`] maps world directions to the source's own.
#[derive(Clone, Debug)]
pub struct Environment {
    layout: Layout,
    texels: Vec<Rgb>,
    source_from_world: DMat3,
}

impl Environment {
    /// An environment of `texels` in `layout`, unrotated.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] if the count is not the layout's, a side is zero, a
    /// panorama is neither 2:1 nor one texel, or a texel is negative or not finite.
    pub fn new(layout: Layout, texels: Vec<Rgb>) -> Result<Self> {
        if let Layout::Panorama { width, height } = layout
            && (width, height) != (1, 1)
            && u64::from(width) != 2 * u64::from(height)
        {
            return wrong(format!(
                "a panorama of {width}x{height} is not 2:1, so it does not cover the sphere once; fill it up \
                 with black or resample it"
            ));
        }
        let environment = of_sound(layout, texels)?;
        let texels = &environment.texels;
        if let Some(at) = first_wrong(texels.as_flattened()).map(|k| k / 3) {
            return wrong(format!(
                "texel {at} is {:?}; radiance must be finite and not negative",
                texels[at]
            ));
        }
        Ok(environment)
    }

    /// Replaces the texels, with the same layout and orientation; they must be finite and not negative.
    pub(crate) fn with_texels(&self, texels: Vec<Rgb>) -> Self {
        debug_assert_eq!(texels.len(), self.texels.len(), "one for one");
        Self { texels, ..*self }
    }

    /// Rotates the environment about +Y: +90 degrees maps +Z to +X.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for an angle that is not finite.
    pub fn rotated_y(mut self, degrees: f64) -> Result<Self> {
        if !degrees.is_finite() {
            return wrong(format!("a rotation by {degrees} degrees, which is not finite"));
        }
        // A world direction is looked up where the rotation took it from.
        self.source_from_world *= rotation_y(degrees).transpose();
        Ok(self)
    }

    /// Flips the picture left to right: a panorama about its centre (z becomes -z), cube faces and octahedral
    /// squares by x becoming -x. Photographs taken from inside need this.
    #[must_use]
    pub fn mirrored(mut self) -> Self {
        let flip = match self.layout {
            Layout::Panorama { .. } => DVec3::new(1.0, 1.0, -1.0),
            Layout::Cube { .. } | Layout::Octahedral { .. } => DVec3::new(-1.0, 1.0, 1.0),
        };
        self.source_from_world = DMat3::from_diagonal(flip) * self.source_from_world;
        self
    }

    /// Layout of the texels.
    #[must_use]
    pub const fn layout(&self) -> Layout {
        self.layout
    }

    /// The texels, in the layout's order.
    #[must_use]
    pub fn texels(&self) -> &[Rgb] {
        &self.texels
    }

    /// Maps a world direction to the source's own, including rotation and mirroring.
    #[must_use]
    pub const fn source_from_world(&self) -> DMat3 {
        self.source_from_world
    }

    /// Calls `visit` for every texel with the unit world direction of its centre, its solid angle and its
    /// radiance.
    pub fn for_each_texel(&self, mut visit: impl FnMut(DVec3, f64, Rgb)) {
        let world_from_source = self.source_from_world.transpose();
        let mut texels = self.texels.iter();
        let mut next = |direction: DVec3, solid_angle: f64| {
            visit(world_from_source * direction, solid_angle, *texels.next().expect("one texel a visit"));
        };
        let direction = |image, i, j| self.layout.direction_from_texel(image, i, j);
        match self.layout {
            Layout::Panorama { width, height } => {
                for j in 0..height {
                    let solid_angle = equirect::texel_solid_angle(width, height, j);
                    (0..width).for_each(|i| next(direction(0, i, j), solid_angle));
                }
            }
            Layout::Cube { size } => {
                for (image, j) in (0..6).flat_map(|image| (0..size).map(move |j| (image, j))) {
                    (0..size).for_each(|i| next(direction(image, i, j), cube::texel_solid_angle(size, i, j)));
                }
            }
            Layout::Octahedral { size } => {
                for j in 0..size {
                    (0..size)
                        .for_each(|i| next(direction(0, i, j), octahedral::texel_solid_angle(size, i, j)));
                }
            }
        }
    }
}

/// [`Environment::new`] for texels known to be finite and not negative, and panoramas of any shape.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if the count is not the layout's, or a side is zero.
pub fn of_sound(layout: Layout, texels: Vec<Rgb>) -> Result<Environment> {
    let (needed, given) = (layout.texel_count(), texels.len());
    if needed == 0 {
        return wrong(format!("{} of no texels ({layout:?}); every side must be at least 1", layout.name()));
    }
    if given != needed {
        return wrong(format!("{layout:?} requires {needed} texels, got {given}"));
    }
    Ok(Environment { layout, texels, source_from_world: DMat3::IDENTITY })
}

/// Whether `value` is no radiance and no bound: negative or not finite.
pub(crate) const fn is_wrong(value: f32) -> bool {
    !(value.is_finite() && value >= 0.0)
}

/// The index of the first of `values` that [`is_wrong`].
pub(crate) fn first_wrong(values: &[f32]) -> Option<usize> {
    const BLOCK: usize = 1024;
    // The sign of a negative number, -0 as well, and of the distance to the greatest number: without
    // branches, for any vector unit.
    let suspicion = |any: i32, value: &f32| {
        let bits = value.to_bits().cast_signed();
        any | bits | (f32::MAX.to_bits().cast_signed() - (bits & i32::MAX))
    };
    let mut suspicious =
        values.chunks(BLOCK).enumerate().filter(|(_, block)| block.iter().fold(0, suspicion) < 0);
    suspicious.find_map(|(k, block)| Some(BLOCK * k + block.iter().position(|value| is_wrong(*value))?))
}

/// A panorama of coloured noise, with lamps of one colour in texels whose noise exceeds `rare`.
#[cfg(test)]
pub(crate) fn lamps([rare, light]: [f64; 2]) -> Environment {
    let texel = |k: u32| -> Rgb {
        let noise = |turn: u32| f64::from(k.wrapping_mul(2_654_435_761).rotate_left(turn) >> 16) / 65536.0;
        let lamp = |turn: u32| if noise(turn) > rare { light } else { 0.0 };
        [0, 7, 19].map(|turn| (0.2 + noise(turn) + lamp(turn + 3)) as f32)
    };
    let layout = Layout::Panorama { width: 128, height: 64 };
    Environment::new(layout, (0..128 * 64).map(texel).collect()).expect("a panorama")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_wrong_value_is_found_wherever_it_is() {
        let mut values = vec![1.0; 5000];
        values[7] = -0.0;
        values[1030] = f32::MAX;
        assert_eq!(first_wrong(&values), None);
        for wrong in [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, -f32::MIN_POSITIVE] {
            for at in [4999, 2048, 1023, 0] {
                let mut values = values.clone();
                (values[at], values[4999]) = (wrong, -1.0);
                assert_eq!(first_wrong(&values), Some(at), "{wrong}");
            }
        }
    }
}
