//! `octagloss bake --target`: the files that engines expect, in a folder for each environment.

use super::args::BakeArgs;
use super::bake::{certified, share_matters, vanished};
use super::bake_context::Told;
use super::console::{self, Talk};
use super::engine::Engine;
use super::fingerprint;
use super::input::{self, Opened, Source};
use super::outcome::{Failure, Outcome, on_threads, print, usage};
use super::output::{
    Stored, SunFile, check_folder_name, cube_told, foretold, json_text, metadata, recover, texel_bytes,
};
use super::shared_args::{EngineArgs, InputArgs};
use anyhow::anyhow;
use blake3::Hash;
use octagloss::bake::BakeSettings;
use octagloss::bake::overflow::{self, Overflow};
use octagloss::bake::report::{OutputFileReport, Report, TargetReport};
use octagloss::export::files::{Made, files};
use octagloss::format::container::Container;
use octagloss::io::LayoutChoice;
use octagloss::io::output::{self, Existing};
use octagloss::io::side_report::REPORT;
use octagloss::lobe::Lobe;
use octagloss::target::{Content, Diffuse, Plan};
use octagloss::{Error, Map, memory};
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What is to be done for every environment, checked.
struct Work {
    plans: Vec<(Plan, BakeSettings)>,
    jobs: Vec<Job>,
    /// The folder for several environments.
    folder: Option<PathBuf>,
    existing: Existing,
    input: InputArgs,
    json: bool,
    overflow: Overflow,
    engine: EngineArgs,
    sun: Vec<SunFile>,
    skip_unchanged: bool,
    /// All that the outputs depend on besides their inputs.
    options: String,
}

/// One environment, its name, and the folder that its files go into.
struct Job {
    source: Source,
    name: String,
    folder: PathBuf,
}

pub(super) fn run(args: BakeArgs) -> Outcome {
    args.engine.check()?;
    let talk = Talk::new(args.quiet);
    let (threads, dry_run) = (args.engine.threads, args.dry_run);
    let work = Work::new(args)?;
    if dry_run {
        return work.foretell();
    }
    on_threads(threads, || work.run(&talk))
}

impl Work {
    fn new(args: BakeArgs) -> Outcome<Self> {
        if args.bounds {
            return usage("--bounds does not go with --target; bake without it for the bounds");
        }
        if args.preview.is_some() {
            return usage("--preview does not go with --target; bake without it for a picture");
        }
        if args.lobe == Lobe::Cosine {
            return usage("--lobe cosine does not go with --target; --diffuse cube adds irradiance");
        }
        let mut plans: Vec<(Plan, BakeSettings)> = Vec::new();
        for target in &args.target {
            if plans.iter().any(|(plan, _)| plan.target == *target) {
                return usage(format!("--target names {} twice", target.name));
            }
            plans.push(planned(Plan::new(target), &args)?);
        }
        if let Some(path) = &args.output {
            if path.as_os_str() == "-" {
                return usage(
                    "-o - takes an output of one file, and --target writes a folder; name it with -o",
                );
            }
            check_folder_name(path, ", and without --target one file is written")?;
        }
        let (options, sun) = (fingerprint::options(&args, ""), SunFile::asked(&args));
        let several = args.inputs.len() > 1 && args.input.layout != LayoutChoice::Faces;
        if several && args.name.is_some() {
            return usage("--name names one environment; several inputs were given");
        }
        let sources = input::sources(args.inputs, &args.input)?;
        let folder = args.output.clone().filter(|_| several);
        let mut by_stem = BTreeMap::new();
        let mut jobs = Vec::new();
        for source in sources {
            let stem = source.stem();
            if let Some(other) = by_stem.insert(stem.clone(), source.path().to_owned()) {
                return usage(format!(
                    "{} and {} would both be written as {stem}; rename one or bake them apart",
                    other.display(),
                    source.path().display(),
                ));
            }
            let own = match &args.output {
                Some(folder) if several => folder.join(&stem),
                Some(path) => path.clone(),
                None => PathBuf::from(&stem),
            };
            let inside = own.canonicalize().is_ok_and(|own| {
                source.files().iter().any(|file| file.canonicalize().is_ok_and(|file| file.starts_with(&own)))
            });
            if inside {
                return usage(format!("{} holds the input; name another folder with -o", own.display()));
            }
            jobs.push(Job { source, name: args.name.clone().unwrap_or(stem), folder: own });
        }
        Ok(Self {
            plans,
            jobs,
            folder,
            existing: if args.force { Existing::Replace } else { Existing::Keep },
            input: args.input,
            json: args.json,
            overflow: args.overflow,
            engine: args.engine,
            sun,
            skip_unchanged: args.skip_unchanged,
            options,
        })
    }

