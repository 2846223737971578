//! `octagloss bake`: environments into prefiltered cube chains.

use super::args::BakeArgs;
use super::bake_context::Told;
use super::console::{self, Talk};
use super::engine::Engine;
use super::fingerprint;
use super::input::{self, Source};
use super::outcome::{Failure, Outcome, is_stdout, on_threads, print, usage};
use super::output::{
    Encoding, Extras, FOREIGN, Outputs, Stored, Stream, SunFile, check_folder_name, extension, foretold,
    named_format, names_folder,
};
use super::shared_args::{EngineArgs, InputArgs};
use anyhow::anyhow;
use blake3::Hash;
use octagloss::analysis::oracle::Oracle;
use octagloss::bake::overflow::{self, Overflow};
use octagloss::bake::report::Report;
use octagloss::bake::{Bake, BakeSettings};
use octagloss::filter::Filter;
use octagloss::format::container::Container;
use octagloss::format::{OutputLayout, Pixel};
use octagloss::io::LayoutChoice;
use octagloss::io::output::{self, Existing};
use octagloss::lobe::Lobe;
use octagloss::sphere::cube::{Face, direction_from_texel};
use octagloss::{Environment, Map, memory};
use rayon::prelude::*;
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What is to be done, checked.
struct Plan {
    settings: BakeSettings,
    jobs: Vec<Job>,
    /// The folder for several outputs.
    folder: Option<PathBuf>,
    input: InputArgs,
    json: bool,
    overflow: Overflow,
    engine: EngineArgs,
    sunless: bool,
    skip_unchanged: bool,
    /// All that the outputs depend on besides their inputs.
    options: String,
}

/// One environment and where it goes.
struct Job {
    source: Source,
    outputs: Outputs,
}

pub(super) fn run(args: BakeArgs) -> Outcome {
    let talk = Talk::new(args.quiet);
    args.engine.check()?;
    let (threads, dry_run) = (args.engine.threads, args.dry_run);
    let plan = Plan::new(args)?;
    if dry_run {
        return plan.foretell();
    }
    on_threads(threads, || plan.run(&talk))
}

impl Plan {
    fn new(mut args: BakeArgs) -> Outcome<Self> {
        let settings = settings(&args)?;
        let encoding = encoding(&args)?;
        let options = fingerprint::options(&args, &format!("{encoding:?}"));
        let existing = if args.force { Existing::Replace } else { Existing::Keep };
        let sources = input::sources(std::mem::take(&mut args.inputs), &args.input)?;
        let format = encoding.format();
        let suffix = match format {
            Container::Ktx2 => ".ktx2",
            Container::Ktx1 => ".ktx",
            Container::Dds => ".dds",
            Container::Exr if encoding.is_single() => ".exr",
            Container::Exr | Container::Hdr => "",
        };

        if let Some(path) = &args.preview {
            if extension(path) != Some("png".to_owned()) {
                return usage(format!("--preview {} must end in .png", path.display()));
            }
            if sources.len() > 1 {
                return usage("--preview takes one input, since it names one picture");
            }
        }
        let mut by_stem = BTreeMap::new();
        for source in &sources {
            if let Some(other) = by_stem.insert(source.stem(), source.path()) {
                return usage(format!(
                    "{} and {} would both be written as {}{suffix}; rename one or bake them apart",
                    other.display(),
                    source.path().display(),
                    source.stem()
                ));
            }
        }
        let stdout = match &args.output {
            Some(path) => is_stdout(path)?,
            None => false,
        };
        if stdout {
            check_stdout(&args, encoding, sources.len())?;
        }
        let several = sources.len() > 1;
        let within = several || (encoding.is_single() && args.output.as_deref().is_some_and(names_folder));
        let folder = args.output.clone().filter(|_| within);
        let jobs: Vec<Job> = sources
            .into_iter()
            .map(|source| {
                let name = PathBuf::from(source.stem() + suffix);
                let main = match &args.output {
                    Some(folder) if within => folder.join(name),
                    Some(path) => path.clone(),
                    None => name,
                };
                let extras = Extras {
                    stream: if stdout { Stream::Stdout } else { Stream::Place },
                    json: args.json,
                    sun: SunFile::asked(&args),
                    preview: args.preview.clone(),
                    exposure: args.exposure,
                };
                let outputs = Outputs::around(main, encoding, existing, &settings, extras);
                Job { source, outputs }
            })
            .collect();
        for job in &jobs {
            job.check_places(&jobs)?;
        }
        Ok(Self {
            settings,
            jobs,
            folder,
            input: args.input,
            json: args.json,
            overflow: args.overflow,
            engine: args.engine,
            sunless: args.sunless,
            skip_unchanged: args.skip_unchanged,
            options,
        })
    }

