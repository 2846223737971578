//! `octagloss bake`: environments into prefiltered cube chains.

use super::args::{BakeArgs, EngineArgs, InputArgs};
use super::engine::{Baker, Engine};
use super::input::{self, Opened, Source};
use super::output::{Encoding, Extras, Outputs, Stored, SunFile};
use super::talk::{self, Talk};
use super::values::{FormatArg, LayoutArg, LobeArg, OutLayoutArg, PixelArg};
use super::{Failure, Outcome, bake_targets, on_threads, print, unchanged, usage};
use anyhow::anyhow;
use blake3::Hash;
use octagloss::bake::{Bake, BakeSettings, Filter, Ladder};
use octagloss::io::cube_write::Container;
use octagloss::io::exr_write::ExrPixel;
use octagloss::io::output::{self, Existing};
use octagloss::io::pixels::Pixel;
use octagloss::oracle::Oracle;
use octagloss::overflow::Overflow;
use octagloss::report::Circumstances;
use octagloss::sphere::cube::{Face, direction_from_texel};
use octagloss::{Environment, Map};
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
    if !args.target.is_empty() {
        return bake_targets::run(args);
    }
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
        let options = unchanged::options(&args, &format!("{encoding:?}"));
        let existing = if args.force { Existing::Replace } else { Existing::Keep };
        let sources = input::sources(std::mem::take(&mut args.inputs), &args.input)?;
        let format = encoding.format();
        let suffix = match format {
            FormatArg::Ktx2 => ".ktx2",
            FormatArg::Ktx => ".ktx",
            FormatArg::Dds => ".dds",
            FormatArg::Exr if encoding.is_single() => ".exr",
            FormatArg::Exr | FormatArg::Hdr => "",
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
        let several = sources.len() > 1;
        let folder = args.output.clone().filter(|_| several);
        let jobs: Vec<Job> = sources
            .into_iter()
            .map(|source| {
                let name = PathBuf::from(source.stem() + suffix);
                let main = match &args.output {
                    Some(folder) if several => folder.join(name),
                    Some(path) => path.clone(),
                    None => name,
                };
                let extras =
                    Extras { json: args.json, sun: SunFile::asked(&args), preview: args.preview.clone() };
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
            overflow: args.overflow.into(),
            engine: args.engine,
            skip_unchanged: args.skip_unchanged,
            options,
        })
    }

    /// What would be written, a line a file.
    fn foretell(&self) -> Outcome {
        let fresh = self.fresh_folder()?;
        let mut text = String::new();
        for job in &self.jobs {
            job.source.check()?;
            if self.is_up_to_date(job) {
                continue;
            }
            job.outputs.check(fresh)?;
            for (path, content) in job.outputs.files(&self.settings)? {
                text += &format!("{}\t{content}\n", path.display());
            }
        }
        print(&text)
    }

    /// The folder for several outputs, where it is yet to be made.
    fn fresh_folder(&self) -> Outcome<Option<&Path>> {
        let fresh = self.folder.as_deref().filter(|folder| !folder.exists());
        match (&self.folder, fresh) {
            (Some(folder), None) if !folder.is_dir() => {
                return Err(anyhow!("{}: is a file; several inputs need a folder", folder.display()).into());
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
                talk::error(&format!("{error:#}"));
                failed = true;
                Ok(())
            }
            other => Err(other),
        };
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
        unchanged::request(&job.source, &self.options)
    }

    fn bake(&self, job: &Job, engine: &OnceCell<Engine>, talk: &Talk) -> Outcome {
        let start = Instant::now();
        // Before it is read: should it change meanwhile, it is found changed.
        let request = self.request(job)?;
        let opened = job.source.open(&self.input, talk)?;
        let engine = self.engine.chosen(engine, talk)?;
        if self.settings.filter == Filter::Reference {
            let seconds = foretell(&opened.environment, &self.settings)?;
            talk.note(&format!(
                "{}: the reference filter will take about {}",
                job.source.path().display(),
                talk::duration(seconds)
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
        let told = Told { source: &job.source, opened: &opened, input: &self.input, baker: &baker, start };
        let circumstances = |stored: Stored| {
            let mut warnings = opened.warnings.clone();
            for warning in stored_warnings(&stored, job.outputs.encoding) {
                talk.warn(&format!("{}: {warning}", job.outputs.main.display()));
                warnings.push(warning);
            }
            told.circumstances(stored, warnings)
        };
        let compressed = match job.outputs.encoding.clamping_pixel() {
            Some(pixel) => compress(&mut baked, self.overflow, pixel).map_err(|error| {
                anyhow::Error::from(error).context(job.outputs.main.display().to_string())
            })?,
            None => 0,
        };
        let (report, bytes) =
            job.outputs.write(&self.settings, &baked, compressed, request, &opened, circumstances)?;
        let bound = match report.error_bound_max() {
            Some(bound) => format!("greatest error bound {bound:.3e}"),
            None => "no error bound".to_owned(),
        };
        talk.note(&format!(
            "{}: {} in {:.2} s on {}, OEM {} + {}, {bound}",
            job.outputs.main.display(),
            talk::bytes(bytes),
            start.elapsed().as_secs_f64(),
            report.engine,
            report.oem.size,
            report.oem.border,
        ));
        if self.json {
            let line = serde_json::to_string(&report).map_err(anyhow::Error::from)?;
            print(&(line + "\n"))?;
        }
        Ok(())
    }
}

/// What a report tells of an environment and its bake, however it is stored.
pub(super) struct Told<'a> {
    pub(super) source: &'a Source,
    pub(super) opened: &'a Opened,
    pub(super) input: &'a InputArgs,
    pub(super) baker: &'a Baker,
    pub(super) start: Instant,
}

impl Told<'_> {
    pub(super) fn circumstances(&self, stored: Stored, warnings: Vec<String>) -> Circumstances {
        Circumstances {
            input: self.source.path().display().to_string(),
            engine: self.baker.engine.to_owned(),
            adapter: self.baker.adapter.clone(),
            repaired: self.opened.repaired.into(),
            layout: self.opened.layout.to_owned(),
            rotate_y: self.input.rotate_y.unwrap_or(0.0),
            mirror: self.input.mirror,
            sanitize: self.input.sanitize,
            extract_sun: self.input.extract_sun,
            sun: self.opened.sun.clone(),
            format: stored.format.to_owned(),
            pixel: stored.pixel.to_owned(),
            level_pixels: stored.pixels,
            clamped: stored.clamped,
            warnings,
            seconds: self.start.elapsed().as_secs_f64(),
        }
    }
}

