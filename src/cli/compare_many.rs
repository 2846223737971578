//! `octagloss compare FOLDER SOURCES`: judges the bakes of several environments.

use super::args::CompareArgs;
use super::compare_sources::Sources;
use super::comparison::{Comparison, against_source, bake_in};
use super::console::{self, Console};
use super::expand::{Expansion, expand};
use super::gate::Verdict;
use super::input::{InputFiles, named_sources};
use super::look_ups::channel;
use super::measures::Measures;
use super::outcome::{Failure, Outcome, failed, print, refuse_given};
use crate::targets::Target;
use octagloss_core::files::io;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Extensions of bakes in one file.
const FILES: [&str; 4] = ["ktx2", "ktx", "dds", "exr"];

/// Whether `path` is a folder that holds bakes but is none.
pub(super) fn is_folder_of_bakes(path: &Path) -> bool {
    path.is_dir() && !io::is_bake_folder(path)
}

/// Compares every bake in the folder with its source: a line each, and one exit status.
pub(super) fn run(args: &CompareArgs, console: &Console) -> Outcome {
    let options = [
        (args.picture.is_some(), "--picture"),
        (args.chart.is_some(), "--chart"),
        (!args.overlay.is_empty(), "--overlay"),
    ];
    refuse_given(&options, |option| {
        format!("{} is a folder of bakes; {option} is for one bake", args.bake.display())
    })?;
    let Expansion { found, failures, .. } = expand(args.against.clone(), args.recursive, Some(&args.bake));
    // By the names of their bakes in the folder, without extension.
    let alike = ("have one name,", "compare them separately");
    let named = named_sources(found, &args.input, "", alike)?;
    failures.iter().for_each(|error| console::error(&error.to_string()));
    let mut run = Run {
        args,
        width: named.iter().map(|(_, name)| name.as_os_str().len() + 5).max().unwrap_or(0).max(4),
        done: 0,
        failed: failures.len(),
        not_judged: BTreeMap::new(),
    };
    if !args.json {
        print(&format!("{:<1$}     error   worst channel  verdict\n", "bake", run.width))?;
    }
    for (source, name) in &named {
        let base = args.bake.join(name);
        match bakes_of(&args.bake, source, &base, named.len() == 1) {
            Ok(bakes) => {
                let sources = Sources::new(source.clone(), &args.input, args.lobe, console);
                bakes.iter().try_for_each(|bake| run.judge(bake, &sources))?;
            }
            Err(failure) => run.fail(&base, source.path(), failure)?,
        }
    }
    run.finish(console)
}

/// State of a run.
struct Run<'a> {
    args: &'a CompareArgs,
    /// Columns of names.
    width: usize,
    done: usize,
    failed: usize,
    /// Names of bakes by what was not judged of them.
    not_judged: BTreeMap<String, Vec<String>>,
}

