//! Reads pyramids in KTX2 files as cubes of what their look-ups answer, so that every command that knows
//! chains knows them: six roughnesses, [`SIZE`] texels along an edge at the first.

use super::LoadedChain;
use super::key_values::value_of;
use super::picture::check_finite;
use super::pyramid_write::{KEY, VERSION, check_size};
use super::texture::Texture;
use crate::common::error::Result;
use crate::common::parallel;
use crate::light::chain::Level;
use crate::light::environment::{Layout, Rgb};
use crate::pyramid::levels::Map;
use crate::pyramid::light::OctaglossLight;
use crate::pyramid::{BakedPyramid, COARSEST, Octaves, SQUARES, Square};
use glam::{DVec3, Vec3A};
use serde::Deserialize;

/// Texels along an edge of the first cube.
const SIZE: u32 = 256;

/// Cubes.
const LEVELS: u32 = 6;

/// What a file says of its light.
#[derive(Deserialize)]
struct Light {
    version: u32,
    size: u32,
    uniform: Vec<f32>,
}

/// The radiance of a pyramid's look-ups.
pub(super) fn decode_chain(texture: &Texture<'_>) -> Result<LoadedChain> {
    let pyramid = decode(texture)?;
    let level = |number: u32| {
        let roughness = f64::from(number + 1) / f64::from(LEVELS);
        let lobes = pyramid.lobes(roughness as f32);
        let level = cube(SIZE >> number, roughness, |direction| lobes.radiance(direction));
        check_finite(texture.source.path, number, level.size(), &level.texels)?;
        Ok(level)
    };
    let mut loaded = texture.loaded((0..LEVELS).map(level).collect::<Result<_>>()?)?;
    // Mips between these cubes are not what the file's look-ups read.
    loaded.provenance.ladder = None;
    loaded.warnings.push(format!(
        "it is a pyramid: cubes of {SIZE} to {} texels stand for its look-ups at {LEVELS} roughnesses",
        SIZE >> (LEVELS - 1)
    ));
    Ok(loaded)
}

/// The irradiance over pi of a pyramid's look-ups.
pub(super) fn decode_irradiance(texture: &Texture<'_>) -> Result<Level> {
    let pyramid = decode(texture)?;
    let level = cube(COARSEST, 1.0, |direction| pyramid.irradiance(direction));
    check_finite(texture.source.path, 0, level.size(), &level.texels)?;
    Ok(level)
}

/// A cube whose texels are `radiance` around their directions.
fn cube(size: u32, roughness: f64, radiance: impl Fn(DVec3) -> Rgb + Sync) -> Level {
    let (layout, area) = (Layout::Cube { size }, size * size);
    let texel = |k: usize| {
        let k = k as u32;
        let (face, at) = (k / area, k % area);
        radiance(layout.direction_from_texel(face, at % size, at / size))
    };
    Level::cube(size, roughness, parallel::values(6 * area as usize, texel))
}

/// The pyramid of a file.
fn decode(texture: &Texture<'_>) -> Result<BakedPyramid> {
    let wrong = |what: String| texture.source.error(format!("{what}; bake it again with --target pyramid"));
    let text = value_of(&texture.pairs, KEY).unwrap_or_default();
    let light: Light = serde_json::from_str(text).map_err(|error| wrong(format!("{KEY}: {error}")))?;
    if light.version != VERSION {
        return Err(wrong(format!("a pyramid of version {}, not {VERSION}", light.version)));
    }
    let octaves = check_size(light.size)
        .and_then(|()| Octaves::over(light.size))
        .map_err(|_| wrong(format!("{KEY} has size {}", light.size)))?;
    let shape = (texture.width, texture.height, texture.layers, texture.levels as u32);
    let side = octaves.size(0).bordered();
    let expected = match texture.is_cube {
        true => (light.size, light.size, 1, octaves.count() + 2),
        false => (side, side, SQUARES, octaves.mips()),
    };
    if shape != expected {
        let (width, height, layers, levels) = shape;
        return Err(wrong(format!(
            "{layers} images of {width}x{height} with {levels} levels are no pyramid of size {}",
            light.size
        )));
    }
    let (octaves, maps, cosine) = match texture.is_cube {
        true => (octaves.on_cubes(), [cubes(texture)?, Vec::new()], None),
        false => {
            let (maps, cosine) = squares(texture, octaves)?;
            (octaves, maps, Some(cosine))
        }
    };
    let uniform: [f32; size_of::<OctaglossLight>() / 4] = light
        .uniform
        .try_into()
        .map_err(|uniform: Vec<f32>| wrong(format!("{KEY} has {} numbers", uniform.len())))?;
    BakedPyramid::of_parts(octaves, maps, cosine, bytemuck::cast(uniform))
        .map_err(|message| wrong(format!("{KEY}: {message}")))
}

/// The cubes of a file: mirror, sharp level, levels from fine to coarse.
fn cubes(texture: &Texture<'_>) -> Result<Vec<Map>> {
    let cube = |mip: usize| {
        let (size, texels) = (texture.width >> mip, texture.level(mip)?);
        check_finite(texture.source.path, mip as u32, size, &texels)?;
        let texels: Vec<Vec3A> = texels.into_iter().map(Vec3A::from_array).collect();
        Ok(Map::of_cube(size, &texels))
    };
    (0..texture.levels).map(cube).collect()
}

/// The squares of a file in the same order and the middle levels, and the cosine level.
fn squares(texture: &Texture<'_>, octaves: Octaves) -> Result<([Vec<Map>; 2], Map)> {
    let mips = (0..octaves.mips()).map(|mip| {
        let texels = texture.level(mip as usize)?;
        check_finite(texture.source.path, mip, octaves.size(mip).bordered(), &texels)?;
        Ok(texels)
    });
    let mips: Vec<_> = mips.collect::<Result<_>>()?;
    let square = |Square { layer, mip }| {
        let (size, texels) = (octaves.size(mip), &mips[mip as usize]);
        let area = texels.len() / SQUARES as usize;
        Map::of_bordered(size.inner, size.border, &texels[layer as usize * area..][..area])
    };
    let maps = (0..octaves.count() + 2).map(|map| square(octaves.square_of(map))).collect();
    let middles = (0..octaves.middles()).map(|middle| square(octaves.square_of_middle(middle))).collect();
    Ok(([maps, middles], square(octaves.square_of_cosine())))
}
