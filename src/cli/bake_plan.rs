//! Converts the options of `bake` to target plans and bake settings.

use super::args::BakeArgs;
use super::outcome::{Outcome, usage};
use super::output::{FOREIGN, SunFile, check_folder_name, extension, named_format, names_folder};
use super::values::SkyboxArg;
use crate::bake::BakeSettings;
use crate::chain::ChainKind;
use crate::filter::Filter;
use crate::format::container::Container;
use crate::format::{OutputLayout, Pixel};
use crate::ladder::Ladder;
use crate::lobe::Lobe;
use crate::target::{Diffuse, TargetPlan, UNTARGETED};
use crate::{Layout, Map};
use std::path::Path;

/// Files to write, and the settings of their bake.
#[derive(Clone, Debug)]
pub(super) struct BakePlan {
    pub(super) plan: TargetPlan,
    pub(super) settings: BakeSettings,
    /// The requested skybox; resolved in the settings once the source is known.
    pub(super) skybox: Option<SkyboxArg>,
    /// A costly choice of ladder or levels.
    pub(super) warning: Option<String>,
}

impl BakePlan {
    /// Resolves the skybox for a source of `layout`.
    pub(super) fn settled(&self, layout: Layout) -> Self {
        let edge = self.skybox.map(|skybox| skybox.edge(layout));
        Self { settings: BakeSettings { skybox: edge, ..self.settings.clone() }, ..self.clone() }
    }
}

/// One plan per target, or one plan without a target. `several` inputs need an output folder.
pub(super) fn plans(args: &BakeArgs, several: bool) -> Outcome<Vec<BakePlan>> {
    args.table.check_scan(args.filter)?;
    if args.target.is_empty() {
        let settings = untargeted_settings(args)?;
        let plan = untargeted(args, several)?;
        let (map, size) = (settings.map, settings.size);
        let defaults = Ladder::ALL.map(|ladder| (ladder, ladder.default_levels(map, size)));
        let warning = costly(args, &settings, &defaults);
        return Ok(vec![BakePlan { plan, settings, skybox: args.skybox, warning }]);
    }
    if args.bounds {
        return usage("--bounds cannot be combined with --target; bake without --target for bounds");
    }
    if args.lobe == Lobe::Cosine {
        return usage("--lobe cosine cannot be combined with --target; --diffuse cube adds irradiance");
    }
    let mut plans: Vec<BakePlan> = Vec::new();
    for target in &args.target {
        if plans.iter().any(|other| other.plan.target == *target) {
            return usage(format!("--target names {} twice", target.name));
        }
        plans.push(planned(TargetPlan::new(target), args)?);
    }
    if let Some(path) = &args.output {
        if path.as_os_str() == "-" {
            return usage("-o - needs an output of one file, but --target writes a folder; name it with -o");
        }
        check_folder_name(path, ", or omit --target to write one file")?;
    }
    Ok(plans)
}

/// The requested files about the sun.
pub(super) fn sun_files(args: &BakeArgs) -> Vec<SunFile> {
    let asked = [(SunFile::Sun, args.input.extract_sun), (SunFile::Sunless, args.sunless)];
    asked.into_iter().filter_map(|(file, asked)| asked.then_some(file)).collect()
}

fn untargeted_settings(args: &BakeArgs) -> Outcome<BakeSettings> {
    if args.lobe == Lobe::Cosine && args.levels.is_some_and(|levels| levels > 1) {
        return usage("--lobe cosine has no roughness and bakes one level; omit --levels");
    }
    if let Some(kind) = args.chain.filter(|kind| args.bounds && *kind != ChainKind::Sampled) {
        return usage(format!("--bounds needs sampled texels; omit --chain {} or --bounds", kind.name()));
    }
    if args.bounds && !matches!(args.filter, Filter::Adaptive(_)) {
        return usage("--bounds needs --filter adaptive:E; other filters have no certified bounds");
    }
    if let Some(layout) = args.out_layout.filter(|layout| *layout != OutputLayout::Faces) {
        let name = layout.name();
        if args.bounds {
            return usage(format!("--bounds is for --out-layout faces, not {name}"));
        }
        if args.irradiance.is_some() && layout.map() != Map::Cube {
            return usage(format!("--irradiance is a cube; omit it or --out-layout {name}"));
        }
        if args.skybox.is_some() && layout.map() != Map::Cube {
            return usage(format!("--skybox is a cube; omit it or --out-layout {name}"));
        }
    }
    let map = args.out_layout.map_or(Map::Cube, OutputLayout::map);
    let (ladder, lobe) = (args.ladder.unwrap_or_default(), args.lobe);
    // The format requires every level down to one texel.
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
        scan: args.table.scan.unwrap_or_default(),
        chain: args.chain,
        bounds: args.bounds,
        irradiance: args.irradiance,
        skybox: None,
        sh_order: args.sh_order,
        sh_window: args.sh_window,
        sheen: false,
    };
    match settings.level_specs() {
        Ok(_) => Ok(settings),
        Err(error) => usage(error.to_string()),
    }
}

