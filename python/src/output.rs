//! Files of a bake.

use crate::errors::{raised, wrong};
use crate::work::Cancel;
use octagloss::files::{Container, Existing, check_file, check_folder, recover, write_files};
use octagloss::recipes::{BakePlan, Baked, Recipe, Source, json_bytes, name, products};
use octagloss::{Bake, Result};
use pyo3::prelude::*;
use std::path::Path;
use std::time::Instant;

/// The plan of `recipe` for `source`, written to `path`.
pub(crate) fn planned(py: Python<'_>, path: &Path, recipe: &Recipe, source: &Source) -> PyResult<BakePlan> {
    let mut recipe = Recipe { input: source.options.clone(), ..recipe.clone() };
    let named = Container::of_path(path);
    if recipe.target.is_empty() {
        if recipe.name.is_some() {
            return Err(wrong("`name` is for targets; omit it"));
        }
        recipe.format = recipe.format.or(named);
        if recipe.format.is_none() {
            return Err(wrong(format!(
                "{}: the name ends in none of .ktx2 .ktx .dds; set `container`",
                path.display()
            )));
        }
    }
    let mut plans = recipe.plans().map_err(|error| raised(py, &error))?;
    let plan = plans.pop().expect("one target").settled(source.environment.layout());
    if !plan.is_file() && named.is_some() {
        return Err(wrong(format!(
            "{}: the output is a folder of files; omit the extension",
            path.display()
        )));
    }
    Ok(plan)
}

/// Fails where writing the files of `plan` would, as far as can be known before a bake.
pub(crate) fn check(path: &Path, plan: &BakePlan, force: bool) -> Result<()> {
    recover(path);
    let existing = Existing::by_force(force);
    if plan.is_file() { check_file(path, existing) } else { check_folder(path, existing) }
}

/// Writes the files of `bake`, which took `seconds`, and for a target its report; returns warnings, one line
/// each.
pub(crate) fn write(
    bake: &Bake,
    seconds: f64,
    plan: &BakePlan,
    source: &Source,
    path: &Path,
    force: bool,
    cancel: &Cancel,
) -> Result<Vec<String>> {
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    let name = if plan.is_file() { file.into_owned() } else { name(plan, source) };
    let baked = Baked::on_cpu(vec![bake.clone()]);
    let mut products = products(std::slice::from_ref(plan), source, baked, &name, Instant::now())?;
    let product = &mut products.per_plan[0];
    product.report.seconds = seconds;
    let report = json_bytes(&product.report)?;
    let report = plan.plan.is_targeted().then(|| ("report.json".to_owned(), &report[..]));
    let files = product.made.iter().map(|made| (made.path.clone(), &made.bytes[..])).chain(report);
    cancel.check()?;
    write_files(path, plan.is_file(), files, Existing::by_force(force))?;
    Ok(std::mem::take(&mut product.losses))
}
