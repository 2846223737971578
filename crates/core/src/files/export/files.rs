//! Encodes the files of a plan from a bake.

use super::{babylon, gltf, playcanvas, pyramid};
use crate::bake::Bake;
use crate::common::error::{Error, Result, wrong};
use crate::common::parallel;
use crate::files::format::container::Container;
use crate::files::format::{LevelName, Pixel, Shown};
use crate::files::io::cube_write::cube_bytes;
use crate::files::io::exr::parts::mips_bytes;
use crate::files::io::exr::write::{Samples, attributes, exr_bytes};
use crate::files::io::hdr::hdr_bytes;
use crate::files::io::ktx2::write::ROUGHNESS_KEY;
use crate::files::io::layout::image_from_faces;
use crate::files::io::oem_write::oem_bytes;
use crate::files::io::provenance::{IRRADIANCE, RECIPE_KEY, TakenSun};
use crate::files::io::pyramid_write::{cubes_bytes, squares_bytes, tables_bytes};
use crate::files::recipe::source::SunReport;
use crate::files::recipe::{Recipe, fields};
use crate::files::target::{Content, TargetPlan, flipped};
use crate::light::chain::{ChainKind, Level};
use crate::light::environment::Rgb;
use crate::light::sh::scale::{ShScale, scaled};
use crate::light::sh::{name, order_text};
use crate::lobe::Lobe;
use crate::pyramid::BakedPyramid;
use crate::sphere::cube::Face;
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::slice::from_ref;

/// A file in memory.
#[derive(Clone, Debug)]
pub struct Made {
    /// Path in the output's folder.
    pub path: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// Number of texels with a clamped channel, per level; empty if it holds no cube.
    pub clamped: Vec<u64>,
}

/// The text of the shader of that name that reads a file: `octagloss_shaders::reader`. The core hands it on,
/// so that a changed shader does not build it again.
pub type Readers = fn(&str) -> Option<Cow<'static, str>>;

/// Encodes the files of `plan` from `bake` for the environment called `name`. `metadata` are key/value pairs
/// for containers that support them.
///
/// # Errors
/// [`Error::Parameter`] if the container cannot hold the pixel format or the levels, and if the plan requires
/// an irradiance or a sheen cube, or spherical harmonics, that were not baked.
pub fn files(
    plan: &TargetPlan,
    name: &str,
    bake: &Bake,
    metadata: &[(String, String)],
    readers: Readers,
) -> Result<Vec<Made>> {
    plan.check()?;
    if plan.is_targeted() && bake.sh.len() < 9 {
        let count = bake.sh.len();
        return wrong(format!("a bake of {count} spherical harmonics; targets need 9 or more"));
    }
    let levels = &bake.chain.levels;
    plan.check_sizes(levels.first().map_or(0, Level::size), levels.len() as u32)?;
    let bounded: Vec<u32> = (0..).zip(levels).filter(|(_, l)| l.bounds.is_some()).map(|(k, _)| k).collect();
    let make = |(path, content): (String, Content)| {
        let (bytes, clamped) = file_of(plan, name, bake, metadata, readers, (&path, content))?;
        Ok(Made { path, bytes, clamped })
    };
    parallel::map(plan.files(name, levels.len() as u32, &bounded), make).into_iter().collect()
}