    /// The folder within a job's that one plan's files go into.
    fn within(&self, plan: &Plan) -> &'static str {
        if self.plans.len() > 1 { plan.target.name } else { "" }
    }

    /// Prints what would be written: a line a file, or with `--json` a line an input.
    fn foretell(&self) -> Outcome {
        let mut text = String::new();
        for job in &self.jobs {
            job.source.check()?;
            if self.is_up_to_date(job) {
                continue;
            }
            self.check(job)?;
            let mut files = Vec::new();
            for (plan, settings) in &self.plans {
                let folder = job.folder.join(self.within(plan));
                for (path, content) in plan.files(&job.name) {
                    files.push((folder.join(path), told(plan, settings, content)?));
                }
                if !self.json {
                    files.push((folder.join(REPORT), "report".to_owned()));
                }
            }
            for file in &self.sun {
                files.push((job.folder.join(file.name()), file.content().to_owned()));
            }
            text += &foretold(&job.source, files, self.json);
        }
        print(&text)
    }

    /// Fails where writing would.
    fn check(&self, job: &Job) -> octagloss::Result<()> {
        match &self.folder {
            Some(folder) if !folder.exists() => output::check_folder(folder, Existing::Keep),
            _ => output::check_folder(&job.folder, self.existing),
        }
    }

    fn run(&self, talk: &Talk) -> Outcome {
        if let Some(folder) = self.folder.as_ref().filter(|folder| folder.exists() && !folder.is_dir()) {
            return Err(anyhow!("{}: is a file; several inputs need a folder", folder.display()).into());
        }
        for job in &self.jobs {
            recover(&job.folder, talk);
        }
        let mut failed = false;
        let engine = OnceCell::new();
        for job in &self.jobs {
            if self.is_up_to_date(job) {
                talk.note(&format!("{}: unchanged", job.folder.display()));
                continue;
            }
            let outcome = self.check(job).map_err(Failure::from).and_then(|()| self.bake(job, &engine, talk));
            match outcome {
                Err(Failure::Failed(error)) => {
                    console::error(&format!("{error:#}"));
                    failed = true;
                }
                other => other?,
            }
        }
        if failed { Err(Failure::Told) } else { Ok(()) }
    }

    /// Whether `job` is to be left alone: every target's folder is as it was written for the same request.
    fn is_up_to_date(&self, job: &Job) -> bool {
        let request = fingerprint::request(&job.source, &self.options);
        self.skip_unchanged
            && request.is_ok_and(|request| {
                self.plans.iter().all(|(plan, _)| {
                    let report = job.folder.join(self.within(plan)).join(REPORT);
                    fingerprint::holds(&report, request, [job.folder.clone()])
                })
            })
    }

    fn bake(&self, job: &Job, engine: &OnceCell<Engine>, talk: &Talk) -> Outcome {
        let start = Instant::now();
        // Before it is read: should it change meanwhile, it is found changed.
        let (request, input_files) = fingerprint::requested(&job.source, &self.options)?;
        let opened = job.source.open(&self.input, talk)?;
        let settings: Vec<BakeSettings> = self.plans.iter().map(|(_, settings)| settings.clone()).collect();
        let pixels = self.plans.iter().map(|(plan, _)| texel_bytes(plan.pixel));
        memory::check_bake(&opened.environment, &settings, pixels.max().unwrap_or(0))?;
        let engine = self.engine.chosen(engine, talk)?;
        let bar = talk.bar(&job.name);
        let (bakes, baker) =
            engine.bake_all(&opened.environment, &settings, talk, &|progress| bar.bake(progress))?;
        drop(bar);
        let told = Told {
            source: &job.source,
            input_files,
            opened: &opened,
            input: &self.input,
            sunless: self.sun.contains(&SunFile::Sunless),
            overflow: self.overflow,
            preview: false,
            baker: &baker,
            start,
        };
        let mut outputs: Vec<(Vec<Made>, Report)> = Vec::with_capacity(bakes.len());
        for ((plan, settings), mut bake) in self.plans.iter().zip(bakes) {
            let compressed = self.overflow.apply_all(&mut bake, plan.pixel).map_err(|error| {
                let place = format!("{}, target {}", job.folder.display(), plan.target.name);
                anyhow::Error::from(error).context(place)
            })?;
            let bake = &bake;
            let made = files(plan, &job.name, bake, &metadata(settings, &opened))?;
            let clamped = made.iter().flat_map(|file| &file.clamped).sum();
            let clamped_share = overflow::clamped_share(bake, plan.pixel);
            let mut warnings = opened.warnings.clone();
            if clamped > 0 && share_matters(clamped_share) {
                let warning = format!(
                    "{clamped} texels are brighter than {} can hold and were clamped, {} of a level's energy",
                    plan.pixel.name(),
                    console::percent(clamped_share),
                );
                talk.warn(&format!("{}, target {}: {warning}", job.folder.display(), plan.target.name));
                warnings.push(warning);
            }
            if let Some(warning) = vanished(bake, plan.pixel.name(), plan.pixel.rounded_to_zero()) {
                talk.warn(&format!("{}, target {}: {warning}", job.folder.display(), plan.target.name));
                warnings.push(warning);
            }
            for warning in &bake.warnings {
                talk.warn(&format!("{}: {warning}", job.source.path().display()));
            }
            let pixels = vec![plan.pixel; bake.stats.len()];
            let stored = Stored::new(plan.format_name(), plan.pixel.name(), &pixels, clamped);
            let mut report = Report {
                compressed,
                ..Report::new(settings, bake, told.circumstances(stored, clamped_share, warnings))
            };
            report.target = Some(TargetReport {
                name: plan.target.name.to_owned(),
                environment: job.name.clone(),
                flip: plan.flip.name().to_owned(),
                diffuse: plan.diffuse.name().to_owned(),
                verified: plan.target.verified.is_some(),
                files: made.iter().map(|file| file.path.clone()).collect(),
            });
            outputs.push((made, report));
        }
        if let Some(folder) = &self.folder {
            fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
        }
        output::write_folder(&job.folder, self.existing, |folder| {
            self.write(folder, request, &opened, &mut outputs)
        })?;
        let bytes: usize = outputs.iter().flat_map(|(made, _)| made).map(|file| file.bytes.len()).sum();
        let reports = outputs.iter().map(|(_, report)| report);
        let bound = |report: &&Report| report.error_bound_max().unwrap_or(-1.0);
        let least_certain = reports.max_by(|a, b| bound(a).total_cmp(&bound(b)));
        talk.note(&format!(
            "{}: {} for {} in {:.2} s on {}, OEM {} + {}, {}",
            job.folder.display(),
            console::bytes(bytes as u64),
            self.plans.iter().map(|(plan, _)| plan.target.name).collect::<Vec<_>>().join(", "),
            start.elapsed().as_secs_f64(),
            outputs[0].1.engine,
            outputs[0].1.oem.size,
            outputs[0].1.oem.border,
            least_certain.map_or_else(|| "nothing certified".to_owned(), certified),
        ));
        if self.json {
            for (_, report) in &outputs {
                let line = serde_json::to_string(report).map_err(anyhow::Error::from)?;
                print(&(line + "\n"))?;
            }
        }
        Ok(())
    }

    /// Writes all into `folder` and completes the reports.
    fn write(
        &self,
        folder: &Path,
        request: Hash,
        opened: &Opened,
        outputs: &mut [(Vec<Made>, Report)],
    ) -> octagloss::Result<()> {
        let write = |plan: &Plan, path: &str, bytes: &[u8]| {
            let path = folder.join(self.within(plan)).join(path);
            let parent = path.parent().expect("within a folder");
            fs::create_dir_all(parent).map_err(|e| Error::io(parent, e))?;
            fs::write(&path, bytes).map_err(|e| Error::io(&path, e))
        };
        for ((plan, _), (made, _)) in self.plans.iter().zip(&*outputs) {
            for file in made {
                write(plan, &file.path, &file.bytes)?;
            }
        }
        self.sun.iter().try_for_each(|file| file.write_into(folder, opened))?;
        let written = fingerprint::joined([fingerprint::hash_of(folder)])?;
        for ((plan, _), (made, report)) in self.plans.iter().zip(outputs) {
            let file =
                |file: &Made| OutputFileReport { path: file.path.clone(), bytes: file.bytes.len() as u64 };
            report.outputs = made.iter().map(file).collect();
            let hashes = made.iter().map(|file| (file.path.clone(), blake3::hash(&file.bytes)));
            report.fingerprint = Some(fingerprint::fingerprint(request, written, hashes));
            if !self.json {
                write(plan, REPORT, json_text(report)?.as_bytes())?;
            }
        }
        Ok(())
    }
}