impl Run<'_> {
    fn judge(&mut self, path: &Path, sources: &Sources<'_>) -> Outcome {
        let measures = Measures::new(self.args, Some(self.args.from.unwrap_or(0.0)));
        let bake = bake_in(path, sources.console);
        let comparison = match bake.and_then(|bake| against_source(&measures, path, &bake, sources)) {
            Ok(comparison) => comparison,
            Err(failure) => return self.fail(path, sources.path(), failure),
        };
        let Some(verdict) = &comparison.verdict else { return Ok(()) };
        let name = self.short(path);
        if !verdict.not_judged.is_empty() {
            self.not_judged.entry(verdict.not_judged.join("; ")).or_default().push(name.clone());
        }
        let failure = self.args.fail_above.and_then(|limit| verdict.check(limit).err());
        let line = match self.args.json {
            true => serde_json::to_string(&comparison)?,
            false => self.line(&name, &comparison, verdict, failure.is_some()),
        };
        print(&(line + "\n"))?;
        self.done += 1;
        if let Some(error) = failure {
            self.failed += 1;
            console::error(&format!("{}: {error:#}", path.display()));
        }
        Ok(())
    }

    /// A row of the table.
    fn line(&self, name: &str, comparison: &Comparison, verdict: &Verdict, is_failed: bool) -> String {
        let word = match (is_failed, self.args.fail_above) {
            (true, _) => "failed",
            (false, Some(_)) => "passed",
            (false, None) => "measured",
        };
        let (luminance, channel, what) = match verdict.worst() {
            Some(worst) => (format!("{:.6}", worst.luminance), channel(worst.greatest), &worst.what[..]),
            None => ("-".to_owned(), "-".to_owned(), &comparison.against[..]),
        };
        let width = self.width;
        format!("{name:<width$}  {luminance:>8}  {channel:>14}  {word:<8}  {what}")
    }

    /// Reports that `path` could not be compared; failures of another kind end the program.
    fn fail(&mut self, path: &Path, source: &Path, failure: Failure) -> Outcome {
        let message = match failure {
            Failure::Failed(error) => format!("{error:#}"),
            Failure::Usage(message) => message,
            other => return Err(other),
        };
        self.failed += 1;
        console::error(&message);
        let (bake, against) = (path.display().to_string(), source.display().to_string());
        let line = if self.args.json {
            json!({"bake": bake, "against": against, "error": message}).to_string()
        } else {
            format!("{:<3$}  {:>8}  {:>14}  failed", self.short(path), "-", "-", self.width)
        };
        print(&(line + "\n"))
    }

    /// `path` within the folder of bakes.
    fn short(&self, path: &Path) -> String {
        path.strip_prefix(&self.args.bake).unwrap_or(path).display().to_string()
    }

    fn finish(self, console: &Console) -> Outcome {
        let total = self.not_judged.values().map(Vec::len).sum::<usize>();
        for (what, names) in &self.not_judged {
            let whose = if names.len() == total { format!("{total} bakes") } else { names.join(", ") };
            console::tell(&format!("{whose}: not judged: {what}"));
        }
        console.note(&format!("{} compared, {} failed", self.done, self.failed));
        if self.failed > 0 { Err(Failure::Reported) } else { Ok(()) }
    }
}

/// The bakes of `source` in `folder`, called `base`, as `bake` names the outputs for several inputs: a file
/// or folder, or one for each target. With `one` source, `folder` can be that of its targets.
fn bakes_of(folder: &Path, source: &InputFiles, base: &Path, one: bool) -> Outcome<Vec<PathBuf>> {
    let mut found: Vec<PathBuf> = FILES
        .into_iter()
        .map(|extension| PathBuf::from(format!("{}.{extension}", base.display())))
        .filter(|path| path.is_file() && !is_same(path, source.path()))
        .collect();
    if base.is_dir() && (found.is_empty() || io::is_bake_folder(base)) {
        let targets = targets_in(base)?;
        if !targets.is_empty() {
            found.extend(targets);
            return Ok(found);
        }
        found.push(base.to_owned());
    }
    if found.is_empty() && one {
        found = targets_in(folder)?;
        if !found.is_empty() {
            return Ok(found);
        }
    }
    let (path, name) = (source.path().display(), base.display());
    match &found[..] {
        [] => failed(format!(
            "{path}: its bake is missing: no {name}.ktx2 (.ktx, .dds, .exr) and no folder {name}"
        )),
        [_] => Ok(found),
        [a, b, ..] => {
            let (a, b) = (a.display(), b.display());
            failed(format!("{a} and {b} are both named for {path}; remove one"))
        }
    }
}

/// The folders of targets in `folder`, sorted.
fn targets_in(folder: &Path) -> crate::Result<Vec<PathBuf>> {
    let names = io::names_in(folder)?.into_iter().filter(|name| Target::named(name).is_some());
    Ok(names.map(|name| folder.join(name)).filter(|path| path.is_dir()).collect())
}

fn is_same(a: &Path, b: &Path) -> bool {
    a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b)
}
