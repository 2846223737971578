//! The values of options: what can be chosen, what it stands for, and texts parsed.

use clap::ValueEnum;
use octagloss::Map;
use octagloss::bake::overflow::Overflow;
use octagloss::cpu::adaptive::LEAST_ERROR;
use octagloss::filter::Filter;
use octagloss::format::Pixel;
use octagloss::io::layout::Unfolding;
use octagloss::ladder::Ladder;
use octagloss::lobe::Lobe;
use octagloss::realtime::tables::COUNTS;
use octagloss::sh::window::ShWindow;
use octagloss::target::{Diffuse, Flip, Plan, TARGETS, Target};

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum DfgFormArg {
    SplitSum,
    MultipleScattering,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum LayoutArg {
    /// By the image's shape
    Auto,
    /// Panorama, 2:1
    Equirect,
    /// Horizontal 4:3 or vertical 3:4 cross
    Cross,
    /// Six faces in a row or a column
    Strip,
    /// Six files
    Faces,
    /// Octahedral square
    Octahedral,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum EngineArg {
    /// The best there is
    Auto,
    /// All cores
    Cpu,
    /// A GPU, or a driver that acts as one
    Gpu,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum LadderArg {
    Linear,
    Filament,
    Unity,
    Babylon,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum LobeArg {
    Ggx,
    Phong,
    Cone,
    Cosine,
    Charlie,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum FormatArg {
    Ktx2,
    Ktx,
    Dds,
    Exr,
    Hdr,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum OutLayoutArg {
    Faces,
    Cross,
    CrossVertical,
    Strip,
    StripVertical,
    Equirect,
    Octahedral,
    Parts,
    Mips,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PixelArg {
    F16,
    F32,
    Rgb9e5,
    R11g11b10f,
    Bc6h,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum OverflowArg {
    Clamp,
    Compress,
    Error,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum FlipArg {
    None,
    X,
    Z,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum DiffuseArg {
    None,
    Cube,
    Sh,
    Both,
}

/// How many texels of a level to compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Texels {
    Some(usize),
    All,
}

impl From<LadderArg> for Ladder {
    fn from(ladder: LadderArg) -> Self {
        match ladder {
            LadderArg::Linear => Self::Linear,
            LadderArg::Filament => Self::Filament,
            LadderArg::Unity => Self::Unity,
            LadderArg::Babylon => Self::Babylon,
        }
    }
}

impl From<LobeArg> for Lobe {
    fn from(lobe: LobeArg) -> Self {
        match lobe {
            LobeArg::Ggx => Self::Ggx,
            LobeArg::Phong => Self::Phong,
            LobeArg::Cone => Self::Cone,
            LobeArg::Cosine => Self::Cosine,
            LobeArg::Charlie => Self::Charlie,
        }
    }
}

impl From<PixelArg> for Pixel {
    fn from(pixel: PixelArg) -> Self {
        match pixel {
            PixelArg::F16 => Self::F16,
            PixelArg::F32 => Self::F32,
            PixelArg::Rgb9e5 => Self::Rgb9e5,
            PixelArg::R11g11b10f => Self::R11g11b10,
            PixelArg::Bc6h => Self::Bc6h,
        }
    }
}

impl From<OverflowArg> for Overflow {
    fn from(overflow: OverflowArg) -> Self {
        match overflow {
            OverflowArg::Clamp => Self::Clamp,
            OverflowArg::Compress => Self::Compress,
            OverflowArg::Error => Self::Error,
        }
    }
}

impl From<FlipArg> for Flip {
    fn from(flip: FlipArg) -> Self {
        match flip {
            FlipArg::None => Self::None,
            FlipArg::X => Self::X,
            FlipArg::Z => Self::Z,
        }
    }
}

impl From<DiffuseArg> for Diffuse {
    fn from(diffuse: DiffuseArg) -> Self {
        match diffuse {
            DiffuseArg::None => Self::None,
            DiffuseArg::Cube => Self::Cube,
            DiffuseArg::Sh => Self::Sh,
            DiffuseArg::Both => Self::Both,
        }
    }
}

impl OutLayoutArg {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Faces => "faces",
            Self::Cross => "cross",
            Self::CrossVertical => "cross-vertical",
            Self::Strip => "strip",
            Self::StripVertical => "strip-vertical",
            Self::Equirect => "equirect",
            Self::Octahedral => "octahedral",
            Self::Parts => "parts",
            Self::Mips => "mips",
        }
    }

    /// What its levels' texels cover.
    pub(super) const fn map(self) -> Map {
        match self {
            Self::Equirect | Self::Mips => Map::Panorama,
            Self::Octahedral => Map::Octahedral,
            _ => Map::Cube,
        }
    }

    /// How a cube's faces lie in a level's one image.
    pub(super) const fn unfolding(self) -> Option<Unfolding> {
        match self {
            Self::Cross => Some(Unfolding::Cross),
            Self::CrossVertical => Some(Unfolding::CrossVertical),
            Self::Strip => Some(Unfolding::Strip),
            Self::StripVertical => Some(Unfolding::StripVertical),
            _ => None,
        }
    }
}

impl FormatArg {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Ktx2 => "ktx2",
            Self::Ktx => "ktx",
            Self::Dds => "dds",
            Self::Exr => "exr",
            Self::Hdr => "hdr",
        }
    }
}

/// The target of that name.
pub(super) fn target(text: &str) -> Result<&'static Target, String> {
    Target::named(text).ok_or_else(|| {
        let names: Vec<_> = TARGETS.iter().map(|target| target.name).collect();
        format!("there are {}", names.join(", "))
    })
}

/// What each target expands to.
pub(super) fn target_help() -> String {
    let mut text = "Presets for engines, comma-separated\n\nEach sets what other options do not. OUT is a folder that \
                    gets the target's files and report.json, one folder a target where there are several; all are made \
                    from one octahedral map."
        .to_owned();
    for target in &TARGETS {
        let tested = match target.verified {
            Some(reader) => format!("tested with {reader}"),
            None => "unverified: no test loads it into its engine".to_owned(),
        };
        text += &format!("\n\n{}: {} ({tested})\n{}\nFiles:", target.name, target.reader, target.expansion());
        for (path, _) in Plan::new(target).files("NAME") {
            text += &format!(" {path}");
        }
    }
    text
}

/// A name without folders.
pub(super) fn file_name(text: &str) -> Result<String, String> {
    if text.is_empty() || text.starts_with('.') || text.contains(['/', '\\', '\0']) {
        return Err("must be a plain name, without folders and not starting with a dot".to_owned());
    }
    Ok(text.to_owned())
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "not a number".to_owned())
}

pub(super) fn finite(text: &str) -> Result<f64, String> {
    Some(number(text)?).filter(|value| value.is_finite()).ok_or_else(|| "must be finite".to_owned())
}

pub(super) fn roughness(text: &str) -> Result<f64, String> {
    Some(number(text)?)
        .filter(|value| (0.0..=1.0).contains(value))
        .ok_or_else(|| "must be between 0 and 1".to_owned())
}

pub(super) fn threshold(text: &str) -> Result<f64, String> {
    Some(finite(text)?).filter(|value| *value >= 0.0).ok_or_else(|| "must not be negative".to_owned())
}

pub(super) fn texels(text: &str) -> Result<Texels, String> {
    match text {
        "all" => Ok(Texels::All),
        _ => match text.parse() {
            Ok(count) if count > 0 => Ok(Texels::Some(count)),
            _ => Err("must be a number above 0, or all".to_owned()),
        },
    }
}

/// The filter's name on the command line and in reports, parsed.
pub(super) fn filter(text: &str) -> Result<Filter, String> {
    let (name, value) = text.split_once(':').map_or((text, None), |(name, value)| (name, Some(value)));
    match (name, value) {
        ("adaptive", None) => Ok(Filter::Adaptive(0.005)),
        ("adaptive", Some(value)) => match value.parse() {
            Ok(error) if (LEAST_ERROR..1.0).contains(&error) => Ok(Filter::Adaptive(error)),
            _ => Err(format!(
                "the error of adaptive:E must be at least {LEAST_ERROR:e}, the least that float32 reaches, and below 1"
            )),
        },
        ("fitted", None) => Ok(Filter::Fitted(4)),
        ("fitted", Some(value)) => match value.parse() {
            Ok(count) if COUNTS.contains(&count) => Ok(Filter::Fitted(count)),
            _ => Err("the boxes of fitted:K must be 1, 2, 4 or 8".to_owned()),
        },
        ("box", None) => Ok(Filter::Box),
        ("reference", None) => Ok(Filter::Reference),
        _ => Err("there are adaptive:E, fitted:K, box and reference".to_owned()),
    }
}

/// A window of spherical harmonics, as reports name it.
pub(super) fn sh_window(text: &str) -> Result<ShWindow, String> {
    let width = |text: &str| match number(text)? {
        width if width > 0.0 && width.is_finite() => Ok(width),
        _ => Err("the width of a window must be above 0 and finite".to_owned()),
    };
    match text.split_once(':') {
        None if text == "none" => Ok(ShWindow::None),
        None if text == "nonnegative" => Ok(ShWindow::Nonnegative),
        Some(("hanning", value)) => width(value).map(ShWindow::Hanning),
        Some(("lanczos", value)) => width(value).map(ShWindow::Lanczos),
        Some(("sinc4", value)) => width(value).map(ShWindow::Sinc4),
        _ => Err("there are none, hanning:W, lanczos:W, sinc4:W and nonnegative".to_owned()),
    }
}