/// A warning if the given ladder or number of levels costs more than twice the best of `choices`, by the
/// estimated error of look-ups.
fn costly(args: &BakeArgs, settings: &BakeSettings, choices: &[(Ladder, u32)]) -> Option<String> {
    let &BakeSettings { map, size, ladder, lobe, .. } = settings;
    let levels = settings.levels.unwrap_or_else(|| ladder.default_levels(map, size));
    // One level is not looked up by roughness.
    if lobe != Lobe::Ggx || levels == 1 || (args.ladder.is_none() && args.levels.is_none()) {
        return None;
    }
    let own = ladder.look_up_error(map, size, levels);
    let (best, best_ladder, best_levels) = choices
        .iter()
        .map(|&(ladder, levels)| (ladder.look_up_error(map, size, levels), ladder, levels))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    (own > COSTLY * best).then(|| {
        format!(
            "trilinear look-ups at roughness 0.6 to 1 are up to {:.0} % off by estimate with {levels} levels of \
             the {} ladder; {:.0} % with --ladder {} --levels {best_levels}",
            100.0 * own,
            ladder.name(),
            100.0 * best,
            best_ladder.name()
        )
    })
}

/// Ratio of estimated errors above which a choice is warned about.
const COSTLY: f64 = 2.0;

/// Rejects options and formats that cannot go to standard output.
pub(super) fn check_stdout(args: &BakeArgs, plan: &TargetPlan, several: bool) -> Outcome {
    if several {
        return usage("-o - takes one input; name a folder with -o for several");
    }
    if !plan.is_single() {
        return usage(
            "-o - needs an output of one file: ktx2, ktx, dds, or exr with --out-layout parts or mips; name a \
             folder with -o",
        );
    }
    let beside = [
        (args.json, "--json"),
        (args.skip_unchanged, "--skip-unchanged"),
        (args.preview.is_some(), "--preview"),
        (args.irradiance.is_some(), "--irradiance"),
        (args.skybox.is_some(), "--skybox"),
        (args.bounds, "--bounds"),
        (args.input.extract_sun, "--extract-sun"),
    ];
    match beside.into_iter().find(|(asked, _)| *asked) {
        Some((_, option)) => usage(format!(
            "-o - writes only one file, to standard output; omit {option} or name a file with -o"
        )),
        None => Ok(()),
    }
}

/// The plan without a target: the given format, else that of the output's extension, else ktx2, with
/// supported pixels.
fn untargeted(args: &BakeArgs, several: bool) -> Outcome<TargetPlan> {
    let container = container(args, several)?;
    let layout = args.out_layout.unwrap_or_default();
    let pixel = pixel(args, container, layout)?;
    let diffuse = if args.irradiance.is_some() { Diffuse::Cube } else { Diffuse::None };
    let skybox = args.skybox.is_some();
    let plan = TargetPlan { container, pixel, layout, diffuse, skybox, ..TargetPlan::new(&UNTARGETED) };
    if let Some(path) = args.output.as_deref().filter(|_| !plan.is_single()) {
        let remedy =
            format!(" (with --format {}), and --out-layout parts writes one .exr file", container.name());
        check_folder_name(path, &remedy)?;
    }
    Ok(plan)
}