/// The bytes of the file at `path` of `plan` with `content`, and its clamped texels as in [`Made`].
fn file_of(
    plan: &TargetPlan,
    name: &str,
    bake: &Bake,
    metadata: &[(String, String)],
    readers: Readers,
    (path, content): (&str, Content),
) -> Result<(Vec<u8>, Vec<u64>)> {
    // Targets with containers of their own have a skybox in another one.
    let own = || Container::of_path(path.as_ref());
    let container =
        if plan.target.has_container() { plan.container } else { own().unwrap_or(plan.container) };
    let pixel = if container.holds(plan.pixel) { plan.pixel } else { Pixel::F16 };
    let cube = |levels: &[Level], sh: bool| {
        let own = match content {
            Content::Sheen => vec![("lobe", json!(Lobe::Charlie)), ("chain", json!(ChainKind::Sampled))],
            Content::Skybox if bake.skybox.is_some() => mirror(),
            Content::Irradiance => irradiated(),
            _ => Vec::new(),
        };
        let mut pairs = Vec::new();
        if plan.container == Container::Ktx1 && sh {
            // Filament's key: nine lines of three numbers; Ktx1Bundle::getSphericalHarmonics reads all 27.
            let line = |[r, g, b]: [f64; 3]| format!("{r:e} {g:e} {b:e}\n");
            let lines = scaled(&bake.sh, ShScale::Filament).into_iter().map(line).collect();
            pairs.push(("sh".to_owned(), lines));
        }
        pairs.extend(of_target(plan, &recorded(metadata, &own)));
        let bytes = cube_bytes(container, &flipped(levels, plan.flip), pixel, &pairs)?;
        Ok((bytes, clamped(levels, pixel)))
    };
    let levels = &bake.chain.levels[..];
    let plain = |bytes: Vec<u8>| (bytes, Vec::new());
    let text = |text: String| plain(text.into_bytes());
    let whole = |bytes: Vec<u8>| (bytes, clamped(levels, plan.pixel));
    Ok(match content {
        Content::ShJson => text(sh_json(plan, bake)),
        Content::ShText => text(sh_text(bake)),
        Content::Specular => cube(levels, plan.diffuse.has_sh())?,
        Content::Skybox => cube(from_ref(skybox(bake)?), false)?,
        Content::SkyboxPanorama => plain(panorama(plan, skybox(bake)?, path, metadata)?),
        Content::Sheen => {
            let sheen = bake.sheen.as_ref().ok_or_else(|| missing("a sheen cube"))?;
            cube(&sheen.levels, false)?
        }
        Content::Irradiance => cube(from_ref(irradiance(bake)?), false)?,
        Content::Oem => whole(oem_bytes(plan.container, levels, plan.pixel, &of_target(plan, metadata))?),
        Content::Pyramid | Content::PyramidCube => {
            let baked = baked_pyramid(bake)?;
            let encode = if content == Content::Pyramid { squares_bytes } else { cubes_bytes };
            plain(encode(baked, plan.pixel, &pyramid::metadata(baked, &of_target(plan, metadata)))?)
        }
        Content::PyramidLight => text(pyramid::light_json(baked_pyramid(bake)?)),
        Content::PyramidTables => plain(tables_bytes(baked_pyramid(bake)?.levels())?),
        Content::PyramidCubeTables => plain(tables_bytes(baked_pyramid(bake)?.levels().on_cubes())?),
        Content::Reader => text(readers(path).expect("a reader of that name").into_owned()),
        Content::Panorama => {
            let level = levels.first().ok_or_else(|| missing("a panorama"))?;
            plain(panorama(plan, level, path, metadata)?)
        }
        Content::Env => whole(babylon::env_bytes(&flipped(levels, plan.flip), &bake.sh, plan.flip)?),
        Content::Glb => whole(gltf::glb_bytes(&flipped(levels, plan.flip), &bake.sh, name)?),
        Content::Atlas => whole(playcanvas::atlas_bytes(
            &flipped(levels, plan.flip),
            &flipped(from_ref(irradiance(bake)?), plan.flip)[0],
        )?),
        Content::Mips => whole(mips_bytes(levels, plan.pixel, metadata)?),
        Content::Image(image) => image_file(plan, bake, metadata, image)?,
    })
}

fn clamped(levels: &[Level], pixel: Pixel) -> Vec<u64> {
    levels.iter().map(|level| pixel.clamped(&level.texels)).collect()
}

fn missing(what: &str) -> Error {
    Error::Parameter(format!("{what} is required but was not baked"))
}

fn baked_pyramid(bake: &Bake) -> Result<&BakedPyramid> {
    bake.pyramid.as_ref().ok_or_else(|| missing("a pyramid"))
}

fn irradiance(bake: &Bake) -> Result<&Level> {
    bake.irradiance.as_ref().ok_or_else(|| missing("an irradiance cube"))
}

