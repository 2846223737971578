//! `octagloss bake`: bakes environments into prefiltered levels, with or without a target.

use super::args::BakeArgs;
use super::console::{self, Console, Files};
use super::engine::Engine;
use super::expand::{Expansion, expand};
use super::input::{InputFiles, named_sources};
use super::outcome::{Failure, Outcome, check_png, failed, is_stdout, on_threads, print, print_json, usage};
use super::output::{Common, Destination, Outputs, names_folder};
use super::{bake_plan, fingerprint, summary, verify};
use crate::files::Existing;
use crate::maps::Face;
use crate::read::InputLayout;
use crate::recipes::{BakePlan, Source, products};
use crate::{BakeSettings, Environment, Error, Filter, Oracle, Progress};
use anyhow::Context as _;
use octagloss_core::common::parallel;
use octagloss_core::files::export::produce::check_memory;
use octagloss_core::files::io::file_name::path_key;
use octagloss_core::files::io::output;
use octagloss_core::files::io::regular::CHANGED;
use octagloss_core::sphere::cube::direction_from_texel;
use serde_json::json;
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The checked job list.
struct Work {
    common: Common,
    jobs: Vec<InputJob>,
    /// The folder for several outputs.
    folder: Option<PathBuf>,
    /// Whether several inputs are possible; messages then show a count.
    several: bool,
    /// Folders and patterns of inputs that could not be read, or have none.
    unread: Vec<Error>,
    args: BakeArgs,
    /// Everything except the inputs that affects the outputs.
    options: String,
}

/// One environment and where its files go.
struct InputJob {
    source: InputFiles,
    outputs: Outputs,
    /// `[3/18] ` for several inputs.
    label: String,
}

pub(super) fn run(args: BakeArgs) -> Outcome {
    let console = Console::new(args.quiet);
    args.engine.check()?;
    let work = Work::new(args)?;
    if work.args.dry_run {
        return work.foretell(&console);
    }
    on_threads(work.args.engine.threads, || work.run(&console))
}

impl Work {
    fn new(mut args: BakeArgs) -> Outcome<Self> {
        let typed = std::mem::take(&mut args.inputs);
        let Expansion { found, is_open, failures } = expand(typed, args.recursive, args.output.as_deref());
        if found.is_empty() && args.recipe.input.layout == InputLayout::Faces {
            // Six files are counted below.
            return Err(failures.into_iter().next().expect("why nothing was found").into());
        }
        let several = !found.is_empty()
            && (is_open || found.len() > 1)
            && args.recipe.input.layout != InputLayout::Faces;
        let plans = bake_plan::plans(&args, several)?;
        if args.verify.is_some() {
            verify::check_plans(&plans, args.dry_run)?;
        }
        let options = fingerprint::options(&plans, &args.engine)?;
        if several && args.recipe.name.is_some() {
            return usage("--name names one environment; several inputs were given");
        }
        let first = &plans[0].plan;
        let is_file = plans[0].is_file();
        let suffix = if is_file { format!(".{}", first.container.name()) } else { String::new() };
        let alike = ("would both be written as", "rename one or bake them separately");
        let sources = named_sources(found, &args.recipe.input, &suffix, alike)?;
        if let Some(path) = &args.preview {
            check_png("--preview", path)?;
            if several {
                return usage("--preview takes one input");
            }
        }
        let place = match &args.output {
            Some(path) if is_stdout(path)? => {
                bake_plan::check_stdout(&args, first, several)?;
                Destination::Stdout
            }
            _ if is_file => Destination::File,
            _ => Destination::Folder,
        };
        let within = several || (is_file && args.output.as_deref().is_some_and(names_folder));
        let total = sources.len();
        let job = |(number, (source, name)): (usize, (InputFiles, PathBuf))| {
            let main = match &args.output {
                Some(folder) if within => folder.join(name),
                Some(path) => path.clone(),
                None => name,
            };
            let name = match place {
                Destination::Folder => args.recipe.name.clone().unwrap_or_else(|| source.stem()),
                _ => main.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            };
            let folder = main.parent().filter(|folder| within && !folder.as_os_str().is_empty());
            let folder = folder.map(Path::to_owned);
            let label = if several { format!("[{number}/{total}] ") } else { String::new() };
            let outputs = Outputs { main, place, name, folder, preview: args.preview.clone() };
            InputJob { source, outputs, label }
        };
        let jobs: Vec<InputJob> = (1..).zip(sources).map(job).collect();
        let common = Common { existing: Existing::by_force(args.force), json: args.json, plans };
        let folder = args.output.clone().filter(|_| within);
        let work = Self { common, jobs, folder, several, unread: failures, args, options };
        work.check_places()?;
        Ok(work)
    }