    /// Prints what would be written: a line a file, or with `--json` a line an input.
    fn foretell(&self) -> Outcome {
        let fresh = self.fresh_folder()?;
        let mut text = String::new();
        for job in &self.jobs {
            job.source.check()?;
            if self.is_up_to_date(job) {
                continue;
            }
            job.outputs.check(fresh)?;
            let files = job.outputs.files(&self.settings)?;
            text += &foretold(&job.source, files, self.json);
        }
        print(&text)
    }

    /// The folder for several outputs, where it is yet to be made.
    fn fresh_folder(&self) -> Outcome<Option<&Path>> {
        let fresh = self.folder.as_deref().filter(|folder| !folder.exists());
        match (&self.folder, fresh) {
            (Some(folder), None) if !folder.is_dir() => {
                let message = "is a file; several inputs, and names that end in /, need a folder";
                return Err(anyhow!("{}: {message}", folder.display()).into());
            }
            (_, Some(fresh)) => output::check_folder(fresh, Existing::Keep)?,
            _ => {}
        }
        Ok(fresh)
    }

    /// Whether `job` is to be left alone.
    fn is_up_to_date(&self, job: &Job) -> bool {
        self.skip_unchanged && self.request(job).is_ok_and(|request| job.outputs.holds(request))
    }

    fn run(&self, talk: &Talk) -> Outcome {
        let mut failed = false;
        let mut tell = |failure: Failure| match failure {
            Failure::Failed(error) => {
                console::error(&format!("{error:#}"));
                failed = true;
                Ok(())
            }
            other => Err(other),
        };
        for job in &self.jobs {
            job.outputs.recover(talk);
        }
        // What cannot be written is told before anything is baked.
        let fresh = self.fresh_folder()?;
        let mut ready = Vec::new();
        for job in &self.jobs {
            if self.is_up_to_date(job) {
                talk.note(&format!("{}: unchanged", job.outputs.main.display()));
                continue;
            }
            match job.outputs.check(fresh) {
                Ok(()) => ready.push(job),
                Err(error) => tell(error.into())?,
            }
        }
        let engine = OnceCell::new();
        for job in ready {
            if let Err(failure) = self.bake(job, &engine, talk) {
                tell(failure)?;
            }
        }
        if failed { Err(Failure::Told) } else { Ok(()) }
    }

    /// The hash of what `job` is made of.
    fn request(&self, job: &Job) -> octagloss::Result<Hash> {
        fingerprint::request(&job.source, &self.options)
    }

