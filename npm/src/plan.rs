//! Converts options to target plans and bake settings, by the rules of the command line.

use crate::given::{Given, wrong};
use octagloss::files::{Container, OutputLayout, Pixel};
use octagloss::internals::bake::overflow::Overflow;
use octagloss::internals::chain::ChainKind;
use octagloss::internals::filter;
use octagloss::internals::image::exposure::Exposure;
use octagloss::internals::lobe::LOBES;
use octagloss::internals::sh::MAX_ORDER;
use octagloss::internals::sh::window::{self, ShWindow};
use octagloss::internals::target::{Diffuse, Flip, TARGETS, Target, TargetPlan, UNTARGETED};
use octagloss::{BakeSettings, Filter, Ladder, Layout, Lobe, Map, Result, Scan};

/// Maximum edge of a cube or an octahedral map, in texels.
const MAX_SIZE: u32 = 16_384;

/// Size of a skybox.
#[derive(Clone, Copy)]
pub(crate) enum Skybox {
    Edge(u32),
    /// Same texel size as the source.
    Source,
}

impl Skybox {
    fn of(text: &str) -> Result<Self> {
        if text == "source" {
            return Ok(Self::Source);
        }
        match text.parse() {
            Ok(edge) if (1..=MAX_SIZE).contains(&edge) => Ok(Self::Edge(edge)),
            _ => wrong(format!(
                "`skybox` is {text}; a whole number from 1 to {MAX_SIZE}, or source, is needed"
            )),
        }
    }

    fn edge(self, layout: Layout) -> u32 {
        let own = match (self, layout) {
            (Self::Edge(edge), _) => edge,
            (_, Layout::Panorama { width, .. }) => width.div_ceil(4),
            (_, Layout::Cube { size }) => size,
            (_, Layout::Octahedral { size }) => size.div_ceil(2),
        };
        own.clamp(1, MAX_SIZE)
    }
}

/// Files to write, and the settings of their bake.
pub(crate) struct Plan {
    pub(crate) files: TargetPlan,
    pub(crate) settings: BakeSettings,
    /// A costly choice of ladder or levels.
    pub(crate) warning: Option<String>,
}

/// What to bake, and what to make of it.
pub(crate) struct Request {
    pub(crate) plans: Vec<Plan>,
    skybox: Option<Skybox>,
    /// Base name of the files; the input's by default.
    pub(crate) name: Option<String>,
    pub(crate) overflow: Overflow,
    pub(crate) preview: bool,
    pub(crate) exposure: Exposure,
    pub(crate) sunless: bool,
}

/// The options of a bake besides those of its input.
struct Options {
    size: Option<u32>,
    levels: Option<u32>,
    ladder: Option<Ladder>,
    chain: Option<ChainKind>,
    lobe: Lobe,
    filter: Filter,
    format: Option<Container>,
    out_layout: Option<OutputLayout>,
    pixel: Option<Pixel>,
    irradiance: Option<u32>,
    skybox: Option<Skybox>,
    sh_order: u32,
    sh_window: ShWindow,
    flip: Option<Flip>,
    diffuse: Option<Diffuse>,
    bounds: bool,
    oem_size: Option<u32>,
    border: Option<u32>,
    scan: Option<Scan>,
}