/// The unfiltered environment: the requested skybox, else level 0.
fn skybox(bake: &Bake) -> Result<&Level> {
    bake.skybox.as_ref().or(bake.chain.levels.first()).ok_or_else(|| missing("a skybox"))
}

/// Encodes the image `name` of a level.
fn image_file(
    plan: &TargetPlan,
    bake: &Bake,
    metadata: &[(String, String)],
    name: LevelName,
) -> Result<(Vec<u8>, Vec<u64>)> {
    let level = match name.shown {
        Shown::Level(level) => bake.chain.levels.get(level as usize).ok_or_else(|| missing("a level"))?,
        Shown::Irradiance => irradiance(bake)?,
        Shown::Skybox => skybox(bake)?,
    };
    let metadata = &match name.shown {
        Shown::Level(_) => metadata.to_vec(),
        Shown::Irradiance => recorded(metadata, &irradiated()),
        Shown::Skybox => recorded(metadata, &mirror()),
    };
    let (size, area) = (level.size(), level.size() as usize * level.size() as usize);
    let roughness = matches!(name.shown, Shown::Level(_)).then_some(level.roughness);
    // Those of EXR files; bounds beside other levels have none.
    let is_exr = plan.container == Container::Exr;
    let attributes = if is_exr { attributes(roughness, metadata.iter().cloned()) } else { Vec::new() };
    if name.is_bound {
        let bounds = level.bounds.as_ref().ok_or_else(|| missing("a bound"))?;
        let bounds = &bounds[name.face.map_or(0, Face::index) * area..][..area];
        let bytes = exr_bytes(size, size, Samples::Luminance(bounds), Pixel::F32, &attributes)?;
        return Ok((bytes, Vec::new()));
    }
    let (width, texels) = match name.face {
        Some(face) => (size, Cow::Borrowed(level.face(face))),
        None => match image_from_faces(plan.layout, size, &level.texels) {
            Some((width, texels)) => (width, Cow::Owned(texels)),
            None => (level.layout.sides().0, Cow::Borrowed(&level.texels[..])),
        },
    };
    // All faces of a level use the same pixel format.
    let pixel = plan.pixel.stored(&level.texels);
    let height = (texels.len() / width.max(1) as usize) as u32;
    let bytes = match plan.container {
        Container::Exr => exr_bytes(width, height, Samples::Rgb(&texels), pixel, &attributes)?,
        Container::Hdr => {
            let own = roughness.map(|roughness| (ROUGHNESS_KEY.to_owned(), roughness.to_string()));
            let pairs: Vec<_> = own.into_iter().chain(metadata.iter().cloned()).collect();
            hdr_bytes(width, height, &texels, &pairs)?
        }
        other => return wrong(format!("an image of a level is exr or hdr, not {other}")),
    };
    Ok((bytes, vec![pixel.clamped(&texels)]))
}

/// Encodes `level` as one image, with columns shifted for the engine.
fn panorama(plan: &TargetPlan, level: &Level, path: &str, metadata: &[(String, String)]) -> Result<Vec<u8>> {
    let (width, height) = level.layout.sides();
    if !width.is_multiple_of(4) {
        return wrong(format!(
            "target {}: `size` {height} is not even, so its panorama cannot be shifted by quarters",
            plan.target.name
        ));
    }
    let shift = (plan.target.quarter_turns * width / 4) as usize;
    let texels: Vec<Rgb> = level
        .texels
        .chunks_exact(width as usize)
        .flat_map(|row| [&row[row.len() - shift..], &row[..row.len() - shift]].concat())
        .collect();
    let mut pairs = of_target(plan, metadata);
    if shift != 0 {
        pairs = recorded(&pairs, &[("quarter_turns", json!(plan.target.quarter_turns))]);
    }
    if path.ends_with(".hdr") {
        return hdr_bytes(width, height, &texels, &pairs);
    }
    let pixel = if Pixel::F16.clamped(&texels) == 0 { Pixel::F16 } else { Pixel::F32 };
    exr_bytes(width, height, Samples::Rgb(&texels), pixel, &attributes(None, pairs))
}

