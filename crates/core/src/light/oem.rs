//! The bordered octahedral environment map (OEM): per texel the energy L*w (red, green, blue) and the solid
//! angle w.

use crate::common::error::{Result, wrong};
use crate::common::smoothstep::smoothstep;
use crate::light::environment::Rgb;
use crate::lobe::Lobe;
use crate::sphere::octahedral::wrap_texel;

/// The share of bilinear reconstruction in a lobe of `alpha` over `inner` x `inner` texels.
///
/// Energy is constant in (u, v) within a texel. A lobe with an alpha of up to two texels (a texel is at least
/// 2/inner wide) is also convolved with a one-texel box, which makes roughness 0 bilinear interpolation. From
/// four texels on the box would only widen the lobe and is omitted; in between, the two are blended.
pub fn bilinear_share(lobe: Lobe, alpha: f64, inner: u32) -> f64 {
    if lobe == Lobe::Cosine {
        return 0.0;
    }
    let alpha = lobe.served_roughness(alpha.sqrt()).powi(2);
    let texels = alpha * f64::from(inner) / 2.0;
    smoothstep((4.0 - texels) / 2.0)
}

/// Size of an OEM.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OemSize {
    /// Texels along an edge of the square itself, at least 1.
    pub inner: u32,
    /// Border texels on every side, wrapped by the map's own rule.
    pub border: u32,
}

impl OemSize {
    /// Texels along an edge, border included; at most the greatest `u32`.
    #[must_use]
    pub const fn bordered(self) -> u32 {
        self.inner.saturating_add(self.border.saturating_mul(2))
    }
}

/// An OEM. Texels are row-major, border included: [L_r*w, L_g*w, L_b*w, w], with w the texel's exact solid
/// angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Oem {
    size: OemSize,
    texels: Vec<[f32; 4]>,
}

impl Oem {
    /// An OEM from the `inner`^2 texels of the square; wrapping fills the border.
    ///
    /// # Panics
    /// If the count is not `size.inner` squared.
    pub fn from_square(size: OemSize, square: Vec<[f32; 4]>) -> Self {
        let inner = size.inner as usize;
        assert_eq!(square.len(), inner * inner, "texels of the square");
        if size.border == 0 {
            return Self { size, texels: square };
        }
        let (border, side) = (i64::from(size.border), i64::from(size.bordered()));
        let mut texels = Vec::with_capacity((side * side) as usize);
        for y in 0..side {
            for x in 0..side {
                let (x, y) = wrap_texel(size.inner, x - border, y - border);
                texels.push(square[y as usize * inner + x as usize]);
            }
        }
        Self { size, texels }
    }

    /// An OEM from all of its texels, border included.
    ///
    /// # Panics
    /// If the count is not the bordered size squared.
    pub fn from_bordered(size: OemSize, texels: Vec<[f32; 4]>) -> Self {
        let side = size.bordered() as usize;
        assert_eq!(texels.len(), side * side, "texels with the border");
        Self { size, texels }
    }

    /// Its size.
    pub const fn size(&self) -> OemSize {
        self.size
    }

    /// All texels, border included.
    pub fn texels(&self) -> &[[f32; 4]] {
        &self.texels
    }

    /// Texel (`x`, `y`) of the square, 0 <= x, y < inner.
    pub fn texel(&self, x: u32, y: u32) -> [f32; 4] {
        let side = self.size.bordered() as usize;
        self.texels[(y + self.size.border) as usize * side + (x + self.size.border) as usize]
    }

    /// Row `y` of the square, without its border.
    pub fn row(&self, y: u32) -> &[[f32; 4]] {
        let start =
            (y + self.size.border) as usize * self.size.bordered() as usize + self.size.border as usize;
        &self.texels[start..start + self.size.inner as usize]
    }

    /// The texels of the square, row by row, without the border.
    pub fn square(&self) -> impl Iterator<Item = &[f32; 4]> {
        (0..self.size.inner).flat_map(|y| self.row(y))
    }

    /// The least radiance of each channel over the square.
    pub fn least_radiance(&self) -> Rgb {
        let mut least = [f32::INFINITY; 3];
        for [r, g, b, w] in self.square() {
            for (least, energy) in least.iter_mut().zip([r, g, b]) {
                *least = least.min(energy / w);
            }
        }
        least
    }

    /// Total energy (red, green, blue) and solid angle of the square, summed in double precision.
    pub fn totals(&self) -> [f64; 4] {
        let mut totals = [0.0; 4];
        for texel in self.square() {
            for (total, value) in totals.iter_mut().zip(texel) {
                *total += f64::from(*value);
            }
        }
        totals
    }

    /// Radiance of texel (`x`, `y`) of the square.
    pub fn radiance(&self, x: u32, y: u32) -> Rgb {
        let [r, g, b, w] = self.texel(x, y);
        [r / w, g / w, b / w]
    }
}

/// Sizes of the levels of a map of `size` x `size` texels, the sharpest first.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if `levels` is 0, or `size` is not divisible by 2 that often.
pub fn level_sizes(size: u32, levels: u32) -> Result<Vec<OemSize>> {
    let halvings = levels.saturating_sub(1);
    if levels == 0 || halvings > 14 || size == 0 || !size.is_multiple_of(1 << halvings) {
        return wrong(format!(
            "octahedral `size` {size} cannot be halved {halvings} times; choose a multiple of {} or fewer \
             `levels`",
            1_u32 << halvings.min(14)
        ));
    }
    Ok((0..levels).map(|l| OemSize { inner: size >> l, border: 1 << (halvings - l) }).collect())
}
