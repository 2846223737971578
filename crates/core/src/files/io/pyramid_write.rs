//! Writes pyramids as KTX2 files that shaders read: `shaders/common/pyramid_file.wgsl`.
//!
//! The maps are an array of three bordered octahedral squares with MIP levels: the mirror, then the Gaussians
//! from fine to coarse, three a MIP level; the last MIP level of the last one has the cosine. The rest is
//! black. Borders halve with the MIP levels, down to one texel.
//!
//! On a cube each MIP level has one: the mirror, then the Gaussians from fine to coarse.
//!
//! The tables, the same for all environments of one size and map, are half floats: the layers of the table of
//! reflections stand side by side, with a column on either side and a row below that repeat their edges, for
//! samplers that round; then come five rows with the weights of radiance, then the albedo, row after row.
//!
//! Reflections along a tangent have a table of their own, of three dimensions.

use super::ktx2::write::{TextureShape, format_of, halves_file, ktx2_file};
use crate::common::error::{Result, wrong};
use crate::files::format::Pixel;
use crate::files::format::texel_bytes::texel_bytes;
use crate::files::target::PyramidMap;
use crate::light::environment::Rgb;
use crate::pyramid::fit::{self, WEIGHTS};
use crate::pyramid::levels::Map;
use crate::pyramid::reads::{LAYERS, NODES, table};
use crate::pyramid::{BakedPyramid, Levels, SMALLEST, SQUARES, Square, albedo, anisotropic};
use ktx2::Format;

/// Key of the light in the maps' metadata, and a version that changes with the layout of the files.
pub(crate) const KEY: &str = "octaglossPyramid";
pub(crate) const VERSION: u32 = 4;

/// Texels along an edge of the smallest map: over a smaller one, mirror and cosine were one MIP level.
pub(crate) const LEAST: u32 = 2 * SMALLEST;

/// Rows of the table's weights.
const WEIGHT_ROWS: usize = WEIGHTS / 4;

/// Encodes the maps of `baked`. `metadata` are text key/value pairs.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for a map of less than 64 texels, for pixels that KTX2 cannot
/// hold or that end below the light of half floats, and for keys that it cannot hold.
pub(crate) fn squares_bytes(
    baked: &BakedPyramid,
    pixel: Pixel,
    metadata: &[(String, String)],
) -> Result<Vec<u8>> {
    let pyramid = &baked.pyramid;
    let levels = pyramid.levels();
    check_size(levels.inner())?;
    let [mips, layers] = [levels.mips() as usize, SQUARES as usize];
    let mut squares = vec![vec![None; layers]; mips];
    let mut put = |square: Square, map| squares[square.mip as usize][square.layer as usize] = map;
    (0..).zip(pyramid.maps()).for_each(|(k, map)| put(levels.square_of(k), Some(map)));
    put(levels.square_of_cosine(), pyramid.cosine());
    let bordered = |mip: usize| -> Vec<Rgb> {
        let size = levels.size(mip as u32);
        let texels = |map: &Option<&Map>| match map {
            Some(map) => map.with_border(size.border),
            None => vec![[0.0; 3]; size.bordered() as usize * size.bordered() as usize],
        };
        squares[mip].iter().flat_map(texels).collect()
    };
    let flat = TextureShape::flat(format_of(pixel)?, [levels.size(0).bordered(); 2], mips);
    let shape = TextureShape { layers: SQUARES, ..flat };
    packed(&shape, metadata, |mip| texel_bytes(levels.size(mip as u32).bordered(), &bordered(mip), pixel))
}

/// Encodes the maps of `baked` as one cube.
///
/// # Errors
/// As [`squares_bytes`].
pub(crate) fn cubes_bytes(
    baked: &BakedPyramid,
    pixel: Pixel,
    metadata: &[(String, String)],
) -> Result<Vec<u8>> {
    check_size(baked.levels().inner())?;
    let pyramid = baked.pyramid.on_cubes();
    let maps = pyramid.maps();
    let flat = TextureShape::flat(format_of(pixel)?, [maps[0].inner(); 2], maps.len());
    let shape = TextureShape { faces: 6, ..flat };
    packed(&shape, metadata, |mip| texel_bytes(maps[mip].inner(), &maps[mip].faces(), pixel))
}

/// The file of `shape` whose MIP levels are `texels`.
fn packed(
    shape: &TextureShape,
    metadata: &[(String, String)],
    texels: impl Fn(usize) -> Vec<u8>,
) -> Result<Vec<u8>> {
    let pairs: Vec<(&str, &str)> = metadata.iter().map(|(key, value)| (&key[..], &value[..])).collect();
    ktx2_file(shape, &pairs, texels)
}

/// Checks that a map of `inner` texels along an edge can be written.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if it has no pyramid, or one of a single level.
pub fn check_size(inner: u32) -> Result<()> {
    match Levels::over(inner) {
        Ok(_) if inner >= LEAST => Ok(()),
        _ => wrong(format!(
            "a `size` of {inner} has no pyramid to write; choose a power of two from {LEAST} to {}",
            Levels::LARGEST
        )),
    }
}

/// Encodes the tables for pyramids of `levels`.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if compression fails.
pub(crate) fn tables_bytes(levels: Levels) -> Result<Vec<u8>> {
    let ([across, rows], side) = (NODES, NODES[0] + 2);
    let nodes = table(levels);
    let width = side * LAYERS;
    let albedo = albedo::texels();
    let height = rows + 1 + WEIGHT_ROWS + albedo.len().div_ceil(width);
    let mut texels = vec![[0.0; 4]; width * height];
    let (reflections, rest) = texels.split_at_mut(width * (rows + 1));
    let (radiance, white) = rest.split_at_mut(width * WEIGHT_ROWS);
    white[..albedo.len()].copy_from_slice(&albedo);
    for (k, texel) in reflections.iter_mut().enumerate() {
        let (x, y) = (k % width, k / width);
        let column = (x % side).clamp(1, across) - 1;
        *texel = nodes[y.min(rows - 1) * across + column][x / side];
    }
    for (k, node) in fit::table(levels).iter().enumerate() {
        for (row, texel) in node.as_chunks::<4>().0.iter().enumerate() {
            radiance[row * width + k] = *texel;
        }
    }
    let sides = [width as u32, height as u32, 0];
    let map = if levels.is_cube() { PyramidMap::Cube } else { PyramidMap::Octahedral };
    let content = format!("tables of {map} pyramids over maps of {}", levels.inner());
    halves_file(Format::R16G16B16A16_SFLOAT, sides, texels.as_flattened(), &content)
}

/// The KTX2 file that shaders of `--target pyramid` read as `octagloss_rows`: the table of reflections along
/// a tangent, for pyramids on `map` over maps of `size` texels along an edge. A texture of three dimensions
/// in RGBA16F, 2.0 MB, which takes eight seconds of one core.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for a `size` that is not a power of two from 64 to 2048.
pub fn anisotropic_table(size: u32, map: PyramidMap) -> Result<Vec<u8>> {
    check_size(size)?;
    let levels = Levels::over(size)?;
    let levels = if map == PyramidMap::Cube { levels.on_cubes() } else { levels };
    let texels = anisotropic::texels(levels);
    let content = format!("table of anisotropic reflections from {map} pyramids over maps of {size}");
    halves_file(Format::R16G16B16A16_SFLOAT, anisotropic::TEXTURE, texels.as_flattened(), &content)
}
