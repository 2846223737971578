//! The files of a target, made of a bake.

use super::{Content, Plan};
use crate::bake::Bake;
use crate::chain::{CubeChain, CubeLevel};
use crate::error::{Error, Result};
use crate::io::cube_write::{Container, cube_bytes};
use crate::lobe::{LOBE_KEY, Lobe};
use crate::sh::{name, order_text};
use crate::sh_scale::{ShScale, scaled};

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

/// The files of `plan` for the environment called `stem`, made of `bake`. `metadata` are key/value pairs for containers that
/// have a place for them.
///
/// # Errors
/// [`Error::Parameter`] where the container cannot hold the pixels or the levels, and where the plan asks for an
/// irradiance or a sheen cube that was not baked.
pub fn files(plan: &Plan, stem: &str, bake: &Bake, metadata: &[(String, String)]) -> Result<Vec<Made>> {
    plan.check()?;
    let make = |(path, content): (String, Content)| {
        let cube = |levels: &[CubeLevel], sh: bool| {
            let chain = CubeChain { levels: levels.iter().map(|level| plan.flip.level(level)).collect() };
            let mut pairs = cube_metadata(plan, bake, metadata, sh);
            if content == Content::Sheen {
                let lobe = pairs.iter_mut().filter(|(key, _)| key == LOBE_KEY);
                lobe.for_each(|(_, value)| Lobe::Charlie.name().clone_into(value));
            }
            cube_bytes(plan.container, &chain, plan.pixel, &pairs)
        };
        let missing = |what: &str| Error::Parameter(format!("{what} is to be written that was not baked"));
        let (bytes, clamped) = match content {
            Content::ShJson => (sh_json(plan, bake).into_bytes(), Vec::new()),
            Content::ShText => (sh_text(bake).into_bytes(), Vec::new()),
            Content::Specular | Content::Skybox | Content::Sheen | Content::Irradiance => {
                let file = match content {
                    Content::Specular => cube(&bake.chain.levels, plan.diffuse.has_sh())?,
                    Content::Skybox => cube(&bake.chain.levels[..1], false)?,
                    Content::Sheen => {
                        let sheen = bake.sheen.as_ref().ok_or_else(|| missing("a sheen cube"))?;
                        cube(&sheen.levels, false)?
                    }
                    _ => {
                        let level = bake.irradiance.as_ref().ok_or_else(|| missing("an irradiance cube"))?;
                        cube(std::slice::from_ref(level), false)?
                    }
                };
                (file.bytes, file.clamped)
            }
        };
        Ok(Made { path, content, bytes, clamped })
    };
    plan.files(stem).into_iter().map(make).collect()
}

/// What the container tells: Filament's key for spherical harmonics, or our own pairs.
fn cube_metadata(plan: &Plan, bake: &Bake, metadata: &[(String, String)], sh: bool) -> Vec<(String, String)> {
    match plan.container {
        Container::Ktx1 => {
            // Nine lines of three numbers; Ktx1Bundle::getSphericalHarmonics reads 27 of them.
            let line = |[r, g, b]: [f64; 3]| format!("{r:e} {g:e} {b:e}\n");
            let lines = scaled(&bake.sh, ShScale::Filament).into_iter().map(line).collect();
            if sh { vec![("sh".to_owned(), lines)] } else { Vec::new() }
        }
        Container::Ktx2 | Container::Dds => {
            let mut pairs = metadata.to_vec();
            pairs.push(("octaglossTarget".to_owned(), plan.target.name.to_owned()));
            pairs.push(("octaglossFlip".to_owned(), plan.flip.name().to_owned()));
            pairs
        }
    }
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
