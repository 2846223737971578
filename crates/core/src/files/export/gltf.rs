//! glTF with EXT_lights_image_based: one binary file, the faces as RGBD in PNG.
//!
//! extensions/2.0/Vendor/EXT_lights_image_based/README.md of KhronosGroup/glTF: levels evenly from roughness
//! 0 to 1 and not down to one texel, every image flipped vertically, nine coefficients of irradiance. Where
//! it leaves a choice, this follows Babylon.js's loader
//! (packages/dev/loaders/src/glTF/2.0/Extensions/EXT_lights_image_based.ts): images are vertically flipped
//! and the cube is looked up with x negated, as in an `.env`. The loader (version 9.28) deviates from the
//! text in three points, which `docs/engines.md` mends: it takes the decoded light for sRGB, selects levels
//! by the logarithm of alpha, and gives the coefficients the signs of the Condon-Shortley phase.

use super::babylon::png_faces;
use crate::common::error::{Error, Result};
use crate::files::io::exr::write::SOFTWARE;
use crate::light::chain::Level;
use crate::light::sh::scale::{ShScale, scaled};
use serde_json::{Value, json};

/// Number of coefficients in the extension.
const NINE: usize = 9;

pub(crate) const EXTENSION: &str = "EXT_lights_image_based";
/// Encodes a `.glb` with a scene lit by `levels` and the harmonics `sh` of the environment's radiance.
///
/// # Errors
/// [`Error::Parameter`] for more than 4 GiB.
pub(crate) fn glb_bytes(levels: &[Level], sh: &[[f64; 3]], name: &str) -> Result<Vec<u8>> {
    let size = levels.first().map_or(0, |level| level.size());
    let images = png_faces(levels)?;
    let mut binary = Vec::new();
    let mut views = Vec::new();
    for image in &images {
        views.push(json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": image.len() }));
        binary.extend(image);
        binary.resize(binary.len().next_multiple_of(4), 0);
    }
    let levels: Vec<Vec<usize>> =
        (0..levels.len()).map(|level| (6 * level..6 * level + 6).collect()).collect();
    let light = json!({
        "name": name,
        "intensity": 1.0,
        "rotation": [0.0, 0.0, 0.0, 1.0],
        "irradianceCoefficients": scaled(&sh[..NINE], ShScale::Irradiance),
        "specularImageSize": size,
        "specularImages": levels,
    });
    let root = json!({
        "asset": { "version": "2.0", "generator": SOFTWARE },
        "extensionsUsed": [EXTENSION],
        "extensions": { EXTENSION: { "lights": [light] } },
        "scene": 0,
        "scenes": [{ "extensions": { EXTENSION: { "light": 0 } } }],
        "images": (0..images.len())
            .map(|k| json!({ "bufferView": k, "mimeType": "image/png" }))
            .collect::<Vec<_>>(),
        "bufferViews": views,
        "buffers": [{ "byteLength": binary.len() }],
    });
    glb(&root, &binary)
}

/// glTF 2.0, section 4.4: header, JSON chunk padded by spaces, binary chunk.
fn glb(root: &Value, binary: &[u8]) -> Result<Vec<u8>> {
    let mut text = root.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + text.len() + 8 + binary.len();
    let length = |bytes: usize| {
        u32::try_from(bytes)
            .map_err(|_| Error::Parameter("a .glb holds up to 4 GiB; use a smaller `size`".to_owned()))
    };
    let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
    Ok([
        words(&[0x4654_6c67, 2, length(total)?, length(text.len())?, 0x4e4f_534a]),
        text,
        words(&[length(binary.len())?, 0x004e_4942]),
        binary.to_vec(),
    ]
    .concat())
}