/// The given format, else that of the output's extension, else the layout's.
fn container(args: &BakeArgs, several: bool) -> Outcome<Container> {
    let file = args.output.as_deref().filter(|path| !names_folder(path));
    let named = file.and_then(named_format);
    let output = || args.output.as_deref().unwrap_or(Path::new("")).display().to_string();
    let foreign = file.and_then(extension).filter(|name| FOREIGN.contains(&name.as_str()));
    if let Some(foreign) = foreign {
        return usage(format!(
            "the output {} has the unsupported extension .{foreign}; use ktx2, ktx, dds, exr or hdr",
            output()
        ));
    }
    if let (true, Some(_)) = (several, named) {
        return usage(format!("several inputs need an output folder; {} names a file", output()));
    }
    Ok(match (args.format, named) {
        (Some(said), Some(named)) if said != named => {
            return usage(format!(
                "--format {} and the output {} contradict each other; omit one",
                said.name(),
                output()
            ));
        }
        (said, named) => said.or(named).unwrap_or(match args.out_layout {
            Some(layout) if layout != OutputLayout::Faces => Container::Exr,
            _ => Container::Ktx2,
        }),
    })
}

/// Pixel format of `layout` in `container`.
fn pixel(args: &BakeArgs, container: Container, layout: OutputLayout) -> Outcome<Pixel> {
    let (name, images) = (container.name(), layout != OutputLayout::Faces);
    let is_one_exr = matches!(layout, OutputLayout::Parts | OutputLayout::Mips);
    if is_one_exr && container != Container::Exr {
        return usage(format!("--out-layout {} is an exr file, not {name}", layout.name()));
    }
    if images && container.is_single() {
        return usage(format!("--out-layout {} is for exr and hdr, not {name}", layout.name()));
    }
    match (container, args.pixel) {
        (Container::Hdr, None) => Ok(Pixel::Rgbe),
        (Container::Hdr, Some(_)) => usage("--pixel cannot be combined with hdr; its pixels are always RGBE"),
        (Container::Exr, None) if !is_one_exr => Ok(Pixel::Auto),
        (_, pixel) => {
            let pixel = pixel.unwrap_or_default();
            if container.holds(pixel) {
                return Ok(pixel);
            }
            let pixel = pixel.name();
            usage(match container {
                Container::Exr => format!("--pixel {pixel} is for ktx2 and dds; exr supports f16 and f32"),
                _ => format!("{name} does not support --pixel {pixel}; ktx2 and dds do"),
            })
        }
    }
}

/// The preset with the overrides of `args`.
fn planned(mut plan: TargetPlan, args: &BakeArgs) -> Outcome<BakePlan> {
    let target = plan.target;
    let fixed = |option: &str| usage(format!("target {} has a fixed format; omit {option}", target.name));
    if let Some(format) = args.format {
        if !target.has_container() {
            return fixed("--format");
        }
        if format == Container::Hdr {
            return usage(
                "--format hdr is a folder of faces and cannot be combined with --target; use ktx2, ktx, dds \
                 or exr",
            );
        }
        plan.container = format;
    }
    if target.map == Map::Octahedral && !matches!(plan.container, Container::Ktx2 | Container::Exr) {
        return usage(format!(
            "target {}: --format {} is for cubes; use ktx2 or exr",
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
        return usage(format!("target {} has no cube; omit --flip", target.name));
    }
    if target.map == Map::Panorama && args.levels.is_some() {
        return usage(format!("target {} has one level; omit --levels", target.name));
    }
    plan.pixel = args.pixel.unwrap_or(plan.pixel);
    plan.flip = args.flip.unwrap_or(plan.flip);
    plan.diffuse = args.diffuse.unwrap_or(plan.diffuse);
    plan.skybox |= args.skybox.is_some();
    if let Err(error) = args.filter.check(args.lobe, args.table.oem_size) {
        return usage(error.to_string());
    }
    let cube = matches!(plan.diffuse, Diffuse::Cube | Diffuse::Both);
    if args.irradiance.is_some() && !cube {
        match (args.diffuse, plan.diffuse) {
            (Some(_), _) => {
                return usage(format!(
                    "--irradiance requests a cube but --diffuse {} has none; omit one",
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
        scan: args.table.scan.unwrap_or_default(),
        chain: args.chain.or(target.chain),
        bounds: false,
        irradiance: cube.then(|| args.irradiance.unwrap_or(target.irradiance_size)),
        skybox: None,
        sh_order: args.sh_order,
        sh_window: args.sh_window,
        sheen: target.has_sheen(),
    };
    let specs = settings.level_specs().and_then(|specs| plan.check_levels(size, specs.len() as u32));
    match specs {
        Ok(()) => {
            let warning = costly(args, &settings, &[(target.ladder, target.levels(size))]);
            Ok(BakePlan { plan, settings, skybox: args.skybox, warning })
        }
        Err(error) => usage(format!("target {}: {error}", target.name)),
    }
}