/// Key/value pairs of every file of a bake by `recipe`, of a source without `suns`.
pub fn metadata(recipe: &Recipe, suns: &[SunReport]) -> Vec<(String, String)> {
    let conventions = "right-handed, y up; faces +X -X +Y -Y +Z -Z as in OpenGL, Vulkan and Direct3D; \
                       linear RGB, Rec. 709; perceptual roughness, alpha = roughness^2";
    let mut record = fields(recipe);
    // The files are the same whatever these are.
    for name in ["scan", "preview", "exposure", "sunless"] {
        record.remove(name);
    }
    record.retain(|_, value| !value.is_null());
    if !suns.is_empty() {
        let taken: Vec<TakenSun> = suns.iter().map(TakenSun::from).collect();
        record.insert("removed_suns".to_owned(), json!(taken));
    }
    vec![
        ("octaglossConventions".to_owned(), conventions.to_owned()),
        (RECIPE_KEY.to_owned(), Value::Object(record).to_string()),
    ]
}

/// Metadata of irradiance cubes: no ladder and no kind of chain.
fn irradiated() -> Vec<(&'static str, Value)> {
    let content = ("content", json!(IRRADIANCE));
    vec![content, ("lobe", json!(Lobe::Cosine)), ("ladder", Value::Null), ("chain", Value::Null)]
}

/// Metadata of skyboxes, whatever the lobe of the levels.
fn mirror() -> Vec<(&'static str, Value)> {
    vec![("lobe", json!(Lobe::Ggx)), ("chain", json!(ChainKind::Sampled))]
}

/// `metadata` with `own` fields of one file in its record of the bake; null removes a field.
fn recorded(metadata: &[(String, String)], own: &[(&str, Value)]) -> Vec<(String, String)> {
    let mut pairs = metadata.to_vec();
    if own.is_empty() {
        return pairs;
    }
    let place = pairs.iter().position(|(key, _)| key == RECIPE_KEY).unwrap_or_else(|| {
        pairs.push((RECIPE_KEY.to_owned(), "{}".to_owned()));
        pairs.len() - 1
    });
    let mut record: Map<String, Value> = serde_json::from_str(&pairs[place].1).unwrap_or_default();
    for (name, value) in own {
        record.insert((*name).to_owned(), value.clone());
    }
    record.retain(|_, value| !value.is_null());
    pairs[place].1 = Value::Object(record).to_string();
    pairs
}

/// `metadata` with the target's name and flip, if there is a target.
fn of_target(plan: &TargetPlan, metadata: &[(String, String)]) -> Vec<(String, String)> {
    if !plan.is_targeted() {
        return metadata.to_vec();
    }
    recorded(metadata, &[("target", json!(plan.target.name)), ("flip", json!(plan.flip))])
}

/// The coefficients in the plan's scaling, with their order.
fn sh_json(plan: &TargetPlan, bake: &Bake) -> String {
    let scale = match plan.target.sh_scale {
        ShScale::Radiance => "radiance, orthonormal basis without the Condon-Shortley phase",
        ShScale::Irradiance => "irradiance, orthonormal basis without the Condon-Shortley phase",
        ShScale::Filament => "irradiance over pi, polynomial of the normal",
    };
    let coefficients = scaled(&bake.sh, plan.target.sh_scale);
    let json = serde_json::json!({
        "order": order_text(coefficients.len()),
        "scale": scale,
        "window": bake.sh_window.to_string(),
        "coefficients": coefficients,
    });
    serde_json::to_string_pretty(&json).expect("keys are strings") + "\n"
}

/// The coefficients in the format of cmgen's sh.txt.
fn sh_text(bake: &Bake) -> String {
    let line = |(index, [r, g, b]): (usize, [f64; 3])| {
        format!("({r:18.15}, {g:18.15}, {b:18.15}); // {}, irradiance, pre-scaled base\n", name(index))
    };
    scaled(&bake.sh, ShScale::Filament).into_iter().enumerate().map(line).collect()
}
