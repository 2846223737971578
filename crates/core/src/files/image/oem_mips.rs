//! Mip-mapped octahedral maps with a safety border, looked up as textures are: trilinear, clamped.
//!
//! Engelhardt and Dachsbacher 2008, section 4.2. Level k holds the means of 2^k x 2^k texels of the bordered
//! map, weighted by solid angle. The border shows what lies beyond the square's edges, so that every level's
//! border is right, too, up to [`OemMips::greatest_level`].

use crate::light::chain_lookup::bilinear;
use crate::light::environment::Rgb;
use crate::light::oem::Oem;
use crate::sphere::map::SphereMap as _;
use crate::sphere::octahedral::oct_from_direction;
use crate::sphere::octahedral_rectangular::OctahedralRectangular;
use crate::sphere::oem_lookup::{greatest_level, rectangular_place};
use glam::{DVec2, DVec3};

/// Weights of the means in mip levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weights {
    /// Solid angles of texels: right.
    SolidAngle,
    /// Equal weights, as of ordinary mip maps: wrong by up to the map's ratio of densities, for comparison.
    Equal,
}

/// Texels that look-ups read outside the texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Addressing {
    /// The nearest texel.
    Clamp,
    /// The texel of the opposite edge: wrong beyond every edge of an octahedral map, for comparison.
    Repeat,
}

/// A level.
#[derive(Clone, Debug, PartialEq)]
pub struct MipLevel {
    /// Texels along an edge, border included.
    pub side: u32,
    /// Radiance, layer after layer, row by row.
    pub texels: Vec<Rgb>,
}

/// An octahedral map and its mip levels.
#[derive(Clone, Debug)]
pub struct OemMips {
    /// Layer and coordinates in [-1, 1]^2 of a direction: both hemispheres in one square, or a layer of each.
    place: fn(DVec3) -> (u32, DVec2),
    inner: u32,
    border: u32,
    levels: Vec<MipLevel>,
}

impl OemMips {
    /// The quadratic layout of `oem`, with its border.
    pub fn quadratic(oem: &Oem, weights: Weights) -> Self {
        let (inner, border) = (oem.size().inner, oem.size().border);
        let texels = oem.texels().iter().map(|texel| texel.map(f64::from)).collect();
        Self::halved(|direction| (0, oct_from_direction(direction)), (inner, border), texels, weights)
    }

    /// The rectangular layout with one layer of `inner` texels along an edge per hemisphere, upper one first,
    /// of the `radiance` of its texels' centres. Border texels are those of the other layer.
    pub fn rectangular(inner: u32, border: u32, weights: Weights, radiance: impl Fn(DVec3) -> Rgb) -> Self {
        let (n, b) = (i64::from(inner), i64::from(border));
        let place = |k: u32| f64::from(k) * 2.0 / f64::from(inner);
        let texel = |x: u32, y: u32| {
            let low = DVec2::new(place(x) - 2.0, place(y) - 1.0);
            let side = 2.0 / f64::from(inner);
            let solid_angle = OctahedralRectangular.solid_angle(0, low, low + side);
            let rgb = radiance(OctahedralRectangular.direction(0, low + side / 2.0));
            let [red, green, blue] = rgb.map(|channel| f64::from(channel) * solid_angle);
            [red, green, blue, solid_angle]
        };
        let own: Vec<[f64; 4]> =
            (0..inner).flat_map(|y| (0..2 * inner).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect();
        let mut texels = Vec::new();
        for layer in 0..2 {
            for (y, x) in (-b..n + b).flat_map(|y| (-b..n + b).map(move |x| (y, x))) {
                let at = OctahedralRectangular.wrap_texel(inner, 0, x + layer * n, y);
                let at = at.expect("the map's texels continue across every edge");
                texels.push(own[(at.y * 2 * inner + at.x) as usize]);
            }
        }
        Self::halved(rectangular_place, (inner, border), texels, weights)
    }

    /// The levels of `texels` (energy and solid angle), halved as long as their side is even.
    fn halved(
        place: fn(DVec3) -> (u32, DVec2),
        (inner, border): (u32, u32),
        mut texels: Vec<[f64; 4]>,
        weights: Weights,
    ) -> Self {
        if weights == Weights::Equal {
            for [red, green, blue, w] in &mut texels {
                [*red, *green, *blue, *w] = [*red / *w, *green / *w, *blue / *w, 1.0];
            }
        }
        let mut side = (inner + 2 * border) as usize;
        let mut levels = Vec::new();
        loop {
            let radiance =
                |[red, green, blue, w]: &[f64; 4]| [red / w, green / w, blue / w].map(|c| c as f32);
            levels.push(MipLevel { side: side as u32, texels: texels.iter().map(radiance).collect() });
            if !side.is_multiple_of(2) {
                return Self { place, inner, border, levels };
            }
            // Layers have an even number of rows, so rows of blocks do not cross them.
            texels = texels
                .chunks_exact(2 * side)
                .flat_map(|rows| {
                    let (upper, lower) = rows.split_at(side);
                    upper
                        .chunks_exact(2)
                        .zip(lower.chunks_exact(2))
                        .map(|(a, b)| std::array::from_fn(|c| a[0][c] + a[1][c] + b[0][c] + b[1][c]))
                })
                .collect();
            side /= 2;
        }
    }

    /// Texels along an edge of a layer, without the border.
    pub const fn inner(&self) -> u32 {
        self.inner
    }

    /// The levels, the finest first.
    pub fn levels(&self) -> &[MipLevel] {
        &self.levels
    }

    /// The greatest level whose look-ups are right everywhere; `None` without a border.
    pub const fn greatest_level(&self) -> Option<u32> {
        greatest_level(self.inner, self.border)
    }

    /// Layer and coordinates in [-1, 1]^2 of `direction`.
    pub fn place(&self, direction: DVec3) -> (u32, DVec2) {
        (self.place)(direction)
    }

    /// Radiance at `direction` and `level`, trilinear. Levels are clamped to those whose look-ups are right.
    pub fn radiance(&self, direction: DVec3, level: f64) -> [f64; 3] {
        let greatest = f64::from(self.greatest_level().unwrap_or(0));
        self.look_up(self.place(direction), level.clamp(0.0, greatest), Addressing::Clamp)
    }

    /// Radiance at a layer and coordinates in [-1, 1]^2, trilinear between any levels of the texture.
    pub fn look_up(&self, place: (u32, DVec2), level: f64, addressing: Addressing) -> [f64; 3] {
        let level = level.clamp(0.0, (self.levels.len() - 1) as f64);
        let (fine, share) = (level.floor() as usize, level.fract());
        let near = self.bilinear(place, fine, addressing);
        if share == 0.0 {
            return near;
        }
        let far = self.bilinear(place, fine + 1, addressing);
        std::array::from_fn(|c| near[c] + (far[c] - near[c]) * share)
    }

    fn bilinear(&self, (layer, uv): (u32, DVec2), level: usize, addressing: Addressing) -> [f64; 3] {
        let MipLevel { side, texels } = &self.levels[level];
        let (side, texel) = (i64::from(*side), f64::from(1_u32 << level));
        let at = ((uv + 1.0) * (f64::from(self.inner) / 2.0) + f64::from(self.border)) / texel;
        let inside = |k: i64| match addressing {
            Addressing::Clamp => k.clamp(0, side - 1),
            Addressing::Repeat => k.rem_euclid(side),
        };
        let index = |x, y| ((i64::from(layer) * side + inside(y)) * side + inside(x)) as u32;
        bilinear(at.x, at.y, index).mean(|texel| texels[texel].map(f64::from))
    }
}