/// What a file of `plan` will be.
fn told(plan: &Plan, settings: &BakeSettings, content: Content) -> octagloss::Result<String> {
    let pixel = plan.pixel.name();
    Ok(match content {
        Content::Specular => cube_told(pixel, settings.size, settings.level_specs()?.len()),
        Content::Sheen => cube_told(&format!("{pixel} sheen"), settings.size, settings.level_specs()?.len()),
        Content::Skybox => cube_told(pixel, settings.size, 1),
        Content::Irradiance => {
            let size = settings.irradiance.unwrap_or(plan.target.irradiance_size);
            cube_told(&format!("{pixel} irradiance"), size, 1)
        }
        Content::ShJson | Content::ShText => "spherical harmonics".to_owned(),
        Content::Oem => {
            let specs = settings.level_specs()?;
            format!("{pixel} octahedral map {}, {} levels, with borders", settings.size, specs.len())
        }
        Content::Reader => "shader code".to_owned(),
        Content::Panorama => format!("panorama {}x{}", 2 * settings.size, settings.size),
        Content::Env | Content::Glb => {
            let specs = settings.level_specs()?;
            format!("{pixel} cube {}, {} levels, and spherical harmonics", settings.size, specs.len())
        }
    })
}

/// The preset with what `args` override.
fn planned(mut plan: Plan, args: &BakeArgs) -> Outcome<(Plan, BakeSettings)> {
    let target = plan.target;
    let fixed =
        |option: &str| usage(format!("target {} has a format of its own; leave {option} out", target.name));
    if let Some(format) = args.format {
        if !target.has_container() {
            return fixed("--format");
        }
        if format == Container::Hdr {
            return usage(
                "--format hdr is a folder of faces and does not go with --target; ktx2, ktx, dds and exr do",
            );
        }
        plan.container = format;
    }
    if target.map == Map::Octahedral && !matches!(plan.container, Container::Ktx2 | Container::Exr) {
        return usage(format!(
            "target {}: --format {} is for cubes; ktx2 and exr go",
            target.name,
            plan.container.name()
        ));
    }
    if !target.has_container() {
        if args.pixel.is_some() {
            return fixed("--pixel");
        }
        if args.diffuse.is_some() || args.irradiance.is_some() {
            return fixed("--diffuse and --irradiance");
        }
    }
    if target.map != Map::Cube && args.flip.is_some() {
        return usage(format!("target {} has no cube; leave --flip out", target.name));
    }
    if target.map == Map::Panorama && args.levels.is_some() {
        return usage(format!("target {} has one level; leave --levels out", target.name));
    }
    plan.pixel = args.pixel.unwrap_or(plan.pixel);
    plan.flip = args.flip.unwrap_or(plan.flip);
    plan.diffuse = args.diffuse.unwrap_or(plan.diffuse);
    if let Err(error) = args.filter.check(args.lobe, args.table.oem_size) {
        return usage(error.to_string());
    }
    let cube = matches!(plan.diffuse, Diffuse::Cube | Diffuse::Both);
    if args.irradiance.is_some() && !cube {
        match (args.diffuse, plan.diffuse) {
            (Some(_), _) => {
                return usage(format!(
                    "--irradiance asks for a cube and --diffuse {} for none; leave one out",
                    plan.diffuse.name()
                ));
            }
            (None, Diffuse::Sh) => plan.diffuse = Diffuse::Both,
            (None, _) => plan.diffuse = Diffuse::Cube,
        }
    }
    if let Err(error) = plan.check() {
        return usage(error.to_string());
    }
    let cube = matches!(plan.diffuse, Diffuse::Cube | Diffuse::Both);
    let size = args.size.unwrap_or(target.size);
    let settings = BakeSettings {
        map: target.map,
        size,
        levels: Some(args.levels.unwrap_or_else(|| target.levels(size))),
        ladder: args.ladder.unwrap_or(target.ladder),
        lobe: args.lobe,
        filter: args.filter,
        oem_size: args.table.oem_size,
        border: args.table.border,
        bounds: false,
        irradiance: cube.then(|| args.irradiance.unwrap_or(target.irradiance_size)),
        sh_order: args.sh_order,
        sh_window: args.sh_window,
        sheen: target.has_sheen(),
    };
    let specs = settings.level_specs().and_then(|specs| plan.check_levels(size, specs.len() as u32));
    match specs {
        Ok(()) => Ok((plan, settings)),
        Err(error) => usage(format!("target {}: {error}", target.name)),
    }
}