    /// Outputs must differ from one another and from every input.
    fn check_places(&self) -> Outcome {
        let inputs = self.jobs.iter().flat_map(|job| job.source.files());
        let inputs: BTreeSet<PathBuf> = inputs.filter_map(|input| input.canonicalize().ok()).collect();
        let mut all: BTreeSet<PathBuf> = BTreeSet::new();
        for job in &self.jobs {
            for place in job.outputs.paths(&self.common)? {
                // A folder's contents follow it in path order.
                if let Ok(real) = place.canonicalize()
                    && let Some(input) = inputs.range(real.clone()..).next()
                    && input.starts_with(&real)
                {
                    let what = if *input == real { "is an input" } else { "holds an input" };
                    return usage(format!("{} {what}; name another output with -o", place.display()));
                }
                if !all.insert(path_key(&place)) {
                    return usage(format!("{} is named for two outputs", place.display()));
                }
            }
        }
        Ok(())
    }

    /// Lists the outputs: one line per file, or with `--json` one line per input, failed ones included.
    /// Reports failures and continues; counts several inputs.
    fn foretell(&self, console: &Console) -> Outcome {
        self.check_folder()?;
        let (mut baked, mut skipped, mut failed) = (0, 0, self.tell_unread());
        let mut text = String::new();
        let failure_line = |input: &Path, error: &str| {
            let line = json!({"input": input.display().to_string(), "error": error}).to_string() + "\n";
            if self.common.json { line } else { String::new() }
        };
        for error in &self.unread {
            if let Error::Io { path, .. } | Error::Input { path, .. } = error {
                text += &failure_line(path, &error.to_string());
            }
        }
        for job in &self.jobs {
            if self.is_up_to_date(job) {
                skipped += 1;
                continue;
            }
            let foretold = || -> Outcome<String> {
                job.outputs.check(&self.common)?;
                let layout = self.opened(job, &Console::new(true))?.0.environment.layout();
                Ok(job.outputs.foretold(&self.common, &job.source, layout)?)
            };
            match foretold() {
                Ok(lines) => {
                    text += &lines;
                    baked += 1;
                }
                Err(failure) => {
                    if let Failure::Failed(error) = &failure {
                        let error = console::with_options(&format!("{error:#}"));
                        text += &failure_line(job.source.path(), &error);
                    }
                    failed += job.report_failure(failure)?;
                }
            }
        }
        print(&text)?;
        if self.several {
            console.note(&format!("{baked} to bake, {skipped} to skip, {failed} failed"));
        }
        if failed > 0 { Err(Failure::Reported) } else { Ok(()) }
    }

    /// Reports input folders that could not be read; returns their number.
    fn tell_unread(&self) -> usize {
        self.unread.iter().for_each(|error| console::error(&error.to_string()));
        self.unread.len()
    }

    /// Checks the folder for several outputs.
    fn check_folder(&self) -> Outcome {
        match &self.folder {
            Some(folder) if !folder.exists() => output::check_folder(folder, Existing::Keep)?,
            Some(folder) if !folder.is_dir() => {
                let message = "is a file; several inputs, and names that end in /, need a folder";
                return failed(format!("{}: {message}", folder.display()));
            }
            _ => {}
        }
        Ok(())
    }

    /// Whether to skip `job`.
    fn is_up_to_date(&self, job: &InputJob) -> bool {
        let request = || fingerprint::requested(&job.source, &self.options).ok();
        self.args.skip_unchanged
            && request().is_some_and(|(request, _)| job.outputs.holds(&self.common, request))
    }

    fn run(&self, console: &Console) -> Outcome {
        let mut recovered = BTreeSet::new();
        for job in &self.jobs {
            job.outputs.recover(&self.common, &mut recovered, console)?;
        }
        // Report unwritable outputs before baking.
        self.check_folder()?;
        let (mut baked, mut skipped, mut failed) = (0, 0, self.tell_unread());
        let mut ready = Vec::new();
        for job in &self.jobs {
            if self.is_up_to_date(job) {
                console.note(&format!("{}{}: unchanged", job.label, job.outputs.main.display()));
                skipped += 1;
                if let Err(failure) = self.verify(job, console) {
                    failed += job.report_failure(failure)?;
                }
                continue;
            }
            match job.outputs.check(&self.common) {
                Ok(()) => ready.push(job),
                Err(failure) => failed += job.report_failure(failure)?,
            }
        }
        let mut engine = None;
        let (start, total) = (Instant::now(), ready.len());
        // Of costly plans, once for all inputs.
        for BakePlan { plan, warning, .. } in self.common.plans.iter().filter(|_| total > 0) {
            if let Some(warning) = warning {
                let place = if plan.is_targeted() { plan.target.name } else { "bake" };
                console.warn(&format!("{place}: {warning}"));
            }
        }
        for (done, job) in ready.into_iter().enumerate() {
            let files = self.several.then_some(Files { start, done, total });
            let outcome = self.bake(job, files, &mut engine, console);
            match outcome.and_then(|()| self.verify(job, console)) {
                Ok(()) => baked += 1,
                Err(failure) => failed += job.report_failure(failure)?,
            }
        }
        if self.several {
            console.note(&format!("{baked} baked, {skipped} skipped, {failed} failed"));
        }
        if failed > 0 { Err(Failure::Reported) } else { Ok(()) }
    }

