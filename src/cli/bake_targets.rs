//! `octagloss bake --target`: the files that engines expect, in a folder for each environment.

use super::args::{BakeArgs, EngineArgs, InputArgs, LobeArg};
use super::bake::{compress, container};
use super::engine::Engine;
use super::input::{self, Source};
use super::output::{metadata, report_text};
use super::talk::{self, Talk};
use super::{Failure, Outcome, on_threads, print, usage};
use anyhow::anyhow;
use octagloss::Error;
use octagloss::bake::{BakeSettings, Ladder};
use octagloss::io::output::{self, Existing};
use octagloss::io::pixels::Pixel;
use octagloss::overflow::Overflow;
use octagloss::report::{Circumstances, RepairReport, Report, TargetReport};
use octagloss::target::files::{Made, files};
use octagloss::target::{Content, Diffuse, Plan};
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
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
        if args.lobe == LobeArg::Cosine {
            return usage("--lobe cosine does not go with --target; --diffuse cube adds irradiance");
        }
        let mut plans: Vec<(Plan, BakeSettings)> = Vec::new();
        for target in &args.target {
            if plans.iter().any(|(plan, _)| plan.target == *target) {
                return usage(format!("--target names {} twice", target.name));
            }
            plans.push(planned(Plan::new(target), &args)?);
        }
        let several = args.inputs.len() > 1 && args.input.layout != super::args::LayoutArg::Faces;
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
            overflow: args.overflow.into(),
            engine: args.engine,
        })
    }

    /// The folder within a job's that one plan's files go into.
    fn within(&self, plan: &Plan) -> &'static str {
        if self.plans.len() > 1 { plan.target.name } else { "" }
    }

    /// What would be written, a line a file.
    fn foretell(&self) -> Outcome {
        let mut text = String::new();
        for job in &self.jobs {
            for file in job.source.files() {
                fs::metadata(file).map_err(|error| Error::io(file, error))?;
            }
            self.check(job)?;
            for (plan, settings) in &self.plans {
                let folder = job.folder.join(self.within(plan));
                for (path, content) in plan.files(&job.name) {
                    text += &format!("{}\t{}\n", folder.join(path).display(), told(plan, settings, content)?);
                }
                if !self.json {
                    text += &format!("{}\treport\n", folder.join("report.json").display());
                }
            }
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
        let mut failed = false;
        let engine = OnceCell::new();
        for job in &self.jobs {
            let outcome = self.check(job).map_err(Failure::from).and_then(|()| self.bake(job, &engine, talk));
            match outcome {
                Err(Failure::Failed(error)) => {
                    talk::error(&format!("{error:#}"));
                    failed = true;
                }
                other => other?,
            }
        }
        if failed { Err(Failure::Told) } else { Ok(()) }
    }

    fn bake(&self, job: &Job, engine: &OnceCell<Engine>, talk: &Talk) -> Outcome {
        let start = Instant::now();
        let opened = job.source.open(&self.input, talk)?;
        let engine = self.engine.chosen(engine, talk)?;
        let bar = talk.bar(&job.name);
        let settings: Vec<BakeSettings> = self.plans.iter().map(|(_, settings)| settings.clone()).collect();
        let (bakes, baker) =
            engine.bake_all(&opened.environment, &settings, talk, &|progress| bar.bake(progress))?;
        drop(bar);
        let mut outputs: Vec<(Vec<Made>, Report)> = Vec::with_capacity(bakes.len());
        for ((plan, settings), mut bake) in self.plans.iter().zip(bakes) {
            let compressed = compress(&mut bake, self.overflow, plan.pixel).map_err(|error| {
                let place = format!("{}, target {}", job.folder.display(), plan.target.name);
                anyhow::Error::from(error).context(place)
            })?;
            let bake = &bake;
            let made = files(plan, &job.name, bake, &metadata(settings))?;
            let clamped = made.iter().flat_map(|file| &file.clamped).sum();
            let mut warnings = opened.warnings.clone();
            if clamped > 0 {
                let warning = format!(
                    "{clamped} texels are brighter than {} can hold and were clamped",
                    plan.pixel.name()
                );
                talk.warn(&format!("{}, target {}: {warning}", job.folder.display(), plan.target.name));
                warnings.push(warning);
            }
            for warning in &bake.warnings {
                talk.warn(&format!("{}: {warning}", job.source.path().display()));
            }
            let told = Circumstances {
                input: job.source.path().display().to_string(),
                engine: baker.engine.to_owned(),
                adapter: baker.adapter.clone(),
                repaired: RepairReport {
                    negative: opened.repaired.negative,
                    nan: opened.repaired.nan,
                    infinite: opened.repaired.infinite,
                    negative_energy_share: opened.repaired.negative_energy_share,
                },
                layout: opened.layout.to_owned(),
                rotate_y: self.input.rotate_y.unwrap_or(0.0),
                mirror: self.input.mirror,
                sanitize: self.input.sanitize,
                format: plan.container.name().to_owned(),
                pixel: plan.pixel.name().to_owned(),
                level_pixels: vec![plan.pixel.name().to_owned(); bake.chain.levels.len()],
                clamped,
                warnings,
                seconds: start.elapsed().as_secs_f64(),
            };
            let mut report = Report { compressed, ..Report::new(settings, bake, told) };
            report.target = Some(TargetReport {
                name: plan.target.name.to_owned(),
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
        output::write_folder(&job.folder, self.existing, |folder| self.write(folder, &outputs))?;
        let bytes: usize = outputs.iter().flat_map(|(made, _)| made).map(|file| file.bytes.len()).sum();
        talk.note(&format!(
            "{}: {} for {} in {:.2} s on {}, OEM {} + {}",
            job.folder.display(),
            talk::bytes(bytes as u64),
            self.plans.iter().map(|(plan, _)| plan.target.name).collect::<Vec<_>>().join(", "),
            start.elapsed().as_secs_f64(),
            outputs[0].1.engine,
            outputs[0].1.oem.size,
            outputs[0].1.oem.border,
        ));
        if self.json {
            for (_, report) in &outputs {
                let line = serde_json::to_string(report).map_err(anyhow::Error::from)?;
                print(&(line + "\n"))?;
            }
        }
        Ok(())
    }

    fn write(&self, folder: &std::path::Path, outputs: &[(Vec<Made>, Report)]) -> octagloss::Result<()> {
        for ((plan, _), (made, report)) in self.plans.iter().zip(outputs) {
            let place = |path: &str| folder.join(self.within(plan)).join(path);
            let write = |path: &str, bytes: &[u8]| {
                let path = place(path);
                let parent = path.parent().expect("within a folder");
                fs::create_dir_all(parent).map_err(|e| Error::io(parent, e))?;
                fs::write(&path, bytes).map_err(|e| Error::io(&path, e))
            };
            for file in made {
                write(&file.path, &file.bytes)?;
            }
            if !self.json {
                write("report.json", report_text(report).as_bytes())?;
            }
        }
        Ok(())
    }
}

/// What a file of `plan` will be.
fn told(plan: &Plan, settings: &BakeSettings, content: Content) -> octagloss::Result<String> {
    let pixel = plan.pixel.name();
    Ok(match content {
        Content::Specular => {
            let rungs = settings.rungs()?;
            format!("{pixel} cube {}, {} levels", settings.size, rungs.len())
        }
        Content::Skybox => format!("{pixel} cube {}, 1 level", settings.size),
        Content::Irradiance => {
            format!("{pixel} irradiance cube {}", settings.irradiance.unwrap_or(plan.target.irradiance_size))
        }
        Content::ShJson | Content::ShText => "spherical harmonics".to_owned(),
    })
}

/// The preset with what `args` override.
fn planned(mut plan: Plan, args: &BakeArgs) -> Outcome<(Plan, BakeSettings)> {
    let target = plan.target;
    if let Some(format) = args.format {
        let Some(container) = container(format) else {
            return usage(format!(
                "--format {} is a folder of faces and does not go with --target; ktx2, ktx and dds do",
                format.name()
            ));
        };
        plan.container = container;
    }
    plan.pixel = args.pixel.map_or(plan.pixel, Pixel::from);
    plan.flip = args.flip.map_or(plan.flip, Into::into);
    plan.diffuse = args.diffuse.map_or(plan.diffuse, Into::into);
    if let Err(error) = args.filter.check(args.lobe.into(), args.table.oem_size) {
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
        size,
        levels: Some(args.levels.unwrap_or_else(|| target.levels(size))),
        ladder: args.ladder.map_or(target.ladder, Ladder::from),
        lobe: args.lobe.into(),
        filter: args.filter,
        oem_size: args.table.oem_size,
        border: args.table.border,
        bounds: false,
        irradiance: cube.then(|| args.irradiance.unwrap_or(target.irradiance_size)),
    };
    match settings.rungs() {
        Ok(_) => Ok((plan, settings)),
        Err(error) => usage(format!("target {}: {error}", target.name)),
    }
}
