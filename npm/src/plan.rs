//! Converts options to plans, by the rules that the command line shares.

use crate::given::{Given, wrong};
use octagloss::files::Overflow;
use octagloss::files::{Container, OutputLayout, Pixel};
use octagloss::harmonics::MAX_ORDER;
use octagloss::harmonics::window::{self, ShWindow};
use octagloss::internals::export::plan::{BakePlan, PlanOptions};
use octagloss::internals::image::exposure::Exposure;
use octagloss::queries::parsed_filter;
use octagloss::targets::{Diffuse, Flip, TARGETS, Target};
use octagloss::{ChainKind, Filter, LOBES, Ladder, Layout, Lobe, Result, Skybox};

/// Maximum edge of a cube or an octahedral map, in texels.
const MAX_SIZE: u32 = 16_384;

/// What to bake, and what to make of it.
pub(crate) struct Request {
    plans: Vec<BakePlan>,
    /// Base name of the files; the input's by default.
    pub(crate) name: Option<String>,
    pub(crate) overflow: Overflow,
    pub(crate) preview: bool,
    pub(crate) exposure: Exposure,
    pub(crate) sunless: bool,
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
        let overflows = Overflow::ALL.map(|how| (how.name(), how));
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
        let options = options(given)?;
        let plans = if targets.is_empty() {
            vec![options.untargeted()?]
        } else {
            targets.into_iter().map(|target| options.targeted(target)).collect::<Result<_>>()?
        };
        Ok(Self { plans, name, overflow, preview, exposure, sunless })
    }

    /// The plans for a source of `layout`.
    pub(crate) fn plans(&self, layout: Layout) -> Vec<BakePlan> {
        self.plans.iter().map(|plan| plan.settled(layout)).collect()
    }
}

/// Reads the options of plans.
fn options(given: &mut Given) -> Result<PlanOptions> {
    let skybox = match given.number_or_text("skybox")? {
        None => None,
        Some(text) => match Skybox::parsed(&text) {
            Ok(skybox) => Some(skybox),
            Err(remedy) => return wrong(format!("`skybox` is {text}; it {remedy}")),
        },
    };
    let options = PlanOptions {
        size: given.whole("size", 1..=MAX_SIZE)?,
        levels: given.whole("levels", 1..=15)?,
        ladder: given.choice("ladder", &Ladder::ALL.map(|ladder| (ladder.name(), ladder)))?,
        chain: given.choice("chain", &ChainKind::ALL.map(|kind| (kind.name(), kind)))?,
        lobe: given.choice("lobe", &LOBES.map(|lobe| (lobe.name(), lobe)))?.unwrap_or(Lobe::Ggx),
        filter: given.parsed_text("filter", parsed_filter)?.unwrap_or(Filter::Adaptive(0.005)),
        container: given.choice("format", &Container::ALL.map(|container| (container.name(), container)))?,
        out_layout: given.choice("outLayout", &OutputLayout::ALL.map(|layout| (layout.name(), layout)))?,
        pixel: given.choice("pixel", &Pixel::CHOICES.map(|pixel| (pixel.name(), pixel)))?,
        irradiance: given.whole("irradiance", 1..=1024)?,
        skybox,
        sh_order: given.whole("shOrder", 2..=MAX_ORDER)?.unwrap_or(2),
        sh_window: given.parsed_text("shWindow", window::parsed)?.unwrap_or(ShWindow::None),
        flip: given.choice("flip", &Flip::ALL.map(|flip| (flip.name(), flip)))?,
        diffuse: given.choice("diffuse", &Diffuse::ALL.map(|form| (form.name(), form)))?,
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