    fn bake(
        &self,
        job: &InputJob,
        files: Option<Files>,
        engine: &mut Option<Engine>,
        console: &Console,
    ) -> Outcome {
        let start = Instant::now();
        let (request, input_files) = fingerprint::requested(&job.source, &self.options)?;
        let (source, plans) = self.opened(job, console)?;
        // The hashes in the report are those of the light.
        if fingerprint::requested(&job.source, &self.options)?.0 != request {
            return Err(Error::input(job.source.path(), CHANGED).into());
        }
        let source = Source { files: input_files, ..source };
        let measured =
            |plan: &BakePlan| BakeSettings { measure: !plan.settings.pyramid, ..plan.settings.clone() };
        let settings: Vec<BakeSettings> = plans.iter().map(measured).collect();
        // Chosen after an input was read, so an unreadable input prints only its own error.
        let engine = match engine {
            Some(engine) => engine,
            None => engine.insert(self.args.engine.choose(console)?),
        };
        if settings[0].filter == Filter::Reference {
            let seconds = reference_seconds(&source.environment, &settings[0])?;
            let (path, time) = (job.source.path().display(), console::duration(seconds));
            console.note(&format!("{path}: the reference filter will take about {time}"));
        }
        let name = format!("{}{}", job.label, job.source.stem());
        let bar = console.bar_of(&name, files);
        let progress = |progress: Progress| {
            bar.at(progress.done, progress.total);
            ControlFlow::Continue(())
        };
        let baked = engine.bake_all(&source.environment, &settings, &progress)?;
        drop(bar);
        if let Some(why) = &baked.fallback {
            console.note(why);
        }
        console.warn_of(job.source.path(), baked.bakes.iter().flat_map(|bake| &bake.warnings));
        let main = job.outputs.main.display();
        let mut products =
            products(&plans, &source, baked, &job.outputs.name, start).with_context(|| main.to_string())?;
        for product in &mut products.per_plan {
            let target = product.plan.plan.target.name;
            let place = if target.is_empty() { String::new() } else { format!(", target {target}") };
            product.losses.iter().for_each(|loss| console.warn(&format!("{main}{place}: {loss}")));
            product.report.warnings.iter_mut().for_each(|text| *text = console::with_options(text));
        }
        let (reports, bytes) = job.outputs.write(&self.common, &products, request)?;
        let seconds = start.elapsed().as_secs_f64();
        let (input, main) = (job.source.path(), job.outputs.main.as_path());
        let main = (job.outputs.place != Destination::Stdout).then_some(main);
        let written = summary::written(main, &plans, &reports, bytes, seconds);
        let next = || format!("; {}", summary::next(main.unwrap_or(input), input, &plans));
        let next = if self.several { String::new() } else { next() };
        console.note(&format!("{}{written}{next}", job.label));
        reports.iter().filter(|_| self.common.json).try_for_each(print_json)
    }

    /// Judges the outputs of `job`, if asked.
    fn verify(&self, job: &InputJob, console: &Console) -> Outcome {
        let Some(limit) = self.args.verify else { return Ok(()) };
        let outputs = match &self.common.plans[..] {
            [_] => vec![job.outputs.main.clone()],
            plans => plans.iter().map(|plan| job.outputs.main.join(plan.plan.target.name)).collect(),
        };
        verify::check(&outputs, &job.source, limit, &self.args, &job.label, console)
    }

    /// The source of `job`, and the plans for it; checks that the bakes fit into memory.
    fn opened(&self, job: &InputJob, console: &Console) -> crate::Result<(Source, Vec<BakePlan>)> {
        let source = job.source.open(&self.args.recipe.input, console)?;
        let layout = source.environment.layout();
        let plans: Vec<BakePlan> = self.common.plans.iter().map(|plan| plan.settled(layout)).collect();
        check_memory(&plans, &source.environment)?;
        Ok((source, plans))
    }
}

impl InputJob {
    /// Reports an input's error and counts the input as failed. Other failures end the program.
    fn report_failure(&self, failure: Failure) -> Outcome<usize> {
        match failure {
            Failure::Failed(error) => {
                console::error(&format!("{}{error:#}", self.label));
                Ok(1)
            }
            other => Err(other),
        }
    }
}

/// Estimates the reference filter's time in seconds from a few texels of each level.
fn reference_seconds(environment: &Environment, settings: &BakeSettings) -> crate::Result<f64> {
    let start = Instant::now();
    let oracle = Oracle::new(environment);
    let prepared = start.elapsed().as_secs_f64();
    let threads = rayon::current_num_threads();
    // One texel per thread, cycling through the faces.
    let directions: Vec<_> =
        (0..threads).map(|k| direction_from_texel(Face::ALL[k % 6], 5, (k % 5) as u32, 1)).collect();
    let (mut seconds, mut last) = (prepared, 0.0);
    for level in settings.level_specs()? {
        let texels = level.layout.texel_count() as f64;
        // Lobes cost about the same at every level: extrapolate from the first slow one.
        if last < 1.0 {
            let start = Instant::now();
            parallel::for_each(&directions, |direction| {
                std::hint::black_box(oracle.reflected(settings.lobe, level.roughness, *direction));
            });
            last = start.elapsed().as_secs_f64();
        }
        seconds += last * texels / threads as f64;
    }
    Ok(seconds)
}
