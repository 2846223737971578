//! Textures of scenes: the texels of all images, with their mip levels, in one buffer.
//! `shaders/common/view_texture.wgsl` looks them up on the GPU.

use super::uniforms::TextureUniform;
use crate::picture::mip_levels::{Space, all_levels, halved};
use octagloss_core::common::error::{Result, wrong};
use octagloss_mesh::{Image, Texture, Wrap};
use std::borrow::Cow;

/// Address mode that mirrors an image every other time.
pub(crate) const MIRROR: u32 = 1;

/// Address mode that repeats the texels at the edge.
pub(crate) const CLAMP: u32 = 2;

/// Bit of textures that are magnified without interpolation.
pub(crate) const NEAREST: u32 = 16;

/// Most bytes of all texels: what every WebGPU device binds at once.
const MAX_BYTES: usize = 128 << 20;

/// Texels of images.
#[derive(Clone, Debug)]
pub(super) struct Texels {
    /// Red, green, blue and opacity in sRGB. Never empty, as no binding is.
    words: Vec<[u8; 4]>,
    /// The finest level of each image, without address modes.
    images: Vec<TextureUniform>,
}

impl Texels {
    /// The texels of the images that `textures` show, of fewer texels if they are larger than 128 MiB.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] if an image does not have the texels of its sides.
    pub(super) fn new(images: &[Image], textures: impl Iterator<Item = Texture>) -> Result<Self> {
        let mut shown = vec![false; images.len()];
        textures.for_each(|texture| shown[texture.image] = true);
        for (number, Image { width, height, texels }) in images.iter().enumerate() {
            if texels.is_empty() || texels.len() as u64 != u64::from(*width) * u64::from(*height) {
                return wrong(format!(
                    "image {number} of {width} x {height} texels has {}; give it as many as its sides say",
                    texels.len()
                ));
            }
        }
        Ok(Self::within(images, &shown, MAX_BYTES / 4))
    }

    /// Those of the `shown` images, with `most` texels of all levels.
    fn within(images: &[Image], shown: &[bool], most: usize) -> Self {
        let listed = images.iter().zip(shown);
        let mut finest: Vec<Option<Cow<'_, Image>>> =
            listed.map(|(image, shown)| shown.then_some(Cow::Borrowed(image))).collect();
        while finest.iter().flatten().map(|image| texels_of_levels(image)).sum::<usize>() > most {
            let largest = finest.iter_mut().flatten().max_by_key(|image| image.texels.len());
            let Some(largest) = largest.filter(|image| image.texels.len() > 1) else { break };
            *largest = Cow::Owned(halved(largest, Space::Srgb));
        }
        let mut words = Vec::new();
        let images = finest
            .into_iter()
            .map(|image| {
                let Some(image) = image else { return TextureUniform::default() };
                // Below 2^25.
                let first = words.len() as u32;
                all_levels(&image, Space::Srgb).for_each(|level| words.extend_from_slice(&level.texels));
                TextureUniform { first, width: image.width, height: image.height, modes: 0 }
            })
            .collect();
        if words.is_empty() {
            words.push([255; 4]);
        }
        Self { words, images }
    }

    /// The buffer's content.
    pub(super) fn bytes(&self) -> &[u8] {
        self.words.as_flattened()
    }

    /// `texture` in the buffer.
    pub(super) fn uniform(&self, texture: Option<Texture>) -> TextureUniform {
        let Some(Texture { image, wrap, nearest }) = texture else { return TextureUniform::default() };
        let [u, v] = wrap.map(|wrap| match wrap {
            Wrap::Repeat => 0,
            Wrap::Mirror => MIRROR,
            Wrap::Clamp => CLAMP,
        });
        TextureUniform { modes: u | (v << 2) | if nearest { NEAREST } else { 0 }, ..self.images[image] }
    }

    /// Columns and rows of `texture`.
    pub(super) fn sides(&self, texture: Texture) -> [u32; 2] {
        let TextureUniform { width, height, .. } = self.images[texture.image];
        [width, height]
    }
}

/// Texels of `image` and its coarser levels.
fn texels_of_levels(image: &Image) -> usize {
    let (mut width, mut height) = (image.width as usize, image.height as usize);
    let mut sum = width * height;
    while width * height > 1 {
        (width, height) = ((width / 2).max(1), (height / 2).max(1));
        sum += width * height;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::{Texels, TextureUniform, texels_of_levels};
    use octagloss_mesh::Image;

    fn image(width: u32, height: u32) -> Image {
        Image { width, height, texels: vec![[9; 4]; (width * height) as usize] }
    }

    #[test]
    fn the_largest_images_are_halved_until_all_fit() {
        let images = [image(16, 4), image(8, 8), image(2, 2), image(64, 64)];
        let sides = |most| -> Vec<[u32; 3]> {
            let texels = Texels::within(&images, &[true, true, true, false], most);
            assert!(texels.words.len() <= most.max(3), "{} of {most}", texels.words.len());
            let of = |image: &TextureUniform| [image.first, image.width, image.height];
            texels.images.iter().map(of).collect()
        };
        // 64 + 16 + 4 + 2 + 1, 64 + 16 + 4 + 1 and 4 + 1 texels; the last image is not shown.
        assert_eq!(images[..3].iter().map(texels_of_levels).collect::<Vec<_>>(), [87, 85, 5]);
        assert_eq!(sides(177), [[0, 16, 4], [87, 8, 8], [172, 2, 2], [0, 0, 0]]);
        assert_eq!(sides(176), [[0, 16, 4], [87, 4, 4], [108, 2, 2], [0, 0, 0]]);
        assert_eq!(sides(112), [[0, 8, 2], [23, 4, 4], [44, 2, 2], [0, 0, 0]]);
        assert_eq!(sides(0), [[0, 1, 1], [1, 1, 1], [2, 1, 1], [0, 0, 0]]);
    }

    #[test]
    fn nothing_fills_a_binding() {
        assert_eq!(Texels::within(&[], &[], 100).bytes().len(), 4);
    }
}