/// Prepares every level of `baked` for `pixel`; the texels that were scaled down.
pub(super) fn compress(baked: &mut Bake, overflow: Overflow, pixel: Pixel) -> octagloss::Result<u64> {
    let sheen = baked.sheen.as_mut().map_or(&mut [][..], |sheen| &mut sheen.levels);
    let levels = baked.chain.levels.iter_mut().chain(baked.irradiance.as_mut()).chain(sheen);
    let cubes: u64 =
        levels.enumerate().map(|(index, level)| overflow.apply(index, level, pixel)).sum::<Result<_, _>>()?;
    let images = baked.images.iter_mut().enumerate();
    let images: u64 =
        images.map(|(index, level)| overflow.apply_image(index, level, pixel)).sum::<Result<_, _>>()?;
    Ok(cubes + images)
}

impl Job {
    /// Outputs must differ from one another and from every input of `jobs`.
    fn check_places(&self, jobs: &[Self]) -> Outcome {
        let places: Vec<PathBuf> = self.outputs.places().collect();
        for (index, place) in places.iter().enumerate() {
            if places[..index].contains(place) {
                return usage(format!("{} is named for two outputs", place.display()));
            }
            let Ok(real) = place.canonicalize() else { continue };
            let inputs = jobs.iter().flat_map(|job| job.source.files());
            if inputs.filter_map(|input| input.canonicalize().ok()).any(|input| input == real) {
                return usage(format!("{} is an input; name another output with -o", place.display()));
            }
        }
        Ok(())
    }
}