    fn bake(&self, job: &Job, engine: &OnceCell<Engine>, talk: &Talk) -> Outcome {
        let start = Instant::now();
        // Before it is read: should it change meanwhile, it is found changed.
        let (request, input_files) = fingerprint::requested(&job.source, &self.options)?;
        let opened = job.source.open(&self.input, talk)?;
        let encoded = job.outputs.encoding.texel_bytes();
        memory::check_bake(&opened.environment, std::slice::from_ref(&self.settings), encoded)?;
        let engine = self.engine.chosen(engine, talk)?;
        if self.settings.filter == Filter::Reference {
            let seconds = foretell(&opened.environment, &self.settings)?;
            talk.note(&format!(
                "{}: the reference filter will take about {}",
                job.source.path().display(),
                console::duration(seconds)
            ));
        }
        let bar = talk.bar(&job.source.stem());
        let (mut baked, baker) =
            engine.bake(&opened.environment, &self.settings, talk, &|progress| bar.bake(progress))?;
        drop(bar);
        baked.warnings.dedup();
        for warning in &baked.warnings {
            talk.warn(&format!("{}: {warning}", job.source.path().display()));
        }

        if let Some(folder) = &self.folder {
            fs::create_dir_all(folder).map_err(|e| octagloss::Error::io(folder, e))?;
        }
        let pixel = job.outputs.encoding.pixel();
        let compressed = self
            .overflow
            .apply_all(&mut baked, pixel)
            .map_err(|error| anyhow::Error::from(error).context(job.outputs.main.display().to_string()))?;
        let clamped_share = overflow::clamped_share(&baked, pixel);
        let told = Told {
            source: &job.source,
            input_files,
            opened: &opened,
            input: &self.input,
            sunless: self.sunless,
            overflow: self.overflow,
            preview: job.outputs.preview.is_some(),
            baker: &baker,
            start,
        };
        let encoding = job.outputs.encoding;
        let vanished = vanished(&baked, pixel.name(), pixel.rounded_to_zero());
        let circumstances = |stored: Stored| {
            let mut warnings = opened.warnings.clone();
            for warning in
                stored_warnings(&stored, clamped_share, encoding).into_iter().chain(vanished.clone())
            {
                talk.warn(&format!("{}: {warning}", job.outputs.main.display()));
                warnings.push(warning);
            }
            told.circumstances(stored, clamped_share, warnings)
        };
        let (report, bytes) =
            job.outputs.write(&self.settings, &baked, compressed, request, &opened, circumstances)?;
        talk.note(&format!(
            "{}: {} in {:.2} s on {}, OEM {} + {}, {}",
            job.outputs.main.display(),
            console::bytes(bytes),
            start.elapsed().as_secs_f64(),
            report.engine,
            report.oem.size,
            report.oem.border,
            certified(&report),
        ));
        if self.json {
            let line = serde_json::to_string(&report).map_err(anyhow::Error::from)?;
            print(&(line + "\n"))?;
        }
        Ok(())
    }
}

/// What the bounds of `report` certify: how far from exact the texels are at most, relative to the
/// environment's mean luminance, and the greatest bound itself.
pub(super) fn certified(report: &Report) -> String {
    let (Some(most), Some(p99)) = (report.error_bound_max(), report.error_bound_p99()) else {
        return "nothing certified".to_owned();
    };
    let percent = |bound: f64| console::percent(report.relative_bound(bound));
    format!(
        "certified within {} of the mean luminance for 99 % of each level's texels, {} for all (luminance {most:.2e})",
        percent(p99),
        percent(most),
    )
}

/// Whether a share of energy is worth a warning: not one that rounds to 0.00 %.
pub(super) fn share_matters(share: f64) -> bool {
    share >= 5e-5
}

impl Job {
    /// Outputs must differ from one another and from every input of `jobs`.
    fn check_places(&self, jobs: &[Self]) -> Outcome {
        let places: Vec<PathBuf> = self.outputs.places().collect();
        for (index, place) in places.iter().enumerate() {
            let others = jobs.iter().filter(|job| !std::ptr::eq(*job, self));
            if places[..index].contains(place)
                || others.flat_map(|job| job.outputs.places()).any(|p| p == *place)
            {
                return usage(format!("{} is named for two outputs", place.display()));
            }
            let Ok(real) = place.canonicalize() else { continue };
            let inputs = jobs.iter().flat_map(|job| job.source.files());
            let mut inputs = inputs.filter_map(|input| input.canonicalize().ok());
            if let Some(input) = inputs.find(|input| input.starts_with(&real)) {
                let what = if input == real { "is an input" } else { "holds an input" };
                return usage(format!("{} {what}; name another output with -o", place.display()));
            }
        }
        Ok(())
    }
}

fn settings(args: &BakeArgs) -> Outcome<BakeSettings> {
    if args.lobe == Lobe::Cosine && args.levels.is_some_and(|levels| levels > 1) {
        return usage("--lobe cosine has no roughness and bakes one level; leave --levels out");
    }
    if args.bounds && !matches!(args.filter, Filter::Adaptive(_)) {
        return usage("--bounds needs --filter adaptive:E; the others certify nothing");
    }
    if let Some(layout) = args.out_layout.filter(|layout| *layout != OutputLayout::Faces) {
        let name = layout.name();
        if args.bounds {
            return usage(format!("--bounds is for --out-layout faces, not {name}"));
        }
        if args.preview.is_some() && layout.map() != Map::Cube {
            return usage(format!("--preview shows cubes; leave it or --out-layout {name} out"));
        }
        if args.irradiance.is_some() && layout.map() != Map::Cube {
            return usage(format!("--irradiance is a cube; leave it or --out-layout {name} out"));
        }
    }
    let map = args.out_layout.map_or(Map::Cube, OutputLayout::map);
    let (ladder, lobe) = (args.ladder.unwrap_or_default(), args.lobe);
    // The format has every level down to one texel, whatever a look-up makes of them.
    let every_level = args.out_layout == Some(OutputLayout::Mips);
    let size = args.size.unwrap_or(if every_level { 256 } else { ladder.default_size(map, lobe) });
    let settings = BakeSettings {
        map,
        size,
        levels: args.levels.or(every_level.then(|| map.most_levels(size))),
        ladder,
        lobe,
        filter: args.filter,
        oem_size: args.table.oem_size,
        border: args.table.border,
        bounds: args.bounds,
        irradiance: args.irradiance,
        sh_order: args.sh_order,
        sh_window: args.sh_window,
        sheen: false,
    };
    match settings.level_specs() {
        Ok(_) => Ok(settings),
        Err(error) => usage(error.to_string()),
    }
}

