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
use crate::pyramid::{BakedPyramid, Levels, SMALLEST, SQUARES, Square};
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
    let level = cube(SMALLEST, 1.0, |direction| pyramid.irradiance(direction));
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
    let levels = check_size(light.size)
        .and_then(|()| Levels::over(light.size))
        .map_err(|_| wrong(format!("{KEY} has size {}", light.size)))?;
    let levels = if texture.is_cube { levels.on_cubes() } else { levels };
    let shape = (texture.width, texture.height, texture.layers, texture.levels as u32);
    let side = levels.size(0).bordered();
    let expected = match texture.is_cube {
        true => (light.size, light.size, 1, levels.count()),
        false => (side, side, SQUARES, levels.mips()),
    };
    if shape != expected {
        let (width, height, layers, mips) = shape;
        return Err(wrong(format!(
            "{layers} images of {width}x{height} with {mips} levels are no pyramid of size {}",
            light.size
        )));
    }
    let (maps, cosine) = match texture.is_cube {
        true => (cubes(texture)?, None),
        false => squares(texture, levels)?,
    };
    let uniform: [f32; size_of::<OctaglossLight>() / 4] = light
        .uniform
        .try_into()
        .map_err(|uniform: Vec<f32>| wrong(format!("{KEY} has {} numbers", uniform.len())))?;
    BakedPyramid::of_parts(levels, maps, cosine, bytemuck::cast(uniform))
        .map_err(|message| wrong(format!("{KEY}: {message}")))
}

/// The cubes of a file: the mirror, then Gaussians from fine to coarse.
fn cubes(texture: &Texture<'_>) -> Result<Vec<Map>> {
    let cube = |mip: usize| {
        let (size, texels) = (texture.width >> mip, texture.level(mip)?);
        check_finite(texture.source.path, mip as u32, size, &texels)?;
        let texels: Vec<Vec3A> = texels.into_iter().map(Vec3A::from_array).collect();
        Ok(Map::of_cube(size, &texels))
    };
    (0..texture.levels).map(cube).collect()
}

/// The squares of a file in the same order, and the cosine level.
fn squares(texture: &Texture<'_>, levels: Levels) -> Result<(Vec<Map>, Option<Map>)> {
    let mips = (0..levels.mips()).map(|mip| {
        let texels = texture.level(mip as usize)?;
        check_finite(texture.source.path, mip, levels.size(mip).bordered(), &texels)?;
        Ok(texels)
    });
    let mips: Vec<_> = mips.collect::<Result<_>>()?;
    let square = |Square { layer, mip }| {
        let (size, texels) = (levels.size(mip), &mips[mip as usize]);
        let area = texels.len() / SQUARES as usize;
        Map::of_bordered(size.inner, size.border, &texels[layer as usize * area..][..area])
    };
    let maps = (0..levels.count()).map(|map| square(levels.square_of(map))).collect();
    Ok((maps, Some(square(levels.square_of_cosine()))))
}
