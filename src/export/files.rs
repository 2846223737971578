//! The files of a target, made of a bake.

use super::{babylon, gltf};
use crate::bake::Bake;
use crate::chain::{Chain, Level};
use crate::environment::Rgb;
use crate::error::{Error, Result};
use crate::format::Pixel;
use crate::format::container::Container;
use crate::io::cube_file::CubeFile;
use crate::io::cube_write::cube_bytes;
use crate::io::exr::write::{Attribute, Samples, exr_bytes};
use crate::io::hdr::write::hdr_bytes_with;
use crate::io::oem_write::oem_bytes;
use crate::io::provenance::{Provenance, QUARTER_TURNS_KEY, irradiance_pairs};
use crate::lobe::{LOBE_KEY, Lobe};
use crate::sh::scale::{ShScale, scaled};
use crate::sh::{name, order_text};
use crate::target::{Content, Plan, READERS};

/// A file in memory.
#[derive(Clone, Debug)]
pub struct Made {
    /// Where it belongs in the target's folder.
    pub path: String,
    /// What is in it.
    pub content: Content,
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// Texels with a channel that was clamped, a level each; empty where it holds no cube.
    pub clamped: Vec<u64>,
}

/// The files of `plan` for the environment called `stem`, made of `bake`. `metadata` are key/value pairs for
/// containers that have a place for them.
///
/// # Errors
/// [`Error::Parameter`] where the container cannot hold the pixels or the levels, and where the plan asks for
/// an irradiance or a sheen cube that was not baked.
pub fn files(plan: &Plan, stem: &str, bake: &Bake, metadata: &[(String, String)]) -> Result<Vec<Made>> {
    plan.check()?;
    let make = |(path, content): (String, Content)| {
        let cube = |levels: &[Level], sh: bool| {
            let chain = Chain { levels: levels.iter().map(|level| plan.flip.level(level)).collect() };
            let mut pairs = cube_metadata(plan, bake, metadata, sh);
            match content {
                Content::Sheen => {
                    let lobe = pairs.iter_mut().filter(|(key, _)| key == LOBE_KEY);
                    lobe.for_each(|(_, value)| Lobe::Charlie.name().clone_into(value));
                }
                Content::Irradiance => pairs = irradiance_pairs(&pairs),
                _ => {}
            }
            cube_bytes(plan.container, &chain, plan.pixel, &pairs)
        };
        let missing = |what: &str| Error::Parameter(format!("{what} is to be written that was not baked"));
        let text = |text: String| CubeFile { bytes: text.into_bytes(), clamped: Vec::new() };
        let file = match content {
            Content::ShJson => text(sh_json(plan, bake)),
            Content::ShText => text(sh_text(bake)),
            Content::Specular => cube(&bake.chain.levels, plan.diffuse.has_sh())?,
            Content::Skybox => cube(&bake.chain.levels[..1], false)?,
            Content::Sheen => {
                let sheen = bake.sheen.as_ref().ok_or_else(|| missing("a sheen cube"))?;
                cube(&sheen.levels, false)?
            }
            Content::Irradiance => {
                let level = bake.irradiance.as_ref().ok_or_else(|| missing("an irradiance cube"))?;
                cube(std::slice::from_ref(level), false)?
            }
            Content::Oem => {
                oem_bytes(plan.container, &bake.chain.levels, plan.pixel, &of_target(plan, metadata))?
            }
            Content::Reader => {
                let (_, code) =
                    READERS.iter().find(|(name, _)| *name == path).expect("a reader of that name");
                text((*code).to_owned())
            }
            Content::Panorama => {
                CubeFile { bytes: panorama(plan, bake, &path, metadata)?, clamped: Vec::new() }
            }
            Content::Env => babylon::env_bytes(&plan.flip.chain(&bake.chain), &bake.sh, plan.flip)?,
            Content::Glb => gltf::glb_bytes(&plan.flip.chain(&bake.chain), &bake.sh, stem)?,
        };
        Ok(Made { path, content, bytes: file.bytes, clamped: file.clamped })
    };
    plan.files(stem).into_iter().map(make).collect()
}

/// Level 0 as one image, its columns where the engine looks for them.
fn panorama(plan: &Plan, bake: &Bake, path: &str, metadata: &[(String, String)]) -> Result<Vec<u8>> {
    let level = bake
        .chain
        .levels
        .first()
        .ok_or_else(|| Error::Parameter("a panorama is to be written that was not baked".to_owned()))?;
    let (width, height) = level.layout.sides();
    if !width.is_multiple_of(4) {
        return Err(Error::Parameter(format!(
            "target {}: --size {height} is not even, and its panorama cannot be turned by quarters",
            plan.target.name
        )));
    }
    let shift = (plan.target.quarter_turns * width / 4) as usize;
    let texels: Vec<Rgb> = level
        .texels
        .chunks_exact(width as usize)
        .flat_map(|row| [&row[row.len() - shift..], &row[..row.len() - shift]].concat())
        .collect();
    let mut pairs = of_target(plan, metadata);
    if shift != 0 {
        pairs.push((QUARTER_TURNS_KEY.to_owned(), plan.target.quarter_turns.to_string()));
    }
    if path.ends_with(".hdr") {
        return hdr_bytes_with(width, height, &texels, &pairs);
    }
    let attributes: Vec<_> = pairs.into_iter().map(|(key, text)| (key, Attribute::Text(text))).collect();
    let pixel = if Pixel::F16.clamped(&texels) == 0 { Pixel::F16 } else { Pixel::F32 };
    exr_bytes(width, height, Samples::Rgb(&texels), pixel, &attributes)
}

/// What a cube says of itself: `metadata` with the target and its flip, in KTX Filament's key for spherical
/// harmonics as well.
fn cube_metadata(plan: &Plan, bake: &Bake, metadata: &[(String, String)], sh: bool) -> Vec<(String, String)> {
    let mut pairs = Vec::new();
    if plan.container == Container::Ktx1 && sh {
        // Nine lines of three numbers; Ktx1Bundle::getSphericalHarmonics reads 27 of them.
        let line = |[r, g, b]: [f64; 3]| format!("{r:e} {g:e} {b:e}\n");
        let lines = scaled(&bake.sh, ShScale::Filament).into_iter().map(line).collect();
        pairs.push(("sh".to_owned(), lines));
    }
    pairs.extend(of_target(plan, metadata));
    pairs
}

/// `metadata` with the target's name and its flip.
fn of_target(plan: &Plan, metadata: &[(String, String)]) -> Vec<(String, String)> {
    let own = Provenance {
        target: Some(plan.target.name.to_owned()),
        flip: Some(plan.flip),
        ..Provenance::default()
    };
    metadata.iter().cloned().chain(own.pairs()).collect()
}

/// The coefficients in the plan's scaling, and which is which.
fn sh_json(plan: &Plan, bake: &Bake) -> String {
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

/// As cmgen prints them into sh.txt.
fn sh_text(bake: &Bake) -> String {
    let line = |(index, [r, g, b]): (usize, [f64; 3])| {
        format!("({r:18.15}, {g:18.15}, {b:18.15}); // {}, irradiance, pre-scaled base\n", name(index))
    };
    scaled(&bake.sh, ShScale::Filament).into_iter().enumerate().map(line).collect()
}
