//! Every option of a bake as one value, and what it makes of a source: files, reports and pictures.

pub use octagloss_core::common::error::with_settings;
pub use octagloss_core::files::export::produce::{
    Baked, Product, Products, SunFile, json_bytes, name, report_path,
};
pub use octagloss_core::files::export::report::{
    EnergyReport, FingerprintReport, LevelReport, OemReport, OutputFileReport, Report, ShReport, TargetReport,
};
pub use octagloss_core::files::image::exposure::Exposure;
pub use octagloss_core::files::recipe::plan::BakePlan;
pub use octagloss_core::files::recipe::source::{InputFileReport, Source, SunReport};
pub use octagloss_core::files::recipe::{InputOptions, Recipe, TableOptions, from_json};

use crate::{BakeSettings, Result};
use octagloss_core::files::export::produce;
use octagloss_shaders::reader;
use web_time::Instant;

/// Makes everything that `recipe` asks for from `source`; `bake` bakes it with the given settings. `start` is
/// when the source began to be read.
///
/// # Errors
/// Those of [`Recipe::plans`], of `bake`, and of [`products`].
pub fn produce(
    recipe: &Recipe,
    source: &Source,
    start: Instant,
    bake: impl FnOnce(&[BakeSettings]) -> Result<Baked>,
) -> Result<Products> {
    produce::produce(recipe, source, start, reader, bake)
}

/// Makes the files of `plans`, which are settled for `source`, from their bakes, for an output called `name`.
/// `start` is when the source began to be read.
///
/// # Errors
/// [`crate::Error::Parameter`] for no plans, for other than one sound bake for each, for light that
/// [`crate::files::Overflow::Error`] refuses, and for levels that a container cannot hold;
/// [`crate::Error::NonFiniteResult`] for a report with NaN.
pub fn products(
    plans: &[BakePlan],
    source: &Source,
    baked: Baked,
    name: &str,
    start: Instant,
) -> Result<Products> {
    produce::products(plans, source, baked, name, start, reader)
}
