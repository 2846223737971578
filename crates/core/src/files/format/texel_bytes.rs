//! Encodes texels for the containers.

use super::bc6h::bc6h_blocks;
use super::r11g11b10::r11g11b10_from_rgb;
use super::{Pixel, push_halves, rgb9e5_from_rgb};
use crate::light::environment::Rgb;
use half::f16;

/// Encodes consecutive squares of `size` x `size` texels in `pixel`, a format of textures; little endian,
/// alpha 1 if there is an alpha channel.
pub(crate) fn texel_bytes(size: u32, texels: &[Rgb], pixel: Pixel) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(texels.len() * 16);
    match pixel {
        Pixel::F16 => {
            let mut rgb = Vec::new();
            for texels in texels.chunks(256) {
                rgb.clear();
                push_halves(texels.as_flattened(), &mut rgb);
                let [one, alpha] = f16::ONE.to_le_bytes();
                for &[a, b, c, d, e, f] in rgb.as_chunks().0 {
                    bytes.extend_from_slice(&[a, b, c, d, e, f, one, alpha]);
                }
            }
        }
        Pixel::F32 => {
            for [r, g, b] in texels {
                bytes.extend([*r, *g, *b, 1.0].iter().flat_map(|v| v.to_le_bytes()));
            }
        }
        Pixel::Rgb9e5 => bytes.extend(texels.iter().flat_map(|t| rgb9e5_from_rgb(*t).to_le_bytes())),
        Pixel::R11g11b10 => bytes.extend(texels.iter().flat_map(|t| r11g11b10_from_rgb(*t).to_le_bytes())),
        Pixel::Bc6h => return bc6h_blocks(size, texels),
        Pixel::Rgbd | Pixel::Rgbp | Pixel::Rgbe | Pixel::Auto => unreachable!("no textures have it"),
    }
    bytes
}
