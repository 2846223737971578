//! How a bake was stored: formats, losses, and the part of the report about its files.

use super::files::Made;
use crate::bake::Bake;
use crate::bake::overflow::clamped_share;
use crate::bake::report::{OutputFileReport, Report, TargetReport};
use crate::format::{Pixel, RGBE_MAX};
use crate::percent::{percent, share_matters};
use crate::target::TargetPlan;

/// What the pixel format made of a bake's light.
#[derive(Clone, Debug)]
pub struct Stored {
    /// Pixel format of each level.
    pub pixels: Vec<String>,
    /// Texels clamped.
    pub clamped: u64,
    /// Greatest share of a level's energy lost to clamping.
    pub clamped_share: f64,
    /// Losses that show, one line each.
    pub warnings: Vec<String>,
}

impl Stored {
    /// Of `bake`, stored by `plan` as the files `made`.
    #[must_use]
    pub fn new(plan: &TargetPlan, bake: &Bake, made: &[Made]) -> Self {
        Self::counted(plan, bake, made.iter().flat_map(|file| &file.clamped).sum())
    }

    /// Of `bake`, stored by `plan` with `clamped` texels.
    #[must_use]
    pub fn counted(plan: &TargetPlan, bake: &Bake, clamped: u64) -> Self {
        let pixel = plan.pixel;
        let pixels: Vec<Pixel> = bake.chain.levels.iter().map(|level| pixel.stored(&level.texels)).collect();
        let clamped_share = clamped_share(bake, pixel);
        let mut warnings = Vec::new();
        if clamped > 0 && pixel == Pixel::Rgbe {
            warnings.push(format!(
                "{clamped} texels exceed the RGBE maximum of {RGBE_MAX:.1e} and were clamped; `container` \
                 exr keeps them",
            ));
        } else if clamped > 0 && share_matters(clamped_share) {
            let remedy = if plan.target.has_container() { "; `pixel` f32 keeps them" } else { "" };
            warnings.push(format!(
                "{clamped} texels exceed the range of {} and were clamped, {} of a level's energy{remedy}",
                pixel.name(),
                percent(clamped_share),
            ));
        }
        let floats = pixels.iter().filter(|pixel| **pixel == Pixel::F32).count();
        if floats > 0 && pixel == Pixel::Auto {
            warnings.push(format!(
                "{floats} of {} levels are stored as float, since they exceed the range of half floats",
                pixels.len()
            ));
        }
        // All light rounds to 0.
        let texels = bake.levels().flat_map(|level| level.texels.as_flattened());
        let (greatest, rounded_to_zero) = (texels.copied().fold(0.0, f32::max), pixel.rounded_to_zero());
        if greatest > 0.0 && greatest <= rounded_to_zero {
            warnings.push(format!(
                "all light is below {}, which rounds {rounded_to_zero:e} and less to 0: the output is black; \
                 `pixel` f32 with ktx2 or exr keeps it",
                pixel.name()
            ));
        }
        let pixels = pixels.iter().map(|pixel| pixel.name().to_owned()).collect();
        Self { pixels, clamped, clamped_share, warnings }
    }
}

/// Records in `report` that `plan` made the files `made`, of the environment called `environment`.
#[must_use]
pub fn recorded(report: Report, plan: &TargetPlan, environment: &str, made: &[Made]) -> Report {
    let output = |file: &Made| OutputFileReport { path: file.path.clone(), bytes: file.bytes.len() as u64 };
    let mut report = Report { outputs: made.iter().map(output).collect(), ..report };
    if plan.is_targeted() {
        report.target = Some(TargetReport {
            name: plan.target.name.to_owned(),
            environment: environment.to_owned(),
            flip: plan.flip.name().to_owned(),
            diffuse: plan.diffuse.name().to_owned(),
            verified: plan.target.verified.is_some(),
            files: made.iter().map(|file| file.path.clone()).collect(),
        });
    } else {
        report.options.out_layout = Some(plan.layout.name().to_owned());
    }
    report
}