/// Refuses what does not go to standard output.
fn check_stdout(args: &BakeArgs, encoding: Encoding, inputs: usize) -> Outcome {
    if inputs > 1 {
        return usage("-o - takes one input; name a folder with -o for several");
    }
    if !encoding.is_single() {
        return usage(
            "-o - takes an output of one file: ktx2, ktx, dds, or exr with --out-layout parts or mips; name a \
             folder with -o",
        );
    }
    let beside = [
        (args.json, "--json"),
        (args.skip_unchanged, "--skip-unchanged"),
        (args.preview.is_some(), "--preview"),
        (args.irradiance.is_some(), "--irradiance"),
        (args.bounds, "--bounds"),
        (args.input.extract_sun, "--extract-sun"),
    ];
    match beside.into_iter().find(|(asked, _)| *asked) {
        Some((_, option)) => usage(format!(
            "-o - writes one file to standard output, and nothing beside it; leave {option} out or name a file with -o"
        )),
        None => Ok(()),
    }
}

/// The format as said, else by the output's extension, else ktx2, and the pixels it can have.
fn encoding(args: &BakeArgs) -> Outcome<Encoding> {
    let encoding = named_encoding(args)?;
    if let Some(path) = args.output.as_deref().filter(|_| !encoding.is_single()) {
        let name = encoding.format().name();
        let remedy = format!(" (with --format {name}), and --out-layout parts writes one .exr file");
        check_folder_name(path, &remedy)?;
    }
    Ok(encoding)
}

fn named_encoding(args: &BakeArgs) -> Outcome<Encoding> {
    let file = args.output.as_deref().filter(|path| !names_folder(path));
    let named = file.and_then(named_format);
    let output = || args.output.as_deref().unwrap_or(Path::new("")).display().to_string();
    let foreign = file.and_then(extension).filter(|name| FOREIGN.contains(&name.as_str()));
    if let Some(foreign) = foreign {
        return usage(format!(
            "the output {} is named .{foreign}, which cannot be written; ktx2, ktx, dds, exr and hdr can",
            output()
        ));
    }
    let several = args.inputs.len() > 1 && args.input.layout != LayoutChoice::Faces;
    if let (true, Some(_)) = (several, named) {
        return usage(format!("several inputs are written into a folder; {} names a file", output()));
    }
    let format = match (args.format, named) {
        (Some(said), Some(named)) if said != named => {
            return usage(format!(
                "--format {} and the output {} contradict each other; leave one out",
                said.name(),
                output()
            ));
        }
        (said, named) => said.or(named).unwrap_or(match args.out_layout {
            Some(layout) if layout != OutputLayout::Faces => Container::Exr,
            _ => Container::Ktx2,
        }),
    };
    if let Some(layout) = args.out_layout.filter(|layout| *layout != OutputLayout::Faces) {
        return image_encoding(args, format, layout);
    }
    match (format, args.pixel) {
        (container @ (Container::Ktx2 | Container::Ktx1 | Container::Dds), pixel) => {
            let pixel = pixel.unwrap_or_default();
            if !container.holds(pixel) {
                return usage(format!(
                    "--pixel {} does not go into {}; ktx2 and dds take it",
                    pixel.name(),
                    container.name()
                ));
            }
            Ok(Encoding::Cube(container, pixel))
        }
        (Container::Exr, None) => Ok(Encoding::Exr(Pixel::Auto)),
        (Container::Exr, Some(Pixel::F16)) => Ok(Encoding::Exr(Pixel::F16)),
        (Container::Exr, Some(Pixel::F32)) => Ok(Encoding::Exr(Pixel::F32)),
        (Container::Exr, Some(other)) => {
            usage(format!("--pixel {} is for ktx2 and dds; exr has f16 and f32", other.name()))
        }
        (Container::Hdr, None) => Ok(Encoding::Hdr),
        (Container::Hdr, Some(_)) => usage("--pixel does not go with hdr, whose pixels are always RGBE"),
    }
}