fn containers() -> [(&'static str, Container); 5] {
    [Container::Ktx2, Container::Ktx1, Container::Dds, Container::Exr, Container::Hdr]
        .map(|container| (container.name(), container))
}

fn pixels() -> [(&'static str, Pixel); 5] {
    [Pixel::F16, Pixel::F32, Pixel::Rgb9e5, Pixel::R11g11b10, Pixel::Bc6h].map(|pixel| (pixel.name(), pixel))
}

fn out_layouts() -> [(&'static str, OutputLayout); 9] {
    [
        OutputLayout::Faces,
        OutputLayout::Cross,
        OutputLayout::CrossVertical,
        OutputLayout::Strip,
        OutputLayout::StripVertical,
        OutputLayout::Equirect,
        OutputLayout::Octahedral,
        OutputLayout::Parts,
        OutputLayout::Mips,
    ]
    .map(|layout| (layout.name(), layout))
}

impl Request {
    /// Reads the options of a bake; checks them as far as the source does not matter.
    pub(crate) fn of(given: &mut Given, extract_sun: bool) -> Result<Self> {
        let mut targets: Vec<&'static Target> = Vec::new();
        for name in given.list("target")? {
            let Some(target) = Target::named(&name) else {
                let names: Vec<_> = TARGETS.iter().map(|target| target.name).collect();
                return wrong(format!("`target` is {name:?}; choose from {}", names.join(", ")));
            };
            if targets.contains(&target) {
                return wrong(format!("`target` names {name} twice"));
            }
            targets.push(target);
        }
        let skybox = given.number_or_text("skybox")?.map(|text| Skybox::of(&text)).transpose()?;
        let overflows = [Overflow::Clamp, Overflow::Compress, Overflow::Error].map(|how| (how.name(), how));
        let overflow = given.choice("overflow", &overflows)?.unwrap_or_default();
        let name = given.parsed_text("name", |name| match name {
            "" => Err("the name of a file is needed".to_owned()),
            _ if name.starts_with('.') || name.contains(['/', '\\', '\0']) => {
                Err("it must be a file name without folders or a leading dot".to_owned())
            }
            _ => Ok(name.to_owned()),
        })?;
        let preview = given.flag("preview")?;
        let exposure = match given.number_or_text("exposure")? {
            None => Exposure::Auto,
            Some(text) => match text.parse() {
                Ok(exposure) => exposure,
                Err(remedy) => return wrong(format!("`exposure` is {text}; it {remedy}")),
            },
        };
        let sunless = given.flag("sunless")?;
        if sunless && !extract_sun {
            return wrong("`sunless` writes the environment without its sun; set `extractSun` too");
        }
        let options = Options::of(given, skybox)?;
        let plans = if targets.is_empty() {
            vec![options.untargeted()?]
        } else {
            targets.into_iter().map(|target| options.targeted(target)).collect::<Result<_>>()?
        };
        Ok(Self { plans, skybox, name, overflow, preview, exposure, sunless })
    }

    /// The settings for a source of `layout`.
    pub(crate) fn settings(&self, layout: Layout) -> Vec<BakeSettings> {
        let edge = self.skybox.map(|skybox| skybox.edge(layout));
        self.plans.iter().map(|plan| BakeSettings { skybox: edge, ..plan.settings.clone() }).collect()
    }
}

impl Options {
    fn of(given: &mut Given, skybox: Option<Skybox>) -> Result<Self> {
        let options = Self {
            size: given.whole("size", 1..=MAX_SIZE)?,
            levels: given.whole("levels", 1..=15)?,
            ladder: given.choice("ladder", &Ladder::ALL.map(|ladder| (ladder.name(), ladder)))?,
            chain: given.choice("chain", &ChainKind::ALL.map(|kind| (kind.name(), kind)))?,
            lobe: given.choice("lobe", &LOBES.map(|lobe| (lobe.name(), lobe)))?.unwrap_or(Lobe::Ggx),
            filter: given.parsed_text("filter", filter::parsed)?.unwrap_or(Filter::Adaptive(0.005)),
            format: given.choice("format", &containers())?,
            out_layout: given.choice("outLayout", &out_layouts())?,
            pixel: given.choice("pixel", &pixels())?,
            irradiance: given.whole("irradiance", 1..=1024)?,
            skybox,
            sh_order: given.whole("shOrder", 2..=MAX_ORDER)?.unwrap_or(2),
            sh_window: given.parsed_text("shWindow", window::parsed)?.unwrap_or(ShWindow::None),
            flip: given.choice("flip", &[Flip::None, Flip::X, Flip::Z].map(|flip| (flip.name(), flip)))?,
            diffuse: given.choice(
                "diffuse",
                &[Diffuse::None, Diffuse::Cube, Diffuse::Sh, Diffuse::Both].map(|form| (form.name(), form)),
            )?,
            bounds: given.flag("bounds")?,
            oem_size: given.whole("oemSize", 1..=MAX_SIZE)?,
            border: given.whole("border", 0..=MAX_SIZE)?,
            scan: given.parsed_text("scan", str::parse)?,
        };
        if let Some(scan) = options.scan {
            options.filter.check_scan(scan)?;
        }
        Ok(options)
    }

    /// The settings that all plans share.
    fn settings(&self) -> BakeSettings {
        BakeSettings {
            lobe: self.lobe,
            filter: self.filter,
            oem_size: self.oem_size,
            border: self.border,
            scan: self.scan.unwrap_or_default(),
            chain: self.chain,
            sh_order: self.sh_order,
            sh_window: self.sh_window,
            ..BakeSettings::default()
        }
    }

    /// The plan of one file, or of a folder of images.
    fn untargeted(&self) -> Result<Plan> {
        if self.flip.is_some() || self.diffuse.is_some() {
            return wrong("`flip` and `diffuse` are for targets; set `target`, or omit them");
        }
        if self.lobe == Lobe::Cosine && self.levels.is_some_and(|levels| levels > 1) {
            return wrong("the lobe cosine has no roughness and bakes one level; omit `levels`");
        }
        if self.bounds && !matches!(self.filter, Filter::Adaptive(_)) {
            return wrong("`bounds` needs `filter` adaptive:E; other filters have no certified bounds");
        }
        let layout = self.out_layout.unwrap_or_default();
        let (name, map) = (layout.name(), layout.map());
        if layout != OutputLayout::Faces && self.bounds {
            return wrong(format!("`bounds` is for `outLayout` faces, not {name}"));
        }
        if map != Map::Cube && (self.irradiance.is_some() || self.skybox.is_some()) {
            return wrong(format!("`irradiance` and `skybox` are cubes; omit them or `outLayout` {name}"));
        }
        let images = layout != OutputLayout::Faces;
        let container = self.format.unwrap_or(if images { Container::Exr } else { Container::Ktx2 });
        let pixel = self.pixel_in(container, layout)?;
        let ladder = self.ladder.unwrap_or_default();
        // The format requires every level down to one texel.
        let every_level = layout == OutputLayout::Mips;
        let size = self.size.unwrap_or(if every_level { 256 } else { ladder.default_size(map, self.lobe) });
        let settings = BakeSettings {
            map,
            size,
            levels: self.levels.or_else(|| every_level.then(|| map.most_levels(size))),
            ladder,
            bounds: self.bounds,
            irradiance: self.irradiance,
            ..self.settings()
        };
        settings.level_specs()?;
        let diffuse = if self.irradiance.is_some() { Diffuse::Cube } else { Diffuse::None };
        let skybox = self.skybox.is_some();
        let files = TargetPlan { container, pixel, layout, diffuse, skybox, ..TargetPlan::new(&UNTARGETED) };
        let defaults = Ladder::ALL.map(|ladder| (ladder, ladder.default_levels(map, size)));
        let warning = self.costly(&settings, &defaults);
        Ok(Plan { files, settings, warning })
    }

    /// Pixel format of `layout` in `container`.
    fn pixel_in(&self, container: Container, layout: OutputLayout) -> Result<Pixel> {
        let (name, is_one_exr) =
            (container.name(), matches!(layout, OutputLayout::Parts | OutputLayout::Mips));
        if is_one_exr && container != Container::Exr {
            return wrong(format!("`outLayout` {} is an exr file, not {name}", layout.name()));
        }
        if layout != OutputLayout::Faces && container.is_single() {
            return wrong(format!("`outLayout` {} is for exr and hdr, not {name}", layout.name()));
        }
        match (container, self.pixel) {
            (Container::Hdr, None) => Ok(Pixel::Rgbe),
            (Container::Hdr, Some(_)) => wrong("the pixels of hdr are always RGBE; omit `pixel`"),
            (Container::Exr, None) if !is_one_exr => Ok(Pixel::Auto),
            (_, pixel) => {
                let pixel = pixel.unwrap_or_default();
                if container.holds(pixel) {
                    return Ok(pixel);
                }
                wrong(format!("{name} files cannot hold `pixel` {}; ktx2 holds it", pixel.name()))
            }
        }
    }

    /// The preset of `target` with these options.
    fn targeted(&self, target: &'static Target) -> Result<Plan> {
        let mut files = TargetPlan::new(target);
        let name = target.name;
        let refused = |message: &str| wrong(format!("target {name} {message}"));
        if self.bounds {
            return wrong("`bounds` cannot be combined with `target`; bake without a target for bounds");
        }
        if self.out_layout.is_some() {
            return wrong("`outLayout` cannot be combined with `target`; omit one");
        }
        if self.lobe == Lobe::Cosine {
            return wrong("the lobe cosine cannot be combined with `target`; `diffuse` cube adds irradiance");
        }
        if !target.has_container() {
            if self.format.is_some() || self.pixel.is_some() {
                return refused("has a fixed format; omit `format` and `pixel`");
            }
            if self.diffuse.is_some() || self.irradiance.is_some() {
                return refused("has fixed diffuse light; omit `diffuse` and `irradiance`");
            }
        }
        files.container = self.format.unwrap_or(files.container);
        if files.container == Container::Hdr {
            return refused("cannot be written as `format` hdr; use ktx2, ktx, dds or exr");
        }
        if target.map == Map::Octahedral && !matches!(files.container, Container::Ktx2 | Container::Exr) {
            return refused("has no cube; use `format` ktx2 or exr");
        }
        if target.map != Map::Cube && self.flip.is_some() {
            return refused("has no cube; omit `flip`");
        }
        if target.map == Map::Panorama && self.levels.is_some() {
            return refused("has one level; omit `levels`");
        }
        files.pixel = self.pixel.unwrap_or(files.pixel);
        files.flip = self.flip.unwrap_or(files.flip);
        files.diffuse = self.diffuse.unwrap_or(files.diffuse);
        files.skybox |= self.skybox.is_some();
        self.filter.check(self.lobe, self.oem_size)?;
        let has_cube = |diffuse| matches!(diffuse, Diffuse::Cube | Diffuse::Both);
        if self.irradiance.is_some() && !has_cube(files.diffuse) {
            files.diffuse = match (self.diffuse, files.diffuse) {
                (Some(form), _) => {
                    let form = form.name();
                    return wrong(format!("`irradiance` is a cube, but `diffuse` {form} has none; omit one"));
                }
                (None, Diffuse::Sh) => Diffuse::Both,
                (None, _) => Diffuse::Cube,
            };
        }
        files.check()?;
        let size = self.size.unwrap_or(target.size);
        let irradiance = self.irradiance.unwrap_or(target.irradiance_size);
        let settings = BakeSettings {
            map: target.map,
            size,
            levels: Some(self.levels.unwrap_or_else(|| target.levels(size))),
            ladder: self.ladder.unwrap_or(target.ladder),
            chain: self.chain.or(target.chain),
            irradiance: has_cube(files.diffuse).then_some(irradiance),
            sheen: target.has_sheen(),
            ..self.settings()
        };
        let levels = settings.level_specs()?.len() as u32;
        files.check_levels(size, levels)?;
        let warning = self.costly(&settings, &[(target.ladder, target.levels(size))]);
        Ok(Plan { files, settings, warning })
    }

    /// A warning if the given ladder or number of levels costs more than twice the best of `choices`, by the
    /// estimated error of look-ups.
    fn costly(&self, settings: &BakeSettings, choices: &[(Ladder, u32)]) -> Option<String> {
        let &BakeSettings { map, size, ladder, lobe, .. } = settings;
        if lobe != Lobe::Ggx || (self.ladder.is_none() && self.levels.is_none()) {
            return None;
        }
        let error = |ladder: Ladder, levels| ladder.look_up_error(map, size, levels);
        let levels = settings.levels.unwrap_or_else(|| ladder.default_levels(map, size));
        let own = error(ladder, levels);
        let (best, best_ladder, best_levels) = choices
            .iter()
            .map(|&(ladder, levels)| (error(ladder, levels), ladder, levels))
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        (own > 2.0 * best).then(|| {
            format!(
                "trilinear look-ups at roughness 0.6 to 1 are up to {:.0} % off by estimate with {levels} levels \
                 of the {} ladder; {:.0} % with `ladder` {} and `levels` {best_levels}",
                100.0 * own,
                ladder.name(),
                100.0 * best,
                best_ladder.name()
            )
        })
    }
}
