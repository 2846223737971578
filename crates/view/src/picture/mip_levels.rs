//! Mip levels of images.

use octagloss_core::common::parallel;
use octagloss_drawing::tone::srgb_from_linear;
use octagloss_mesh::Image;
use std::borrow::Cow;
use std::iter::successors;

/// Encoding of texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Space {
    Srgb,
    Linear,
}

impl Space {
    /// The light that `byte` encodes.
    pub(crate) fn light(self, byte: u8) -> f32 {
        let x = f32::from(byte) / 255.0;
        match self {
            Self::Linear => x,
            Self::Srgb if x <= 0.040_45 => x / 12.92,
            Self::Srgb => ((x + 0.055) / 1.055).powf(2.4),
        }
    }

    fn encoded(self, light: f32) -> f32 {
        match self {
            Self::Linear => light,
            Self::Srgb => srgb_from_linear(light),
        }
    }
}

/// `image` and its coarser levels, down to one texel.
pub(crate) fn all_levels(image: &Image, space: Space) -> impl Iterator<Item = Cow<'_, Image>> {
    successors(Some(Cow::Borrowed(image)), move |level| {
        (level.texels.len() > 1).then(|| Cow::Owned(halved(level, space)))
    })
}

/// Halves the sides of `image`: averages linear light, not its encoding.
pub(crate) fn halved(image: &Image, space: Space) -> Image {
    let (width, height) = ((image.width / 2).max(1), (image.height / 2).max(1));
    let light: Vec<f32> = (0..=255_u8).map(|byte| space.light(byte)).collect();
    let span = |k: u32, of: u32, from: u32| k * from / of..((k + 1) * from).div_ceil(of);
    let texel = |index: usize| {
        let index = index as u32;
        let mut sum = [0.0; 4];
        let mut count = 0.0;
        for y in span(index / width, height, image.height) {
            for x in span(index % width, width, image.width) {
                let [red, green, blue, opacity] = image.texels[(y * image.width + x) as usize];
                let colour = [red, green, blue].map(|value| light[usize::from(value)]);
                (0..3).for_each(|c| sum[c] += colour[c]);
                sum[3] += f32::from(opacity) / 255.0;
                count += 1.0;
            }
        }
        let byte = |x: f32| (x * 255.0).round() as u8;
        let [red, green, blue, opacity] = sum.map(|sum| sum / count);
        let [red, green, blue] = [red, green, blue].map(|light| byte(space.encoded(light)));
        [red, green, blue, byte(opacity)]
    };
    Image { width, height, texels: parallel::values((width * height) as usize, texel) }
}

#[cfg(test)]
mod tests {
    use super::{Space, halved};
    use octagloss_mesh::Image;

    #[test]
    fn levels_are_means_of_light() {
        let texels = vec![[0, 255, 64, 0], [255, 255, 64, 255], [0, 255, 64, 0]];
        let image = Image { width: 3, height: 1, texels };
        // A third of the light is 0.333, which sRGB writes as 156.
        assert_eq!(halved(&image, Space::Srgb).texels, [[156, 255, 64, 85]]);
        assert_eq!(halved(&image, Space::Linear).texels, [[85, 255, 64, 85]]);
    }
}