/// How `layout`, which is not faces, is stored in `format`.
fn image_encoding(args: &BakeArgs, format: Container, layout: OutputLayout) -> Outcome<Encoding> {
    let single = matches!(layout, OutputLayout::Parts | OutputLayout::Mips);
    if single && format != Container::Exr {
        return usage(format!("--out-layout {} is an exr file, not {}", layout.name(), format.name()));
    }
    let pixel = match (format, args.pixel) {
        (Container::Exr, None) => Pixel::Auto,
        (Container::Exr, Some(Pixel::F16)) => Pixel::F16,
        (Container::Exr, Some(Pixel::F32)) => Pixel::F32,
        (Container::Hdr, None) => return Ok(Encoding::HdrImages(layout)),
        (Container::Exr | Container::Hdr, Some(_)) => {
            return usage("--pixel f16 and f32 go with exr, none with hdr");
        }
        _ => {
            return usage(format!(
                "--out-layout {} is for exr and hdr, not {}",
                layout.name(),
                format.name()
            ));
        }
    };
    let one = if pixel == Pixel::F32 { Pixel::F32 } else { Pixel::F16 };
    Ok(match layout {
        OutputLayout::Parts => Encoding::Cube(Container::Exr, one),
        OutputLayout::Mips => Encoding::Mips(one),
        _ => Encoding::ExrImages(layout, pixel),
    })
}

/// A warning where light is there, but all of it is so dim that pixels called `name` round it to 0.
pub(super) fn vanished(bake: &Bake, name: &str, rounded_to_zero: f32) -> Option<String> {
    let greatest = bake.levels().flat_map(|level| level.texels.as_flattened()).copied().fold(0.0, f32::max);
    (greatest > 0.0 && greatest <= rounded_to_zero).then(|| {
        format!(
            "all light is below {name}, which rounds {greatest:e} and less to 0: the output is black; --pixel f32 \
             with ktx2 or exr keeps it"
        )
    })
}

fn stored_warnings(stored: &Stored, clamped_share: f64, encoding: Encoding) -> Vec<String> {
    let mut warnings = Vec::new();
    if stored.clamped > 0 && share_matters(clamped_share) {
        warnings.push(format!(
            "{} texels are brighter than the pixel format can hold and were clamped, {} of a level's energy; --pixel f32 \
             keeps them",
            stored.clamped,
            console::percent(clamped_share),
        ));
    }
    let may_be_floats = matches!(encoding, Encoding::Exr(Pixel::Auto) | Encoding::ExrImages(_, Pixel::Auto));
    if stored.floats > 0 && may_be_floats {
        warnings.push(format!(
            "{} of {} levels are stored as float, having values above 65504",
            stored.floats,
            stored.pixels.len()
        ));
    }
    warnings
}

/// Seconds that the reference filter will take: a few texels of each level are timed.
fn foretell(environment: &Environment, settings: &BakeSettings) -> octagloss::Result<f64> {
    let start = Instant::now();
    let oracle = Oracle::new(environment);
    let prepared = start.elapsed().as_secs_f64();
    let threads = rayon::current_num_threads();
    // As many texels as there are threads, one on each face in turn.
    let directions: Vec<_> =
        (0..threads).map(|k| direction_from_texel(Face::ALL[k % 6], 5, (k % 5) as u32, 1)).collect();
    let (mut seconds, mut last) = (prepared, 0.0);
    for level in settings.level_specs()? {
        let texels = level.layout.texel_count() as f64;
        // Lobes cost alike from level to level: once one is slow it stands for the rest.
        if last < 1.0 {
            let start = Instant::now();
            directions.par_iter().for_each(|direction| {
                std::hint::black_box(oracle.reflect(settings.lobe, level.roughness, *direction));
            });
            last = start.elapsed().as_secs_f64();
        }
        seconds += last * texels / threads as f64;
    }
    Ok(seconds)
}
