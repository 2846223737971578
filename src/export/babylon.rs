//! Babylon.js's `.env`: eight bytes, a JSON header, RGBD images as PNG.
//!
//! packages/dev/core/src/Misc/environmentTextureTools.ts (`GetEnvInfo`, `CreateEnvTextureAsync`): mipmaps
//! from the largest down to one texel, six faces each in the order of the cube map, at positions counted from
//! the header's end. Images are vertically flipped: the reader draws them into a render target, whose rows
//! run upwards.

use crate::chain::Chain;
use crate::error::Result;
use crate::format::Pixel;
use crate::format::container::ENV_MAGIC;
use crate::format::rgbd::rgbd_png_bytes;
use crate::io::cube_file::CubeFile;
use crate::sh::scale::{ShScale, scaled};
use crate::sphere::cube::Face;
use crate::target::Flip;
use crate::target::sizes::check_env;
use rayon::prelude::*;
use serde_json::{Value, json};

/// Encodes an `.env` of `chain`, already flipped by `flip`, and the harmonics `sh` of the environment's
/// radiance.
///
/// # Errors
/// [`crate::Error::Parameter`] for a size that is not a power of two, and for missing levels.
pub(crate) fn env_bytes(chain: &Chain, sh: &[[f64; 3]], flip: Flip) -> Result<CubeFile> {
    let size = chain.levels.first().map_or(0, |level| level.size());
    check_env(size, chain.levels.len() as u32)?;
    let images = png_faces(chain)?;
    let mut position = 0;
    let mipmaps: Vec<Value> = images
        .iter()
        .map(|image| {
            let place = json!({ "length": image.len(), "position": position });
            position += image.len();
            place
        })
        .collect();
    let manifest = json!({
        "version": 1,
        "width": size,
        "irradiance": polynomial(sh, flip),
        "specular": { "mipmaps": mipmaps, "lodGenerationScale": 0.8 },
    });
    let mut bytes = ENV_MAGIC.to_vec();
    bytes.extend(manifest.to_string().as_bytes());
    bytes.push(0);
    bytes.extend(images.concat());
    Ok(CubeFile { bytes, clamped: clamped(chain) })
}

/// Number of texels that RGBD clamps, per level.
pub(crate) fn clamped(chain: &Chain) -> Vec<u64> {
    chain.levels.iter().map(|level| Pixel::Rgbd.clamped(&level.texels)).collect()
}

/// Encodes every face of every level as PNG, rows upwards.
pub(crate) fn png_faces(chain: &Chain) -> Result<Vec<Vec<u8>>> {
    let faces: Vec<_> = chain
        .levels
        .iter()
        .flat_map(|level| Face::ALL.map(|face| (level.size(), level.face(face))))
        .collect();
    let png = |(size, texels): (u32, &[[f32; 3]])| {
        let texels: Vec<_> = texels.chunks_exact(size as usize).rev().flatten().copied().collect();
        rgbd_png_bytes(size, &texels)
    };
    faces.into_par_iter().map(png).collect()
}

/// Irradiance over pi as Babylon.js's `SphericalPolynomial`: x, y, z, their squares and products, without a
/// constant.
fn polynomial(sh: &[[f64; 3]], flip: Flip) -> Value {
    let scaled = scaled(sh, ShScale::Filament);
    let [one, y, z, x, xy, yz, zonal, zx, squares] = std::array::from_fn(|k| scaled[k]);
    let combined =
        |a: f64, b: f64| -> [f64; 3] { std::array::from_fn(|c| one[c] + a * zonal[c] + b * squares[c]) };
    let turned = flip.apply(glam::DVec3::ONE);
    let times = |rgb: [f64; 3], sign: f64| rgb.map(|c| c * sign);
    json!({
        "x": times(x, turned.x),
        "y": times(y, turned.y),
        "z": times(z, turned.z),
        // The constant is distributed over the squares, whose sum is 1.
        "xx": combined(-1.0, 1.0),
        "yy": combined(-1.0, -1.0),
        "zz": combined(2.0, 0.0),
        "yz": times(yz, turned.y * turned.z),
        "zx": times(zx, turned.z * turned.x),
        "xy": times(xy, turned.x * turned.y),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sh::scale::filament_irradiance;
    use glam::DVec3;

    #[test]
    fn the_polynomial_is_filaments_in_other_terms() {
        let sh: [[f64; 3]; 9] = std::array::from_fn(|k| [1.0 + k as f64, (k as f64).sin(), -0.3 * k as f64]);
        let filament = scaled(&sh, ShScale::Filament);
        for flip in [Flip::None, Flip::X, Flip::Z] {
            let json = polynomial(&sh, flip);
            for normal in [DVec3::X, DVec3::NEG_Z, DVec3::new(2.0, -3.0, 6.0) / 7.0] {
                let n = flip.apply(normal);
                let terms = [("x", n.x), ("y", n.y), ("z", n.z), ("xx", n.x * n.x), ("yy", n.y * n.y)];
                let more = [("zz", n.z * n.z), ("yz", n.y * n.z), ("zx", n.z * n.x), ("xy", n.x * n.y)];
                let value = |c: usize| -> f64 {
                    terms.iter().chain(&more).map(|(key, t)| json[key][c].as_f64().unwrap() * t).sum()
                };
                let expected = filament_irradiance(&filament, normal);
                for (c, expected) in expected.iter().enumerate() {
                    assert!((value(c) - expected).abs() < 1e-12, "{flip:?} {normal} {c}");
                }
            }
        }
    }
}
