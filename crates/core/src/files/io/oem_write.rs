//! Writes bordered octahedral maps as interchange files: one level a roughness, each with its own border, in
//! KTX2 (MIP levels) or OpenEXR (one part a level).
//!
//! Level l of L has n >> l texels and a border of 2^(L - 1 - l) on every side: one texel at the last level,
//! so that bilinear look-ups never wrap. The border is the same share of the side at every level, so that a
//! direction has the same texture coordinates at all levels. Border texels follow the octahedral wrapping
//! rule.

use super::exr::parts::{Part, exr_parts_bytes};
use super::exr::write::attributes;
use super::ktx2::write::{ROUGHNESS_KEY, TextureShape, format_of, ktx2_file, roughness_text};
use super::map_header::BORDER_KEY;
use crate::common::error::{Result, wrong};
use crate::files::format::container::Container;
use crate::files::format::texel_bytes::texel_bytes;
use crate::files::format::{LevelName, Pixel};
use crate::light::chain::Level;
use crate::light::environment::{Layout, Rgb};
use crate::light::oem::{OemSize, level_sizes};
use crate::sphere::octahedral::wrap_texel;

/// Conventions written into every file.
const CONVENTIONS: [(&str, &str); 4] = [
    (
        "octaglossFold",
        "p = d / (|x| + |y| + |z|); y >= 0: (u, v) = (p.x, p.z); y < 0: (u, v) = ((1 - |p.z|) s(p.x), (1 - \
         |p.x|) s(p.z)), s(t) = 1 for t >= 0, else -1",
    ),
    ("octaglossUp", "+Y, right-handed; the centre is +Y, the corners are -Y, u runs along x, v along z"),
    (
        "octaglossBorderRule",
        "texel (i, j) of the unfolded plane is (i mod n, j mod n) where floor(i/n) + floor(j/n) is even, \
         else that turned by 180 degrees: (n-1 - i mod n, n-1 - j mod n)",
    ),
    (
        "octaglossTexelCentres",
        "half-integer: texel (i, j) of the square without its border lies at (u, v) = ((i, j) + 1/2) 2/n - \
         1, v downwards",
    ),
];

/// Encodes `levels`, octahedral squares whose sizes halve, with their borders: KTX2, or OpenEXR with parts
/// `m0`, `m1`, ... `metadata` are further text key/value pairs.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for other containers or levels, and for pixel formats and keys
/// that the container cannot hold.
pub fn oem_bytes(
    container: Container,
    levels: &[Level],
    pixel: Pixel,
    metadata: &[(String, String)],
) -> Result<Vec<u8>> {
    let size = levels.first().map_or(0, |level| level.layout.sides().0);
    let sizes = level_sizes(size, levels.len() as u32)?;
    for (index, (level, size)) in levels.iter().zip(&sizes).enumerate() {
        if level.layout != (Layout::Octahedral { size: size.inner }) {
            return wrong(format!(
                "level {index} of an octahedral map must be a square of {}, not {:?}",
                size.inner, level.layout
            ));
        }
    }
    if !container.holds(pixel) {
        return wrong(format!("{} files cannot hold {}", container.name(), pixel.name()));
    }
    let list =
        |of: fn(&OemSize) -> u32| sizes.iter().map(|s| of(s).to_string()).collect::<Vec<_>>().join(",");
    let own = [
        ("octaglossContent", "octahedral map".to_owned()),
        ("octaglossInterior", list(|size| size.inner)),
        (BORDER_KEY, list(|size| size.border)),
    ];
    let mut pairs: Vec<(&str, &str)> = own.iter().map(|(key, value)| (*key, value.as_str())).collect();
    pairs.extend(CONVENTIONS);
    pairs.extend(metadata.iter().map(|(key, value)| (key.as_str(), value.as_str())));
    let bordered: Vec<Vec<Rgb>> =
        levels.iter().zip(&sizes).map(|(level, size)| with_border(&level.texels, *size)).collect();

    match container {
        Container::Ktx2 => {
            let roughness = roughness_text(levels.iter().map(|level| level.roughness));
            pairs.push((ROUGHNESS_KEY, &roughness));
            let shape = TextureShape::flat(format_of(pixel)?, [sizes[0].bordered(); 2], levels.len());
            ktx2_file(&shape, &pairs, |index| texel_bytes(sizes[index].bordered(), &bordered[index], pixel))
        }
        Container::Exr => {
            let parts: Vec<Part<'_>> = levels
                .iter()
                .zip(&sizes)
                .zip(&bordered)
                .zip(0..)
                .map(|(((level, size), texels), index)| Part {
                    name: LevelName::whole(index).to_string(),
                    width: size.bordered(),
                    height: size.bordered(),
                    texels,
                    attributes: attributes(Some(level.roughness), pairs.iter().copied()),
                })
                .collect();
            exr_parts_bytes(&parts, pixel)
        }
        Container::Ktx1 | Container::Dds | Container::Hdr => {
            wrong(format!("an octahedral map is written as ktx2 or exr, not {}", container.name()))
        }
    }
}

/// Adds the border to the texels of a square.
fn with_border(square: &[Rgb], size: OemSize) -> Vec<Rgb> {
    let (border, side) = (i64::from(size.border), i64::from(size.bordered()));
    let texel = |(x, y): (i64, i64)| {
        let (x, y) = wrap_texel(size.inner, x - border, y - border);
        square[y as usize * size.inner as usize + x as usize]
    };
    (0..side).flat_map(|y| (0..side).map(move |x| (x, y))).map(texel).collect()
}
