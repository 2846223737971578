//! Babylon.js's `.env`: eight bytes, a JSON header, RGBD images as PNG.
//!
//! packages/dev/core/src/Misc/environmentTextureTools.ts (`GetEnvInfo`, `CreateEnvTextureAsync`): mipmaps
//! from the largest down to one texel, six faces each in the order of the cube map, at positions counted from
//! the header's end. Images are vertically flipped: the reader draws them into a render target, whose rows
//! run upwards.

use crate::common::error::Result;
use crate::common::parallel;
use crate::files::format::container::ENV_MAGIC;
use crate::files::format::rgbd::rgbd_png_bytes;
use crate::files::target::Flip;
use crate::light::chain::Level;
use crate::light::sh::scale::{ShScale, scaled};
use crate::sphere::cube::Face;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Encodes an `.env` of `levels`, already flipped by `flip`, and the harmonics `sh` of the environment's
/// radiance.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for faces that PNG cannot hold.
pub(crate) fn env_bytes(levels: &[Level], sh: &[[f64; 3]], flip: Flip) -> Result<Vec<u8>> {
    let size = levels.first().map_or(0, |level| level.size());
    let images = png_faces(levels)?;
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
    Ok(bytes)
}

/// Encodes every face of every level as PNG, rows upwards.
pub(crate) fn png_faces(levels: &[Level]) -> Result<Vec<Vec<u8>>> {
    let faces = levels.iter().flat_map(|level| Face::ALL.map(|face| (level.size(), level.face(face))));
    let png = |(size, texels): (u32, &[[f32; 3]])| {
        let texels: Vec<_> = texels.chunks_exact(size as usize).rev().flatten().copied().collect();
        rgbd_png_bytes(size, &texels)
    };
    parallel::map(faces, png).into_iter().collect()
}

/// Babylon.js's `SphericalPolynomial`: x, y, z, their squares and products, without a constant.
///
/// packages/dev/core/src/Maths/sphericalPolynomial.ts: `FromHarmonics` scales the harmonics of irradiance
/// over pi by the cosine a second time. `FromPolynomial` divides by it before materials evaluate the
/// harmonics (harmonicsFunctions.fx with `SPHERICAL_HARMONICS`, their default).
fn polynomial(sh: &[[f64; 3]], flip: Flip) -> Value {
    let over_pi: Vec<_> = scaled(sh, ShScale::Irradiance).iter().map(|rgb| rgb.map(|c| c / PI)).collect();
    let scaled = scaled(&over_pi, ShScale::Filament);
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
    use crate::light::sh::scale::filament_irradiance;
    use glam::DVec3;

    /// Irradiance over pi as the engine's materials evaluate it: `FromPolynomial`, `preScaleForRendering` and
    /// `computeEnvironmentIrradiance`, whose signs cancel.
    fn evaluated(json: &Value, c: usize, n: DVec3) -> f64 {
        let of = |key: &str| json[key][c].as_f64().unwrap();
        let [xx, yy, zz] = ["xx", "yy", "zz"].map(of);
        let linear = 0.977_204 * (3.0 / (4.0 * PI)).sqrt();
        let quadratic = 1.165_38 * (15.0 / (4.0 * PI)).sqrt();
        PI * (0.376_127 * (xx + yy + zz) * (1.0 / (4.0 * PI)).sqrt()
            + linear * (of("y") * n.y + of("z") * n.z + of("x") * n.x)
            + quadratic * (of("xy") * n.x * n.y + of("yz") * n.y * n.z + of("zx") * n.z * n.x)
            + 1.345_67 * (zz - (xx + yy) / 2.0) * (5.0 / (16.0 * PI)).sqrt() * (3.0 * n.z * n.z - 1.0)
            + quadratic / 2.0 * (xx - yy) * (n.x * n.x - n.y * n.y))
    }

    #[test]
    fn the_polynomial_gives_irradiance_in_materials() {
        let sh: [[f64; 3]; 9] = std::array::from_fn(|k| [1.0 + k as f64, (k as f64).sin(), -0.3 * k as f64]);
        let filament = scaled(&sh, ShScale::Filament);
        for flip in [Flip::None, Flip::X, Flip::Z] {
            let json = polynomial(&sh, flip);
            for normal in [DVec3::X, DVec3::NEG_Z, DVec3::new(2.0, -3.0, 6.0) / 7.0] {
                let expected = filament_irradiance(&filament, normal);
                for (c, expected) in expected.iter().enumerate() {
                    // Every constant of the engine is rounded by less than 2e-6 of itself, and the terms sum
                    // to less than 10.
                    let error = evaluated(&json, c, flip.apply(normal)) - expected;
                    assert!(error.abs() < 2e-5, "{flip:?} {normal} {c}: {error}");
                }
            }
        }
    }
}