fn settings(args: &BakeArgs) -> Outcome<BakeSettings> {
    if args.lobe == LobeArg::Cosine && args.levels.is_some_and(|levels| levels > 1) {
        return usage("--lobe cosine has no roughness and bakes one level; leave --levels out");
    }
    if args.bounds && !matches!(args.filter, Filter::Adaptive(_)) {
        return usage("--bounds needs --filter adaptive:E; the others certify nothing");
    }
    if let Some(layout) = args.out_layout.filter(|layout| *layout != OutLayoutArg::Faces) {
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
    let settings = BakeSettings {
        map: args.out_layout.map_or(Map::Cube, OutLayoutArg::map),
        size: args.size.unwrap_or(256),
        levels: args.levels,
        ladder: args.ladder.map_or(Ladder::Linear, Ladder::from),
        lobe: args.lobe.into(),
        filter: args.filter,
        oem_size: args.table.oem_size,
        border: args.table.border,
        bounds: args.bounds,
        irradiance: args.irradiance,
        sh_order: args.sh_order,
        sh_window: args.sh_window,
        sheen: false,
    };
    match settings.rungs() {
        Ok(_) => Ok(settings),
        Err(error) => usage(error.to_string()),
    }
}

/// Extensions of formats that are not written: a file so named would belie its content.
const FOREIGN: [&str; 11] =
    ["basis", "bmp", "gif", "jpeg", "jpg", "pfm", "png", "tga", "tif", "tiff", "webp"];

/// The format as said, else by the output's extension, else ktx2, and the pixels it can have.
fn encoding(args: &BakeArgs) -> Outcome<Encoding> {
    let named = args.output.as_deref().and_then(extension).and_then(|extension| match extension.as_str() {
        "ktx2" => Some(FormatArg::Ktx2),
        "ktx" => Some(FormatArg::Ktx),
        "dds" => Some(FormatArg::Dds),
        "exr" => Some(FormatArg::Exr),
        "hdr" => Some(FormatArg::Hdr),
        _ => None,
    });
    let output = || args.output.as_deref().unwrap_or(Path::new("")).display().to_string();
    let foreign = args.output.as_deref().and_then(extension).filter(|name| FOREIGN.contains(&name.as_str()));
    if let Some(foreign) = foreign {
        return usage(format!(
            "the output {} is named .{foreign}, which cannot be written; ktx2, ktx, dds, exr and hdr can",
            output()
        ));
    }
    let several = args.inputs.len() > 1 && args.input.layout != LayoutArg::Faces;
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
            Some(layout) if layout != OutLayoutArg::Faces => FormatArg::Exr,
            _ => FormatArg::Ktx2,
        }),
    };
    if let Some(layout) = args.out_layout.filter(|layout| *layout != OutLayoutArg::Faces) {
        return image_encoding(args, format, layout);
    }
    match (format, args.pixel) {
        (FormatArg::Ktx2 | FormatArg::Ktx | FormatArg::Dds, pixel) => {
            let container = container(format).expect("these three are");
            let pixel = pixel.map_or(Pixel::F16, Pixel::from);
            if !container.holds(pixel) {
                return usage(format!(
                    "--pixel {} does not go into {}; ktx2 and dds take it",
                    pixel.name(),
                    container.name()
                ));
            }
            Ok(Encoding::Cube(container, pixel))
        }
        (FormatArg::Exr, None) => Ok(Encoding::Exr(ExrPixel::Auto)),
        (FormatArg::Exr, Some(PixelArg::F16)) => Ok(Encoding::Exr(ExrPixel::F16)),
        (FormatArg::Exr, Some(PixelArg::F32)) => Ok(Encoding::Exr(ExrPixel::F32)),
        (FormatArg::Exr, Some(other)) => {
            usage(format!("--pixel {} is for ktx2 and dds; exr has f16 and f32", Pixel::from(other).name()))
        }
        (FormatArg::Hdr, None) => Ok(Encoding::Hdr),
        (FormatArg::Hdr, Some(_)) => usage("--pixel does not go with hdr, whose pixels are always RGBE"),
    }
}

/// How `layout`, which is not faces, is stored in `format`.
fn image_encoding(args: &BakeArgs, format: FormatArg, layout: OutLayoutArg) -> Outcome<Encoding> {
    let single = matches!(layout, OutLayoutArg::Parts | OutLayoutArg::Mips);
    if single && format != FormatArg::Exr {
        return usage(format!("--out-layout {} is an exr file, not {}", layout.name(), format.name()));
    }
    let pixel = match (format, args.pixel) {
        (FormatArg::Exr, None) => ExrPixel::Auto,
        (FormatArg::Exr, Some(PixelArg::F16)) => ExrPixel::F16,
        (FormatArg::Exr, Some(PixelArg::F32)) => ExrPixel::F32,
        (FormatArg::Hdr, None) => return Ok(Encoding::HdrImages(layout)),
        (FormatArg::Exr | FormatArg::Hdr, Some(_)) => {
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
    let one = if pixel == ExrPixel::F32 { Pixel::F32 } else { Pixel::F16 };
    Ok(match layout {
        OutLayoutArg::Parts => Encoding::Cube(Container::Exr, one),
        OutLayoutArg::Mips => Encoding::Mips(one),
        _ => Encoding::ExrImages(layout, pixel),
    })
}

/// The container that `format` is, where it holds a chain in one file.
pub(super) const fn container(format: FormatArg) -> Option<Container> {
    match format {
        FormatArg::Ktx2 => Some(Container::Ktx2),
        FormatArg::Ktx => Some(Container::Ktx1),
        FormatArg::Dds => Some(Container::Dds),
        FormatArg::Exr | FormatArg::Hdr => None,
    }
}

fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

fn stored_warnings(stored: &Stored, encoding: Encoding) -> Vec<String> {
    let mut warnings = Vec::new();
    if stored.clamped > 0 {
        warnings.push(format!(
            "{} texels are brighter than the pixel format can hold and were clamped; --pixel f32 keeps them",
            stored.clamped
        ));
    }
    let may_be_floats =
        matches!(encoding, Encoding::Exr(ExrPixel::Auto) | Encoding::ExrImages(_, ExrPixel::Auto));
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
    for level in settings.rungs()? {
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
